//! The robot of a problem file and its start.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The arm that manipulates; the other one stays parked.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ArmSide {
    /// The right arm, as in the paper's figures.
    #[default]
    Right,
    /// The left arm.
    Left,
}

/// Which joint limits bound the arm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Limits {
    /// The safety limits of the robot's controllers, a margin inside the hard ones.
    #[default]
    Soft,
    /// The mechanical limits.
    Hard,
}

/// `[robot]`: the model, the arm and the start configuration.
///
/// The start of an arm is either a posture by name or one value for each joint (rad or m, from shoulder to wrist); naming
/// neither means the robot's home. Posture names mean the same shape of arm on both sides. Keys that a robot cannot follow,
/// because it has one arm or no lift, are refused.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Robot {
    /// The name of one of the program's robots; without it and without `file` it is the first of them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub model: Option<String>,
    /// A robot file, relative to the folder of the problem or plan file that names it: the robot is the one that it describes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub file: Option<PathBuf>,
    /// A robot description file instead of a built-in model, relative to the folder of the problem or plan file that names
    /// it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub urdf: Option<PathBuf>,
    /// Links of the description that have a visual and may lack a collision shape: the robot is planned as if they were air.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub shapeless: Vec<String>,
    /// The manipulating arm.
    #[serde(default)]
    pub arm: ArmSide,
    /// Height of the torso lift in metres, the robot says how high; fixed during planning.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub torso_m: Option<f64>,
    /// Start of the base: x, y (m) and yaw (rad, -pi to pi) in the world frame.
    pub base: [f64; 3],
    /// Start posture of the manipulating arm, by name.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub posture: Option<String>,
    /// Start joints of the manipulating arm (rad), instead of a posture.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub joints: Option<Vec<f64>>,
    /// Posture in which the other arm is parked, by name.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub other_posture: Option<String>,
    /// Joints at which the other arm is parked (rad), instead of a posture.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub other_joints: Option<Vec<f64>>,
    /// Which joint limits bound the arm.
    #[serde(default)]
    pub limits: Limits,
}
