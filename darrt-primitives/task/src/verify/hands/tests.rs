//! Plans of a robot with two hands, and lies about which of them does what.

use super::*;
use crate::clock::{TimedPlan, time};
use crate::plan_file::{AllowedContact, ContactReason, PlanFile, Waypoint};
use crate::problem_file::PrimitiveName;
use crate::testing::{LEFT_TOOL as LEFT, both_hands, facts, left_handed};
use crate::verify::{Proof, VerifyOptions, verify_with};

const RIGHT: &str = "r_gripper_tool_frame";

fn judged(plan: &PlanFile, is_plain: bool) -> Result<Proof, Refusal> {
    verify_with(plan, &both_hands(&plan.problem), &VerifyOptions { is_plain, ..VerifyOptions::default() })
}

/// What both judges say of the plan after the change, in the same words.
fn refused(change: impl FnOnce(&mut PlanFile)) -> Refusal {
    let mut plan = left_handed();
    change(&mut plan);
    let refusal = judged(&plan, false).unwrap_err();
    assert_eq!(judged(&plan, true).unwrap_err().message, refusal.message);
    refusal
}

fn holding(plan: &PlanFile) -> usize {
    plan.steps.iter().position(|step| step.holds.is_some()).expect("a step that holds something")
}

/// A step of nothing but waypoints.
fn transit(tool: Option<&str>, waypoints: Vec<Waypoint>) -> Step {
    Step {
        primitive: PrimitiveName::ARM_TRANSIT,
        object: None,
        tool: tool.map(str::to_owned),
        holds: None,
        pushes: None,
        allowed_contacts: Vec::new(),
        waypoints,
    }
}

/// The same place with the fingers of the right hand a little more closed.
fn with_right_hand(at: &Waypoint, by_rad: f64) -> Waypoint {
    let mut at = at.clone();
    for (name, value) in &mut at.joints {
        if name.starts_with("r_gripper") {
            *value += by_rad;
        }
    }
    at
}

#[test]
fn a_plan_of_the_second_hand_is_right_and_one_of_both_too() {
    let mut plan = left_handed();
    let proof = judged(&plan, false).unwrap();
    assert_eq!(judged(&plan, true).unwrap().steps, proof.steps);
    // Judged as that of a robot with the left arm alone it is as right.
    let mut alone = plan.clone();
    alone.steps.iter_mut().for_each(|step| step.tool = None);
    assert_eq!(crate::verify::verify(&alone, &facts(&alone.problem)).unwrap().steps, proof.steps);
    // The first hand closes a little at the end.
    let end = plan.steps.last().unwrap().waypoints.last().unwrap().clone();
    let closed = with_right_hand(&end, -0.1);
    for tool in [None, Some(RIGHT)] {
        plan.steps.push(transit(tool, vec![end.clone(), closed.clone()]));
        assert_eq!(judged(&plan, false).unwrap().steps, proof.steps + 1);
        plan.steps.pop();
    }
}

#[test]
fn the_clock_of_a_plan_is_that_of_the_hand_at_work() {
    let plan = left_handed();
    let both = both_hands(&plan.problem);
    let timing = time(&plan, &both).unwrap();
    let mut alone = plan.clone();
    alone.steps.iter_mut().for_each(|step| step.tool = None);
    assert_eq!(timing, time(&alone, &facts(&plan.problem)).unwrap());
    let mut timed = plan.clone();
    crate::clock::give_clock(&mut timed, &both, &VerifyOptions::default(), &darrt_core::budget::Cancel::new()).unwrap();
    assert!(judged(&timed, false).unwrap().duration_s.is_some());
    // What is held goes with the second tool.
    let on_clock = TimedPlan::new(&timed, &both).unwrap();
    let step = holding(&plan);
    let middle_s = f64::midpoint(on_clock.step_start_s(step).unwrap(), on_clock.step_start_s(step + 1).unwrap());
    let moment = on_clock.at(middle_s);
    let hold = plan.steps[moment.step].holds.as_ref().unwrap();
    let tool = on_clock.links(&moment)[on_clock.tree().link_index(LEFT).unwrap()];
    let held = on_clock.objects(&moment)[hold.object.as_str()];
    let expected = tool * nalgebra::Isometry3::from(hold.tool_from_object);
    assert!((held.translation.vector - expected.translation.vector).norm() < 1e-9);
}

#[test]
fn a_tool_that_the_robot_does_not_have_is_named_with_those_that_it_has() {
    let refusal = refused(|plan| plan.steps[0].tool = Some("l_gripper_tol_frame".to_owned()));
    assert_eq!((refusal.kind, refusal.step), (RefusalKind::Malformed, Some(1)));
    let text = "`tool` is `l_gripper_tol_frame`, no tool of the robot (did you mean `l_gripper_tool_frame`?); there are \
                r_gripper_tool_frame, l_gripper_tool_frame";
    assert_eq!(&*refusal.message, text);
}

#[test]
fn a_step_that_names_the_other_hand_is_refused() {
    // It takes with the fingers of the left hand.
    let refusal = refused(|plan| {
        let step = holding(plan);
        plan.steps[step].tool = None;
    });
    assert_eq!(refusal.kind, RefusalKind::AllowedContact, "{refusal}");
    // And without any fingers the left one is not to move.
    let refusal = refused(|plan| {
        let step = holding(plan);
        plan.steps[step].tool = Some(RIGHT.to_owned());
        plan.steps[step].allowed_contacts.retain(|contact| contact.reason == ContactReason::Support);
    });
    assert_eq!(refusal.kind, RefusalKind::Stray, "{refusal}");
    assert!(refusal.message.contains("`l_gripper_l_finger_joint` moves"), "{refusal}");
}

#[test]
fn a_straight_line_of_the_other_hand_is_none() {
    // The hand that the step names stands still, and so goes straight.
    let refusal = refused(|plan| {
        let is_line = |step: &Step| step.primitive.as_str() == "Straight-Line-Arm-Transit";
        let step = plan.steps.iter().position(is_line).expect("an approach");
        // The fingers open in a step of their own.
        let opening = plan.steps[step].waypoints[..2].to_vec();
        plan.steps[step].waypoints.remove(0);
        plan.steps[step].tool = None;
        plan.steps[step].allowed_contacts.clear();
        plan.steps.insert(step, transit(Some(LEFT), opening));
        plan.contracts.insert(PrimitiveName::ARM_TRANSIT, darrt_primitives::primitive::STANDARD[0].1);
    });
    assert_eq!(refusal.kind, RefusalKind::Stray, "{refusal}");
    assert!(refusal.message.contains("does not move the hand of `r_gripper_tool_frame`"), "{refusal}");
}

#[test]
fn what_one_hand_has_taken_is_not_carried_by_the_other() {
    let refusal = refused(|plan| {
        let step = holding(plan) + 1;
        assert!(plan.steps[step].holds.is_some());
        plan.steps[step].tool = Some(RIGHT.to_owned());
    });
    assert_eq!(refusal.kind, RefusalKind::Mode, "{refusal}");
    let parts = [LEFT, RIGHT, "while something is held, no other hand is at work"];
    assert!(parts.iter().all(|part| refusal.message.contains(part)), "{refusal}");
}

#[test]
fn while_one_hand_holds_something_the_other_does_nothing() {
    let refusal = refused(|plan| {
        let step = holding(plan) + 1;
        let here = plan.steps[step].waypoints[0].clone();
        plan.steps.insert(step, transit(None, vec![here.clone(), here]));
        let arm_transit = darrt_primitives::primitive::STANDARD[0].1;
        plan.contracts.insert(PrimitiveName::ARM_TRANSIT, arm_transit);
    });
    assert_eq!(refusal.kind, RefusalKind::Mode, "{refusal}");
    assert!(refusal.message.contains("no other hand is at work"), "{refusal}");
}

#[test]
fn the_fingers_of_the_idle_hand_stand_still() {
    let refusal = refused(|plan| {
        let step = holding(plan);
        let mut moved = false;
        for (index, step) in plan.steps.iter_mut().enumerate().skip(step) {
            for (at, waypoint) in step.waypoints.iter_mut().enumerate() {
                moved |= index > 0 && at > 0;
                if moved {
                    *waypoint = with_right_hand(waypoint, -0.05);
                }
            }
        }
    });
    assert_eq!(refusal.kind, RefusalKind::Stray, "{refusal}");
    assert!(refusal.message.contains("`r_gripper_l_finger_joint` moves, but must stand still"), "{refusal}");
}

#[test]
fn the_fingers_of_the_idle_hand_touch_nothing() {
    let refusal = refused(|plan| {
        let step = holding(plan);
        let object = plan.steps[step].object.clone().unwrap();
        let fingers = ["r_gripper_l_finger_link".to_owned()];
        plan.steps[step].allowed_contacts.extend(AllowedContact::fingers(&fingers, &object, ContactReason::Grasp));
    });
    assert_eq!(refusal.kind, RefusalKind::AllowedContact, "{refusal}");
    assert!(refusal.message.contains("r_gripper_l_finger_link"), "{refusal}");
}
