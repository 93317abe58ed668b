//! Contracts that lie: whatever a plan says of its primitives, no contract excuses what no robot can do.

use darrt_pr2::verify;
use darrt_primitives::contract::{Contract, HandUse, HandWay, MovingPart, ObjectRule};
use darrt_task::plan_file::PlanFile;
use darrt_task::problem_file::PrimitiveName;
use darrt_task::verify::RefusalKind;

use crate::verify_plans::plans;

/// The plan with another contract for one of its primitives, and as what it is refused.
fn lies(mut plan: PlanFile, primitive: &PrimitiveName, change: impl FnOnce(&mut Contract)) -> RefusalKind {
    verify(&plan).expect("an honest plan");
    change(plan.contracts.get_mut(primitive).unwrap());
    verify(&plan).expect_err("a contract that lies").kind
}

#[test]
fn a_contract_is_asked_for_every_primitive() {
    let mut plan = plans::push();
    plan.contracts.remove(&PrimitiveName::PUSH);
    let refusal = verify(&plan).unwrap_err();
    assert_eq!(refusal.kind, RefusalKind::Primitive);
    assert!(refusal.message.contains("`contracts` says nothing of Push"), "{refusal}");
}

#[test]
fn no_contract_excuses_what_the_plan_does() {
    use RefusalKind as K;
    let (arm, push, pick) = (&PrimitiveName::STRAIGHT_LINE_ARM_TRANSIT, &PrimitiveName::PUSH, &PrimitiveName::PICK);
    let (carry, place) = (&PrimitiveName::ARM_RIGID_TRANSFER, &PrimitiveName::PLACE);
    // The object follows nothing.
    assert_eq!(lies(plans::push(), push, |c| c.object = ObjectRule::Rests), K::Mode);
    // It is said to lie under the fingers that are beside it.
    assert_eq!(lies(plans::push(), push, |c| c.object = ObjectRule::Dragged), K::Push);
    // A push that the base does.
    assert_eq!(lies(plans::push(), push, |c| c.moves = MovingPart::Base), K::Primitive);
    // A push that may go any way.
    assert_eq!(lies(plans::push(), push, |c| c.way = HandWay::Free), K::Primitive);
    // A push without a touch.
    assert_eq!(lies(plans::push(), push, |c| c.fingers_touch = false), K::Primitive);
    // A push in which the hand closes on what it pushes.
    assert_eq!(lies(plans::push(), push, |c| c.hand = HandUse::Takes), K::Primitive);
    // A push that goes straight for the hand: so it is, and yet what slides must be a push.
    assert_eq!(
        lies(plans::push(), push, |c| *c = Contract::of(MovingPart::Arm, HandUse::Empty, HandWay::Own)),
        K::Mode
    );
    // The hand takes nothing, but carries on.
    assert_eq!(lies(plans::carry(), pick, |c| c.hand = HandUse::Empty), K::Mode);
    // It carries what it has not taken.
    assert_eq!(lies(plans::carry(), pick, |c| c.hand = HandUse::Carries), K::Mode);
    // It lets go in the air.
    assert_eq!(
        lies(plans::carry(), carry, |c| *c = Contract::of(MovingPart::Arm, HandUse::LetsGo, HandWay::Own)),
        K::Gripper
    );
    // It never lets go of what then stands.
    assert_eq!(lies(plans::carry(), place, |c| c.hand = HandUse::Carries), K::AllowedContact);
    // An empty hand that carries.
    assert_eq!(lies(plans::carry(), carry, |c| c.hand = HandUse::Empty), K::Primitive);
    // A transit of the base that the arm does.
    assert_eq!(lies(plans::carry(), &PrimitiveName::BASE_RIGID_TRANSFER, |c| c.moves = MovingPart::Arm), K::Stray);
    // An approach that says it drives.
    assert_eq!(lies(plans::push(), arm, |c| c.moves = MovingPart::Base), K::Primitive);
}
