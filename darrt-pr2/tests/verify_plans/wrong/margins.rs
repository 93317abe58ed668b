//! What comes too near without touching, and what may.

use darrt_pr2::verify;
use darrt_task::plan_file::{PlanFile, Pose};
use darrt_task::problem_file::{Obstacle, Region, Surface};
use darrt_task::verify::{RefusalKind, WarningKind};

use super::{about, block, refused};
use crate::verify_plans::builder::{PLATE, TABLE};
use crate::verify_plans::plans;

/// Radius of the plate, metres.
const RADIUS: f64 = 0.14;

/// A brick this far from the way of the pushed plate.
fn brick(gap: f64) -> Obstacle {
    block("brick", [-0.2 + RADIUS + gap + 0.025, -0.1, 0.8], [0.05, 0.05, 0.1])
}

/// The push with a second plate standing about.
fn with_saucer(at: [f64; 2]) -> PlanFile {
    let mut plan = plans::push();
    plan.problem.obstacles.retain(|obstacle| obstacle.name != "big bowl");
    let mut saucer = plan.problem.objects[0].clone();
    "saucer".clone_into(&mut saucer.name);
    saucer.at = at;
    plan.problem.objects.push(saucer);
    let pose = Pose { position: [at[0], at[1], 0.76], quaternion: [0.0, 0.0, 0.0, 1.0] };
    let waypoints = plan.steps.iter_mut().flat_map(|step| &mut step.waypoints);
    for waypoint in waypoints.chain([&mut plan.start]) {
        waypoint.objects.insert("saucer".into(), pose);
    }
    plan
}

/// The push, which ends at y = -0.25, with the table in two surfaces that meet 20 mm before that.
fn over_a_seam() -> PlanFile {
    let mut plan = plans::push();
    let seam = -0.23;
    let half = |name: &str, low: f64, high: f64| Surface {
        name: name.to_owned(),
        top_of: None,
        polygon: Some(vec![[-0.45, low], [0.45, low], [0.45, high], [-0.45, high]]),
        z: Some(0.75),
        body: Some(TABLE.to_owned()),
    };
    plan.problem.obstacles.retain(|obstacle| obstacle.standing_on.is_none());
    let surfaces = &mut plan.problem.surfaces;
    surfaces.retain(|surface| surface.name != "central table");
    surfaces.extend([half("central table", seam, 0.6), half("right half", -0.6, seam)]);
    plan.problem.goal.objects[0].on = Some("right half".to_owned());
    plan
}

fn kinds(plan: &PlanFile) -> Vec<WarningKind> {
    verify(plan).unwrap().warnings.iter().map(|warning| warning.kind).collect()
}

#[test]
fn what_need_not_be_near_keeps_the_least_margin() {
    let refusal = refused(plans::push(), 2, RefusalKind::Margin, |plan| plan.problem.obstacles.push(brick(0.004)));
    about(&refusal, PLATE, "brick");
    assert!(refusal.message.contains("apart, at least 5.00 mm must be kept"), "{refusal}");
    // Nearer than is wanted it may come.
    let mut plan = plans::push();
    plan.problem.obstacles.push(brick(0.007));
    let proof = verify(&plan).unwrap();
    let warning = proof.warnings.iter().find(|warning| warning.kind == WarningKind::ObjectMargin).unwrap();
    assert_eq!((warning.step, &*warning.bodies[0], &*warning.bodies[1]), (Some(2), PLATE, "brick"));
    assert!((warning.found - 0.007).abs() < 1e-4 && warning.wanted == 0.01, "{warning}");
    assert!((proof.smallest_clearance.unwrap().distance_m - 0.007).abs() < 1e-4);
    plan.problem.safety.object_margin_m = 0.006;
    assert!(!kinds(&plan).contains(&WarningKind::ObjectMargin));
    // Who keeps nothing may come as near as he likes.
    plan.problem.safety.least_margin_m = 0.0001;
    plan.problem.safety.contact_margin_m = 0.0001;
    plan.problem.obstacles.pop();
    plan.problem.obstacles.push(brick(0.001));
    verify(&plan).unwrap();
}

#[test]
fn what_must_be_near_keeps_a_margin_of_its_own() {
    let plan = plans::push();
    let intended = verify(&plan).unwrap().smallest_intended.unwrap();
    assert!(intended.distance_m < 0.0055, "the fingertips pass the table: {intended:?}");
    let strict = |plan: &mut PlanFile, contact_margin_m| {
        let safety = &mut plan.problem.safety;
        (safety.least_margin_m, safety.contact_margin_m) = (0.015, contact_margin_m);
        safety.object_margin_m = safety.object_margin_m.max(0.015);
    };
    let refusal = refused(plan.clone(), 1, RefusalKind::Margin, |plan| strict(plan, 0.008));
    about(&refusal, "r_gripper", TABLE);
    // It is the step that says what the hand is about.
    let mut strict_plan = plan;
    strict(&mut strict_plan, 0.002);
    verify(&strict_plan).unwrap();
    let refusal = refused(strict_plan, 1, RefusalKind::Margin, |plan| plan.steps[0].object = None);
    about(&refusal, "r_gripper", "");
}

#[test]
fn what_begins_too_near_only_moves_away() {
    // Beside the plate, which leaves it behind.
    let plan = with_saucer([-0.2 + 2.0 * RADIUS + 0.003, 0.05]);
    let proof = verify(&plan).unwrap();
    assert_eq!(proof.warnings[0].kind, WarningKind::StartNear, "{:?}", proof.warnings);
    assert!((proof.warnings[0].found - 0.003).abs() < 1e-4, "{}", proof.warnings[0]);
    // A little ahead: the plate would pass nearer than it stood.
    let refusal = refused(with_saucer([-0.2 + 0.2815, 0.02]), 2, RefusalKind::Margin, |_| ());
    about(&refusal, PLATE, "saucer");
}

#[test]
fn a_goal_beside_something_may_be_reached() {
    // The push ends with the plate at y = -0.25.
    let mut plan = plans::push();
    plan.problem.obstacles.push(block("brick", [-0.2, -0.25 - RADIUS - 0.003 - 0.025, 0.8], [0.05, 0.05, 0.1]));
    assert!(kinds(&plan).contains(&WarningKind::GoalNear));
    // A region leaves the choice to the plan.
    let refusal = refused(plan, 2, RefusalKind::Margin, |plan| {
        let goal = &mut plan.problem.goal.objects[0];
        goal.at = None;
        goal.region = Some(Region { min: [-0.3, -0.3], max: [-0.1, -0.2] });
    });
    about(&refusal, PLATE, "brick");
}

/// Two that touch have come too near before: told is the worse.
#[test]
fn a_collision_is_no_matter_of_margins() {
    refused(plans::push(), 2, RefusalKind::Collision, |plan| plan.problem.obstacles.push(brick(-0.01)));
}

#[test]
fn the_seam_of_surfaces_that_lie_flush_is_no_edge() {
    let plan = over_a_seam();
    assert_eq!(plan.problem.safety.edge_margin_m, 0.03);
    assert!(!kinds(&plan).contains(&WarningKind::Edge), "{:?}", verify(&plan).unwrap().warnings);
    // Where the half beyond ends, there is one.
    let mut plan = plan;
    plan.problem.safety.edge_margin_m = 0.4;
    let proof = verify(&plan).unwrap();
    let warning = proof.warnings.iter().find(|warning| warning.kind == WarningKind::Edge).unwrap();
    assert!((warning.found - 0.25).abs() < 2e-3, "{warning}");
}
