//! What is done at the table, case by case: what the instances say about themselves, and where the objects end.
#![cfg(feature = "testing")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test says no more than that it failed")]

use darrt_core::motion::Instance;
use darrt_core::primitive::{Infeasible, Instances};
use darrt_core::random::{Purpose, Stream, stream};
use darrt_core::state::{ComponentId, ComponentSet, ObjectId};
use darrt_primitives::action::transfer::{transfer, transfer_by_base};
use darrt_primitives::action::{label, pick::pick, place::place, push::push};
use darrt_primitives::mode::{Contacts, SurfaceId, TouchReason};
use darrt_primitives::object_space::upright;
use darrt_primitives::testing::table::{Table, TableState, honest_table, object, start};
use nalgebra::{Isometry3, Point2, Translation3, UnitQuaternion, Vector2, Vector3};

/// What `act` does with the first random numbers with which it succeeds.
fn first(act: impl Fn(&mut Stream) -> Result<Instances<Table>, Infeasible>) -> Instances<Table> {
    (0..64).find_map(|seed| act(&mut stream(seed, 0, 0, Purpose::Extend)).ok()).unwrap()
}

/// A push of the red tin by `by`.
fn pushed(m: &Table, from: &TableState, by: [f64; 2]) -> Instances<Table> {
    let mut target = *from.object(object(0)).unwrap();
    target.translation.x += by[0];
    target.translation.y += by[1];
    first(|rng| push(m, from, object(0), &target, rng))
}

fn end(m: &Table, from: &TableState, instances: &[Instance<Table>]) -> TableState {
    instances.iter().fold(from.clone(), |here, instance| instance.at(m, 1.0, &here))
}

fn moved(m: &Table, from: &TableState, instances: &[Instance<Table>]) -> Vector2<f64> {
    let at = |state: &TableState| state.object(object(0)).unwrap().translation.vector.xy();
    at(&end(m, from, instances)) - at(from)
}

#[test]
fn a_push_comes_up_to_the_object_and_takes_it_along() {
    let m = honest_table().unwrap();
    let from = start(&m);
    let instances = pushed(&m, &from, [0.1, 0.05]);
    let [.., approach, along] = &instances[..] else { panic!("too few instances") };
    assert_eq!((approach.label, along.label), (label::STRAIGHT_LINE_ARM_TRANSIT, label::PUSH));
    assert_eq!((approach.object, along.object), (Some(object(0)), Some(object(0))));
    assert_eq!((approach.moves, approach.contacts), (ComponentSet::ROBOT, Contacts::default()));
    assert_eq!(along.moves, ComponentSet::ROBOT.with(ComponentId::Object(object(0))));
    assert_eq!(along.contacts.fingers, Some((object(0), TouchReason::Push)));
    assert!(approach.reversible && !along.reversible);
    assert!((moved(&m, &from, &instances) - Vector2::new(0.1, 0.05)).norm() < 1e-9);
}

/// The arm follows it in a single step.
#[test]
fn a_short_push_arrives_too() {
    let m = honest_table().unwrap();
    let from = start(&m);
    for by in [[0.015, 0.0], [0.0, 0.019]] {
        assert!((moved(&m, &from, &pushed(&m, &from, by)) - Vector2::from(by)).norm() < 1e-9);
    }
}

#[test]
fn a_hand_at_an_object_backs_out_before_it_pushes_again() {
    let m = honest_table().unwrap();
    let from = start(&m);
    let there = end(&m, &from, &pushed(&m, &from, [0.1, 0.0]));
    assert_eq!(there.mode.engaged(), Some(object(0)));
    let again = pushed(&m, &there, [0.0, 0.1]);
    assert_eq!(again[0].contacts.fingers, Some((object(0), TouchReason::Retreat)));
    assert!((moved(&m, &there, &again) - Vector2::new(0.0, 0.1)).norm() < 1e-9);
}

#[test]
fn a_push_off_the_table_stops_at_all_the_distances_that_are_asked_for() {
    let m = honest_table().unwrap();
    let from = start(&m);
    let target = Isometry3::translation(-1.4, -0.3, 0.74);
    let surface = m.surface(from.mode.support_of(object(0)).unwrap()).unwrap();
    let mut depths = Vec::new();
    for seed in 0..32 {
        let Ok(instances) = push(&m, &from, object(0), &target, &mut stream(seed, 0, 0, Purpose::Extend)) else {
            continue;
        };
        let at = end(&m, &from, &instances).object(object(0)).unwrap().translation;
        depths.push(surface.depth(&Point2::new(at.x, at.y)));
    }
    assert!(depths.iter().all(|d| (0.02 - 1e-9..=0.06 + 1e-9).contains(d)), "{depths:?}");
    let least = depths.iter().copied().fold(f64::INFINITY, f64::min);
    let most = depths.iter().copied().fold(0.0, f64::max);
    assert!(most - least > 0.01, "{depths:?}");
}

/// The table with `id` just lifted.
fn lifted(m: &Table, id: ObjectId) -> TableState {
    let from = start(m);
    end(m, &from, &first(|rng| pick(m, &from, id, rng)))
}

fn pose(state: &TableState, id: ObjectId) -> Isometry3<f64> {
    *state.object(id).unwrap()
}

/// Same place and same axis; the same turn about it as well, unless the object is round.
fn assert_at(found: &Isometry3<f64>, wanted: &Isometry3<f64>, is_round: bool) {
    let off = (found.translation.vector - wanted.translation.vector).norm();
    let tilt = (found.rotation * Vector3::z()).angle(&(wanted.rotation * Vector3::z()));
    let turn = if is_round { 0.0 } else { found.rotation.angle_to(&wanted.rotation) };
    assert!(off < 1e-6 && tilt < 1e-6 && turn < 1e-6, "{found} is not {wanted}");
}

#[test]
fn a_pick_lifts_the_object_straight_up() {
    let m = honest_table().unwrap();
    let from = start(&m);
    for id in (0..3).map(object) {
        let instances = first(|rng| pick(&m, &from, id, rng));
        let [.., approach, lift] = &instances[..] else { panic!("too few instances") };
        assert_eq!((approach.label, approach.object), (label::STRAIGHT_LINE_ARM_TRANSIT, Some(id)));
        assert_eq!((lift.label, lift.object, lift.reversible), (label::PICK, Some(id), false));
        let after = end(&m, &from, &instances);
        assert_eq!(after.mode.held().map(|held| held.object), Some(id));
        let up = pose(&after, id).translation.vector - pose(&from, id).translation.vector;
        assert!(up.xy().norm() < 1e-6 && (0.05..=0.15 + 1e-9).contains(&up.z), "{up}");
    }
}

#[test]
fn a_hand_at_one_object_backs_out_before_it_picks_another() {
    let m = honest_table().unwrap();
    let from = start(&m);
    let there = end(&m, &from, &pushed(&m, &from, [0.1, 0.0]));
    let instances = first(|rng| pick(&m, &there, object(1), rng));
    assert_eq!(instances[0].contacts.fingers, Some((object(0), TouchReason::Retreat)));
    assert!(!instances[0].reversible);
}

#[test]
fn a_place_sets_the_object_down_and_lets_go() {
    let m = honest_table().unwrap();
    for id in (0..3).map(object) {
        let from = lifted(&m, id);
        // Meant to stand on the table, but not quite right: too high.
        let z = 0.7 + m.movable(id).unwrap().half_height_m;
        let target = upright(Vector3::new(-0.3, -0.05, z + 0.01), 0.5);
        let instances = first(|rng| place(&m, &from, &target, rng));
        let [.., down, back] = &instances[..] else { panic!("too few instances") };
        assert_eq!((down.label, down.object, down.reversible), (label::PLACE, Some(id), false));
        assert_eq!(back.contacts.fingers, Some((id, TouchReason::Retreat)));
        let after = end(&m, &from, &instances);
        assert_at(&pose(&after, id), &upright(Vector3::new(-0.3, -0.05, z), 0.5), id != object(2));
        assert_eq!((after.mode.held(), after.mode.engaged()), (None, None));
        assert_eq!(after.mode.support_of(id), Some(SurfaceId::new(0)));
        // The fingers open by the settings' 0.01 m.
        assert!((after.mode.gap_m() - from.mode.gap_m() - 0.01).abs() < 1e-12);
    }
}

#[test]
fn a_transfer_brings_what_is_held_to_its_target() {
    let m = honest_table().unwrap();
    for id in (0..3).map(object) {
        let from = lifted(&m, id);
        let target = upright(Vector3::new(0.4, 0.2, 1.0), 0.7);
        let instances = first(|rng| transfer(&m, &from, &target, rng));
        assert!(instances.iter().all(|i| i.object == Some(id) && i.reversible));
        let names = [label::ARM_RIGID_TRANSFER, label::BASE_RIGID_TRANSFER];
        assert!(instances.iter().all(|i| names.contains(&i.label)));
        assert_at(&pose(&end(&m, &from, &instances), id), &target, id != object(2));
    }
}

#[test]
fn the_base_alone_carries_on_the_level_and_no_other_way() {
    let m = honest_table().unwrap();
    for id in (0..3).map(object) {
        let from = lifted(&m, id);
        let here = pose(&from, id);
        let turned = |axis: Vector3<f64>, by: [f64; 3]| {
            let rotation = UnitQuaternion::from_scaled_axis(axis) * here.rotation;
            Isometry3::from_parts(Translation3::from(here.translation.vector + Vector3::from(by)), rotation)
        };
        let alone =
            |target: &Isometry3<f64>| transfer_by_base(&m, &from, target, &mut stream(3, 0, 0, Purpose::Extend));
        let target = turned(Vector3::z() * 0.6, [0.3, -0.2, 0.0]);
        let instances = alone(&target).unwrap();
        assert_eq!(instances.iter().map(|i| i.label).collect::<Vec<_>>(), [label::BASE_RIGID_TRANSFER]);
        let after = end(&m, &from, &instances);
        assert_eq!(after.robot.arm, from.robot.arm);
        assert_at(&pose(&after, id), &target, id != object(2));
        for (target, why) in [
            (turned(Vector3::zeros(), [0.1, 0.0, 0.05]), Infeasible::Unreachable),
            (turned(Vector3::zeros(), [0.1, 0.0, -0.05]), Infeasible::Unreachable),
            (turned(Vector3::x() * 0.2, [0.1, 0.0, 0.0]), Infeasible::Unreachable),
            (turned(Vector3::zeros(), [9.0, 0.0, 0.0]), Infeasible::Limits),
        ] {
            assert_eq!(alone(&target).unwrap_err(), why);
        }
        assert_eq!(
            transfer_by_base(&m, &start(&m), &target, &mut stream(3, 0, 0, Purpose::Extend)).unwrap_err(),
            Infeasible::NoGrasp
        );
    }
}
