//! Place: the robot lets go of the puck that it holds.

use rand::Rng;

use super::pick::change_grip;
use super::world::{Grip, PuckWorld};
use crate::partial::PartialState;
use crate::primitive::{Infeasible, Instances, Primitive, PrimitiveId};
use crate::state::State;

/// Useful when the held puck is where it should be, or may be anywhere, and something else is not.
#[derive(Debug, Clone, Copy, Default)]
pub struct Place;

impl Primitive<PuckWorld> for Place {
    fn id(&self) -> PrimitiveId {
        PrimitiveId::new(2, "Place")
    }

    fn useful(&self, m: &PuckWorld, from: &State<PuckWorld>, to: &PartialState<PuckWorld>) -> bool {
        from.mode.held().is_some_and(|(id, _)| to.is_object_met(m, from, id)) && !to.is_met(m, from)
    }

    fn propagate(
        &self,
        _: &PuckWorld,
        from: &State<PuckWorld>,
        _: &PartialState<PuckWorld>,
        _: &mut dyn Rng,
    ) -> Result<Instances<PuckWorld>, Infeasible> {
        let (id, _) = from.mode.held().ok_or(Infeasible::NoGrasp)?;
        Ok(vec![change_grip(self.id(), from, id, Grip::Resting).ok_or(Infeasible::NoGrasp)?])
    }
}
