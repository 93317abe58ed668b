//! What is wrong with a problem is said with name, value and bound.

use darrt_core::error::Error;
use darrt_core::extend::ExtendOptions;
use darrt_core::goal::Reach;
use darrt_core::partial::PartialState;
use darrt_core::problem::{Parts, Problem};
use darrt_core::sample::{Full, GoalBiased, RobotOrObjects};
use darrt_core::space::{RealBox, Se2, Se3, So2};
use darrt_core::testing::puck::{PuckWorld, Push, Setup};

use super::support::{World, small};

fn refused(change: impl FnOnce(&mut Parts<World>)) -> String {
    let mut parts = small().puck_goal(0, [2.0, 1.0]).parts().unwrap();
    change(&mut parts);
    Problem::new(parts).unwrap_err().to_string()
}

fn setup_refused(setup: Setup) -> String {
    setup.problem().unwrap_err().to_string()
}

#[test]
fn a_wrong_number_of_objects() {
    assert_eq!(refused(|p| p.start.objects.clear()), "the start has 0 objects, but the domain has 1");
    let crowd = (0..64).fold(small(), |setup, i| setup.puck(&format!("puck {i}"), 0.01, [1.0, 1.5]));
    assert_eq!(setup_refused(crowd), "the domain has 65 objects, but at most 63 are supported");
    assert_eq!(setup_refused(small().puck_goal(4, [1.0, 1.0])), "the goal has 5 objects, but the domain has 1");
    let bare = Setup::new([3.0, 2.0], 0.15).parts().unwrap();
    let foreign = Reach::new(PartialState::anywhere(&bare.domain));
    assert_eq!(refused(|p| p.goal = Box::new(foreign)), "the target has 0 objects, but the domain has 1");
}

#[test]
fn a_start_outside_of_its_space_or_in_a_collision() {
    assert_eq!(refused(|p| p.start.robot = [0.1, 1.0]), "the start of robot lies outside its space: [0.1, 1.0]");
    assert_eq!(refused(|p| p.start.robot = [f64::NAN, 1.0]), "the start of robot lies outside its space: [NaN, 1.0]");
    assert_eq!(
        refused(|p| p.start.objects[0] = [1.0, f64::INFINITY]),
        "the start of red lies outside its space: [1.0, inf]"
    );
    assert_eq!(
        refused(|p| p.start.robot = [0.9, 1.0]),
        "the start is not valid: robot against object: robot and red at (0.900, 1.000, 0.000)"
    );
    assert_eq!(
        setup_refused(small().wall("wall", [1.05, 0.0], [1.2, 2.0])),
        "the start is not valid: object against obstacle: red and wall at (1.000, 1.000, 0.000)"
    );
}

#[test]
fn no_primitives_or_two_of_one_name() {
    assert_eq!(refused(|p| p.primitives.clear()), "the problem has no primitives, but needs at least one");
    assert_eq!(
        refused(|p| p.primitives.push(Box::new(Push))),
        "the primitive name \"Push\" is used twice, but must be unique"
    );
}

#[test]
fn a_goal_outside_of_a_space() {
    let outside = "the goal asks red to be at [2.95, 1.0], outside its space";
    assert_eq!(setup_refused(small().puck_goal(0, [2.95, 1.0])), outside);
    let nan = "the goal asks robot to be at [NaN, 1.0], outside its space";
    assert_eq!(setup_refused(small().robot_goal([f64::NAN, 1.0])), nan);
}

#[test]
fn a_malformed_world() {
    let radius = setup_refused(Setup::new([3.0, 2.0], 1.5));
    assert_eq!(radius, "radius of the robot is 1.5, but must be positive and at most half a side of the floor");
    let radius = setup_refused(small().puck("blue", f64::NAN, [2.0, 1.0]));
    assert_eq!(radius, "radius of puck blue is NaN, but must be positive and at most half a side of the floor");
    let side = setup_refused(Setup::new([f64::INFINITY, 2.0], 0.1));
    assert_eq!(side, "side of the floor is inf, but must be finite and positive");
    let wall = setup_refused(small().wall("wall", [2.0, 0.0], [1.9, 1.0]));
    assert_eq!(wall, "lower corner of wall is 2, but must be finite and at most the upper corner");
    let pillar = setup_refused(small().pillar("pillar", [2.0, 0.0], 0.0));
    assert_eq!(pillar, "radius of pillar is 0, but must be finite and positive");
}

#[test]
fn options_out_of_range() {
    let message = |e: Error| e.to_string();
    assert_eq!(GoalBiased::new(Full, 1.5).map_err(message).unwrap_err(), "goal_bias is 1.5, but must be in [0, 1]");
    assert_eq!(
        RobotOrObjects::new(0.5, f64::NAN).map_err(message).unwrap_err(),
        "group_share is NaN, but must be in [0, 1]"
    );
    assert!(RobotOrObjects::new(-0.1, 0.0).is_err());
    let bad = ExtendOptions { spacing_m: 0.0, ..ExtendOptions::default() };
    assert_eq!(bad.check().map_err(message).unwrap_err(), "spacing_m is 0, but must be finite and positive");
    assert!(ExtendOptions::default().check().is_ok());
}

#[test]
fn malformed_spaces() {
    assert!(RealBox::new([0.0, f64::NAN], [1.0, 1.0]).is_err());
    assert!(RealBox::new([0.0, 2.0], [1.0, 1.0]).is_err());
    assert!(RealBox::new([0.0], [f64::INFINITY]).is_err());
    assert!(RealBox::weighted([0.0], [1.0], [0.0]).is_err());
    let too_wide = RealBox::new([-f64::MAX], [f64::MAX]).unwrap_err().to_string();
    assert_eq!(too_wide, "diagonal of the box is inf, but must be finite");
    assert!(So2::new(0.0).is_err() && So2::new(f64::NAN).is_err());
    assert!(Se2::new([0.0; 2], [1.0; 2], -1.0).is_err());
    assert!(Se3::new([0.0; 3], [1.0; 3], f64::INFINITY).is_err());
    let world: Result<PuckWorld, Error> = PuckWorld::new([0.0, 1.0], 0.1, Vec::new());
    assert!(world.is_err());
}
