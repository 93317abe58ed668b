//! Instances that do not keep the contract of what they say they are.

use darrt_core::laws::Broken;
use darrt_core::motion::Instance;
use darrt_core::primitive::PrimitiveId;

use super::Case;
use super::bench::{Act, Change, Scene, regrip, scene};
use crate::contract::{Contract, HandUse, HandWay, MovingPart, ObjectRule};
use crate::laws::tabletop::{CONTRACT, SOUND, STRAIGHT, TAKES};
use crate::laws::{TabletopClaims, check_contracts};
use crate::primitive;
use crate::testing::table::object;

/// The honest instance under another name.
fn called(act: Act, primitive: PrimitiveId) -> Result<(), Broken> {
    let mut scene = scene(act)?;
    scene.instance = Instance { primitive, ..scene.instance };
    scene.check()
}

fn changed(act: Act, change: Change) -> Result<(), Broken> {
    scene(act)?.warped(change).check()
}

/// A primitive of a user.
const OWN: PrimitiveId = PrimitiveId::new(9, "Own");

/// The instance of this scene by this contract.
fn by(contract: Contract, scene: Scene) -> Result<(), Broken> {
    let Scene { m, from, instance } = scene;
    let instance = Instance { primitive: OWN, ..instance };
    check_contracts(&m, &[(OWN, contract)], &[instance], &from, &[0.1, 0.5, 0.9], &TabletopClaims::default())
}

const LINE: Contract = Contract::of(MovingPart::Arm, HandUse::Empty, HandWay::Straight);
const PUSHED: Contract =
    Contract { object: ObjectRule::Pushed, ..Contract::of(MovingPart::Arm, HandUse::Empty, HandWay::Own) };

fn of_ones_own() -> Vec<Case> {
    let case = |name, wrong, law, broken| Case {
        name,
        wrong,
        law,
        broken,
        honest: || {
            let carries = Contract::of(MovingPart::Base, HandUse::Carries, HandWay::Free);
            let all = [(LINE, Act::Approach), (PUSHED, Act::Push), (carries, Act::Carry)];
            all.into_iter().try_for_each(|(contract, act)| by(contract, scene(act)?))
        },
    };
    vec![
        case("a contract of no contact", "what is pushed is not touched, it says", SOUND, || {
            by(Contract { fingers_touch: false, ..PUSHED }, scene(Act::Push)?)
        }),
        case("an own line that bows", "the contract says straight, and the joints go straight", STRAIGHT, || {
            let bows: Change = Box::new(|_, t, state| state.robot.arm[1] += 0.2 * t * (1.0 - t));
            by(LINE, scene(Act::Approach)?.warped(bows))
        }),
        case("hands off, it says", "the contract forbids the fingers what the instance allows them", CONTRACT, || {
            by(Contract { fingers_touch: false, ..LINE }, scene(Act::Retreat)?)
        }),
        case("an own push of nothing", "the contract of an empty hand, copied from a transit", CONTRACT, || {
            by(Contract { object: ObjectRule::Rests, ..PUSHED }, scene(Act::Push)?)
        }),
    ]
}

pub(super) fn cases() -> Vec<Case> {
    [of_standard_ones(), of_ones_own()].concat()
}

fn of_standard_ones() -> Vec<Case> {
    let case = |name, wrong, law, broken| Case {
        name,
        wrong,
        law,
        broken,
        honest: || {
            [Act::Transit, Act::Push, Act::Pick, Act::Carry, Act::Place].into_iter().try_for_each(|a| scene(a)?.check())
        },
    };
    vec![
        case("a pick called a place", "an id copied with the file", CONTRACT, || called(Act::Pick, primitive::PLACE)),
        case("a push called a transit", "the arm moves, and what is before it as well", CONTRACT, || {
            called(Act::Push, primitive::ARM_TRANSIT)
        }),
        case("a transfer called a transit", "something is in the hand all the same", CONTRACT, || {
            called(Act::Carry, primitive::BASE_TRANSIT)
        }),
        case("drives and reaches at once", "the arm is folded while the base drives", CONTRACT, || {
            changed(
                Act::Transit,
                Box::new(|_, t, state| state.robot.arm[3] = (state.robot.arm[3] + 0.1 * t * (1.0 - t)).min(0.5)),
            )
        }),
        case("takes nothing up", "the hand closes, and stays where it is", TAKES, || {
            let start = scene(Act::Pick)?.from.robot;
            let stays: Change = Box::new(move |m, _, state| {
                let Some(grasp) = state.mode.held().map(|held| held.tool_from_object) else { return };
                state.robot = start;
                regrip(m, state, object(2), &grasp);
            });
            changed(Act::Pick, stays)
        }),
    ]
}
