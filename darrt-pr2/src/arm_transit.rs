//! Arm-Transit: the arm moves towards a joint goal in a straight line in joint space (paper section 5.1).

use darrt_core::partial::PartialState;
use darrt_core::primitive::{Infeasible, Instances, Primitive};
use darrt_primitives::action::label;
use darrt_primitives::arm_space::ARM;
use rand::Rng;

use crate::one_group::{asks_for_transit, move_group};
use crate::world::{World, WorldState};

/// Arm-Transit: the arm moves towards a joint goal in a straight line in joint space (paper section 5.1).
#[derive(Debug, Clone, Copy, Default)]
pub struct ArmTransit;

impl Primitive<World> for ArmTransit {
    fn name(&self) -> &'static str {
        label::ARM_TRANSIT
    }

    fn useful(&self, m: &World, from: &WorldState, to: &PartialState<World>) -> bool {
        asks_for_transit(m, from, to, ARM)
    }

    fn propagate(
        &self,
        m: &World,
        from: &WorldState,
        to: &PartialState<World>,
        _: &mut dyn Rng,
    ) -> Result<Instances<World>, Infeasible> {
        move_group(m, from, to, ARM, m.settings().travel_gap_m)
    }
}
