//! What is done at the table, case by case: what the instances say about themselves, and where the objects end.
#![cfg(feature = "testing")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test says no more than that it failed")]

use darrt_core::motion::Instance;
use darrt_core::primitive::{Infeasible, Instances};
use darrt_core::random::{Purpose, Stream, stream};
use darrt_core::state::{ComponentId, ComponentSet, ObjectId};
use darrt_primitives::action::line::{follow_in_room, room_for_hand};
use darrt_primitives::action::stance::Refused;
use darrt_primitives::action::transfer::{transfer, transfer_by_base};
use darrt_primitives::action::{pick::pick, place::place, push::push};
use darrt_primitives::edge_margin::Brink;
use darrt_primitives::grasp::footprint::Footprint;
use darrt_primitives::grasp::overhead::{OverheadGrasps, WallGrasps, WallOptions};
use darrt_primitives::grasp::rim::{Rim, RimGrasps, RimOptions};
use darrt_primitives::grasp::{GraspFamily, Grip};
use darrt_primitives::length_range::LengthRange;
use darrt_primitives::manipulator::{Configuration, Manipulator};
use darrt_primitives::mode::{Contacts, SurfaceId, TouchReason};
use darrt_primitives::object_space::upright;
use darrt_primitives::primitive;
use darrt_primitives::push::Friction;
use darrt_primitives::push::edge_stop::RimReach;
use darrt_primitives::push::steady::SlidingDisc;
use darrt_primitives::tabletop::{Movable, PushSettings};
use darrt_primitives::target_query::asks_to_push;
use darrt_primitives::testing::gantry::{Gantry, MAX_GAP_M, TIP_BEYOND_TOOL_M, motion};
use darrt_primitives::testing::table::{Table, TableState, altered_table, honest_table, object, start};
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
    assert_eq!((approach.primitive, along.primitive), (primitive::STRAIGHT_LINE_ARM_TRANSIT, primitive::PUSH));
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
fn fingertips_that_pass_above_an_object_do_not_push_it() {
    let height_m = 2.0 * honest_table().unwrap().movable(object(0)).unwrap().half_height_m;
    for (clearance_m, refusal) in [(0.5 * height_m, None), (height_m, Some(Infeasible::NoContact))] {
        let m = altered_table(Gantry::new().unwrap(), |_, s| s.push.fingertip_clearance_m = clearance_m).unwrap();
        let from = start(&m);
        let mut target = *from.object(object(0)).unwrap();
        target.translation.x += 0.1;
        let act = |seed| push(&m, &from, object(0), &target, &mut stream(seed, 0, 0, Purpose::Extend)).err();
        assert!((0..64).map(act).any(|found| found == refusal), "{clearance_m}");
        assert!(refusal.is_none() || (0..64).map(act).all(|found| found == refusal), "{clearance_m}");
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

#[test]
fn what_would_not_stay_at_the_fingers_or_is_too_heavy_is_not_pushed() {
    type Change = fn(&mut Movable, &mut PushSettings);
    let changes: [(Change, Option<Infeasible>); 3] = [
        (|_, _| (), None),
        // The fingers are 40 mm apart.
        (|_, push| push.position_error_m = 0.021, Some(Infeasible::UnstablePush)),
        (|tin, _| tin.mass_kg = 0.0, Some(Infeasible::UnstablePush)),
    ];
    for (change, refusal) in changes {
        let m = altered_table(Gantry::new().unwrap(), |objects, s| change(&mut objects[0], &mut s.push)).unwrap();
        let from = start(&m);
        let mut target = pose(&from, object(0));
        target.translation.x += 0.1;
        let act = |seed| push(&m, &from, object(0), &target, &mut stream(seed, 0, 0, Purpose::Extend)).err();
        assert!((0..64).map(act).any(|found| found == refusal), "{refusal:?}");
        assert!(refusal.is_none() || (0..64).map(act).all(|found| found == refusal), "{refusal:?}");
    }
}

/// A push that is cut short settles what the place of the object may be off; one whose end is near is as short as that.
#[test]
fn pushes_are_long_enough_to_settle_unless_their_end_is_near() {
    let m = altered_table(Gantry::new().unwrap(), |_, s| s.push.position_error_m = 0.015).unwrap();
    let from = start(&m);
    let disc = SlidingDisc {
        radius_m: 0.04,
        mass_kg: 0.3,
        table: Friction::new(0.3).unwrap(),
        fingers: Friction::new(0.5).unwrap(),
    };
    let settle_m = disc.steady_push(0.04, 0.015, f64::INFINITY).unwrap().settle_m;
    assert!((0.05..0.2).contains(&settle_m), "{settle_m}");
    let mut cut = 0;
    for seed in 0..64 {
        // The blue tin is in the way, 0.28 m ahead of the place where the red one would touch it.
        for ahead_m in [0.03, 0.3, 0.6] {
            let mut target = pose(&from, object(0));
            target.translation.vector +=
                (pose(&from, object(1)).translation.vector - target.translation.vector).normalize() * ahead_m;
            let wanted = (target.translation.vector - pose(&from, object(0)).translation.vector).xy();
            let Ok(way) = push(&m, &from, object(0), &target, &mut stream(seed, 0, 0, Purpose::Extend)) else {
                continue;
            };
            let went_m = moved(&m, &from, &way).norm();
            assert!(went_m >= settle_m.min(wanted.norm()) - 1e-9, "{went_m} of {wanted}");
            cut += u32::from(went_m < wanted.norm() - 1e-3);
        }
    }
    assert!(cut > 3, "{cut}");
}

#[test]
fn nothing_is_left_nearer_to_an_edge_than_it_may() {
    let id = object(0);
    let m = honest_table().unwrap();
    let surface = m.surface(SurfaceId::new(0)).unwrap();
    let (from, here) = (lifted(&m, id), start(&m));
    let at = |x: f64| upright(Vector3::new(x, 0.1, 0.74), 0.0);
    // The left edge of the table is at x = -0.9, the margin is 0.02.
    for (x, may) in [(-0.879, true), (-0.881, false)] {
        let placed = (0..32).any(|seed| place(&m, &from, &at(x), &mut stream(seed, 0, 0, Purpose::Extend)).is_ok());
        assert_eq!(placed, may, "{x}");
    }
    assert_eq!(place(&m, &from, &at(-0.89), &mut stream(0, 0, 0, Purpose::Extend)).err(), Some(Infeasible::OffSupport));
    for seed in 0..32 {
        let Ok(way) = push(&m, &here, id, &at(-0.89), &mut stream(seed, 0, 0, Purpose::Extend)) else { continue };
        let end = pose(&end(&m, &here, &way), id).translation;
        assert!(surface.depth(&Point2::new(end.x, end.y)) >= 0.02 - 1e-9);
    }
    // A goal on the brink forces it.
    let brink = Brink {
        surface: SurfaceId::new(0),
        min: Point2::new(-0.89, 0.1),
        max: Point2::new(-0.89, 0.1),
        margin_m: 0.01,
    };
    let m = altered_table(Gantry::new().unwrap(), |objects, _| objects[0].brinks = vec![brink]).unwrap();
    let (from, here) = (lifted(&m, id), start(&m));
    let placed = first(|rng| place(&m, &from, &at(-0.89), rng));
    assert_at(&pose(&end(&m, &from, &placed), id), &at(-0.89), true);
    let pushed = first(|rng| push(&m, &here, id, &at(-0.89), rng));
    assert!((pose(&end(&m, &here, &pushed), id).translation.x + 0.89).abs() < 1e-9);
    assert_eq!(
        place(&m, &from, &at(-0.885), &mut stream(0, 0, 0, Purpose::Extend)).err(),
        Some(Infeasible::OffSupport)
    );
}

/// A board 4 cm above what is set down, lifted or pushed: lines of the hand get as short as the room is.
#[test]
fn lines_of_the_hand_fit_the_room() {
    let m = honest_table().unwrap();
    let from = start(&m);
    let line = |range: LengthRange| {
        // With all the room that is wanted, up to 0.03 m; with what is needed, up to 0.04 m.
        let clear = |at: &Isometry3<f64>, care| at.translation.z <= if care > 0 { 0.03 } else { 0.04 };
        room_for_hand(&m, range, &Isometry3::identity(), &Vector3::z(), clear)
    };
    let range = |least_m, wanted_m| LengthRange::new(least_m, wanted_m).unwrap();
    assert_eq!(line(range(0.02, 0.1)).map(LengthRange::wanted_m), Ok(0.025));
    assert_eq!(line(range(0.02, 0.03)).map(LengthRange::wanted_m), Ok(0.03));
    assert_eq!(line(range(0.035, 0.1)).map(LengthRange::wanted_m), Ok(0.035));
    assert_eq!(line(range(0.05, 0.1)), Err(Isometry3::translation(0.0, 0.0, 0.05)));
    // The arm follows as far as it reaches, which may not be far enough.
    let tool = m.manipulator().world_from_tool(&from.robot);
    let follow = |range, check: &dyn Fn(f64) -> bool| {
        let refuse = |q: &Configuration<_>| {
            let up = m.manipulator().world_from_tool(q).translation.z - tool.translation.z;
            if check(up) { Ok(()) } else { Err(Refused::Unreachable) }
        };
        follow_in_room(&m, &from.robot, &tool, &Vector3::z(), range, refuse).map(|line| line.reached_m())
    };
    assert!(matches!(follow(range(0.01, 0.08), &|_| true), Ok(up) if (up - 0.08).abs() < 1e-9));
    assert!(matches!(follow(range(0.01, 0.08), &|up| up < 0.05), Ok(up) if (up - 0.04).abs() < 1e-9));
    assert!(follow(range(0.06, 0.08), &|up| up < 0.05).is_err());
    assert!(follow(range(3.0, 4.0), &|_| true).is_err());
}

#[test]
fn only_what_may_be_pushed_is_pushed() {
    // The red tin is round, but it must not be pushed; the box is not round.
    let m = altered_table(Gantry::new().unwrap(), |objects, _| objects[0].is_pushable = false).unwrap();
    let from = start(&m);
    for (id, may) in [(object(0), false), (object(1), true), (object(2), false)] {
        let mut target = pose(&from, id);
        target.translation.x += 0.1;
        let ends: Vec<_> =
            (0..8).map(|seed| push(&m, &from, id, &target, &mut stream(seed, 0, 0, Purpose::Extend))).collect();
        assert_eq!((asks_to_push(&m, &from, id, &target), ends.iter().any(Result::is_ok)), (may, may));
        assert_eq!(ends.iter().all(|end| matches!(end, Err(Infeasible::NoContact))), !may);
    }
}

/// Just above where the tool is while it pushes on the left table, metres.
const HAND_WHILE_PUSHING_M: f64 = 0.767;

/// An arm that follows a line of its tool only between these x, but higher up also before the first of them.
fn near_between<const FROM_MM: i16, const TO_MM: i16>(
    base: &[f64; 3],
    tool: &Isometry3<f64>,
    near: &motion::Joints,
) -> Option<motion::Joints> {
    let [low, high] = [FROM_MM, TO_MM].map(|mm| f64::from(mm) / 1000.0);
    let reaches =
        tool.translation.x <= high && (tool.translation.x >= low || tool.translation.z > HAND_WHILE_PUSHING_M);
    reaches.then(|| motion::near(base, tool, near)).flatten()
}

#[test]
fn a_push_needs_room_behind_the_object_and_two_centimetres_ahead() {
    type Near = fn(&[f64; 3], &Isometry3<f64>, &motion::Joints) -> Option<motion::Joints>;
    let reach = |near: Near| {
        let m = altered_table(Gantry { near, ..Gantry::new().unwrap() }, |_, s| s.line_step_m = 0.005).unwrap();
        let from = start(&m);
        let mut target = pose(&from, object(0));
        target.translation.x += 0.1;
        let act = |seed| push(&m, &from, object(0), &target, &mut stream(seed, 0, 0, Purpose::Extend));
        let ends: Vec<_> = (0..16).filter_map(|seed| act(seed).ok()).map(|way| moved(&m, &from, &way).x).collect();
        ends.into_iter().reduce(f64::max)
    };
    // The tool is at x = -0.645 when the fingers touch the tin, and comes down at -0.675.
    for (near, reached_mm) in [
        (near_between::<-680, 0> as Near, Some(100.0)),
        (near_between::<-680, -618>, Some(26.0)),
        (near_between::<-680, -630>, None),
        (near_between::<-660, 0>, None),
    ] {
        assert_eq!(reach(near).map(|x| (x * 1000.0).round()), reached_mm);
    }
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

/// What may touch while the fingers close around `id` on the left table, or open from it.
fn on_the_left_table(id: ObjectId) -> Contacts {
    Contacts { fingers: Some((id, TouchReason::Grasp)), support: Some((id, SurfaceId::new(0))) }
}

#[test]
fn a_pick_lifts_the_object_straight_up() {
    let m = honest_table().unwrap();
    let from = start(&m);
    for id in (0..3).map(object) {
        let instances = first(|rng| pick(&m, &from, id, rng));
        let [.., approach, lift] = &instances[..] else { panic!("too few instances") };
        assert_eq!((approach.primitive, approach.object), (primitive::STRAIGHT_LINE_ARM_TRANSIT, Some(id)));
        assert_eq!((lift.primitive, lift.object, lift.reversible), (primitive::PICK, Some(id), false));
        assert_eq!((approach.contacts, lift.contacts), (Contacts::default(), on_the_left_table(id)));
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
        let [carried @ .., down, back] = &instances[..] else { panic!("too few instances") };
        assert_eq!((down.primitive, down.object, down.reversible), (primitive::PLACE, Some(id), false));
        assert!(carried.iter().all(|instance| instance.contacts == Contacts::default()));
        assert_eq!(down.contacts, on_the_left_table(id));
        assert_eq!(back.contacts, Contacts { fingers: Some((id, TouchReason::Retreat)), support: None });
        let after = end(&m, &from, &instances);
        assert_at(&pose(&after, id), &upright(Vector3::new(-0.3, -0.05, z), 0.5), id != object(2));
        assert_eq!((after.mode.held(), after.mode.engaged()), (None, None));
        assert_eq!(after.mode.support_of(id), Some(SurfaceId::new(0)));
        // The fingers open by the settings' 0.01 m.
        assert!((after.mode.gap_m() - from.mode.gap_m() - 0.01).abs() < 1e-12);
    }
}

/// The way of the hand in `instance`, in its own frame: x is where it points.
fn way_of_the_hand(m: &Table, from: &TableState, instance: &Instance<Table>) -> Vector3<f64> {
    let at = |s| m.manipulator().world_from_tool(&instance.at(m, s, from).robot);
    let way = at(0.0).inverse() * at(1.0);
    assert!(way.rotation.angle() < 1e-6, "{way}");
    way.translation.vector
}

#[test]
fn the_hand_goes_in_and_out_along_its_own_axis() {
    // Where no direction is named, things are set down from above as well.
    let unnamed = altered_table(Gantry::new().unwrap(), |_, settings| settings.place.approach_directions.clear());
    for m in [honest_table().unwrap(), unnamed.unwrap()] {
        let goes = |from: &TableState, instance: &Instance<Table>, ahead: f64| {
            let way = way_of_the_hand(&m, from, instance);
            assert!((way - Vector3::x() * ahead).norm() < 1e-6, "{way}");
        };
        for id in (0..3).map(object) {
            let from = start(&m);
            let picked = first(|rng| pick(&m, &from, id, rng));
            let [there @ .., approach, _] = &picked[..] else { panic!("too few instances") };
            goes(&end(&m, &from, there), approach, 0.1);

            let from = end(&m, &from, &picked);
            let target = upright(Vector3::new(-0.3, -0.05, 0.7 + m.movable(id).unwrap().half_height_m), 0.5);
            let placed = first(|rng| place(&m, &from, &target, rng));
            let [there @ .., down, back] = &placed[..] else { panic!("too few instances") };
            let above = end(&m, &from, there);
            goes(&above, down, 0.1);
            goes(&down.at(&m, 1.0, &above), back, -0.1);
        }
    }
}

#[test]
fn a_lift_may_end_where_the_arm_does_if_that_is_high_enough() {
    // The arm lifts a tin by less than 0.9 m.
    for (least, may) in [(0.7, true), (1.0, false)] {
        let m = altered_table(Gantry::new().unwrap(), |objects, _| objects[0].lift_m = [least, 2.0]).unwrap();
        let from = start(&m);
        for seed in 0..8 {
            match pick(&m, &from, object(0), &mut stream(seed, 0, 0, Purpose::Extend)) {
                Ok(picked) => {
                    let up = pose(&end(&m, &from, &picked), object(0)).translation.z - 0.74;
                    assert!(may && (least..0.9).contains(&up), "{up}");
                }
                Err(why) => assert!(!may && why == Infeasible::Unreachable, "{why:?}"),
            }
        }
    }
}

/// The table whose red tin can be grasped in this way only.
fn grasped_by(grasps: impl GraspFamily + 'static) -> Table {
    altered_table(Gantry::new().unwrap(), |objects, _| {
        objects[0].grasps = vec![Box::new(grasps)];
        objects[0].rim = RimReach { insertion: 0.02, clearance: 0.005, ..RimReach::default() };
    })
    .unwrap()
}

fn grip(open_gap: f64) -> Grip {
    let approach = LengthRange::new(0.05, 0.1).unwrap();
    Grip { open_gap, tip_ahead: TIP_BEYOND_TOOL_M, approach, ..Grip::default() }
}

#[test]
fn the_fingers_open_no_farther_than_they_can() {
    let m = grasped_by(OverheadGrasps::new(Footprint::Disc { radius: 0.04 }, 0.08, 0.03, grip(0.2)).unwrap());
    let from = start(&m);
    let picked = first(|rng| pick(&m, &from, object(0), rng));
    let [before @ .., _] = &picked[..] else { panic!("too few instances") };
    assert_eq!(end(&m, &from, before).mode.gap_m(), MAX_GAP_M);
}

#[test]
fn a_rim_is_gripped_only_where_it_sticks_out_over_the_edge() {
    let options = RimOptions { insertion: 0.02, ..RimOptions::default() };
    let m = grasped_by(RimGrasps::new(Rim::level(0.04, 0.08, 0.04).unwrap(), grip(0.095), options).unwrap());
    let mut from = start(&m);
    let picks = |from: &TableState| -> Vec<_> {
        (0..16).map(|seed| pick(&m, from, object(0), &mut stream(seed, 0, 0, Purpose::Extend))).collect()
    };
    assert!(picks(&from).iter().all(|end| matches!(end, Err(Infeasible::NoGrasp))));

    // 0.01 m inside the left edge, and turned: the azimuths of the grasps are about the tin's own axes.
    from.objects[0] = upright(Vector3::new(-0.89, -0.3, 0.74), 2.0);
    let picked: Vec<_> = picks(&from).into_iter().flatten().collect();
    assert!(!picked.is_empty());
    for instances in picked {
        let tool = m.manipulator().world_from_tool(&end(&m, &from, &instances).robot);
        // The fingertips, 0.02 m from the axis, are 0.005 m beside the table: 0.02 cos - 0.01 >= 0.005.
        assert!((tool.rotation * Vector3::x()).x >= 0.75 - 1e-6, "{tool}");
    }
}

#[test]
fn what_no_grasp_holds_is_not_picked() {
    let table = |mass_kg, fingers| {
        let change = |objects: &mut [Movable], _: &mut _| {
            (objects[0].mass_kg, objects[0].friction.fingers) = (mass_kg, fingers);
        };
        altered_table(Gantry::new().unwrap(), change).unwrap()
    };
    let picks = |m: &Table| -> Vec<_> {
        (0..16).map(|seed| pick(m, &start(m), object(0), &mut stream(seed, 0, 0, Purpose::Extend))).collect()
    };
    // The gantry grips and carries without limit.
    assert!(picks(&table(50.0, 0.5)).iter().any(Result::is_ok));
    assert!(picks(&table(0.3, 0.0)).iter().all(|end| matches!(end, Err(Infeasible::NoHold))));
}

#[test]
fn one_finger_stands_inside_the_bowl_that_is_picked_by_its_wall() {
    let m = grasped_by(WallGrasps::new(0.04, 0.08, 0.005, grip(0.05), WallOptions::default()).unwrap());
    let from = start(&m);
    let picked = first(|rng| pick(&m, &from, object(0), rng));
    let [.., approach, lift] = &picked[..] else { panic!("too few instances") };
    assert_eq!(approach.contacts, Contacts { fingers: Some((object(0), TouchReason::Grasp)), support: None });
    assert_eq!(lift.contacts, on_the_left_table(object(0)));
}

#[test]
fn a_transfer_brings_what_is_held_to_its_target() {
    let m = honest_table().unwrap();
    for id in (0..3).map(object) {
        let from = lifted(&m, id);
        let target = upright(Vector3::new(0.4, 0.2, 1.0), 0.7);
        let instances = first(|rng| transfer(&m, &from, &target, None, rng));
        assert!(instances.iter().all(|i| i.object == Some(id) && i.reversible));
        let names = [primitive::ARM_RIGID_TRANSFER, primitive::BASE_RIGID_TRANSFER];
        assert!(instances.iter().all(|i| names.contains(&i.primitive)));
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
        assert_eq!(instances.iter().map(|i| i.primitive).collect::<Vec<_>>(), [primitive::BASE_RIGID_TRANSFER]);
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
