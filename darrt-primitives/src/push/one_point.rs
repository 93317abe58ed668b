//! Pushing with one finger: the twist of the object, and the drift of a disc away from the finger.
//!
//! A disc pushed off its centre turns away from the finger and in the end leaves it; this is why a
//! push uses two fingers. With the ellipsoidal limit surface both phases of the drift, sticking and
//! sliding, have closed forms.

use std::f64::consts::FRAC_PI_2;

use nalgebra::Vector2;

use super::limit_surface::PressureConstant;
use super::motion_cone::{PointContact, disc_half_angle};
use super::{Friction, Twist, cross};
use crate::error::{PrimitiveError, positive, within};

/// What the finger does on the surface of the object.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ContactMode {
    /// No relative motion.
    Sticking,
    /// The contact force is on the left edge of the friction cone (toward normal + 90 degrees).
    SlidingLeftEdge,
    /// The contact force is on the right edge of the friction cone.
    SlidingRightEdge,
}

/// The object's motion under a one-point push.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pushed {
    /// Velocity of the centre of friction and rotation rate, in the units of the pusher velocity.
    pub twist: Twist,
    /// Sticking or sliding.
    pub mode: ContactMode,
}

/// Motion of an object whose `contact` is pushed with `velocity` (m/s, object frame).
///
/// `None` when the pusher does not move into the object.
///
/// # Source
/// Lynch, Maekawa, Tanie 1992 (sticking); Mason 1986 (sliding: the force stays on the cone edge and
/// the normal velocities agree).
pub fn push(contact: &PointContact, pressure: PressureConstant, velocity: &Vector2<f64>) -> Option<Pushed> {
    let approach = velocity.dot(&contact.normal());
    if approach.is_nan() || approach <= 0.0 {
        return None;
    }
    let linear = contact.sticking_force(pressure, velocity);
    let tangential = linear.dot(&contact.tangent());
    if contact.sticks(pressure, velocity) {
        let angular = cross(&contact.point(), &linear) / pressure.squared();
        let twist = Twist { linear, angular };
        return Some(Pushed { twist, mode: ContactMode::Sticking });
    }
    let (share, mode) =
        if tangential > 0.0 { (1.0, ContactMode::SlidingLeftEdge) } else { (-1.0, ContactMode::SlidingRightEdge) };
    let unscaled = pressure.twist_of(&contact.wrench(share));
    // Positive: were it not, this edge of the motion cone would lie behind the contact tangent and
    // every approaching velocity on its side would stick.
    let gain = unscaled.velocity_at(&contact.point()).dot(&contact.normal());
    let rate = approach / gain;
    let twist = Twist { linear: unscaled.linear * rate, angular: unscaled.angular * rate };
    Some(Pushed { twist, mode })
}

/// A disc under a straight one-point push.
///
/// The state is psi, the angle from the push direction to the direction contact-to-centre, in
/// `[-pi/2, pi/2]`; the lateral offset of the centre is R sin psi. Left of the push is positive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DiscDrift {
    radius: f64,
    pressure: PressureConstant,
    friction: Friction,
    cone: f64,
}

/// Where a drifting disc is after some length of push.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drifted {
    /// The angle psi, radians.
    pub psi: f64,
    /// Lateral offset of the centre from the line of the finger, metres: R sin psi.
    pub offset: f64,
    /// How far the disc has turned about itself, radians.
    pub rotation: f64,
    /// Is the finger still touching? False once |psi| has reached 90 degrees.
    pub touching: bool,
}

impl DiscDrift {
    /// A disc of `radius` metres with its support pressure and contact friction.
    ///
    /// # Errors
    /// When `radius` is not finite and positive.
    pub fn new(radius: f64, pressure: PressureConstant, friction: Friction) -> Result<Self, PrimitiveError> {
        let radius = positive("disc radius", radius)?;
        let cone = disc_half_angle(radius, pressure, friction)?;
        Ok(Self { radius, pressure, friction, cone })
    }

    /// The angle psi of a lateral `offset` in metres.
    ///
    /// # Errors
    /// When `offset` is not finite or larger than the radius.
    pub fn psi_of_offset(&self, offset: f64) -> Result<f64, PrimitiveError> {
        let offset = within("lateral offset", offset, -self.radius, self.radius)?;
        Ok((offset / self.radius).asin())
    }

    /// Largest |psi| at which the finger does not slip: half-angle of the motion cone, radians.
    pub fn sticking_limit(&self) -> f64 {
        self.cone
    }

    /// Length over which a small offset grows by the factor e while sticking: (c^2 + R^2)/R, metres.
    pub fn growth_length(&self) -> f64 {
        (self.pressure.squared() + self.radius * self.radius) / self.radius
    }

    /// Length over which a small offset grows by the factor e while sliding: R cos(alpha), metres.
    ///
    /// Equal to R without friction.
    pub fn sliding_growth_length(&self) -> f64 {
        self.radius * self.friction.angle().cos()
    }

    /// The disc after a straight push of `length` metres from angle `psi`.
    ///
    /// # Errors
    /// When `psi` is outside `[-pi/2, pi/2]` or `length` is negative or not finite.
    pub fn advance(&self, psi: f64, length: f64) -> Result<Drifted, PrimitiveError> {
        let start = within("psi", psi, -FRAC_PI_2, FRAC_PI_2)?;
        let length = within("push length", length, 0.0, f64::MAX)?;
        // The law is odd in psi.
        let (psi, rotation) = self.advance_left(start.abs(), length);
        let sign = if start < 0.0 { -1.0 } else { 1.0 };
        Ok(Drifted {
            psi: sign * psi,
            offset: sign * self.radius * psi.sin(),
            rotation: sign * rotation,
            touching: psi < FRAC_PI_2,
        })
    }

    /// Push length that takes the disc from angle `from` to angle `to`, metres.
    ///
    /// Both angles on the same side, `|from| <= |to|`; infinite when `from` is 0 and `to` is not
    /// (the unstable equilibrium), 0 when they are equal.
    ///
    /// # Errors
    /// When an angle is not finite, `to` is outside `[-pi/2, pi/2]`, or `from` is not between 0 and `to`.
    pub fn length_between(&self, from: f64, to: f64) -> Result<f64, PrimitiveError> {
        let to = within("final psi", to, -FRAC_PI_2, FRAC_PI_2)?;
        let from = within("initial psi", from, to.min(0.0), to.max(0.0))?;
        let (from, to) = (from.abs(), to.abs());
        let sticking_end = to.min(self.cone).max(from);
        Ok(self.sticking_length(from, sticking_end) + self.sliding_length(sticking_end, to))
    }

    /// (psi, rotation) after `length`, for `psi` in `[0, pi/2]`.
    fn advance_left(&self, psi: f64, length: f64) -> (f64, f64) {
        let edge = self.cone.min(FRAC_PI_2);
        let to_edge = self.sticking_length(psi, edge.max(psi));
        if length <= to_edge {
            let end = grown(psi, length / self.growth_length()).min(FRAC_PI_2);
            return (end, end - psi);
        }
        let from = edge.max(psi);
        let alpha = self.friction.angle();
        let growth = (length - to_edge) / self.sliding_growth_length();
        let end = (alpha + grown(from - alpha, growth)).min(FRAC_PI_2);
        (end, from - psi + self.sliding_rotation(from, end))
    }

    /// Length from `from` to `to` while sticking: integral of (c^2 + R^2) / (R sin psi).
    fn sticking_length(&self, from: f64, to: f64) -> f64 {
        length_of_growth(from, to, self.growth_length())
    }

    /// Length from `from` to `to` while sliding: integral of R / (sin psi - mu cos psi), where
    /// sin psi - mu cos psi = sin(psi - alpha) / cos(alpha).
    fn sliding_length(&self, from: f64, to: f64) -> f64 {
        let alpha = self.friction.angle();
        length_of_growth(from - alpha, to - alpha, self.sliding_growth_length())
    }

    /// Rotation of the disc between two angles while sliding: the integral of the moment
    /// mu R cos(psi) / c^2 along the push.
    fn sliding_rotation(&self, from: f64, to: f64) -> f64 {
        let (alpha, mu) = (self.friction.angle(), self.friction.coefficient());
        if mu == 0.0 || to <= from {
            return 0.0;
        }
        let (a, b) = (from - alpha, to - alpha);
        let gain = mu * self.radius * self.radius / self.pressure.squared() * alpha.cos();
        gain * (alpha.cos() * (b.sin() / a.sin()).ln() - alpha.sin() * (b - a))
    }
}

/// Solution of d(angle)/ds = sin(angle): tan(angle/2) grows by e^s.
fn grown(angle: f64, s: f64) -> f64 {
    2.0 * ((0.5 * angle).tan() * s.exp()).atan()
}

/// Length over which `grown` (with the given e-fold `scale`) takes `from` to `to`; 0 when equal.
fn length_of_growth(from: f64, to: f64, scale: f64) -> f64 {
    if to <= from { 0.0 } else { scale * ((0.5 * to).tan() / (0.5 * from).tan()).ln() }
}

#[cfg(test)]
mod tests;
