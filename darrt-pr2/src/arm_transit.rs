//! Arm-Transit: the arm moves towards a joint goal in a straight line in joint space (paper section 5.1).

use darrt_core::partial::PartialState;
use darrt_core::primitive::{Infeasible, Instances, Primitive};
use darrt_primitives::action::travel::arm_to;
use darrt_primitives::action::{Chain, label};
use darrt_primitives::arm_space::ARM;
use darrt_primitives::wish::asks_for_group;
use rand::Rng;

use crate::world::{World, WorldState};

/// Arm-Transit: the arm moves towards a joint goal in a straight line in joint space (paper section 5.1).
#[derive(Debug, Clone, Copy, Default)]
pub struct ArmTransit;

impl Primitive<World> for ArmTransit {
    fn name(&self) -> &'static str {
        label::ARM_TRANSIT
    }

    fn useful(&self, m: &World, from: &WorldState, to: &PartialState<World>) -> bool {
        from.mode.is_hand_free() && to.are_objects_met(m, from) && asks_for_group(from, to, ARM)
    }

    fn propagate(
        &self,
        m: &World,
        from: &WorldState,
        to: &PartialState<World>,
        rng: &mut dyn Rng,
    ) -> Result<Instances<World>, Infeasible> {
        let _ = rng;
        let target = to.robot_overlay(m, &from.robot);
        let mut chain = Chain::at(from);
        arm_to(m, &mut chain, &target.arm, m.settings().travel_gap_m);
        chain.finish()
    }
}
