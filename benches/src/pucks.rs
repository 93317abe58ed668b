//! The puck domain: trees of any size, and runs of the planner at fixed seeds.

use std::sync::Arc;

use darrt_core::budget::Budget;
use darrt_core::distance::{Distance, Euclidean, ExactTour, GreedyVisit};
use darrt_core::domain::Domain;
use darrt_core::motion::{Instance, Straight};
use darrt_core::observe::Silent;
use darrt_core::partial::PartialState;
use darrt_core::problem::Problem;
use darrt_core::sample::{Full, GoalBiased, RandomSubset, RobotOrObjects, Sampler};
use darrt_core::search::Strategy;
use darrt_core::solve::{SolveOptions, solve};
use darrt_core::space::ComponentSpace as _;
use darrt_core::state::{ComponentSet, State};
use darrt_core::testing::puck::problems::{self, Ready};
use darrt_core::testing::puck::{Mode, PuckWorld, paper_strategy};
use darrt_core::tree::{Edge, Tree};

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
pub const SAMPLERS: [NamedSampler; 3] = [
    ("full", || Box::new(Full)),
    ("random subset", || Box::new(RandomSubset)),
    ("robot or objects", || Box::new(RobotOrObjects::new(0.5, 0.0).unwrap())),
];

/// Names one distance and makes it.
pub type NamedDistance = (&'static str, fn() -> Box<dyn Distance<PuckWorld>>);

/// The distances. A new one is compared by being added here.
pub const DISTANCES: [NamedDistance; 3] = [
    ("euclidean", || Box::new(Euclidean)),
    ("greedy visit", || Box::new(GreedyVisit)),
    ("exact tour", || Box::new(ExactTour)),
];

/// The strategy of the paper with these two parts replaced.
pub fn strategy(sampler: Box<dyn Sampler<PuckWorld>>, distance: Box<dyn Distance<PuckWorld>>) -> Strategy<PuckWorld> {
    let sampler = Box::new(GoalBiased::new(sampler, 0.2).unwrap());
    Strategy { sampler, distance, ..paper_strategy().unwrap() }
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
    let root = state(m, 0);
    let instance = Arc::new(Instance {
        label: "Transit",
        motion: Box::new(Straight::new(root.clone(), root.robot, 0.0)),
        contacts: ComponentSet::EMPTY,
        moves: ComponentSet::ROBOT,
        object: None,
        reversible: true,
    });
    let mut tree = Tree::rooted_at(root);
    for index in 1..count {
        let edge = Edge { parent: Tree::<PuckWorld>::ROOT, instance: Arc::clone(&instance), t: 1.0, primitive: 0 };
        tree.add(state(m, index), edge).unwrap();
    }
    tree
}

/// What the runs over all [`SEEDS`] needed.
#[derive(Debug, Clone, Copy)]
pub struct Needed {
    /// Runs that ended with a solution.
    pub solved: u64,
    /// Iterations over all runs.
    pub iterations: u64,
}

/// Solves `problem` once per seed, restarting every 200 iterations.
pub fn run(problem: &Problem<PuckWorld>, strategy: &Strategy<PuckWorld>) -> Needed {
    let mut needed = Needed { solved: 0, iterations: 0 };
    for seed in 0..SEEDS {
        let options = SolveOptions {
            seed,
            budget: Budget { iterations: Some(ITERATIONS), ..Budget::default() },
            restart_iterations: Some(200),
            ..SolveOptions::default()
        };
        let outcome = solve(problem, strategy, &options, &mut Silent);
        needed.solved += u64::from(outcome.solution.is_some());
        needed.iterations += outcome.iterations;
    }
    needed
}
