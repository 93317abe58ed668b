//! A plan that was found takes less time, and stays a plan.

use darrt_core::budget::{Interrupt, Stop};
use darrt_core::cost::{ExecutionCost, TravelCost, plan_seconds};
use darrt_core::domain::Domain;
use darrt_core::extend::{ExtendOptions, Extender};
use darrt_core::improve::{ImproveOptions, Improvement, improve};
use darrt_core::laws::check_planner;
use darrt_core::motion::Instance;
use darrt_core::observe::Silent;
use darrt_core::partial::PartialState;
use darrt_core::plan::{Plan, Step};
use darrt_core::problem::Problem;
use darrt_core::search::Strategy;
use darrt_core::solve::{SolveOptions, solve};
use darrt_core::space::ComponentSpace;
use darrt_core::state::State;
use darrt_core::testing::puck::{Setup, paper_strategy, problems};
use darrt_core::testing::strategies::{config, seeds};
use proptest::prelude::*;
use rand::{Rng, RngExt};

use super::support::{World, id, options, rng};

const EXTEND: ExtendOptions = ExtendOptions { spacing_m: 0.1, max_depth: 20, defer: false, step_m: None };

fn improvement(draws_per_step: usize, shortcuts_per_step: usize) -> Improvement<World> {
    let options =
        ImproveOptions { draws_per_step, draws_per_iteration: 0.5, shortcuts_per_step, ..ImproveOptions::default() };
    Improvement { cost: Box::new(TravelCost::default()), options }
}

fn extender(problem: &Problem<World>) -> Extender<'_, World> {
    Extender { problem, options: &EXTEND, local_repair: None, interrupt: Interrupt::NEVER }
}

fn seconds(problem: &Problem<World>, plan: &Plan<World>) -> f64 {
    plan_seconds(&TravelCost::default(), problem.domain(), plan)
}

fn improved(problem: &Problem<World>, plan: &Plan<World>, with: &Improvement<World>, seed: u64) -> Plan<World> {
    let improved = || improve(&extender(problem), with, &[plan], 20, &mut rng(seed)).unwrap();
    let new = improved();
    assert_eq!(format!("{:?}", improved()), format!("{new:?}"), "same numbers, same plan");
    let m = problem.domain();
    assert_eq!(problem.verifier().verify(m, problem.start(), problem.goal(), &new).err(), None);
    new
}

#[test]
fn found_plans_never_take_longer_and_often_less() {
    let ready = [problems::two_pucks, problems::wall_with_gap, problems::graspable, problems::four_pucks]
        .map(|make| make().unwrap());
    let mut runner = proptest::test_runner::TestRunner::new(config(24, None));
    let gains = std::cell::RefCell::new([0_u32; 2]);
    let cases = (seeds(), 0..ready.len(), 0..6_usize, 0..4_usize);
    runner
        .run(&cases, |(seed, which, draws, shortcuts)| {
            let problem = &ready[which];
            let outcome = solve(problem, &paper_strategy().unwrap(), &options(seed, 5000), &mut Silent);
            let plan = outcome.solution.unwrap().plan().clone();
            let new = improved(problem, &plan, &improvement(draws, shortcuts), seed);
            let (before, after) = (seconds(problem, &plan), seconds(problem, &new));
            prop_assert!(after <= before + 1e-9, "{before} s before, {after} s after");
            let mut gains = gains.borrow_mut();
            gains[0] += 1;
            gains[1] += u32::from(after < 0.95 * before);
            Ok(())
        })
        .unwrap();
    let [runs, less] = gains.into_inner();
    assert!(8 * less > runs, "of {runs} plans {less} take less time");
}

/// Travel, and as much as a push of 3 m where the robot comes from farther than 0.3 m to a puck that it must hit well.
struct NearBy;

impl ExecutionCost<World> for NearBy {
    fn seconds(&self, m: &World, instance: &Instance<World>, from: &State<World>, until: f64) -> f64 {
        TravelCost::default().seconds(m, instance, from, until)
    }

    fn arrival(&self, m: &World, last: &State<World>, entry: &State<World>, _: &State<World>) -> f64 {
        if m.robot().distance(&last.robot, &entry.robot) > 0.3 { 3.0 } else { 0.0 }
    }

    fn stopover(
        &self,
        m: &World,
        from: &State<World>,
        to: &State<World>,
        rng: &mut dyn Rng,
    ) -> Option<PartialState<World>> {
        let index = (0..to.objects.len()).find(|index| from.objects[*index] != to.objects[*index])?;
        let [x, y] = to.objects[index];
        let beside = [x + rng.random_range(-0.5..0.5), y + rng.random_range(-0.5..0.5)];
        Some(PartialState::anywhere(m).with_object(id(index), beside))
    }
}

/// What arriving costs is part of what a plan costs, and of what is saved.
#[test]
fn plans_are_improved_in_what_arriving_costs_too() {
    let ready = [problems::two_pucks, problems::four_pucks].map(|make| make().unwrap());
    let cheap = |cost: fn() -> Box<dyn ExecutionCost<World>>| Improvement { cost: cost(), ..improvement(6, 2) };
    let mut arrivals_s = [0.0; 2];
    for (seed, problem) in (0..6).flat_map(|seed| ready.iter().map(move |problem| (seed, problem))) {
        let m = problem.domain();
        let outcome = solve(problem, &paper_strategy().unwrap(), &options(seed, 5000), &mut Silent);
        let plan = outcome.solution.unwrap().plan().clone();
        let careful = improved(problem, &plan, &cheap(|| Box::new(NearBy)), seed);
        let fast = improved(problem, &plan, &cheap(|| Box::new(TravelCost::default())), seed);
        assert!(plan_seconds(&NearBy, m, &careful) <= plan_seconds(&NearBy, m, &plan) + 1e-9);
        for (sum_s, plan) in arrivals_s.iter_mut().zip([&careful, &fast]) {
            *sum_s += plan_seconds(&NearBy, m, plan) - seconds(problem, plan);
        }
    }
    assert!(arrivals_s[0] < arrivals_s[1], "{arrivals_s:?}");
}

/// Manipulations that lead nowhere are left out by draws alone.
#[test]
fn a_puck_that_nobody_asks_for_is_not_pushed() {
    let floor = Setup::new([4.0, 3.0], 0.15).robot_at([0.5, 1.5]).puck("red", 0.12, [1.2, 1.5]);
    let floor = floor.puck("blue", 0.12, [1.5, 0.5]).puck_goal(1, [3.0, 0.5]);
    let problem = floor.problem().unwrap();
    let m = problem.domain();
    let puck = |index, at| PartialState::anywhere(m).with_object(id(index), at);
    let (mut here, mut steps) = (problem.start().clone(), Vec::new());
    for target in [puck(0, [2.0, 1.5]), puck(1, [2.0, 0.5]), puck(1, [3.0, 0.5])] {
        let extension = extender(&problem).extend(&here, &target, &mut rng(0));
        here = extension.reached.last().unwrap().state.clone();
        for r in extension.reached {
            match steps.last_mut().filter(|last: &&mut Step<_>| std::sync::Arc::ptr_eq(&last.instance, &r.instance)) {
                Some(last) => last.until = r.t,
                None => steps.push(Step { instance: r.instance, until: r.t, primitive: r.primitive }),
            }
        }
    }
    let plan = Plan::new(problem.start().clone(), steps);
    assert!(problem.verifier().verify(m, problem.start(), problem.goal(), &plan).is_ok());
    let new = improved(&problem, &plan, &improvement(4, 0), 1);
    let labels: Vec<_> = new.steps().iter().map(|step| step.instance.primitive.name()).collect();
    assert_eq!(labels, ["Transit", "Push"]);
}

#[test]
fn no_plan_when_nobody_waits() {
    let problem = problems::two_pucks().unwrap();
    let plan = solve(&problem, &paper_strategy().unwrap(), &options(0, 5000), &mut Silent).solution.unwrap();
    let try_it = |stop| {
        let ask = move || stop;
        let extender = Extender { interrupt: Interrupt::new(&ask), ..extender(&problem) };
        improve(&extender, &improvement(4, 4), &[plan.plan()], 9, &mut rng(0))
    };
    assert!(try_it(Some(Stop::Cancelled)).is_none());
    // When time is up what is known is still judged.
    assert!(try_it(Some(Stop::TimeLimit)).is_some() && try_it(None).is_some());
    assert!(improve(&extender(&problem), &improvement(4, 4), &[], 9, &mut rng(0)).is_none());
}

/// The laws of planners, and the same plan on any number of threads.
#[test]
fn a_planner_that_improves_is_a_planner() {
    for defer in [false, true] {
        let paper = paper_strategy().unwrap();
        let strategy =
            Strategy { extend: ExtendOptions { defer, ..EXTEND }, improve: Some(improvement(4, 2)), ..paper };
        check_planner(&problems::wall_with_gap().unwrap(), &strategy, &options(2, 60)).unwrap();
        for (seed, problem) in [problems::graspable().unwrap(), problems::two_pucks().unwrap()].iter().enumerate() {
            let planned = |threads| {
                let short = SolveOptions { restart_iterations: Some(30), threads, ..options(seed as u64, 5000) };
                let solution = solve(problem, &strategy, &short, &mut Silent).solution.unwrap();
                assert!(solution.found().is_some());
                format!("{:?}", solution.plan())
            };
            assert_eq!(planned(1), planned(3));
        }
    }
}

#[test]
fn plans_of_further_trees_make_better_plans_and_the_search_no_longer() {
    let problem = problems::four_pucks().unwrap();
    let planned = |further_trees, seed| {
        // Nothing is drawn anew, which would make good what one tree missed.
        let with = improvement(0, 0);
        let options = ImproveOptions { further_trees, draws_per_iteration: 0.0, ..with.options };
        let strategy = Strategy { improve: Some(Improvement { options, ..with }), ..paper_strategy().unwrap() };
        let outcome = solve(&problem, &strategy, &self::options(seed, 5000), &mut Silent);
        (seconds(&problem, outcome.solution.unwrap().plan()), outcome.iterations)
    };
    let mut took_s = [0.0; 2];
    for seed in 0..12 {
        let ((alone_s, iterations), (beside_s, again)) = (planned(0, seed), planned(6, seed));
        assert_eq!(iterations, again, "the search is the same");
        assert_eq!(planned(6, seed).0.to_bits(), beside_s.to_bits(), "same seed, same plan");
        took_s[0] += alone_s;
        took_s[1] += beside_s;
    }
    assert!(took_s[1] < 0.97 * took_s[0], "{took_s:?}");
}
