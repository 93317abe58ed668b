//! Broken picks, carries, places, approaches and retreats.

use darrt_core::laws::Broken;
use darrt_core::motion::Instance;
use nalgebra::{Isometry3, Translation3, Vector3};

use super::bench::{Act, Change, object_of, pose_mut, regrip, scene, shift};
use super::{Case, unusable};
use crate::laws::tabletop::{ATTACH, EXEMPT, HELD_RIGID, INSIDE, MODES, PICK_YAW, RELEASE, RETREAT, STILL, STRAIGHT};
use crate::mode::{Contacts, Held, SurfaceId, TouchReason};
use crate::primitive;
use crate::testing::table::object;

/// The instance with a change on the way.
fn warped(act: Act, change: Change) -> Result<(), Broken> {
    scene(act)?.warped(change).check()
}

/// The instance with other contacts.
fn touching(act: Act, contacts: Contacts) -> Result<(), Broken> {
    let mut scene = scene(act)?;
    scene.instance = Instance { contacts, object: Some(object_of(act)), ..scene.instance };
    scene.check()
}

pub(super) fn cases() -> Vec<Case> {
    [held(), modes(), hands()].concat()
}

fn held() -> Vec<Case> {
    let case = |name, wrong, law, broken| Case {
        name,
        wrong,
        law,
        broken,
        honest: || honest(&[Act::Pick, Act::Carry, Act::Place]),
    };
    vec![
        case(
            "moves the robot but not the held object",
            "lifts the hand, and the box stays on the table",
            HELD_RIGID,
            || {
                let start = scene(Act::Pick)?.from.object(object(2)).copied().unwrap_or_default();
                let stays =
                    move |_: &_, _, state: &mut _| pose_mut(state, object(2)).into_iter().for_each(|p| *p = start);
                warped(Act::Pick, Box::new(stays))
            },
        ),
        case("slips through the fingers", "the held object follows the wrist, not the tool", HELD_RIGID, || {
            warped(Act::Carry, Box::new(|_, t, state| shift(state, object(2), Vector3::new(0.0, 0.0, -0.02 * t))))
        }),
        case(
            "snaps into the nominal grasp",
            "attaches in the grasp of the table, not as the hand really stands",
            ATTACH,
            || {
                let scene = scene(Act::Pick)?;
                let during = scene.instance.at(&scene.m, 0.5, &scene.from).mode;
                let held = *during.held().ok_or_else(|| unusable("nothing held"))?;
                let snapped =
                    Held { tool_from_object: held.tool_from_object * Translation3::new(0.0, 0.004, 0.0), ..held };
                let mode =
                    scene.from.mode.attached(snapped, during.gap_m()).ok_or_else(|| unusable("no transition"))?;
                let change: Change = Box::new(move |m, _, state| {
                    regrip(m, state, held.object, &snapped.tool_from_object);
                    state.mode.clone_from(&mode);
                });
                scene.warped(change).check()
            },
        ),
        case("pick that changes yaw", "the wrist turns while it lifts, and the box with it", PICK_YAW, || {
            let swing: Change = Box::new(|m, t, state| {
                let Some(grasp) = state.mode.held().map(|held| held.tool_from_object) else { return };
                state.robot.arm[4] += 0.2 * t;
                regrip(m, state, object(2), &grasp);
            });
            warped(Act::Pick, swing)
        }),
        case("drops it", "lets go two centimetres above the table", RELEASE, || {
            let scene = scene(Act::Place)?;
            let grasp = scene.from.mode.held().map_or_else(Isometry3::identity, |held| held.tool_from_object);
            let change: Change = Box::new(move |m, t, state| {
                state.robot.arm[2] += 0.02 * t;
                regrip(m, state, object(2), &grasp);
            });
            scene.warped(change).check()
        }),
        case("sets it down askew", "lets go while the hand still leans", RELEASE, || {
            let scene = scene(Act::Place)?;
            let grasp = scene.from.mode.held().map_or_else(Isometry3::identity, |held| held.tool_from_object);
            let change: Change = Box::new(move |m, t, state| {
                state.robot.arm[5] += 0.05 * t;
                regrip(m, state, object(2), &grasp);
            });
            scene.warped(change).check()
        }),
    ]
}

fn modes() -> Vec<Case> {
    let case = |name, wrong, law, broken| Case {
        name,
        wrong,
        law,
        broken,
        honest: || honest(&[Act::Transit, Act::Pick, Act::Carry]),
    };
    vec![
        case("grasps from afar", "attaches an object at which the hand does not stand", MODES, || {
            let mut scene = scene(Act::Pick)?;
            scene.from.mode = scene.from.mode.disengaged().ok_or_else(|| unusable("not engaged"))?;
            scene.check()
        }),
        case("lets go in passing", "the mode at the end of a carry forgets the object", MODES, || {
            let empty = scene(Act::Transit)?.from.mode;
            let forgets: Change = Box::new(move |_, t, state| {
                if t >= 1.0 {
                    state.mode.clone_from(&empty);
                }
            });
            warped(Act::Carry, forgets)
        }),
        case("exemption outlives the instance", "a transit may still touch what the last retreat left", EXEMPT, || {
            let fingers = Some((object(2), TouchReason::Retreat));
            touching(Act::Transit, Contacts { fingers, support: None })
        }),
        case("carries along the table", "the exemption of the lift is kept for the whole carry", EXEMPT, || {
            let support = Some((object(2), SurfaceId::new(0)));
            touching(Act::Carry, Contacts { fingers: Some((object(2), TouchReason::Grasp)), support })
        }),
        case("exempts another object", "the lift may touch the tin instead of the box", EXEMPT, || {
            touching(Act::Pick, Contacts { fingers: Some((object(1), TouchReason::Grasp)), support: None })
        }),
        case("sweeps the table", "a transit takes along what it should drive around", STILL, || {
            warped(Act::Transit, Box::new(|_, t, state| shift(state, object(1), Vector3::new(0.1 * t, 0.0, 0.0))))
        }),
    ]
}

fn hands() -> Vec<Case> {
    let case = |name, wrong, law, broken| Case {
        name,
        wrong,
        law,
        broken,
        honest: || honest(&[Act::Transit, Act::Approach, Act::Retreat]),
    };
    vec![
        case("straight in joint space", "goes from end to end in joint space: the hand swings out", STRAIGHT, || {
            let swing = |t: f64| 0.1 * (std::f64::consts::PI * t).sin();
            warped(Act::Approach, Box::new(move |_, t, state| state.robot.arm[4] += swing(t)))
        }),
        case(
            "drives out of the room",
            "the base goes where the object must go, whatever its bounds say",
            INSIDE,
            || warped(Act::Transit, Box::new(|_, t, state| state.robot.base[1] += 4.0 * t)),
        ),
        case("bends too far", "the last way point comes from an inverse that knows no limits", INSIDE, || {
            warped(Act::Approach, Box::new(|_, t, state| state.robot.arm[5] += if t >= 1.0 { 2.0 } else { 0.0 }))
        }),
        case("leaves sideways", "retreats along an axis of the base, not of the hand", RETREAT, || {
            let mut scene = scene(Act::Retreat)?;
            scene.instance.primitive = primitive::ARM_TRANSIT;
            scene.warped(Box::new(|_, t, state| state.robot.arm[1] += 0.05 * t)).check()
        }),
        case("retreats into the object", "the sign of the retreat is wrong", RETREAT, || {
            let mut scene = scene(Act::Retreat)?;
            scene.instance.primitive = primitive::ARM_TRANSIT;
            let z = scene.from.robot.arm[2];
            scene.warped(Box::new(move |_, _, state| state.robot.arm[2] = 2.0 * z - state.robot.arm[2])).check()
        }),
        case("drives off", "the base already drives while the hand retreats", RETREAT, || {
            let mut scene = scene(Act::Retreat)?;
            scene.instance.primitive = primitive::ARM_TRANSIT;
            let drives: Change = Box::new(|_, t, state| {
                // The arm makes up for the base, so that the hand still goes straight up.
                let (sin, cos) = state.robot.base[2].sin_cos();
                state.robot.base[0] += 0.05 * cos * t;
                state.robot.base[1] += 0.05 * sin * t;
                state.robot.arm[0] -= 0.05 * t;
            });
            scene.warped(drives).check()
        }),
    ]
}

fn honest(acts: &[Act]) -> Result<(), Broken> {
    acts.iter().try_for_each(|act| scene(*act)?.check())
}
