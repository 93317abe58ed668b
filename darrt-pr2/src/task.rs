//! The PR2 in files: what the table `[robot]` of a problem means, and the robot as data for those who must not trust its code.

use std::sync::Arc;

use darrt_primitives::kinematics::{MeshPlaces, RobotDescription};
use darrt_primitives::manipulator::{Configuration, Hand};
use darrt_task::clock::{Bounds, MotionLimits};
use darrt_task::problem_file::{ArmSide, Limits, Robot as RobotSettings};
use darrt_task::robot::{JointValues, RobotError, RobotFacts, TaskRobot};

use crate::arm::{ArmConfiguration, JOINT_NAMES, LimitKind, Side};
use crate::gripper;
use crate::model::{ModelError, Pr2Model, WholeBody, embedded_description};
use crate::postures::ArmPosture;
use crate::robot::{BASE_SPEED, Gripper, JOINT_SPEED_RAD_PER_S, LOADED_BASE_SPEED, PAYLOAD_KG, PUSH_FORCE_N, Pr2};
use crate::self_collision;

/// The posture of an arm for which a problem names neither a posture nor joints.
const HOME: ArmPosture = ArmPosture::Side;
/// Height of the torso where a problem says nothing, metres.
const TORSO_M: f64 = 0.2;
/// How low and how high it goes (joint limits of the description).
const TORSO_RANGE_M: [f64; 2] = [0.0, 0.33];

impl From<ModelError> for RobotError {
    fn from(error: ModelError) -> Self {
        match error {
            ModelError::Urdf(error) => Self::Urdf(error),
            error => Self::model(error),
        }
    }
}

/// The names of the postures, in the order of [`ArmPosture::ALL`].
fn posture_names() -> Vec<String> {
    ArmPosture::ALL.map(|posture| posture.name().to_owned()).to_vec()
}

impl TaskRobot for Pr2 {
    fn models() -> Vec<String> {
        vec!["pr2".to_owned()]
    }

    fn posture_names(_: &RobotSettings) -> Result<Vec<String>, RobotError> {
        Ok(posture_names())
    }

    fn build(settings: &RobotSettings) -> Result<(Self, ArmConfiguration), RobotError> {
        let model = match &settings.urdf {
            Some(path) => Pr2Model::from_file(path, &meshes(settings))?,
            None => Pr2Model::embedded()?,
        };
        let limits = match settings.limits {
            Limits::Soft => LimitKind::Soft,
            Limits::Hard => LimitKind::Hard,
        };
        let side = side_of(settings);
        let [arm, other] = starts(settings)?;
        let mut rest = WholeBody { base: settings.base, torso_m: torso_m(settings)?, ..WholeBody::at_rest() };
        for (at, value) in [(side, arm), (side.other(), other)] {
            if let Some(slot) = rest.arms.get_mut(at.index()) {
                *slot = value;
            }
        }
        Ok((Self::new(model, side, limits, rest)?, arm))
    }

    fn facts(settings: &RobotSettings) -> Result<RobotFacts, RobotError> {
        let description = match &settings.urdf {
            Some(path) => Arc::new(RobotDescription::from_file(path)?),
            None => embedded_description()?,
        };
        description.check_shapes(&settings.shapeless)?;
        let side = side_of(settings);
        let prefix = side.prefix();
        let [arm, other] = starts(settings)?;
        let joints = |side: Side| JOINT_NAMES.map(|name| format!("{}_{name}_joint", side.prefix()));
        let mut start: JointValues = vec![("torso_lift_joint".to_owned(), torso_m(settings)?)];
        for (side, values) in [(side, arm), (side.other(), other)] {
            start.extend(joints(side).into_iter().zip(values));
        }
        let finger = |side: Side| format!("{}_gripper_l_finger_joint", side.prefix());
        let open = WholeBody::at_rest().finger_angles;
        let link = |name: &str| format!("{prefix}_gripper_{name}_link");
        let pairs = self_collision::pairs(side).into_iter().map(|pair| [pair.moving, pair.other]);
        Ok(RobotFacts {
            description,
            meshes: meshes(settings),
            arm_joints: joints(side).to_vec(),
            finger_joint: finger(side),
            tool_link: format!("{prefix}_gripper_tool_frame"),
            finger_links: ["l_finger", "r_finger", "l_finger_tip", "r_finger_tip"].map(link).to_vec(),
            tip_links: ["l_finger_tip", "r_finger_tip"].map(link),
            is_limited_softly: settings.limits == Limits::Soft,
            start,
            at_rest: Side::BOTH.map(finger).into_iter().zip(open).collect(),
            self_pairs: pairs.collect(),
            is_bolted: false,
            drives_along_heading: false,
            pad_length_m: gripper::PAD_LENGTH,
            grip_force_n: Gripper.grip_force_n(),
            payload_kg: PAYLOAD_KG,
            push_force_n: PUSH_FORCE_N,
            motion: motion_limits(),
            second: None,
        })
    }

    fn posture(&self, name: &str) -> Option<ArmConfiguration> {
        Some(ArmPosture::from_name(name)?.values(self.arm().side))
    }

    fn joint_values(&self, q: &Configuration<ArmConfiguration>, gap_m: f64) -> Vec<f64> {
        self.model().joint_values(&self.whole_body(q, gap_m))
    }

    fn with_bases_from_reachability(self) -> Self {
        Self::with_bases_from_reachability(self)
    }
}

/// The arm at the speeds and the base at the pace with which plans are compared too; accelerations and jerks, which no
/// description of the PR2 has, as the defaults are.
fn motion_limits() -> MotionLimits {
    let defaults = MotionLimits::default();
    let joints = Side::BOTH.map(|side| JOINT_NAMES.map(|name| format!("{}_{name}_joint", side.prefix())));
    let speeds = joints.into_iter().flat_map(|joints| joints.into_iter().zip(JOINT_SPEED_RAD_PER_S));
    let [drive, turn] = BASE_SPEED;
    MotionLimits {
        joint_velocities: speeds.collect(),
        drive: Bounds { velocity: drive, ..defaults.drive },
        turn: Bounds { velocity: turn, ..defaults.turn },
        loaded_base_share: LOADED_BASE_SPEED[0] / drive,
        ..defaults
    }
}

fn side_of(settings: &RobotSettings) -> Side {
    match settings.arm {
        ArmSide::Right => Side::Right,
        ArmSide::Left => Side::Left,
    }
}

fn torso_m(settings: &RobotSettings) -> Result<f64, RobotError> {
    let value = settings.torso_m.unwrap_or(TORSO_M);
    let [low, high] = TORSO_RANGE_M;
    if (low..=high).contains(&value) {
        return Ok(value);
    }
    Err(RobotError::Key { key: "robot.torso_m", why: format!("is {value}, must be in [{low}, {high}]") })
}

fn meshes(settings: &RobotSettings) -> MeshPlaces {
    settings.urdf.as_deref().map(MeshPlaces::around).unwrap_or_default()
}

/// Where the arm that manipulates starts, and where the other one is parked.
fn starts(settings: &RobotSettings) -> Result<[ArmConfiguration; 2], RobotError> {
    let side = side_of(settings);
    let mine =
        arm_start(side, ["robot.posture", "robot.joints"], settings.posture.as_deref(), settings.joints.as_deref());
    let keys = ["robot.other_posture", "robot.other_joints"];
    let other = arm_start(side.other(), keys, settings.other_posture.as_deref(), settings.other_joints.as_deref());
    Ok([mine?, other?])
}

fn arm_start(
    side: Side,
    [posture_key, joints_key]: [&'static str; 2],
    posture: Option<&str>,
    joints: Option<&[f64]>,
) -> Result<ArmConfiguration, RobotError> {
    if let Some(joints) = joints {
        let (found, expected) = (joints.len(), JOINT_NAMES.len());
        return joints.try_into().map_err(|_| RobotError::JointCount { key: joints_key, found, expected });
    }
    let Some(name) = posture else { return Ok(HOME.values(side)) };
    let posture =
        ArmPosture::from_name(name).ok_or_else(|| RobotError::unknown_posture(posture_key, name, posture_names()))?;
    Ok(posture.values(side))
}
