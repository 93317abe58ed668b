//! Place: the object in the gripper is set down on a support surface in a straight line and detached (paper section 5.1).

use darrt_core::partial::PartialState;
use darrt_core::primitive::{Infeasible, Instances, Primitive, PrimitiveId};
use rand::Rng;

use crate::action::place::place;
use crate::manipulator::Manipulator;
use crate::tabletop::{Tabletop, TabletopState};
use crate::target_query::{asks_for_empty_hand, held_target_on_surface, random_standing_pose};

/// Place: the object in the gripper is set down on a support surface in a straight line and detached (paper section 5.1).
#[derive(Debug, Clone, Copy, Default)]
pub struct Place;

impl<M: Manipulator> Primitive<Tabletop<M>> for Place {
    fn id(&self) -> PrimitiveId {
        super::PLACE
    }

    fn useful(&self, m: &Tabletop<M>, from: &TabletopState<M>, to: &PartialState<Tabletop<M>>) -> bool {
        !to.is_met(m, from) && (held_target_on_surface(m, from, to).is_some() || asks_for_empty_hand(m, from, to))
    }

    fn propagate(
        &self,
        m: &Tabletop<M>,
        from: &TabletopState<M>,
        to: &PartialState<Tabletop<M>>,
        rng: &mut dyn Rng,
    ) -> Result<Instances<Tabletop<M>>, Infeasible> {
        if let Some(pose) = held_target_on_surface(m, from, to) {
            return place(m, from, pose, rng);
        }
        let held = from.mode.held().ok_or(Infeasible::NoGrasp)?;
        let anywhere = random_standing_pose(m, held.object, rng).ok_or(Infeasible::OffSupport)?;
        place(m, from, &anywhere, rng)
    }
}
