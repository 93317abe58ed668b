//! The robots inside keep the laws of robots, and stand where the general tree of their completed description says.

#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

use darrt_core::random::{Purpose, Stream, stream};
use darrt_primitives::joints::Joints;
use darrt_primitives::kinematics::KinematicTree;
use darrt_primitives::laws::{ManipulatorClaims, ReachClaims, check_manipulator, check_reaches};
use darrt_primitives::manipulator::{Configuration, JointVector as _, Manipulator as _};
use darrt_task::file_robot::{FileRobot, shipped};
use darrt_task::problem_file::Robot as RobotSettings;
use darrt_task::robot::TaskRobot as _;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use rand::RngExt as _;

fn settings(name: &str) -> RobotSettings {
    serde_json::from_value(serde_json::json!({ "model": name, "base": [0.2, -0.1, 0.5] })).unwrap()
}

fn drawn(robot: &FileRobot, rng: &mut Stream) -> Configuration<Joints> {
    let values: Vec<f64> = robot.limits().iter().map(|limit| rng.random_range(limit.lower..=limit.upper)).collect();
    let base =
        if robot.drives() { [rng.random_range(-1.0..1.0), 0.3, rng.random_range(-3.0..3.0)] } else { [0.2, -0.1, 0.5] };
    Configuration { base, arm: Joints::from_values(&values).unwrap() }
}

#[test]
fn the_laws_of_robots_hold() {
    for shipped in shipped::all() {
        let (robot, _) = FileRobot::build(&settings(shipped.name)).unwrap();
        let mut rng = stream(5, 0, 0, Purpose::Extend);
        for seed in 0..20 {
            let (a, b) = (drawn(&robot, &mut rng), drawn(&robot, &mut rng));
            let gaps = [0.01, robot.hand().max_gap_m()];
            let checked = check_manipulator(&robot, [&a, &b], gaps, seed, &ManipulatorClaims::default());
            assert!(checked.is_ok(), "{}: {}", shipped.name, checked.unwrap_err());
        }
        let configurations: Vec<_> = (0..200).map(|_| drawn(&robot, &mut rng)).collect();
        let claims = ReachClaims { inverse: 0.98, base: 0.5, ..ReachClaims::default() };
        check_reaches(&robot, &configurations, 1, &claims).unwrap();
    }
}

#[test]
fn links_stand_where_the_tree_of_the_facts_says() {
    for shipped in shipped::all() {
        let settings = settings(shipped.name);
        let (robot, start) = FileRobot::build(&settings).unwrap();
        let facts = FileRobot::facts(&settings).unwrap();
        let tree = KinematicTree::new(&facts.description).unwrap();
        let mut rng = stream(6, 0, 0, Purpose::Extend);
        let mut poses = vec![Isometry3::identity(); tree.link_count()];
        let mut links = vec![Isometry3::identity(); robot.links().len()];
        for _ in 0..50 {
            let q = drawn(&robot, &mut rng);
            let gap_m = rng.random_range(0.0..robot.hand().max_gap_m());
            let [x, y, yaw] = q.base;
            let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw);
            let world_from_root = Isometry3::from_parts(Translation3::new(x, y, 0.0), turn);
            tree.forward(&robot.joint_values(&q, gap_m), &world_from_root, &mut poses).unwrap();
            robot.link_poses(&q, gap_m, &mut links);
            for (link, pose) in robot.links().iter().zip(&links) {
                let expected = poses[tree.link_index(&link.body.name).unwrap()];
                assert!((pose.translation.vector - expected.translation.vector).norm() < 1e-12);
                assert!(pose.rotation.angle_to(&expected.rotation) < 1e-9);
            }
            let tool = poses[tree.link_index(&facts.tool_link).unwrap()];
            assert!((robot.world_from_tool(&q).translation.vector - tool.translation.vector).norm() < 1e-12);
        }
        let arm: Vec<_> = facts.arm_joints.iter().zip(start.as_ref()).collect();
        assert!(arm.iter().all(|(name, value)| facts.start.iter().any(|(n, v)| n == *name && v == *value)));
        assert_eq!(facts.is_bolted, !robot.drives());
    }
}
