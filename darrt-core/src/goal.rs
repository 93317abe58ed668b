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
///
/// # Example
/// ```
/// use darrt_core::prelude::*;
/// use rand::Rng;
///
/// /// One object where it should be, within the tolerance of its space, and nothing in the hand.
/// struct Delivered<D: Domain> {
///     target: PartialState<D>,
///     empty_handed: D::Mode,
/// }
///
/// impl<D: Domain> Goal<D> for Delivered<D> {
///     fn is_satisfied(&self, m: &D, state: &State<D>) -> bool {
///         state.mode == self.empty_handed && self.target.is_met(m, state)
///     }
///
///     fn sample(&self, _: &D, _: &mut dyn Rng) -> Option<PartialState<D>> {
///         Some(self.target.clone())
///     }
/// }
/// ```
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
