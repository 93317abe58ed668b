//! Forward kinematics of one arm as straight-line code: every link pose, no allocation.
//!
//! The numbers are the dimensions of the PR2; [`Pr2Model`](crate::model::Pr2Model) refuses a description with others,
//! and the tests hold this file against the general tree and against reference poses.

pub use darrt_primitives::manipulator::world_from_base;
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector3};

use crate::arm::{ArmConfiguration, Side};
use crate::gripper;

/// Pan axis behind the base frame, m.
pub const SHOULDER_X: f64 = -0.05;
/// Pan axis beside the base frame, m (left positive; mirrored for the right arm).
pub const SHOULDER_Y: f64 = 0.188;
/// Shoulder height above the floor with the torso down, m.
pub const SHOULDER_Z: f64 = 0.790_675;
/// From the pan axis to the lift axis, m.
pub const UPPER_ARM_OFFSET: f64 = 0.1;
/// From the lift axis to the elbow, m.
pub const UPPER_ARM: f64 = 0.4;
/// From the elbow to the wrist centre, m.
pub const FOREARM: f64 = 0.321;
/// From the wrist centre to the tool frame, m.
pub const TOOL: f64 = 0.18;

/// Frames of one arm. Several links of the description share a frame; see [`Frame::links`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Frame {
    /// Turns with joint 1.
    ShoulderPan,
    /// Turns with joint 2.
    ShoulderLift,
    /// Turns with joint 3; carries the upper arm.
    UpperArmRoll,
    /// Turns with joint 4.
    ElbowFlex,
    /// Turns with joint 5; carries the forearm.
    ForearmRoll,
    /// Turns with joint 6.
    WristFlex,
    /// Turns with joint 7; carries the palm.
    WristRoll,
    /// The finger on the palm's +y side.
    LeftFinger,
    /// The finger on the palm's -y side.
    RightFinger,
    /// Tip of the left finger, parallel to the palm.
    LeftFingerTip,
    /// Tip of the right finger, parallel to the palm.
    RightFingerTip,
    /// Between the fingertips: x out of the hand, y the opening axis.
    Tool,
}

impl Frame {
    /// All frames, in the order of [`ArmPoses`].
    pub const ALL: [Self; 12] = [
        Self::ShoulderPan,
        Self::ShoulderLift,
        Self::UpperArmRoll,
        Self::ElbowFlex,
        Self::ForearmRoll,
        Self::WristFlex,
        Self::WristRoll,
        Self::LeftFinger,
        Self::RightFinger,
        Self::LeftFingerTip,
        Self::RightFingerTip,
        Self::Tool,
    ];

    /// Names of the description's links that share this frame, without the side's prefix.
    pub fn links(self) -> &'static [&'static str] {
        match self {
            Self::ShoulderPan => &["shoulder_pan_link"],
            Self::ShoulderLift => &["shoulder_lift_link"],
            Self::UpperArmRoll => &["upper_arm_roll_link", "upper_arm_link"],
            Self::ElbowFlex => &["elbow_flex_link"],
            Self::ForearmRoll => &["forearm_roll_link", "forearm_link"],
            Self::WristFlex => &["wrist_flex_link"],
            Self::WristRoll => &["wrist_roll_link", "gripper_palm_link"],
            Self::LeftFinger => &["gripper_l_finger_link"],
            Self::RightFinger => &["gripper_r_finger_link"],
            Self::LeftFingerTip => &["gripper_l_finger_tip_link"],
            Self::RightFingerTip => &["gripper_r_finger_tip_link"],
            Self::Tool => &["gripper_tool_frame"],
        }
    }
}

/// Poses of all frames of one arm.
#[derive(Debug, Clone, PartialEq)]
pub struct ArmPoses([Isometry3<f64>; 12]);

impl Default for ArmPoses {
    fn default() -> Self {
        Self([Isometry3::identity(); 12])
    }
}

impl ArmPoses {
    /// Pose of one frame.
    pub fn pose(&self, frame: Frame) -> &Isometry3<f64> {
        &self.0[frame as usize]
    }

    /// All poses, in the order of [`Frame::ALL`].
    pub fn as_slice(&self) -> &[Isometry3<f64>] {
        &self.0
    }
}

/// One arm on a torso of fixed height.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ArmChain {
    /// Which arm.
    pub side: Side,
    /// Height of the torso above its lowest position, m.
    pub torso_m: f64,
}

impl ArmChain {
    /// The chain of one arm.
    pub fn new(side: Side, torso_m: f64) -> Self {
        Self { side, torso_m }
    }

    /// Writes the world pose of every frame.
    ///
    /// `base`: x, y (m) and yaw (rad) of the base on the floor. `q`: the seven joints, rad. `finger_angle`: rad, see
    /// [`gripper::finger_angle`].
    pub fn world_from_links(&self, base: &[f64; 3], q: &ArmConfiguration, finger_angle: f64, out: &mut ArmPoses) {
        let mut at = self.walk(base, q, |frame, at| out.0[frame as usize] = at.pose());
        let wrist = out.0[Frame::WristRoll as usize];
        let fingers = gripper::finger_poses(finger_angle);
        out.0[Frame::LeftFinger as usize] = wrist * fingers.left_finger;
        out.0[Frame::RightFinger as usize] = wrist * fingers.right_finger;
        out.0[Frame::LeftFingerTip as usize] = wrist * fingers.left_tip;
        out.0[Frame::RightFingerTip as usize] = wrist * fingers.right_tip;
        at.forward(TOOL);
        out.0[Frame::Tool as usize] = at.pose();
    }

    /// Pose of the tool frame in the base frame.
    pub fn base_from_tool(&self, q: &ArmConfiguration) -> Isometry3<f64> {
        let mut at = self.walk(&[0.0; 3], q, |_, _| ());
        at.forward(TOOL);
        at.pose()
    }

    /// Pose of the tool frame in the world, for a base at x, y (m), yaw (rad).
    pub fn world_from_tool(&self, base: &[f64; 3], q: &ArmConfiguration) -> Isometry3<f64> {
        let mut at = self.walk(base, q, |_, _| ());
        at.forward(TOOL);
        at.pose()
    }

    /// Walks from the base to the wrist, showing every frame; returns the wrist.
    fn walk(&self, base: &[f64; 3], q: &ArmConfiguration, mut show: impl FnMut(Frame, &Walker)) -> Walker {
        let [x, y, yaw] = *base;
        let [q1, q2, q3, q4, q5, q6, q7] = *q;
        let (s, c) = yaw.sin_cos();
        let side = self.side.sign() * SHOULDER_Y;
        let mut at = Walker {
            position: Vector3::new(
                x + c * SHOULDER_X - s * side,
                y + s * SHOULDER_X + c * side,
                SHOULDER_Z + self.torso_m,
            ),
            w: 1.0,
            x: 0.0,
            y: 0.0,
            z: 0.0,
        };
        // Base yaw and pan turn about parallel axes.
        at.turn_z(yaw + q1);
        show(Frame::ShoulderPan, &at);
        at.forward(UPPER_ARM_OFFSET);
        at.turn_y(q2);
        show(Frame::ShoulderLift, &at);
        at.turn_x(q3);
        show(Frame::UpperArmRoll, &at);
        at.forward(UPPER_ARM);
        at.turn_y(q4);
        show(Frame::ElbowFlex, &at);
        at.turn_x(q5);
        show(Frame::ForearmRoll, &at);
        at.forward(FOREARM);
        at.turn_y(q6);
        show(Frame::WristFlex, &at);
        at.turn_x(q7);
        show(Frame::WristRoll, &at);
        at
    }
}

/// A pose that turns about its own axes and moves along its own x.
// OPTIMIZATION: products with quaternions of one nonzero axis, eight multiplications instead of sixteen.
#[derive(Debug, Clone, Copy)]
struct Walker {
    position: Vector3<f64>,
    w: f64,
    x: f64,
    y: f64,
    z: f64,
}

impl Walker {
    fn turn_x(&mut self, angle: f64) {
        let (s, c) = (0.5 * angle).sin_cos();
        let Self { w, x, y, z, .. } = *self;
        (self.w, self.x, self.y, self.z) = (w * c - x * s, x * c + w * s, y * c + z * s, z * c - y * s);
    }

    fn turn_y(&mut self, angle: f64) {
        let (s, c) = (0.5 * angle).sin_cos();
        let Self { w, x, y, z, .. } = *self;
        (self.w, self.x, self.y, self.z) = (w * c - y * s, x * c - z * s, y * c + w * s, z * c + x * s);
    }

    fn turn_z(&mut self, angle: f64) {
        let (s, c) = (0.5 * angle).sin_cos();
        let Self { w, x, y, z, .. } = *self;
        (self.w, self.x, self.y, self.z) = (w * c - z * s, x * c + y * s, y * c - x * s, z * c + w * s);
    }

    fn forward(&mut self, distance: f64) {
        let Self { w, x, y, z, .. } = *self;
        self.position +=
            distance * Vector3::new(1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y));
    }

    fn pose(&self) -> Isometry3<f64> {
        // Products of unit quaternions are unit up to rounding.
        let rotation = UnitQuaternion::new_unchecked(Quaternion::new(self.w, self.x, self.y, self.z));
        Isometry3::from_parts(Translation3::from(self.position), rotation)
    }
}

#[cfg(test)]
mod tests;
