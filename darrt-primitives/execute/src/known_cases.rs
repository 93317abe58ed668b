//! The physics is held to cases whose outcome is known: formulas of planar pushing, of friction and of levers, and figures that
//! another engine gives.

#![allow(clippy::unwrap_used, reason = "a test says what is wrong by panicking")]
#![allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "counts of time steps")]

use darrt_primitives::kinematics::{MeshPlaces, RobotDescription};
use darrt_primitives::push::Friction;
use darrt_primitives::push::limit_surface::PressureConstant;
use darrt_primitives::push::one_point::DiscDrift;
use darrt_primitives::push::settling::Funnel;
use darrt_task::clock::MotionLimits;
use darrt_task::problem_file::ShapeSpec;
use darrt_task::robot::RobotFacts;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use rapier3d_f64::prelude::{
    ColliderBuilder, PhysicsWorld, Pose, RigidBodyBuilder, RigidBodyHandle, SharedShape, Vector,
};
use std::sync::Arc;

use crate::robot::Robot;
use crate::solids::{self, Piece};
use crate::stage::{GRAVITY, STEP_S, Scenery, Stage, TrueObject, add_object, add_room, empty_world, robot_group};

const FRICTION: f64 = 0.3;
const HEIGHT_M: f64 = 0.02;

fn disc(radius: f64) -> Vec<Piece> {
    solids::of_object("disc", &ShapeSpec::Cylinder { radius, height: HEIGHT_M }).unwrap()
}

fn object(at: [f64; 3], friction: f64) -> TrueObject {
    let world_from_object = Isometry3::translation(at[0], at[1], at[2]);
    TrueObject { world_from_object, mass_kg: 0.5, table_friction: friction, finger_friction: friction }
}

/// A table with its top at z = 0 from x = -1 to x = 0, and a disc on it.
fn table_with(radius: f64, x: f64, y: f64) -> (PhysicsWorld, RigidBodyHandle) {
    let mut world = empty_world();
    let body_from_piece = Pose::from(Isometry3::translation(-0.5, 0.0, -0.02));
    let top = Piece { shape: SharedShape::cuboid(0.5, 0.6, 0.02), body_from_piece };
    add_room(&mut world, &Scenery::of_pieces(vec![top]));
    let disc = add_object(&mut world, 0, &disc(radius), &object([x, y, HEIGHT_M / 2.0], FRICTION));
    (world, disc)
}

fn run(world: &mut PhysicsWorld, seconds: f64) {
    (0..(seconds / STEP_S).round() as u32).for_each(|_| world.step());
}

fn place(world: &PhysicsWorld, body: RigidBodyHandle) -> Isometry3<f64> {
    (*world.bodies[body].position()).into()
}

#[test]
fn what_stands_stays_and_presses_with_its_weight() {
    let (mut world, plate) = table_with(0.14, -0.5, 0.0);
    run(&mut world, 0.5);
    let before = place(&world, plate);
    run(&mut world, 3.0);
    let moved = (place(&world, plate).translation.vector - before.translation.vector).norm();
    assert!(moved < 1e-4, "moved by {moved}");
    assert!(before.translation.z > HEIGHT_M / 2.0 - 3e-4, "sank to {}", before.translation.z);
    let weight: f64 = world.contact_pairs().map(|pair| pair.total_impulse().length() / STEP_S).sum();
    // The engine tells forces up to a quarter too large.
    assert!((1.0..1.3).contains(&(weight / (0.5 * GRAVITY))), "{weight} N");
}

#[test]
fn what_slides_coasts_as_far_as_friction_lets_it() {
    let (mut world, plate) = table_with(0.14, -0.5, 0.0);
    run(&mut world, 0.5);
    let before = place(&world, plate);
    world.bodies[plate].set_linvel(Vector::new(0.0, 0.2, 0.0), true);
    run(&mut world, 1.0);
    let way = (place(&world, plate).translation.vector - before.translation.vector).norm();
    let formula = 0.2 * 0.2 / (2.0 * FRICTION * GRAVITY);
    assert!((way - formula).abs() < 5e-4, "{way}, formula {formula}");
}

#[test]
fn what_stands_out_over_an_edge_tips_when_its_centre_has_passed_it() {
    for (inside_m, falls) in [(0.005, false), (-0.002, true)] {
        let (mut world, plate) = table_with(0.14, -inside_m, 0.0);
        run(&mut world, 4.0);
        let z = place(&world, plate).translation.z;
        assert_eq!(z < -0.1, falls, "centre {inside_m} inside the edge: z = {z}");
    }
}

/// Fingertips like pins push the disc along +y; `sideways` is where they are in x from the middle of the disc.
fn pushed(radius: f64, sideways: &[f64], way_m: f64) -> (f64, f64) {
    const PIN_M: f64 = 0.004;
    let speed = 0.05;
    let (mut world, plate) = table_with(radius, -0.5, -0.3);
    let pins = sideways.iter().map(|x: &f64| {
        let back = ((radius + PIN_M).powi(2) - x * x).sqrt();
        // A finger that is farther out touches later; all of them start in line.
        let start = Isometry3::translation(-0.5 + x, -0.3 - back, HEIGHT_M / 2.0);
        (start, RigidBodyBuilder::kinematic_position_based())
    });
    let starts: Vec<_> = pins.collect();
    let line = starts.iter().map(|(start, _)| start.translation.y).fold(f64::INFINITY, f64::min);
    let mut handles = Vec::new();
    for (start, body) in starts {
        let mut start = start;
        start.translation.y = line;
        let pin =
            ColliderBuilder::new(SharedShape::capsule_z(0.02, PIN_M)).friction(1.0).collision_groups(robot_group());
        handles.push((start, world.insert(body.pose(start.into()), pin).0));
    }
    run(&mut world, 0.3);
    let touch = place(&world, plate).translation.y;
    let ticks = ((way_m + 0.1) / speed / STEP_S) as u32;
    for tick in 0..ticks {
        for (start, handle) in &handles {
            let mut pose = *start;
            pose.translation.y += f64::from(tick + 1) * STEP_S * speed;
            world.bodies[*handle].set_next_kinematic_position(pose.into());
        }
        world.step();
        if place(&world, plate).translation.y - touch >= way_m {
            break;
        }
    }
    let end = place(&world, plate);
    (end.translation.x + 0.5, end.rotation.euler_angles().2)
}

#[test]
fn a_disc_drifts_off_one_finger_faster_than_one_that_sticks_and_slower_than_one_without_friction() {
    let radius = 0.13;
    let rim = PressureConstant::rim(radius).unwrap();
    let with = |friction| DiscDrift::new(radius, rim, Friction::new(friction).unwrap()).unwrap();
    for offset in [0.005, 0.010] {
        let formula = |drift: DiscDrift| {
            let psi = drift.advance(drift.psi_of_offset(offset).unwrap(), 0.2).unwrap().psi;
            radius * psi.sin()
        };
        let (least, most) = (formula(with(FRICTION)), formula(with(0.0)));
        let (drifted, _) = pushed(radius, &[-offset], 0.2);
        let found = drifted + offset;
        assert!(found > least && found < most, "{offset}: {found}, formulas {least} and {most}");
    }
}

#[test]
fn two_fingers_are_a_funnel() {
    let (radius, gap, error, way) = (0.14, 0.08, 0.01, 0.2);
    let rim = PressureConstant::rim(radius).unwrap();
    let funnel = Funnel::new(radius, gap, rim, Friction::new(FRICTION).unwrap()).unwrap();
    let settled = funnel.push(error, way).unwrap();
    assert!(settled.both_touching);
    // The disc stands `error` to the right of the middle between the fingers.
    let (drifted, turned) = pushed(radius, &[-gap / 2.0 - error, gap / 2.0 - error], way);
    let left = drifted + error;
    assert!(left.abs() < 1e-3, "{left} left");
    assert!((turned.abs() / settled.rotation.abs() - 1.0).abs() < 0.2, "turned {turned}, formula {}", settled.rotation);
}

/// A hand of two sliding fingers at (0, 0, 1), pointing along +x, turned by roll and then down by pitch.
fn hand(roll: f64, pitch: f64) -> Robot {
    let text = include_str!("known_cases/hand.urdf");
    let text = text.replace("ROLL", &roll.to_string()).replace("PITCH", &pitch.to_string());
    let names = |names: &[&str]| names.iter().map(ToString::to_string).collect::<Vec<_>>();
    Robot::new(&RobotFacts {
        description: Arc::new(RobotDescription::from_text(&text).unwrap()),
        meshes: MeshPlaces::default(),
        arm_joints: Vec::new(),
        finger_joint: "opening".to_owned(),
        tool_link: "palm".to_owned(),
        finger_links: names(&["left", "right"]),
        tip_links: ["left".to_owned(), "right".to_owned()],
        is_limited_softly: false,
        start: Vec::new(),
        at_rest: Vec::new(),
        self_pairs: Vec::new(),
        pad_length_m: 0.04,
        grip_force_n: 50.0,
        payload_kg: 2.0,
        push_force_n: 30.0,
        is_bolted: false,
        drives_along_heading: false,
        motion: MotionLimits::default(),
        second: None,
    })
    .unwrap()
}

/// Grips without weight, then lets the weight act; where the object is in the world then, and how far open the hand.
fn gripped(robot: &Robot, shape: &ShapeSpec, is: &TrueObject, open: f64) -> (Isometry3<f64>, f64) {
    let pieces = solids::of_object("object", shape).unwrap();
    let scenery = Scenery::of_object(pieces);
    let mut stage = Stage::new(robot, &scenery, std::slice::from_ref(is), [0.0; 3], &[open]);
    let gravity = std::mem::take(&mut stage.world.gravity);
    for tick in 0..(2.0 / STEP_S) as u32 {
        if tick == (1.0 / STEP_S) as u32 {
            stage.world.gravity = gravity;
        }
        stage.step([0.0; 3], &mut [open], (open - 0.03 * f64::from(tick) * STEP_S).max(0.0));
    }
    (stage.object(0), 2.0 * stage.opening().half_width())
}

/// A plate with its rim 0.03 m between fingers that open upwards and downwards.
fn gripped_plate(tilt_deg: f64) -> f64 {
    let radius = 0.14;
    let robot = hand(std::f64::consts::FRAC_PI_2, tilt_deg.to_radians());
    let shape = ShapeSpec::Cylinder { radius, height: HEIGHT_M };
    let (pose, gap) = gripped(&robot, &shape, &object([radius - 0.035, 0.0, 1.0], 0.4), 0.03);
    assert!((gap - HEIGHT_M).abs() < 1e-3, "the hand is open by {gap}");
    assert!(pose.translation.z > 0.9, "dropped: {pose}");
    (pose.rotation * Vector3::z()).angle(&Vector3::z()).to_degrees()
}

#[test]
fn a_plate_gripped_level_stays_level_and_one_gripped_askew_turns_flush() {
    let level = gripped_plate(0.0);
    assert!(level < 0.5, "level: turned by {level} degrees");
    for tilt in [10.0, 20.0] {
        let turned = gripped_plate(tilt);
        assert!((turned - tilt).abs() < 2.0, "tilt {tilt}: turned by {turned} degrees");
    }
}

#[test]
fn what_friction_does_not_hold_slips_out_of_the_hand() {
    // 0.5 kg weigh 4.9 N; twice 50 N times the friction hold 10 N or 3 N.
    for (friction, holds) in [(0.1, true), (0.03, false)] {
        let robot = hand(0.0, 0.0);
        let shape = ShapeSpec::Box { size: [0.04, 0.04, 0.04] };
        let (pose, _) = gripped(&robot, &shape, &object([-0.02, 0.0, 1.0], friction), 0.03);
        let sunk = 1.0 - pose.translation.z;
        assert_eq!(sunk < 2e-3, holds, "friction {friction}: sunk by {sunk} m");
    }
}

#[test]
fn a_bowl_is_hollow_and_a_plate_has_a_thin_rim() {
    let holds = |pieces: &[Piece], at: Vector3<f64>| {
        let point = Vector::new(at.x, at.y, at.z);
        pieces.iter().any(|piece| piece.shape.contains_point(&piece.body_from_piece, point))
    };
    let bowl = solids::of_object("bowl", &ShapeSpec::Bowl { radius: 0.075, height: 0.065, wall: 0.005 }).unwrap();
    assert!(holds(&bowl, Vector3::new(0.0, 0.0, -0.03)) && !holds(&bowl, Vector3::new(0.0, 0.0, 0.0)));
    assert!(holds(&bowl, Vector3::new(0.0725, 0.0, 0.03)) && !holds(&bowl, Vector3::new(0.06, 0.0, 0.03)));
    let turned = Isometry3::from_parts(Translation3::identity(), UnitQuaternion::identity());
    assert_eq!(solids::mass_properties(&bowl, 0.3).transform_by(&turned.into()).mass(), 0.3);
    // Most of a bowl is below its middle.
    assert!(solids::mass_properties(&bowl, 0.3).local_com.z < -0.005);
}
