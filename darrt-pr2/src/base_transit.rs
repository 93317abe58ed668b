//! Base-Transit: the base moves towards a goal pose (paper section 5.1).

use darrt_core::partial::PartialState;
use darrt_core::primitive::{Infeasible, Instances, Primitive};
use darrt_primitives::action::label;
use darrt_primitives::arm_space::BASE;
use rand::Rng;

use crate::one_group::{asks_for_transit, move_group};
use crate::world::{World, WorldState};

/// Base-Transit: the base moves towards a goal pose (paper section 5.1).
#[derive(Debug, Clone, Copy, Default)]
pub struct BaseTransit;

impl Primitive<World> for BaseTransit {
    fn name(&self) -> &'static str {
        label::BASE_TRANSIT
    }

    fn useful(&self, m: &World, from: &WorldState, to: &PartialState<World>) -> bool {
        asks_for_transit(m, from, to, BASE)
    }

    fn propagate(
        &self,
        m: &World,
        from: &WorldState,
        to: &PartialState<World>,
        _: &mut dyn Rng,
    ) -> Result<Instances<World>, Infeasible> {
        move_group(m, from, to, BASE, m.settings().travel_gap_m)
    }
}
