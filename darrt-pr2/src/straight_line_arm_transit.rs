//! Straight-Line-Arm-Transit: the arm moves the gripper in a straight line, here to retreat from an object; Push, Pick and Place use it to approach (paper section 5.1).

use darrt_core::partial::PartialState;
use darrt_core::primitive::{Infeasible, Instances, Primitive};
use darrt_primitives::action::retreat::retreat;
use darrt_primitives::action::{Chain, label};
use rand::Rng;

use crate::world::{World, WorldState};

/// Straight-Line-Arm-Transit: the arm moves the gripper in a straight line, here to retreat from an object; Push, Pick and Place use it to approach (paper section 5.1).
#[derive(Debug, Clone, Copy, Default)]
pub struct StraightLineArmTransit;

impl Primitive<World> for StraightLineArmTransit {
    fn name(&self) -> &'static str {
        label::STRAIGHT_LINE_ARM_TRANSIT
    }

    fn useful(&self, m: &World, from: &WorldState, to: &PartialState<World>) -> bool {
        from.mode.engaged().is_some() && !to.is_met(m, from)
    }

    fn propagate(
        &self,
        m: &World,
        from: &WorldState,
        to: &PartialState<World>,
        rng: &mut dyn Rng,
    ) -> Result<Instances<World>, Infeasible> {
        let _ = (to, rng);
        let mut chain = Chain::at(from);
        retreat(m, &mut chain, m.settings().retreat_m)?;
        chain.finish()
    }
}
