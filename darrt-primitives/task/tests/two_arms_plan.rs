//! A plan of a robot with two arms, from the problem to the picture: neither arm alone could do it.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test stops at the first surprise")]

use std::sync::LazyLock;

use darrt_core::budget::Cancel;
use darrt_core::observe::Silent;
use darrt_task::clock::TimedPlan;
use darrt_task::file_robot::FileRobot;
use darrt_task::picture::story::Story;
use darrt_task::plan_file::{PlanFile, Step, Waypoint};
use darrt_task::planning::{PlanRequest, plan};
use darrt_task::problem_file::ProblemFile;
use darrt_task::registry::Registry;
use darrt_task::replan::{ReplanRequest, replan};
use darrt_task::robot::{RobotFacts, TaskRobot as _};
use darrt_task::verify::{RefusalKind, VerifyOptions, verify_with};

const PROBLEM: &str = include_str!("data/two-arms/hand-over.toml");
/// The joints that open the hands, by hand.
const FINGERS: [&str; 2] = ["right_jaw_a", "left_jaw_a"];

static REQUEST: LazyLock<PlanRequest> = LazyLock::new(|| {
    let problem = ProblemFile::from_toml(PROBLEM, "hand-over.toml").unwrap();
    PlanRequest { iterations: Some(8000), ..PlanRequest::new(problem, 0) }
});
static PLAN: LazyLock<PlanFile> = LazyLock::new(|| {
    let found = plan(&Registry::<FileRobot>::new(), &REQUEST, &Cancel::new(), &mut Silent).unwrap();
    found.plan.unwrap_or_else(|| panic!("no plan: {:?}", found.last_refusal))
});

fn facts() -> RobotFacts {
    FileRobot::facts(&REQUEST.problem.robot).unwrap()
}

fn finger(at: &Waypoint, hand: usize) -> f64 {
    at.joints[FINGERS[hand]]
}

#[test]
fn what_is_written_is_right_and_read_by_a_stranger() {
    let facts = facts();
    let text = PLAN.to_json().unwrap();
    let read = PlanFile::from_json(&text, "text").unwrap();
    assert_eq!(read, *PLAN);
    assert!(read.timing.is_some());
    for is_plain in [false, true] {
        let proof = verify_with(&read, &facts, &VerifyOptions { is_plain, ..VerifyOptions::default() }).unwrap();
        assert_eq!(proof.steps, read.steps.len());
    }
    let taken_by = |step: &&Step| step.primitive.as_str() == "Pick";
    let takers: Vec<_> = read.steps.iter().filter(taken_by).map(|step| step.hand(&facts).unwrap()).collect();
    assert!(takers.contains(&0) && takers.contains(&1), "{takers:?}");
    let story = Story::of_plan(&read, &facts).unwrap();
    // As much of the name as tells one tool from the other.
    for step in &story.steps {
        let (name, others) = (story.tool_of(step).unwrap(), facts.of_hand(1 - step.hand).tool_link);
        assert!(facts.of_hand(step.hand).tool_link.contains(name) && !others.contains(name), "{name}");
    }
    assert!((TimedPlan::new(&read, &facts).unwrap().duration_s() - read.timing.unwrap().duration_s).abs() < 1e-9);
}

#[test]
fn only_the_fingers_of_the_hand_at_work_move() {
    let facts = facts();
    assert_eq!(facts.finger_joints().collect::<Vec<_>>(), FINGERS);
    for step in &PLAN.steps {
        let hand = step.hand(&facts).unwrap();
        assert_eq!(step.tool.is_some(), hand == 1, "the first hand needs no name");
        let idle = 1 - hand;
        let first = finger(&step.waypoints[0], idle);
        assert!(step.waypoints.iter().all(|at| finger(at, idle) == first), "{}", step.primitive);
        // The hand that is not at work is open as such hands are.
        assert_eq!(first, finger(&PLAN.start, 1));
        let fingers = &facts.of_hand(hand).finger_links;
        let links = step.allowed_contacts.iter().filter(|contact| contact.a != "tin");
        assert!(links.map(|contact| &contact.a).all(|link| fingers.contains(link)));
    }
}

#[test]
fn the_other_hand_carries_nothing_and_lies_are_told() {
    let facts = facts();
    let carried = PLAN.steps.iter().position(|step| step.primitive.as_str() == "Place").unwrap();
    let mut lie = PlanFile { timing: None, ..PLAN.clone() };
    let hand = lie.steps[carried].hand(&facts).unwrap();
    lie.steps[carried].tool = Some(facts.of_hand(1 - hand).tool_link);
    let refusal = verify_with(&lie, &facts, &VerifyOptions::default()).unwrap_err();
    assert_eq!((refusal.kind, refusal.step), (RefusalKind::Mode, u32::try_from(carried + 1).ok()));
    let tools = [0, 1].map(|hand| facts.of_hand(hand).tool_link);
    assert!(tools.iter().all(|tool| refusal.message.contains(&format!("`{tool}`"))), "{refusal}");
}

#[test]
fn an_old_plan_is_taken_up_where_the_hand_is_free() {
    let mut request = REQUEST.clone();
    request.problem.goal.objects[0].at = Some([0.52, -0.72]);
    let from = ReplanRequest { plan: request, from: PLAN.clone(), keep: None };
    let replanned = replan(&Registry::<FileRobot>::new(), &from, &Cancel::new(), &mut Silent).unwrap();
    let whole = replanned.result.plan.unwrap_or_else(|| panic!("no plan: {:?}", replanned.result.last_refusal));
    verify_with(&whole, &facts(), &VerifyOptions::default()).unwrap();
}
