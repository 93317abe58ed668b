//! Arm-Transit: the arm moves towards a joint goal in a straight line in joint space (paper section 5.1).

use darrt_core::partial::PartialState;
use darrt_core::primitive::{Infeasible, Instances, Primitive, PrimitiveId};
use rand::Rng;

use super::joint_group::{asks_for_transit, move_group};
use crate::manipulator::Manipulator;
use crate::mobile_arm_space::ARM;
use crate::tabletop::{Tabletop, TabletopState};

/// Arm-Transit: the arm moves towards a joint goal in a straight line in joint space (paper section 5.1).
#[derive(Debug, Clone, Copy, Default)]
pub struct ArmTransit;

impl<M: Manipulator> Primitive<Tabletop<M>> for ArmTransit {
    fn id(&self) -> PrimitiveId {
        super::ARM_TRANSIT
    }

    fn useful(&self, m: &Tabletop<M>, from: &TabletopState<M>, to: &PartialState<Tabletop<M>>) -> bool {
        asks_for_transit(m, from, to, ARM)
    }

    fn propagate(
        &self,
        m: &Tabletop<M>,
        from: &TabletopState<M>,
        to: &PartialState<Tabletop<M>>,
        _: &mut dyn Rng,
    ) -> Result<Instances<Tabletop<M>>, Infeasible> {
        move_group(m, from, to, ARM, m.settings().travel_gap_m)
    }
}
