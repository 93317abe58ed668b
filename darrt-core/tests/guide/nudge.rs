//! Nudge: push a puck towards its target, but by no more than one stroke.

use darrt_core::motion::Waypoints;
use darrt_core::prelude::*;
use darrt_core::testing::puck::PuckWorld;
use darrt_core::testing::puck::approach::approach;
use rand::Rng;

/// Metres that a puck is moved at most.
const STROKE_M: f64 = 0.25;

pub struct Nudge;

impl Primitive<PuckWorld> for Nudge {
    fn id(&self) -> PrimitiveId {
        PrimitiveId::new(9, "Nudge")
    }

    fn useful(&self, m: &PuckWorld, from: &State<PuckWorld>, to: &PartialState<PuckWorld>) -> bool {
        from.mode.held().is_none() && !to.are_objects_met(m, from)
    }

    fn propagate(
        &self,
        m: &PuckWorld,
        from: &State<PuckWorld>,
        to: &PartialState<PuckWorld>,
        _: &mut dyn Rng,
    ) -> Result<Instances<PuckWorld>, Infeasible> {
        // The first puck that is not where it should be, and the way it has to go.
        let open = to.objects().find(|(id, _)| !to.is_object_met(m, from, *id));
        let (id, target) = open.ok_or(Infeasible::NoProgress)?;
        let at = *from.object(id).ok_or(Infeasible::NoContact)?;
        let metres = (target[0] - at[0]).hypot(target[1] - at[1]);
        let along = |p: &[f64; 2], s: f64| [0, 1].map(|i| p[i] + s * (target[i] - at[i]) / metres);
        let stroke = metres.min(STROKE_M);
        // The robot goes to the far side of the puck, and then both move by the stroke.
        let contact = along(&at, -m.touch_distance(id));
        if !m.robot().contains(&contact) {
            return Err(Infeasible::NoContact);
        }
        let (transit, touching) = approach(m, from, id, contact).ok_or(Infeasible::NoContact)?;
        let mut end = State { robot: along(&contact, stroke), ..touching.clone() };
        *end.objects.get_mut(id.index()).ok_or(Infeasible::NoContact)? = along(&at, stroke);
        let mode = touching.mode.clone();
        let nudge = Instance {
            primitive: self.id(),
            motion: Box::new(Waypoints::new(vec![touching, end], &[stroke], mode).ok_or(Infeasible::NoProgress)?),
            contacts: ComponentSet::EMPTY.with(ComponentId::Object(id)),
            moves: ComponentSet::ROBOT.with(ComponentId::Object(id)),
            object: Some(id),
            reversible: false,
        };
        Ok(vec![transit, nudge])
    }
}
