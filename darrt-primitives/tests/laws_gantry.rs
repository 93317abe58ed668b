//! The gantry keeps every law of a robot, and so do its spaces and what it does at the tables.
#![cfg(feature = "testing")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test says no more than that it failed")]

use std::cell::Cell;

use darrt_core::domain::Domain;
use darrt_core::laws::MotionClaims;
use darrt_core::laws::{SpaceClaims, check_component_space, check_domain, check_motion};
use darrt_core::primitive::Infeasible;
use darrt_core::primitive::Instances;
use darrt_core::random::{Purpose, stream};
use darrt_core::space::ComponentSpace;
use darrt_core::state::ObjectId;
use darrt_core::testing::strategies::{config, configs, looks, parameters, seeds, seen};
use darrt_primitives::action::{Chain, pick::pick, place::place, push::push, retreat::retreat, transfer::transfer};
use darrt_primitives::kinematics::{KinematicChain, KinematicTree, RobotDescription};
use darrt_primitives::laws::{
    ManipulatorClaims, ReachClaims, TabletopClaims, body_travel, check_chain, check_grasps, check_manipulator,
    check_reaches, check_tabletop,
};
use darrt_primitives::manipulator::Manipulator;
use darrt_primitives::mobile_arm_space::MobileArmSpace;
use darrt_primitives::testing::gantry::{Gantry, Joints};
use darrt_primitives::testing::strategies::{any_mode, engaged, holding, resting};
use darrt_primitives::testing::table::{Table, TableState, honest_table};
use nalgebra::{Isometry3, Point3, Vector3};
use proptest::prelude::*;

const REGRESSIONS: Option<&str> = Some("tests/regressions/laws_gantry.txt");

fn space(robot: &Gantry) -> MobileArmSpace<Joints> {
    MobileArmSpace::new([-2.0; 2], [2.0; 2], robot.limits(), robot.joint_weights_m()).unwrap()
}

#[test]
fn the_gantry_keeps_the_laws_of_a_robot() {
    let robot = Gantry::new().unwrap();
    let space = space(&robot);
    let claims = ManipulatorClaims { joint_step: 0.5, ..ManipulatorClaims::default() };
    proptest!(config(64, REGRESSIONS), |(a in configs(&space), b in configs(&space), seed in seeds(), gap in 0.0..0.1)| {
        check_manipulator(&robot, [&a, &b], [gap, 0.1 - gap], seed, &claims)?;
        check_manipulator(&robot, [&a, &a], [gap, gap], seed, &claims)?;
    });
}

#[test]
fn the_gantry_finds_what_it_reaches() {
    let robot = Gantry::new().unwrap();
    let space = space(&robot);
    let many = proptest::collection::vec(configs(&space), 32);
    proptest!(config(8, REGRESSIONS), |(many in many, seed in seeds())| {
        check_reaches(&robot, &many, seed, &ReachClaims::default())?;
    });
}

#[test]
fn a_jacobian_of_a_robot_without_closed_form_equals_finite_differences() {
    let text = include_str!("data/generic_arm.urdf");
    let tree = KinematicTree::new(&RobotDescription::from_text(text).unwrap()).unwrap();
    let chain = KinematicChain::new(&tree, "mount", "probe").unwrap();
    let values = proptest::collection::vec(-1.5..1.5_f64, tree.variables().len());
    proptest!(config(64, REGRESSIONS), |(q in values, turn in -3.0..3.0, x in -0.2..0.2)| {
        let root = Isometry3::new(Vector3::new(1.0, x, 0.5), Vector3::new(0.3, turn, 0.1));
        check_chain(&tree, &chain, &q, &root, &Point3::new(x, 0.1, -0.2))?;
    });
}

#[test]
fn the_spaces_and_the_domain_keep_their_laws() {
    let m = honest_table().unwrap();
    let s = any_mode(&m);
    proptest!(config(24, REGRESSIONS), |(a in s.clone(), b in s.clone(), c in s, t in parameters(), u in parameters(), seed in seeds())| {
        let claims = SpaceClaims::default();
        check_component_space(m.robot(), &claims, [&a.robot, &b.robot, &c.robot], [t, u], seed)?;
        check_domain(&m, &claims, [&a, &b, &c], [t, u], seed)?;
    });
}

#[test]
fn the_grasps_at_the_table_keep_their_laws() {
    let m = honest_table().unwrap();
    for movable in m.movables() {
        for (family, seed) in movable.grasps.iter().zip(0..) {
            check_grasps(&**family, &movable.body, m.manipulator().hand(), seed).unwrap();
        }
    }
}

type Outcome = Result<Instances<Table>, Infeasible>;

/// What `act` does from `from` keeps the laws of table-top instances; it must succeed now and then.
fn check_action(
    m: &Table,
    starts: impl Strategy<Value = TableState> + Clone,
    act: impl Fn(&TableState, u64) -> Outcome,
) {
    let succeeded = seen(5, || {
        let count = Cell::new(0);
        proptest!(config(48, REGRESSIONS), |(from in starts.clone(), seed in 0..1000_u64, ts in looks())| {
            if let Ok(instances) = act(&from, seed) {
                count.set(count.get() + 1);
                check_tabletop(m, &instances, &from, &ts, &TabletopClaims::default())?;
                let motion = MotionClaims { travel: &body_travel, ..MotionClaims::default() };
                for instance in instances.iter().take(1) {
                    check_motion(m, &*instance.motion, &from, &ts, &motion)?;
                }
            }
        });
        count.get()
    });
    assert!(succeeded >= 5, "succeeded {succeeded} times only");
}

#[test]
fn pushes_keep_their_laws() {
    let m = honest_table().unwrap();
    check_action(&m, resting(&m), |from, seed| {
        let mut rng = stream(seed, 0, 0, Purpose::Extend);
        let target = Isometry3::translation(0.0, (seed as f64 / 1000.0) - 0.5, 0.74);
        push(&m, from, ObjectId::new((seed % 2) as usize), &target, &mut rng)
    });
}

#[test]
fn picks_keep_their_laws() {
    let m = honest_table().unwrap();
    let act = |from: &TableState, seed: u64| {
        pick(&m, from, ObjectId::new((seed % 3) as usize), &mut stream(seed, 0, 0, Purpose::Extend))
    };
    check_action(&m, resting(&m), act);
    check_action(&m, engaged(&m), act);
}

#[test]
fn what_is_held_is_carried_and_placed_by_the_laws() {
    let m = honest_table().unwrap();
    check_action(&m, holding(&m), |from, seed| {
        let target = Isometry3::translation(0.4, 0.2, 1.1);
        transfer(&m, from, &target, None, &mut stream(seed, 0, 0, Purpose::Extend))
    });
    check_action(&m, holding(&m), |from, seed| {
        let target = Isometry3::translation(0.4, 0.2, 0.74);
        place(&m, from, &target, &mut stream(seed, 0, 0, Purpose::Extend))
    });
}

#[test]
fn retreats_keep_their_laws() {
    let m = honest_table().unwrap();
    check_action(&m, engaged(&m), |from, _| {
        let mut chain = Chain::at(from);
        retreat(&m, &mut chain, m.settings().retreat_m)?;
        chain.finish()
    });
}

/// Found by the laws: the turns of a round object about its own axis do not count, but the shortest rotation between two
/// poses leads that axis around a detour, so that the way was longer than the distance.
#[test]
fn the_axis_of_a_round_object_takes_the_shortest_way() {
    let m = honest_table().unwrap();
    let tin = &m.objects()[0];
    let leaning = |axis: Vector3<f64>| Isometry3::new(Vector3::new(0.0, 0.0, 0.8), axis);
    let (a, b) = (leaning(Vector3::zeros()), leaning(Vector3::new(0.8, 0.2, 2.5)));
    let half = tin.interpolate(&a, &b, 0.5);
    let (whole, first, second) = (tin.distance(&a, &b), tin.distance(&a, &half), tin.distance(&half, &b));
    assert!((first - 0.5 * whole).abs() < 1e-9 && (second - 0.5 * whole).abs() < 1e-9, "{first} {second} {whole}");
}
