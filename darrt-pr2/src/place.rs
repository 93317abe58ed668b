//! Place: the object in the gripper is set down on a support surface in a straight line and detached (paper section 5.1).

use darrt_core::partial::PartialState;
use darrt_core::primitive::{Infeasible, Instances, Primitive};
use darrt_primitives::action::label;
use darrt_primitives::action::place::place;
use darrt_primitives::wish::{asks_for_empty_hand, held_target_on_surface, random_standing_pose};
use rand::Rng;

use crate::world::{World, WorldState};

/// Place: the object in the gripper is set down on a support surface in a straight line and detached (paper section 5.1).
#[derive(Debug, Clone, Copy, Default)]
pub struct Place;

impl Primitive<World> for Place {
    fn name(&self) -> &'static str {
        label::PLACE
    }

    fn useful(&self, m: &World, from: &WorldState, to: &PartialState<World>) -> bool {
        !to.is_met(m, from) && (held_target_on_surface(m, from, to).is_some() || asks_for_empty_hand(m, from, to))
    }

    fn propagate(
        &self,
        m: &World,
        from: &WorldState,
        to: &PartialState<World>,
        rng: &mut dyn Rng,
    ) -> Result<Instances<World>, Infeasible> {
        if let Some(pose) = held_target_on_surface(m, from, to) {
            return place(m, from, pose, rng);
        }
        let held = from.mode.held().ok_or(Infeasible::NoGrasp)?;
        let anywhere = random_standing_pose(m, held.object, rng).ok_or(Infeasible::OffSupport)?;
        place(m, from, &anywhere, rng)
    }
}
