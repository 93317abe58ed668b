//! Configurations and bases for a pose of the hand.

use darrt_core::laws::{Broken, at_most, ensure, equal};
use nalgebra::{Isometry3, Translation3};

use super::{
    BASE_FOR, BASE_VARIED, INVERSE_LIMITS, INVERSE_POSE, INVERSE_VARIED, MAY_REACH, NEAR_SELF, PURE, SEEDED, Trial,
    same_pose,
};
use crate::manipulator::{Configuration, Manipulator};
use crate::mobile_arm_space::difference;

/// How many solutions are drawn for each pose.
const DRAWS: u64 = 4;
/// So many joints reach a pose in a few ways only.
const DETERMINED: usize = 6;
/// How many solutions are drawn until they are the same for ever.
const VARIED_DRAWS: u64 = 24;
/// Joint travel by which it is seen what a joint moves, radians or metres.
const SMALL: f64 = 1e-3;
/// And how many bases.
const BASES: u64 = 24;

impl<M: Manipulator> Trial<'_, M> {
    pub(super) fn inverse(&self) -> Result<(), Broken> {
        for (q, other) in [(self.a, self.b), (self.b, self.a)] {
            let tool = self.robot.world_from_tool(q);
            self.reaches(&q.base, &tool)?;
            self.drawn(&q.base, &tool)?;
            self.base_for(&tool)?;
            // Also where the hand may not get to.
            self.drawn(&other.base, &tool)?;
            self.near_itself(q, &tool)?;
            self.near_pure(q, &tool, other)?;
        }
        self.inverse_varied()
    }

    /// Redundancy is drawn: for two poses, many draws are not the same in both.
    fn inverse_varied(&self) -> Result<(), Broken> {
        let limits = self.robot.limits().iter().enumerate();
        let movable = limits.filter(|(joint, limit)| limit.upper > limit.lower && self.moves_hand(*joint)).count();
        if movable <= DETERMINED {
            return Ok(());
        }
        let is_varied = |q: &Configuration<M::Joints>| {
            let tool = self.robot.world_from_tool(q);
            let mut found =
                (0..VARIED_DRAWS).filter_map(|i| self.robot.inverse_from(&q.arm, &q.base, &tool, &mut self.rng(i)));
            let Some(first) = found.next() else { return true };
            let mut count = 1;
            found.any(|other| {
                count += 1;
                other != first
            }) || count < VARIED_DRAWS / 2
        };
        let holds = is_varied(self.a) || is_varied(self.b);
        let text = || format!("the same arm configuration in all of {VARIED_DRAWS} draws, for both poses");
        ensure(INVERSE_VARIED, holds, text, "different ones: redundancy is drawn")
    }

    /// Does a joint move the hand at work? Of a robot with one hand each is taken to.
    fn moves_hand(&self, joint: usize) -> bool {
        let mut moved = *self.a;
        moved.arm.as_mut().iter_mut().skip(joint).take(1).for_each(|value| *value += SMALL);
        self.robot.hands() == 1 || self.robot.world_from_tool(&moved) != self.robot.world_from_tool(self.a)
    }

    pub(super) fn reaches(&self, base: &[f64; 3], tool: &Isometry3<f64>) -> Result<(), Broken> {
        ensure(MAY_REACH, self.may_reach(base, tool), || "false".to_owned(), "true: a configuration reaches it")
    }

    /// Solutions of several draws, each of them twice.
    pub(super) fn drawn(&self, base: &[f64; 3], tool: &Isometry3<f64>) -> Result<(), Broken> {
        let draw = |attempt| self.solved(base, tool, &mut self.rng(attempt));
        for attempt in 0..DRAWS {
            let found = draw(attempt);
            let _ = draw(attempt + 1);
            equal(SEEDED, &draw(attempt), &found).map_err(|broken| broken.of("inverse"))?;
            if let Some(arm) = found {
                self.solves(&Configuration { base: *base, arm }, tool).map_err(|broken| broken.of("inverse"))?;
                self.reaches(base, tool)?;
            }
        }
        Ok(())
    }

    /// `q` is within the limits and brings the tool to `tool`.
    pub(super) fn solves(&self, q: &Configuration<M::Joints>, tool: &Isometry3<f64>) -> Result<(), Broken> {
        if let Some((joint, value)) = self.space.first_outside(&q.arm) {
            let bound = self.robot.limits().get(joint).map_or_else(String::new, |l| format!("{l:?}"));
            return Err(Broken::new(INVERSE_LIMITS, format!("{value:?}"), bound).of(format_args!("joint {joint}")));
        }
        let continuous = q.arm.as_ref().iter().zip(self.robot.limits()).enumerate();
        for (joint, (value, _)) in continuous.filter(|(_, (_, limit))| limit.is_unlimited()) {
            let holds = -std::f64::consts::PI < *value && *value <= std::f64::consts::PI;
            ensure(INVERSE_LIMITS, holds, || format!("{value:?}"), "a continuous joint in (-pi, pi]")
                .map_err(|broken| broken.of(format_args!("joint {joint}")))?;
        }
        same_pose(INVERSE_POSE, &self.robot.world_from_tool(q), tool, self.claims.pose)
    }

    fn base_for(&self, tool: &Isometry3<f64>) -> Result<(), Broken> {
        let draw = |attempt| self.robot.base_for_hand(self.at_work(), tool, &mut self.rng(attempt));
        let base = draw(0);
        let is_place = base.iter().all(|x| x.is_finite()) && base[2].abs() <= std::f64::consts::PI;
        ensure(BASE_FOR, is_place, || format!("{base:?}"), "finite, yaw in [-pi, pi]")?;
        let _ = draw(1);
        equal(SEEDED, &draw(0), &base).map_err(|broken| broken.of("base_for"))?;
        let mut differs = false;
        for attempt in 1..BASES {
            let other = draw(attempt);
            let is_place = other.iter().all(|x| x.is_finite()) && other[2].abs() <= std::f64::consts::PI;
            ensure(BASE_FOR, is_place, || format!("{other:?}"), "finite, yaw in [-pi, pi]")?;
            differs |= other != base;
        }
        // One that stands where it stands wherever its hand shall be is bolted down.
        let elsewhere = Translation3::new(1.0, 1.0, 0.0) * tool;
        let is_bolted = self.robot.base_for_hand(self.at_work(), &elsewhere, &mut self.rng(0)) == base;
        ensure(BASE_VARIED, differs || is_bolted, || format!("{BASES} times {base:?}"), "different ones")?;
        self.drawn(&base, tool)
    }

    fn near_itself(&self, q: &Configuration<M::Joints>, tool: &Isometry3<f64>) -> Result<(), Broken> {
        let Some(near) = self.robot.inverse_near(&q.base, tool, &q.arm) else {
            return Err(Broken::new(NEAR_SELF, "no configuration", format!("{:?}", q.arm)));
        };
        self.solves(&Configuration { base: q.base, arm: near }, tool).map_err(|broken| broken.of("inverse_near"))?;
        let joints = q.arm.as_ref().iter().zip(near.as_ref()).zip(self.robot.limits());
        for (joint, ((from, to), limit)) in joints.enumerate() {
            at_most(NEAR_SELF, difference(*from, *to, limit).abs(), 0.0, self.claims.near_self)
                .map_err(|broken| broken.of(format_args!("joint {joint}")))?;
        }
        Ok(())
    }

    fn near_pure(
        &self,
        q: &Configuration<M::Joints>,
        tool: &Isometry3<f64>,
        other: &Configuration<M::Joints>,
    ) -> Result<(), Broken> {
        let near = |arm: &M::Joints| self.robot.inverse_near(&q.base, tool, arm);
        let found = near(&q.arm);
        // The same hand pose from another arm posture, which may be too far away to be near.
        if let Some(arm) = near(&other.arm) {
            self.solves(&Configuration { base: q.base, arm }, tool).map_err(|broken| broken.of("inverse_near"))?;
        }
        equal(PURE, &near(&q.arm), &found).map_err(|broken| broken.of("inverse_near"))
    }
}
