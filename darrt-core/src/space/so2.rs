//! The circle: one angle.

use std::f64::consts::{PI, TAU};

use rand::{Rng, RngExt};

use super::ComponentSpace;
use crate::error::Error;

/// Brings an angle into `(-pi, pi]`.
pub fn wrap(angle_rad: f64) -> f64 {
    let wrapped = (angle_rad + PI).rem_euclid(TAU) - PI;
    if wrapped <= -PI { PI } else { wrapped }
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
}
