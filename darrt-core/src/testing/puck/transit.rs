//! Transit: the robot alone, on a straight line.

use rand::Rng;

use super::clearance::CLEARANCE_M;
use super::plane;
use super::world::{Point, PuckWorld};
use crate::motion::{Instance, Waypoints};
use crate::partial::PartialState;
use crate::primitive::{Infeasible, Instances, Primitive, PrimitiveId};
use crate::state::{ComponentId, ComponentSet, ObjectId, State};

/// Useful when all named pucks are where they should be and the robot, which holds nothing, is not
/// (paper section 4.1).
#[derive(Debug, Clone, Copy, Default)]
pub struct Transit;

impl Primitive<PuckWorld> for Transit {
    fn id(&self) -> PrimitiveId {
        PrimitiveId::new(0, "Transit")
    }

    fn useful(&self, m: &PuckWorld, from: &State<PuckWorld>, to: &PartialState<PuckWorld>) -> bool {
        from.mode.held().is_none() && to.are_objects_met(m, from) && !to.is_robot_met(m, from)
    }

    fn propagate(
        &self,
        m: &PuckWorld,
        from: &State<PuckWorld>,
        to: &PartialState<PuckWorld>,
        _: &mut dyn Rng,
    ) -> Result<Instances<PuckWorld>, Infeasible> {
        let target = to.robot_overlay(m, &from.robot);
        Ok(vec![drive(m, from, &[], target, None).ok_or(Infeasible::Limits)?.0])
    }
}

/// The robot along the points of `via` to `target`, there to touch `approached`, if any. Returns the
/// instance and the state that it ends in; `None` for a target that is not finite.
pub fn drive(
    m: &PuckWorld,
    from: &State<PuckWorld>,
    via: &[Point],
    target: Point,
    approached: Option<ObjectId>,
) -> Option<(Instance<PuckWorld>, State<PuckWorld>)> {
    let mut states = vec![from.clone()];
    let on_the_way = from.mode.touching(None);
    states.extend(via.iter().map(|at| State { robot: *at, mode: on_the_way.clone(), ..from.clone() }));
    let end = State { robot: target, mode: from.mode.touching(approached), ..from.clone() };
    states.push(end.clone());
    let segments: Vec<f64> =
        states.windows(2).map(|segment| plane::distance(&segment[0].robot, &segment[1].robot)).collect();
    // It may leave what it touches now.
    let touched = m.ids().filter(|id| Some(*id) == approached || m.gap(from, *id) < CLEARANCE_M);
    let instance = Instance {
        primitive: PrimitiveId::new(0, "Transit"),
        contacts: touched.fold(ComponentSet::EMPTY, |set, id| set.with(ComponentId::Object(id))),
        motion: Box::new(Waypoints::new(states, &segments, on_the_way)?),
        moves: ComponentSet::ROBOT,
        object: approached,
        reversible: true,
    };
    Some((instance, end))
}
