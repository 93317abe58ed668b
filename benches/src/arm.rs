//! The right arm of the PR2 at a torso height of 0.2 m.

use darrt_pr2::arm::{Arm, ArmConfiguration, LimitKind, Side};
use nalgebra::Isometry3;
use rand::RngExt as _;

use crate::stream;

/// Height of the torso, metres.
pub const TORSO_M: f64 = 0.2;

/// The arm, within its soft limits.
pub fn right_arm() -> Arm {
    Arm::new(Side::Right, TORSO_M, LimitKind::Soft).unwrap()
}

/// `count` configurations uniform in the limits of `arm`.
pub fn configurations(arm: &Arm, count: u64) -> Vec<ArmConfiguration> {
    let draw = |index| {
        let mut rng = stream(index);
        arm.limits.map(|limit| {
            let (lower, upper) = if limit.is_unlimited() {
                (-std::f64::consts::PI, std::f64::consts::PI)
            } else {
                (limit.lower, limit.upper)
            };
            rng.random_range(lower..upper)
        })
    };
    (0..count).map(draw).collect()
}

/// Where `arm` has the tool in each configuration: poses that are certainly reached.
pub fn poses(arm: &Arm, configurations: &[ArmConfiguration]) -> Vec<Isometry3<f64>> {
    configurations.iter().map(|q| arm.base_from_tool(q)).collect()
}
