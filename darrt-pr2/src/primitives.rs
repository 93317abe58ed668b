//! The paper's eight primitives on the PR2 (section 5.1): the generic ones of `darrt-primitives`, under the paper's names.
//!
//! What is the PR2's own about them are its numbers: the gap and the pads of its gripper ([`gripper`](crate::gripper)), its
//! postures ([`postures`](crate::postures)), its limits, speeds and forces ([`robot`](crate::robot)), and the defaults of
//! `[push]` and `[place]` in problem files.

/// The arm moves an object that is attached to the gripper, in straight lines in joint space.
pub use darrt_primitives::primitive::arm_rigid_transfer::ArmRigidTransfer;
/// The arm moves towards a joint goal in a straight line in joint space, with nothing in the hand. Where that is blocked, a
/// way around is looked for.
pub use darrt_primitives::primitive::arm_transit::ArmTransit;
/// The base moves with an object that is attached to the gripper.
pub use darrt_primitives::primitive::base_rigid_transfer::BaseRigidTransfer;
/// The base moves towards a goal pose, with nothing in the hand. Base and arm never move together: the base is less precise.
pub use darrt_primitives::primitive::base_transit::BaseTransit;
/// In a valid grasp pose the object is attached to the gripper and lifted in a straight line.
pub use darrt_primitives::primitive::pick::Pick;
/// The object in the gripper is set down on a support surface in a straight line, and detached.
pub use darrt_primitives::primitive::place::Place;
/// The gripper touches the rim of a round object with two fingers and pushes it along the ray through its centre.
pub use darrt_primitives::primitive::push::Push;
/// The gripper moves in a straight line in Cartesian space: to retreat from an object, and as the last part of every
/// approach.
pub use darrt_primitives::primitive::straight_line_arm_transit::StraightLineArmTransit;
