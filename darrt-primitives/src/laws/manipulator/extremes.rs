//! A robot at its limits, and asked for what is no pose.

use darrt_core::laws::watch::entering;
use darrt_core::laws::{Broken, ensure};
use darrt_core::random::{Purpose, stream};
use darrt_core::space::ComponentSpace;
use nalgebra::{Isometry3, Point2, Quaternion, Translation3, UnitQuaternion, Vector3};
use rand::RngExt;

use super::{DURATION, MAY_NOT_REACH, NAN, TRAVEL_TIGHT, Trial, links::is_rigid};
use crate::laws::tabletop::corners;
use crate::manipulator::{Configuration, Manipulator};

/// How much a bound on travel may exceed the travel of a short motion.
const TIGHT: f64 = 100.0;
/// Travel that is forgiven, metres.
const SLACK_M: f64 = 1e-3;
/// Length of the short motion, as a part of the way to the other configuration.
const SHORT: f64 = 0.02;
/// Speeds of robots, metres per second.
const FASTEST_M_PER_S: f64 = 20.0;
const SLOWEST_M_PER_S: f64 = 1e-3;
/// By what factor the straight way may take longer than its two halves.
const LONGER: f64 = 1.1;
/// Farther than any arm, metres.
const FAR_M: f64 = 20.0;

impl<M: Manipulator> Trial<'_, M> {
    pub(super) fn extremes(&self) -> Result<(), Broken> {
        self.not_a_number()?;
        self.far_away()?;
        self.tight()?;
        self.at_limits().map_err(|broken| broken.of("at its limits"))
    }

    fn not_a_number(&self) -> Result<(), Broken> {
        let tool = self.robot.world_from_tool(self.a);
        let nowhere = Isometry3::from_parts(Translation3::new(tool.translation.x, f64::NAN, 0.5), tool.rotation);
        let turned = UnitQuaternion::new_unchecked(Quaternion::new(f64::NAN, 0.0, 0.0, 1.0));
        for pose in [nowhere, Isometry3::from_parts(tool.translation, turned)] {
            entering("inverse");
            let found = self.solved(&self.a.base, &pose, &mut self.rng(0));
            ensure(NAN, found.is_none(), || format!("{found:?}"), "no configuration").map_err(|b| b.of("inverse"))?;
            entering("inverse_near");
            let found = self.robot.inverse_near(&self.a.base, &pose, &self.a.arm);
            ensure(NAN, found.is_none(), || format!("{found:?}"), "no configuration")
                .map_err(|broken| broken.of("inverse_near"))?;
        }
        entering("turn_to_reach");
        let centre = Point2::new(f64::NAN, 0.0);
        let turn = self.robot.turn_to_reach_with(self.at_work(), &self.a.base, &nowhere, &centre, &mut self.rng(0));
        ensure(NAN, turn.is_none_or(f64::is_finite), || format!("{turn:?}"), "no turn, or some angle")
            .map_err(|broken| broken.of("turn_to_reach"))?;
        entering("may_reach");
        let may = self.may_reach(&self.a.base, &nowhere);
        ensure(NAN, !may, || "true".to_owned(), "false").map_err(|broken| broken.of("may_reach"))?;
        // It only has to come back.
        entering("world_from_tool");
        let _ = self.robot.world_from_tool(&Configuration { base: [f64::NAN; 3], ..*self.a });
        Ok(())
    }

    fn far_away(&self) -> Result<(), Broken> {
        for direction in [Vector3::x(), -Vector3::y(), Vector3::z(), -Vector3::z()] {
            let mut tool = self.robot.world_from_tool(self.a);
            tool.translation.vector += FAR_M * direction;
            entering("may_reach");
            let may = self.may_reach(&self.a.base, &tool);
            ensure(MAY_NOT_REACH, !may, || format!("true for {:?}", tool.translation.vector.as_slice()), "false")?;
        }
        Ok(())
    }

    /// The bound on a short motion against what it really does.
    fn tight(&self) -> Result<(), Broken> {
        let near = self.space.interpolate(self.a, self.b, SHORT);
        let [before, after] = [self.a, &near].map(|q| self.poses(q, self.gaps_m[0]));
        let links = self.robot.links().iter().zip(before.iter().zip(&after));
        let moved =
            links.flat_map(|(link, (p, q))| corners(&link.body, p).zip(corners(&link.body, q)).collect::<Vec<_>>());
        let farthest = moved.map(|(p, q)| (q - p).norm()).fold(0.0, f64::max);
        entering("travel_m");
        let bound = self.robot.travel_m(self.a, &near, 0.0);
        let text = || format!("{bound:?} m for {farthest:?} m");
        ensure(TRAVEL_TIGHT, bound <= TIGHT * farthest + SLACK_M, text, "at most a hundred times as far")?;
        entering("link_travel_m");
        let mut of_each = vec![0.0; self.robot.links().len()];
        let held = self.robot.link_travel_m(self.a, &near, 0.0, &mut of_each);
        let most = of_each.into_iter().fold(held, f64::max);
        let text = || format!("link_travel_m {most:?} m for {farthest:?} m");
        ensure(TRAVEL_TIGHT, most <= TIGHT * farthest + SLACK_M, text, "at most a hundred times as far")?;
        self.speed(&near, farthest)
    }

    /// Seconds for what travels so far.
    fn speed(&self, near: &Configuration<M::Joints>, farthest_m: f64) -> Result<(), Broken> {
        entering("duration_s");
        let seconds = self.robot.duration_s(self.a, near, false);
        let bound_m = self.robot.travel_m(self.a, near, 0.0);
        let text = || format!("{seconds:?} s for {farthest_m:?} m");
        let fits = seconds >= farthest_m / FASTEST_M_PER_S && seconds <= bound_m / SLOWEST_M_PER_S + SLACK_M;
        ensure(DURATION, fits || seconds.is_nan(), text, "seconds: between 1 mm/s and 20 m/s")?;
        let half = self.space.interpolate(self.a, self.b, 0.5);
        let [whole, first, second] =
            [(self.a, self.b), (self.a, &half), (&half, self.b)].map(|(a, b)| self.robot.duration_s(a, b, false));
        let text = || format!("{whole:?} s, but {first:?} and {second:?} s by way of the middle");
        ensure(DURATION, whole <= LONGER * (first + second) + SLACK_M, text, "not longer")
    }

    /// Every joint at one end of its range.
    fn at_limits(&self) -> Result<(), Broken> {
        let mut rng = stream(self.seed, 0, 1, Purpose::Attempt);
        let mut q = *self.a;
        for (slot, limit) in q.arm.as_mut().iter_mut().zip(self.robot.limits()) {
            let is_upper = rng.random_bool(0.5);
            *slot = match (limit.is_unlimited(), is_upper) {
                (true, true) => std::f64::consts::PI,
                (true, false) => (-std::f64::consts::PI).next_up(),
                (false, true) => limit.upper,
                (false, false) => limit.lower,
            };
        }
        entering("world_from_tool");
        let tool = self.robot.world_from_tool(&q);
        is_rigid(&tool).map_err(|broken| broken.of("tool"))?;
        for (link, pose) in self.poses(&q, self.gaps_m[1]).iter().enumerate() {
            is_rigid(pose).map_err(|broken| broken.of(self.link_name(link)))?;
        }
        self.reaches(&q.base, &tool)?;
        self.drawn(&q.base, &tool)?;
        self.bounds(&q)
    }
}
