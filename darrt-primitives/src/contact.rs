//! Two-point contact between a hand and the rim of a round object.
//!
//! The hand stands behind the object with its two fingers side by side across the push, so that both fingertips touch the
//! rim behind the centre. It points straight down, or leans so that the fingertips go ahead of the wrist: that is how it
//! comes under a shelf, and how it pushes what is tall. The push begins along the ray from the middle of the contact points
//! through the centre of the object.
//!
//! The tool frame has x along the direction the hand points, y along the finger opening and z along
//! the finger width; its origin lies midway between the fingers.
//!
//! # Source
//! Section 3 (primitive Push, figure 1) and section 5.1 of the paper.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{Isometry3, Matrix3, Point2, Point3, Rotation3, Unit, UnitQuaternion, Vector2, Vector3};

use crate::error::{PrimitiveError, finite, positive, positive_below, within};

/// Largest lean of a pushing hand from the vertical that an arm is asked for, radians (75 degrees): nearer to level, fingers are wider
/// than thin objects are high. A hand that is always level ([`HandTies`](crate::hand_ties::HandTies)) pushes as it is.
pub const MAX_LEAN: f64 = 75.0 * std::f64::consts::PI / 180.0;

/// Two fingers and the disc they push.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RimContact {
    radius: f64,
    gap: f64,
    tips: Fingertips,
}

/// The fingertips of a hand at some opening: boxes about the tool's axes. Metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fingertips {
    /// How far they reach beyond the tool origin, at least 0.
    pub beyond_tool: f64,
    /// Half their width along the tool's z axis.
    pub half_width: f64,
}

impl Fingertips {
    /// Height of the tool origin when their lowest point is at the height `lowest` and the hand leans like this, metres.
    pub fn tool_height(&self, lowest: f64, stance: &HandStance) -> f64 {
        let (sin, cos) = stance.lean.sin_cos();
        lowest + self.beyond_tool * cos + self.half_width * sin
    }
}

/// How the hand stands behind the disc.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct HandStance {
    /// Turned by 180 degrees about its own axis: the fingers change places.
    pub twin: bool,
    /// Lean about the finger axis, radians, 0 for a hand that points down, at most pi / 2 for a level one: the fingertips go ahead,
    /// the wrist trails behind the push.
    pub lean: f64,
}

/// The heights at which a hand pushes, metres above what the disc slides on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PushHeights {
    /// The lowest point of the fingertips.
    pub tips: f64,
    /// The upper edge of the disc; above [`Self::tips`].
    pub top: f64,
}

impl RimContact {
    /// A disc of `radius` metres, fingers `gap` metres apart with these `tips`.
    ///
    /// # Errors
    /// When a length is not finite and positive (the tips may end with the tool), or `gap` is not below 2 `radius`.
    pub fn new(radius: f64, gap: f64, tips: Fingertips) -> Result<Self, PrimitiveError> {
        let radius = positive("disc radius", radius)?;
        within("fingertip beyond the tool", tips.beyond_tool, 0.0, f64::MAX)?;
        positive("half fingertip width", tips.half_width)?;
        Ok(Self { radius, gap: positive_below("finger gap", gap, 2.0 * radius)?, tips })
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

    /// Distance of the tool origin behind the centre of the disc when both fingertips touch, metres.
    ///
    /// Of a fingertip that leans, the foremost point no higher than the disc touches: the front of its end if that is not
    /// above the disc's upper edge, else the place of its end at that edge. What of the hand is wider than the tips is not
    /// asked about.
    ///
    /// # Errors
    /// When the lean is out of range, or the heights are not finite or not in order.
    pub fn setback(&self, heights: &PushHeights, stance: &HandStance) -> Result<f64, PrimitiveError> {
        let Fingertips { beyond_tool, half_width } = self.tips;
        let lean = within("hand lean", stance.lean, 0.0, FRAC_PI_2)?;
        let top = finite("upper edge of the disc", heights.top)?;
        let height = positive("height of the disc above the fingertips", top - finite("fingertips", heights.tips)?)?;
        let (sin, cos) = lean.sin_cos();
        // The end of the tip rises from its back corner to its front one.
        let end_height = 2.0 * half_width * sin;
        let share = if end_height <= height { 1.0 } else { height / end_height };
        let foremost = beyond_tool * sin + half_width * cos * (2.0 * share - 1.0);
        Ok(self.chord_distance() + foremost)
    }

    /// Height of the tool origin above what the disc slides on, metres.
    pub fn tool_height(&self, heights: &PushHeights, stance: &HandStance) -> f64 {
        self.tips.tool_height(heights.tips, stance)
    }

    /// How much the fingertips press the disc down for each newton with which they push it ahead: 0 where the front of the
    /// tips touches its side, the cotangent of the lean where their slanting ends touch its upper edge.
    pub fn pressing_down(&self, heights: &PushHeights, stance: &HandStance) -> f64 {
        let (sin, cos) = stance.lean.sin_cos();
        let is_over_edge = 2.0 * self.tips.half_width * sin > heights.top - heights.tips;
        if is_over_edge { cos / sin } else { 0.0 }
    }

    /// Left and right contact point on the rim for a push along `direction`.
    pub fn contact_points(&self, center: &Point2<f64>, direction: &Unit<Vector2<f64>>) -> [Point2<f64>; 2] {
        let middle = center - self.chord_distance() * direction.into_inner();
        let aside = 0.5 * self.gap * left_of(direction);
        [middle + aside, middle - aside]
    }

    /// Tool pose that pushes the disc at `center` along `direction`, on a surface `surface_height` above the floor; world
    /// axes, metres.
    ///
    /// # Errors
    /// When a number is not finite, or heights or stance are out of range.
    pub fn world_from_tool(
        &self,
        center: &Point2<f64>,
        direction: &Unit<Vector2<f64>>,
        surface_height: f64,
        heights: &PushHeights,
        stance: &HandStance,
    ) -> Result<Isometry3<f64>, PrimitiveError> {
        let surface = finite("surface height", surface_height)?;
        finite("disc centre x", center.x)?;
        finite("disc centre y", center.y)?;
        let at = center - self.setback(heights, stance)? * direction.into_inner();
        let position = Point3::new(at.x, at.y, surface + self.tool_height(heights, stance));
        Ok(Isometry3::from_parts(position.coords.into(), hand_behind(direction, stance)))
    }
}

/// Orientation of a hand with its fingers across `direction`.
fn hand_behind(direction: &Unit<Vector2<f64>>, stance: &HandStance) -> UnitQuaternion<f64> {
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
