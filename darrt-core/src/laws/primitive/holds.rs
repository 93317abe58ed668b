//! Does what is moved stay with what moves it?

use super::{HOLDS, Trial};
use crate::domain::Domain;
use crate::laws::{Broken, at_most};
use crate::motion::Instance;
use crate::state::{ComponentId, ObjectId, State};

/// Where along an instance one looks.
const LOOKS: u32 = 24;
/// How much what is carried may come nearer to the working point, or leave it, metres: soft fingers, and rounding.
const SLIPS_M: f64 = 2e-3;
/// How much farther from the hand than at either end what is moved may be, metres.
const AHEAD_M: f64 = 5e-3;

impl<D: Domain> Trial<'_, '_, D> {
    /// Of what is carried the distance to the working point, if the domain tells points; of what is moved otherwise the reach,
    /// which is not larger in between than at the ends.
    pub(super) fn holds(&self, instance: &Instance<D>, before: &State<D>, after: &State<D>) -> Result<(), Broken> {
        let m = self.m;
        if before.robot == after.robot && instance.object.is_none() {
            return Ok(());
        }
        let first = instance.at(m, 0.5 / f64::from(LOOKS), before);
        let carried = m.carried(&first.mode);
        for id in (0..m.objects().len()).map(ObjectId::new) {
            let component = ComponentId::Object(id);
            if before.object(id) == after.object(id) || !instance.moves.contains(ComponentId::Robot) {
                continue;
            }
            let gap = |state: &State<D>| {
                let (tool, point) = (m.working_point(&state.robot), m.object_point(id, state.object(id)?));
                let is_told = tool != [0.0; 3] && point != [0.0; 3];
                is_told.then(|| tool.iter().zip(point).map(|(x, y)| (x - y).powi(2)).sum::<f64>().sqrt())
            };
            let reach = |state: &State<D>| state.object(id).map(|at| m.reach(&state.robot, id, at));
            let of = |broken: Broken| broken.of(m.component_name(component));
            let ends = [before, after].map(|state| reach(state).unwrap_or(0.0));
            for i in 0..LOOKS {
                let t = (f64::from(i) + 0.5) / f64::from(LOOKS);
                let here = instance.at(m, t, before);
                if carried.contains(component) {
                    if let (Some(was), Some(is)) = (gap(&first), gap(&here)) {
                        at_most(HOLDS, (is - was).abs(), 0.0, SLIPS_M)
                            .map_err(|broken| of(broken.at(t).of("slips, m")))?;
                    }
                } else if let Some(is) = reach(&here).filter(|_| instance.object == Some(id)) {
                    at_most(HOLDS, is, ends[0].max(ends[1]), AHEAD_M)
                        .map_err(|broken| of(broken.at(t).of("away from the hand, m")))?;
                }
            }
        }
        Ok(())
    }
}
