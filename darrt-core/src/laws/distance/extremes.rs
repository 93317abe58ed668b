//! Distances in the corners, between nearly equal states, and half-way.

use rand::RngExt;

use super::{FINITE, POSITIVE, RESOLVES};
use crate::domain::Domain;
use crate::laws::feed::{components, cornered, count_of, elsewhere as anywhere, moved, on_face, rng_of};
use crate::laws::{Broken, ensure, measure};
use crate::partial::PartialState;
use crate::random::Stream;
use crate::space::ComponentSpace;
use crate::state::{ComponentId, ObjectId, State};

/// How many pairs of objects and targets decide whether objects near their targets are nearer.
const PAIRS: usize = 16;

/// In how many places the way of the robot is looked at closely, and how closely: single precision has no more digits.
const FINE: u32 = 16;
const FINE_SHARE: f64 = 1e-8;
/// The first half of the robot's way is at least this part of all of it; of a root it is 0.29.
const LEAST_SHARE: f64 = 0.35;
/// Into how many steps the way of the robot is cut.
const STEPS: u32 = 128;

/// A distance under test.
pub(super) struct Trial<'a, D: Domain> {
    pub(super) m: &'a D,
    /// The distance.
    pub(super) d: &'a dyn Fn(&State<D>, &PartialState<D>) -> f64,
    pub(super) from: &'a State<D>,
    pub(super) to: &'a PartialState<D>,
    pub(super) elsewhere: &'a State<D>,
}

impl<D: Domain> Trial<'_, D> {
    pub(super) fn run(&self) -> Result<(), Broken> {
        let mut rng = rng_of(&(self.from, self.to));
        let [x, y] = [self.from, self.elsewhere].map(|state| cornered(self.m, state, &mut rng));
        let nowhere = PartialState::anywhere(self.m);
        let far = PartialState::of_state(self.m, &y);
        for (from, to) in [(&x, &far), (&x, self.to), (self.from, &far), (&x, &nowhere), (self.from, &nowhere)] {
            measure(FINITE, (self.d)(from, to))
                .map_err(|broken| broken.replayed_by(|| format!("check_distance(&{from:?}, &{to:?}, &{y:?})")))?;
        }
        self.one_number_off(&mut rng)?;
        self.robot_half_way(&x.robot, &y)?;
        self.objects_close(&mut rng)?;
        self.in_metres(&x.robot, &y, &mut rng)
    }

    /// A state that meets the target but for one number.
    fn one_number_off(&self, rng: &mut Stream) -> Result<(), Broken> {
        let met = self.to.overlay(self.m, self.from);
        for component in components(self.m, self.to.components()) {
            for coordinate in 0..count_of(self.m, &met, component) {
                let off = on_face(self.m, &met, component, coordinate, rng.random_bool(0.5));
                if self.to.is_met(self.m, &off) {
                    continue;
                }
                let metres = (self.d)(&off, self.to);
                let name = self.m.component_name(component);
                ensure(POSITIVE, metres > 0.0, || format!("{metres:?}, for {off:?}"), "a positive distance")
                    .map_err(|broken| broken.of(format_args!("coordinate {coordinate} of {name}")))?;
            }
        }
        Ok(())
    }

    /// The robot alone, as far away as it gets.
    fn robot_half_way(&self, start: &crate::state::RobotConfig<D>, end: &State<D>) -> Result<(), Broken> {
        let robot = self.m.robot();
        if robot.distance(start, &end.robot) <= 100.0 * robot.tolerance() {
            return Ok(());
        }
        let to = PartialState::anywhere(self.m).with_robot(self.m, end.robot.clone());
        let at = |t: f64| State { robot: robot.interpolate(start, &end.robot, t), ..self.from.clone() };
        let mut before: Option<f64> = None;
        for step in 0..STEPS {
            let here = at(f64::from(step) / f64::from(STEPS));
            if to.is_met(self.m, &here) {
                break;
            }
            let metres = (self.d)(&here, &to);
            let text = || format!("{metres:?} m, {step} of {STEPS} steps on the way, as one step before");
            ensure(RESOLVES, before != Some(metres), text, "another distance: no threshold, steps or plateau")
                .map_err(|broken| broken.of(self.m.component_name(ComponentId::Robot)))?;
            before = Some(metres);
        }
        for step in 0..FINE {
            let t = 0.1 + 0.8 * f64::from(step) / f64::from(FINE);
            let [near, next] = [t, t + FINE_SHARE].map(|t| (self.d)(&at(t), &to));
            let text = || format!("{near:?} m at {t:?} of the way, and {FINE_SHARE:?} of it farther on");
            ensure(RESOLVES, near != next, text, "another distance: no threshold, steps or plateau")
                .map_err(|broken| broken.of(self.m.component_name(ComponentId::Robot)))?;
        }
        let [whole, half, rest] = [0.0, 0.5, 0.9].map(|t| (self.d)(&at(t), &to));
        let text = || format!("{whole:?}, {half:?} and {rest:?} m at 0, 0.5 and 0.9 of the way");
        ensure(RESOLVES, rest < half && half < whole, text, "less and less")
            .map_err(|broken| broken.of(self.m.component_name(ComponentId::Robot)))?;
        // The first half of the way counts as well: else all that is far is equally far.
        let text = || format!("{whole:?} m, {half:?} m at half of the way");
        ensure(RESOLVES, whole - half >= LEAST_SHARE * whole, text, "clearly less at half of the way")
            .map_err(|broken| broken.of(self.m.component_name(ComponentId::Robot)))
    }

    /// One object far from and close to its target. The robot's way to it may be longer for the nearer one, but not always.
    fn objects_close(&self, rng: &mut Stream) -> Result<(), Broken> {
        for (i, space) in self.m.objects().iter().enumerate() {
            let id = ObjectId::new(i);
            let (mut far, mut close, mut counts) = (0.0, 0.0, false);
            for _ in 0..PAIRS {
                let state = anywhere(self.m, self.from, rng);
                let aim = moved(self.m, &state, ComponentId::Object(id), rng);
                let (Some(start), Some(target)) = (state.object(id), aim.object(id)) else { continue };
                let to = PartialState::anywhere(self.m).with_object(id, target.clone());
                let mut nearly = state.clone();
                if let Some(slot) = nearly.objects.get_mut(i) {
                    *slot = space.interpolate(start, target, 0.99);
                }
                counts |= !to.is_met(self.m, &nearly);
                let metres = (self.d)(&state, &to);
                let text = || format!("{metres:?}, for {state:?} and {to:?}");
                ensure(POSITIVE, metres > 0.0 || to.is_met(self.m, &state), text, "a positive distance")?;
                far += metres;
                close += (self.d)(&nearly, &to);
            }
            let text = || format!("{close:?} m close to {PAIRS} targets, {far:?} m far from them");
            ensure(RESOLVES, !counts || close < far, text, "less when close")
                .map_err(|broken| broken.of(self.m.component_name(ComponentId::Object(id))))?;
        }
        Ok(())
    }
}
