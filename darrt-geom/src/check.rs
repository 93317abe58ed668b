//! Checks shared by the constructors of this crate. A name is only put together when something is wrong.

use crate::error::GeomError;
use nalgebra::{Isometry3, Point3};
use std::fmt::Display;

/// Smallest length of a shape, in metres.
pub const MINIMUM_LENGTH: f64 = 1e-6;
/// Largest length of a shape and largest coordinate of a pose, in metres.
pub const MAXIMUM_LENGTH: f64 = 1e4;

/// `value`, when it is finite and in `[minimum, maximum]`.
pub(crate) fn in_range(name: impl Display + Copy, value: f64, minimum: f64, maximum: f64) -> Result<f64, GeomError> {
    if !value.is_finite() {
        return Err(GeomError::NotFinite { name: name.to_string(), value });
    }
    if value < minimum || value > maximum {
        return Err(GeomError::OutOfRange { name: name.to_string(), value, minimum, maximum });
    }
    Ok(value)
}

/// A length of a shape: in `[MINIMUM_LENGTH, MAXIMUM_LENGTH]` metres.
pub(crate) fn length(name: impl Display + Copy, value: f64) -> Result<f64, GeomError> {
    in_range(name, value, MINIMUM_LENGTH, MAXIMUM_LENGTH)
}

/// A coordinate: in `[-MAXIMUM_LENGTH, MAXIMUM_LENGTH]` metres.
pub(crate) fn coordinate(name: impl Display + Copy, value: f64) -> Result<f64, GeomError> {
    in_range(name, value, -MAXIMUM_LENGTH, MAXIMUM_LENGTH)
}

/// A point whose coordinates are all in range.
pub(crate) fn point(name: impl Display + Copy, p: &Point3<f64>) -> Result<(), GeomError> {
    p.iter().try_for_each(|&x| coordinate(name, x).map(drop))
}

/// A pose with finite, bounded translation and a quaternion of length one (to 1e-6).
pub(crate) fn pose(name: impl Display + Copy, pose: &Isometry3<f64>) -> Result<(), GeomError> {
    point(name, &Point3::from(pose.translation.vector))?;
    let norm = pose.rotation.as_ref().norm();
    in_range(format_args!("quaternion length of {name}"), norm, 1.0 - 1e-6, 1.0 + 1e-6).map(drop)
}

/// A list whose length is in `[minimum, maximum]`.
pub(crate) fn count(name: impl Display + Copy, count: usize, minimum: usize, maximum: usize) -> Result<(), GeomError> {
    if count < minimum || count > maximum {
        return Err(GeomError::Count { name: name.to_string(), count, minimum, maximum });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pose_must_be_finite_bounded_and_unit() {
        assert!(pose("p", &Isometry3::identity()).is_ok());
        assert!(pose("p", &Isometry3::translation(f64::NAN, 0.0, 0.0)).is_err());
        assert!(pose("p", &Isometry3::translation(0.0, 2e4, 0.0)).is_err());
        let mut long = Isometry3::identity();
        long.rotation = nalgebra::UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(1.1, 0.0, 0.0, 0.0));
        assert!(pose("p", &long).is_err());
    }

    #[test]
    fn ranges_are_closed() {
        assert!(length("l", MINIMUM_LENGTH).is_ok() && length("l", MAXIMUM_LENGTH).is_ok());
        assert!(length("l", 0.0).is_err() && length("l", f64::INFINITY).is_err());
        assert!(count("c", 0, 1, 2).is_err() && count("c", 3, 1, 2).is_err() && count("c", 2, 1, 2).is_ok());
    }
}
