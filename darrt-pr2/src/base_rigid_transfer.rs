//! Base-Rigid-Transfer: the base moves an attached object towards a goal pose (paper section 5.1).

use darrt_core::partial::PartialState;
use darrt_core::primitive::{Infeasible, Instances, Primitive};
use darrt_primitives::action::label;
use darrt_primitives::action::transfer::transfer_by_base;
use darrt_primitives::arm_space::BASE;
use darrt_primitives::wish::held_target_in_air;
use rand::Rng;

use crate::one_group::{asks_for_transfer, move_group};
use crate::world::{World, WorldState};

/// Base-Rigid-Transfer: the base moves an attached object towards a goal pose (paper section 5.1).
#[derive(Debug, Clone, Copy, Default)]
pub struct BaseRigidTransfer;

impl Primitive<World> for BaseRigidTransfer {
    fn name(&self) -> &'static str {
        label::BASE_RIGID_TRANSFER
    }

    fn useful(&self, m: &World, from: &WorldState, to: &PartialState<World>) -> bool {
        asks_for_transfer(m, from, to, BASE)
    }

    fn propagate(
        &self,
        m: &World,
        from: &WorldState,
        to: &PartialState<World>,
        rng: &mut dyn Rng,
    ) -> Result<Instances<World>, Infeasible> {
        match held_target_in_air(m, from, to) {
            Some(pose) => transfer_by_base(m, from, pose, rng),
            None => move_group(m, from, to, BASE, from.mode.gap_m()),
        }
    }
}
