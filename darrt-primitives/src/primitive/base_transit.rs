//! Base-Transit: the base moves towards a goal pose (paper section 5.1).

use darrt_core::partial::PartialState;
use darrt_core::primitive::{Infeasible, Instances, Primitive, PrimitiveId};
use rand::Rng;

use super::joint_group::{asks_for_transit, move_group};
use crate::manipulator::Manipulator;
use crate::mobile_arm_space::BASE;
use crate::tabletop::{Tabletop, TabletopState};

/// Base-Transit: the base moves towards a goal pose (paper section 5.1).
#[derive(Debug, Clone, Copy, Default)]
pub struct BaseTransit;

impl<M: Manipulator> Primitive<Tabletop<M>> for BaseTransit {
    fn id(&self) -> PrimitiveId {
        super::BASE_TRANSIT
    }

    fn useful(&self, m: &Tabletop<M>, from: &TabletopState<M>, to: &PartialState<Tabletop<M>>) -> bool {
        asks_for_transit(m, from, to, BASE)
    }

    fn propagate(
        &self,
        m: &Tabletop<M>,
        from: &TabletopState<M>,
        to: &PartialState<Tabletop<M>>,
        _: &mut dyn Rng,
    ) -> Result<Instances<Tabletop<M>>, Infeasible> {
        move_group(m, from, to, BASE, m.settings().travel_gap_m)
    }
}
