//! Is a distance metres, and not their square, their root or millimetres?

use super::extremes::Trial;
use super::{METRES, RESOLVES};
use crate::domain::Domain;
use crate::laws::feed::{elsewhere as anywhere, moved};
use crate::laws::{Broken, ensure};
use crate::partial::PartialState;
use crate::random::Stream;
use crate::space::ComponentSpace;
use crate::state::{ComponentId, ObjectId, RobotConfig, State};

/// Of the whole distance at least this part is left half-way. A square leaves 0.25.
const LEAST_HALF: f64 = 0.35;
/// What the robot's own space says may be off by this factor: weights differ, but not by a thousand.
const UNIT: f64 = 100.0;
/// How many targets of an object are looked at, and how far from them, in parts of the way to somewhere else.
const PAIRS: usize = 32;
const NEAR: f64 = 3e-3;
/// What an object is farther away makes at least this part of difference on the mean: the robot's way to it may shrink.
const GROWS: f64 = 0.05;

impl<D: Domain> Trial<'_, D> {
    pub(super) fn in_metres(&self, start: &RobotConfig<D>, end: &State<D>, rng: &mut Stream) -> Result<(), Broken> {
        self.of_robot(start, end).map_err(|broken| broken.of(self.m.component_name(ComponentId::Robot)))?;
        for i in 0..self.m.objects().len() {
            let id = ObjectId::new(i);
            self.of_object(id, rng).map_err(|broken| broken.of(self.m.component_name(ComponentId::Object(id))))?;
        }
        Ok(())
    }

    fn of_robot(&self, start: &RobotConfig<D>, end: &State<D>) -> Result<(), Broken> {
        let robot = self.m.robot();
        let own = robot.distance(start, &end.robot);
        if own <= 1e4 * robot.tolerance() {
            return Ok(());
        }
        let to = PartialState::anywhere(self.m).with_robot(self.m, end.robot.clone());
        let at = |t: f64| State { robot: robot.interpolate(start, &end.robot, t), ..self.from.clone() };
        let [whole, half] = [0.0, 0.5].map(|t| (self.d)(&at(t), &to));
        let text = || format!("{whole:?}, and {half:?} half-way");
        ensure(METRES, half >= LEAST_HALF * whole, text, "about half of it half-way")?;
        let is_metres = (1.0 / UNIT..=UNIT).contains(&(whole / own));
        ensure(
            METRES,
            is_metres,
            || format!("{whole:?} for {own:?} m of the robot's space"),
            "as many, within a factor of 100",
        )
    }

    /// Once and twice as far from its target, on the mean over many.
    fn of_object(&self, id: ObjectId, rng: &mut Stream) -> Result<(), Broken> {
        let Some(space) = self.m.objects().get(id.index()) else { return Ok(()) };
        let (mut more, mut metres) = (0.0, 0.0);
        for _ in 0..PAIRS {
            let state = anywhere(self.m, self.from, rng);
            let aim = moved(self.m, &state, ComponentId::Object(id), rng);
            let (Some(there), Some(target)) = (state.object(id), aim.object(id)) else { continue };
            let to = PartialState::anywhere(self.m).with_object(id, target.clone());
            let at = |share: f64| {
                let mut near = state.clone();
                near.objects
                    .iter_mut()
                    .skip(id.index())
                    .take(1)
                    .for_each(|slot| *slot = space.interpolate(target, there, share));
                near
            };
            let (once, twice) = (at(NEAR), at(2.0 * NEAR));
            if to.is_met(self.m, &once) {
                continue;
            }
            more += (self.d)(&twice, &to) - (self.d)(&once, &to);
            if let (Some(p), Some(q)) = (once.object(id), twice.object(id)) {
                metres += space.distance(p, q);
            }
        }
        let text = || format!("{more:?} more for {metres:?} m more, close to {PAIRS} targets");
        ensure(RESOLVES, more != 0.0 || metres == 0.0, text, "more")?;
        let fits = (GROWS * metres..=UNIT * metres).contains(&more);
        ensure(METRES, fits, text, "about as many more, within a factor of 100")
    }
}
