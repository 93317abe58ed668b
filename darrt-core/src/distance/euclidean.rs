//! The sum of the distances in every subspace: a significant underestimate (paper section 4.3), kept for
//! comparison.

use super::Distance;
use crate::domain::Domain;
use crate::nearest::bounds::{LANES, Lanes, Ways};
use crate::nearest::pruned::nearest_pruned;
use crate::partial::PartialState;
use crate::space::ComponentSpace;
use crate::state::State;
use crate::tree::{NodeId, Tree};

/// Sum over the named components of their distance to the target.
#[derive(Debug, Clone, Copy, Default)]
pub struct Euclidean;

impl<D: Domain> Distance<D> for Euclidean {
    fn distance(&self, m: &D, from: &State<D>, to: &PartialState<D>) -> f64 {
        let robot = match to.robot() {
            Some(_) => m.robot().distance(&from.robot, &to.robot_overlay(m, &from.robot)),
            None => 0.0,
        };
        robot + to.objects().map(|(id, target)| object_travel(m, from, id, target)).sum::<f64>()
    }

    fn nearest(&self, m: &D, tree: &Tree<D>, to: &PartialState<D>) -> Option<NodeId> {
        nearest_pruned(m, tree, to, sum_at_least, |node| self.distance(m, &node.state, to))
    }
}

fn sum_at_least(ways: &Ways, out: &mut Lanes) {
    *out = ways.robot_m.unwrap_or([0.0; LANES]);
    for object in &ways.objects {
        out.iter_mut().zip(&object.way_m).for_each(|(sum, way)| *sum += way);
    }
}

/// Metres from where an object is to `target`.
pub(crate) fn object_travel<D: Domain>(
    m: &D,
    from: &State<D>,
    id: crate::state::ObjectId,
    target: &crate::state::ObjectConfig<D>,
) -> f64 {
    match (m.objects().get(id.index()), from.object(id)) {
        (Some(space), Some(config)) => space.distance(config, target),
        _ => 0.0,
    }
}
