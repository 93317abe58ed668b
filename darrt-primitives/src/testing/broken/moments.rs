//! Broken instances that are wrong for a moment only, or in what they claim.

use darrt_core::laws::Broken;
use darrt_core::motion::Instance;
use darrt_core::state::ComponentId;
use nalgebra::{UnitQuaternion, Vector3};

use super::Case;
use super::bench::{Act, Change, object_of, pose_mut, regrip, scene, shift};
use crate::laws::tabletop::{
    DECLARED, EXEMPT, GAP, HELD_RIGID, INSIDE, ONE_WAY, PICK_YAW, RAY, STILL, STRAIGHT, SUPPORT,
};
use crate::mode::{Contacts, SurfaceId, TouchReason};
use crate::testing::table::object;

/// The instance with a change while the parameter is in a short interval.
fn for_a_moment(act: Act, change: Change) -> Result<(), Broken> {
    let moment: Change = Box::new(move |m, t, state| {
        if (0.4..0.47).contains(&t) {
            change(m, t, state);
        }
    });
    scene(act)?.warped(moment).check()
}

/// The instance with other claims.
fn claiming(
    act: Act,
    change: fn(Instance<crate::testing::table::Table>) -> Instance<crate::testing::table::Table>,
) -> Result<(), Broken> {
    let mut scene = scene(act)?;
    scene.instance = change(scene.instance);
    scene.check()
}

pub(super) fn cases() -> Vec<Case> {
    [moments(), claims()].concat()
}

fn all_honest() -> Result<(), Broken> {
    [Act::Transit, Act::Approach, Act::Push, Act::Pick, Act::Carry, Act::Place, Act::Retreat]
        .into_iter()
        .try_for_each(|act| scene(act)?.check())
}

fn moments() -> Vec<Case> {
    let case = |name, wrong, law, broken| Case { name, wrong, law, broken, honest: all_honest };
    vec![
        case("sweeps a tin in passing", "a bystander is elsewhere for a moment", STILL, || {
            for_a_moment(Act::Transit, Box::new(|_, _, state| shift(state, object(1), Vector3::new(0.05, 0.0, 0.0))))
        }),
        case("slips for a moment", "the held object is not in the hand between two knots", HELD_RIGID, || {
            for_a_moment(Act::Carry, Box::new(|_, _, state| shift(state, object(2), Vector3::new(0.0, 0.0, 0.01))))
        }),
        case("turns while it is lifted", "the wrist swings out and back while it lifts", PICK_YAW, || {
            for_a_moment(
                Act::Pick,
                Box::new(|m, _, state| {
                    let Some(grasp) = state.mode.held().map(|held| held.tool_from_object) else { return };
                    state.robot.arm[4] += 0.2;
                    regrip(m, state, object(2), &grasp);
                }),
            )
        }),
        case("off the line for a moment", "the hand swings out half-way down", STRAIGHT, || {
            for_a_moment(Act::Approach, Box::new(|_, _, state| state.robot.arm[1] += 0.03))
        }),
        case("out of the room for a moment", "the base leaves its bounds on the way", INSIDE, || {
            for_a_moment(Act::Transit, Box::new(|_, _, state| state.robot.base[1] += 5.0))
        }),
        case("hops", "the pushed tin is above the table for a moment", SUPPORT, || {
            for_a_moment(
                Act::Push,
                Box::new(|_, _, state| {
                    if let Some(pose) = pose_mut(state, object(0)) {
                        pose.translation.z += 0.02;
                    }
                }),
            )
        }),
        case("spins", "the pushed tin turns for a moment", RAY, || {
            for_a_moment(
                Act::Push,
                Box::new(|_, _, state| {
                    if let Some(pose) = pose_mut(state, object(0)) {
                        pose.rotation = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 0.3) * pose.rotation;
                    }
                }),
            )
        }),
    ]
}

fn claims() -> Vec<Case> {
    let case = |name, wrong, law, broken| Case { name, wrong, law, broken, honest: all_honest };
    vec![
        case("a push that may be undone", "copied from a carry, with the claim to be reversible", ONE_WAY, || {
            claiming(Act::Push, |instance| Instance { reversible: true, ..instance })
        }),
        case("declares the other tin", "moves is everything on the table, to be on the safe side", DECLARED, || {
            claiming(Act::Transit, |instance| {
                let moves = instance.moves.with(ComponentId::Object(object(1)));
                Instance { moves, ..instance }
            })
        }),
        case("carries undeclared", "moves is the robot, also with a box in its hand", DECLARED, || {
            claiming(Act::Carry, |instance| Instance { moves: darrt_core::state::ComponentSet::ROBOT, ..instance })
        }),
        case("opens beyond its widest gap", "the gap of another gripper", GAP, || {
            let wide: Change = Box::new(|_, _, state| {
                if let Some(mode) = state.mode.opened_to(0.2) {
                    state.mode = mode;
                }
            });
            scene(Act::Transit)?.warped(wide).check()
        }),
        case("closes beyond nothing", "a thickness subtracted twice", GAP, || {
            let narrow: Change = Box::new(|_, _, state| {
                if let Some(mode) = state.mode.opened_to(-0.01) {
                    state.mode = mode;
                }
            });
            scene(Act::Transit)?.warped(narrow).check()
        }),
        case("runs ahead", "the tin leaves the ray near the end, and comes back", RAY, || {
            // Half-way the tin runs ahead, and comes back: what a push allows is no matter here.
            let back: Change = Box::new(|_, t, state| {
                if (0.8..0.9).contains(&t)
                    && let Some(pose) = pose_mut(state, object(0))
                {
                    pose.translation.x += 0.003;
                }
            });
            scene(Act::Push)?.warped(back).check()
        }),
        case(
            "touches the other table",
            "the surface of the exemption is that where it will be set down",
            EXEMPT,
            || {
                claiming(Act::Pick, |instance| {
                    let fingers = Some((object_of(Act::Pick), TouchReason::Grasp));
                    let support = Some((object_of(Act::Pick), SurfaceId::new(1)));
                    Instance { contacts: Contacts { fingers, support }, ..instance }
                })
            },
        ),
    ]
}
