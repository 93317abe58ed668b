//! The variants of sampling, distance, extension and search solve the puck problems, and keep the laws of the planner.
#![cfg(feature = "testing")]
#![allow(clippy::unwrap_used, reason = "a test says no more than that it failed")]

use darrt_core::budget::{Budget, Stop};
use darrt_core::cost::{TravelCost, plan_seconds};
use darrt_core::distance::Distance;
use darrt_core::domain::Domain;
use darrt_core::extend::{ExtendOptions, Extender, extend_towards};
use darrt_core::improve::{ImproveOptions, Improvement};
use darrt_core::laws::planner::{check_accounts, check_cancel};
use darrt_core::laws::{MotionClaims, check_distance, check_motion, check_planner};
use darrt_core::motion::{Instance, Motion, Reversed};
use darrt_core::observe::{Observer, Silent};
use darrt_core::partial::PartialState;
use darrt_core::problem::Problem;
use darrt_core::random::{Purpose, stream};
use darrt_core::sample::{GoalBiased, Placed, RobotOrObjects, Sampler};
use darrt_core::search::{Algorithm, Strategy};
use darrt_core::solve::{Cost, Member, Outcome, SolveOptions, Until, solve, solve_with};
use darrt_core::space::{ComponentSpace, Place};
use darrt_core::state::{ComponentSet, ObjectId, State};
use darrt_core::testing::puck::{
    Carry, Clearance, Obstacle, Outline, Pick, Place as PlaceDown, PuckWorld, Push, Setup, Transit, paper_strategy,
    problems,
};
use darrt_core::testing::strategies::{config, states, targets};
use darrt_core::validity::{Blame, FreePrefix, Validity};
use darrt_core::variants::{ApproachVisit, Frontier, Weighted};
use proptest::prelude::*;

fn options(seed: u64, iterations: u64) -> SolveOptions {
    let budget = Budget { iterations: Some(iterations), ..Budget::default() };
    SolveOptions { seed, budget, restart_iterations: Some(200), threads: 1 }
}

fn robot_or_objects() -> RobotOrObjects {
    RobotOrObjects::new(0.5, 0.0).unwrap()
}

/// The paper's strategy with another sampler.
fn sampling(sampler: impl Sampler<PuckWorld> + 'static) -> Strategy<PuckWorld> {
    Strategy { sampler: Box::new(GoalBiased::new(sampler, 0.2).unwrap()), ..paper_strategy().unwrap() }
}

/// The paper's strategy with another distance.
fn measuring(distance: impl Distance<PuckWorld> + 'static) -> Strategy<PuckWorld> {
    Strategy { distance: Box::new(distance), ..paper_strategy().unwrap() }
}

fn approach_visit() -> ApproachVisit<PuckWorld> {
    let primitives = vec![Box::new(Transit) as _, Box::new(Push) as _, Box::new(Pick) as _];
    ApproachVisit::new(primitives.into_iter().chain([Box::new(Carry) as _, Box::new(PlaceDown) as _]).collect())
}

fn variants() -> Vec<(&'static str, Strategy<PuckWorld>)> {
    let placed = |place, share| sampling(Placed::new(robot_or_objects(), place, share).unwrap());
    let step = ExtendOptions { step_m: Some(0.7), ..ExtendOptions::default() };
    vec![
        ("on support", placed(Place::OnSupport, 0.7)),
        ("support edge", placed(Place::SupportEdge, 0.3)),
        ("frontier", sampling(Frontier::new(robot_or_objects(), 0.3, 0.2).unwrap())),
        ("weighted sum", measuring(Weighted::sum(0.3, 1.0).unwrap())),
        ("maximum", measuring(Weighted::maximum(1.0, 1.0).unwrap())),
        ("approach visit", measuring(approach_visit())),
        ("bounded step", Strategy { extend: step, ..paper_strategy().unwrap() }),
    ]
}

#[test]
fn every_variant_of_a_part_solves_and_keeps_the_laws_of_the_planner() {
    for (name, strategy) in variants() {
        for (problem_name, make) in [("open", problems::open as fn() -> _), ("wall_with_gap", problems::wall_with_gap)]
        {
            let problem: Problem<PuckWorld> = make().unwrap();
            let outcome = solve(&problem, &strategy, &options(1, 4_000), &mut Silent);
            assert!(outcome.solution.is_some(), "{name} on {problem_name}: {:?}", outcome.stop);
            check_planner(&problem, &strategy, &options(2, 60)).unwrap();
        }
    }
}

fn run(problem: &Problem<PuckWorld>, algorithm: Algorithm, until: Until, options: &SolveOptions) -> Outcome<PuckWorld> {
    let strategy = paper_strategy().unwrap();
    solve_with(problem, &[Member { algorithm, strategy: &strategy }], until, options, &mut Silent)
}

/// What a plan does, bit for bit enough.
fn text(outcome: &Outcome<PuckWorld>) -> String {
    format!("{:?} {:?} {}", outcome.solution, outcome.accounts, outcome.iterations)
}

#[test]
fn every_search_solves_the_puck_problems_alike_on_any_number_of_threads() {
    for algorithm in Algorithm::ALL {
        for (name, make) in problems::ALL {
            let problem = make().unwrap();
            let outcome = run(&problem, algorithm, Until::Solved, &options(3, 6_000));
            let solution =
                outcome.solution.as_ref().unwrap_or_else(|| panic!("{algorithm} on {name}: {:?}", outcome.stop));
            check_accounts(&outcome.accounts, outcome.iterations, outcome.accounts.added).unwrap();
            let (m, plan) = (problem.domain(), solution.plan());
            problem.verifier().verify(m, problem.start(), problem.goal(), plan).unwrap();
            let two = SolveOptions { threads: 2, ..options(3, 6_000) };
            assert_eq!(text(&run(&problem, algorithm, Until::Solved, &two)), text(&outcome), "{algorithm} on {name}");
        }
    }
}

/// Rules of which it is not known what is the robot's.
struct Told(Clearance);

impl Validity<PuckWorld> for Told {
    fn check(&self, m: &PuckWorld, state: &State<PuckWorld>, contacts: &ComponentSet) -> Result<(), Blame> {
        self.0.check(m, state, contacts)
    }

    fn free_prefix(&self, m: &PuckWorld, instance: &Instance<PuckWorld>, from: &State<PuckWorld>) -> FreePrefix {
        self.0.free_prefix(m, instance, from)
    }
}

/// With rules that can be told apart the objects are planned first; without, a hierarchical search is the one that it is made of.
#[test]
fn a_hierarchical_search_needs_rules_that_can_be_told_apart() {
    let floor =
        Setup::new([4.0, 3.0], 0.15).robot_at([2.0, 0.5]).puck("red", 0.12, [1.0, 1.5]).puck("blue", 0.12, [3.0, 1.5]);
    let floor = floor.pillar("pillar", [2.0, 1.5], 0.2).puck_goal(0, [3.0, 2.4]).puck_goal(1, [1.0, 0.6]);
    let apart = floor.clone().problem().unwrap();
    let mut parts = floor.parts().unwrap();
    let pillar = Outline::Disc { centre: [2.0, 1.5], radius_m: 0.2 };
    parts.validity = Box::new(Told(Clearance::new(vec![Obstacle { name: "pillar".into(), outline: pillar }])));
    let told = Problem::new(parts).unwrap();
    let pairs = [(Algorithm::Hierarchical, Algorithm::Darrt), (Algorithm::HierarchicalConnect, Algorithm::Connect)];
    let run = |problem, algorithm| text(&run(problem, algorithm, Until::Solved, &options(2, 4_000)));
    for (hierarchical, plain) in pairs {
        assert_eq!(run(&told, hierarchical), run(&told, plain), "{hierarchical}");
        assert_ne!(run(&apart, hierarchical), run(&apart, plain), "{hierarchical}");
    }
    assert_ne!(run(&apart, Algorithm::Hierarchical), run(&apart, Algorithm::HierarchicalConnect));
}

#[test]
fn every_search_ends_when_it_is_cancelled() {
    let (problem, strategy) = (problems::four_pucks().unwrap(), paper_strategy().unwrap());
    for algorithm in Algorithm::ALL {
        for until in [Until::Solved, Until::BudgetEnds(Cost::Steps)] {
            let members = [Member { algorithm, strategy: &strategy }];
            let solver = |options: &SolveOptions, observer: &mut dyn Observer| {
                solve_with(&problem, &members, until, options, observer)
            };
            [1, 2].into_iter().try_for_each(|threads| check_cancel(&solver, &options(1, 200), threads)).unwrap();
        }
    }
}

#[test]
fn algorithms_go_by_name() {
    for algorithm in Algorithm::ALL {
        assert_eq!(Algorithm::from_name(algorithm.name()), Some(algorithm));
    }
    assert_eq!(Algorithm::from_name("dart"), None);
}

#[test]
fn anytime_never_returns_a_dearer_plan_for_more_budget() {
    let problem = problems::two_pucks().unwrap();
    for cost in [Cost::Steps, Cost::Travel] {
        let cost_of = |outcome: &Outcome<PuckWorld>| cost.of(outcome.solution.as_ref().unwrap().plan(), None);
        let first = run(&problem, Algorithm::Darrt, Until::Solved, &options(5, 4_000));
        let mut last = cost_of(&first);
        let mut improved = false;
        for iterations in [1_000, 2_000, 4_000] {
            let outcome = run(&problem, Algorithm::Darrt, Until::BudgetEnds(cost), &options(5, iterations));
            if outcome.solution.is_none() {
                continue;
            }
            assert_eq!(outcome.stop, Stop::Solved);
            let now = cost_of(&outcome);
            assert!(now <= last, "{now:?} after {last:?}");
            improved |= now < last;
            last = now;
            let two = SolveOptions { threads: 2, ..options(5, iterations) };
            assert_eq!(text(&run(&problem, Algorithm::Darrt, Until::BudgetEnds(cost), &two)), text(&outcome));
        }
        assert!(improved, "{cost:?}: no better plan than the first");
    }
}

/// The first member cannot solve it (it never extends far enough), the second can.
#[test]
fn a_portfolio_gives_every_member_its_turn() {
    let problem = problems::open().unwrap();
    let short = ExtendOptions { step_m: Some(1e-6), ..ExtendOptions::default() };
    let hopeless = Strategy { extend: short, ..paper_strategy().unwrap() };
    let good = paper_strategy().unwrap();
    let member = |algorithm, strategy| Member { algorithm, strategy };
    let members = [member(Algorithm::Darrt, &hopeless), member(Algorithm::Connect, &good)];
    let run = |members: &[Member<'_, PuckWorld>], threads| {
        let options = SolveOptions { threads, ..options(1, 2_000) };
        solve_with(&problem, members, Until::Solved, &options, &mut Silent)
    };
    assert!(run(&members[..1], 1).solution.is_none());
    let outcome = run(&members, 1);
    assert!(outcome.solution.is_some() && outcome.restarts % 2 == 1);
    assert_eq!(text(&run(&members, 2)), text(&outcome));
    assert!(run(&[], 1).solution.is_none());
}

#[test]
fn a_bounded_step_ends_after_its_travel() {
    let problem = problems::open().unwrap();
    let m = problem.domain();
    let to = PartialState::anywhere(m).with_object(ObjectId::new(0), [3.0, 2.0]);
    let extend = |step_m| {
        let options = ExtendOptions { step_m, ..ExtendOptions::default() };
        extend_towards(&problem, &options, problem.start(), &to, &mut stream(1, 0, 0, Purpose::Extend))
    };
    let whole = extend(None);
    assert!(whole.is_met);
    for step_m in [0.05, 0.3, 1.0, 100.0] {
        let extension = extend(Some(step_m));
        let mut travel_m = 0.0;
        for (i, reached) in extension.reached.iter().enumerate() {
            let next = extension.reached.get(i + 1);
            if next.is_none_or(|next| !std::sync::Arc::ptr_eq(&next.instance, &reached.instance)) {
                travel_m += reached.t * reached.instance.motion.length();
            }
        }
        let is_whole = step_m > 50.0;
        assert!(is_whole || (travel_m - step_m).abs() < 1e-9, "{travel_m} for {step_m}");
        assert_eq!((extension.is_met, extension.blame.is_some()), (is_whole, false));
    }
    for step_m in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(ExtendOptions { step_m: Some(step_m), ..ExtendOptions::default() }.check().is_err());
    }
}

/// Pushes are not reversible, transits are; the way back is a motion like any other.
#[test]
fn only_what_is_reversible_is_run_backwards() {
    let problem = problems::open().unwrap();
    let m = problem.domain();
    let to = PartialState::anywhere(m).with_object(ObjectId::new(0), [3.0, 2.0]);
    let strategy = paper_strategy().unwrap();
    let interrupt = darrt_core::budget::Interrupt::NEVER;
    let extender = Extender { problem: &problem, options: &strategy.extend, local_repair: None, interrupt };
    let reached = extender.extend(problem.start(), &to, &mut stream(1, 0, 0, Purpose::Extend)).reached;
    let (first, last) = (&reached[0].instance, &reached.last().unwrap().instance);
    assert!(first.reversible && !last.reversible);
    assert!(Reversed::instance(last, 1.0).is_none() && Reversed::instance(first, 0.0).is_none());
    for until in [1.0, 0.4] {
        let back = Reversed::new(std::sync::Arc::clone(first), until).unwrap();
        let from = first.at(m, until, problem.start());
        check_motion(m, &back, &from, &[0.1, 0.5, 0.9], &MotionClaims::default()).unwrap();
        let mut end = from.clone();
        back.at_into(m, 1.0, &mut end);
        assert_eq!(end, *problem.start());
        assert!(back.knots().windows(2).all(|pair| pair[0] <= pair[1]));
    }
}

#[test]
fn samples_at_an_edge_lie_there() {
    let problem = problems::open().unwrap();
    let m = problem.domain();
    let sampler = Placed::new(robot_or_objects(), Place::SupportEdge, 1.0).unwrap();
    let space = &m.objects()[0];
    let mut seen = 0;
    for i in 0..200 {
        let s = sampler.sample(m, problem.goal(), &mut stream(i, 0, 0, Purpose::Sample));
        let Some(at) = s.object(ObjectId::new(0)) else { continue };
        let near = |i: usize| {
            let (low, high) = (space.lower()[i], space.upper()[i]);
            (at[i] - low).min(high - at[i]) <= 0.1 * (high - low) + 1e-12
        };
        assert!(space.contains(at) && (near(0) || near(1)), "{at:?}");
        seen += 1;
    }
    assert!(seen > 50);
}

#[test]
fn the_way_to_the_contact_is_a_distance_and_not_below_the_greedy_tour() {
    use darrt_core::distance::GreedyVisit;
    let problem = problems::four_pucks().unwrap();
    let m = problem.domain();
    let s = states(m, problem.start().mode.clone());
    let distance = approach_visit();
    let mut longer = 0;
    proptest!(config(96, None), |(to in targets(m), here in s.clone(), there in s)| {
        check_distance(m, &distance, &here, &to, &there)?;
        darrt_core::laws::check_not_above(m, &GreedyVisit, &distance, &here, &to)?;
        let tree = darrt_core::laws::nearest::tree_of(m, &here, [there.clone(), here.clone()]);
        darrt_core::laws::check_nearest(m, &distance, &tree, &to)?;
    });
    let to = PartialState::anywhere(m)
        .with_object(ObjectId::new(0), m.objects()[0].sample(&mut stream(0, 0, 0, Purpose::Sample)));
    longer +=
        u32::from(distance.distance(m, problem.start(), &to) > GreedyVisit.distance(m, problem.start(), &to) + 0.01);
    assert_eq!(longer, 1, "the contact is on the far side");
}

#[test]
fn improvement_changes_the_plan_and_not_the_search() {
    let problem = problems::two_pucks().unwrap();
    for algorithm in Algorithm::ALL {
        let planned = |draws_per_step| {
            let effort = ImproveOptions {
                draws_per_step,
                draws_per_iteration: 1.0,
                shortcuts_per_step: 4,
                ..ImproveOptions::default()
            };
            let improve =
                (draws_per_step > 0).then(|| Improvement { cost: Box::new(TravelCost::default()), options: effort });
            let strategy = Strategy { improve, ..paper_strategy().unwrap() };
            let members = [Member { algorithm, strategy: &strategy }];
            solve_with(&problem, &members, Until::Solved, &options(3, 20_000), &mut Silent)
        };
        let (plain, better) = (planned(0), planned(4));
        assert_eq!(better.iterations, plain.iterations, "{algorithm:?}");
        let seconds = |outcome: &Outcome<PuckWorld>| {
            plan_seconds(&TravelCost::default(), problem.domain(), outcome.solution.as_ref().unwrap().plan())
        };
        assert!(seconds(&better) <= seconds(&plain) + 1e-9, "{algorithm:?}");
    }
}
