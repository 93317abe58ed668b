//! The robot of a problem file and its start.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A robot model that the program carries inside.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum RobotModel {
    /// The PR2 of the paper.
    Pr2,
}

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
/// The start of an arm is either a posture by name or seven joint values (rad, from shoulder to wrist); naming
/// neither means the posture `side`. Posture names mean the same shape of arm on both sides.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Robot {
    /// A built-in model; default `pr2` unless `urdf` is given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub model: Option<RobotModel>,
    /// A robot description file instead of a built-in model, relative to the folder of the problem or plan file that names
    /// it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub urdf: Option<PathBuf>,
    /// The manipulating arm.
    #[serde(default)]
    pub arm: ArmSide,
    /// Height of the torso lift in metres, 0 to 0.33; fixed during planning.
    #[serde(default = "default_torso")]
    pub torso_m: f64,
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

/// Number of joints of a PR2 arm.
pub const ARM_JOINTS: usize = 7;

/// The posture of an arm for which the file names neither a posture nor joints.
pub const DEFAULT_POSTURE: &str = "side";

impl Robot {
    /// Fills in the model and the postures that the file left out.
    pub(crate) fn normalise(&mut self) {
        if self.model.is_none() && self.urdf.is_none() {
            self.model = Some(RobotModel::Pr2);
        }
        if self.posture.is_none() && self.joints.is_none() {
            self.posture = Some(DEFAULT_POSTURE.to_owned());
        }
        if self.other_posture.is_none() && self.other_joints.is_none() {
            self.other_posture = Some(DEFAULT_POSTURE.to_owned());
        }
    }
}

fn default_torso() -> f64 {
    0.20
}
