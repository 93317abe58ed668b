//! Plans from old plans: what is still right is kept, the rest is planned anew, and the whole is judged.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test says what is wrong by panicking")]

use darrt_core::budget::Cancel;
use darrt_core::observe::Silent;
use darrt_pr2::problems::builtin;
use darrt_pr2::robot::Pr2;
use darrt_task::plan_file::{PlanFile, Step};
use darrt_task::planning::{PlanRequest, plan};
use darrt_task::planning_error::PlanningError;
use darrt_task::problem_file::{Obstacle, ProblemFile, ShapeSpec};
use darrt_task::replan::{ReplanRequest, Replanned, replan};
use darrt_task::verify::{VerifyOptions, verify_for};

fn request(problem: ProblemFile) -> PlanRequest {
    PlanRequest { iterations: Some(8000), ..PlanRequest::new(problem, 0) }
}

fn planned(problem: &ProblemFile) -> PlanFile {
    let result = plan(&darrt_pr2::registry(), &request(problem.clone()), &Cancel::new(), &mut Silent).unwrap();
    result.plan.unwrap()
}

fn replanned(problem: ProblemFile, from: &PlanFile, keep: Option<usize>) -> Result<Replanned, PlanningError> {
    let request = ReplanRequest { plan: request(problem), from: from.clone(), keep };
    replan(&darrt_pr2::registry(), &request, &Cancel::new(), &mut Silent)
}

/// The new plan is right, for the new problem, and begins with what was kept.
fn check(replanned: &Replanned, problem: &ProblemFile, from: &PlanFile) {
    let plan = replanned.result.plan.as_ref().unwrap_or_else(|| panic!("{:?}", replanned.result));
    assert_eq!(plan.problem, *problem);
    verify_for::<Pr2>(plan, &VerifyOptions::default()).unwrap();
    let base = |plan: &PlanFile| -> Vec<_> {
        plan.steps.iter().take(replanned.kept).map(|step| (step.primitive.clone(), step.waypoints.len())).collect()
    };
    assert_eq!(base(plan), base(from));
    // So are the last ones, the robot's way to the last bit.
    let tail = |plan: &PlanFile| -> Vec<_> {
        let robot =
            |step: &Step| step.waypoints.iter().skip(1).map(|at| (at.base, at.joints.clone())).collect::<Vec<_>>();
        let first = plan.steps.len() - replanned.tail;
        plan.steps[first..].iter().map(|step| (step.primitive.clone(), robot(step))).collect()
    };
    assert_eq!(tail(plan), tail(from));
}

fn post(at: [f64; 2]) -> Obstacle {
    Obstacle {
        name: "post".to_owned(),
        shape: ShapeSpec::Cylinder { radius: 0.05, height: 1.0 },
        at: vec![at[0], at[1], 0.5],
        standing_on: None,
        yaw: None,
        rpy: None,
        quaternion: None,
    }
}

#[test]
fn a_plan_that_is_still_right_is_kept_whole() {
    let mut problem = builtin("plate1").unwrap();
    let old = planned(&problem);
    let same = replanned(problem.clone(), &old, None).unwrap();
    assert_eq!((same.kept, same.of, same.result.iterations), (old.steps.len(), old.steps.len(), 0));
    check(&same, &problem, &old);
    problem.obstacles.push(post([4.5, 4.5]));
    let far = replanned(problem.clone(), &old, None).unwrap();
    assert_eq!(far.kept, old.steps.len());
    check(&far, &problem, &old);
}

#[test]
fn with_another_goal_the_beginning_is_kept() {
    let mut problem = builtin("plate1").unwrap();
    let old = planned(&problem);
    let [x, y] = problem.goal.objects[0].at.unwrap();
    problem.goal.objects[0].at = Some([x + 0.03, y]);
    let new = replanned(problem.clone(), &old, None).unwrap();
    assert!(new.kept > 0 && new.kept < old.steps.len(), "{} of {}", new.kept, new.of);
    check(&new, &problem, &old);
}

#[test]
fn with_another_start_the_old_plan_is_taken_up_again_once_the_object_is_where_it_had_it() {
    for (name, by) in [("simple-plate", [-0.02, 0.02]), ("plate3", [-0.02, 0.02]), ("bowl", [0.02, -0.02])] {
        let mut problem = builtin(name).unwrap();
        let old = planned(&problem);
        problem.objects[0].at[0] += by[0];
        problem.objects[0].at[1] += by[1];
        let new = replanned(problem.clone(), &old, None).unwrap();
        assert!(new.refused.is_some());
        // The bowl is picked where it starts: nothing of that is as it was.
        assert!(new.tail > 0 || name == "bowl", "{name}: {} of {} kept", new.tail, new.of);
        check(&new, &problem, &old);
        // Steps that a person keeps are not all that a person wants: what follows is planned anew.
        assert_eq!(replanned(problem, &old, Some(0)).unwrap().tail, 0);
    }
}

#[test]
fn steps_are_kept_only_where_the_hand_is_free() {
    let problem = builtin("bowl").unwrap();
    let old = planned(&problem);
    let pick = old.steps.iter().position(|step| step.primitive.as_str() == "Pick").unwrap();
    let error = replanned(problem.clone(), &old, Some(pick + 1)).unwrap_err();
    assert!(matches!(error, PlanningError::CannotKeep { keep, .. } if keep == pick + 1), "{error}");
    let new = replanned(problem.clone(), &old, Some(0)).unwrap();
    assert_eq!(new.kept, 0);
    check(&new, &problem, &old);
    let error = replanned(problem, &old, Some(1000)).unwrap_err().to_string();
    assert!(error.contains("1000"), "{error}");
}

#[test]
fn the_same_old_plan_gives_the_same_new_one() {
    let mut problem = builtin("plate1").unwrap();
    let old = planned(&problem);
    problem.objects[0].at[0] += 0.02;
    let new = || replanned(problem.clone(), &old, None).unwrap().result.plan.unwrap();
    assert_eq!(new(), new());
}
