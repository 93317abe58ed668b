//! Push: the robot drives a puck along the ray from the contact through the puck's centre.

use rand::{Rng, RngExt};

use super::approach::approach;
use super::plane;
use super::world::{Point, PuckWorld};
use crate::domain::Domain;
use crate::motion::{Instance, Waypoints};
use crate::partial::PartialState;
use crate::primitive::{Infeasible, Instances, Primitive, PrimitiveId};
use crate::space::ComponentSpace;
use crate::state::{ComponentId, ComponentSet, ObjectId, State};

/// Useful when the robot holds nothing and some named puck is not where it should be. Propagating gives
/// the transit to the contact opposite to the target, and the push (paper section 4.1).
#[derive(Debug, Clone, Copy, Default)]
pub struct Push;

impl Primitive<PuckWorld> for Push {
    fn id(&self) -> PrimitiveId {
        PrimitiveId::new(4, "Push")
    }

    fn useful(&self, m: &PuckWorld, from: &State<PuckWorld>, to: &PartialState<PuckWorld>) -> bool {
        from.mode.held().is_none() && !to.are_objects_met(m, from)
    }

    fn approach(&self, m: &PuckWorld, from: &State<PuckWorld>, to: &PartialState<PuckWorld>) -> Option<f64> {
        let open = to.objects().filter(|(id, _)| !to.is_object_met(m, from, *id));
        let contacts = open.filter_map(|(id, target)| contact(m, from, id, target));
        contacts.map(|contact| plane::distance(&from.robot, &contact)).min_by(f64::total_cmp)
    }

    fn propagate(
        &self,
        m: &PuckWorld,
        from: &State<PuckWorld>,
        to: &PartialState<PuckWorld>,
        rng: &mut dyn Rng,
    ) -> Result<Instances<PuckWorld>, Infeasible> {
        let open: Vec<_> = to.objects().filter(|(id, _)| !to.is_object_met(m, from, *id)).collect();
        let (id, target) = *open.get(rng.random_range(0..open.len().max(1))).ok_or(Infeasible::NoProgress)?;
        from.object(id).ok_or(Infeasible::NoContact)?;
        let contact = contact(m, from, id, target).ok_or(Infeasible::NoProgress)?;
        if !m.robot().contains(&contact) {
            return Err(Infeasible::NoContact);
        }
        if !m.objects().get(id.index()).is_some_and(|floor| floor.contains(target)) {
            return Err(Infeasible::OffSupport);
        }
        let (transit, touching) = approach(m, from, id, contact).ok_or(Infeasible::NoContact)?;
        Ok(vec![transit, push(m, &touching, id, *target).ok_or(Infeasible::NoProgress)?])
    }
}

/// Where the robot stands to push a puck straight to `target`.
fn contact(m: &PuckWorld, from: &State<PuckWorld>, id: ObjectId, target: &Point) -> Option<Point> {
    let at = from.object(id)?;
    Some(plane::along(at, &plane::direction(at, target)?, -m.touch_distance(id)))
}

/// Moves the touched puck to `target`; the robot follows at the distance of the contact.
fn push(m: &PuckWorld, touching: &State<PuckWorld>, id: ObjectId, target: Point) -> Option<Instance<PuckWorld>> {
    let at = touching.object(id)?;
    let mut end = touching.clone();
    *end.objects.get_mut(id.index())? = target;
    end.robot = plane::along(&target, &plane::direction(at, &target)?, -m.touch_distance(id));
    let length = plane::distance(at, &target).max(plane::distance(&touching.robot, &end.robot));
    let mode = touching.mode.clone();
    Some(Instance {
        primitive: PrimitiveId::new(4, "Push"),
        motion: Box::new(Waypoints::new(vec![touching.clone(), end], &[length], mode)?),
        contacts: ComponentSet::EMPTY.with(ComponentId::Object(id)),
        moves: ComponentSet::ROBOT.with(ComponentId::Object(id)),
        object: Some(id),
        reversible: false,
    })
}
