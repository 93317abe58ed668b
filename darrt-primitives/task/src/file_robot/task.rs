//! The robot of a robot file in problem files, and as data for those who must not trust the planner's code.

use std::sync::Arc;

use darrt_primitives::contract::Contract;
use darrt_primitives::joints::Joints;
use darrt_primitives::manipulator::{Configuration, JointVector as _, LinkGroup, Manipulator as _};

use super::load::{self, Loaded};
use super::{FileRobot, choose, shipped};
use crate::clock::{Bounds, MotionLimits};
use crate::problem_file::{ArmSide, Limits, PrimitiveName, ProblemFile, Robot as RobotSettings};
use crate::robot::{JointValues, RobotError, RobotFacts, TaskRobot};
use crate::robot_file::BaseKind;

/// The speeds that plans are compared at, and the least of the accelerations that the file names; all else as the defaults.
fn motion_limits(loaded: &Loaded, robot: &FileRobot) -> MotionLimits {
    let defaults = MotionLimits::default();
    let file = &loaded.source.file;
    let least = file.arm.accelerations.iter().flatten().copied().reduce(f64::min);
    let joint = |bounds: Bounds| match least {
        Some(least) => Bounds { acceleration: least, jerk: bounds.jerk * least / bounds.acceleration, ..bounds },
        None => bounds,
    };
    let [[drive, turn], [loaded_drive, loaded_turn]] = robot.speeds.base;
    MotionLimits {
        joint_velocities: loaded.amended.arm_joints.iter().cloned().zip(robot.speeds.joints.iter().copied()).collect(),
        turning_joint: joint(defaults.turning_joint),
        sliding_joint: joint(defaults.sliding_joint),
        drive: Bounds { velocity: drive, ..defaults.drive },
        turn: Bounds { velocity: turn, ..defaults.turn },
        loaded_base_share: (loaded_drive / drive).min(loaded_turn / turn).min(1.0),
        ..defaults
    }
}

impl TaskRobot for FileRobot {
    fn models() -> Vec<String> {
        shipped::all().iter().map(|robot| robot.name.to_owned()).collect()
    }

    fn posture_names(settings: &RobotSettings) -> Result<Vec<String>, RobotError> {
        Ok(load::source(settings)?.0.file.postures.into_keys().collect())
    }

    fn build(settings: &RobotSettings) -> Result<(Self, Joints), RobotError> {
        check_keys(settings)?;
        let robot = Loaded::of(settings)?.robot(settings.limits, settings.base)?;
        let start = robot.start(settings)?;
        Ok((robot, start))
    }

    fn facts(settings: &RobotSettings) -> Result<RobotFacts, RobotError> {
        check_keys(settings)?;
        let loaded = Loaded::of(settings)?;
        let robot = loaded.robot(settings.limits, settings.base)?;
        let start = robot.start(settings)?;
        // All joints but the hand's: what the plan leaves alone stands where it rests.
        let values = robot.inverse.values(&start, robot.hand.opening.open());
        let (tree, _) = loaded.solids()?;
        let names = tree.variables().iter().map(|variable| variable.name.to_string());
        let start = names.zip(values).filter(|(name, _)| *name != loaded.source.file.gripper.joint).collect();
        let file = &loaded.source.file;
        let names =
            |group| robot.links().iter().filter(move |link| link.group == group).map(|l| l.body.name.to_string());
        let link = |index: usize| robot.links().get(index).map_or_else(String::new, |link| link.body.name.to_string());
        Ok(RobotFacts {
            arm_joints: loaded.amended.arm_joints.clone(),
            finger_joint: file.gripper.joint.clone(),
            tool_link: loaded.amended.tool_link.clone(),
            finger_links: names(LinkGroup::Finger).collect(),
            tip_links: loaded.amended.tip_links.clone(),
            is_limited_softly: settings.limits == Limits::Soft,
            start,
            at_rest: vec![(file.gripper.joint.clone(), robot.hand.opening.open())] as JointValues,
            self_pairs: robot.self_pairs().iter().map(|(a, b)| [link(*a), link(*b)]).collect(),
            pad_length_m: robot.hand.pad_length_m,
            grip_force_n: robot.hand.grip_force_n,
            payload_kg: robot.payload_kg,
            push_force_n: robot.push_force_n,
            motion: motion_limits(&loaded, &robot),
            second: None,
            is_bolted: !file.base.kind.drives(),
            drives_along_heading: file.base.kind == BaseKind::Differential,
            meshes: loaded.meshes,
            description: Arc::new(loaded.amended.description),
        })
    }

    fn with_robot(
        problem: ProblemFile,
        name: &str,
        contract: &dyn Fn(&PrimitiveName) -> Option<Contract>,
    ) -> Result<(ProblemFile, Vec<String>), RobotError> {
        choose::with_robot(problem, name, contract)
    }

    fn posture(&self, name: &str) -> Option<Joints> {
        self.postures.get(name).copied()
    }

    fn joint_values(&self, q: &Configuration<Joints>, gap_m: f64) -> Vec<f64> {
        self.inverse.values(&q.arm, self.hand.opening.joint(gap_m))
    }

    fn drives(&self) -> bool {
        self.base_kind.drives()
    }
}

impl FileRobot {
    /// Where the arm starts.
    fn start(&self, settings: &RobotSettings) -> Result<Joints, RobotError> {
        let Some(values) = &settings.joints else {
            let name = settings.posture.as_ref().unwrap_or(&self.home);
            let known = self.postures.keys().cloned();
            return self.posture(name).ok_or_else(|| RobotError::unknown_posture("robot.posture", name, known));
        };
        let (found, expected) = (values.len(), self.limits.len());
        let joints = Joints::from_values(values).filter(|_| found == expected);
        let joints = joints.ok_or(RobotError::JointCount { key: "robot.joints", found, expected })?;
        let mut outside = values.iter().zip(&self.limits).enumerate();
        if let Some((joint, (value, limit))) = outside.find(|(_, (value, limit))| !limit.contains(**value)) {
            let why = format!("has {value} for joint {joint}, outside its limits [{}, {}]", limit.lower, limit.upper);
            return Err(RobotError::Key { key: "robot.joints", why });
        }
        Ok(joints)
    }
}

/// What a problem file says of other robots.
fn check_keys(settings: &RobotSettings) -> Result<(), RobotError> {
    let elsewhere = "belongs into the robot file, which says where all joints stand that are not the arm's";
    let keys = [
        ("robot.urdf", settings.urdf.is_some(), "belongs into the robot file, which names its description"),
        ("robot.shapeless", !settings.shapeless.is_empty(), "belongs into the robot file"),
        ("robot.torso_m", settings.torso_m.is_some(), elsewhere),
        ("robot.other_posture", settings.other_posture.is_some(), elsewhere),
        ("robot.other_joints", settings.other_joints.is_some(), elsewhere),
        ("robot.arm", settings.arm != ArmSide::Right, "is for a robot with two arms; a robot file has one"),
    ];
    match keys.into_iter().find(|(_, is_there, _)| *is_there) {
        Some((key, _, why)) => Err(RobotError::Key { key, why: why.to_owned() }),
        None => Ok(()),
    }
}
