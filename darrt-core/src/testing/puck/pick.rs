//! Pick: the robot grabs a graspable puck at its rim, from a random side.

use rand::{Rng, RngExt};

use super::approach::approach;
use super::plane;
use super::world::{Grip, PuckWorld};
use crate::domain::Domain;
use crate::motion::{Instance, Waypoints};
use crate::partial::PartialState;
use crate::primitive::{Infeasible, Instances, Primitive, PrimitiveId};
use crate::space::ComponentSpace;
use crate::state::{ComponentId, ComponentSet, ObjectId, State};

/// Useful when the robot holds nothing and some named graspable puck is not where it should be.
/// Propagating gives the transit to the rim, and the change of mode.
#[derive(Debug, Clone, Copy, Default)]
pub struct Pick;

impl Primitive<PuckWorld> for Pick {
    fn id(&self) -> PrimitiveId {
        PrimitiveId::new(1, "Pick")
    }

    fn useful(&self, m: &PuckWorld, from: &State<PuckWorld>, to: &PartialState<PuckWorld>) -> bool {
        from.mode.held().is_none() && candidates(m, from, to).next().is_some()
    }

    fn propagate(
        &self,
        m: &PuckWorld,
        from: &State<PuckWorld>,
        to: &PartialState<PuckWorld>,
        rng: &mut dyn Rng,
    ) -> Result<Instances<PuckWorld>, Infeasible> {
        let open: Vec<_> = candidates(m, from, to).collect();
        let id = *open.get(rng.random_range(0..open.len().max(1))).ok_or(Infeasible::NoGrasp)?;
        let at = from.object(id).ok_or(Infeasible::NoGrasp)?;
        let angle: f64 = rng.random_range(0.0..std::f64::consts::TAU);
        let contact = plane::along(at, &[angle.cos(), angle.sin()], m.touch_distance(id));
        if !m.robot().contains(&contact) {
            return Err(Infeasible::NoGrasp);
        }
        let (transit, touching) = approach(m, from, id, contact).ok_or(Infeasible::NoGrasp)?;
        let held = Grip::Held { offset: plane::subtract(at, &contact) };
        Ok(vec![transit, change_grip(self.id(), &touching, id, held).ok_or(Infeasible::NoGrasp)?])
    }
}

/// The graspable pucks that `to` wants somewhere else.
fn candidates<'a>(
    m: &'a PuckWorld,
    from: &'a State<PuckWorld>,
    to: &'a PartialState<PuckWorld>,
) -> impl Iterator<Item = ObjectId> {
    let open = to.objects().map(|(id, _)| id).filter(|id| !to.is_object_met(m, from, *id));
    open.filter(|id| m.puck(*id).is_some_and(|p| p.is_graspable))
}

/// An instance of no length that changes nothing but the grip on `id`; the robot touches it before or after.
pub(super) fn change_grip(
    primitive: PrimitiveId,
    from: &State<PuckWorld>,
    id: ObjectId,
    grip: Grip,
) -> Option<Instance<PuckWorld>> {
    let touching = matches!(grip, Grip::Resting).then_some(id);
    let mode = from.mode.with_grip(id, grip).touching(touching);
    let end = State { mode, ..from.clone() };
    Some(Instance {
        primitive,
        motion: Box::new(Waypoints::new(vec![from.clone(), end], &[0.0], from.mode.clone())?),
        contacts: ComponentSet::EMPTY.with(ComponentId::Object(id)),
        moves: ComponentSet::EMPTY,
        object: Some(id),
        reversible: true,
    })
}
