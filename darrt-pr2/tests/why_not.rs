//! Ideas of a person, each with what is wrong with it first: the tests look at the cause, not at the words.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test says what is wrong by panicking")]

use std::f64::consts::{FRAC_PI_4, PI};

use darrt_pr2::robot::Pr2;
use darrt_task::diagnosis::cause::Stage;
use darrt_task::diagnosis::why_not::{Fault, Idea, Variant, WhyNot, WhyNotError, WhyNotRequest, Wrong, why_not};
use darrt_task::problem_file::ProblemFile;
use darrt_task::registry::Registry;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

/// A mug on a table in front of the robot, with more of it.
fn problem(more: &str) -> ProblemFile {
    let text = format!(
        r#"
format = "darrt-problem"
version = 1
name = "idea"
primitives = ["Arm-Transit","Straight-Line-Arm-Transit","Arm-Rigid-Transfer","Base-Transit","Base-Rigid-Transfer","Pick","Place","Push"]
[robot]
base = [-1.0, 0.0, 0.0]
[[obstacle]]
name = "table"
shape = {{ box = {{ size = [0.8, 1.2, 0.74] }} }}
at = [0.0, 0.0, 0.37]
[[surface]]
name = "table"
top_of = "table"
[[object]]
name = "mug"
shape = {{ cylinder = {{ radius = 0.035, height = 0.10 }} }}
on = "table"
at = [-0.2, 0.2]
grasps = ["side"]
{more}
[[goal.object]]
object = "mug"
on = "table"
at = [-0.2, -0.3]
"#
    );
    ProblemFile::from_toml(&text, "idea").unwrap()
}

fn cage() -> String {
    let post = |i: u32| {
        let (s, c) = (f64::from(i) * FRAC_PI_4).sin_cos();
        let at = [-0.2 + 0.065 * c, 0.2 + 0.065 * s, 0.89];
        let shape = "{ cylinder = { radius = 0.01, height = 0.3 } }";
        format!("[[obstacle]]\nname = \"post {i}\"\nshape = {shape}\nat = {at:?}\n")
    };
    (0..8).map(post).collect()
}

fn asked(more: &str, idea: Idea) -> WhyNot {
    why_not(&Registry::<Pr2>::new(), &WhyNotRequest { problem: problem(more), idea }).unwrap()
}

fn hand([x, y, z, roll, pitch, yaw]: [f64; 6], takes: Option<&str>) -> Idea {
    let rotation = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
    Idea::Hand {
        world_from_tool: Isometry3::from_parts(Translation3::new(x, y, z), rotation),
        takes: takes.map(str::to_owned),
    }
}

/// What is wrong, and a variant in which nothing is: that is asked about again.
fn wrong(more: &str, idea: Idea, takes: Option<&str>) -> (Fault, Variant) {
    let answer = asked(more, idea.clone());
    assert_eq!(answer, asked(more, idea), "the same question has the same answer");
    let (fault, variant) = (answer.fault.unwrap(), answer.variant.unwrap());
    let state = Idea::State { base: Some(variant.base), joints: Some(variant.joints.clone()) };
    // With the fingers about an object the state alone is none that the robot may be in.
    let again = if takes.is_some() { hand(variant.tool, takes) } else { state };
    assert_eq!(asked(more, again).fault, None, "{variant:?}");
    (fault, variant)
}

#[test]
fn a_base_in_the_table() {
    let idea = Idea::State { base: Some([-0.6, 0.0, 0.0]), joints: None };
    let (fault, variant) = wrong("", idea, None);
    assert_eq!(fault.wrong, Wrong::Base);
    assert!(fault.names.contains(&"table".to_owned()), "{fault:?}");
    let by = fault.by.unwrap();
    assert!((0.01..0.3).contains(&by), "{by}");
    assert!(variant.away_m > 0.5 * by && variant.away_m < by + 0.3, "{variant:?}");
}

#[test]
fn a_joint_beyond_its_limit_and_a_base_beyond_its_bounds() {
    let start = asked("", Idea::State { base: None, joints: None });
    let mut joints = start.variant.filter(|_| start.fault.is_none()).unwrap().joints;
    joints[1] = 2.0;
    let (fault, variant) = wrong("", Idea::State { base: None, joints: Some(joints.clone()) }, None);
    assert_eq!((fault.wrong, fault.names[0].as_str()), (Wrong::Limit, "r_shoulder_lift_joint"));
    let by = fault.by.unwrap();
    assert!((0.5..1.2).contains(&by), "the limit is about 1.3: {by}");
    assert!(variant.joint_most >= by - 1e-9 && variant.joint_most < by + 0.5, "{variant:?}");

    let bounds = problem("").bounds.base_x;
    let answer = asked("", Idea::State { base: Some([bounds[1] + 0.75, 0.0, 0.0]), joints: None });
    let fault = answer.fault.unwrap();
    assert_eq!(fault.wrong, Wrong::Bounds);
    assert!((fault.by.unwrap() - 0.75).abs() < 1e-9, "{fault:?}");
}

#[test]
fn an_arm_in_the_table() {
    let start = asked("", Idea::State { base: None, joints: None }).variant.unwrap();
    let idea = Idea::State { base: Some([-0.85, 0.0, 0.0]), joints: Some(vec![0.0, 0.6, 0.0, -0.2, 0.0, -0.2, 0.0]) };
    let (fault, _) = wrong("", idea, None);
    assert_eq!(fault.wrong, Wrong::Robot, "{fault:?}");
    assert!(fault.names.contains(&"table".to_owned()), "{fault:?}");
    assert_eq!(start.joints.len(), 7);
}

#[test]
fn a_hand_in_the_table_and_one_out_of_reach() {
    let (fault, variant) = wrong("", hand([0.0, 0.0, 0.70, 0.0, 0.0, 0.0], None), None);
    assert_eq!(fault.wrong, Wrong::Hand);
    assert!(fault.names.contains(&"table".to_owned()) && fault.by.unwrap() > 0.0, "{fault:?}");
    assert!(variant.tool[2] > 0.74, "above the table: {variant:?}");

    let (fault, variant) = wrong("", hand([-1.0, 1.0, 2.4, 0.0, 0.0, 0.0], None), None);
    assert_eq!((fault.wrong, fault.names.len()), (Wrong::Reach, 0));
    assert!(variant.tool[2] < 2.3 && variant.away_m > 0.1, "{variant:?}");
    assert!(asked("", hand(variant.tool, None)).fault.is_none());
}

#[test]
fn a_grasp_that_is_none_one_that_is_blocked_and_one_that_is_good() {
    // The hand is level, 20 cm beside the mug.
    let (fault, variant) = wrong("", hand([-0.4, 0.2, 0.79, 0.0, 0.0, 0.0], Some("mug")), Some("mug"));
    assert_eq!((fault.wrong, fault.names[0].as_str()), (Wrong::Grasp, "mug"));
    let by = fault.by.unwrap();
    assert!((0.1..0.3).contains(&by) && variant.away_m >= by - 1e-3, "{by}, {variant:?}");

    let answer = asked(&cage(), hand(variant.tool, Some("mug")));
    let fault = answer.fault.unwrap();
    assert_eq!(fault.wrong, Wrong::Pick(Stage::Hand));
    assert!(fault.names[1].starts_with("post"), "{fault:?}");
    assert_eq!(answer.variant, None, "every grasp meets a post");
}

#[test]
fn a_rim_that_overhangs_nothing() {
    let plate = r#"[[object]]
name = "plate"
shape = { cylinder = { radius = 0.14, height = 0.02 } }
on = "table"
at = [0.0, -0.1]
grasps = ["rim"]
"#;
    // From the side of the robot, the hand level.
    let tool = Vector3::new(-0.16, -0.1, 0.75);
    let answer = asked(plate, hand([tool.x, tool.y, tool.z, PI / 2.0, 0.0, 0.0], Some("plate")));
    let fault = answer.fault.unwrap();
    let expected = [Wrong::Grasp, Wrong::Pick(Stage::Overhang)];
    assert!(expected.contains(&fault.wrong), "{fault:?}");
    assert_eq!(answer.variant, None, "it lies in the middle of the table");
}

#[test]
fn ideas_that_are_none() {
    let of = |idea| why_not(&Registry::<Pr2>::new(), &WhyNotRequest { problem: problem(""), idea }).unwrap_err();
    let few = of(Idea::State { base: None, joints: Some(vec![0.0; 3]) });
    assert!(matches!(few, WhyNotError::Joints { found: 3, expected: 7 }), "{few}");
    let gone = of(hand([0.0; 6], Some("cup")));
    assert!(matches!(gone, WhyNotError::NoObject { .. }), "{gone}");
}
