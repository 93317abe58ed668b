//! A verifier that refuses: counted, told, and the search goes on.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU64, Ordering};

use darrt_core::budget::Stop;
use darrt_core::goal::{Goal, Reach};
use darrt_core::observe::Event;
use darrt_core::partial::PartialState;
use darrt_core::plan::{Plan, Step};
use darrt_core::problem::Problem;
use darrt_core::state::State;
use darrt_core::testing::puck::Judge;
use darrt_core::validity::AlwaysValid;
use darrt_core::verify::{Refusal, Replay, Verified, Verifier};

use super::support::{World, options, robot_instance, run, run_observed, small};

/// Refuses the first few plans, whatever they are.
struct Grumpy {
    refusals_left: AtomicU64,
}

impl Verifier<World> for Grumpy {
    fn verify(&self, _: &World, _: &State<World>, _: &dyn Goal<World>, _: &Plan<World>) -> Result<Verified, Refusal> {
        let left = self.refusals_left.fetch_update(Ordering::SeqCst, Ordering::SeqCst, |n| n.checked_sub(1));
        match left {
            Ok(n) => Err(Refusal { step: None, at: 0.0, reason: format!("not in the mood, {n} more") }),
            Err(_) => Ok(Verified::default()),
        }
    }
}

fn judged_by(verifier: impl Verifier<World> + 'static) -> Problem<World> {
    let mut parts = small().puck_goal(0, [2.0, 1.0]).parts().unwrap();
    parts.verifier = Box::new(verifier);
    Problem::new(parts).unwrap()
}

#[test]
fn refused_plans_are_counted_and_told_and_the_search_goes_on() {
    let problem = judged_by(Grumpy { refusals_left: AtomicU64::new(3) });
    let mut told = Vec::new();
    let outcome = run_observed(&problem, &options(0, 500), |event| {
        if let Event::Refused { reason, .. } = event {
            told.push((*reason).to_owned());
        }
        ControlFlow::Continue(())
    });
    assert_eq!(outcome.stop, Stop::Solved);
    assert_eq!(outcome.accounts.refused, 3);
    assert_eq!(told, ["not in the mood, 3 more", "not in the mood, 2 more", "not in the mood, 1 more"]);
    assert_eq!(outcome.last_refusal.as_deref(), Some("not in the mood, 1 more"));
    assert!(outcome.accounts.are_balanced());
}

#[test]
fn a_verifier_that_never_agrees_leaves_no_solution() {
    let problem = judged_by(Grumpy { refusals_left: AtomicU64::new(u64::MAX) });
    let outcome = run(&problem, &options(0, 100));
    assert_eq!(outcome.stop, Stop::IterationLimit);
    assert!(outcome.solution.is_none() && outcome.accounts.refused > 0);
}

#[test]
fn an_observer_that_breaks_before_a_refusal_is_obeyed() {
    let problem = judged_by(Grumpy { refusals_left: AtomicU64::new(u64::MAX) });
    let outcome = run_observed(&problem, &options(0, 500), |event| match event {
        Event::Iteration { added: 1.., .. } => ControlFlow::Break(()),
        _ => ControlFlow::Continue(()),
    });
    assert_eq!(outcome.stop, Stop::Cancelled);
}

/// The judge, and a plan of one robot step to (1, 0.3), changed by `spoil`.
fn verdict(spoil: impl Fn(&mut Step<World>)) -> Result<(), String> {
    let problem = small().wall("wall", [1.4, 0.9], [1.6, 1.1]).puck_goal(0, [1.0, 1.0]).problem().unwrap();
    let (m, start) = (problem.domain(), problem.start());
    let target = State { robot: [1.0, 0.3], ..start.clone() };
    let mut step = Step { instance: robot_instance(start, &target).into(), until: 1.0, primitive: 0 };
    spoil(&mut step);
    let plan = Plan::new(start.clone(), vec![step]);
    problem.verifier().verify(m, start, problem.goal(), &plan).map(|_| ()).map_err(|refusal| refusal.to_string())
}

#[test]
fn the_judge_finds_what_is_wrong_with_a_step() {
    assert_eq!(verdict(|_| ()), Ok(()));
    for until in [f64::NAN, 0.0, -1.0, 1.5, f64::INFINITY] {
        let why = verdict(|step| step.until = until).unwrap_err();
        assert!(why.contains("must end in (0, 1]"), "{until}: {why}");
    }
    let problem = small().puck_goal(0, [1.0, 1.0]).problem().unwrap();
    let start = problem.start();
    let swap = |to: State<World>| verdict(|step| step.instance = robot_instance(start, &to).into()).unwrap_err();
    let through_puck = swap(State { robot: [1.3, 1.0], ..start.clone() });
    assert!(through_puck.starts_with("step 1 at 0.2") && through_puck.contains("robot and red"), "{through_puck}");
    let outside = swap(State { robot: [0.5, 1.9], ..start.clone() });
    assert!(outside.contains("edge of the floor"), "{outside}");
    let mut moved = start.clone();
    moved.objects[0] = [1.5, 0.5];
    let stray = swap(State { robot: [0.5, 0.5], ..moved });
    assert!(stray.contains("red moves, but the step does not move it"), "{stray}");
    let jump = State { robot: [0.6, 1.0], ..start.clone() };
    let elsewhere = verdict(|step| step.instance = robot_instance(&jump, start).into()).unwrap_err();
    assert!(elsewhere.contains("it starts at"), "{elsewhere}");
}

#[test]
fn the_judge_sees_a_puck_that_moves_by_itself() {
    let problem = small().puck_goal(0, [2.0, 1.0]).problem().unwrap();
    let (m, start) = (problem.domain(), problem.start());
    let mut end = start.clone();
    end.objects[0] = [2.0, 1.0];
    let mut instance = robot_instance(start, &end);
    instance.moves = instance.moves.with(darrt_core::state::ComponentId::Object(super::support::id(0)));
    let plan = Plan::new(start.clone(), vec![Step { instance: instance.into(), until: 1.0, primitive: 0 }]);
    let why = Judge::new(Vec::new()).verify(m, start, problem.goal(), &plan).unwrap_err();
    assert_eq!(why.reason, "red moves without being touched by the robot");
}

#[test]
fn the_replay_refuses_a_wrong_start_and_a_wrong_end() {
    let problem = small().puck_goal(0, [2.0, 1.0]).problem().unwrap();
    let (m, start) = (problem.domain(), problem.start());
    let replay = Replay::new(AlwaysValid, 0.01);
    let other = State { robot: [0.6, 1.0], ..start.clone() };
    let why = replay.verify(m, start, problem.goal(), &Plan::new(other, Vec::new())).unwrap_err();
    assert_eq!(why.to_string(), "the plan does not start at the start of the problem");
    let why = replay.verify(m, start, problem.goal(), &Plan::new(start.clone(), Vec::new())).unwrap_err();
    assert_eq!(why.to_string(), "the plan does not end in the goal");
    let nowhere = Reach::new(PartialState::anywhere(m));
    assert!(replay.verify(m, start, &nowhere, &Plan::new(start.clone(), Vec::new())).is_ok());
}
