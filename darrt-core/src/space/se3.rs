//! Pose of a rigid body in a bounded box of space.

use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};
use rand::{Rng, RngExt};

use super::{ComponentSpace, RealBox};
use crate::error::Error;

/// `world_from_body` with the position in a box; a turn of one radian costs `metres_per_rad` metres.
#[derive(Debug, Clone, PartialEq)]
pub struct Se3 {
    position: RealBox<3>,
    metres_per_rad: f64,
}

/// Angle of the shortest rotation from `a` to `b`, in `[0, pi]`; blind to the sign of the quaternions.
pub fn angle_between(a: &UnitQuaternion<f64>, b: &UnitQuaternion<f64>) -> f64 {
    if a == b {
        return 0.0;
    }
    let q = a.conjugate().into_inner() * b.into_inner();
    2.0 * q.imag().norm().atan2(q.w.abs())
}

/// A rotation drawn uniformly.
///
/// # Source
/// Shoemake, Uniform random rotations, Graphics Gems III, 1992.
pub fn uniform_rotation(rng: &mut dyn Rng) -> UnitQuaternion<f64> {
    let u: f64 = rng.random_range(0.0..1.0);
    let (a, b) = (rng.random_range(0.0..std::f64::consts::TAU), rng.random_range(0.0..std::f64::consts::TAU));
    let (p, q) = ((1.0 - u).sqrt(), u.sqrt());
    UnitQuaternion::new_normalize(Quaternion::new(q * b.cos(), p * a.sin(), p * a.cos(), q * b.sin()))
}

impl Se3 {
    /// Positions in `[lower, upper]`, all rotations.
    ///
    /// # Errors
    /// [`Error::Parameter`] for bounds that are not finite or inverted, or a negative `metres_per_rad`.
    pub fn new(lower: [f64; 3], upper: [f64; 3], metres_per_rad: f64) -> Result<Self, Error> {
        crate::error::in_range("metres_per_rad", metres_per_rad, 0.0, f64::MAX, "finite and not negative")?;
        Ok(Self { position: RealBox::new(lower, upper)?, metres_per_rad })
    }

    /// The box of positions.
    pub fn position(&self) -> &RealBox<3> {
        &self.position
    }
}

impl ComponentSpace for Se3 {
    type Config = Isometry3<f64>;

    fn dimension(&self) -> usize {
        6
    }

    fn contains(&self, q: &Isometry3<f64>) -> bool {
        self.position.contains(&q.translation.vector.into()) && (q.rotation.norm() - 1.0).abs() < 1e-6
    }

    fn distance(&self, a: &Isometry3<f64>, b: &Isometry3<f64>) -> f64 {
        let travel = (a.translation.vector - b.translation.vector).norm();
        travel + self.metres_per_rad * angle_between(&a.rotation, &b.rotation)
    }

    fn interpolate(&self, a: &Isometry3<f64>, b: &Isometry3<f64>, t: f64) -> Isometry3<f64> {
        if t <= 0.0 {
            return *a;
        }
        if t >= 1.0 {
            return *b;
        }
        let position = self.position.interpolate(&a.translation.vector.into(), &b.translation.vector.into(), t);
        // Opposite rotations (a half turn) have no unique shortest way; nalgebra then has none, and any
        // fixed axis will do.
        let rotation = a.rotation.try_slerp(&b.rotation, t, 1e-12).unwrap_or_else(|| {
            let axis = (a.rotation.inverse() * b.rotation).axis().unwrap_or(nalgebra::Vector3::z_axis());
            a.rotation * UnitQuaternion::from_axis_angle(&axis, std::f64::consts::PI * t)
        });
        Isometry3::from_parts(Translation3::from(position), rotation)
    }

    fn sample(&self, rng: &mut dyn Rng) -> Isometry3<f64> {
        let position = self.position.sample(rng);
        Isometry3::from_parts(Translation3::from(position), uniform_rotation(rng))
    }
}
