//! Robot files: refused, or the robot stands where finite numbers say, and each of its hands is where its links are.
#![no_main]

use darrt_fuzz::text::text;
use darrt_primitives::manipulator::{Configuration, JointVector as _, Manipulator as _};
use darrt_task::file_robot::{FileRobot, shipped};
use libfuzzer_sys::fuzz_target;
use nalgebra::Isometry3;

/// Two arms, a rail to be had, and three joints in one plane.
const ROBOTS: [&str; 3] = ["two-arm", "table-arm", "planar-arm"];

fuzz_target!(|data: &[u8]| {
    let robots = ROBOTS.map(|name| shipped::find(name).expect("a robot inside"));
    let file = text(data, &robots.map(|robot| robot.text));
    // A file names its description, which here is one of those inside.
    let Some(inside) = robots.iter().find(|robot| file.contains(&format!("{}.urdf", robot.name))) else { return };
    let Ok(robot) = FileRobot::from_texts(&file, inside.urdf, "fuzzed.toml") else { return };
    let home = robot.home();
    let within = home.as_ref().iter().zip(robot.limits()).all(|(value, limit)| limit.contains(*value));
    assert!(within && home.as_ref().len() == robot.limits().len());
    assert_eq!(robot.joint_weights_m().len(), robot.limits().len());
    let mut poses = vec![Isometry3::identity(); robot.links().len()];
    for hand in 0..robot.hands() {
        let widest_m = robot.hand_of(hand).max_gap_m();
        assert!(widest_m > 0.0 && widest_m.is_finite() && robot.idle_gap_m() <= widest_m);
        let q = Configuration { base: [0.0; 3], arm: home.with_hand_at_work(hand) };
        robot.link_poses(&q, 0.5 * widest_m, &mut poses);
        let tool = robot.world_from_tool(&q);
        assert!(poses.iter().chain([&tool]).all(is_finite));
        assert_eq!(robot.travel_m(&q, &q, 0.1), 0.0);
    }
    assert!((0..poses.len()).all(|link| robot.hand_of_link(link) < robot.hands()));
    assert!(robot.self_pairs().iter().all(|(a, b)| a != b && *a.max(b) < poses.len()));
});

fn is_finite(pose: &Isometry3<f64>) -> bool {
    pose.translation.vector.iter().chain(pose.rotation.coords.iter()).all(|x| x.is_finite())
}
