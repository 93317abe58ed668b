//! Plans that start or end elsewhere than the problem says.

use darrt_pr2::verify;
use darrt_task::plan_file::PlanFile;
use darrt_task::problem_file::{GoalState, Region, Symmetry};
use darrt_task::verify::RefusalKind;

use super::{about, block, refused};
use crate::verify_plans::plans;

#[test]
fn the_start_is_the_problems() {
    use RefusalKind as K;
    let refusal = refused(plans::push(), 0, K::Start, |plan| plan.problem.objects[0].at[0] += 1e-3);
    assert!(refusal.message.contains("`plate`"), "{refusal}");
    refused(plans::push(), 0, K::Start, |plan| plan.problem.robot.base[2] += 1e-3);
    refused(plans::push(), 0, K::Start, |plan| plan.problem.robot.torso_m = Some(0.25));
    refused(plans::push(), 0, K::Start, |plan| plan.problem.robot.other_posture = Some("up".to_owned()));
    refused(plans::push(), 0, K::Start, |plan| plan.problem.robot.joints.as_mut().unwrap()[6] += 1e-6);
    let refusal = refused(plans::push(), 0, K::Problem, |plan| plan.problem.objects[0].on = "shelf".to_owned());
    assert!(refusal.message.contains("shelf"), "{refusal}");
    let pillar = block("pillar", [-0.8, 0.0, 1.0], [0.1, 0.1, 1.9]);
    let refusal = refused(plans::push(), 0, K::Collision, |plan| plan.problem.obstacles.push(pillar));
    about(&refusal, "base_link", "pillar");
}

#[test]
fn the_goal_holds_at_the_end() {
    use RefusalKind as K;
    refused(plans::push(), 0, K::Goal, |plan| plan.problem.goal.objects[0].at = Some([-0.2, -0.1]));
    refused(plans::push(), 0, K::Goal, |plan| {
        let goal = &mut plan.problem.goal.objects[0];
        (goal.on, goal.at) = (Some("side table".to_owned()), Some([-2.14, -1.09]));
    });
    // Where it is, but in the hand.
    refused(plans::push(), 0, K::Goal, |plan| {
        let goal = &mut plan.problem.goal.objects[0];
        let [x, y] = goal.at.take().unwrap();
        (goal.on, goal.position, goal.state) = (None, Some([x, y, 0.76]), Some(GoalState::Held));
    });
    refused(plans::carry(), 0, K::Goal, |plan| plan.steps.truncate(5));
    refused(plans::push(), 0, K::Goal, |plan| plan.steps.clear());
    let region = |max: f64| {
        move |plan: &mut PlanFile| {
            let goal = &mut plan.problem.goal.objects[0];
            goal.at = None;
            goal.region = Some(Region { min: [-0.3, -0.4], max: [-0.1, max] });
        }
    };
    refused(plans::push(), 0, K::Goal, region(-0.3));
    let mut plan = plans::push();
    region(-0.2)(&mut plan);
    verify(&plan).unwrap();
    // A goal that is missed beside one that is met: alternatives.
    plan.problem.goal.objects.push(plans::goal_on_table([0.2, 0.2]));
    verify(&plan).unwrap();
}

#[test]
fn the_yaw_counts_for_objects_that_are_not_round() {
    let plan = |symmetry, yaw| {
        let mut plan = plans::push();
        plan.problem.objects[0].symmetry = Some(symmetry);
        plan.problem.goal.objects[0].yaw = Some(yaw);
        plan
    };
    verify(&plan(Symmetry::Z, 0.2)).unwrap();
    verify(&plan(Symmetry::None, 0.04)).unwrap();
    refused(plan(Symmetry::None, 0.2), 0, RefusalKind::Goal, |_| ());
}
