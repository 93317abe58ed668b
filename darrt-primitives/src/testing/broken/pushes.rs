//! Broken pushes.

use darrt_core::laws::Broken;
use nalgebra::{Isometry3, UnitQuaternion, Vector3};

use super::Case;
use super::bench::{Act, Scene, pose_mut, scene, shift};
use crate::laws::check_finger_contacts;
use crate::laws::tabletop::{CONTACT, FINGERS, RAY, SUPPORT, TOUCH, TURN};
use crate::mode::Contacts;
use crate::push::slide::Slide;
use crate::testing::scene_oracle::SceneOracle;
use crate::testing::table::object;

/// A push, where it starts and how far it goes.
fn push() -> Result<(Scene, Isometry3<f64>, Vector3<f64>), Broken> {
    let scene = scene(Act::Push)?;
    let start = scene.from.object(object(0)).copied().unwrap_or_default();
    let end = scene.instance.at(&scene.m, 1.0, &scene.from).object(object(0)).copied().unwrap_or_default();
    let way = end.translation.vector - start.translation.vector;
    Ok((scene, start, way))
}

/// The push with the tin at another share of its way.
fn paced(pace: fn(f64) -> f64) -> Result<(), Broken> {
    let (scene, start, way) = push()?;
    let moves = move |_: &_, _, state: &mut _| {
        if let Some(pose) = pose_mut(state, object(0)) {
            let done = (pose.translation.vector - start.translation.vector).norm() / way.norm();
            pose.translation.vector = start.translation.vector + way * pace(done.min(1.0));
        }
    };
    scene.warped(Box::new(moves)).check()
}

/// The push with the tin moved or turned, by its share of the way.
fn moved(change: fn(&mut Isometry3<f64>, &Vector3<f64>, f64)) -> Result<(), Broken> {
    let (scene, start, way) = push()?;
    let moves = move |_: &_, _, state: &mut _| {
        if let Some(pose) = pose_mut(state, object(0)) {
            let done = (pose.translation.vector - start.translation.vector).norm() / way.norm();
            change(pose, &way, done);
        }
    };
    scene.warped(Box::new(moves)).check()
}

pub(super) fn cases() -> Vec<Case> {
    let case = |name, wrong, law, broken| Case { name, wrong, law, broken, honest: || scene(Act::Push)?.check() };
    vec![
        case(
            "push that loses contact in the middle",
            "the tin runs ahead of the fingers, and waits at the end",
            CONTACT,
            || paced(|s| s + 0.4 * s * (1.0 - s)),
        ),
        case("fingers through the tin", "the tin starts later than the fingers", CONTACT, || paced(|s| s * s)),
        case("off by one at the last waypoint", "the tin is one step behind the hand", CONTACT, || {
            paced(|s| if s < 1.0 { 0.95 * s } else { 1.0 })
        }),
        case("bounces back", "the tin moves back a little before it goes on", RAY, || {
            paced(|s| s + 0.3 * (4.0 * std::f64::consts::PI * s).sin())
        }),
        case("rolls aside", "the tin leaves the ray through its centre, and comes back to it", RAY, || {
            moved(|pose, way, s| pose.translation.vector += way.cross(&Vector3::z()) * (0.1 * s * (1.0 - s)))
        }),
        case("turns the tin", "the friction of one finger turns the tin along, and it goes straight on", RAY, || {
            moved(|pose, _, s| {
                pose.rotation = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 0.2 * s) * pose.rotation;
            })
        }),
        case("tips the tin", "the tin leans as it is pushed", SUPPORT, || {
            moved(|pose, _, s| {
                pose.rotation = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), 0.2 * s) * pose.rotation;
            })
        }),
        case(
            "turns too sharply",
            "the arc is as sharp as the arm can turn, and the tin rolls off the fingers",
            TURN,
            || {
                let (scene, start, way) = push()?;
                // A quarter of the way: nearly half a turn in less than its own width.
                let arc = Slide::along_arc(start, &(start.translation.vector + way / 4.0).xy(), 2.5);
                let moves = move |_: &_, _, state: &mut _| {
                    if let Some(pose) = pose_mut(state, object(0)) {
                        *pose = arc.at((pose.translation.vector - start.translation.vector).norm() / way.norm());
                    }
                };
                scene.warped(Box::new(moves)).check()
            },
        ),
        case("lifts the tin", "the tin follows the hand's height", SUPPORT, || {
            moved(|pose, _, s| pose.translation.z += 0.01 * s)
        }),
        case("pushes over the edge", "the way is as long as asked for, and the table is not", SUPPORT, || {
            moved(|pose, way, s| pose.translation.vector += way * (3.0 * s))
        }),
        case("pushes without touching", "the contact is computed for a tin of twice the radius", TOUCH, || {
            let (mut scene, _, way) = push()?;
            let ahead = way.normalize() * 0.04;
            shift(&mut scene.from, object(0), ahead);
            scene.warped(Box::new(move |_, _, state| shift(state, object(0), ahead))).check()
        }),
        Case {
            name: "forgets an exemption",
            wrong: "pushes the tin, but does not allow the fingers to touch it",
            law: FINGERS,
            broken: || touches(|_| Contacts::default()),
            honest: || touches(|contacts| contacts),
        },
    ]
}

/// The push with other contacts, judged by the oracle. The tin is pressed a little into the fingers: to touch exactly is a
/// matter of rounding.
fn touches(change: fn(Contacts) -> Contacts) -> Result<(), Broken> {
    let (mut scene, _, way) = push()?;
    let into = way.normalize() * -0.001;
    scene.instance.contacts = change(scene.instance.contacts);
    shift(&mut scene.from, object(0), into);
    let Scene { m, from, instance } = scene.warped(Box::new(move |_, _, state| shift(state, object(0), into)));
    check_finger_contacts(&m, &SceneOracle::new(&[]), &[instance], &from, &[0.3, 0.6])
}
