//! Pick: in a valid grasp pose the object is attached to the gripper and lifted in a straight line (paper section 5.1).

use darrt_core::partial::PartialState;
use darrt_core::primitive::{Infeasible, Instances, Primitive};
use darrt_primitives::action::approach::to_grasp_m;
use darrt_primitives::action::label;
use darrt_primitives::action::pick::pick;
use darrt_primitives::wish::{asks_to_pick, random_unmet_object, unmet_objects};
use rand::Rng;

use crate::world::{World, WorldState};

/// Pick: in a valid grasp pose the object is attached to the gripper and lifted in a straight line (paper section 5.1).
#[derive(Debug, Clone, Copy, Default)]
pub struct Pick;

impl Primitive<World> for Pick {
    fn name(&self) -> &'static str {
        label::PICK
    }

    fn useful(&self, m: &World, from: &WorldState, to: &PartialState<World>) -> bool {
        from.mode.held().is_none() && unmet_objects(m, from, to, |id, _| asks_to_pick(m, from, id)).next().is_some()
    }

    /// To the nearest of the grasps, or very far where none fits: what lies in the middle of a table must be pushed first.
    fn approach(&self, m: &World, from: &WorldState, to: &PartialState<World>) -> Option<f64> {
        if from.mode.held().is_some() {
            return None;
        }
        let wanted = unmet_objects(m, from, to, |id, _| asks_to_pick(m, from, id));
        wanted.map(|(id, _)| to_grasp_m(m, from, id)).min_by(f64::total_cmp)
    }

    fn propagate(
        &self,
        m: &World,
        from: &WorldState,
        to: &PartialState<World>,
        rng: &mut dyn Rng,
    ) -> Result<Instances<World>, Infeasible> {
        let wanted = random_unmet_object(m, from, to, |id, _: &_| asks_to_pick(m, from, id), rng);
        let (object, _) = wanted.ok_or(Infeasible::NoProgress)?;
        pick(m, from, object, rng)
    }
}
