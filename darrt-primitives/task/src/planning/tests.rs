use darrt_core::cost::ExecutionCost;
use darrt_core::observe::Silent;
use darrt_core::solve::solve;
use darrt_primitives::execution_time::ExecutionTime;

use super::*;
use crate::testing::{builtin, planned, registry, verify};

/// Bowl with a budget of iterations alone.
fn request(iterations: u64) -> PlanRequest {
    let mut request = PlanRequest::new(builtin("bowl").unwrap(), 5);
    request.time_limit = Some(Duration::from_secs(3600));
    request.iterations = Some(iterations);
    request.restart = Some(100);
    request
}

/// Steps in the file.
fn steps(result: &PlanResult) -> usize {
    result.plan.as_ref().unwrap().steps.len()
}

#[test]
fn more_budget_never_gives_a_plan_of_more_steps() {
    let first = planned(&request(600));
    assert_eq!(first.plans, 1);
    let mut before = usize::MAX;
    let mut plans = 0;
    for iterations in [200, 600, 1200] {
        let result = planned(&PlanRequest { improve: Some(Cost::Steps), ..request(iterations) });
        assert!(result.plan.is_none() || result.proof.is_some(), "what is returned has been accepted");
        assert!(result.plans >= plans);
        plans = result.plans;
        if result.plan.is_some() {
            assert!(steps(&result) <= before);
            before = steps(&result);
        }
    }
    assert!(plans > 1 && before <= steps(&first), "{plans} {before}");
}

#[test]
fn more_budget_never_gives_a_plan_of_less_clearance() {
    let gains = (0..3).map(|seed| {
        let clearance_m = |improve, iterations, threads| {
            let request = PlanRequest { seed, threads, improve, as_found: true, ..request(iterations) };
            planned(&request).proof.unwrap().smallest_clearance.unwrap().distance_m
        };
        let best = Some(Cost::Clearance);
        let first = clearance_m(None, 600, 1);
        let (some, more) = (clearance_m(best, 600, 1), clearance_m(best, 1200, 1));
        assert!(first <= some && some <= more, "{first} {some} {more}");
        assert_eq!(clearance_m(best, 1200, 2), more);
        more - first
    });
    assert!(gains.fold(0.0, f64::max) > 0.0);
}

/// What is improved is judged like every plan, and takes less time on the whole; what is left as it was found says so.
#[test]
fn plans_are_improved_unless_nobody_wants_it() {
    let (mut better_s, mut found_s) = (0.0, 0.0);
    for seed in 0..4 {
        let planned = |as_found| planned(&PlanRequest { seed, as_found, ..request(600) });
        let (better, found) = (planned(false), planned(true));
        // Some plan may be as good as it gets.
        if let Some((file, straight_s)) = &better.found {
            assert!(steps(&found) <= file.steps.len() && *straight_s > 0.0);
        }
        assert_eq!(verify(better.plan.as_ref().unwrap()).unwrap(), better.proof.unwrap());
        let is_as_found = |result: &Option<PlanFile>| result.as_ref().unwrap().planner.as_found;
        assert!(is_as_found(&found.plan) && !is_as_found(&better.plan) && found.found.is_none());
        better_s += better.execution_s.unwrap();
        found_s += found.execution_s.unwrap();
    }
    assert!(better_s < 0.95 * found_s, "{better_s} {found_s}");
    let clear = planned(&PlanRequest { improve: Some(Cost::Clearance), ..request(200) });
    assert!(clear.found.is_none(), "what is to keep clear goes no shorter way");
}

#[test]
fn plans_are_not_improved_without_a_limit() {
    let mut endless = PlanRequest { improve: Some(Cost::Travel), ..PlanRequest::new(builtin("bowl").unwrap(), 0) };
    // Longer than the clock can tell.
    endless.problem.budget.time_limit_s = f64::MAX;
    let error = plan(&registry(), &endless, &Cancel::new(), &mut Silent).unwrap_err();
    assert!(matches!(error, PlanningError::NoLimit), "{error}");
}

#[test]
fn several_searches_are_restarted_although_nothing_says_when() {
    let mut both = request(RESTART_ITERATIONS + 1);
    both.restart = None;
    both.problem.budget.restart_iterations = None;
    // The first search is never asked again if the second solves.
    both.algorithms = Algorithm::ALL.to_vec();
    both.problem.sampling.goal_bias = 0.0;
    both.problem.sampling.object_share = 0.0;
    assert_eq!(planned(&both).restarts, 1);
}

/// The law of [`ExecutionCost`] on every step of plans, and that no drive is faster than the base.
#[test]
fn a_part_of_a_step_takes_no_longer_than_the_whole() {
    let registry = registry();
    for name in ["bowl", "simple-plate"] {
        let file = builtin(name).unwrap();
        let prepared = prepare(&registry, &file).unwrap();
        let strategy = strategy(&registry, &PlanRequest::new(file.clone(), 0)).unwrap();
        let outcome = solve(&prepared.problem, &strategy, &SolveOptions::default(), &mut Silent);
        let (plan, _) = outcome.solution.unwrap().into_parts();
        let m = prepared.problem.domain();
        let mut here = plan.start().clone();
        let mut sum_s = 0.0;
        for step in plan.steps() {
            let seconds = |share: f64| ExecutionTime.seconds(m, &step.instance, &here, share * step.until);
            let mut before_s = 0.0;
            for share in [0.0, 0.1, 0.35, 0.8, 0.99, 1.0] {
                assert!(
                    seconds(share) >= before_s - 1e-9 && seconds(share).is_finite(),
                    "{} at {share}",
                    step.instance.primitive
                );
                before_s = seconds(share);
            }
            sum_s += before_s;
            let end = step.instance.at(m, step.until, &here);
            let drive_m = (end.robot.base[0] - here.robot.base[0]).hypot(end.robot.base[1] - here.robot.base[1]);
            assert!(before_s >= drive_m / 0.5, "{before_s} s for {drive_m} m");
            here = end;
        }
        assert!((plan_seconds(&ExecutionTime, m, &plan) - sum_s).abs() < 1e-9);
    }
}

/// Planned for success the robot pushes once more from where it grasps; else it drives between the two.
#[test]
fn planned_for_success_it_grasps_from_where_it_has_pushed() {
    let of_hand = |cost: &'static str| {
        let plans = (0..4).map(|seed| {
            let request = PlanRequest::new(builtin("simple-plate").unwrap(), seed);
            let plan = planned(&PlanRequest { cost: CostName::new(cost), ..request }).plan.unwrap();
            verify(&plan).unwrap();
            let names: Vec<_> = plan.steps.iter().map(|step| step.primitive.as_str().to_owned()).collect();
            let pick = names.iter().position(|name| name == "Pick").unwrap();
            let before = names.iter().take(pick).rev().find(|name| ["Push", "Base-Transit"].contains(&name.as_str()));
            usize::from(before.is_some_and(|name| name == "Push"))
        });
        plans.sum::<usize>()
    };
    assert!(of_hand("success") > of_hand("execution-time"));
}

/// The robot goes where its goal says, by base, joints and tool, and the verifier holds it to that.
#[test]
fn the_robot_has_goals_too() {
    let robot = |text: &str| {
        let bowl = crate::testing::builtin_text("bowl").unwrap();
        let (head, _) = bowl.split_once("[[goal.object]]").unwrap();
        let text = format!("{head}[goal.robot]\n{text}\n");
        crate::problem_file::ProblemFile::from_toml(&text, "robot").unwrap()
    };
    let goals = [
        "base = [-1.0, 1.0, 0.5]",
        "joints = [-0.4, 0.0, 0.0, -2.05, 0.0, -0.1, 0.0]",
        "tool = { position = [0.0, 1.0, 1.2], rpy = [0.0, 0.0, 0.3] }",
        "base = [-1.0, 1.0, 0.5]\njoints = [-0.4, 0.0, 0.0, -2.05, 0.0, -0.1, 0.0]",
    ];
    for goal in goals {
        let mut plan = planned(&PlanRequest::new(robot(goal), 1)).plan.unwrap();
        assert!(!plan.steps.is_empty(), "{goal}");
        verify(&plan).unwrap();
        let robot = plan.problem.goal.robot.as_mut().unwrap();
        robot.base = robot.base.map(|[x, y, yaw]| [x + 0.02, y, yaw]);
        robot.joints.iter_mut().flatten().take(1).for_each(|joint| *joint += 0.06);
        robot.tool.iter_mut().for_each(|tool| tool.position[2] += 0.02);
        let refusal = verify(&plan).unwrap_err();
        assert!(refusal.message.contains("the goal does not hold"), "{refusal}");
    }
}
