//! One arm of the PR2: joint limits, forward kinematics of the tool, closed-form inverse kinematics.
//!
//! The chain, from the base frame on the floor (x forward, y left, z up): up and sideways to the shoulder, then
//! `Rz(q1) Tx(0.1) Ry(q2) Rx(q3) Tx(0.4) Ry(q4) Rx(q5) Tx(0.321) Ry(q6) Rx(q7) Tx(0.18)` to the tool frame between the
//! fingertips. Joints in this order: shoulder pan, shoulder lift, upper arm roll, elbow flex, forearm roll, wrist flex,
//! wrist roll. Seven joints for six numbers of a pose: one joint is chosen, the rest follows.
//!
//! | question | file |
//! |---|---|
//! | which configurations reach this pose, for one choice of the free joint? | [`Arm::inverse`], [`Arm::inverse_with_pan`] |
//! | the same for eight choices at once? | [`Arm::inverse_for_rolls`], [`many_rolls`] |
//! | any configuration that reaches this pose; the one nearest to here? | [`Arm::inverse_any`], [`Arm::inverse_near`] |
//! | how far does any point of the arm travel when joints move? | [`travel`] |

mod closed_form;
pub mod many_rolls;
mod search;
pub mod travel;

use arrayvec::ArrayVec;
use darrt_primitives::kinematics::JointLimit;
use nalgebra::Isometry3;

use crate::forward::ArmChain;
use crate::model::ModelError;

/// Joint values of one arm, rad: pan, lift, upper arm roll, elbow, forearm roll, wrist flex, wrist roll.
pub type ArmConfiguration = [f64; 7];

/// Solutions of one call of the inverse: at most eight exist.
pub type Solutions = ArrayVec<ArmConfiguration, 8>;

/// Names of the seven joints, without side and `_joint`.
pub const JOINT_NAMES: [&str; 7] =
    ["shoulder_pan", "shoulder_lift", "upper_arm_roll", "elbow_flex", "forearm_roll", "wrist_flex", "wrist_roll"];

/// Travel of the torso, m (hard limits).
pub const TORSO_RANGE: JointLimit = JointLimit::new(0.0, 0.33);

/// Which arm.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Side {
    /// The robot's right, y negative.
    Right,
    /// The robot's left, y positive.
    Left,
}

impl Side {
    /// Both, right first.
    pub const BOTH: [Self; 2] = [Self::Right, Self::Left];

    /// The other arm.
    #[must_use]
    pub fn other(self) -> Self {
        match self {
            Self::Right => Self::Left,
            Self::Left => Self::Right,
        }
    }

    /// Sign of y: -1 right, +1 left.
    pub fn sign(self) -> f64 {
        match self {
            Self::Right => -1.0,
            Self::Left => 1.0,
        }
    }

    /// First letter of link and joint names: `r` or `l`.
    pub fn prefix(self) -> char {
        match self {
            Self::Right => 'r',
            Self::Left => 'l',
        }
    }

    /// 0 right, 1 left.
    pub fn index(self) -> usize {
        match self {
            Self::Right => 0,
            Self::Left => 1,
        }
    }
}

/// Which of the two sets of joint limits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LimitKind {
    /// The safety controller's: inside the hard ones by 0.1 to 0.2 rad, away from the singular postures.
    #[default]
    Soft,
    /// The mechanical ones.
    Hard,
}

/// One arm at a fixed torso height.
#[derive(Debug, Clone, PartialEq)]
pub struct Arm {
    /// Which arm.
    pub side: Side,
    /// Height of the torso above its lowest position, m, in [`TORSO_RANGE`].
    pub torso_m: f64,
    /// Limits of the seven joints, rad.
    pub limits: [JointLimit; 7],
}

impl Arm {
    /// An arm of the stock PR2.
    ///
    /// # Errors
    /// [`ModelError::Torso`] when `torso_m` is outside [`TORSO_RANGE`] or not a number.
    pub fn new(side: Side, torso_m: f64, limits: LimitKind) -> Result<Self, ModelError> {
        Self::with_limits(side, torso_m, stock_limits(side, limits))
    }

    /// An arm with the given joint limits (a turning joint without limits: [`JointLimit::UNLIMITED`]).
    ///
    /// # Errors
    /// [`ModelError::Torso`] when `torso_m` is outside [`TORSO_RANGE`] or not a number.
    pub fn with_limits(side: Side, torso_m: f64, limits: [JointLimit; 7]) -> Result<Self, ModelError> {
        if !TORSO_RANGE.contains(torso_m) {
            return Err(ModelError::Torso { value: torso_m, lower: TORSO_RANGE.lower, upper: TORSO_RANGE.upper });
        }
        Ok(Self { side, torso_m, limits })
    }

    /// Pose of the tool frame in the base frame.
    pub fn base_from_tool(&self, q: &ArmConfiguration) -> Isometry3<f64> {
        ArmChain::new(self.side, self.torso_m).base_from_tool(q)
    }

    /// Whether every joint is inside its limits.
    pub fn within_limits(&self, q: &ArmConfiguration) -> bool {
        q.iter().zip(&self.limits).all(|(value, limit)| limit.contains(*value))
    }
}

/// Joint limits of the stock PR2, rad.
#[allow(clippy::approx_constant, reason = "the description says -0.5236, not pi / 6")]
pub fn stock_limits(side: Side, kind: LimitKind) -> [JointLimit; 7] {
    let (pan, lift, roll, elbow, wrist) = match kind {
        LimitKind::Hard => {
            ([-2.285_398_16, 0.714_601_837], [-0.523_6, 1.396_3], [-3.9, 0.8], [-2.321_3, 0.0], [-2.18, 0.0])
        }
        LimitKind::Soft => {
            ([-2.135_398_16, 0.564_601_837], [-0.353_6, 1.296_3], [-3.75, 0.65], [-2.121_3, -0.15], [-2.0, -0.1])
        }
    };
    let sided = |[lower, upper]: [f64; 2]| match side {
        Side::Right => JointLimit::new(lower, upper),
        Side::Left => JointLimit::new(-upper, -lower),
    };
    let plain = |[lower, upper]: [f64; 2]| JointLimit::new(lower, upper);
    [sided(pan), plain(lift), sided(roll), plain(elbow), JointLimit::UNLIMITED, plain(wrist), JointLimit::UNLIMITED]
}

/// Length of the difference of two configurations, rad, joints without limits the short way round.
pub fn joint_distance(limits: &[JointLimit; 7], a: &ArmConfiguration, b: &ArmConfiguration) -> f64 {
    joint_differences(limits, a, b).iter().map(|d| d * d).sum::<f64>().sqrt()
}

/// `b - a` joint by joint, rad, joints without limits the short way round.
pub fn joint_differences(limits: &[JointLimit; 7], a: &ArmConfiguration, b: &ArmConfiguration) -> [f64; 7] {
    std::array::from_fn(|i| {
        let difference = b[i] - a[i];
        if limits[i].is_unlimited() { darrt_primitives::kinematics::limit::wrap_to_pi(difference) } else { difference }
    })
}

#[cfg(test)]
mod tests;
