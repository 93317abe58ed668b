//! The circle: one angle.

use std::f64::consts::{PI, TAU};

use rand::{Rng, RngExt};

use super::ComponentSpace;
use crate::error::Error;

/// Brings an angle into `(-pi, pi]`.
///
/// Odd (but at `pi`) and exact for angles that are there already, so that turns there and back are equal
/// and tiny turns do not vanish: the remainder is exact, and so is the one subtraction near it.
pub fn wrap(angle_rad: f64) -> f64 {
    let rest = angle_rad % TAU;
    if rest > PI {
        rest - TAU
    } else if rest <= -PI {
        rest + TAU
    } else {
        rest
    }
}

/// Signed shortest turn from `a` to `b`, in `(-pi, pi]`.
pub fn turn(a_rad: f64, b_rad: f64) -> f64 {
    wrap(b_rad - a_rad)
}

/// An angle in `[-pi, pi]`; interpolation takes the shorter way round.
#[derive(Debug, Clone, PartialEq)]
pub struct So2 {
    /// Metres that a reference point travels per radian.
    metres_per_rad: f64,
}

impl So2 {
    /// A circle whose reference point lies `metres_per_rad` metres from the axis.
    ///
    /// # Errors
    /// [`Error::Parameter`] if the radius is not finite and positive.
    pub fn new(metres_per_rad: f64) -> Result<Self, Error> {
        crate::error::in_range("metres_per_rad", metres_per_rad, f64::MIN_POSITIVE, f64::MAX, "finite and positive")?;
        Ok(Self { metres_per_rad })
    }
}

impl ComponentSpace for So2 {
    type Config = f64;

    fn dimension(&self) -> usize {
        1
    }

    fn contains(&self, q: &f64) -> bool {
        (-PI..=PI).contains(q)
    }

    fn distance(&self, a: &f64, b: &f64) -> f64 {
        turn(*a, *b).abs() * self.metres_per_rad
    }

    fn interpolate(&self, a: &f64, b: &f64, t: f64) -> f64 {
        if t <= 0.0 {
            *a
        } else if t >= 1.0 {
            *b
        } else {
            wrap(a + turn(*a, *b) * t)
        }
    }

    fn sample(&self, rng: &mut dyn Rng) -> f64 {
        rng.random_range(-PI..=PI)
    }

    fn index_coordinates(&self, angle_rad: &f64, mark: &mut dyn FnMut(u32, f64)) {
        // A point on the rim: no chord is longer than its arc.
        mark(0, self.metres_per_rad * angle_rad.cos());
        mark(0, self.metres_per_rad * angle_rad.sin());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_wrap_into_the_half_open_circle() {
        for (angle, expected) in [
            (0.0, 0.0),
            (PI, PI),
            (-PI, PI),
            (TAU, 0.0),
            (3.0, 3.0),
            (-3.0, -3.0),
            (4.0, 4.0 - TAU),
            (-4.0, TAU - 4.0),
            (1e-300, 1e-300),
        ] {
            assert_eq!(wrap(angle), expected, "{angle}");
        }
        assert!(wrap(f64::NAN).is_nan());
        for i in -1000..1000_i32 {
            let wrapped = wrap(f64::from(i) * 0.1);
            assert!(wrapped > -PI && wrapped <= PI);
        }
    }

    #[test]
    fn the_shorter_way_round_leads_over_pi() {
        let circle = So2::new(2.0).unwrap();
        assert!((circle.distance(&3.0, &-3.0) - 2.0 * (TAU - 6.0)).abs() < 1e-15);
        assert_eq!(circle.distance(&3.0, &-3.0), circle.distance(&-3.0, &3.0));
        let half = circle.interpolate(&3.0, &-3.0, 0.5);
        assert!((half.abs() - PI).abs() < 1e-15, "{half}");
        assert_eq!(circle.distance(&PI, &-PI), 0.0);
    }

    #[test]
    fn ends_are_kept_bit_for_bit() {
        let circle = So2::new(1.0).unwrap();
        for (a, b) in [(-PI, PI), (PI, -PI), (-0.0, 3.0), (3.0, -0.0), (0.1, 0.1)] {
            assert_eq!(circle.interpolate(&a, &b, 0.0).to_bits(), a.to_bits());
            assert_eq!(circle.interpolate(&a, &b, 1.0).to_bits(), b.to_bits());
        }
    }
}
