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
        Twist {
            linear: wrench.force,
            angular: wrench.moment / self.squared(),
        }
    }

    /// The wrench direction a twist needs: (vx, vy, c^2 om).
    pub fn wrench_of(self, twist: &Twist) -> Wrench {
        Wrench {
            force: twist.linear,
            moment: twist.angular * self.squared(),
        }
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
        (wrench.moment != 0.0)
            .then(|| turned_left(&wrench.force) * (self.squared() / wrench.moment))
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
        Ok(Self {
            pressure,
            max_force,
        })
    }

    /// The limit surface of `mass` kilograms on a level table.
    ///
    /// # Errors
    /// When `mass` or the friction coefficient is not positive.
    pub fn of_mass(
        pressure: PressureConstant,
        mass: f64,
        support_friction: Friction,
    ) -> Result<Self, PrimitiveError> {
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
        (wrench.force.norm_squared() / self.max_force.powi(2)
            + (wrench.moment / self.max_moment()).powi(2))
        .sqrt()
    }

    /// The wrench on the surface that sustains a twist, `None` for no motion.
    pub fn sustaining(&self, twist: &Twist) -> Option<Wrench> {
        let wrench = self.pressure.wrench_of(twist);
        let level = self.level(&wrench);
        (level > 0.0).then(|| Wrench {
            force: wrench.force / level,
            moment: wrench.moment / level,
        })
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
    let sum: f64 = (0..STEPS)
        .map(|i| -FRAC_PI_2 + (f64::from(i) + 0.5) * step)
        .map(|u| integrand(u.sin(), u.cos()))
        .sum();
    sum * step
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn assert_near(found: f64, expected: f64, tolerance: f64) {
        assert!(
            (found - expected).abs() <= tolerance,
            "{found} is not within {tolerance} of {expected}"
        );
    }

    #[test]
    fn pressure_constants_of_standard_supports() {
        for (radius, expected) in [(0.13, 0.086_667), (0.14, 0.093_333), (0.15, 0.1)] {
            let disc = PressureConstant::uniform_disc(radius).unwrap();
            assert_near(disc.meters(), expected, 5e-7);
        }
        assert_eq!(PressureConstant::rim(0.13).unwrap().meters(), 0.13);
        let ring = PressureConstant::ring(0.06, 0.08).unwrap();
        assert_near(ring.meters(), 0.070_476, 5e-7);
        assert_eq!(PressureConstant::line(0.2).unwrap().meters(), 0.05);
        for (a, b, expected) in [
            (1.0, 1.0, 0.382_597_86),
            (0.30, 0.20, 0.096_810_61),
            (0.20, 0.20, 0.076_519_57),
        ] {
            let rectangle = PressureConstant::rectangle(a, b).unwrap();
            assert_near(rectangle.meters(), expected, 5e-9);
        }
    }

    #[test]
    fn a_thin_rectangle_is_a_line_and_a_thin_ring_a_rim() {
        let thin = PressureConstant::rectangle(0.4, 1e-7).unwrap();
        assert_near(thin.meters(), 0.1, 1e-6);
        let ring = PressureConstant::ring(0.1 - 1e-9, 0.1).unwrap();
        assert_near(ring.meters(), 0.1, 1e-8);
    }

    #[test]
    fn a_plate_of_half_a_kilogram() {
        let c = PressureConstant::uniform_disc(0.14).unwrap();
        let plate = LimitSurface::of_mass(c, 0.5, Friction::new(0.3).unwrap()).unwrap();
        assert_near(plate.max_force(), 1.47, 5e-3);
        assert_near(plate.max_moment(), 0.137, 5e-4);
        let idle = Twist {
            linear: Vector2::zeros(),
            angular: 0.0,
        };
        assert_eq!(plate.sustaining(&idle), None);
    }

    /// Columns: rho/R, exact F, exact M, exact h, ellipsoid F, ellipsoid M, ellipsoid h (in R).
    const DISC_TABLE: [[f64; 7]; 6] = [
        [0.25, 0.24803, 0.95368, 2.5633, 0.35112, 0.93633, 1.7778],
        [0.5, 0.48384, 0.82162, 1.1321, 0.60000, 0.80000, 0.8889],
        [1.0, 0.84883, 0.42441, 0.3333, 0.83205, 0.55470, 0.4444],
        [1.5, 0.94082, 0.26070, 0.1847, 0.91381, 0.40614, 0.2963],
        [2.0, 0.96769, 0.19171, 0.1321, 0.94868, 0.31623, 0.2222],
        [4.0, 0.99213, 0.09425, 0.0633, 0.98639, 0.16440, 0.1111],
    ];

    #[test]
    fn exact_disc_and_ellipsoid_table() {
        let c = PressureConstant::uniform_disc(1.0).unwrap();
        let ellipsoid = LimitSurface::new(c, 1.0).unwrap();
        for [rho, force, moment, offset, approx_force, approx_moment, approx_offset] in DISC_TABLE {
            let exact = exact_disc(rho).unwrap();
            assert_near(exact.force, force, 5.1e-6);
            assert_near(exact.moment, moment, 5.1e-6);
            assert_near(exact.offset_in_radii(), offset, 5.1e-5);
            let turning = Twist {
                linear: Vector2::new(0.0, rho),
                angular: 1.0,
            };
            let wrench = ellipsoid.sustaining(&turning).unwrap();
            assert_near(wrench.force.norm(), approx_force, 5.1e-6);
            let moment = wrench.moment / ellipsoid.max_moment();
            assert_near(moment, approx_moment, 5.1e-6);
            assert_near(c.rotation_distance(rho), approx_offset, 5.1e-5);
        }
    }

    #[test]
    fn exact_disc_at_its_ends_and_across_the_rim() {
        let spin = exact_disc(0.0).unwrap();
        assert_near(spin.force, 0.0, 1e-15);
        assert_near(spin.moment, 1.0, 1e-12);
        let slide = exact_disc(1e6).unwrap();
        assert_near(slide.force, 1.0, 1e-10);
        assert_near(slide.moment, 0.0, 1e-5);
        let (inside, outside) = (exact_disc(1.0).unwrap(), exact_disc(1.0 + 1e-12).unwrap());
        assert_near(inside.force, outside.force, 1e-9);
        assert_near(inside.moment, outside.moment, 1e-9);
        assert!(exact_disc(-0.1).is_err());
    }

    #[test]
    fn the_exact_integrals_agree_with_a_sum_over_the_disc() {
        for rho in [0.3, 0.8, 1.7] {
            let (mut force, mut moment, mut count) = (0.0, 0.0, 0.0);
            let cells = 400;
            for ix in -cells..cells {
                for iy in -cells..cells {
                    let x = (f64::from(ix) + 0.5) / f64::from(cells);
                    let y = (f64::from(iy) + 0.5) / f64::from(cells);
                    if x.hypot(y) <= 1.0 {
                        let reach = (x - rho).hypot(y);
                        force += (x - rho) / reach;
                        moment += (x * (x - rho) + y * y) / reach;
                        count += 1.0;
                    }
                }
            }
            let exact = exact_disc(rho).unwrap();
            assert_near(exact.force, (force / count as f64).abs(), 1e-4);
            assert_near(exact.moment, 1.5 * moment / count, 1e-4);
        }
    }

    #[test]
    fn centre_of_rotation_of_the_sharpest_turn() {
        let c = PressureConstant::uniform_disc(0.13).unwrap();
        assert_near(c.rotation_distance(0.041_315), 0.181_80, 5.1e-6);
        let push = Wrench::of_force_at(&Vector2::new(0.0, -0.041_315), Vector2::x());
        let cor = c.center_of_rotation(&push).unwrap();
        // The force passes on the right (y < 0), so the centre of rotation lies on the left.
        assert_near(cor.x, 0.0, 1e-15);
        assert_near(cor.y, 0.181_80, 5.1e-6);
    }

    proptest! {
        #[test]
        fn twist_and_wrench_are_inverse(
            c in 0.01..0.5_f64, fx in -2.0..2.0_f64, fy in -2.0..2.0_f64, m in -0.5..0.5_f64,
        ) {
            let pressure = PressureConstant::new(c).unwrap();
            let wrench = Wrench { force: Vector2::new(fx, fy), moment: m };
            let back = pressure.wrench_of(&pressure.twist_of(&wrench));
            prop_assert!((back.force - wrench.force).norm() < 1e-12);
            prop_assert!((back.moment - wrench.moment).abs() < 1e-12);
        }

        #[test]
        fn the_sustaining_wrench_lies_on_the_surface_and_does_the_most_work(
            vx in -1.0..1.0_f64, vy in -1.0..1.0_f64, om in 0.1..4.0_f64,
            ax in -1.0..1.0_f64, ay in -1.0..1.0_f64, am in -1.0..1.0_f64,
        ) {
            let c = PressureConstant::new(0.09).unwrap();
            let surface = LimitSurface::new(c, 1.5).unwrap();
            let twist = Twist { linear: Vector2::new(vx, vy), angular: om };
            let wrench = surface.sustaining(&twist).unwrap();
            prop_assert!((surface.level(&wrench) - 1.0).abs() < 1e-12);
            let power = |w: &Wrench| w.force.dot(&twist.linear) + w.moment * twist.angular;
            let other = Twist { linear: Vector2::new(ax, ay), angular: am };
            if let Some(rival) = surface.sustaining(&other) {
                prop_assert!(power(&rival) <= power(&wrench) + 1e-12);
            }
        }
    }
}
