//! Shapes of obstacles and objects as files write them.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The shape of a body in its own frame, lengths in metres: `shape = { cylinder = { radius = 0.14, height = 0.02 } }`.
///
/// The frame's origin is the centre of the box, sphere, cylinder, capsule, bowl or plate, and the origin of the coordinates
/// for a hull or a mesh; the axis of round shapes is z.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum ShapeSpec {
    /// A box with full edge lengths along x, y and z.
    Box {
        /// Full edge lengths, all > 0.
        size: [f64; 3],
    },
    /// A ball.
    Sphere {
        /// Radius, > 0.
        radius: f64,
    },
    /// A solid cylinder along z.
    Cylinder {
        /// Radius, > 0.
        radius: f64,
        /// Full height, > 0.
        height: f64,
    },
    /// A cylinder along z with half-spherical ends.
    Capsule {
        /// Radius, > 0.
        radius: f64,
        /// Full height with both ends, > 2 * radius.
        height: f64,
    },
    /// An open bowl or cup: a cylinder along z with a wall that a finger can go over.
    Bowl {
        /// Outer radius, > 0.
        radius: f64,
        /// Full height, > 0.
        height: f64,
        /// Thickness of the wall, > 0 and < radius.
        wall: f64,
    },
    /// A plate: a round bottom and around it a rim that rises outward.
    Plate {
        /// Outer radius, > 0: that of the lower edge of the rim.
        radius: f64,
        /// Full height, at least that of the rim: `width_m` sin + `thickness_m` cos of the slope.
        height: f64,
        /// The rim. Its upper edge is the top of the plate.
        rim: PlateRim,
    },
    /// The convex hull of points.
    Hull {
        /// At least four points that do not lie in one plane.
        points: Vec<[f64; 3]>,
    },
    /// A triangle mesh from an STL or OBJ file.
    Mesh {
        /// The file, relative to the folder of the problem or plan file that names it.
        file: PathBuf,
        /// Factor on the coordinates of the file, > 0; 0.001 for a file in millimetres.
        #[serde(default = "one")]
        scale: f64,
    },
}

/// The rim of a plate: a ring of even thickness that rises outward.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlateRim {
    /// Rise outward, degrees, 0 to 45.
    pub slope_deg: f64,
    /// From its outer end inward along its faces (m), > 0 and < radius.
    pub width_m: f64,
    /// Thickness across its faces (m), > 0.
    pub thickness_m: f64,
}

impl PlateRim {
    /// Height of the rim alone, metres.
    pub fn height(&self) -> f64 {
        let (sin, cos) = self.slope_deg.to_radians().sin_cos();
        self.width_m * sin + self.thickness_m * cos
    }
}

impl ShapeSpec {
    /// The word that the files use for this kind of shape.
    pub const fn kind(&self) -> &'static str {
        match self {
            Self::Box { .. } => "box",
            Self::Sphere { .. } => "sphere",
            Self::Cylinder { .. } => "cylinder",
            Self::Capsule { .. } => "capsule",
            Self::Bowl { .. } => "bowl",
            Self::Plate { .. } => "plate",
            Self::Hull { .. } => "hull",
            Self::Mesh { .. } => "mesh",
        }
    }

    /// Radius of the largest horizontal cross-section of a shape that is round about z (m), else `None`.
    pub const fn round_radius(&self) -> Option<f64> {
        match self {
            Self::Sphere { radius }
            | Self::Cylinder { radius, .. }
            | Self::Capsule { radius, .. }
            | Self::Bowl { radius, .. }
            | Self::Plate { radius, .. } => Some(*radius),
            Self::Box { .. } | Self::Hull { .. } | Self::Mesh { .. } => None,
        }
    }

    /// By how much the rim rises outward, degrees; 0 for a shape that has no such rim.
    pub const fn rim_slope_deg(&self) -> f64 {
        match self {
            Self::Plate { rim, .. } => rim.slope_deg,
            _ => 0.0,
        }
    }

    /// May something be in it that must not be spilt: is it a bowl, or round and taller than its radius, as a mug or a
    /// bottle is?
    pub const fn may_be_full(&self) -> bool {
        match self {
            Self::Bowl { .. } => true,
            Self::Cylinder { radius, height } | Self::Capsule { radius, height } => *height > *radius,
            Self::Box { .. } | Self::Sphere { .. } | Self::Plate { .. } | Self::Hull { .. } | Self::Mesh { .. } => {
                false
            }
        }
    }

    /// How far the shape reaches below its origin (m), positive; `None` for a mesh, whose file must be read first.
    pub fn depth_below_origin(&self) -> Option<f64> {
        match self {
            Self::Box { size } => Some(size[2] / 2.0),
            Self::Sphere { radius } => Some(*radius),
            Self::Cylinder { height, .. }
            | Self::Capsule { height, .. }
            | Self::Bowl { height, .. }
            | Self::Plate { height, .. } => Some(height / 2.0),
            Self::Hull { points } => points.iter().map(|point| -point[2]).max_by(f64::total_cmp),
            Self::Mesh { .. } => None,
        }
    }
}

fn one() -> f64 {
    1.0
}
