//! How far a held object leans from the vertical, and how far it may: what is full must not be spilt.

use nalgebra::Isometry3;

use crate::manipulator::{Configuration, Manipulator};
use crate::mobile_arm_space::difference;
use crate::object_space::own_axis;
use crate::tabletop::{Tabletop, TabletopState};

/// Between two states that are looked at a held object may lean this much farther than at them, radians. The states looked
/// at keep so much away from the limit that the limit holds between them as well.
pub(crate) const UNSEEN_RAD: f64 = 0.5 * std::f64::consts::PI / 180.0;

/// Angle between an object's own z axis and the vertical, radians in `[0, pi]`.
pub fn tilt_rad(world_from_object: &Isometry3<f64>) -> f64 {
    let axis = own_axis(world_from_object);
    axis.x.hypot(axis.y).atan2(axis.z)
}

impl<M: Manipulator> Tabletop<M> {
    /// How much farther the held object of `state` may lean, radians: negative beyond its limit, `None` where nothing is
    /// held or any tilt will do.
    pub fn tilt_left_rad(&self, state: &TabletopState<M>) -> Option<f64> {
        let held = state.mode.held()?;
        let limit = self.tilt_limit_rad(held);
        if limit >= std::f64::consts::PI {
            return None;
        }
        Some(limit - UNSEEN_RAD - tilt_rad(state.object(held.object)?))
    }

    /// Bound on the angle by which anything rigid to the tool tilts while the arm moves straight from `a` to `b`, radians:
    /// no more than its joints turn. The base turns about the vertical and tilts nothing.
    pub fn tilt_travel_rad(&self, a: &Configuration<M::Joints>, b: &Configuration<M::Joints>) -> f64 {
        let joints = a.arm.as_ref().iter().zip(b.arm.as_ref()).zip(self.manipulator().limits());
        joints.map(|((p, q), limit)| difference(*p, *q, limit).abs()).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{UnitQuaternion, Vector3};

    #[test]
    fn the_tilt_is_the_angle_of_the_axis_whatever_the_yaw() {
        for degrees in [0.0_f64, 1e-4, 30.0, 90.0, 179.0, 180.0] {
            for yaw in [0.0, 1.0, -2.5] {
                let lean = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), degrees.to_radians());
                let turned = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw) * lean;
                let pose = Isometry3::from_parts(Vector3::new(1.0, -2.0, 0.5).into(), turned);
                assert!((tilt_rad(&pose) - degrees.to_radians()).abs() < 1e-7, "{degrees} {yaw}");
            }
        }
    }
}
