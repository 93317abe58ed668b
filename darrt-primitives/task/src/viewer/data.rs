//! What the viewer is given: one JSON object, explained for strangers in `docs/viewer-data.md`.
//!
//! Metres, radians, the world's floor at z = 0. A pose is `[x, y, z, qx, qy, qz, qw]`. Numbers are rounded to what the eye
//! can tell, so the object is small; plans are judged by their own file, not by this one.

use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};
use serde::{Deserialize, Serialize};

use super::search::SearchData;
use super::why::WhyData;

/// The only accepted value of the key `format`.
pub const FORMAT: &str = "darrt-viewer";
/// The version of the format.
pub const VERSION: u32 = 1;

/// A pose: `[x, y, z, qx, qy, qz, qw]`.
pub type PoseData = [f64; 7];

/// Everything that the page shows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ViewerData {
    /// Always [`FORMAT`].
    pub format: String,
    /// Always [`VERSION`].
    pub version: u32,
    /// One line.
    pub title: String,
    /// A paragraph.
    pub description: String,
    /// One line about how the plan was found.
    pub note: String,
    /// The robot.
    pub robot: RobotData,
    /// What does not move.
    pub bodies: Vec<BodyData>,
    /// What things stand on.
    pub surfaces: Vec<SurfaceData>,
    /// What can be moved.
    pub objects: Vec<ObjectData>,
    /// Where everything stands at first.
    pub start: StartData,
    /// What happens, in order; none for a problem without a plan.
    pub steps: Vec<StepData>,
    /// Why there is no plan; then the steps are the beginning of one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub why: Option<WhyData>,
    /// How the search went, if it was recorded.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub search: Option<SearchData>,
}

/// A tree of links.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RobotData {
    /// Its name.
    pub name: String,
    /// Parents before children; the first is the root, which stands where the base is.
    pub links: Vec<LinkData>,
    /// The joint values that a state consists of.
    pub variables: Vec<VariableData>,
    /// Index of the link to which a held object is rigid.
    pub tool: usize,
    /// By hand, of a robot with several: index of the link to which what it holds is rigid.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tools: Vec<usize>,
}

/// One link.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LinkData {
    /// Its name.
    pub name: String,
    /// Index of the link above it; none for the root.
    pub parent: Option<usize>,
    /// Pose in the parent at joint value zero.
    pub pose: PoseData,
    /// How it moves against its parent; none if it does not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub joint: Option<JointData>,
    /// What it looks like.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub parts: Vec<PartData>,
}

/// `value = multiplier * variable + offset`, about or along an axis of the link.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointData {
    /// `turning` or `sliding`.
    pub kind: JointKindData,
    /// Unit axis in the link's frame.
    pub axis: [f64; 3],
    /// Index of the variable.
    pub variable: usize,
    /// Factor.
    pub multiplier: f64,
    /// Offset.
    pub offset: f64,
}

/// How a joint moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum JointKindData {
    /// About its axis.
    Turning,
    /// Along its axis.
    Sliding,
}

/// One joint value.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VariableData {
    /// Name of the joint.
    pub name: String,
    /// Of what kind it is.
    pub kind: JointKindData,
    /// Smallest and largest value; none for a joint that turns without end.
    pub limits: Option<[f64; 2]>,
}

/// A solid at its place in the frame of its link, body or object.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PartData {
    /// The solid.
    pub shape: ShapeData,
    /// Its pose.
    pub pose: PoseData,
}

/// A solid in its own frame; what is round is round about z.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum ShapeData {
    /// A box about the origin.
    Box {
        /// Full edge lengths.
        size: [f64; 3],
    },
    /// A ball about the origin.
    Sphere {
        /// Radius.
        radius: f64,
    },
    /// A cylinder about the origin.
    Cylinder {
        /// Radius.
        radius: f64,
        /// Full length.
        length: f64,
    },
    /// A cylinder with half-spherical ends.
    Capsule {
        /// Radius.
        radius: f64,
        /// Length of the cylinder, without the ends.
        length: f64,
    },
    /// A profile turned about z: cones, bowls, plates.
    Lathe {
        /// `[radius, z]`, from the top to the bottom as seen from outside.
        profile: Vec<[f64; 2]>,
    },
    /// Triangles.
    Mesh {
        /// x, y, z of each corner in turn.
        vertices: Vec<f64>,
        /// Three corners of each triangle in turn, counter-clockwise from outside.
        triangles: Vec<u32>,
    },
}

/// A body that does not move.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BodyData {
    /// Its name.
    pub name: String,
    /// Pose in the world.
    pub pose: PoseData,
    /// Does it carry a surface? It is then drawn as a table.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub carries: bool,
    /// What it looks like.
    pub parts: Vec<PartData>,
}

/// A horizontal surface.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SurfaceData {
    /// Its name.
    pub name: String,
    /// Height.
    pub z: f64,
    /// Its corners in turn.
    pub corners: Vec<[f64; 2]>,
}

/// A body that can be moved.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ObjectData {
    /// Its name.
    pub name: String,
    /// What it looks like.
    pub parts: Vec<PartData>,
    /// Where it shall end: any of these poses,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub goals: Vec<PoseData>,
    /// or over any of these rectangles.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub regions: Vec<RegionData>,
}

/// A horizontal rectangle.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RegionData {
    /// Smallest x and y.
    pub min: [f64; 2],
    /// Largest x and y.
    pub max: [f64; 2],
    /// Height.
    pub z: f64,
}

/// Where everything stands at first.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StartData {
    /// x, y, yaw of the root.
    pub base: [f64; 3],
    /// By variable.
    pub joints: Vec<f64>,
    /// By object.
    pub objects: Vec<PoseData>,
}

/// One step. What it has no track for stays where it was at the end of the step before; what it holds is rigid to the tool.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StepData {
    /// What is done: the name of a primitive.
    pub name: String,
    /// Colour of its band, `#rrggbb`.
    pub colour: String,
    /// Seconds from the beginning of the step to each waypoint, for playing; at least two, the first is 0.
    pub times: Vec<f64>,
    /// Index of the object that the step is about.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub object: Option<usize>,
    /// Index of the object that is pushed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pushes: Option<usize>,
    /// Index of the link of the hand at work, if it is not the robot's first: what is held is rigid to it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tool: Option<usize>,
    /// What is in the hand.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub holds: Option<HoldData>,
    /// Pairs of bodies that may touch, and why.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub contacts: Vec<[String; 3]>,
    /// x, y, yaw of the root at each waypoint, if it moves.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub base: Vec<[f64; 3]>,
    /// The joints that move.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub joints: Vec<JointTrack>,
    /// The objects that move and are not held.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub objects: Vec<ObjectTrack>,
    /// How near anything comes to what it may not touch.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub clearance: Vec<ClearanceData>,
}

/// An object in the hand.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HoldData {
    /// Its index.
    pub object: usize,
    /// Its pose in the frame of the tool.
    pub tool_from_object: PoseData,
}

/// A variable's values.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointTrack {
    /// Index of the variable.
    pub variable: usize,
    /// At each waypoint.
    pub values: Vec<f64>,
}

/// An object's poses.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ObjectTrack {
    /// Index of the object.
    pub object: usize,
    /// At each waypoint.
    pub poses: Vec<PoseData>,
}

/// The nearest two bodies at one moment.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ClearanceData {
    /// The moment, in waypoints from the beginning of the step: 2.5 is half way from the third to the fourth.
    pub at: f64,
    /// How far apart they are, metres.
    pub distance: f64,
    /// Their names.
    pub bodies: [String; 2],
    /// The nearest point of each, in the world.
    pub points: [[f64; 3]; 2],
}

impl JointTrack {
    /// The values of a joint at every waypoint, rounded; `None` if it stays where it is.
    pub fn of(variable: usize, values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let values: Vec<f64> = values.into_iter().map(rounded).collect();
        moves(&values).then_some(Self { variable, values })
    }
}

impl ObjectTrack {
    /// The poses of an object at every waypoint, rounded; `None` if it stays where it is.
    pub fn of<'a>(object: usize, poses: impl IntoIterator<Item = &'a Isometry3<f64>>) -> Option<Self> {
        let poses: Vec<PoseData> = poses.into_iter().map(pose).collect();
        moves(&poses).then_some(Self { object, poses })
    }
}

/// Does something change from one waypoint to the next?
pub(super) fn moves<T: PartialEq>(values: &[T]) -> bool {
    values.windows(2).any(|pair| pair.first() != pair.last())
}

/// A number to a hundredth of a millimetre, or of a milliradian.
pub fn rounded(value: f64) -> f64 {
    to(value, 1e5)
}

/// To the inverse of `steps`; without a negative zero.
pub(super) fn to(value: f64, steps: f64) -> f64 {
    (value * steps).round() / steps + 0.0
}

/// A pose as data.
pub fn pose(pose: &Isometry3<f64>) -> PoseData {
    let [x, y, z] = pose.translation.vector.into();
    let q = pose.rotation.quaternion();
    let [x, y, z] = [x, y, z].map(rounded);
    let [i, j, k, w] = [q.i, q.j, q.k, q.w].map(|value| to(value, 1e6));
    [x, y, z, i, j, k, w]
}

/// A pose from data; a quaternion that is none gives no turn.
pub(super) fn pose_of([x, y, z, i, j, k, w]: &PoseData) -> Isometry3<f64> {
    let rotation = UnitQuaternion::try_new(Quaternion::new(*w, *i, *j, *k), 1e-9).unwrap_or_default();
    Isometry3::from_parts(Translation3::new(*x, *y, *z), rotation)
}
