//! Two-point contact between a hand and the rim of a round object.
//!
//! The hand points down with its two fingers side by side across the push, so that both fingertips
//! touch the rim behind the centre. The only admissible push runs along the ray from the middle of
//! the contact points through the centre of the object.
//!
//! The tool frame has x along the direction the hand points, y along the finger opening and z along
//! the finger width; its origin lies midway between the fingers.
//!
//! # Source
//! Section 3 (primitive Push, figure 1) and section 5.1 of the paper.

use nalgebra::{Isometry3, Matrix3, Point2, Point3, Rotation3, Unit, UnitQuaternion, Vector2, Vector3};

use crate::error::{PrimitiveError, finite, positive, positive_below, within};

/// Half the fingertip width of a common parallel gripper, metres; the default of scenes that say nothing.
pub const DEFAULT_HALF_TIP: f64 = 0.0112;

/// Largest lean of a pushing hand from the vertical, radians (60 degrees).
pub const MAX_LEAN: f64 = std::f64::consts::FRAC_PI_3;

/// Two fingers and the disc they push.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RimContact {
    radius: f64,
    gap: f64,
    half_tip: f64,
}

/// How the hand stands behind the disc.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HandStance {
    /// Turned by 180 degrees about the vertical: the fingers change places.
    pub twin: bool,
    /// Lean about the finger axis, radians in `[-MAX_LEAN, MAX_LEAN]`: positive tips the fingers
    /// forward, so that the wrist trails behind the push.
    pub lean: f64,
    /// How far below the tool origin the rim touches the fingers, metres (negative: above). Matters
    /// only with a lean, which moves the fingertip faces forward by this times tan(lean).
    pub contact_below_tool: f64,
}

impl Default for HandStance {
    /// Straight down, fingers not swapped.
    fn default() -> Self {
        Self { twin: false, lean: 0.0, contact_below_tool: 0.0 }
    }
}

impl RimContact {
    /// A disc of `radius`, fingers `gap` apart, fingertips reaching `half_tip` ahead of the tool
    /// origin along the push; all in metres.
    ///
    /// # Errors
    /// When a length is not finite and positive, or `gap` is not below 2 `radius`.
    pub fn new(radius: f64, gap: f64, half_tip: f64) -> Result<Self, PrimitiveError> {
        let radius = positive("disc radius", radius)?;
        Ok(Self {
            radius,
            gap: positive_below("finger gap", gap, 2.0 * radius)?,
            half_tip: positive("half fingertip width", half_tip)?,
        })
    }

    /// Radius of the disc, metres.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Finger gap, metres.
    pub fn gap(&self) -> f64 {
        self.gap
    }

    /// Angle beta of each contact from the point behind the centre, radians: asin(gap / 2R).
    pub fn half_angle(&self) -> f64 {
        (0.5 * self.gap / self.radius).asin()
    }

    /// Distance of the middle of the two contact points behind the centre, metres: R cos beta.
    pub fn chord_distance(&self) -> f64 {
        let half = 0.5 * self.gap;
        ((self.radius - half) * (self.radius + half)).sqrt()
    }

    /// Distance of the tool origin behind the centre for an upright hand, metres.
    pub fn setback(&self) -> f64 {
        self.chord_distance() + self.half_tip
    }

    /// Distance of the tool origin behind the centre for a hand in the given stance, metres.
    pub fn setback_of(&self, stance: &HandStance) -> f64 {
        self.chord_distance() + self.half_tip / stance.lean.cos() + stance.contact_below_tool * stance.lean.tan()
    }

    /// Left and right contact point on the rim for a push along `direction`.
    pub fn contact_points(&self, center: &Point2<f64>, direction: &Unit<Vector2<f64>>) -> [Point2<f64>; 2] {
        let middle = center - self.chord_distance() * direction.into_inner();
        let aside = 0.5 * self.gap * left_of(direction);
        [middle + aside, middle - aside]
    }

    /// Where an upright hand stands to push the disc at `center` along `direction`.
    pub fn tool_position(&self, center: &Point2<f64>, direction: &Unit<Vector2<f64>>) -> Point2<f64> {
        center - self.setback() * direction.into_inner()
    }

    /// Centre of the disc that an upright hand at `tool` touches with both fingers.
    pub fn center_ahead_of(&self, tool: &Point2<f64>, direction: &Unit<Vector2<f64>>) -> Point2<f64> {
        tool + self.setback() * direction.into_inner()
    }

    /// Do both fingertips of an upright hand at `tool` touch the rim of a disc at `center`?
    ///
    /// True when the front face of each fingertip is within `tolerance` metres of the rim and behind
    /// the centre.
    pub fn touches_rim(
        &self,
        tool: &Point2<f64>,
        direction: &Unit<Vector2<f64>>,
        center: &Point2<f64>,
        tolerance: f64,
    ) -> bool {
        let front = tool + self.half_tip * direction.into_inner();
        let aside = 0.5 * self.gap * left_of(direction);
        [front + aside, front - aside].iter().all(|finger| {
            let to_center = center - finger;
            to_center.dot(direction) > 0.0 && (to_center.norm() - self.radius).abs() <= tolerance
        })
    }

    /// Tool pose that pushes the disc at `center` along `direction` with the tool origin at
    /// `tool_height` above the floor; world axes, metres.
    ///
    /// # Errors
    /// When a coordinate or `tool_height` is not finite, or the stance is out of range.
    pub fn world_from_tool(
        &self,
        center: &Point2<f64>,
        direction: &Unit<Vector2<f64>>,
        tool_height: f64,
        stance: &HandStance,
    ) -> Result<Isometry3<f64>, PrimitiveError> {
        let height = finite("tool height", tool_height)?;
        finite("disc centre x", center.x)?;
        finite("disc centre y", center.y)?;
        within("hand lean", stance.lean, -MAX_LEAN, MAX_LEAN)?;
        finite("contact below the tool", stance.contact_below_tool)?;
        let at = center - self.setback_of(stance) * direction.into_inner();
        let rotation = hand_down(direction, stance);
        Ok(Isometry3::from_parts(Point3::new(at.x, at.y, height).coords.into(), rotation))
    }
}

/// Orientation of a hand that points down with its fingers across `direction`.
fn hand_down(direction: &Unit<Vector2<f64>>, stance: &HandStance) -> UnitQuaternion<f64> {
    let (sin, cos) = stance.lean.sin_cos();
    let ahead = Vector3::new(direction.x, direction.y, 0.0);
    let side = left_of(direction);
    let sign = if stance.twin { -1.0 } else { 1.0 };
    let pointing = sin * ahead - cos * Vector3::z();
    let opening = sign * Vector3::new(side.x, side.y, 0.0);
    let axes = Matrix3::from_columns(&[pointing, opening, pointing.cross(&opening)]);
    UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes))
}

/// The unit vector 90 degrees to the left of `direction`.
fn left_of(direction: &Unit<Vector2<f64>>) -> Vector2<f64> {
    Vector2::new(-direction.y, direction.x)
}

#[cfg(test)]
mod tests;
