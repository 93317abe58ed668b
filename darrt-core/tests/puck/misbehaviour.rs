//! Attempts to make the planner hang, panic or lie.

use darrt_core::budget::Stop;
use darrt_core::distance::{Distance, Euclidean, ExactTour, GreedyVisit};
use darrt_core::domain::Domain;
use darrt_core::extend::ExtendOptions;
use darrt_core::goal::{AnyOf, Goal, Region};
use darrt_core::motion::{Motion, Straight, Waypoints};
use darrt_core::observe::Silent;
use darrt_core::partial::PartialState;
use darrt_core::problem::Problem;
use darrt_core::sample::{Full, RandomSubset, Sampler};
use darrt_core::search::{Darrt, Strategy};
use darrt_core::solve::{SolveOptions, solve};
use darrt_core::space::ComponentSpace;
use darrt_core::state::State;
use darrt_core::testing::puck::{Setup, problems};
use rand::{Rng, RngExt};

use super::support::{World, greedy, id, options, robot_or_objects, run, small, strategy};

/// Every other target is not a number somewhere, or far outside.
struct Poison;

impl Sampler<World> for Poison {
    fn sample(&self, m: &World, goal: &dyn Goal<World>, rng: &mut dyn Rng) -> PartialState<World> {
        let s = RandomSubset.sample(m, goal, rng);
        match rng.random_range(0..6) {
            0 => s.with_robot(m, [f64::NAN, 1.0]),
            1 => s.with_object(id(0), [1.0, f64::NAN]),
            2 => s.with_object(id(0), [1e300, -1e300]),
            3 => s.with_robot(m, [f64::INFINITY, f64::NEG_INFINITY]),
            _ => s,
        }
    }
}

#[test]
fn poisoned_samples_leave_no_trace_in_the_tree() {
    let problem = problems::two_pucks().unwrap();
    for distance in [Box::new(GreedyVisit) as Box<dyn Distance<World>>, Box::new(Euclidean), Box::new(ExactTour)] {
        let strategy = Strategy {
            sampler: Box::new(Poison),
            distance,
            extend: ExtendOptions::default(),
            local_repair: None,
            try_penalty_m: 0.0,
            shorten: darrt_core::shorten::ShortenOptions::default(),
            improve: None,
        };
        let mut darrt = Darrt::new(&problem, &strategy, 0, 0, usize::MAX);
        for _ in 0..200 {
            darrt.step();
        }
        let m = problem.domain();
        assert!(darrt.tree().len() > 100);
        for (_, node) in darrt.tree().iter() {
            assert!(m.robot().contains(&node.state.robot), "{:?}", node.state);
            assert!(m.objects().iter().zip(&node.state.objects).all(|(space, at)| space.contains(at)));
        }
        assert!(darrt.accounts().are_balanced());
    }
}

#[test]
fn a_world_without_pucks_is_plain_motion_planning() {
    let setup = Setup::new([3.0, 2.0], 0.15).robot_at([0.5, 1.0]).wall("wall", [1.4, 0.0], [1.6, 1.5]);
    let problem = setup.robot_goal([2.5, 1.0]).problem().unwrap();
    for strategy in [greedy(Full), greedy(RandomSubset), strategy(robot_or_objects(), ExactTour)] {
        let outcome = solve(&problem, &strategy, &options(0, 1000), &mut Silent);
        assert_eq!(outcome.stop, Stop::Solved);
    }
}

#[test]
fn restarts_after_nothing_and_no_threads_are_read_as_one() {
    let problem = problems::open().unwrap();
    for threads in [0, 1, 3] {
        let opts = SolveOptions { restart_iterations: Some(0), threads, ..options(0, 40) };
        let outcome = run(&problem, &opts);
        assert_eq!((outcome.restarts + 1, outcome.accounts.extensions), (outcome.iterations, outcome.iterations));
    }
}

#[test]
fn an_empty_goal_and_a_goal_that_cannot_be_sampled() {
    let with_goal = |goal: Box<dyn Goal<World>>| {
        let mut parts = small().parts().unwrap();
        parts.goal = goal;
        run(&Problem::new(parts).unwrap(), &options(0, 100))
    };
    let outcome = with_goal(Box::new(AnyOf::new(Vec::new())));
    assert_eq!((outcome.stop, outcome.nearest_to_goal), (Stop::IterationLimit, f64::INFINITY));
    let right_half = Region::new(Box::new(|_: &World, s: &State<World>| s.objects[0][0] > 2.0), Box::new(|_, _| None));
    let outcome = with_goal(Box::new(right_half));
    assert_eq!(outcome.stop, Stop::Solved);
    let plan = outcome.solution.unwrap().plan().clone();
    assert!(plan.steps().last().unwrap().until <= 1.0);
}

#[test]
fn a_plan_may_end_in_the_middle_of_an_instance() {
    let mut parts = small().parts().unwrap();
    let m = parts.domain.clone();
    let far = PartialState::anywhere(&m).with_object(id(0), [2.8, 1.0]);
    parts.goal = Box::new(Region::new(
        Box::new(|_: &World, s: &State<World>| s.objects[0][0] > 1.5),
        Box::new(move |_, _| Some(far.clone())),
    ));
    let outcome = run(&Problem::new(parts).unwrap(), &options(7, 100));
    let plan = outcome.solution.unwrap().plan().clone();
    assert!(plan.steps().last().unwrap().until < 1.0);
    assert!(plan.end(&m).objects[0][0] > 1.5);
    assert_eq!(plan.at(&m, plan.steps().len(), 0.5), None);
}

#[test]
fn waypoints_are_exact_at_their_ends_whatever_the_segments() {
    let problem = small().problem().unwrap();
    let (m, a) = (problem.domain(), problem.start());
    let mut b = State { robot: [0.7, 0.4], ..a.clone() };
    b.mode = b.mode.touching(Some(id(0)));
    let c = State { robot: [-0.0, 0.3], ..a.clone() };
    for segments in [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 2.0]] {
        let motion = Waypoints::new(vec![a.clone(), b.clone(), c.clone()], &segments, b.mode.clone()).unwrap();
        let mut out = c.clone();
        for (t, expected) in [(0.0, a), (-1.0, a), (1.0, &c), (7.0, &c)] {
            motion.at_into(m, t, &mut out);
            assert_eq!(format!("{out:?}"), format!("{expected:?}"), "{segments:?} at {t}");
        }
        motion.at_into(m, 0.5, &mut out);
        assert_eq!(out.mode, b.mode);
        motion.at_into(m, f64::NAN, &mut out);
    }
    for bad in [&[f64::NAN, 1.0][..], &[-1.0, 1.0], &[1.0], &[f64::INFINITY, 0.0]] {
        assert!(Waypoints::new(vec![a.clone(), b.clone(), c.clone()], bad, b.mode.clone()).is_none());
    }
    assert!(Waypoints::new(vec![a.clone()], &[], a.mode.clone()).is_none());
}

#[test]
fn a_straight_motion_is_exact_at_its_ends() {
    let problem = small().problem().unwrap();
    let (m, a) = (problem.domain(), problem.start());
    let straight = Straight::new(a.clone(), [-0.0, 0.9], 0.6);
    let mut out = a.clone();
    straight.at_into(m, 1.0, &mut out);
    assert!(out.robot[0].is_sign_negative() && out.robot == [0.0, 0.9]);
    straight.at_into(m, 0.0, &mut out);
    assert_eq!(out, *a);
    assert_eq!(out.objects, a.objects);
}
