//! Base-Transit: the base moves towards a goal pose (paper section 5.1).

use darrt_core::partial::PartialState;
use darrt_core::primitive::{Infeasible, Instances, Primitive};
use darrt_primitives::action::travel::base_to;
use darrt_primitives::action::{Chain, label};
use darrt_primitives::arm_space::BASE;
use darrt_primitives::wish::asks_for_group;
use rand::Rng;

use crate::world::{World, WorldState};

/// Base-Transit: the base moves towards a goal pose (paper section 5.1).
#[derive(Debug, Clone, Copy, Default)]
pub struct BaseTransit;

impl Primitive<World> for BaseTransit {
    fn name(&self) -> &'static str {
        label::BASE_TRANSIT
    }

    fn useful(&self, m: &World, from: &WorldState, to: &PartialState<World>) -> bool {
        from.mode.is_hand_free() && to.are_objects_met(m, from) && asks_for_group(from, to, BASE)
    }

    fn propagate(
        &self,
        m: &World,
        from: &WorldState,
        to: &PartialState<World>,
        rng: &mut dyn Rng,
    ) -> Result<Instances<World>, Infeasible> {
        let _ = rng;
        let target = to.robot_overlay(m, &from.robot);
        let mut chain = Chain::at(from);
        base_to(m, &mut chain, &target.base, m.settings().travel_gap_m);
        chain.finish()
    }
}
