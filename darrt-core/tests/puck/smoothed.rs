//! A plan that was found travels less, and stays a plan.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use darrt_core::budget::{Interrupt, Stop};
use darrt_core::cost::TravelCost;
use darrt_core::extend::{ExtendOptions, Extender};
use darrt_core::goal::Goal;
use darrt_core::improve::{ImproveOptions, Improvement};
use darrt_core::laws::check_planner;
use darrt_core::laws::motion::{MotionClaims, check_instance, check_motion};
use darrt_core::motion::{Motion, Section, Spliced};
use darrt_core::observe::Silent;
use darrt_core::partial::PartialState;
use darrt_core::plan::{Plan, Step};
use darrt_core::problem::Problem;
use darrt_core::search::Strategy;
use darrt_core::shorten::ShortenOptions;
use darrt_core::smooth::smooth;
use darrt_core::solve::solve;
use darrt_core::state::State;
use darrt_core::testing::puck::{Point, Setup, paper_strategy, problems};
use darrt_core::testing::strategies::{config, seeds};
use darrt_core::verify::{Refusal, Verified, Verifier};
use proptest::prelude::*;

use super::support::{World, id, options, rng, small};

const DEFER: ExtendOptions = ExtendOptions { spacing_m: 0.1, max_depth: 20, defer: true, step_m: None };
const EAGER: ExtendOptions = ExtendOptions { defer: false, ..DEFER };

/// A second for every metre, and hardly anything for a step: so of two plans of one length that with fewer steps is better.
fn cost() -> TravelCost {
    TravelCost::new(1.0, 1e-7).unwrap()
}

fn extender<'a>(problem: &'a Problem<World>, options: &'a ExtendOptions) -> Extender<'a, World> {
    Extender { problem, options, local_repair: None, interrupt: Interrupt::NEVER }
}

/// The plan that goes from target to target.
fn by_hand(problem: &Problem<World>, targets: &[PartialState<World>]) -> Plan<World> {
    let (m, mut here, mut steps) = (problem.domain(), problem.start().clone(), Vec::new());
    for target in targets {
        let extension = extender(problem, &DEFER).extend(&here, target, &mut rng(0));
        assert!(extension.is_met, "{target:?}");
        here = extension.reached.last().unwrap().state.clone();
        steps.extend(extension.reached.into_iter().map(|r| Step {
            instance: r.instance,
            until: r.t,
            primitive: r.primitive,
        }));
    }
    let plan = Plan::new(problem.start().clone(), steps);
    problem.verifier().verify(m, problem.start(), problem.goal(), &plan).unwrap();
    plan
}

fn puck(m: &World, index: usize, at: Point) -> PartialState<World> {
    PartialState::anywhere(m).with_object(id(index), at)
}

fn robot(m: &World, at: Point) -> PartialState<World> {
    PartialState::anywhere(m).with_robot(m, at)
}

/// What every smoother plan must be.
fn check(problem: &Problem<World>, old: &Plan<World>, new: &Plan<World>) {
    let m = problem.domain();
    assert_eq!(problem.verifier().verify(m, problem.start(), problem.goal(), new).err(), None);
    let (steps, new_steps) = (old.steps().len(), new.steps().len());
    assert!(new_steps <= steps && new.length() <= old.length() + 1e-6, "{new:?} after {old:?}");
    assert!(new_steps < steps || new.length() < old.length());
    let mut here = problem.start().clone();
    for step in new.steps() {
        check_instance(m, &step.instance, &here, &[0.1, 0.35, 0.5, 0.8], &MotionClaims::default()).unwrap();
        let free = problem.validity().free_prefix(m, &step.instance, &here);
        assert!(free.fraction >= step.until, "{:?}", free.blame);
        here = step.instance.at(m, step.until, &here);
    }
}

fn smoothed(problem: &Problem<World>, plan: &Plan<World>, attempts: usize) -> Plan<World> {
    let [eager, defer] = [EAGER, DEFER].map(|extend| {
        let smoothed = |seed| smooth(&extender(problem, &extend), &cost(), plan, attempts, &mut rng(seed));
        let new = smoothed(1).unwrap();
        check(problem, plan, &new);
        assert_eq!(format!("{:?}", smoothed(1)), format!("{:?}", Some(&new)), "same seed, same plan");
        new
    });
    let both = [&eager, &defer].map(|plan| plan.steps().len());
    assert_eq!(both[0], both[1]);
    eager
}

fn labels(plan: &Plan<World>) -> Vec<&'static str> {
    plan.steps().iter().map(|step| step.instance.primitive.name()).collect()
}

#[test]
fn what_ends_where_it_began_is_left_out_without_an_attempt() {
    let floor = Setup::new([4.0, 3.0], 0.15).robot_at([0.5, 1.5]).puck("red", 0.12, [1.2, 1.5]);
    let problem = floor.puck_goal(0, [3.0, 1.5]).problem().unwrap();
    let m = problem.domain();
    let (there, back) = (robot(m, [0.5, 2.5]), robot(m, [0.5, 1.5]));
    let straight = by_hand(&problem, &[puck(m, 0, [3.0, 1.5])]);
    let roundabout = by_hand(&problem, &[there, back, puck(m, 0, [3.0, 1.5])]);
    assert_eq!(labels(&roundabout).len(), labels(&straight).len() + 2);
    assert_eq!(labels(&smoothed(&problem, &roundabout, 0)), labels(&straight));
    let nothing = smooth(&extender(&problem, &EAGER), &cost(), &straight, 0, &mut rng(1));
    assert!(nothing.is_none(), "{nothing:?}");
}

#[test]
fn a_puck_is_not_pushed_to_and_fro() {
    // The blue one is pushed before, the green one afterwards; the red one comes back to where it was.
    let floor = Setup::new([4.0, 3.0], 0.15).robot_at([0.5, 1.5]).puck("red", 0.12, [1.2, 1.5]);
    let floor = floor.puck("blue", 0.12, [1.5, 0.5]).puck("green", 0.12, [1.5, 2.5]);
    let problem = floor.puck_goal(1, [3.0, 0.5]).puck_goal(2, [3.0, 2.5]).problem().unwrap();
    let m = problem.domain();
    let (away, back) = (puck(m, 0, [2.0, 1.5]), puck(m, 0, [1.2, 1.5]));
    let clear = robot(m, [2.2, 1.5]);
    let plan = by_hand(&problem, &[puck(m, 1, [3.0, 0.5]), away, back, clear, puck(m, 2, [3.0, 2.5])]);
    assert_eq!(plan.steps().len(), 9);
    let new = smoothed(&problem, &plan, 60);
    assert_eq!(labels(&new), ["Transit", "Push"].repeat(2));
    let red = (0..4).filter_map(|step| new.at(m, step, 1.0)?.object(id(0)).copied());
    assert!(red.into_iter().all(|at| at == [1.2, 1.5]));
}

#[test]
fn a_puck_goes_straight_where_it_went_astray() {
    let problem = small().puck_goal(0, [2.4, 1.0]).robot_goal([0.5, 0.3]).problem().unwrap();
    let m = problem.domain();
    let plan = by_hand(&problem, &[puck(m, 0, [1.6, 1.5]), puck(m, 0, [2.4, 1.0]), robot(m, [0.5, 0.3])]);
    assert_eq!(labels(&smoothed(&problem, &plan, 60)), ["Transit", "Push", "Transit"]);
}

#[test]
fn moves_of_one_kind_become_one_and_detours_go() {
    let problem = small().robot_goal([0.5, 0.4]).problem().unwrap();
    let m = problem.domain();
    let stops = [[0.5, 1.7], [1.5, 1.7], [2.0, 0.4], [0.5, 0.4]];
    let plan = by_hand(&problem, &stops.map(|at| robot(m, at)));
    let new = smoothed(&problem, &plan, 5);
    assert_eq!(new.steps().len(), 1);
    assert!((new.length() - 0.6).abs() < 1e-9, "{}", new.length());
}

/// Once around a wall as far as one can: one step that is as short as it gets.
#[test]
fn a_corner_is_cut_but_not_the_wall() {
    let floor = Setup::new([3.0, 3.0], 0.15).robot_at([0.5, 0.5]).puck("red", 0.12, [2.5, 2.5]);
    let problem = floor.wall("wall", [1.4, 0.0], [1.6, 1.5]).robot_goal([2.5, 0.5]).problem().unwrap();
    let m = problem.domain();
    let plan = by_hand(&problem, &[[0.5, 2.6], [2.1, 2.6], [2.5, 0.5]].map(|at| robot(m, at)));
    let new = smoothed(&problem, &plan, 400);
    assert_eq!(labels(&new), ["Transit"]);
    // From the start to a radius above the two corners, and on to the goal; that is a little too near.
    let shortest_m = 2.0 * (0.9_f64.hypot(1.15)) + 0.2;
    assert!(new.length() > shortest_m && new.length() < shortest_m + 0.35, "{} {shortest_m}", new.length());
}

#[test]
fn what_is_carried_is_not_carried_to_and_fro() {
    let floor = Setup::new([3.0, 2.0], 0.15).robot_at([0.5, 1.0]).graspable_puck("red", 0.12, [1.0, 1.0]);
    let problem = floor.puck_goal(0, [2.4, 1.0]).problem().unwrap();
    let m = problem.domain();
    // What grabs the puck sets it down where it should be, so it is grabbed by hand.
    let picks = |seed| {
        let reached =
            extender(&problem, &DEFER).extend(problem.start(), &puck(m, 0, [2.4, 1.0]), &mut rng(seed)).reached;
        (reached.iter().map(|r| r.instance.primitive.name()).collect::<Vec<_>>()
            == ["Transit", "Pick", "Carry", "Place"])
        .then_some(reached)
    };
    let reached = (0..).find_map(picks).unwrap();
    let mut steps: Vec<_> = (reached.into_iter().take(2))
        .map(|r| Step { instance: r.instance, until: r.t, primitive: r.primitive })
        .collect();
    let mut here = steps[1].instance.at(m, 1.0, problem.start());
    for target in [robot(m, [1.5, 0.4]), robot(m, [1.2, 1.6]), robot(m, [2.0, 1.4]), puck(m, 0, [2.4, 1.0])] {
        // It may also let go of the puck.
        let carries = |seed| {
            let reached = extender(&problem, &DEFER).extend(&here, &target, &mut rng(seed)).reached;
            reached.first().is_some_and(|first| first.instance.primitive.name() == "Carry").then_some(reached)
        };
        let reached = (0..).find_map(carries).unwrap();
        here = reached.last().unwrap().state.clone();
        steps.extend(reached.into_iter().map(|r| Step { instance: r.instance, until: r.t, primitive: r.primitive }));
    }
    let plan = Plan::new(problem.start().clone(), steps);
    assert_eq!(labels(&plan), ["Transit", "Pick", "Carry", "Carry", "Carry", "Carry", "Place"]);
    for attempts in [1, 2, 3, 60] {
        let extender = extender(&problem, &EAGER);
        if let Some(new) = smooth(&extender, &cost(), &plan, attempts, &mut rng(3)) {
            check(&problem, &plan, &new);
        }
    }
    assert!(smoothed(&problem, &plan, 200).steps().len() <= 4);
    // Within the transfer alone: what comes behind is another matter.
    let held = Plan::new(problem.start().clone(), plan.steps()[..5].to_vec());
    let new = smooth(&extender(&problem, &EAGER), &cost(), &held, 100, &mut rng(0)).unwrap();
    assert_eq!(labels(&new), ["Transit", "Pick", "Carry"]);
    assert_eq!(new.end(m), held.end(m));
}

#[test]
fn no_effort_no_plan_and_none_when_nobody_waits() {
    let problem = small().robot_goal([0.5, 0.4]).problem().unwrap();
    let m = problem.domain();
    let plan = by_hand(&problem, &[robot(m, [0.5, 1.7]), robot(m, [0.5, 0.4])]);
    let try_it = |attempts, interrupt| {
        let extender = Extender { interrupt, ..extender(&problem, &EAGER) };
        smooth(&extender, &cost(), &plan, attempts, &mut rng(0))
    };
    assert!(try_it(0, Interrupt::NEVER).is_none() && try_it(1, Interrupt::NEVER).is_some());
    assert!(try_it(9, Interrupt::new(&|| Some(Stop::TimeLimit))).is_none());
    let empty = Plan::new(problem.start().clone(), Vec::new());
    assert!(smooth(&extender(&problem, &EAGER), &cost(), &empty, 3, &mut rng(0)).is_none());
}

fn smoothing(extend: ExtendOptions, attempts: usize) -> Strategy<World> {
    let extensions = if extend.defer { 50 } else { 0 };
    let options = ImproveOptions {
        further_trees: 0,
        draws_per_step: 0,
        draws_per_iteration: 0.0,
        shortcuts_per_step: attempts,
        ..ImproveOptions::default()
    };
    let improve = (attempts > 0).then(|| Improvement { cost: Box::new(cost()), options });
    Strategy { extend, shorten: ShortenOptions { extensions }, improve, ..paper_strategy().unwrap() }
}

#[test]
fn found_plans_get_smoother_and_stay_right() {
    let ready = [problems::two_pucks, problems::wall_with_gap, problems::graspable, problems::four_pucks]
        .map(|make| make().unwrap());
    let mut runner = proptest::test_runner::TestRunner::new(config(24, None));
    let gains = std::cell::RefCell::new([0_u32; 3]);
    let cases = (seeds(), 0..ready.len(), any::<bool>(), 1..80_usize);
    runner
        .run(&cases, |(seed, which, defer, attempts)| {
            let (problem, extend) = (&ready[which], if defer { DEFER } else { EAGER });
            let outcome = solve(problem, &smoothing(extend, 0), &options(seed, 5000), &mut Silent);
            let plan = outcome.solution.unwrap().plan().clone();
            let smoothed = || smooth(&extender(problem, &extend), &cost(), &plan, attempts, &mut rng(seed));
            let new = smoothed();
            prop_assert_eq!(format!("{:?}", smoothed()), format!("{:?}", &new));
            let mut gains = gains.borrow_mut();
            gains[0] += 1;
            if let Some(new) = new {
                check(problem, &plan, &new);
                gains[1] += u32::from(new.length() < 0.99 * plan.length());
                gains[2] += u32::from(new.steps().len() < plan.steps().len());
            }
            Ok(())
        })
        .unwrap();
    let [runs, less, fewer] = gains.into_inner();
    assert!(less > 0 && fewer > 0, "of {runs} plans {less} travel less, {fewer} have fewer steps");
}

#[test]
fn the_planner_smooths_what_it_finds() {
    for extend in [EAGER, DEFER] {
        let problem = problems::two_pucks().unwrap();
        let length = |attempts, seed| {
            let outcome = solve(&problem, &smoothing(extend, attempts), &options(seed, 5000), &mut Silent);
            let plan = outcome.solution.unwrap().plan().clone();
            (plan.length(), outcome.iterations)
        };
        for seed in 0..4 {
            let (rough, smooth) = (length(0, seed), length(20, seed));
            assert!(smooth.0 < rough.0 && smooth.1 == rough.1, "{rough:?} {smooth:?}");
        }
        check_planner(&problems::wall_with_gap().unwrap(), &smoothing(extend, 20), &options(2, 60)).unwrap();
    }
}

/// Refuses the first plan it is shown, and accepts all others.
struct NotTheFirst(AtomicU64);

impl Verifier<World> for NotTheFirst {
    fn verify(&self, _: &World, _: &State<World>, _: &dyn Goal<World>, _: &Plan<World>) -> Result<Verified, Refusal> {
        match self.0.fetch_add(1, Ordering::SeqCst) {
            0 => Err(Refusal { step: None, at: 0.0, reason: "the first".to_owned() }),
            _ => Ok(Verified::default()),
        }
    }
}

#[test]
fn a_smoother_plan_that_is_refused_costs_nothing() {
    let setup = || small().puck_goal(0, [2.0, 1.3]).robot_goal([0.5, 0.3]);
    let mut parts = setup().parts().unwrap();
    parts.verifier = Box::new(NotTheFirst(AtomicU64::new(0)));
    let refusing = Problem::new(parts).unwrap();
    let outcome = |problem: &Problem<World>, attempts| {
        let outcome = solve(problem, &smoothing(EAGER, attempts), &options(3, 5000), &mut Silent);
        assert_eq!(outcome.accounts.refused, 0);
        outcome.solution.unwrap()
    };
    let problem = setup().problem().unwrap();
    let (rough, smooth) = (outcome(&problem, 0), outcome(&problem, 20));
    assert!(smooth.plan().length() < rough.plan().length());
    assert_eq!(format!("{:?}", smooth.found()), format!("{:?}", Some(rough.plan())));
    let refused = outcome(&refusing, 20);
    assert_eq!(format!("{:?}", refused.plan()), format!("{:?}", rough.plan()));
    assert!(refused.found().is_none() && rough.found().is_none());
}

#[test]
fn parts_of_instances_are_one_motion() {
    let problem = small().robot_goal([2.0, 0.4]).problem().unwrap();
    let m = problem.domain();
    let plan = by_hand(&problem, &[robot(m, [0.5, 1.7]), robot(m, [1.5, 1.7]), robot(m, [2.0, 0.4])]);
    let section = |step: usize, from, to| Section { instance: Arc::clone(&plan.steps()[step].instance), from, to };
    let motion = Spliced::new(vec![section(0, 0.25, 1.0), section(1, 0.0, 1.0), section(2, 0.0, 0.5)]).unwrap();
    let from = plan.at(m, 0, 0.25).unwrap();
    check_motion(m, &motion, &from, &[0.01, 0.2, 0.3, 0.5, 0.7, 0.99], &MotionClaims::default()).unwrap();
    assert!(motion.knots().windows(2).all(|pair| pair[0] <= pair[1]) && motion.knots().len() >= 3);
    let corners = [plan.at(m, 0, 1.0), plan.at(m, 1, 1.0)].map(Option::unwrap);
    for corner in corners {
        let mut here = from.clone();
        let nearest = motion.knots().iter().any(|knot| {
            motion.at_into(m, *knot, &mut here);
            (here.robot[0] - corner.robot[0]).hypot(here.robot[1] - corner.robot[1]) < 1e-9
        });
        assert!(nearest, "{corner:?} is a corner");
    }
    for wrong in [vec![], vec![section(0, 0.5, 0.5)], vec![section(0, -0.1, 1.0)], vec![section(0, 0.0, 1.1)]] {
        assert!(Spliced::new(wrong).is_none());
    }
    assert!(Spliced::new(vec![section(0, f64::NAN, 1.0)]).is_none());
}
