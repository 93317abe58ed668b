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

/// Angle of the shortest rotation from `a` to `b`, in `[0, pi]`; blind to the sign of the quaternions,
/// and symmetric and zero for equal rotations without rounding.
///
/// # Source
/// Kahan's angle between unit vectors, `2 atan2(|a - b|, |a + b|)`; rotations turn by twice the angle
/// between their quaternions.
pub fn angle_between(a: &UnitQuaternion<f64>, b: &UnitQuaternion<f64>) -> f64 {
    let apart = (a.into_inner() - b.into_inner()).norm();
    let opposite = (a.into_inner() + b.into_inner()).norm();
    4.0 * apart.min(opposite).atan2(apart.max(opposite))
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

    fn index_coordinates(&self, q: &Isometry3<f64>, mark: &mut dyn FnMut(u32, f64)) {
        q.translation.vector.iter().for_each(|x| mark(0, *x));
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use nalgebra::Vector3;

    use super::*;
    use crate::random::{Purpose, stream};

    fn space() -> Se3 {
        Se3::new([-1.0; 3], [1.0; 3], 0.3).unwrap()
    }

    fn turned(axis: Vector3<f64>, angle: f64) -> UnitQuaternion<f64> {
        UnitQuaternion::from_scaled_axis(axis * angle)
    }

    fn opposite(q: &UnitQuaternion<f64>) -> UnitQuaternion<f64> {
        UnitQuaternion::new_unchecked(-q.into_inner())
    }

    #[test]
    fn angles_are_exact_from_tiny_to_a_half_turn() {
        let a = turned(Vector3::new(1.0, 2.0, 3.0), 0.4);
        for angle in [0.0, 1e-9, 1e-3, FRAC_PI_2, 3.0, PI] {
            let b = a * turned(Vector3::y(), angle);
            assert!((angle_between(&a, &b) - angle).abs() < 1e-14 + 1e-7 * angle.min(1e-8), "{angle}");
            assert_eq!(angle_between(&a, &b), angle_between(&b, &a));
            assert!((angle_between(&opposite(&a), &b) - angle).abs() < 1e-14);
        }
        assert_eq!(angle_between(&a, &a), 0.0);
        assert_eq!(angle_between(&a, &opposite(&a)), 0.0);
        assert!((angle_between(&a, &(a * turned(Vector3::x(), 3.5))) - (2.0 * PI - 3.5)).abs() < 1e-14);
    }

    #[test]
    fn quaternions_of_either_sign_interpolate_the_short_way() {
        let a = Isometry3::from_parts(Translation3::identity(), turned(Vector3::z(), 0.2));
        let b = Isometry3::from_parts(Translation3::new(0.5, 0.0, 0.0), turned(Vector3::z(), 0.8));
        let flipped = Isometry3::from_parts(b.translation, opposite(&b.rotation));
        for b in [b, flipped] {
            let half = space().interpolate(&a, &b, 0.5);
            assert!(angle_between(&half.rotation, &turned(Vector3::z(), 0.5)) < 1e-12);
            assert_eq!(space().interpolate(&a, &b, 0.0), a);
            assert_eq!(space().interpolate(&a, &b, 1.0), b);
            assert_eq!(space().interpolate(&a, &b, 1.0).rotation.w.to_bits(), b.rotation.w.to_bits());
        }
    }

    #[test]
    fn the_same_rotation_with_the_other_sign_stays_put() {
        let a = Isometry3::from_parts(Translation3::identity(), turned(Vector3::x(), 1.0));
        let b = Isometry3::from_parts(Translation3::identity(), opposite(&a.rotation));
        assert_eq!(space().distance(&a, &b), 0.0);
        for i in 0..=8_u8 {
            let q = space().interpolate(&a, &b, f64::from(i) / 8.0);
            assert!(space().distance(&a, &q) < 1e-12 && space().contains(&q));
        }
    }

    #[test]
    fn a_half_turn_has_some_way_and_keeps_to_it() {
        let a = Isometry3::identity();
        let b = Isometry3::from_parts(Translation3::identity(), turned(Vector3::z(), PI));
        let mut last = 0.0;
        for i in 0..=20_u8 {
            let q = space().interpolate(&a, &b, f64::from(i) / 20.0);
            let turned = angle_between(&a.rotation, &q.rotation);
            assert!(space().contains(&q) && turned >= last - 1e-12, "{turned} after {last}");
            last = turned;
        }
        assert!((last - PI).abs() < 1e-12);
    }

    #[test]
    fn random_rotations_are_rotations_and_spread_over_all_axes() {
        let mut rng = stream(1, 0, 0, Purpose::Sample);
        let mut mean = Vector3::zeros();
        for _ in 0..4000 {
            let q = space().sample(&mut rng);
            assert!(space().contains(&q));
            mean += q.rotation * Vector3::x() / 4000.0;
        }
        assert!(mean.norm() < 0.05, "{mean}");
    }
}
