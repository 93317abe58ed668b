//! The robot of a robot file in problem files, and as data for those who must not trust the planner's code.

use std::sync::Arc;

use darrt_primitives::contract::Contract;
use darrt_primitives::joints::Joints;
use darrt_primitives::manipulator::{Configuration, JointVector as _, LinkGroup, Manipulator as _};

use super::chain::Fingers;
use super::load::{self, Loaded};
use super::{FileRobot, choose, shipped};
use crate::clock::{Bounds, MotionLimits};
use crate::problem_file::{ArmSide, Limits, PrimitiveName, ProblemFile, Robot as RobotSettings};
use crate::robot::{HandFacts, JointValues, RobotError, RobotFacts, TaskRobot};
use crate::robot_file::{AmendedArm, ArmTables, BaseKind};

/// The speeds that plans are compared at, and the least of the accelerations that the file names; all else as the defaults.
fn motion_limits(loaded: &Loaded, robot: &FileRobot) -> MotionLimits {
    let defaults = MotionLimits::default();
    let file = &loaded.source.file;
    let all = file.arms().flat_map(|tables| tables.arm.accelerations.iter().flatten());
    let least = all.copied().reduce(f64::min);
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
        // All joints but the hands': what the plan leaves alone stands where it rests.
        let values = robot.values(&start, robot.at_rest());
        let (tree, _) = loaded.solids()?;
        let file = &loaded.source.file;
        let is_finger = |name: &String| file.arms().any(|tables| tables.gripper.joint == *name);
        let names = tree.variables().iter().map(|variable| variable.name.to_string());
        let start = names.zip(values).filter(|(name, _)| !is_finger(name)).collect();
        let fingers = file.arms().map(|tables| tables.gripper.joint.clone());
        let at_rest: JointValues = fingers.zip(robot.at_rest()).collect();
        let link = |index: usize| robot.links().get(index).map_or_else(String::new, |link| link.body.name.to_string());
        let second = file.second_arm().zip(loaded.amended.second.as_ref());
        let second = second.map(|(tables, amended)| hand_facts(&robot, 1, tables, amended));
        let first = hand_facts(&robot, 0, file.first_arm(), &loaded.amended.first);
        let facts = RobotFacts {
            arm_joints: first.arm_joints,
            finger_joint: first.finger_joint,
            tool_link: first.tool_link,
            finger_links: first.finger_links,
            tip_links: first.tip_links,
            is_limited_softly: settings.limits == Limits::Soft,
            start,
            at_rest,
            self_pairs: robot.self_pairs().iter().map(|(a, b)| [link(*a), link(*b)]).collect(),
            pad_length_m: first.pad_length_m,
            grip_force_n: first.grip_force_n,
            payload_kg: first.payload_kg,
            push_force_n: first.push_force_n,
            motion: motion_limits(&loaded, &robot),
            second,
            is_bolted: !file.base.kind.drives(),
            drives_along_heading: file.base.kind == BaseKind::Differential,
            meshes: loaded.meshes,
            description: Arc::new(loaded.amended.description),
        };
        Ok(facts)
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
        self.values(&q.arm, self.fingers(&q.arm, gap_m))
    }

    fn drives(&self) -> bool {
        self.base_kind.drives()
    }
}

/// The facts about one of the hands.
fn hand_facts(robot: &FileRobot, hand: usize, tables: ArmTables<'_>, amended: &AmendedArm) -> HandFacts {
    let links = robot.links().iter().enumerate();
    let fingers = links.filter(|(link, l)| l.group == LinkGroup::Finger && robot.hand_of_link(*link) == hand);
    let arm = robot.arm(hand);
    HandFacts {
        arm_joints: amended.joints.clone(),
        finger_joint: tables.gripper.joint.clone(),
        tool_link: amended.tool_link.clone(),
        finger_links: fingers.map(|(_, link)| link.body.name.to_string()).collect(),
        tip_links: amended.tip_links.clone(),
        pad_length_m: arm.hand.pad_length_m,
        grip_force_n: arm.hand.grip_force_n,
        payload_kg: arm.payload_kg,
        push_force_n: arm.push_force_n,
    }
}

impl FileRobot {
    /// The values of all variables of the tree.
    fn values(&self, joints: &Joints, fingers: Fingers) -> Vec<f64> {
        self.drivers.iter().map(|driver| driver.value(joints.as_ref(), fingers)).collect()
    }

    /// The joints that open the hands where nothing is said of them: one hand is open, two are as those not at work.
    fn at_rest(&self) -> Fingers {
        if self.second.is_some() { self.idle } else { [self.first.hand.opening.open(), 0.0] }
    }

    /// Where the arm starts.
    fn start(&self, settings: &RobotSettings) -> Result<Joints, RobotError> {
        let Some(values) = &settings.joints else {
            let name = settings.posture.as_ref().unwrap_or(&self.home);
            let known = self.postures.keys().cloned();
            return self.posture(name).ok_or_else(|| RobotError::unknown_posture("robot.posture", name, known));
        };
        let (found, expected) = (values.len(), self.limits.len());
        let joints = Joints::from_values(values).filter(|_| found == expected);
        let joints = joints.ok_or_else(|| RobotError::joint_count("robot.joints", found, expected, self.hands()))?;
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
        (
            "robot.arm",
            settings.arm != ArmSide::Right,
            "is for a robot that plans with one of two arms; a robot file says with which, or with both",
        ),
    ];
    match keys.into_iter().find(|(_, is_there, _)| *is_there) {
        Some((key, _, why)) => Err(RobotError::Key { key, why: why.to_owned() }),
        None => Ok(()),
    }
}
