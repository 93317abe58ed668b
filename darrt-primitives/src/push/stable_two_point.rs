//! Two fingers on a disc: when the disc stays fixed to the hand.
//!
//! The contacts sit at angles +beta and -beta about the point behind the centre,
//! R (-cos beta, +-sin beta), and the hand pushes along +x of its own axis. The disc stays fixed to
//! the hand iff the wrench its motion needs lies in the cone of the four friction edges (Lynch and
//! Mason 1996). With the ellipsoidal limit surface this has closed forms:
//!
//! - pure translation at angle theta from the axis is stable iff |theta| < beta, for any friction, so
//!   pushing along the ray through the centre needs two contacts and nothing else;
//! - straight ahead, the largest lateral offset of the force line is R sin beta when the friction
//!   angle alpha >= beta, else R sin alpha cos alpha / cos beta.
//!
//! Friction decides only how sharply the hand may turn.

use nalgebra::{Unit, Vector2};

use super::limit_surface::PressureConstant;
use super::motion_cone::{PointContact, Rotation};
use super::{Friction, Twist, Wrench, cross};
use crate::error::{PrimitiveError, positive, positive_below};

/// Two frictional contacts placed symmetrically behind the centre of a disc.
///
/// # Laws
/// `is_stable(t)` iff the wrench of `t` is a non-negative combination of [`Self::friction_edges`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TwoPointContact {
    radius: f64,
    half_angle: f64,
    pressure: PressureConstant,
    friction: Friction,
}

/// The centre of rotation that one friction edge alone would cause.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EdgeCenter {
    /// Metres from the centre of the disc, x along the push.
    pub point: Vector2<f64>,
    /// The sense of rotation about it.
    pub rotation: Rotation,
}

impl TwoPointContact {
    /// Contacts at `half_angle` radians on both sides of the axis, in (0, pi/2).
    ///
    /// # Errors
    /// When `radius` is not positive, `half_angle` outside its range, or the contacts can wedge the
    /// disc (mu tan beta >= 1: the friction cones face each other and no closed form holds).
    pub fn new(
        radius: f64,
        half_angle: f64,
        pressure: PressureConstant,
        friction: Friction,
    ) -> Result<Self, PrimitiveError> {
        let radius = positive("disc radius", radius)?;
        let limit = std::f64::consts::FRAC_PI_2 - friction.angle();
        let half_angle = positive_below("contact half-angle", half_angle, limit)?;
        Ok(Self { radius, half_angle, pressure, friction })
    }

    /// Contacts of two fingers `gap` metres apart: sin beta = (gap/2)/R.
    ///
    /// # Errors
    /// When `radius` is not positive, `gap` outside (0, 2R), or the contacts can wedge the disc.
    pub fn from_gap(
        radius: f64,
        gap: f64,
        pressure: PressureConstant,
        friction: Friction,
    ) -> Result<Self, PrimitiveError> {
        let radius = positive("disc radius", radius)?;
        let gap = positive_below("finger gap", gap, 2.0 * radius)?;
        Self::new(radius, (0.5 * gap / radius).asin(), pressure, friction)
    }

    /// The angle beta of each contact from the axis, radians; also the largest stable heading of a
    /// pure translation.
    pub fn half_angle(&self) -> f64 {
        self.half_angle
    }

    /// Left and right contact.
    ///
    /// # Errors
    /// Never for a constructed value; the signature is that of [`PointContact::on_disc`].
    pub fn contacts(&self) -> Result<[PointContact; 2], PrimitiveError> {
        let at = |azimuth| PointContact::on_disc(self.radius, azimuth, self.friction);
        Ok([at(-self.half_angle)?, at(self.half_angle)?])
    }

    /// The four edges of the friction cones as unit forces with their moments: left finger left and
    /// right edge, then the same of the right finger.
    pub fn friction_edges(&self) -> [Wrench; 4] {
        let (alpha, beta) = (self.friction.angle(), self.half_angle);
        [(-beta, alpha), (-beta, -alpha), (beta, alpha), (beta, -alpha)].map(|(normal, offset): (f64, f64)| Wrench {
            force: Vector2::new((normal + offset).cos(), (normal + offset).sin()),
            // The contact is at -R n, so the moment is -R n x f.
            moment: -self.radius * offset.sin(),
        })
    }

    /// Centres of rotation of the four friction edges, in the order of [`Self::friction_edges`].
    ///
    /// Each edge is a line tangent to the circle of radius R sin alpha, so each centre is at
    /// c^2/(R sin alpha). `None` without friction (all four at infinity).
    pub fn edge_centers(&self) -> Option<[EdgeCenter; 4]> {
        let edges = self.friction_edges();
        if self.friction.coefficient() == 0.0 {
            return None;
        }
        Some(edges.map(|edge| EdgeCenter {
            point: self.pressure.center_of_rotation(&edge).unwrap_or_else(|| Vector2::repeat(f64::INFINITY)),
            rotation: if edge.moment > 0.0 { Rotation::CounterClockwise } else { Rotation::Clockwise },
        }))
    }

    /// Is pure translation at `heading` radians from the axis stable?
    ///
    /// # Source
    /// Lynch and Mason 1996.
    pub fn is_translation_stable(&self, heading: f64) -> bool {
        heading.abs() < self.half_angle
    }

    /// Largest lateral offset of the force line when heading straight, metres.
    pub fn max_force_offset(&self) -> f64 {
        let (alpha, beta) = (self.friction.angle(), self.half_angle);
        if alpha >= beta { self.radius * beta.sin() } else { self.radius * alpha.sin() * alpha.cos() / beta.cos() }
    }

    /// Largest stable curvature when heading straight, 1/m: the largest force offset over c^2.
    pub fn max_curvature(&self) -> f64 {
        self.max_force_offset() / self.pressure.squared()
    }

    /// Least stable turning radius when heading straight, metres; infinite without friction.
    pub fn min_turning_radius(&self) -> f64 {
        self.pressure.rotation_distance(self.max_force_offset())
    }

    /// Least and largest stable curvature (1/m, counter-clockwise positive) while the centre of the
    /// disc heads `heading` radians away from the axis; `None` when no motion that way is stable.
    ///
    /// The moments that four edges can add to a given force form an interval whose ends are reached
    /// by two edges at a time.
    pub fn curvature_range(&self, heading: f64) -> Option<[f64; 2]> {
        let direction = Vector2::new(heading.cos(), heading.sin());
        let [low, high] = self.moment_range(&direction)?;
        Some([low / self.pressure.squared(), high / self.pressure.squared()])
    }

    /// Does the disc stay fixed to the hand during `twist` (hand axes)?
    ///
    /// The border of the stable set counts as stable.
    pub fn is_stable(&self, twist: &Twist) -> bool {
        let needed = self.pressure.wrench_of(twist);
        let Some(direction) = Unit::try_new(needed.force, f64::MIN_POSITIVE) else {
            return needed.moment == 0.0;
        };
        let lever = needed.moment / needed.force.norm();
        self.moment_range(&direction).is_some_and(|[low, high]| (low..=high).contains(&lever))
    }

    /// Range of moments about the centre that the edges can give to the unit force `direction`.
    fn moment_range(&self, direction: &Vector2<f64>) -> Option<[f64; 2]> {
        // Slack for directions that lie on an edge of the force cone up to rounding.
        const SLACK: f64 = 1e-12;
        let edges = self.friction_edges();
        let mut range: Option<[f64; 2]> = None;
        for (i, a) in edges.iter().enumerate() {
            for b in edges.iter().skip(i + 1) {
                let area = cross(&a.force, &b.force);
                if area.abs() < SLACK {
                    continue;
                }
                let share_a = cross(direction, &b.force) / area;
                let share_b = cross(&a.force, direction) / area;
                if share_a >= -SLACK && share_b >= -SLACK {
                    let moment = share_a * a.moment + share_b * b.moment;
                    let [low, high] = range.unwrap_or([moment, moment]);
                    range = Some([low.min(moment), high.max(moment)]);
                }
            }
        }
        range
    }
}

#[cfg(test)]
mod tests;
