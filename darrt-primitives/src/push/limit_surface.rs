//! The limit surface: which motion a sliding wrench causes.
//!
//! A wrench that makes the object slide lies on the limit surface, and the twist is its outward
//! normal there (Goyal, Ruina, Papadopoulos 1991). The planner uses the ellipsoidal approximation
//! of Lee and Cutkosky (1991) and Howe and Cutkosky (1996),
//!
//! ```text
//! (fx^2 + fy^2) / fmax^2 + m^2 / mmax^2 = 1,     fmax = mu_s N,   mmax = c fmax
//! twist (vx, vy, om) is parallel to (fx, fy, m / c^2)
//! ```
//!
//! where the length c, the *pressure constant*, is the mean distance of the support pressure from
//! the centre of friction. [`exact_disc`] gives the exact values for a uniformly pressed disc.

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::Vector2;

use super::{Friction, GRAVITY, Twist, Wrench, turned_left};
use crate::error::{PrimitiveError, positive, within};

/// The pressure constant c: mean distance of the support pressure from the centre of friction, metres.
///
/// A dinner plate stands on a foot ring of 0.55 to 0.65 of its radius, so its c is close to that of
/// the uniform disc; a flat disc warped onto its rim has c = R.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub struct PressureConstant(f64);

impl PressureConstant {
    /// A known constant in metres.
    ///
    /// # Errors
    /// When `meters` is not finite and positive.
    pub fn new(meters: f64) -> Result<Self, PrimitiveError> {
        positive("pressure constant", meters).map(Self)
    }

    /// Uniform pressure under a disc of `radius`: 2R/3.
    ///
    /// # Errors
    /// When `radius` is not finite and positive.
    pub fn uniform_disc(radius: f64) -> Result<Self, PrimitiveError> {
        Ok(Self(2.0 / 3.0 * positive("disc radius", radius)?))
    }

    /// All pressure on a thin ring of `radius`: R.
    ///
    /// # Errors
    /// When `radius` is not finite and positive.
    pub fn rim(radius: f64) -> Result<Self, PrimitiveError> {
        positive("rim radius", radius).map(Self)
    }

    /// Uniform pressure on the ring between two radii.
    ///
    /// # Errors
    /// When a radius is not positive, or `inner` is not below `outer`.
    pub fn ring(inner: f64, outer: f64) -> Result<Self, PrimitiveError> {
        let outer = positive("outer ring radius", outer)?;
        let inner = crate::error::positive_below("inner ring radius", inner, outer)?;
        // (r2^3 - r1^3) / (r2^2 - r1^2) with the common factor r2 - r1 divided out.
        let ratio = (outer * outer + outer * inner + inner * inner) / (outer + inner);
        Ok(Self(2.0 / 3.0 * ratio))
    }

    /// Uniform pressure under an `a` by `b` rectangle.
    ///
    /// # Errors
    /// When a side is not finite and positive.
    pub fn rectangle(a: f64, b: f64) -> Result<Self, PrimitiveError> {
        let a = positive("rectangle side", a)?;
        let b = positive("rectangle side", b)?;
        let d = a.hypot(b);
        let along_a = a * a / b * ((b + d) / a).ln();
        let along_b = b * b / a * ((a + d) / b).ln();
        Self::new((2.0 * d + along_a + along_b) / 12.0)
    }

    /// Uniform pressure under a line of `length`: L/4.
    ///
    /// # Errors
    /// When `length` is not finite and positive.
    pub fn line(length: f64) -> Result<Self, PrimitiveError> {
        Ok(Self(positive("line length", length)? / 4.0))
    }

    /// The constant in metres.
    pub fn meters(self) -> f64 {
        self.0
    }

    /// Its square, the factor between moment and rotation.
    pub fn squared(self) -> f64 {
        self.0 * self.0
    }

    /// The twist direction a wrench causes: (fx, fy, m/c^2).
    ///
    /// # Source
    /// Lee and Cutkosky 1991; Howe and Cutkosky 1996.
    pub fn twist_of(self, wrench: &Wrench) -> Twist {
        Twist { linear: wrench.force, angular: wrench.moment / self.squared() }
    }

    /// The wrench direction a twist needs: (vx, vy, c^2 om).
    pub fn wrench_of(self, twist: &Twist) -> Wrench {
        Wrench { force: twist.linear, moment: twist.angular * self.squared() }
    }

    /// Distance from the centre to the centre of rotation for a force line at distance `offset`
    /// (metres): c^2/h, on the other side of the centre. Infinite for `offset` = 0.
    ///
    /// The relation is its own inverse: the same call gives the offset for a distance.
    pub fn rotation_distance(self, offset: f64) -> f64 {
        self.squared() / offset.abs()
    }

    /// Centre of rotation (object frame) a wrench causes, `None` for a pure force through the centre.
    pub fn center_of_rotation(self, wrench: &Wrench) -> Option<Vector2<f64>> {
        (wrench.moment != 0.0).then(|| turned_left(&wrench.force) * (self.squared() / wrench.moment))
    }
}

/// An ellipsoidal limit surface with its absolute size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LimitSurface {
    pressure: PressureConstant,
    max_force: f64,
}

impl LimitSurface {
    /// A limit surface whose largest force is `max_force` newtons.
    ///
    /// # Errors
    /// When `max_force` is not finite and positive.
    pub fn new(pressure: PressureConstant, max_force: f64) -> Result<Self, PrimitiveError> {
        let max_force = positive("largest friction force", max_force)?;
        Ok(Self { pressure, max_force })
    }

    /// The limit surface of `mass` kilograms on a level table.
    ///
    /// # Errors
    /// When `mass` or the friction coefficient is not positive.
    pub fn of_mass(pressure: PressureConstant, mass: f64, support_friction: Friction) -> Result<Self, PrimitiveError> {
        let mass = positive("mass", mass)?;
        Self::new(pressure, support_friction.coefficient() * mass * GRAVITY)
    }

    /// Force of a pure translation, N.
    pub fn max_force(&self) -> f64 {
        self.max_force
    }

    /// Moment of a pure rotation, N m.
    pub fn max_moment(&self) -> f64 {
        self.pressure.meters() * self.max_force
    }

    /// Where a wrench stands: below 1 nothing moves, 1 is on the surface.
    pub fn level(&self, wrench: &Wrench) -> f64 {
        (wrench.force.norm_squared() / self.max_force.powi(2) + (wrench.moment / self.max_moment()).powi(2)).sqrt()
    }

    /// The wrench on the surface that sustains a twist, `None` for no motion.
    pub fn sustaining(&self, twist: &Twist) -> Option<Wrench> {
        let wrench = self.pressure.wrench_of(twist);
        let level = self.level(&wrench);
        (level > 0.0).then(|| Wrench { force: wrench.force / level, moment: wrench.moment / level })
    }
}

/// Force and moment of a rotating disc as fractions of the largest of each.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DiscWrench {
    /// |F| / fmax, in `[0, 1]`.
    pub force: f64,
    /// |M| / mmax with mmax = (2R/3) fmax, in `[0, 1]`.
    pub moment: f64,
}

impl DiscWrench {
    /// Distance of the force line from the centre, in radii: M / F.
    pub fn offset_in_radii(&self) -> f64 {
        2.0 / 3.0 * self.moment / self.force
    }
}

/// Exact wrench of a uniformly pressed disc turning about a point `rho_in_radii` radii from its
/// centre (0 to 10^6), by numeric integration.
///
/// In polar coordinates about the centre of rotation the radial integral is elementary; what is left
/// is, with k = rho/R,
///
/// ```text
/// k <= 1:  F = (k/pi) I cos^2 p sqrt(1 - k^2 sin^2 p) dp      M = (1/2pi) I (1 - k^2 sin^2 p)^(3/2) dp   over 0..2pi
/// k >= 1:  F = (2/pi) I cos^2 u sqrt(1 - sin^2 u / k^2) du    M = (1/(k pi)) I cos^4 u / sqrt(1 - sin^2 u / k^2) du   over -pi/2..pi/2
/// ```
///
/// All four are smooth and periodic, so equal steps converge faster than any power of the step.
///
/// # Errors
/// When `rho_in_radii` is not finite or outside `[0, 10^6]`.
///
/// # Source
/// The integrals of Goyal, Ruina, Papadopoulos 1991 for a disc, reduced by hand.
pub fn exact_disc(rho_in_radii: f64) -> Result<DiscWrench, PrimitiveError> {
    let k = within("distance of the centre of rotation", rho_in_radii, 0.0, 1e6)?;
    let (force, moment) = if k <= 1.0 {
        // Each integrand has period pi: twice the integral over half the circle.
        let root = |s: f64| (1.0 - k * k * s * s).max(0.0).sqrt();
        let f = over_half_circle(|s, c| c * c * root(s));
        let m = over_half_circle(|s, _| root(s).powi(3));
        (2.0 * k / PI * f, m / PI)
    } else {
        let root = |s: f64| (1.0 - s * s / (k * k)).max(0.0).sqrt();
        let f = over_half_circle(|s, c| c * c * root(s));
        let m = over_half_circle(|s, c| c.powi(4) / root(s));
        (2.0 / PI * f, m / (k * PI))
    };
    Ok(DiscWrench { force, moment })
}

/// Midpoint sum of `integrand(sin u, cos u)` over -pi/2..pi/2.
fn over_half_circle(integrand: impl Fn(f64, f64) -> f64) -> f64 {
    const STEPS: u32 = 1024;
    let step = PI / f64::from(STEPS);
    let sum: f64 =
        (0..STEPS).map(|i| -FRAC_PI_2 + (f64::from(i) + 0.5) * step).map(|u| integrand(u.sin(), u.cos())).sum();
    sum * step
}

#[cfg(test)]
mod tests;
