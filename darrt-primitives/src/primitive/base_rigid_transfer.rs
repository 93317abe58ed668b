//! Base-Rigid-Transfer: the base moves an attached object towards a goal pose (paper section 5.1).

use darrt_core::partial::PartialState;
use darrt_core::primitive::{Infeasible, Instances, Primitive, PrimitiveId};
use rand::Rng;

use super::joint_group::{asks_for_transfer, move_group};
use crate::action::transfer::transfer_by_base;
use crate::manipulator::Manipulator;
use crate::mobile_arm_space::BASE;
use crate::tabletop::{Tabletop, TabletopState};
use crate::target_query::held_target_in_air;

/// Base-Rigid-Transfer: the base moves an attached object towards a goal pose (paper section 5.1).
#[derive(Debug, Clone, Copy, Default)]
pub struct BaseRigidTransfer;

impl<M: Manipulator> Primitive<Tabletop<M>> for BaseRigidTransfer {
    fn id(&self) -> PrimitiveId {
        super::BASE_RIGID_TRANSFER
    }

    fn useful(&self, m: &Tabletop<M>, from: &TabletopState<M>, to: &PartialState<Tabletop<M>>) -> bool {
        asks_for_transfer(m, from, to, BASE)
    }

    fn propagate(
        &self,
        m: &Tabletop<M>,
        from: &TabletopState<M>,
        to: &PartialState<Tabletop<M>>,
        rng: &mut dyn Rng,
    ) -> Result<Instances<Tabletop<M>>, Infeasible> {
        match held_target_in_air(m, from, to) {
            Some(pose) => transfer_by_base(m, from, pose, rng),
            None => move_group(m, from, to, BASE, from.mode.gap_m()),
        }
    }
}
