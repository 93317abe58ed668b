//! The sum of the distances in every subspace: a significant underestimate (paper section 4.3), kept for
//! comparison.

use super::Distance;
use crate::domain::Domain;
use crate::partial::PartialState;
use crate::space::ComponentSpace;
use crate::state::State;

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
}

/// Metres from where an object is to `target`.
pub(super) fn object_travel<D: Domain>(
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
