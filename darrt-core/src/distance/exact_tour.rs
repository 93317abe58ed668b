//! The shortest tour over all orders of the objects, for few objects.

use smallvec::SmallVec;

use super::greedy_visit::{Departure, last_stretch, nearest_departure, open_objects, travel_between};
use super::{Distance, GreedyVisit};
use crate::domain::Domain;
use crate::partial::PartialState;
use crate::state::{ObjectId, State};
use crate::tree::{NodeId, Tree};

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
        exact_tour(m, &Departure { state: from, working_point: None }, to)
    }

    fn nearest(&self, m: &D, tree: &Tree<D>, to: &PartialState<D>) -> Option<NodeId> {
        nearest_departure(m, tree, to, |from| exact_tour(m, from, to))
    }
}

fn exact_tour<D: Domain>(m: &D, from: &Departure<'_, D>, to: &PartialState<D>) -> f64 {
    let (open, ways) = open_objects(m, from.state, to);
    if open.len() > ExactTour::MAX_OBJECTS {
        return GreedyVisit.distance(m, from.state, to);
    }
    let open: SmallVec<[ObjectId; 8]> = open.iter().map(|(id, _)| *id).collect();
    ways + best_tour(m, from, to, &open, None, f64::INFINITY)
}

/// The shortest way of the robot between the objects. Depth-first over the orders of `open`, cutting tours that are
/// already no shorter than `bound`.
fn best_tour<D: Domain>(
    m: &D,
    from: &Departure<'_, D>,
    to: &PartialState<D>,
    open: &[ObjectId],
    last: Option<ObjectId>,
    bound: f64,
) -> f64 {
    if open.is_empty() {
        return last_stretch(m, from.state, to, last);
    }
    let mut best = bound;
    for (slot, id) in open.iter().enumerate() {
        let next_m = travel_between(m, from, to, last, *id);
        if next_m >= best {
            continue;
        }
        let rest: SmallVec<[ObjectId; 8]> =
            open.iter().enumerate().filter(|(i, _)| *i != slot).map(|(_, id)| *id).collect();
        best = best.min(next_m + best_tour(m, from, to, &rest, Some(*id), best - next_m));
    }
    best
}
