//! A robot with two arms, as a file: both arms of the PR2.

#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

use darrt_core::random::{Purpose, Stream, stream};
use darrt_primitives::joints::Joints;
use darrt_primitives::laws::{ManipulatorClaims, ReachClaims, check_manipulator, check_reaches};
use darrt_primitives::manipulator::{Configuration, JointVector as _, LinkGroup, Manipulator};
use darrt_task::file_robot::FileRobot;
use darrt_task::file_robot::inspect::inspect;
use darrt_task::laws::check_task_robot;
use darrt_task::problem_file::ProblemFile;
use darrt_task::problem_file::Robot as RobotSettings;
use darrt_task::robot::TaskRobot as _;
use nalgebra::Isometry3;
use rand::RngExt as _;

const BOTH: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../darrt-pr2/robots/pr2-both-arms.toml");
const RIGHT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../darrt-pr2/robots/pr2.toml");

fn settings(file: &str) -> RobotSettings {
    serde_json::from_value(serde_json::json!({ "file": file, "base": [0.2, -0.1, 0.5] })).unwrap()
}

fn built(file: &str) -> (FileRobot, Joints) {
    FileRobot::build(&settings(file)).unwrap()
}

fn drawn(robot: &FileRobot, hand: usize, rng: &mut Stream) -> Configuration<Joints> {
    let value = |limit: &darrt_primitives::kinematics::JointLimit, rng: &mut Stream| {
        if limit.is_unlimited() { rng.random_range(-3.1..3.1) } else { rng.random_range(limit.lower..=limit.upper) }
    };
    let values: Vec<f64> = robot.limits().iter().map(|limit| value(limit, rng)).collect();
    let base = [rng.random_range(-1.0..1.0), 0.3, rng.random_range(-3.0..3.0)];
    Configuration { base, arm: Joints::from_values(&values).unwrap().with_hand_at_work(hand) }
}

fn poses(robot: &FileRobot, q: &Configuration<Joints>, gap_m: f64) -> Vec<Isometry3<f64>> {
    let mut poses = vec![Isometry3::identity(); robot.links().len()];
    robot.link_poses(q, gap_m, &mut poses);
    poses
}

#[test]
fn the_laws_of_robots_hold_whichever_hand_is_at_work() {
    let (robot, _) = built(BOTH);
    assert_eq!((robot.hands(), robot.limits().len()), (2, 14));
    for hand in 0..2 {
        let mut rng = stream(5, 0, 0, Purpose::Extend);
        for seed in 0..8 {
            let (a, b) = (drawn(&robot, hand, &mut rng), drawn(&robot, hand, &mut rng));
            let gaps = [0.01, robot.hand_of(hand).max_gap_m()];
            check_manipulator(&robot, [&a, &b], gaps, seed, &ManipulatorClaims::default()).unwrap();
        }
        let configurations: Vec<_> = (0..100).map(|_| drawn(&robot, hand, &mut rng)).collect();
        let claims = ReachClaims { inverse: 0.9, base: 0.5, ..ReachClaims::default() };
        check_reaches(&robot, &configurations, 1, &claims).unwrap();
    }
}

#[test]
fn the_laws_of_robots_of_problems_hold() {
    let robot = format!("file = {}", serde_json::Value::from(BOTH));
    let problem = include_str!("data/two-arms/first.toml").replace("model = \"pr2-both-arms\"", &robot);
    let problem = ProblemFile::from_toml(&problem, "both").unwrap();
    check_task_robot::<FileRobot>(&problem, 0).unwrap();
}

#[test]
fn an_arm_alone_leaves_the_other_where_it_is() {
    let (robot, start) = built(BOTH);
    let mut rng = stream(6, 0, 0, Purpose::Extend);
    for hand in 0..2 {
        let (mine, others) = if hand == 0 { (0..7, 7..14) } else { (7..14, 0..7) };
        for _ in 0..20 {
            let now = drawn(&robot, hand, &mut rng);
            let wanted = robot.world_from_tool(&drawn(&robot, hand, &mut rng));
            let base = robot.base_for_hand(hand, &wanted, &mut rng);
            let Some(arm) = robot.inverse_from(&now.arm, &base, &wanted, &mut rng) else { continue };
            assert_eq!(arm.hand_at_work(), hand);
            assert_eq!(arm.as_ref()[others.clone()], now.arm.as_ref()[others.clone()]);
            let reached = robot.world_from_tool(&Configuration { base, arm });
            assert!((reached.translation.vector - wanted.translation.vector).norm() < 1e-9);
            let folded = robot.with_others_at(&arm, &start);
            assert_eq!(folded.hand_at_work(), hand);
            assert_eq!(folded.as_ref()[mine.clone()], arm.as_ref()[mine.clone()]);
            assert_eq!(folded.as_ref()[others.clone()], start.as_ref()[others.clone()]);
            let near = robot.inverse_near(&base, &wanted, &arm).unwrap();
            assert_eq!(near.as_ref()[others.clone()], arm.as_ref()[others.clone()]);
        }
    }
    // Without a word of where the arms are it is the first hand, the other arm at home.
    let tool = robot.world_from_tool(&Configuration { base: [0.0; 3], arm: robot.posture("untucked").unwrap() });
    let found = robot.inverse(&[0.0; 3], &tool, &mut rng).unwrap();
    assert_eq!((found.hand_at_work(), &found.as_ref()[7..]), (0, &start.as_ref()[7..]));
}

#[test]
fn nothing_moves_when_another_hand_goes_to_work() {
    let (robot, _) = built(BOTH);
    let mut rng = stream(7, 0, 0, Purpose::Extend);
    let q = drawn(&robot, 0, &mut rng);
    let other = Configuration { arm: q.arm.with_hand_at_work(1), ..q };
    let idle_m = robot.idle_gap_m();
    assert_eq!(poses(&robot, &q, idle_m), poses(&robot, &other, idle_m));
    assert_eq!(robot.joint_values(&q, idle_m), robot.joint_values(&other, idle_m));
    // The gap is that of the hand at work, and each hand has as many links.
    let (closed, closed_other) = (poses(&robot, &q, 0.0), poses(&robot, &other, 0.0));
    let open = poses(&robot, &q, idle_m);
    let of = |hand: usize, group: LinkGroup| {
        let links = robot.links().iter().enumerate().filter(move |(_, link)| link.group == group);
        links.map(|(number, _)| number).filter(|link| robot.hand_of_link(*link) == hand).collect::<Vec<_>>()
    };
    for (closed, hand) in [(closed, 0), (closed_other, 1)] {
        for link in 0..robot.links().len() {
            let moves = closed[link] != open[link];
            assert_eq!(moves, of(hand, LinkGroup::Finger).contains(&link), "{}", robot.links()[link].body.name);
        }
    }
    for group in [LinkGroup::Hand, LinkGroup::Finger] {
        assert_eq!(of(0, group).len(), of(1, group).len());
        assert!(!of(0, group).is_empty());
    }
}

#[test]
fn the_first_arm_is_that_of_the_robot_with_it_alone() {
    let [(both, start), (right, alone)] = [built(BOTH), built(RIGHT)];
    assert_eq!(&start.as_ref()[..7], alone.as_ref());
    let q = Configuration { base: [0.3, 0.1, -0.4], arm: start };
    let of_right = Configuration { base: q.base, arm: alone };
    assert_eq!(both.world_from_tool(&q), right.world_from_tool(&of_right));
    let [there, here] = [poses(&both, &q, 0.05), poses(&right, &of_right, 0.05)];
    // The left hand has pads, and is open, where it is not at rest.
    let links = right.links().iter().zip(&here).filter(|(link, _)| !link.body.name.starts_with("l_gripper"));
    for (link, pose) in links {
        let at = both.links().iter().position(|other| other.body.name == link.body.name).unwrap();
        assert!((there[at].translation.vector - pose.translation.vector).norm() < 1e-12, "{}", link.body.name);
    }
}

/// The text of the robot file, with its description wherever it is read.
fn text() -> String {
    let urdf = concat!(env!("CARGO_MANIFEST_DIR"), "/../../darrt-pr2/src/pr2.urdf");
    std::fs::read_to_string(BOTH).unwrap().replace("../src/pr2.urdf", urdf)
}

/// The robot of such a text, or what is wrong with it.
fn of_text(text: &str) -> Result<FileRobot, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("robot.toml");
    std::fs::write(&path, text).unwrap();
    let built = FileRobot::build(&settings(path.to_str().unwrap()));
    built.map(|(robot, _)| robot).map_err(|error| error.to_string())
}

/// Both arms with the lift, which is the first joint of each.
fn on_the_lift() -> String {
    let text = text().replace("from = \"torso_lift_link\"", "from = \"base_link\"");
    // The first line of each posture is that of the right arm, which turns to the right.
    let text = text.replace("speeds = [1.0,", "speeds = [0.02, 1.0,").replace("\n  -", "\n  0.2, -");
    let text = text.replace("[rest]                          # the lift\ntorso_lift_joint = 0.2\n", "");
    text.replace("ignore = [", "ignore = [\n  [\"base_bellow_link\", \"torso_lift_link\"],")
}

#[test]
fn arms_may_share_their_first_joints() {
    let rail = "kind = \"rail\"\nrail_axis = [0, 1, 0]\nrail_m = [-0.5, 0.5]\nxyz = [0, 0, 0.05]";
    let on_rail = on_the_lift().replace("kind = \"planar\"", rail).replace("speeds = [0.02,", "speeds = [0.5, 0.02,");
    let on_rail = on_rail.replace("\n  0.2, -", "\n  0.1, 0.2, -");
    for (text, joints) in [(on_the_lift(), 15), (on_rail, 16)] {
        let robot = of_text(&text).unwrap();
        assert_eq!(robot.limits().len(), joints);
        for hand in 0..2 {
            let mut rng = stream(8, 0, 0, Purpose::Extend);
            for seed in 0..4 {
                let (mut a, mut b) = (drawn(&robot, hand, &mut rng), drawn(&robot, hand, &mut rng));
                if !robot.drives() {
                    (a.base, b.base) = ([0.2, -0.1, 0.5], [0.2, -0.1, 0.5]);
                }
                let gaps = [0.01, robot.hand_of(hand).max_gap_m()];
                check_manipulator(&robot, [&a, &b], gaps, seed, &ManipulatorClaims::default()).unwrap();
            }
        }
    }
}

#[test]
fn what_is_wrong_with_the_second_arm_has_its_key_and_line() {
    let text = text();
    let second = |from: &str, to: &str| {
        let (before, after) = text.split_at(text.find("[second.arm]").unwrap());
        assert!(after.contains(from));
        of_text(&format!("{before}{}", after.replacen(from, to, 1))).unwrap_err()
    };
    let line = |part: &str| {
        let from = text.lines().position(|line| line == "[second.arm]").unwrap();
        text.lines().skip(from).position(|line| line.starts_with(part)).unwrap() + from + 1
    };
    for (from, to, key, at, why) in [
        ("l_wrist_roll_link", "l_wrst_roll_link", "second.arm.to", "to =", "did you mean `l_wrist_roll_link`?"),
        ("payload_kg = 1.8", "payload_kg = -1", "second.arm.payload_kg", "payload_kg", "is -1, must be above 0"),
        ("1.5, 1.12]", "1.12]", "second.arm.speeds", "speeds", "has 6 entries, must have 7"),
        ("l_gripper_tool_frame", "r_gripper_tool_frame", "second.tool.link", "link", "not rigid to the last link"),
        ("\"l_gripper_r_finger_tip_link\"", "\"head_pan_link\"", "second.gripper.tips", "tips", "arm does not carry"),
        (
            "from = \"torso_lift_link\"",
            "from = \"base_link\"",
            "arm.from",
            "",
            "let both arms begin above it, or both below",
        ),
        ("from = \"torso_lift_link\"", "from = \"l_upper_arm_link\"", "second.arm.to", "to =", "has at least 6"),
        ("joint = \"l_", "joint = \"r_", "second.gripper.joint", "joint", "the joint of the hand of the first arm"),
    ] {
        let error = second(from, to);
        assert!(error.contains(&format!("`{key}`")) && error.contains(why), "{error}");
        assert!(at.is_empty() || error.contains(&format!("robot.toml:{}:", line(at))), "{error}");
    }
    // The first arm once more.
    let same = second("l_wrist_roll_link", "r_wrist_roll_link");
    assert!(same.contains("`second.arm.to` names `r_wrist_roll_link`, in which the first arm ends"), "{same}");
    let through =
        text.replace("l_wrist_roll_link", "r_gripper_palm_link").replace("\"l_gripper_tool", "\"r_gripper_tool");
    let error = of_text(&through).unwrap_err();
    assert!(error.contains("which moves the hand of the first arm"), "{error}");
    let shorter = text.replacen("1.398,\n  2.135,", "1.398,\n ", 1);
    let error = of_text(&shorter).unwrap_err();
    assert!(error.contains("has 13 entries, must have 14, one for each joint of both arms"), "{error}");
    let rail = "kind = \"rail\"\nrail_axis = [0, 1, 0]\nrail_m = [-0.5, 0.5]";
    let error = of_text(&text.replace("kind = \"planar\"", rail)).unwrap_err();
    assert!(error.contains("between it and the rail is a joint that rests"), "{error}");
    let few = text.replace("[second.gripper]", "[second.griper]");
    assert!(of_text(&few).unwrap_err().contains("did you mean `gripper`?"));
}

#[test]
fn a_check_tells_of_both_hands() {
    let found = inspect(BOTH).unwrap();
    let of = |what: &str| found.understood.iter().filter(|line| line.starts_with(what)).count();
    assert_eq!((of("joint:"), of("hand:"), of("reach:")), (14, 2, 2), "{:#?}", found.understood);
    // Joined shapes are told of, as of the robot with one arm.
    let is_joined = |line: &String| line.contains("broken law manipulator.pairs");
    assert!(found.odd.iter().all(is_joined), "{:#?}", found.odd);
}

#[test]
fn the_facts_tell_of_both_hands() {
    let (robot, _) = built(BOTH);
    let facts = FileRobot::facts(&settings(BOTH)).unwrap();
    let second = facts.second.as_ref().unwrap();
    assert_eq!((facts.hands(), facts.all_arm_joints().len()), (2, 14));
    assert_eq!(facts.all_arm_joints()[7..], second.arm_joints);
    assert_eq!(facts.of_hand(1).tool_link, "l_gripper_tool_frame");
    assert_eq!(facts.of_hand(1).arm_joints, second.arm_joints);
    assert!(facts.of_hand(1).finger_links.iter().all(|link| link.starts_with("l_gripper")));
    assert!(facts.finger_links.iter().all(|link| link.starts_with("r_gripper")));
    assert_eq!(facts.at_rest.len(), 2);
    assert!(facts.start.iter().all(|(joint, _)| !facts.finger_joints().any(|finger| finger == joint)));
    let is_across =
        |pair: &[String; 2]| pair.iter().all(|link| link.contains("gripper")) && pair[0][..2] != pair[1][..2];
    assert!(facts.self_pairs.iter().any(is_across), "the hands may touch each other");
    assert!(robot.self_pairs().iter().all(|(a, b)| {
        let is_hand = |link: usize| matches!(robot.links()[link].group, LinkGroup::Hand | LinkGroup::Finger);
        !(is_hand(*a) && is_hand(*b)) || robot.hand_of_link(*a) != robot.hand_of_link(*b)
    }));
}
