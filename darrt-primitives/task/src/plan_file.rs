//! Plan files: a solved problem as JSON, complete enough for a stranger's program to replay and to judge.
//!
//! | question | file |
//! |---|---|
//! | how is a file read without trusting it? | [`read`] |
//! | how is it written so that it is never half there? | [`mod@write`] |
//! | which joints does a waypoint list? | [`joints`], [`complete`] |
//! | how was it found? | [`facts`] |
//! | when is the robot where? | [`timing`] |
//! | which hand is at work? | [`tool`] |
//! | what does the published schema say? | [`schema`](crate::schema) |
//!
//! `docs/plan-format.md` explains the meaning of every key to readers without this code. SI units, radians, world frame
//! with the floor at z = 0, quaternions `[x, y, z, w]`. How long the search took is not stored: one problem and one seed give one file,
//! byte for byte.

pub mod complete;
pub mod error;
pub mod facts;
pub mod joints;
mod json;
mod layout;
pub mod read;
pub mod timing;
pub mod tool;
mod unique;
pub mod write;

use std::collections::BTreeMap;
use std::sync::Arc;

use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use darrt_primitives::contract::Contract;

use crate::problem_file::{PrimitiveName, ProblemFile};
pub use error::PlanFileError;
pub use facts::{GradeName, PlannerFacts, SearchName};
pub use joints::JointTable;
pub use timing::Timing;
pub use tool::UnknownTool;

/// The only accepted value of the key `format`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum PlanFormat {
    /// `"format": "darrt-plan"`.
    #[serde(rename = "darrt-plan")]
    DarrtPlan,
}

/// The highest version of the format that this program reads.
pub const VERSION: u32 = 2;

/// A plan with the problem that it solves.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlanFile {
    /// Says what kind of file this is; always `darrt-plan`.
    pub format: PlanFormat,
    /// Version of the format; this program reads version 2.
    pub version: u32,
    /// The problem, complete: every default filled in.
    pub problem: ProblemFile,
    /// The seed of the random numbers with which the plan was found.
    pub seed: u64,
    /// How the plan was found.
    pub planner: PlannerFacts,
    /// What the steps of each primitive keep to, by its name: a primitive that is not the paper's is judged by this alone.
    #[serde(deserialize_with = "unique::map")]
    pub contracts: BTreeMap<PrimitiveName, Contract>,
    /// What is left to do, if the plan does not lead to the whole goal: the beginning of a plan that was not found.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub partial: Option<Partial>,
    /// Where everything stands before the first step.
    pub start: Waypoint,
    /// The primitive actions in order.
    pub steps: Vec<Step>,
    /// When the robot is where; missing in files of older programs and in plans that were not timed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub timing: Option<Timing>,
}

/// How much of the goal a plan leads to.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Partial {
    /// The objects whose goals hold at the end.
    pub met: Vec<String>,
    /// The objects whose goals need not hold at the end.
    pub remains: Vec<String>,
    /// The goal of the robot need not hold either.
    pub robot_remains: bool,
}

/// One primitive action.
///
/// Between two waypoints base and joints move linearly, yaw and continuous joints the shorter way; what is held is
/// rigid to the tool frame; a pushed object moves linearly, or along the arc with which it turns. Either the base moves in a step, or the arm, never both.
/// The gripper opens or closes only between the first two or the last two waypoints of a step, while all else stands. Of a robot
/// with several hands only that of [`Step::tool`] opens, closes, holds and touches.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Step {
    /// The name of the primitive; its contract is among [`PlanFile::contracts`].
    pub primitive: PrimitiveName,
    /// The object that the step is about, if it is about one.
    pub object: Option<String>,
    /// The link of the tool frame of the hand at work; missing: that of the robot's first hand, the only one of most robots.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tool: Option<String>,
    /// The object in the hand during the step.
    pub holds: Option<Hold>,
    /// The object that is pushed during the step.
    pub pushes: Option<String>,
    /// The only pairs of bodies that may touch, besides a resting object and the body that carries it.
    pub allowed_contacts: Vec<AllowedContact>,
    /// At least two; the first equals the last one of the step before, or the start.
    #[schemars(length(min = 2))]
    pub waypoints: Vec<Waypoint>,
}

/// An object in the hand.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Hold {
    /// Its name.
    pub object: String,
    /// Its pose in the tool frame.
    pub tool_from_object: Pose,
}

/// A pair of bodies that may touch during a step.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AllowedContact {
    /// A link of the robot or an object.
    pub a: String,
    /// An object or a fixed body.
    pub b: String,
    /// Why they may touch.
    pub reason: ContactReason,
}

/// Why two bodies may touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ContactReason {
    /// The fingers push the object.
    Push,
    /// The fingers close on the object, hold it, or open from it.
    Grasp,
    /// The fingers slide off the object.
    Retreat,
    /// The object is lifted from, or set down on, the body under its surface.
    Support,
}

/// Where everything stands at one moment.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Waypoint {
    /// x, y (m) and yaw (rad) of the root of the robot description in the world.
    pub base: [f64; 3],
    /// Every movable joint of the robot by its name in the robot description, rad or m; mimic joints included.
    #[serde(deserialize_with = "unique::map")]
    pub joints: BTreeMap<Arc<str>, f64>,
    /// Every movable object's pose in the world.
    #[serde(deserialize_with = "unique::map")]
    pub objects: BTreeMap<Arc<str>, Pose>,
}

/// A pose in space.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Pose {
    /// x, y, z in metres.
    pub position: [f64; 3],
    /// Unit quaternion `[x, y, z, w]`.
    pub quaternion: [f64; 4],
}

impl From<Isometry3<f64>> for Pose {
    fn from(pose: Isometry3<f64>) -> Self {
        let q = pose.rotation.quaternion();
        Self { position: pose.translation.vector.into(), quaternion: [q.i, q.j, q.k, q.w] }
    }
}

impl From<Pose> for Isometry3<f64> {
    /// The quaternion is normalised; a zero or not finite one gives a rotation that is not finite.
    fn from(pose: Pose) -> Self {
        let [x, y, z, w] = pose.quaternion;
        let rotation = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
        Self::from_parts(Translation3::from(pose.position), rotation)
    }
}

impl AllowedContact {
    /// The finger links of a gripper with an object.
    pub fn fingers(links: &[String], object: &str, reason: ContactReason) -> Vec<Self> {
        links.iter().map(|a| Self { a: a.clone(), b: object.to_owned(), reason }).collect()
    }

    /// An object with the fixed body that carries it.
    pub fn support(object: &str, body: &str) -> Self {
        Self { a: object.to_owned(), b: body.to_owned(), reason: ContactReason::Support }
    }
}
