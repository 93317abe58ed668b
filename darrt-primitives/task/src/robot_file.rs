//! Robot files: what a robot description cannot say, as a TOML text that a person can read, copy and edit.
//!
//! The way of the data: [`read`] (guards, TOML, nearest valid names) → the types below → [`amend`](mod@amend) (names and numbers
//! against the description, which gets a tool frame, pads and joints that follow others) → [`file_robot`](crate::file_robot).
//! `docs/robot-format.md` explains the format.
//!
//! Units are SI, angles are radians unless the key ends in `_deg`.

pub mod amend;
pub mod built_hand;
pub mod error;
mod pads;
pub mod read;
mod straight;
mod two_arms;

use std::collections::BTreeMap;
use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use amend::{Amended, AmendedArm, amend};
pub use built_hand::BuiltHand;
pub use error::RobotFileError;
pub use read::Source;

/// The only accepted value of the key `format`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum Format {
    /// `format = "darrt-robot"`.
    #[serde(rename = "darrt-robot")]
    DarrtRobot,
}

/// The highest version of the format that this program reads.
pub const VERSION: u32 = 1;

/// A robot: a description, and what it does not say.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RobotFile {
    /// Says what kind of file this is; always `darrt-robot`.
    pub format: Format,
    /// Version of the format; this program reads version 1.
    pub version: u32,
    /// Short name in lower case.
    pub name: String,
    /// One line for people.
    #[serde(default)]
    pub title: String,
    /// The robot description (URDF), relative to the folder of this file.
    pub urdf: PathBuf,
    /// The semantic description (SRDF) of the same robot: the pairs of links that it disables are not checked. Relative to the
    /// folder of this file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub srdf: Option<PathBuf>,
    /// Folders of packages, for meshes called `package://NAME/...`; relative to the folder of this file. A package that is not here
    /// is looked for in `ROS_PACKAGE_PATH`, `AMENT_PREFIX_PATH`, and from the description upwards.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub packages: BTreeMap<String, PathBuf>,
    /// Links of the description that have a visual and may lack a collision shape: the robot is planned as if they were air.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub shapeless: Vec<String>,
    /// What carries the arm.
    pub base: Base,
    /// The arm that manipulates.
    pub arm: Arm,
    /// The tool frame: x forward out of the hand, y the direction in which the fingers open, in the middle between the pads.
    pub tool: Tool,
    /// A hand of boxes, where the description has none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hand: Option<BuiltHand>,
    /// The hand with two fingers.
    pub gripper: Gripper,
    /// A second arm with a hand of its own, of a robot that works with both.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub second: Option<SecondArm>,
    /// Postures of the arm by name: one value for each joint (rad or m), from the base outwards; then one for each joint of the
    /// second arm that the first has not.
    pub postures: BTreeMap<String, Vec<f64>>,
    /// The posture in which the arm starts where a problem does not say.
    pub home: String,
    /// Values of joints that no arm and no hand has, such as a lift or a head (rad or m); by default 0, or what is nearest to it
    /// within the limits.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub rest: BTreeMap<String, f64>,
    /// Pairs of links that are never checked against each other, besides neighbours.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub ignore: Vec<[String; 2]>,
}

/// `[second]`: a second arm, in the words of the first.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SecondArm {
    /// The arm.
    pub arm: Arm,
    /// The tool frame of its hand.
    pub tool: Tool,
    /// Its hand.
    pub gripper: Gripper,
}

/// What a robot file says of one arm and its hand.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ArmTables<'a> {
    /// What comes before its keys.
    prefix: &'static str,
    pub(crate) arm: &'a Arm,
    pub(crate) tool: &'a Tool,
    pub(crate) gripper: &'a Gripper,
}

impl ArmTables<'_> {
    /// The path of one of its keys, such as `arm.to`.
    pub(crate) fn key(&self, key: &str) -> String {
        format!("{}{key}", self.prefix)
    }
}

impl RobotFile {
    /// What it says of the first arm.
    pub(crate) fn first_arm(&self) -> ArmTables<'_> {
        ArmTables { prefix: "", arm: &self.arm, tool: &self.tool, gripper: &self.gripper }
    }

    /// What it says of the second arm, if it has one.
    pub(crate) fn second_arm(&self) -> Option<ArmTables<'_>> {
        let SecondArm { arm, tool, gripper } = self.second.as_ref()?;
        Some(ArmTables { prefix: "second.", arm, tool, gripper })
    }

    /// What it says of its arms, the first one first.
    pub(crate) fn arms(&self) -> impl Iterator<Item = ArmTables<'_>> {
        std::iter::once(self.first_arm()).chain(self.second_arm())
    }
}

/// How the base moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum BaseKind {
    /// It is bolted down.
    Fixed,
    /// It drives on the floor in any direction, and turns.
    Planar,
    /// It slides along a line in its frame: the line becomes the first joint of each arm.
    Rail,
    /// It drives along its heading only, ahead and back, and turns on the spot.
    Differential,
}

impl BaseKind {
    /// Does it drive on the floor?
    pub fn drives(self) -> bool {
        matches!(self, Self::Planar | Self::Differential)
    }
}

/// `[base]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Base {
    /// How it moves.
    pub kind: BaseKind,
    /// Where the root of the description is in the frame of the base, which lies on the floor: x, y, z, metres.
    #[serde(default)]
    pub xyz: [f64; 3],
    /// How it is turned there: roll, pitch, yaw, radians.
    #[serde(default)]
    pub rpy: [f64; 3],
    /// The direction of a rail in the frame of the base.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rail_axis: Option<[f64; 3]>,
    /// From where to where it slides along that direction, metres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rail_m: Option<[f64; 2]>,
    /// Metres and radians per second with an empty hand.
    #[serde(default = "Base::default_speed")]
    pub speed: [f64; 2],
    /// The same with something in the hand.
    #[serde(default = "Base::default_loaded_speed")]
    pub loaded_speed: [f64; 2],
}

impl Base {
    /// A careful indoor pace.
    fn default_speed() -> [f64; 2] {
        [0.5, 1.0]
    }

    fn default_loaded_speed() -> [f64; 2] {
        [0.3, 0.6]
    }
}

/// `[arm]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Arm {
    /// The link that the arm is mounted on; the first joint below it is the arm's first joint.
    pub from: String,
    /// The last link that the arm moves, or one that is rigid to it.
    pub to: String,
    /// Speeds of the joints (rad/s or m/s); by default half of what the description allows, or 1 where it says nothing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub speeds: Option<Vec<f64>>,
    /// Accelerations of the joints (rad/s^2 or m/s^2), for a plan with times.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub accelerations: Option<Vec<f64>>,
    /// The heaviest object that the arm carries, kilograms.
    pub payload_kg: f64,
    /// The largest force with which the hand pushes sideways, newton.
    pub push_force_n: f64,
}

/// `[tool]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Tool {
    /// The link that it is rigid to.
    pub link: String,
    /// Where it is in the frame of that link: x, y, z, metres.
    #[serde(default)]
    pub xyz: [f64; 3],
    /// How it is turned there: roll, pitch, yaw, radians.
    #[serde(default)]
    pub rpy: [f64; 3],
}

/// `[gripper]`: a parallel jaw of two fingers that one joint moves.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Gripper {
    /// The joint that opens the hand; the gap is found from the shapes of the tips.
    pub joint: String,
    /// Joints that follow it, for a description that does not say so.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub follow: BTreeMap<String, Follow>,
    /// The links with the pads: first that on the side of the tool's +y.
    pub tips: [String; 2],
    /// Length of a pad from the tip back, metres.
    pub pad_length_m: f64,
    /// Force of each finger on what it holds, newton.
    pub grip_force_n: f64,
    /// The widest gap that is used, metres; by default as far as the joint opens.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max_gap_m: Option<f64>,
}

/// `value = multiplier * value of the gripper's joint + offset`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Follow {
    /// Factor.
    #[serde(default = "Follow::one")]
    pub multiplier: f64,
    /// Offset, rad or m.
    #[serde(default)]
    pub offset: f64,
}

impl Follow {
    fn one() -> f64 {
        1.0
    }
}
