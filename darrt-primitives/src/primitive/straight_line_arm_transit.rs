//! Straight-Line-Arm-Transit: the arm moves the gripper in a straight line, here to retreat from an object; Push, Pick and Place use it to approach (paper section 5.1).

use darrt_core::partial::PartialState;
use darrt_core::primitive::{Infeasible, Instances, Primitive, PrimitiveId};
use rand::Rng;

use crate::action::Chain;
use crate::action::retreat::retreat;
use crate::manipulator::Manipulator;
use crate::tabletop::{Tabletop, TabletopState};

/// Straight-Line-Arm-Transit: the arm moves the gripper in a straight line, here to retreat from an object; Push, Pick and Place use it to approach (paper section 5.1).
#[derive(Debug, Clone, Copy, Default)]
pub struct StraightLineArmTransit;

impl<M: Manipulator> Primitive<Tabletop<M>> for StraightLineArmTransit {
    fn id(&self) -> PrimitiveId {
        super::STRAIGHT_LINE_ARM_TRANSIT
    }

    fn useful(&self, m: &Tabletop<M>, from: &TabletopState<M>, to: &PartialState<Tabletop<M>>) -> bool {
        from.mode.engaged().is_some() && !to.is_met(m, from)
    }

    fn propagate(
        &self,
        m: &Tabletop<M>,
        from: &TabletopState<M>,
        to: &PartialState<Tabletop<M>>,
        rng: &mut dyn Rng,
    ) -> Result<Instances<Tabletop<M>>, Infeasible> {
        let _ = (to, rng);
        let mut chain = Chain::at(from);
        retreat(m, &mut chain, m.settings().retreat_m)?;
        chain.finish()
    }
}
