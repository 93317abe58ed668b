//! Problem files: a planning problem as a TOML text that a person can read, copy and edit.
//!
//! The way of the data: [`read`] (size and nesting guards, TOML, nearest valid names) → the types below →
//! [`validate`] (numbers, names, references, placement) → [`geometry`] (bodies, poses and support surfaces).
//! Names of primitives, samplers, distances and postures are checked by the [`registry`](crate::registry), which knows them;
//! `docs/problem-format.md` explains the format.
//!
//! Units are SI, angles are radians unless the key ends in `_deg`, the world frame has the floor at z = 0 and z
//! up, quaternions are `[x, y, z, w]`.

pub(crate) mod arrays;
pub mod collection;
pub mod error;
pub mod geometry;
pub mod goal;
pub mod grasps;
pub mod layout;
pub mod length_range;
pub mod name;
pub mod nesting;
pub mod object;
pub(crate) mod paths;
pub(crate) mod ranges;
pub mod read;
pub mod robot;
pub mod safety;
pub mod settings;
pub mod shape;
pub mod steer;
pub mod suggest;
pub(crate) mod toml_path;
pub mod upper_face;
pub mod validate;
pub mod world;

pub use error::ProblemFileError;
pub use goal::{Goal, GoalState, GoalTarget, ObjectGoal, Region, RobotGoal, ToolGoal};
pub use grasps::{GraspFamily, OverheadGrasp, RimGrasp, SideGrasp};
pub use length_range::LengthRange;
pub use name::{CostName, DistanceName, PrimitiveName, SamplerName};
pub use object::{Friction, Object, Symmetry};
pub use robot::{ArmSide, Limits, Robot};
pub use safety::Safety;
pub use settings::{Budget, EdgeRule, PaperFigures, Place, Push, Sampling, Transit};
pub use shape::{PlateRim, ShapeSpec};
pub use steer::Steer;
pub use world::{Bounds, Obstacle, Surface};

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The only accepted value of the key `format`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum Format {
    /// `format = "darrt-problem"`.
    #[serde(rename = "darrt-problem")]
    DarrtProblem,
}

/// The highest version of the format that this program reads.
pub const VERSION: u32 = 1;

/// The settings of one primitive, which its own type reads.
pub type PrimitiveSettings = serde_json::Map<String, serde_json::Value>;

/// One planning problem: robot, world, movable objects, goal, and the primitives that may be used.
///
/// A value that came out of [`ProblemFile::read`] or [`ProblemFile::from_toml`] is validated and
/// complete: every default has been filled in, so writing it as JSON and reading it back gives the same value.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ProblemFile {
    /// Says what kind of file this is; always `darrt-problem`.
    pub format: Format,
    /// Version of the format; this program reads version 1.
    pub version: u32,
    /// Short name in lower case, used in reports and file names.
    pub name: String,
    /// One line for people.
    #[serde(default)]
    pub title: String,
    /// A paragraph for people: what makes the problem interesting.
    #[serde(default)]
    pub description: String,
    /// The primitives the planner may use, by the names under which the program knows them: the paper's, and those of other
    /// crates.
    pub primitives: Vec<PrimitiveName>,
    /// Settings of primitives that have some of their own, by name: `[primitive.NAME]`.
    #[serde(default, rename = "primitive", skip_serializing_if = "BTreeMap::is_empty")]
    pub primitive_settings: BTreeMap<PrimitiveName, PrimitiveSettings>,
    /// The robot and where it starts.
    pub robot: Robot,
    /// Where the base and the objects may be sampled.
    #[serde(default)]
    pub bounds: Bounds,
    /// Fixed bodies; the floor is always there and has the reserved name `floor`.
    #[serde(default, rename = "obstacle")]
    pub obstacles: Vec<Obstacle>,
    /// Horizontal support surfaces on which objects can stand.
    #[serde(default, rename = "surface")]
    pub surfaces: Vec<Surface>,
    /// Movable objects, at least one.
    #[serde(rename = "object")]
    pub objects: Vec<Object>,
    /// Where objects and robot shall end.
    pub goal: Goal,
    /// Rules for the steps of the plan.
    #[serde(default, rename = "steer", skip_serializing_if = "Vec::is_empty")]
    pub steers: Vec<Steer>,
    /// How far robot and objects keep from what they need not touch.
    #[serde(default)]
    pub safety: Safety,
    /// Parameters of the primitive Push.
    #[serde(default)]
    pub push: Push,
    /// Parameters of the primitive Place.
    #[serde(default)]
    pub place: Place,
    /// How the space is sampled and which distance picks the tree node.
    #[serde(default)]
    pub sampling: Sampling,
    /// Postures the arm may travel through.
    #[serde(default)]
    pub transit: Transit,
    /// When to stop and when to start over.
    #[serde(default)]
    pub budget: Budget,
    /// What the paper reports for this problem; documentation only, the planner does not read it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub paper: Option<PaperFigures>,
}

impl ProblemFile {
    /// The movable object called `name`.
    pub fn object(&self, name: &str) -> Option<&Object> {
        self.objects.iter().find(|object| object.name == name)
    }

    /// The support surface called `name`.
    pub fn surface(&self, name: &str) -> Option<&Surface> {
        self.surfaces.iter().find(|surface| surface.name == name)
    }

    /// The fixed body called `name`.
    pub fn obstacle(&self, name: &str) -> Option<&Obstacle> {
        self.obstacles.iter().find(|obstacle| obstacle.name == name)
    }

    /// Whether there is a goal for the object of this name.
    pub fn has_goal(&self, object: &str) -> bool {
        self.goal.objects.iter().any(|goal| goal.object == object)
    }

    /// Whether the planner may use the primitive of this name.
    pub fn allows(&self, primitive: &PrimitiveName) -> bool {
        self.primitives.contains(primitive)
    }

    /// The names of the surfaces on which `object` may stand: its own list, or every surface when it names none.
    pub fn allowed_surfaces<'a>(&'a self, object: &'a Object) -> Vec<&'a str> {
        match &object.surfaces {
            Some(names) => names.iter().map(String::as_str).collect(),
            None => self.surfaces.iter().map(|s| s.name.as_str()).collect(),
        }
    }
}
