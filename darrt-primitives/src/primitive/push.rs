//! Push: the gripper touches the rim of a round object with two fingers and pushes it along the ray through its centre (paper section 5.1, figure 1).

use darrt_core::partial::PartialState;
use darrt_core::primitive::{Infeasible, Instances, Primitive, PrimitiveId};
use rand::Rng;

use crate::action::approach::to_push_m;
use crate::action::push::push;
use crate::manipulator::Manipulator;
use crate::tabletop::{Tabletop, TabletopState};
use crate::target_query::{asks_to_push, random_unmet_object, unmet_objects};

/// Push: the gripper touches the rim of a round object with two fingers and pushes it along the ray through its centre (paper section 5.1, figure 1).
#[derive(Debug, Clone, Copy, Default)]
pub struct Push;

impl<M: Manipulator> Primitive<Tabletop<M>> for Push {
    fn id(&self) -> PrimitiveId {
        super::PUSH
    }

    fn useful(&self, m: &Tabletop<M>, from: &TabletopState<M>, to: &PartialState<Tabletop<M>>) -> bool {
        from.mode.held().is_none()
            && unmet_objects(m, from, to, |id, pose| asks_to_push(m, from, id, pose)).next().is_some()
    }

    /// To the contact behind the nearest of the objects, wherever the push of one may end.
    fn approach(&self, m: &Tabletop<M>, from: &TabletopState<M>, to: &PartialState<Tabletop<M>>) -> Option<f64> {
        if from.mode.held().is_some() {
            return None;
        }
        let wanted = unmet_objects(m, from, to, |id, pose| asks_to_push(m, from, id, pose));
        wanted.map(|(id, target)| to_push_m(m, from, id, target)).min_by(f64::total_cmp)
    }

    fn propagate(
        &self,
        m: &Tabletop<M>,
        from: &TabletopState<M>,
        to: &PartialState<Tabletop<M>>,
        rng: &mut dyn Rng,
    ) -> Result<Instances<Tabletop<M>>, Infeasible> {
        let wanted = random_unmet_object(m, from, to, |id, pose: &_| asks_to_push(m, from, id, pose), rng);
        let (object, target) = wanted.ok_or(Infeasible::NoProgress)?;
        push(m, from, object, target, rng)
    }
}
