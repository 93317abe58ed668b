//! Every everyday problem is planned once, and the plan is what a person would expect of it.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test says what is wrong by panicking")]

use darrt_core::budget::Cancel;
use darrt_core::observe::Silent;
use darrt_pr2::problems::{builtin, everyday_names, hopeless_names};
use darrt_task::plan_file::{PlanFile, Step, Waypoint};
use darrt_task::planning::{PlanRequest, plan};
use darrt_task::problem_file::PrimitiveName;

/// The verified plan of a problem, within a number of iterations that no seed tried has needed.
fn planned(name: &str) -> PlanFile {
    let mut request = PlanRequest::new(builtin(name).unwrap(), 0);
    request.iterations = Some(20_000);
    let result = plan(&darrt_pr2::registry(), &request, &Cancel::new(), &mut Silent)
        .unwrap_or_else(|error| panic!("{name}: {error}"));
    result.plan.unwrap_or_else(|| panic!("{name}: no plan, {:?} after {} iterations", result.stop, result.iterations))
}

#[test]
fn every_problem_is_solved() {
    for name in everyday_names() {
        let plan = planned(name);
        assert!(!plan.steps.is_empty(), "{name}");
    }
}

#[test]
fn the_plate_is_pushed_over_the_seam() {
    let plan = planned("plate-over-seam");
    let x_y = |waypoint: &Waypoint| waypoint.objects.get("plate").map(|pose| pose.position);
    let crosses = |step: &Step| {
        let ends = [step.waypoints.first(), step.waypoints.last()].map(|w| w.and_then(x_y).map(|[_, y, _]| y));
        step.primitive == PrimitiveName::PUSH && matches!(ends, [Some(from), Some(to)] if from > 0.0 && to < 0.0)
    };
    assert!(plan.steps.iter().any(crosses), "no push goes over the seam");
}

#[test]
fn what_has_no_plan_is_refused_at_once_with_the_reason() {
    let said = hopeless_names().map(|name| {
        let request = PlanRequest::new(builtin(name).unwrap(), 0);
        plan(&darrt_pr2::registry(), &request, &Cancel::new(), &mut Silent).unwrap_err().to_string()
    });
    let reasons = ["it weighs 3 kg, the arm carries 1.8", "N of grip, the gripper has 50"];
    for (said, reason) in said.iter().zip(reasons) {
        assert!(said.contains("no grasp holds it") && said.contains(reason), "{said}");
    }
}
