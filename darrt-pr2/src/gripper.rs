//! The gripper: a four-bar whose two fingertips stay parallel, opened by one angle.
//!
//! Wrist frame: x out of the hand, y the opening axis, z the width of the fingers. The numbers come from the joint
//! origins of the description and the collision meshes of fingers and tips.

use nalgebra::{Isometry3, UnitQuaternion, Vector3};

/// Largest finger angle, rad.
pub const MAX_FINGER_ANGLE: f64 = 0.548;
/// Smallest gap asked of the gripper, m.
pub const MIN_GAP: f64 = 0.0;
/// Largest nominal gap, m.
pub const MAX_GAP: f64 = 0.09;
/// Half the width of a fingertip, along z, m.
pub const TIP_HALF_WIDTH: f64 = 0.0113;
/// Half the width of a finger, along z, m.
pub const FINGER_HALF_WIDTH: f64 = 0.0276;

/// Length of a pad from the tip of the finger back, m.
pub const PAD_LENGTH: f64 = 0.036;
/// Force of each finger on what it holds, N: the lower end of what is quoted for this gripper, 50 to 100.
pub const GRIP_FORCE_N: f64 = 50.0;

/// Finger joint in the wrist frame, m (y mirrored for the right finger).
const FINGER_JOINT: (f64, f64) = (0.076_91, 0.01);
/// Tip joint in the finger frame, m (y mirrored for the right finger).
const TIP_JOINT: (f64, f64) = (0.091_37, 0.004_95);
/// How far the pad stands inside the tip joint, m.
const PAD_INSIDE: f64 = 0.015_8;
/// How far the tip reaches beyond its joint, m.
const TIP_BEYOND: f64 = 0.031;
/// How far the tip stands outside its joint, m.
const TIP_OUTSIDE: f64 = 0.028_9;
/// The point of the finger, in its frame, that is outermost while the gripper is nearly closed, m.
const FINGER_OUTERMOST: (f64, f64) = (0.013_5, 0.045_6);

/// Gap between the pads, m, for a finger angle in `[0, 0.548]` rad; the pads overlap by 1.7 mm at zero.
pub fn gap(angle: f64) -> f64 {
    2.0 * (tip_joint_y(angle) - PAD_INSIDE)
}

/// Finger angle, rad, that opens the pads to `gap` (m); a gap out of reach gives the nearest angle in `[0, 0.548]`, and
/// one that is not a number gives zero.
pub fn finger_angle(gap: f64) -> f64 {
    let (x, y) = TIP_JOINT;
    let sine = (gap / 2.0 + PAD_INSIDE - FINGER_JOINT.1) / x.hypot(y);
    let angle = sine.clamp(-1.0, 1.0).asin() - y.atan2(x);
    if angle.is_nan() { 0.0 } else { angle.clamp(0.0, MAX_FINGER_ANGLE) }
}

/// How far the fingertips reach in front of the wrist centre, m.
pub fn fingertip_x(angle: f64) -> f64 {
    tip_joint_x(angle) + TIP_BEYOND
}

/// Half the width of the whole gripper along y, m.
pub fn outer_half_width(angle: f64) -> f64 {
    let (s, c) = angle.sin_cos();
    let finger = FINGER_JOINT.1 + FINGER_OUTERMOST.0 * s + FINGER_OUTERMOST.1 * c;
    finger.max(tip_joint_y(angle) + TIP_OUTSIDE)
}

/// Poses of fingers and tips in the wrist frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FingerPoses {
    /// Finger on the +y side.
    pub left_finger: Isometry3<f64>,
    /// Finger on the -y side.
    pub right_finger: Isometry3<f64>,
    /// Tip on the +y side.
    pub left_tip: Isometry3<f64>,
    /// Tip on the -y side.
    pub right_tip: Isometry3<f64>,
}

/// Where fingers and tips stand in the wrist frame for a finger angle (rad).
pub fn finger_poses(angle: f64) -> FingerPoses {
    let (x, y) = (tip_joint_x(angle), tip_joint_y(angle));
    let turned = |y: f64, angle: f64| {
        let rotation = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle);
        Isometry3::from_parts(Vector3::new(FINGER_JOINT.0, y, 0.0).into(), rotation)
    };
    FingerPoses {
        left_finger: turned(FINGER_JOINT.1, angle),
        right_finger: turned(-FINGER_JOINT.1, -angle),
        left_tip: Isometry3::translation(x, y, 0.0),
        right_tip: Isometry3::translation(x, -y, 0.0),
    }
}

fn tip_joint_x(angle: f64) -> f64 {
    let (s, c) = angle.sin_cos();
    FINGER_JOINT.0 + TIP_JOINT.0 * c - TIP_JOINT.1 * s
}

fn tip_joint_y(angle: f64) -> f64 {
    let (s, c) = angle.sin_cos();
    FINGER_JOINT.1 + TIP_JOINT.0 * s + TIP_JOINT.1 * c
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Angle, gap, fingertip end, outer half width: measured on the collision meshes.
    const MEASURED: [[f64; 4]; 7] = [
        [0.0, -0.0017, 0.1993, 0.0556],
        [0.1, 0.0165, 0.1983, 0.0567],
        [0.2, 0.0344, 0.1965, 0.0619],
        [0.3, 0.0519, 0.1937, 0.0706],
        [0.4, 0.0687, 0.1901, 0.0790],
        [0.5, 0.0847, 0.1857, 0.0870],
        [0.548, 0.0921, 0.1833, 0.0907],
    ];

    #[test]
    fn agrees_with_the_meshes() {
        for [angle, g, end, half] in MEASURED {
            assert!((gap(angle) - g).abs() < 1e-4, "gap({angle}) = {}", gap(angle));
            assert!((fingertip_x(angle) - end).abs() < 1e-4, "{angle}: {}", fingertip_x(angle));
            assert!((outer_half_width(angle) - half).abs() < 1e-4, "{angle}: {}", outer_half_width(angle));
        }
    }

    #[test]
    fn angle_and_gap_are_inverse() {
        for k in 0..=90 {
            let g = f64::from(k) * 1e-3;
            assert!((gap(finger_angle(g)) - g).abs() < 1e-15);
        }
        assert_eq!(finger_angle(1.0), MAX_FINGER_ANGLE);
        assert_eq!(finger_angle(-1.0), 0.0);
        assert_eq!(finger_angle(f64::NAN), 0.0);
        assert_eq!(finger_angle(f64::INFINITY), MAX_FINGER_ANGLE);
    }

    #[test]
    fn tips_are_parallel_to_the_palm_and_mirrored() {
        let poses = finger_poses(0.4);
        assert_eq!(poses.left_tip.rotation, UnitQuaternion::identity());
        assert_eq!(poses.left_tip.translation.y, -poses.right_tip.translation.y);
        assert!((2.0 * (poses.left_tip.translation.y - PAD_INSIDE) - gap(0.4)).abs() < 1e-15);
    }
}
