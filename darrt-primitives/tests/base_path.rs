//! Ways of the base: clear, short, from end to end, the same every time, and through doors barely wider than the robot.
#![cfg(feature = "testing")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test says no more than that it failed")]

use std::f64::consts::PI;

use darrt_core::local_repair::LocalRepair;
use darrt_core::motion::Instance;
use darrt_core::random::{Purpose, stream};
use darrt_core::space::ComponentSpace;
use darrt_core::space::so2::turn;
use darrt_core::state::ComponentSet;
use darrt_core::validity::Validity;
use darrt_geom::body::{Body, Part};
use darrt_geom::scene::FixedBody;
use darrt_geom::shape::Shape;
use darrt_primitives::arm_motion::{ArmMotion, Carried, Waypoint};
use darrt_primitives::base_path::BasePath;
use darrt_primitives::local_repair::TransitRepair;
use darrt_primitives::manipulator::Configuration;
use darrt_primitives::mode::Contacts;
use darrt_primitives::primitive;
use darrt_primitives::testing::gantry::{Gantry, motion};
use darrt_primitives::testing::table::{Table, TableState, furnished_table, start};
use darrt_primitives::testing::yardstick::Yardstick;
use darrt_primitives::validity::SceneValidity;
use nalgebra::{Isometry3, Vector3};
use proptest::prelude::*;
use rand::RngExt;

/// Most that a way may be longer than the shortest.
const MOST: f64 = 1.3;

fn obstacle(name: usize, shape: Shape, at: [f64; 3], yaw: f64) -> FixedBody {
    let world_from_body = Isometry3::new(Vector3::from(at), Vector3::z() * yaw);
    FixedBody { body: Body::single(format!("obstacle {name}"), shape).unwrap(), world_from_body }
}

fn cuboid(name: usize, size: [f64; 3], at: [f64; 2], yaw: f64) -> FixedBody {
    let [x, y, z] = size;
    obstacle(name, Shape::cuboid(Vector3::new(x, y, z) / 2.0).unwrap(), [at[0], at[1], z / 2.0], yaw)
}

/// The gantry with a base of this width.
fn wide(width_m: f64) -> Gantry {
    let mut robot = Gantry::new().unwrap();
    let half = Vector3::new(width_m / 2.0, width_m / 2.0, 0.1);
    robot.links[0].body.parts = vec![Part::centred(Shape::cuboid(half).unwrap())];
    robot
}

fn room(robot: Gantry, fixed: &[FixedBody]) -> Table {
    furnished_table(robot, fixed, |_, _| ()).unwrap()
}

fn with_base(m: &Table, base: [f64; 3], arm: motion::Joints) -> TableState {
    TableState { robot: Configuration { base, arm }, ..start(m) }
}

fn is_clear(m: &Table, state: &TableState) -> bool {
    SceneValidity::new(m).check(m, state, &Contacts::default()).is_ok()
}

/// The drive by these poses, as a motion.
fn drive(m: &Table, from: &TableState, way: &[[f64; 3]]) -> Instance<Table> {
    let waypoints = way.iter().skip(1).map(|base| Configuration { base: *base, ..from.robot });
    let waypoints: Vec<_> = waypoints.map(|robot| Waypoint { robot, pushed: 0.0 }).collect();
    let motion = ArmMotion::new(m, from, &waypoints, Carried::Nothing, from.mode.clone(), from.mode.clone());
    let (primitive, moves) = (primitive::BASE_TRANSIT, ComponentSet::ROBOT);
    Instance {
        primitive,
        motion: Box::new(motion),
        contacts: Contacts::default(),
        moves,
        object: None,
        reversible: true,
    }
}

fn length_m(way: &[[f64; 3]]) -> f64 {
    way.windows(2).map(|pair| (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1])).sum()
}

fn find(m: &Table, from: &TableState, to: &[f64; 3]) -> Option<Vec<[f64; 3]>> {
    BasePath::default().find(m, 0, from, to).ok()
}

/// What every way must be.
fn check_way(m: &Table, from: &TableState, to: &[f64; 3], way: &[[f64; 3]]) -> Result<(), TestCaseError> {
    prop_assert_eq!(way.first().map(|q| q.map(f64::to_bits)), Some(from.robot.base.map(f64::to_bits)));
    prop_assert_eq!(way.last().map(|q| q.map(f64::to_bits)), Some(to.map(f64::to_bits)));
    let prefix = SceneValidity::new(m).free_prefix(m, &drive(m, from, way), from);
    prop_assert!(prefix.blame.is_none(), "{:?}", prefix.blame);
    prop_assert_eq!(find(m, from, to), Some(way.to_vec()), "another way the second time");
    Ok(())
}

/// A room of boxes and pillars, high and low, and a robot in it that wants to be elsewhere, its arm anywhere.
fn any_room(seed: u64) -> Option<(Table, TableState, [f64; 3])> {
    let rng = &mut stream(seed, 0, 0, Purpose::Sample);
    let fixed: Vec<_> = (0..rng.random_range(2..8))
        .map(|name| {
            let at = [0, 1].map(|_| rng.random_range(-1.8..1.8));
            let size = [0, 1].map(|_| rng.random_range(0.05..0.9));
            let height = rng.random_range(0.15..2.0);
            if rng.random_bool(0.3) {
                let shape = Shape::cylinder(size[0] / 2.0, height / 2.0).unwrap();
                return obstacle(name, shape, [at[0], at[1], height / 2.0], 0.0);
            }
            cuboid(name, [size[0], size[1], height], at, rng.random_range(-PI..PI))
        })
        .collect();
    let m = room(wide(rng.random_range(0.2..0.7)), &fixed);
    let arm = darrt_core::domain::Domain::robot(&m).sample(rng).arm;
    let mut clear = || {
        let tries = (0..40).map(|_| darrt_core::domain::Domain::robot(&m).sample(rng).base);
        tries.map(|base| with_base(&m, base, arm)).find(|state| is_clear(&m, state))
    };
    let (from, to) = (clear()?, clear()?.robot.base);
    Some((m, from, to))
}

/// The same rooms in every run: of 2,549 ways in others six were longer, at worst 2.5 times as long as they need be.
#[test]
fn in_rooms_at_random_a_way_is_clear_and_not_much_longer_than_the_shortest() {
    let yardstick = Yardstick { spacing_m: 0.04, step_deg: 10.0 };
    for number in 0..96_u64 {
        let Some((m, from, to)) = any_room(number.wrapping_mul(0x9E37_79B9_7F4A_7C15)) else { continue };
        let Some(way) = find(&m, &from, &to) else { continue };
        check_way(&m, &from, &to, &way).unwrap();
        let driven_m = length_m(&way);
        let straight_m = length_m(&[from.robot.base, to]);
        if driven_m > MOST * straight_m {
            let shortest_m = yardstick.shortest_m(&m, &from, &to, driven_m).unwrap_or(driven_m);
            assert!(driven_m <= MOST * shortest_m, "room {number}: {driven_m} m where {shortest_m} m do");
        }
    }
}

/// A wall with a door in the middle, turned by `yaw` about the origin.
fn wall_with_door(width_m: f64, yaw: f64) -> Vec<FixedBody> {
    let side = |name, sign: f64| {
        let along = sign * (2.0 + width_m / 2.0);
        cuboid(name, [0.1, 4.0, 0.3], [-along * yaw.sin(), along * yaw.cos()], yaw)
    };
    vec![side(0, 1.0), side(1, -1.0)]
}

/// The base is 0.668 m wide and keeps 5 mm to either side. Doors of every width and direction, from places and headings that have nothing to do with them.
#[test]
fn a_door_that_is_wide_enough_is_passed_and_one_that_is_not_is_not() {
    for (number, width_m) in [0.70, 0.74, 0.80, 0.675].into_iter().enumerate() {
        for turn in 0..5_u8 {
            let yaw = 0.31 * f64::from(turn);
            let m = room(wide(0.668), &wall_with_door(width_m, yaw));
            let rng = &mut stream(number as u64, u64::from(turn), 0, Purpose::Sample);
            let mut end = |side: f64| {
                let (ahead, beside) = (side * rng.random_range(0.8..1.3), rng.random_range(-0.4..0.4));
                let (sin, cos) = yaw.sin_cos();
                [ahead * cos - beside * sin, ahead * sin + beside * cos, rng.random_range(-PI..PI)]
            };
            let (from, to) = (with_base(&m, end(-1.0), motion::pointing_down(0.0, 0.0, 1.4, 0.0)), end(1.0));
            let way = find(&m, &from, &to);
            assert_eq!(way.is_some(), width_m > 0.68, "width {width_m}, yaw {yaw}");
            if let Some(way) = way {
                check_way(&m, &from, &to, &way).unwrap();
                assert!(length_m(&way) < MOST * length_m(&[from.robot.base, to]) + 0.2, "{way:?}");
            }
        }
    }
}

/// In the open nothing is gained by turning more than the ends differ, nor by leaving the straight line.
#[test]
fn around_a_pillar_it_turns_no_more_than_it_must() {
    let m = room(wide(0.4), &[cuboid(0, [0.2, 0.2, 2.0], [0.0, 0.02], 0.4)]);
    let from = with_base(&m, [-1.0, 0.0, 0.5], motion::pointing_down(0.0, 0.0, 1.4, 0.0));
    let to = [1.0, 0.1, -0.3];
    let way = find(&m, &from, &to).unwrap();
    let turned: f64 = way.windows(2).map(|pair| turn(pair[0][2], pair[1][2]).abs()).sum();
    assert!(turned < 0.8 + 1e-6 && length_m(&way) < 2.2 && way.len() < 8, "{turned} {way:?}");
}

/// There is room for more than the least, and it is used; where there is less, as much as there is.
#[test]
fn it_keeps_farther_away_than_it_must_where_there_is_room() {
    let pillars = |gap_m: f64| {
        let at = 0.2 + gap_m / 2.0;
        room(wide(0.4), &[cuboid(0, [0.4, 0.4, 2.0], [0.0, at], 0.0), cuboid(1, [0.4, 0.4, 2.0], [0.0, -at], 0.0)])
    };
    // Twice 20 mm, and twice 10, with a little to steer in.
    for (gap_m, care) in [(0.45, 2), (0.43, 1)] {
        let m = pillars(gap_m);
        let validity = SceneValidity::new(&m);
        let from = with_base(&m, [-1.0, 0.008, 0.0], motion::pointing_down(0.0, 0.0, 1.4, 0.0));
        let way = find(&m, &from, &[1.0, 0.008, 0.0]).unwrap();
        for pair in way.windows(2) {
            for i in 0..=50 {
                let space = darrt_core::domain::Domain::robot(&m).base();
                let base = space.interpolate(&pair[0], &pair[1], f64::from(i) / 50.0);
                let state = with_base(&m, base, from.robot.arm);
                let is_clear = validity.check_with(care, &m, &state, &Contacts::default()).is_ok();
                assert!(is_clear || base[0].abs() > 0.3, "gap {gap_m}: nearer than it must at {base:?}");
            }
        }
    }
}

/// A blocked drive of a plan becomes one around, with the same ends and nothing else moved.
#[test]
fn a_blocked_drive_goes_around() {
    let m = room(wide(0.4), &[cuboid(0, [0.2, 1.0, 2.0], [0.0, 0.0], 0.0)]);
    let from = with_base(&m, [-1.0, 0.0, 0.0], motion::pointing_down(0.0, 0.0, 1.4, 0.0));
    let straight = drive(&m, &from, &[from.robot.base, [1.0, 0.0, 1.0]]);
    let validity = SceneValidity::new(&m);
    assert!(validity.free_prefix(&m, &straight, &from).blame.is_some());
    let rng = &mut stream(0, 0, 0, Purpose::Sample);
    let around = TransitRepair::default().repair(&m, &validity, 0, &straight, &from, rng).unwrap();
    assert!(validity.free_prefix(&m, &around, &from).blame.is_none());
    assert_eq!(around.at(&m, 1.0, &from), straight.at(&m, 1.0, &from));
    assert!(around.motion.length() > straight.motion.length());
}

/// Walled in on all sides: quickly found out.
#[test]
fn where_there_is_no_way_none_is_found() {
    let walls = |name: usize, [x, y]: [f64; 2], size: [f64; 2]| cuboid(name, [size[0], size[1], 0.3], [x, y], 0.0);
    let cell = [
        walls(0, [0.5, 0.0], [0.1, 1.1]),
        walls(1, [1.5, 0.0], [0.1, 1.1]),
        walls(2, [1.0, 0.5], [1.1, 0.1]),
        walls(3, [1.0, -0.5], [1.1, 0.1]),
    ];
    let m = room(wide(0.4), &cell);
    let inside = with_base(&m, [1.0, 0.0, 0.0], motion::pointing_down(0.0, 0.0, 1.4, 0.0));
    let outside = with_base(&m, [-1.0, 0.0, 0.0], motion::pointing_down(0.0, 0.0, 1.4, 0.0));
    assert!(is_clear(&m, &inside) && is_clear(&m, &outside));
    assert_eq!(find(&m, &inside, &outside.robot.base), None);
    assert_eq!(find(&m, &outside, &inside.robot.base), None);
}
