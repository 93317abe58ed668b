//! Pick: in a valid grasp pose the object is attached to the gripper and lifted in a straight line (paper section 5.1).

use darrt_core::partial::PartialState;
use darrt_core::primitive::{Infeasible, Instances, Primitive, PrimitiveId};
use rand::Rng;

use crate::action::approach::to_grasp_m;
use crate::action::pick::pick;
use crate::manipulator::Manipulator;
use crate::tabletop::{Tabletop, TabletopState};
use crate::target_query::{asks_to_pick, random_unmet_object, unmet_objects};

/// Pick: in a valid grasp pose the object is attached to the gripper and lifted in a straight line (paper section 5.1).
#[derive(Debug, Clone, Copy, Default)]
pub struct Pick;

impl<M: Manipulator> Primitive<Tabletop<M>> for Pick {
    fn id(&self) -> PrimitiveId {
        super::PICK
    }

    fn useful(&self, m: &Tabletop<M>, from: &TabletopState<M>, to: &PartialState<Tabletop<M>>) -> bool {
        from.mode.held().is_none() && unmet_objects(m, from, to, |id, _| asks_to_pick(m, from, id)).next().is_some()
    }

    /// To the nearest of the grasps, or very far where none fits: what lies in the middle of a table must be pushed first.
    fn approach(&self, m: &Tabletop<M>, from: &TabletopState<M>, to: &PartialState<Tabletop<M>>) -> Option<f64> {
        if from.mode.held().is_some() {
            return None;
        }
        let wanted = unmet_objects(m, from, to, |id, _| asks_to_pick(m, from, id));
        wanted.map(|(id, _)| to_grasp_m(m, from, id)).min_by(f64::total_cmp)
    }

    fn propagate(
        &self,
        m: &Tabletop<M>,
        from: &TabletopState<M>,
        to: &PartialState<Tabletop<M>>,
        rng: &mut dyn Rng,
    ) -> Result<Instances<Tabletop<M>>, Infeasible> {
        let wanted = random_unmet_object(m, from, to, |id, _: &_| asks_to_pick(m, from, id), rng);
        let (object, _) = wanted.ok_or(Infeasible::NoProgress)?;
        pick(m, from, object, rng)
    }
}
