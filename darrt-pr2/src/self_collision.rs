//! Which pairs of links may touch while one arm moves and the other stands still.
//!
//! The rules follow the robot's semantic description (found by sampling: pairs that never meet, or always do, are left
//! out), said link group by link group instead of pair by pair. Where it left out a pair of left and right arm links
//! that we could not confirm, the pair is kept: a pair too many costs time, a pair too few a collision.

use crate::arm::Side;
use crate::model::Pr2Model;

/// Names of two links to be held apart: the first moves with the active arm, the second does not, or is farther in.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct LinkPair {
    /// A link of the active arm.
    pub moving: String,
    /// A link of the trunk, of the parked arm, or the active arm's shoulder or upper arm.
    pub other: String,
}

/// Links of an arm, from the shoulder outwards, without the side's prefix.
const ARM: [&str; 14] = [
    "shoulder_pan_link",
    "shoulder_lift_link",
    "upper_arm_roll_link",
    "upper_arm_link",
    "elbow_flex_link",
    "forearm_roll_link",
    "forearm_link",
    "wrist_flex_link",
    "wrist_roll_link",
    "gripper_palm_link",
    "gripper_l_finger_link",
    "gripper_r_finger_link",
    "gripper_l_finger_tip_link",
    "gripper_r_finger_tip_link",
];

/// Links of the trunk that forearm and hand can reach.
const TRUNK: [&str; 7] = [
    "base_link",
    "base_bellow_link",
    "torso_lift_link",
    "head_pan_link",
    "head_tilt_link",
    "head_sensor_block_link",
    "laser_tilt_mount_link",
];

/// How far along the arm a link is: decides what it can reach.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Reach {
    /// Shoulder and upper arm: cannot reach the trunk.
    UpperArm,
    /// Elbow and the tube behind it: reach the base only.
    Elbow,
    /// Forearm and wrist: reach the trunk but not the head's tilting part.
    Forearm,
    /// Palm and fingers: reach all of the trunk.
    Hand,
}

fn reach(link: &str) -> Reach {
    match link {
        "elbow_flex_link" | "forearm_roll_link" => Reach::Elbow,
        "forearm_link" | "wrist_flex_link" | "wrist_roll_link" => Reach::Forearm,
        _ if link.starts_with("gripper") => Reach::Hand,
        _ => Reach::UpperArm,
    }
}

fn meets_trunk(link: &str, trunk: &str) -> bool {
    match reach(link) {
        Reach::UpperArm => false,
        Reach::Elbow => trunk == "base_link",
        Reach::Forearm => trunk != "head_tilt_link" && !(link == "wrist_roll_link" && trunk == "laser_tilt_mount_link"),
        Reach::Hand => true,
    }
}

/// Whether a link of one arm can meet a link of the other.
fn meets_other_arm(a: &str, b: &str) -> bool {
    let shoulder = |link: &str| link.starts_with("shoulder");
    let never = (a == "shoulder_lift_link" && b == "shoulder_lift_link")
        || (reach(a) == Reach::Elbow && shoulder(b))
        || (reach(b) == Reach::Elbow && shoulder(a));
    !never
}

/// Whether a link can meet an inner one of the same arm, with at least three joints between them.
///
/// The description lists the shoulder's pan for forearm and hand only. The others meet beyond the soft limits alone, where
/// arms may be told to go: the elbow beside the shoulder's pan in 83, fingers and palm on the upper arm or the shoulder's lift
/// in 2 to 43 of 20,000 configurations within the hard limits, in none within the soft ones.
fn meets_own_arm(outer: &str, inner: &str) -> bool {
    match inner {
        "shoulder_pan_link" => reach(outer) >= Reach::Elbow,
        "shoulder_lift_link" | "upper_arm_link" => reach(outer) == Reach::Hand,
        _ => false,
    }
}

/// Every pair of links, by name, that can meet while the arm on `active` moves and the other is parked.
///
/// Pairs of the parked arm with itself or with the trunk are not listed: they do not change.
pub fn pairs(active: Side) -> Vec<LinkPair> {
    let named = |side: Side, link: &str| format!("{}_{link}", side.prefix());
    let mut pairs = Vec::new();
    for link in ARM {
        let mut add = |other: String| pairs.push(LinkPair { moving: named(active, link), other });
        for trunk in TRUNK.into_iter().filter(|trunk| meets_trunk(link, trunk)) {
            add(trunk.to_owned());
        }
        for own in ARM.into_iter().filter(|own| meets_own_arm(link, own)) {
            add(named(active, own));
        }
        for parked in ARM.into_iter().filter(|parked| meets_other_arm(link, parked)) {
            add(named(active.other(), parked));
        }
    }
    pairs
}

/// The pairs of [`pairs`] as link indices of a model, without links it does not have or that have no geometry.
pub fn link_pairs(model: &Pr2Model, active: Side) -> Vec<[usize; 2]> {
    let solid = |name: &str| model.tree().link_index(name).filter(|link| model.body(*link).is_some());
    pairs(active).iter().filter_map(|p| Some([solid(&p.moving)?, solid(&p.other)?])).collect()
}

#[cfg(test)]
mod tests;
