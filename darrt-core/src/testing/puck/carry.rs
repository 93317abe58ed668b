//! Carry: robot and held puck move as one rigid body ("rigid-transfer" of paper section 3).

use rand::Rng;

use super::pick::change_grip;
use super::plane;
use super::world::{Grip, Point, PuckWorld};
use crate::domain::Domain;
use crate::motion::{Instance, Waypoints};
use crate::partial::PartialState;
use crate::primitive::{Infeasible, Instances, Primitive, PrimitiveId};
use crate::space::ComponentSpace;
use crate::state::{ComponentId, ComponentSet, ObjectId, State};

/// Useful when the held puck is not where it should be; or when it may be anywhere, and the robot is not
/// where it should be. A puck that reaches its target is let go there: a target has no mode, so nothing
/// else would ask for it.
#[derive(Debug, Clone, Copy, Default)]
pub struct Carry;

impl Primitive<PuckWorld> for Carry {
    fn id(&self) -> PrimitiveId {
        PrimitiveId::new(3, "Carry")
    }

    fn useful(&self, m: &PuckWorld, from: &State<PuckWorld>, to: &PartialState<PuckWorld>) -> bool {
        let Some((id, _)) = from.mode.held() else { return false };
        match to.object(id) {
            Some(_) => !to.is_object_met(m, from, id),
            None => to.are_objects_met(m, from) && !to.is_robot_met(m, from),
        }
    }

    fn propagate(
        &self,
        m: &PuckWorld,
        from: &State<PuckWorld>,
        to: &PartialState<PuckWorld>,
        _: &mut dyn Rng,
    ) -> Result<Instances<PuckWorld>, Infeasible> {
        let (id, offset) = from.mode.held().ok_or(Infeasible::NoGrasp)?;
        let robot = to.robot_overlay(m, &from.robot);
        let named = to.object(id).map(|target| (plane::subtract(target, &offset), *target));
        let (robot, puck) = named.unwrap_or((robot, plane::add(&robot, &offset)));
        let puck_fits = m.objects().get(id.index()).is_some_and(|space| space.contains(&puck));
        if !m.robot().contains(&robot) || !puck_fits {
            return Err(Infeasible::Limits);
        }
        let (carried, end) = carry(from, id, robot, puck).ok_or(Infeasible::Limits)?;
        let released = to.object(id).and_then(|_| change_grip(super::Place.id(), &end, id, Grip::Resting));
        Ok(std::iter::once(carried).chain(released).collect())
    }
}

/// The instance, and the state that it ends in.
fn carry(
    from: &State<PuckWorld>,
    id: ObjectId,
    robot: Point,
    puck: Point,
) -> Option<(Instance<PuckWorld>, State<PuckWorld>)> {
    let mut end = State { robot, ..from.clone() };
    let slot = end.objects.get_mut(id.index())?;
    // Both lines are equally long but for rounding.
    let length = plane::distance(&from.robot, &robot).max(plane::distance(slot, &puck));
    *slot = puck;
    let motion = Waypoints::new(vec![from.clone(), end.clone()], &[length], from.mode.clone())?;
    let instance = Instance {
        primitive: PrimitiveId::new(3, "Carry"),
        motion: Box::new(motion),
        contacts: ComponentSet::EMPTY.with(ComponentId::Object(id)),
        moves: ComponentSet::ROBOT.with(ComponentId::Object(id)),
        object: Some(id),
        reversible: true,
    };
    Some((instance, end))
}
