//! Movable objects.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::grasps::{GraspFamily, OverheadGrasp, RimGrasp, SideGrasp};
use super::shape::ShapeSpec;

/// Which turns of an object do not matter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Symmetry {
    /// Round about its z axis: every yaw is the same.
    Z,
    /// Every yaw is different.
    #[default]
    None,
}

/// Coefficients of Coulomb friction, 0 to 2.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Friction {
    /// Between the object and the surface under it.
    pub table: f64,
    /// Between the object and the fingers.
    pub fingers: f64,
}

impl Default for Friction {
    fn default() -> Self {
        Self { table: 0.3, fingers: 0.4 }
    }
}

/// `[[object]]`: a movable rigid object that starts upright on a surface.
///
/// The object's frame is the origin of its shape with z up at the start.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Object {
    /// Unique name among objects and obstacles.
    pub name: String,
    /// The shape.
    pub shape: ShapeSpec,
    /// Mass in kilograms, > 0.
    #[serde(default = "default_mass")]
    pub mass_kg: f64,
    /// Friction with the surface and with the fingers.
    #[serde(default)]
    pub friction: Friction,
    /// Which turns do not matter; by default `z` for a shape that is round about z, else `none`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub symmetry: Option<Symmetry>,
    /// How far its axis may lean from the vertical while it is carried, degrees, 0 to 180; by default 45 for a bowl and for
    /// a round object that is taller than its radius (they may be full), else 180.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max_tilt_deg: Option<f64>,
    /// The surface on which the object starts.
    pub on: String,
    /// Where its centre starts on that surface: world x, y in metres.
    pub at: [f64; 2],
    /// Yaw at the start (rad).
    #[serde(default)]
    pub yaw: f64,
    /// The surfaces on which the object may stand; every surface when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub surfaces: Option<Vec<String>>,
    /// Families of grasps with which Pick may take the object.
    #[serde(default)]
    pub grasps: Vec<GraspFamily>,
    /// Parameters of the rim grasps.
    #[serde(default)]
    pub rim: RimGrasp,
    /// Parameters of the grasps from above.
    #[serde(default)]
    pub overhead: OverheadGrasp,
    /// Parameters of the grasps from the side.
    #[serde(default)]
    pub side: SideGrasp,
    /// Whether Push may move the object; it must be round about z. By default every round object is pushable.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pushable: Option<bool>,
}

impl Object {
    /// Whether the shape is round about z.
    pub const fn is_round(&self) -> bool {
        self.shape.round_radius().is_some()
    }

    /// Which turns do not matter.
    pub const fn symmetry(&self) -> Symmetry {
        match self.symmetry {
            Some(symmetry) => symmetry,
            None if self.is_round() => Symmetry::Z,
            None => Symmetry::None,
        }
    }

    /// Whether Push may move the object.
    pub const fn pushable(&self) -> bool {
        match self.pushable {
            Some(pushable) => pushable,
            None => self.is_round(),
        }
    }

    /// How far its axis may lean while it is carried, degrees.
    pub fn max_tilt_deg(&self) -> f64 {
        self.max_tilt_deg.unwrap_or(if self.shape.may_be_full() { UPRIGHT_TILT_DEG } else { 180.0 })
    }

    /// Pitches of the hand at the rim, degrees.
    pub fn rim_tilts_deg(&self) -> Vec<f64> {
        self.rim.tilts_deg.clone().unwrap_or_else(|| vec![self.shape.rim_slope_deg()])
    }

    /// Fills in what depends on other keys.
    pub(crate) fn normalise(&mut self) {
        self.symmetry = Some(self.symmetry());
        self.pushable = Some(self.pushable());
        self.max_tilt_deg = Some(self.max_tilt_deg());
        self.rim.tilts_deg = Some(self.rim_tilts_deg());
    }
}

/// How far what may be full leans while it is carried, unless the file says otherwise, degrees.
const UPRIGHT_TILT_DEG: f64 = 45.0;

fn default_mass() -> f64 {
    0.5
}
