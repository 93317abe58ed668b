//! Base-Rigid-Transfer: the base moves an attached object towards a goal pose (paper section 5.1).

use darrt_core::partial::PartialState;
use darrt_core::primitive::{Infeasible, Instances, Primitive};
use darrt_primitives::action::transfer::transfer_by_base;
use darrt_primitives::action::travel::base_to;
use darrt_primitives::action::{Chain, label};
use darrt_primitives::arm_space::BASE;
use darrt_primitives::wish::{asks_for_group, held_target_in_air, may_carry_along};
use rand::Rng;

use crate::world::{World, WorldState};

/// Base-Rigid-Transfer: the base moves an attached object towards a goal pose (paper section 5.1).
#[derive(Debug, Clone, Copy, Default)]
pub struct BaseRigidTransfer;

impl Primitive<World> for BaseRigidTransfer {
    fn name(&self) -> &'static str {
        label::BASE_RIGID_TRANSFER
    }

    fn useful(&self, m: &World, from: &WorldState, to: &PartialState<World>) -> bool {
        held_target_in_air(m, from, to).is_some() || (may_carry_along(m, from, to) && asks_for_group(from, to, BASE))
    }

    fn propagate(
        &self,
        m: &World,
        from: &WorldState,
        to: &PartialState<World>,
        rng: &mut dyn Rng,
    ) -> Result<Instances<World>, Infeasible> {
        if let Some(pose) = held_target_in_air(m, from, to) {
            return transfer_by_base(m, from, pose, rng);
        }
        let target = to.robot_overlay(m, &from.robot);
        let mut chain = Chain::at(from);
        base_to(m, &mut chain, &target.base, from.mode.gap_m());
        chain.finish()
    }
}
