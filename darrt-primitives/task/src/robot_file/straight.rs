//! Right angles that a description writes with few digits.
//!
//! A right angle written as 1.5708, or as 1.57, tilts all that comes after it a little. Six joints make up for that; the hand of an arm
//! of fewer never points straight down then, nor lies level, as objects want it.

use darrt_primitives::kinematics::RobotDescription;
use nalgebra::{Matrix3, Rotation3, Unit, UnitQuaternion, Vector3};

/// What is as near to right angles is meant as such, radians: 3.14 for pi.
const MEANT_RAD: f64 = 2e-3;
/// What is as near is one, but for rounding, radians.
const ROUNDING_RAD: f64 = 1e-14;

/// Makes the angles right that are meant so, between the root and `tip`, of the places of joints and of their axes. The names of the
/// joints that were changed, from the root outwards.
pub(super) fn straighten(description: &mut RobotDescription, tip: usize) -> Vec<String> {
    let mut changed = Vec::new();
    let mut link = tip;
    while let Some(joint) = description.joints.iter_mut().find(|joint| joint.child == link) {
        let rotation = right_angles(&joint.parent_from_child.rotation);
        let axis = along_one(&joint.axis);
        if rotation.is_some() || axis.is_some() {
            joint.parent_from_child.rotation = rotation.unwrap_or(joint.parent_from_child.rotation);
            joint.axis = axis.unwrap_or(joint.axis);
            changed.push(joint.name.to_string());
        }
        link = joint.parent;
    }
    changed.reverse();
    changed
}

/// The rotation by right angles that is meant; `None` if there is none, or it is there.
fn right_angles(rotation: &UnitQuaternion<f64>) -> Option<UnitQuaternion<f64>> {
    let rounded: Matrix3<f64> = rotation.to_rotation_matrix().matrix().map(f64::round);
    let is_rotation = rounded.transpose() * rounded == Matrix3::identity() && rounded.determinant() > 0.0;
    let meant = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(rounded));
    let apart_rad = meant.rotation_to(rotation).vector().norm() * 2.0;
    (is_rotation && apart_rad <= MEANT_RAD && apart_rad > ROUNDING_RAD).then_some(meant)
}

/// The same of an axis.
fn along_one(axis: &Unit<Vector3<f64>>) -> Option<Unit<Vector3<f64>>> {
    let rounded: Vector3<f64> = axis.map(f64::round);
    let apart = (rounded - axis.into_inner()).norm();
    (rounded.norm() == 1.0 && apart <= MEANT_RAD && apart > ROUNDING_RAD).then(|| Unit::new_unchecked(rounded))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    #[test]
    #[expect(clippy::approx_constant, reason = "as people write them")]
    fn what_is_meant_as_a_right_angle_is_one() {
        let turned = |roll: f64, pitch: f64, yaw: f64| UnitQuaternion::from_euler_angles(roll, pitch, yaw);
        for (written, meant) in [
            (turned(1.5708, 0.0, 0.0), turned(FRAC_PI_2, 0.0, 0.0)),
            (turned(3.14, 0.0, -1.57), turned(PI, 0.0, -FRAC_PI_2)),
            (turned(0.0, 1e-4, 0.0), UnitQuaternion::identity()),
        ] {
            let found = right_angles(&written).unwrap();
            assert!(found.angle_to(&meant) < 1e-7 && (found * Vector3::z() - meant * Vector3::z()).norm() < 1e-12);
            assert_eq!(right_angles(&found), None, "it is one now");
        }
        assert_eq!(right_angles(&turned(0.3, 0.0, 0.0)), None);
        assert_eq!(right_angles(&turned(0.01, 0.0, 0.0)), None, "so much is meant");
        assert_eq!(right_angles(&UnitQuaternion::identity()), None);
        let axis = |x: f64, y: f64, z: f64| Unit::new_normalize(Vector3::new(x, y, z));
        assert_eq!(along_one(&axis(0.0, 1e-4, -1.0)), Some(-Vector3::z_axis()));
        assert_eq!(along_one(&axis(0.0, 0.6, 0.8)), None);
        assert_eq!(along_one(&Vector3::x_axis()), None);
    }
}
