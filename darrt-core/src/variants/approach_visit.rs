//! The greedy tour that begins with the way to the contact or grasp, as the primitives see it.

use crate::distance::Distance;
use crate::distance::greedy_visit::{Departure, greedy_tour, open_objects};
use crate::domain::Domain;
use crate::nearest::pruned::nearest_pruned;
use crate::partial::PartialState;
use crate::primitive::Primitive;
use crate::state::State;
use crate::tree::{Node, NodeId, Tree};

/// Like [`GreedyVisit`](crate::distance::GreedyVisit), but the robot's first way is at least the shortest that a useful primitive names for it
/// ([`Primitive::approach`]): the way to the side from which an object must be pushed is longer than the way to the object.
pub struct ApproachVisit<D: Domain> {
    primitives: Vec<Box<dyn Primitive<D>>>,
}

impl<D: Domain> ApproachVisit<D> {
    /// A distance that sees these primitives: those of the problem.
    pub fn new(primitives: Vec<Box<dyn Primitive<D>>>) -> Self {
        Self { primitives }
    }

    fn measure(&self, m: &D, departure: &Departure<'_, D>, to: &PartialState<D>) -> f64 {
        let from = departure.state;
        let tour = greedy_tour(m, departure, to);
        let (open, ways) = open_objects(m, from, to);
        if open.is_empty() {
            return tour;
        }
        let useful = self.primitives.iter().filter(|p| p.useful(m, from, to));
        // One that does not say may start where it is.
        let approach = useful.map(|p| p.approach(m, from, to).unwrap_or(0.0)).min_by(f64::total_cmp);
        // `max` would pass over a tour that is no number.
        approach.map(|metres| ways + metres).filter(|metres| *metres > tour).unwrap_or(tour)
    }
}

impl<D: Domain> Distance<D> for ApproachVisit<D> {
    fn distance(&self, m: &D, from: &State<D>, to: &PartialState<D>) -> f64 {
        self.measure(m, &Departure { state: from, working_point: None }, to)
    }

    fn nearest(&self, m: &D, tree: &Tree<D>, to: &PartialState<D>) -> Option<NodeId> {
        let measure = |node: &Node<D>| {
            self.measure(m, &Departure { state: &node.state, working_point: Some(node.working_point()) }, to)
        };
        // Never below the greedy tour, so what bounds that one bounds this.
        nearest_pruned(m, tree, to, crate::distance::greedy_visit::tour_at_least, measure)
    }
}

impl<D: Domain> std::fmt::Debug for ApproachVisit<D> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let names: Vec<_> = self.primitives.iter().map(|p| p.name()).collect();
        f.debug_struct("ApproachVisit").field("primitives", &names).finish()
    }
}
