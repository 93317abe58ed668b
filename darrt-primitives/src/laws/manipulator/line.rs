//! Following straight lines of the hand.

use darrt_core::laws::{Broken, at_most, ensure};
use darrt_core::space::ComponentSpace;
use nalgebra::{Isometry3, Translation3, Vector3};

use super::{LINE_BOW, LINE_STEP, NEAR_FINDS, Trial};
use crate::manipulator::{Configuration, Manipulator};
use crate::mobile_arm_space::difference;

/// Joints of an arm that can bring its hand to any pose.
const FREEDOM: usize = 6;
/// Length of the steps of which one at least can be taken, metres.
const SHORT_M: f64 = 1e-3;

impl<M: Manipulator> Trial<'_, M> {
    /// From both configurations, along the axes of the world both ways, as far as the arm reaches.
    pub(super) fn line(&self) -> Result<(), Broken> {
        let mut is_found = self.a.arm.as_ref().len() < FREEDOM;
        for q in [self.a, self.b] {
            let tool = self.robot.world_from_tool(q);
            for axis in [Vector3::x(), Vector3::y(), Vector3::z()] {
                for direction in [axis, -axis] {
                    let first = shifted(&tool, &(direction * SHORT_M));
                    is_found = is_found || self.robot.inverse_near(&q.base, &first, &q.arm).is_some();
                    self.follow(q, &tool, &direction).map_err(|broken| {
                        broken.of(format_args!("line from {:?} towards {:?}", q.arm, direction.as_slice()))
                    })?;
                }
            }
        }
        ensure(NEAR_FINDS, is_found, || "none".to_owned(), "one of twelve steps")
    }

    fn follow(
        &self,
        start: &Configuration<M::Joints>,
        tool: &Isometry3<f64>,
        direction: &Vector3<f64>,
    ) -> Result<(), Broken> {
        let mut here = *start;
        let mut done_m = 0.0;
        while done_m < self.claims.line_m {
            let ahead_m = done_m + self.claims.step_m;
            let pose = shifted(tool, &(direction * ahead_m));
            let Some(arm) = self.robot.inverse_near(&here.base, &pose, &here.arm) else { return Ok(()) };
            let next = Configuration { arm, ..here };
            let at = |broken: Broken| broken.at(ahead_m / self.claims.line_m);
            self.solves(&next, &pose).map_err(|broken| at(broken).of("inverse_near"))?;
            self.small_step(&here.arm, &next.arm).map_err(at)?;
            self.straight(&here, &next, &shifted(tool, &(direction * done_m)), &pose).map_err(at)?;
            here = next;
            done_m = ahead_m;
        }
        Ok(())
    }

    fn small_step(&self, from: &M::Joints, to: &M::Joints) -> Result<(), Broken> {
        let joints = from.as_ref().iter().zip(to.as_ref()).zip(self.robot.limits());
        for (joint, ((from, to), limit)) in joints.enumerate() {
            at_most(LINE_STEP, difference(*from, *to, limit).abs(), self.claims.joint_step, 1e-9)
                .map_err(|broken| broken.of(format_args!("joint {joint}")))?;
        }
        Ok(())
    }

    /// Half-way in joint space the hand is half-way on the line.
    fn straight(
        &self,
        from: &Configuration<M::Joints>,
        to: &Configuration<M::Joints>,
        tool_from: &Isometry3<f64>,
        tool_to: &Isometry3<f64>,
    ) -> Result<(), Broken> {
        let between = self.robot.world_from_tool(&self.space.interpolate(from, to, 0.5)).translation.vector;
        let (a, b) = (tool_from.translation.vector, tool_to.translation.vector);
        let along = (b - a).normalize();
        let off = (between - a) - along * (between - a).dot(&along);
        at_most(LINE_BOW, off.norm(), self.claims.bow_m, 0.0)
    }
}

/// The pose moved in the world without turning.
fn shifted(pose: &Isometry3<f64>, by: &Vector3<f64>) -> Isometry3<f64> {
    Isometry3::from_parts(Translation3::from(pose.translation.vector + by), pose.rotation)
}
