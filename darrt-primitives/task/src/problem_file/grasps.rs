//! Families of grasps and their parameters.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::length_range::LengthRange;

/// A family of grasps that Pick may draw from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum GraspFamily {
    /// The fingers straddle the rim of a plate, one above and one below, the hand points at the object's axis.
    Rim,
    /// The hand points down: it pinches the wall of a bowl, or closes about a narrow object.
    Overhead,
    /// The hand is level and closes about the sides of an upright object.
    Side,
}

/// `[object.rim]`: parameters of the rim grasps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct RimGrasp {
    /// Downward pitches of the hand in degrees, above 0 where the wrist is higher than the rim; by default the slope of the
    /// rim, 0 for a flat plate. None may be more than 1 degree from it: between pads that are not flush with the rim the
    /// object turns as soon as it is lifted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tilts_deg: Option<Vec<f64>>,
    /// How many directions around the object's axis, evenly spaced.
    pub azimuths: u32,
    /// How far the fingertips reach inside the rim, along it (m). What of the pads lies on the object bears its weight.
    pub insertion_m: f64,
    /// Gap between the open fingers while approaching (m).
    pub opening_m: f64,
    /// Length of the straight approach along the hand (m).
    pub approach_m: LengthRange,
    /// Length of the straight lift (m).
    pub lift_m: f64,
}

impl Default for RimGrasp {
    fn default() -> Self {
        Self {
            tilts_deg: None,
            azimuths: 24,
            insertion_m: 0.04,
            opening_m: 0.06,
            approach_m: LengthRange::new(0.05, 0.10),
            lift_m: 0.12,
        }
    }
}

/// `[object.overhead]`: parameters of the grasps from above.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct OverheadGrasp {
    /// Leans of the hand from the vertical in degrees, -90 to 90, about the finger axis.
    pub tilts_deg: Vec<f64>,
    /// How many directions around the object's axis, evenly spaced.
    pub azimuths: u32,
    /// How far the fingertips reach below the top of the object (m); less where it is too low for it.
    pub insertion_m: LengthRange,
    /// Gap between the open fingers while approaching (m).
    pub opening_m: f64,
    /// Length of the straight approach along the hand (m).
    pub approach_m: LengthRange,
    /// Length of the straight lift (m).
    pub lift_m: f64,
}

impl Default for OverheadGrasp {
    fn default() -> Self {
        Self {
            tilts_deg: vec![0.0],
            azimuths: 24,
            insertion_m: LengthRange::new(0.01, 0.03),
            opening_m: 0.05,
            approach_m: LengthRange::new(0.04, 0.10),
            lift_m: 0.10,
        }
    }
}

/// `[object.side]`: parameters of the grasps from the side.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct SideGrasp {
    /// Downward pitches of the hand in degrees, -90 to 90.
    pub tilts_deg: Vec<f64>,
    /// How many directions around the object's axis, evenly spaced.
    pub azimuths: u32,
    /// How far the fingertips reach beyond the object's axis (m).
    pub insertion_m: f64,
    /// Gap between the open fingers while approaching (m).
    pub opening_m: f64,
    /// Length of the straight approach along the hand (m).
    pub approach_m: LengthRange,
    /// Length of the straight lift (m).
    pub lift_m: f64,
}

impl Default for SideGrasp {
    fn default() -> Self {
        Self {
            tilts_deg: vec![0.0],
            azimuths: 24,
            insertion_m: 0.01,
            opening_m: 0.088,
            approach_m: LengthRange::new(0.06, 0.10),
            lift_m: 0.10,
        }
    }
}
