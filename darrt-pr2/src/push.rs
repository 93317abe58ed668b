//! Push: the gripper touches the rim of a round object with two fingers and pushes it along the ray through its centre (paper section 5.1, figure 1).

use darrt_core::partial::PartialState;
use darrt_core::primitive::{Infeasible, Instances, Primitive};
use darrt_primitives::action::approach::to_push_m;
use darrt_primitives::action::label;
use darrt_primitives::action::push::push;
use darrt_primitives::wish::{asks_to_push, random_unmet_object, unmet_objects};
use rand::Rng;

use crate::world::{World, WorldState};

/// Push: the gripper touches the rim of a round object with two fingers and pushes it along the ray through its centre (paper section 5.1, figure 1).
#[derive(Debug, Clone, Copy, Default)]
pub struct Push;

impl Primitive<World> for Push {
    fn name(&self) -> &'static str {
        label::PUSH
    }

    fn useful(&self, m: &World, from: &WorldState, to: &PartialState<World>) -> bool {
        from.mode.held().is_none()
            && unmet_objects(m, from, to, |id, pose| asks_to_push(m, from, id, pose)).next().is_some()
    }

    /// To the contact behind the nearest of the objects, wherever the push of one may end.
    fn approach(&self, m: &World, from: &WorldState, to: &PartialState<World>) -> Option<f64> {
        if from.mode.held().is_some() {
            return None;
        }
        let wanted = unmet_objects(m, from, to, |id, pose| asks_to_push(m, from, id, pose));
        wanted.map(|(id, target)| to_push_m(m, from, id, target)).min_by(f64::total_cmp)
    }

    fn propagate(
        &self,
        m: &World,
        from: &WorldState,
        to: &PartialState<World>,
        rng: &mut dyn Rng,
    ) -> Result<Instances<World>, Infeasible> {
        let wanted = random_unmet_object(m, from, to, |id, pose: &_| asks_to_push(m, from, id, pose), rng);
        let (object, target) = wanted.ok_or(Infeasible::NoProgress)?;
        push(m, from, object, target, rng)
    }
}
