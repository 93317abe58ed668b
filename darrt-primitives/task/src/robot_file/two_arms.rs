//! What the two arms of one robot must be to each other.

use darrt_primitives::kinematics::RobotDescription;

use super::ArmTables;
use super::amend::{AmendedArm, joint_index};
use super::error::Fault;

/// An arm as the file and as the description have it.
type Named<'a> = (ArmTables<'a>, &'a AmendedArm);

/// Each has a hand of its own and is mounted on what both arms carry or none does; the fault is told of the second.
pub(super) fn check(first: Named<'_>, second: Named<'_>, description: &RobotDescription) -> Result<(), Fault> {
    let (tables, arm) = second;
    let of_both = [
        ("tool.link", &first.1.tool_link, &arm.tool_link, "the tool frame"),
        ("gripper.joint", &first.0.gripper.joint, &tables.gripper.joint, "the joint of the hand"),
    ];
    for ([a, b], other) in [([first, second], "first"), ([second, first], "second")] {
        let wrist = a.1.joints.last();
        if let Some(wrist) = wrist.filter(|wrist| b.1.joints.contains(wrist)) {
            let why = format!(
                "is moved by `{wrist}`, which moves the hand of the {other} arm: each arm ends in a hand of its own"
            );
            return Err(Fault::new(b.0.key("arm.to"), why));
        }
        let opens = &a.0.gripper.joint;
        if b.1.joints.contains(opens) {
            let why = format!("is moved by `{opens}`, which opens the hand of the {other} arm");
            return Err(Fault::new(b.0.key("arm.to"), why));
        }
    }
    for (key, one, other, what) in of_both {
        if one == other {
            return Err(Fault::new(tables.key(key), format!("names `{one}`, which is {what} of the first arm")));
        }
    }
    if let Some(name) = tables.gripper.follow.keys().find(|name| first.0.gripper.follow.contains_key(*name)) {
        let key = tables.key(&format!("gripper.follow.{name}"));
        return Err(Fault::new(key, "follows the joint of the first hand: see `gripper.follow`"));
    }
    carried(first, second, description)?;
    carried(second, first, description)
}

/// What moves this arm besides its own joints are no joints of the other.
fn carried((tables, arm): Named<'_>, (others, other): Named<'_>, description: &RobotDescription) -> Result<(), Fault> {
    let wrist = arm.joints.last().and_then(|name| joint_index(description, name));
    let mut at = wrist.and_then(|joint| description.joints.get(joint)).map(|joint| joint.parent);
    while let Some(joint) = at.and_then(|link| description.joints.iter().find(|joint| joint.child == link)) {
        let driver = joint.mimic.and_then(|mimic| description.joints.get(mimic.joint)).unwrap_or(joint);
        let is_of = |arm: &AmendedArm| arm.joints.iter().any(|name| **name == *driver.name);
        if is_of(other) && !is_of(arm) {
            let why = format!(
                "names `{}`, which `{}` moves, a joint below `{}`: let both arms begin above it, or both below",
                tables.arm.from,
                joint.name,
                others.key("arm.from")
            );
            return Err(Fault::new(tables.key("arm.from"), why));
        }
        at = Some(joint.parent);
    }
    Ok(())
}
