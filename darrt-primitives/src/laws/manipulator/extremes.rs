//! A robot at its limits, and asked for what is no pose.

use darrt_core::laws::watch::entering;
use darrt_core::laws::{Broken, ensure};
use darrt_core::random::{Purpose, stream};
use darrt_core::space::ComponentSpace;
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};
use rand::RngExt;

use super::{MAY_NOT_REACH, NAN, TRAVEL_TIGHT, Trial, links::is_rigid};
use crate::laws::tabletop::corners;
use crate::manipulator::{Configuration, Manipulator};

/// How much a bound on travel may exceed the travel of a short motion.
const TIGHT: f64 = 100.0;
/// Travel that is forgiven, metres.
const SLACK_M: f64 = 1e-3;
/// Length of the short motion, as a part of the way to the other configuration.
const SHORT: f64 = 0.02;
/// Farther than any arm, metres.
const FAR_M: f64 = 100.0;

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
            let found = self.robot.inverse(&self.a.base, &pose, &mut self.rng(0));
            ensure(NAN, found.is_none(), || format!("{found:?}"), "no configuration").map_err(|b| b.of("inverse"))?;
            entering("inverse_near");
            let found = self.robot.inverse_near(&self.a.base, &pose, &self.a.arm);
            ensure(NAN, found.is_none(), || format!("{found:?}"), "no configuration")
                .map_err(|broken| broken.of("inverse_near"))?;
        }
        entering("may_reach");
        let may = self.robot.may_reach(&self.a.base, &nowhere);
        ensure(NAN, !may, || "true".to_owned(), "false").map_err(|broken| broken.of("may_reach"))?;
        // It only has to come back.
        entering("world_from_tool");
        let _ = self.robot.world_from_tool(&Configuration { base: [f64::NAN; 3], ..*self.a });
        Ok(())
    }

    fn far_away(&self) -> Result<(), Broken> {
        let mut tool = self.robot.world_from_tool(self.a);
        tool.translation.x += FAR_M;
        entering("may_reach");
        let may = self.robot.may_reach(&self.a.base, &tool);
        ensure(MAY_NOT_REACH, !may, || format!("true for {:?}", tool.translation.vector.as_slice()), "false")
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
        ensure(TRAVEL_TIGHT, bound <= TIGHT * farthest + SLACK_M, text, "at most a hundred times as far")
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
