//! Arm-Rigid-Transfer: the arm moves an attached object towards a goal pose, in straight lines in joint space (paper section 5.1).

use darrt_core::partial::PartialState;
use darrt_core::primitive::{Infeasible, Instances, Primitive, PrimitiveId};
use rand::Rng;

use super::joint_group::{asks_for_transfer, move_group};
use crate::action::transfer::transfer;
use crate::manipulator::Manipulator;
use crate::mobile_arm_space::ARM;
use crate::tabletop::{Tabletop, TabletopState};
use crate::target_query::{held_target_in_air, named_base};

/// Arm-Rigid-Transfer: the arm moves an attached object towards a goal pose, in straight lines in joint space (paper section 5.1).
#[derive(Debug, Clone, Copy, Default)]
pub struct ArmRigidTransfer;

impl<M: Manipulator> Primitive<Tabletop<M>> for ArmRigidTransfer {
    fn id(&self) -> PrimitiveId {
        super::ARM_RIGID_TRANSFER
    }

    fn useful(&self, m: &Tabletop<M>, from: &TabletopState<M>, to: &PartialState<Tabletop<M>>) -> bool {
        asks_for_transfer(m, from, to, ARM)
    }

    fn propagate(
        &self,
        m: &Tabletop<M>,
        from: &TabletopState<M>,
        to: &PartialState<Tabletop<M>>,
        rng: &mut dyn Rng,
    ) -> Result<Instances<Tabletop<M>>, Infeasible> {
        match held_target_in_air(m, from, to) {
            // A base that the target names is where it shall be when the object is.
            Some(pose) => transfer(m, from, pose, named_base(to), rng),
            None => move_group(m, from, to, ARM, from.mode.gap_m()),
        }
    }
}
