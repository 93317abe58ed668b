//! The PR2 as a robot.

use darrt_core::testing::strategies::{config, configs, seeds};
use darrt_pr2::arm::{ArmConfiguration, LimitKind, Side};
use darrt_pr2::model::{Pr2Model, WholeBody};
use darrt_pr2::robot::Pr2;
use darrt_primitives::kinematics::{KinematicChain, KinematicTree};
use darrt_primitives::laws::{ManipulatorClaims, ReachClaims, check_chain, check_manipulator, check_reaches};
use darrt_primitives::manipulator::Manipulator;
use darrt_primitives::mobile_arm_space::MobileArmSpace;
use nalgebra::{Isometry3, Point3, Vector3};
use proptest::prelude::*;

const REGRESSIONS: Option<&str> = Some("tests/regressions/laws_robot.txt");

fn robot(side: Side, limits: LimitKind) -> Pr2 {
    let rest = WholeBody { torso_m: 0.2, ..WholeBody::at_rest() };
    Pr2::new(Pr2Model::embedded().unwrap(), side, limits, rest).unwrap()
}

fn space(robot: &Pr2) -> MobileArmSpace<ArmConfiguration> {
    MobileArmSpace::new([-3.0; 2], [3.0; 2], robot.limits(), robot.joint_weights_m()).unwrap()
}

fn check(side: Side, limits: LimitKind) {
    let robot = robot(side, limits);
    let space = space(&robot);
    let claims = ManipulatorClaims::default();
    proptest!(config(24, REGRESSIONS), |(a in configs(&space), b in configs(&space), seed in seeds(), gap in 0.0..0.09)| {
        check_manipulator(&robot, [&a, &b], [gap, 0.09 - gap], seed, &claims)?;
    });
}

#[test]
fn the_right_arm_keeps_the_laws_of_a_robot() {
    check(Side::Right, LimitKind::Soft);
}

#[test]
fn the_left_arm_keeps_the_laws_of_a_robot() {
    check(Side::Left, LimitKind::Soft);
}

/// With the mechanical limits the elbow and the wrist can be stretched, where the closed form is singular.
#[test]
fn the_right_arm_keeps_the_laws_up_to_its_hard_limits() {
    check(Side::Right, LimitKind::Hard);
}

#[test]
fn both_arms_find_what_they_reach() {
    for side in Side::BOTH {
        let robot = robot(side, LimitKind::Soft);
        let space = space(&robot);
        let modelled = robot.clone().with_bases_from_reachability();
        let many = proptest::collection::vec(configs(&space), 64);
        proptest!(config(4, REGRESSIONS), |(many in many, seed in seeds())| {
            check_reaches(&robot, &many, seed, &ReachClaims::default())?;
            check_reaches(&modelled, &many, seed, &ReachClaims::default())?;
        });
    }
}

#[test]
fn the_jacobians_of_both_arms_equal_finite_differences() {
    let model = Pr2Model::embedded().unwrap();
    let tree: &KinematicTree = model.tree();
    for prefix in ["r", "l"] {
        let chain = KinematicChain::new(tree, "base_link", &format!("{prefix}_gripper_tool_frame")).unwrap();
        let values = proptest::collection::vec(-1.0..1.0_f64, tree.variables().len());
        proptest!(config(24, REGRESSIONS), |(q in values, yaw in -3.0..3.0, x in -0.2..0.2)| {
            let root = Isometry3::new(Vector3::new(1.0, x, 0.0), Vector3::z() * yaw);
            check_chain(tree, &chain, &q, &root, &Point3::new(x, 0.1, -0.2))?;
        });
    }
}
