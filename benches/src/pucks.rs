//! The puck domain: trees of any size, and runs of the planner at fixed seeds.

use darrt_core::budget::Budget;
use darrt_core::distance::{Distance, Euclidean, ExactTour, GreedyVisit};
use darrt_core::domain::Domain;
use darrt_core::observe::Silent;
use darrt_core::partial::PartialState;
use darrt_core::problem::Problem;
use darrt_core::sample::{Full, GoalBiased, Placed, RandomSubset, RobotOrObjects, Sampler};
use darrt_core::search::{Algorithm, Strategy};
use darrt_core::solve::{Member, SolveOptions, Until, solve_with};
use darrt_core::space::{ComponentSpace as _, Place};
use darrt_core::state::State;
use darrt_core::testing::puck::problems::{self, Ready};
use darrt_core::testing::puck::{Mode, Pick, PuckWorld, Push, Setup, paper_strategy};
use darrt_core::tree::Tree;
use darrt_core::variants::{ApproachVisit, Frontier, Weighted};

use crate::stream;

/// A problem's name and how to make it.
pub type NamedProblem = (&'static str, fn() -> Ready);

/// Problems on which variants are compared, from easy to hard.
pub const PROBLEMS: [NamedProblem; 4] = [
    ("open", problems::open),
    ("two pucks", problems::two_pucks),
    ("four pucks", problems::four_pucks),
    ("graspable", problems::graspable),
];

/// Seeds of one measured run.
pub const SEEDS: u64 = 5;

/// Iterations after which a run is given up.
const ITERATIONS: u64 = 1000;

/// Names one way of sampling and makes it.
pub type NamedSampler = (&'static str, fn() -> Box<dyn Sampler<PuckWorld>>);

/// The ways of sampling. A new one is compared by being added here.
pub const SAMPLERS: [NamedSampler; 6] = [
    ("full", || Box::new(Full)),
    ("random subset", || Box::new(RandomSubset)),
    ("robot or objects", || Box::new(robot_or_objects())),
    ("standing", || Box::new(Placed::new(robot_or_objects(), Place::OnSupport, 0.7).unwrap())),
    ("edge of the support", || Box::new(Placed::new(robot_or_objects(), Place::SupportEdge, 0.3).unwrap())),
    ("frontier", || Box::new(Frontier::new(robot_or_objects(), 0.3, 0.2).unwrap())),
];

fn robot_or_objects() -> RobotOrObjects {
    RobotOrObjects::new(0.5, 0.0).unwrap()
}

/// Names one distance and makes it.
pub type NamedDistance = (&'static str, fn() -> Box<dyn Distance<PuckWorld>>);

/// The distances. A new one is compared by being added here.
pub const DISTANCES: [NamedDistance; 6] = [
    ("euclidean", || Box::new(Euclidean)),
    ("greedy visit", || Box::new(GreedyVisit)),
    ("exact tour", || Box::new(ExactTour)),
    ("weighted sum", || Box::new(Weighted::sum(0.3, 1.0).unwrap())),
    ("maximum", || Box::new(Weighted::maximum(1.0, 1.0).unwrap())),
    ("greedy visit to the contact", || Box::new(ApproachVisit::new(vec![Box::new(Push), Box::new(Pick)]))),
];

/// The strategy of the paper with these two parts replaced.
pub fn strategy(sampler: Box<dyn Sampler<PuckWorld>>, distance: Box<dyn Distance<PuckWorld>>) -> Strategy<PuckWorld> {
    let sampler = Box::new(GoalBiased::new(sampler, 0.2).unwrap());
    Strategy { sampler, distance, ..paper_strategy().unwrap() }
}

/// A puck that can only be pushed, in a pen with its goal outside: no seed solves it.
pub fn unreachable() -> Problem<PuckWorld> {
    Setup::new([4.0, 3.0], 0.15)
        .robot_at([0.5, 1.5])
        .puck("red", 0.12, [1.5, 1.0])
        .wall("fence", [2.4, 0.0], [2.6, 3.0])
        .puck_goal(0, [3.3, 2.0])
        .problem()
        .unwrap()
}

/// A state with everything anywhere in its space, nothing held.
pub fn state(m: &PuckWorld, index: u64) -> State<PuckWorld> {
    let rng = &mut stream(index);
    let objects = m.objects().iter().map(|space| space.sample(rng)).collect();
    State { robot: m.robot().sample(rng), objects, mode: Mode::resting(m.objects().len()) }
}

/// `count` targets as the sampler of the paper draws them for `problem`.
pub fn targets(problem: &Problem<PuckWorld>, count: u64) -> Vec<PartialState<PuckWorld>> {
    let sampler = RobotOrObjects::new(0.5, 0.0).unwrap();
    (0..count).map(|i| sampler.sample(problem.domain(), problem.goal(), &mut stream(i))).collect()
}

/// A tree of `count` random states, all of them children of the root.
pub fn tree(m: &PuckWorld, count: u64) -> Tree<PuckWorld> {
    crate::trees::random(m, &state(m, 0), count)
}

/// What the runs over all [`SEEDS`] needed.
#[derive(Debug, Clone, Copy)]
pub struct Needed {
    /// Runs that ended with a solution.
    pub solved: u64,
    /// Iterations over all runs.
    pub iterations: u64,
}

/// Solves `problem` once per seed by Algorithm 1, restarting every 200 iterations.
pub fn run(problem: &Problem<PuckWorld>, strategy: &Strategy<PuckWorld>) -> Needed {
    run_by(Algorithm::Darrt, problem, strategy)
}

/// [`run`] by any search.
pub fn run_by(algorithm: Algorithm, problem: &Problem<PuckWorld>, strategy: &Strategy<PuckWorld>) -> Needed {
    let mut needed = Needed { solved: 0, iterations: 0 };
    for seed in 0..SEEDS {
        let options = SolveOptions {
            seed,
            budget: Budget { iterations: Some(ITERATIONS), ..Budget::default() },
            restart_iterations: Some(200),
            ..SolveOptions::default()
        };
        let members = [Member { algorithm, strategy }];
        let outcome = solve_with(problem, &members, Until::Solved, &options, &mut Silent);
        needed.solved += u64::from(outcome.solution.is_some());
        needed.iterations += outcome.iterations;
    }
    needed
}
