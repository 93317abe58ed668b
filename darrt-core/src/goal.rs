//! G, the goal set, which may be infinite (paper section 3).

use rand::Rng;

use crate::domain::Domain;
use crate::partial::PartialState;
use crate::state::State;

pub mod any_of;
pub mod partial;
pub mod region;

pub use any_of::AnyOf;
pub use partial::Reach;
pub use region::Region;

/// The set of states to be reached.
///
/// # Law
/// A state that meets a sample, in a mode that the goal accepts, satisfies the goal.
pub trait Goal<D: Domain>: Send + Sync {
    /// Is `state` in the goal set?
    fn is_satisfied(&self, m: &D, state: &State<D>) -> bool;

    /// A target whose states lie in the goal set; `None` if the goal cannot be sampled.
    fn sample(&self, m: &D, rng: &mut dyn Rng) -> Option<PartialState<D>>;

    /// How many parts of the goal `state` meets, for the best of a search that does not meet all of them; by default the goal
    /// is one part.
    fn parts_met(&self, m: &D, state: &State<D>) -> usize {
        usize::from(self.is_satisfied(m, state))
    }
}
