//! The paper's eight primitives (section 5.1), for any [`Manipulator`](crate::manipulator::Manipulator) at tables, each in
//! one file; their ids; and their contracts.
//!
//! | primitive | file |
//! |---|---|
//! | the arm moves, alone or with what it holds | [`arm_transit`], [`arm_rigid_transfer`] |
//! | the base moves, alone or with what it holds | [`base_transit`], [`base_rigid_transfer`] |
//! | the hand goes on a straight line | [`straight_line_arm_transit`] |
//! | an object is taken, set down, pushed | [`mod@pick`], [`mod@place`], [`mod@push`] |

use darrt_core::primitive::PrimitiveId;

use crate::contract::{Contract, HandUse, HandWay, MovingPart, ObjectRule};

pub mod arm_rigid_transfer;
pub mod arm_transit;
pub mod base_rigid_transfer;
pub mod base_transit;
mod joint_group;
pub mod pick;
pub mod place;
pub mod push;
pub mod straight_line_arm_transit;

/// The arm moves alone.
pub const ARM_TRANSIT: PrimitiveId = PrimitiveId::new(0, "Arm-Transit");
/// The hand moves on a straight line, empty.
pub const STRAIGHT_LINE_ARM_TRANSIT: PrimitiveId = PrimitiveId::new(1, "Straight-Line-Arm-Transit");
/// The arm moves with an object in the hand.
pub const ARM_RIGID_TRANSFER: PrimitiveId = PrimitiveId::new(2, "Arm-Rigid-Transfer");
/// The base moves alone.
pub const BASE_TRANSIT: PrimitiveId = PrimitiveId::new(3, "Base-Transit");
/// The base moves with an object in the hand.
pub const BASE_RIGID_TRANSFER: PrimitiveId = PrimitiveId::new(4, "Base-Rigid-Transfer");
/// An object is attached and lifted.
pub const PICK: PrimitiveId = PrimitiveId::new(5, "Pick");
/// An object is set down and let go.
pub const PLACE: PrimitiveId = PrimitiveId::new(6, "Place");
/// An object is pushed.
pub const PUSH: PrimitiveId = PrimitiveId::new(7, "Push");

/// The eight, by their index, each with its contract. Primitives of other crates come after them.
pub const STANDARD: [(PrimitiveId, Contract); 8] = [
    (ARM_TRANSIT, Contract::of(MovingPart::Arm, HandUse::Empty, HandWay::Free)),
    (STRAIGHT_LINE_ARM_TRANSIT, Contract::of(MovingPart::Arm, HandUse::Empty, HandWay::Straight)),
    (ARM_RIGID_TRANSFER, Contract::of(MovingPart::Arm, HandUse::Carries, HandWay::Free)),
    (BASE_TRANSIT, Contract::of(MovingPart::Base, HandUse::Empty, HandWay::Free)),
    (BASE_RIGID_TRANSFER, Contract::of(MovingPart::Base, HandUse::Carries, HandWay::Free)),
    (PICK, Contract::of(MovingPart::Arm, HandUse::Takes, HandWay::Own)),
    (PLACE, Contract::of(MovingPart::Arm, HandUse::LetsGo, HandWay::Own)),
    (PUSH, Contract { object: ObjectRule::Pushed, ..Contract::of(MovingPart::Arm, HandUse::Empty, HandWay::Own) }),
];
