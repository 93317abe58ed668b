//! Arm-Rigid-Transfer: the arm moves an attached object towards a goal pose, in straight lines in joint space (paper section 5.1).

use darrt_core::partial::PartialState;
use darrt_core::primitive::{Infeasible, Instances, Primitive};
use darrt_primitives::action::label;
use darrt_primitives::action::transfer::transfer;
use darrt_primitives::arm_space::ARM;
use darrt_primitives::wish::held_target_in_air;
use rand::Rng;

use crate::one_group::{asks_for_transfer, move_group};
use crate::world::{World, WorldState};

/// Arm-Rigid-Transfer: the arm moves an attached object towards a goal pose, in straight lines in joint space (paper section 5.1).
#[derive(Debug, Clone, Copy, Default)]
pub struct ArmRigidTransfer;

impl Primitive<World> for ArmRigidTransfer {
    fn name(&self) -> &'static str {
        label::ARM_RIGID_TRANSFER
    }

    fn useful(&self, m: &World, from: &WorldState, to: &PartialState<World>) -> bool {
        asks_for_transfer(m, from, to, ARM)
    }

    fn propagate(
        &self,
        m: &World,
        from: &WorldState,
        to: &PartialState<World>,
        rng: &mut dyn Rng,
    ) -> Result<Instances<World>, Infeasible> {
        match held_target_in_air(m, from, to) {
            Some(pose) => transfer(m, from, pose, rng),
            None => move_group(m, from, to, ARM, from.mode.gap_m()),
        }
    }
}
