//! Joint values, and where they put the links.

use darrt_core::laws::watch::entering;
use darrt_core::laws::{Broken, ensure, equal};
use darrt_primitives::manipulator::{Configuration, JointVector as _, world_from_base};
use nalgebra::Isometry3;

use super::{PLACES, ROUNDING, Trial, VALUES};
use crate::robot::{RobotFacts, TaskRobot};

/// Gaps as shares of the widest.
const SHARES: [f64; 3] = [0.0, 0.4, 1.0];

impl<M: TaskRobot> Trial<'_, M> {
    pub(super) fn configurations(&self) -> Result<(), Broken> {
        let all = self.drawn()?;
        for (q, other) in all.iter().zip(all.iter().cycle().skip(1)) {
            for hand in 0..self.robot.hands() {
                let facts = self.facts.of_hand(hand);
                let q = Configuration { arm: q.arm.with_hand_at_work(hand), ..*q };
                self.values(&facts, &q, other)?;
                for share in SHARES {
                    self.places(&facts, &q, share * self.robot.hand_of(hand).max_gap_m())?;
                }
            }
        }
        Ok(())
    }

    fn joints(&self, q: &Configuration<M::Joints>, gap_m: f64) -> Vec<f64> {
        entering("joint_values");
        self.robot.joint_values(q, gap_m)
    }

    /// `facts` are those of the hand at work in `q`.
    fn values(
        &self,
        facts: &RobotFacts,
        q: &Configuration<M::Joints>,
        other: &Configuration<M::Joints>,
    ) -> Result<(), Broken> {
        let widest_m = self.robot.hand_of(q.arm.hand_at_work()).max_gap_m();
        let [closed, half, open] = SHARES.map(|share| self.joints(q, share * widest_m));
        let is_whole = closed.len() == self.tree.variables().len() && closed.iter().chain(&open).all(|x| x.is_finite());
        ensure(VALUES, is_whole, || format!("{} values: {closed:?}", closed.len()), "a finite one for each variable")?;
        let _ = self.joints(other, widest_m);
        equal(VALUES, &self.joints(q, 0.0), &closed).map_err(|broken| broken.of("asked again"))?;
        for (joint, value) in self.facts.all_arm_joints().into_iter().zip(q.arm.as_ref()) {
            let variable = self.variable(VALUES, joint)?;
            let found = closed.get(variable).copied().unwrap_or(f64::NAN);
            let text = || format!("{found:?}, the configuration {value:?}");
            ensure(VALUES, (found - value).abs() <= ROUNDING, text, "the same").map_err(|b| b.of(joint))?;
        }
        let finger = self.variable(VALUES, &facts.finger_joint)?;
        let [a, b, c] = [&closed, &half, &open].map(|all| all.get(finger).copied().unwrap_or(f64::NAN));
        let text = || format!("{a:?}, {b:?} and {c:?} for gaps of {SHARES:?} of the widest");
        ensure(VALUES, a < b && b < c, text, "more for a wider gap").map_err(|b| b.of(&facts.finger_joint))?;
        // A hand that is not at work is open as far whatever the gap.
        for joint in self.facts.finger_joints().filter(|joint| *joint != facts.finger_joint) {
            let variable = self.variable(VALUES, joint)?;
            let [narrow, wide] = [&closed, &open].map(|all| all.get(variable).copied());
            equal(VALUES, &wide, &narrow).map_err(|b| b.of(joint))?;
        }
        // What a hand has besides that joint may move with it; what the arm has does not.
        for (joint, value) in self.facts.all_arm_joints().into_iter().zip(q.arm.as_ref()) {
            let variable = self.variable(VALUES, joint)?;
            let found = open.get(variable).copied().unwrap_or(f64::NAN);
            let text = || format!("{found:?} with the hand open, {value:?} with it closed");
            ensure(VALUES, (found - value).abs() <= ROUNDING, text, "the same").map_err(|b| b.of(joint))?;
        }
        Ok(())
    }

    fn places(&self, facts: &RobotFacts, q: &Configuration<M::Joints>, gap_m: f64) -> Result<(), Broken> {
        let mut of_tree = vec![Isometry3::identity(); self.tree.link_count()];
        let done = self.tree.forward(&self.joints(q, gap_m), &world_from_base(&q.base), &mut of_tree);
        done.map_err(|error| Broken::new(VALUES, error.to_string(), "values for the description"))?;
        let links = self.robot.links();
        let mut of_robot = vec![Isometry3::identity(); links.len()];
        entering("link_poses");
        self.robot.link_poses(q, gap_m, &mut of_robot);
        let place = |name: &str| self.tree.link_index(name).and_then(|link| of_tree.get(link));
        for (link, pose) in links.iter().zip(&of_robot) {
            let name = &*link.body.name;
            let there = place(name);
            let there = there.ok_or_else(|| Broken::new(PLACES, format!("no link `{name}`"), "a link of the facts"))?;
            same(there, pose).map_err(|broken| broken.of(name))?;
        }
        let tool = place(&facts.tool_link).copied().unwrap_or_default();
        same(&tool, &self.robot.world_from_tool(q)).map_err(|broken| broken.of(&facts.tool_link))
    }
}

/// The pose of the facts is that of the robot.
fn same(facts: &Isometry3<f64>, robot: &Isometry3<f64>) -> Result<(), Broken> {
    let apart =
        (facts.translation.vector - robot.translation.vector).norm().max(facts.rotation.angle_to(&robot.rotation));
    if apart <= ROUNDING {
        return Ok(());
    }
    let text = |pose: &Isometry3<f64>| {
        format!("{:?} turned {:?}", pose.translation.vector.as_slice(), pose.rotation.quaternion().coords.as_slice())
    };
    Err(Broken::new(PLACES, text(facts), format!("by the robot {}", text(robot))).within(ROUNDING))
}
