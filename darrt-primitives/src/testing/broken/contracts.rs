//! Instances that do not keep the contract of what they say they are.

use darrt_core::laws::Broken;
use darrt_core::motion::Instance;
use darrt_core::primitive::PrimitiveId;

use super::Case;
use super::bench::{Act, Change, regrip, scene};
use crate::laws::tabletop::{CONTRACT, TAKES};
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

pub(super) fn cases() -> Vec<Case> {
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
