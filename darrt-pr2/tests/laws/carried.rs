//! What is carried leans no farther than its problem allows, and does lean where nothing forbids it.

use darrt_core::budget::Cancel;
use darrt_core::observe::Silent;
use darrt_pr2::problems::builtin;
use darrt_task::plan_file::PlanFile;
use darrt_task::planning::{PlanRequest, plan};
use nalgebra::{Isometry3, Vector3};

/// With one of these the bowl is carried upside down where that is allowed and nothing is improved.
const SEEDS: std::ops::Range<u64> = 10..14;

/// The largest lean of the bowl at any waypoint of plans with a limit, degrees.
fn most_lean_deg(limit_deg: f64, as_found: bool) -> f64 {
    let of_plan = |seed| {
        let mut problem = builtin("bowl").unwrap();
        problem.objects[0].max_tilt_deg = Some(limit_deg);
        let request = PlanRequest { as_found, ..PlanRequest::new(problem, seed) };
        let result = plan(&darrt_pr2::registry(), &request, &Cancel::new(), &mut Silent).unwrap();
        lean_deg(&result.plan.unwrap())
    };
    SEEDS.map(of_plan).fold(0.0, f64::max)
}

fn lean_deg(plan: &PlanFile) -> f64 {
    let waypoints = plan.steps.iter().flat_map(|step| &step.waypoints);
    let poses = waypoints.flat_map(|waypoint| waypoint.objects.values().copied().map(Isometry3::from));
    poses.map(|pose| (pose.rotation * Vector3::z()).angle(&Vector3::z()).to_degrees()).fold(0.0, f64::max)
}

#[test]
fn a_bowl_leans_as_far_as_it_may_and_no_farther() {
    let free = most_lean_deg(180.0, true);
    for (limit_deg, as_found) in [(5.0, false), (10.0, false), (10.0, true)] {
        let bound = most_lean_deg(limit_deg, as_found);
        assert!(bound <= limit_deg && bound < free, "{bound} of {limit_deg}, {free} without a limit");
    }
}
