//! `DISTANCE(v, s, M, A)`: how far a state is from a partial target (paper section 4.3).
//!
//! Directed: `from` is a state and `to` a partial state, so the two cannot be swapped.

use crate::domain::Domain;
use crate::partial::PartialState;
use crate::state::State;
use crate::tree::{NodeId, Tree};

pub mod euclidean;
pub mod exact_tour;
pub mod greedy_visit;

pub use euclidean::Euclidean;
pub use exact_tour::ExactTour;
pub use greedy_visit::GreedyVisit;

/// How far, in metres.
///
/// # Laws
/// Finite, non-negative, zero when the target is met up to the tolerance of its components; components
/// that the target leaves open do not count.
///
/// # Example
/// ```
/// use darrt_core::distance::Distance;
/// use darrt_core::prelude::*;
///
/// /// Objects count, the robot does not.
/// struct ObjectsOnly;
///
/// impl<D: Domain> Distance<D> for ObjectsOnly {
///     fn distance(&self, m: &D, from: &State<D>, to: &PartialState<D>) -> f64 {
///         let metres = |(id, target): (ObjectId, _)| {
///             let space = m.objects().get(id.index())?;
///             Some(space.distance(from.object(id)?, target))
///         };
///         to.objects().filter_map(metres).sum()
///     }
/// }
/// ```
pub trait Distance<D: Domain>: Send + Sync {
    /// Metres from `from` to the nearest state that meets `to`.
    fn distance(&self, m: &D, from: &State<D>, to: &PartialState<D>) -> f64;

    /// arg min over the tree; the lowest index wins a tie. `None` for an empty tree.
    ///
    /// One virtual call around a loop that the compiler specialises for the implementor.
    fn nearest(&self, m: &D, tree: &Tree<D>, to: &PartialState<D>) -> Option<NodeId> {
        crate::nearest::linear::nearest_by(tree, |state| self.distance(m, state, to))
    }
}
