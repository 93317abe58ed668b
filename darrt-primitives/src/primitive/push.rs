//! Push: the gripper touches the rim of a round object with two fingers and pushes it along the ray through its centre (paper section 5.1, figure 1).

use darrt_core::partial::PartialState;
use darrt_core::primitive::{Infeasible, Instances, Primitive, PrimitiveId};
use rand::Rng;

use crate::action::approach::to_push_m;
use crate::action::push::push;
use crate::manipulator::Manipulator;
use crate::tabletop::{Tabletop, TabletopState};
use crate::target_query::{object_to_push, objects_to_push};

/// Push: the gripper touches the rim of a round object with two fingers and pushes it along the ray through its centre (paper section 5.1, figure 1).
#[derive(Debug, Clone, Copy, Default)]
pub struct Push;

impl<M: Manipulator> Primitive<Tabletop<M>> for Push {
    fn id(&self) -> PrimitiveId {
        super::PUSH
    }

    fn useful(&self, m: &Tabletop<M>, from: &TabletopState<M>, to: &PartialState<Tabletop<M>>) -> bool {
        objects_to_push(m, from, to).next().is_some()
    }

    /// To the contact behind the nearest of the objects, wherever the push of one may end.
    fn approach(&self, m: &Tabletop<M>, from: &TabletopState<M>, to: &PartialState<Tabletop<M>>) -> Option<f64> {
        objects_to_push(m, from, to).map(|(id, target)| to_push_m(m, from, id, target)).min_by(f64::total_cmp)
    }

    fn propagate(
        &self,
        m: &Tabletop<M>,
        from: &TabletopState<M>,
        to: &PartialState<Tabletop<M>>,
        rng: &mut dyn Rng,
    ) -> Result<Instances<Tabletop<M>>, Infeasible> {
        let (object, target) = object_to_push(m, from, to, rng)?;
        push(m, from, object, target, rng)
    }
}
