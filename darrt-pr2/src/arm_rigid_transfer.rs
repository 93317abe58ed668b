//! Arm-Rigid-Transfer: the arm moves an attached object towards a goal pose, in straight lines in joint space (paper section 5.1).

use darrt_core::partial::PartialState;
use darrt_core::primitive::{Infeasible, Instances, Primitive};
use darrt_primitives::action::transfer::transfer;
use darrt_primitives::action::travel::arm_to;
use darrt_primitives::action::{Chain, label};
use darrt_primitives::arm_space::ARM;
use darrt_primitives::wish::{asks_for_group, held_target_in_air, may_carry_along};
use rand::Rng;

use crate::world::{World, WorldState};

/// Arm-Rigid-Transfer: the arm moves an attached object towards a goal pose, in straight lines in joint space (paper section 5.1).
#[derive(Debug, Clone, Copy, Default)]
pub struct ArmRigidTransfer;

impl Primitive<World> for ArmRigidTransfer {
    fn name(&self) -> &'static str {
        label::ARM_RIGID_TRANSFER
    }

    fn useful(&self, m: &World, from: &WorldState, to: &PartialState<World>) -> bool {
        held_target_in_air(m, from, to).is_some() || (may_carry_along(m, from, to) && asks_for_group(from, to, ARM))
    }

    fn propagate(
        &self,
        m: &World,
        from: &WorldState,
        to: &PartialState<World>,
        rng: &mut dyn Rng,
    ) -> Result<Instances<World>, Infeasible> {
        if let Some(pose) = held_target_in_air(m, from, to) {
            return transfer(m, from, pose, rng);
        }
        let target = to.robot_overlay(m, &from.robot);
        let mut chain = Chain::at(from);
        arm_to(m, &mut chain, &target.arm, from.mode.gap_m());
        chain.finish()
    }
}
