//! The fixed world of a problem file: sampling bounds, obstacles, support surfaces.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::shape::ShapeSpec;

/// `[bounds]`: closed ranges `[low, high]` in metres, world frame.
///
/// They bound sampling and the states of a plan, walls are obstacles. The defaults (a square of 10 m, objects up to
/// 1.7 m) are wide; tight bounds make planning quicker.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Bounds {
    /// x of the base's centre.
    pub base_x: [f64; 2],
    /// y of the base's centre.
    pub base_y: [f64; 2],
    /// x of an object's centre.
    pub object_x: [f64; 2],
    /// y of an object's centre.
    pub object_y: [f64; 2],
    /// z of an object's centre.
    pub object_z: [f64; 2],
}

impl Default for Bounds {
    fn default() -> Self {
        Self {
            base_x: [-5.0, 5.0],
            base_y: [-5.0, 5.0],
            object_x: [-5.0, 5.0],
            object_y: [-5.0, 5.0],
            object_z: [0.0, 1.7],
        }
    }
}

impl Bounds {
    /// The five ranges with their keys, in the order of the file format.
    pub const fn ranges(&self) -> [(&'static str, [f64; 2]); 5] {
        [
            ("base_x", self.base_x),
            ("base_y", self.base_y),
            ("object_x", self.object_x),
            ("object_y", self.object_y),
            ("object_z", self.object_z),
        ]
    }
}

/// `[[obstacle]]`: a fixed body.
///
/// Its place is either `at = [x, y, z]`, the origin of the shape in the world, or `standing_on = "surface"` with
/// `at = [x, y]`, which puts its lowest point on that surface. At most one of `yaw`, `rpy` and `quaternion` turns it;
/// a standing obstacle can only have `yaw`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Obstacle {
    /// Unique name among the obstacles; `floor` is reserved.
    pub name: String,
    /// The shape.
    pub shape: ShapeSpec,
    /// Position in metres: three numbers, or two with `standing_on`.
    #[schemars(length(min = 2, max = 3))]
    pub at: Vec<f64>,
    /// The support surface on which the obstacle stands.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub standing_on: Option<String>,
    /// Rotation about z (rad).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub yaw: Option<f64>,
    /// Rotation by roll, pitch and yaw about the fixed x, y and z axes, in this order (rad).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rpy: Option<[f64; 3]>,
    /// Rotation as a unit quaternion `[x, y, z, w]`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub quaternion: Option<[f64; 4]>,
}

/// `[[surface]]`: a horizontal support surface.
///
/// Either `top_of = "obstacle"`, the top face of a level box, or `polygon`, `z` and `body`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Surface {
    /// Unique name among the surfaces.
    pub name: String,
    /// The box obstacle whose top face this is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub top_of: Option<String>,
    /// Corners of a simple polygon in order, world x and y in metres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub polygon: Option<Vec<[f64; 2]>>,
    /// Height of the polygon above the floor in metres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub z: Option<f64>,
    /// The obstacle on whose upper face a polygon lies, and which objects there touch; with `top_of` it is that obstacle.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub body: Option<String>,
}

impl Surface {
    /// The obstacle that objects on this surface touch, if the file names one.
    pub fn carrying_body(&self) -> Option<&str> {
        self.top_of.as_deref().or(self.body.as_deref())
    }
}
