//! The searches by name.

use std::fmt;

use super::connect::Connect;
use super::hierarchical::Hierarchical;
use super::{Darrt, Part, Step, Strategy};
use crate::budget::Interrupt;
use crate::domain::Domain;
use crate::observe::accounts::Accounts;
use crate::problem::Problem;
use crate::record::Growth;
use crate::state::State;
use crate::verify::{Refusal, Solution};

/// One attempt of a search, which [`solve_with`](crate::solve::solve_with) asks for one iteration after the other.
///
/// # Laws
/// Pure but for the interrupt: the same beginning gives the same iterations. Every iteration makes one extension and counts
/// it, and a solution has been accepted by the verifier of the problem.
///
/// # Example
/// Not a search of its own: it follows any other one and says where it stands.
/// ```
/// use darrt_core::prelude::*;
/// use darrt_core::observe::accounts::Accounts;
/// use darrt_core::search::{Planner, Step};
/// use darrt_core::verify::{Refusal, Solution};
///
/// struct Told<P>(P);
///
/// impl<D: Domain, P: Planner<D>> Planner<D> for Told<P> {
///     fn prove_start(&mut self) -> Option<Result<Solution<D>, Refusal>> { self.0.prove_start() }
///     fn step(&mut self) -> Step<D> {
///         let step = self.0.step();
///         if self.0.iteration() % 1000 == 0 {
///             println!("{} nodes, {} m from the goal", self.0.nodes(), self.0.nearest_to_goal());
///         }
///         step
///     }
///     fn iteration(&self) -> u64 { self.0.iteration() }
///     fn nodes(&self) -> usize { self.0.nodes() }
///     fn accounts(&self) -> Accounts { self.0.accounts() }
///     fn nearest_to_goal(&self) -> f64 { self.0.nearest_to_goal() }
/// }
/// ```
pub trait Planner<D: Domain> {
    /// The empty plan, if the start lies in the goal and the verifier agrees.
    fn prove_start(&mut self) -> Option<Result<Solution<D>, Refusal>>;

    /// One iteration.
    fn step(&mut self) -> Step<D>;

    /// Iterations done.
    fn iteration(&self) -> u64;

    /// Nodes of its trees.
    fn nodes(&self) -> usize;

    /// The counts so far.
    fn accounts(&self) -> Accounts;

    /// Metres from a sample of the goal to the nearest state so far; infinite if the goal has no samples.
    fn nearest_to_goal(&self) -> f64;

    /// The state that is so near to the goal; by default none is known.
    fn nearest(&self) -> Option<&State<D>> {
        None
    }

    /// From now on [`Planner::growth`] will be asked for after every iteration. By default nothing is known of a tree.
    fn keep_track(&mut self) {}

    /// What the last iteration did to the tree that grows from the start, if [track is kept](Planner::keep_track) of it.
    fn growth(&self) -> Option<Growth<'_, D>> {
        None
    }

    /// The ways to the best states reached, the best first, for the time when there is no plan; by default none are known.
    fn parts(&self) -> Vec<Part<D>> {
        Vec::new()
    }
}

/// Where an attempt begins: what [`Darrt::new`] asks for besides problem and strategy.
#[derive(Debug, Clone, Copy)]
pub struct Start<'p> {
    /// Seed of every random choice.
    pub seed: u64,
    /// Number of the attempt; attempts with different numbers share no random numbers.
    pub attempt: u64,
    /// Most nodes of one tree.
    pub node_limit: usize,
    /// Asked within an iteration whether to go on.
    pub interrupt: Interrupt<'p>,
    /// Does it look for a part of a plan only? The whole is made smoother, not its parts.
    pub is_part: bool,
}

/// Which search.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
#[non_exhaustive]
pub enum Algorithm {
    /// Algorithm 1 of the paper: one tree from the start.
    #[default]
    Darrt,
    /// `DARRTConnect`: a second tree from the goal.
    Connect,
    /// `DARRTH`: first the objects alone, then the whole from subgoal to subgoal.
    Hierarchical,
    /// `DARRTHConnect`: the same, from subgoal to subgoal by `DARRTConnect`.
    HierarchicalConnect,
}

impl Algorithm {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Darrt, Self::Connect, Self::Hierarchical, Self::HierarchicalConnect];

    /// Its name in files and options.
    pub fn name(self) -> &'static str {
        match self {
            Self::Darrt => "darrt",
            Self::Connect => "connect",
            Self::Hierarchical => "hierarchical",
            Self::HierarchicalConnect => "hierarchical-connect",
        }
    }

    /// The search of this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|algorithm| algorithm.name() == name)
    }

    /// One attempt at `problem`.
    pub fn planner<'p, D: Domain>(
        self,
        problem: &Problem<D>,
        strategy: &'p Strategy<D>,
        start: Start<'p>,
    ) -> Box<dyn Planner<D> + 'p> {
        match self {
            Self::Darrt => Box::new(Darrt::begin(problem, strategy, start)),
            Self::Connect => Box::new(Connect::new(problem, strategy, start)),
            Self::Hierarchical => Box::new(Hierarchical::new(problem, strategy, start)),
            Self::HierarchicalConnect => Box::new(Hierarchical::connecting(problem, strategy, start)),
        }
    }
}

impl fmt::Display for Algorithm {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl<'p, D: Domain> Darrt<'p, D> {
    /// [`Darrt::new`] with everything in one value.
    pub(super) fn begin(problem: &Problem<D>, strategy: &'p Strategy<D>, start: Start<'p>) -> Self {
        let Start { seed, attempt, node_limit, interrupt, is_part } = start;
        Self { is_part, ..Self::new(problem, strategy, seed, attempt, node_limit).interrupted_by(interrupt) }
    }
}

impl<D: Domain> Planner<D> for Darrt<'_, D> {
    fn prove_start(&mut self) -> Option<Result<Solution<D>, Refusal>> {
        self.prove_start()
    }

    fn step(&mut self) -> Step<D> {
        self.step()
    }

    fn iteration(&self) -> u64 {
        self.iteration()
    }

    fn nodes(&self) -> usize {
        self.tree().len()
    }

    fn accounts(&self) -> Accounts {
        self.accounts().clone()
    }

    fn nearest_to_goal(&self) -> f64 {
        self.nearest_to_goal()
    }

    fn nearest(&self) -> Option<&State<D>> {
        self.nearest.as_ref()
    }

    fn keep_track(&mut self) {
        self.tree.number_births();
    }

    fn growth(&self) -> Option<Growth<'_, D>> {
        Some(Growth { tree: self.tree(), extended: self.extended })
    }

    fn parts(&self) -> Vec<Part<D>> {
        self.parts()
    }
}
