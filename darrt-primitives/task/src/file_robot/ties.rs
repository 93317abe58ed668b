//! What the joints of an arm do not change of its hand.

use darrt_primitives::hand_ties::{HandTies, up_in_tool};
use nalgebra::{Unit, Vector3};

use super::chain::ArmChain;

/// How far an axis may be from the vertical, or from the level, and count as that; radians.
const ROUNDING: f64 = 1e-9;

/// The ties of the hand: joints that turn about the vertical change neither its tilt nor its height, and those that slide keep its
/// tilt, if all joints before them are such.
pub(super) fn ties(chain: &ArmChain) -> HandTies {
    let at_zero = vec![0.0; chain.joints.len()];
    let frames = chain.frames(&[0.0; 3], &at_zero);
    // A turn about the vertical leaves the rise of all axes beyond it as it is at zero.
    let rise = |(frame, axis): (&nalgebra::Isometry3<f64>, &Unit<Vector3<f64>>)| (frame.rotation * axis.into_inner()).z;
    let axes = || frames.iter().skip(1).zip(chain.joints.iter().map(|joint| &joint.axis)).map(rise).zip(&chain.joints);
    if axes().any(|(rise, joint)| !joint.slides && rise.abs() < 1.0 - ROUNDING) {
        return HandTies::default();
    }
    let tool = chain.world_from_tool(&[0.0; 3], &at_zero);
    let is_level = axes().all(|(rise, joint)| !joint.slides || rise.abs() <= ROUNDING);
    HandTies {
        up_in_tool: Some(Unit::new_normalize(up_in_tool(&tool))),
        height_m: is_level.then_some(tool.translation.z),
    }
}
