//! The shortest tour over all orders of the objects, for few objects.

use smallvec::SmallVec;

use super::euclidean::object_travel;
use super::greedy_visit::{hop, last_leg};
use super::{Distance, GreedyVisit};
use crate::domain::Domain;
use crate::partial::PartialState;
use crate::state::{ObjectId, State};

/// Like [`GreedyVisit`], but with the best order. Past [`ExactTour::MAX_OBJECTS`] open objects the number
/// of orders explodes and it falls back to the greedy tour.
#[derive(Debug, Clone, Copy, Default)]
pub struct ExactTour;

impl ExactTour {
    /// Up to how many objects all orders are tried (6! = 720 tours).
    pub const MAX_OBJECTS: usize = 6;
}

impl<D: Domain> Distance<D> for ExactTour {
    fn distance(&self, m: &D, from: &State<D>, to: &PartialState<D>) -> f64 {
        let open: SmallVec<[ObjectId; 8]> =
            to.objects().map(|(id, _)| id).filter(|id| !to.is_object_met(m, from, *id)).collect();
        if open.len() > Self::MAX_OBJECTS {
            return GreedyVisit.distance(m, from, to);
        }
        best_tour(m, from, to, &open, None, f64::INFINITY)
    }
}

/// Depth-first over the orders of `open`, cutting tours that are already longer than `bound`.
fn best_tour<D: Domain>(
    m: &D,
    from: &State<D>,
    to: &PartialState<D>,
    open: &[ObjectId],
    last: Option<ObjectId>,
    bound: f64,
) -> f64 {
    if open.is_empty() {
        return last_leg(m, from, to, last);
    }
    let mut best = bound;
    for (slot, id) in open.iter().enumerate() {
        let leg = hop(m, from, to, last, *id) + to.object(*id).map_or(0.0, |t| object_travel(m, from, *id, t));
        if leg >= best {
            continue;
        }
        let rest: SmallVec<[ObjectId; 8]> =
            open.iter().enumerate().filter(|(i, _)| *i != slot).map(|(_, id)| *id).collect();
        best = best.min(leg + best_tour(m, from, to, &rest, Some(*id), best - leg));
    }
    best
}
