//! DARRT (Algorithm 1 of the paper): one attempt from the initial state.
//!
//! | variant | what is different |
//! |---|---|
//! | [`Darrt`] | nothing: Algorithm 1 |
//! | [`connect`] | a second tree grows backwards from the goal |
//! | [`hierarchical`] | the objects are planned first, as if the robot could pass through everything; the parts are either of the above |
//!
//! All are a [`Planner`], made by [`Algorithm::planner`], and run by [`solve_with`](crate::solve::solve_with).

use crate::budget::{Interrupt, Stop};
use crate::distance::Distance;
use crate::domain::Domain;
use crate::extend::{ExtendOptions, Extender, Extension};
use crate::improve::Improvement;
use crate::lazy_validation::NotValidated;
use crate::local_repair::LocalRepair;
use crate::observe::accounts::Accounts;
use crate::partial::PartialState;
use crate::pipeline::{Pipeline, Unproved};
use crate::plan::Plan;
use crate::problem::Problem;
use crate::random::{Purpose, stream};
use crate::sample::Sampler;
use crate::shorten::ShortenOptions;
use crate::state::State;
use crate::tree::{Edge, NodeId, Tree};
use crate::validity::Blame;
use crate::verify::{Refusal, Solution};

mod algorithm;
pub mod connect;
mod further;
pub mod hierarchical;
pub(crate) mod part;

pub use algorithm::{Algorithm, Planner, Start};
pub(crate) use further::{Effort, further_plans};
pub use part::Part;

/// The parts of the search that are variants of one trait each.
pub struct Strategy<D: Domain> {
    /// SAMPLE.
    pub sampler: Box<dyn Sampler<D>>,
    /// DISTANCE.
    pub distance: Box<dyn Distance<D>>,
    /// How EXTENDTOWARDS discretises.
    pub extend: ExtendOptions,
    /// What is tried when a motion is blocked; `None`: the blocked motion is cut short, as in the paper.
    pub local_repair: Option<Box<dyn LocalRepair<D>>>,
    /// Metres by which a node, and every other in which the objects stand as in it, counts as farther away after each
    /// extension from it; at least 0. Zero is the plain arg min of Algorithm 1, which asks the nearest placement again and
    /// again even where nothing leads on (paper section 6.2).
    pub try_penalty_m: f64,
    /// What is done for a shorter plan once one is found.
    pub shorten: ShortenOptions,
    /// What is done for a plan that takes less time to carry out; `None`: the plan that is found, made shorter, is the result.
    pub improve: Option<Improvement<D>>,
}

impl<D: Domain> Strategy<D> {
    /// Algorithm 1 with these: a blocked motion is cut short, and the plan stays as it was found.
    pub fn new(sampler: impl Sampler<D> + 'static, distance: impl Distance<D> + 'static) -> Self {
        Self {
            sampler: Box::new(sampler),
            distance: Box::new(distance),
            extend: ExtendOptions::default(),
            local_repair: None,
            try_penalty_m: 0.0,
            shorten: ShortenOptions::default(),
            improve: None,
        }
    }
}

impl<D: Domain> std::fmt::Debug for Strategy<D> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Strategy").field("extend", &self.extend).finish_non_exhaustive()
    }
}

/// One attempt: a tree that grows from the initial state.
pub struct Darrt<'p, D: Domain> {
    problem: Problem<D>,
    strategy: &'p Strategy<D>,
    /// The sampler of this attempt alone, if it learns.
    learner: Option<Box<dyn Sampler<D>>>,
    interrupt: Interrupt<'p>,
    tree: Tree<D>,
    accounts: Accounts,
    seed: u64,
    attempt: u64,
    iteration: u64,
    node_limit: usize,
    goal_sample: Option<PartialState<D>>,
    nearest_to_goal: f64,
    /// The state that is so near.
    nearest: Option<State<D>>,
    is_part: bool,
    /// Number of the node that was extended last; see [`Tree::births`].
    extended: Option<u32>,
}

// Not derived: a sampler is not printable.
impl<D: Domain> std::fmt::Debug for Darrt<'_, D> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Darrt")
            .field("attempt", &self.attempt)
            .field("iteration", &self.iteration)
            .field("nodes", &self.tree.len())
            .finish_non_exhaustive()
    }
}

/// What an extension of a node did to the tree.
struct Grown<D: Domain> {
    step: Step<D>,
    /// The last node that it added; the node itself if it added none.
    last: NodeId,
    /// Did it meet its target?
    is_met: bool,
}

/// What one iteration did.
#[derive(Debug)]
pub struct Step<D: Domain> {
    /// States added to the tree.
    pub added: usize,
    /// What blocked the extension.
    pub blame: Option<Blame>,
    /// A verified solution, if one was found.
    pub solution: Option<Solution<D>>,
    /// Set when a state satisfied the goal but the verifier refused.
    pub refusal: Option<Refusal>,
    /// Set when a state satisfied the goal but a motion to it, taken as free before, is blocked: the states that were
    /// taken back, and what is in the way.
    pub withdrawn: Option<(usize, Blame)>,
    /// Set when the tree is full, or when the verifier was cancelled.
    pub stop: Option<Stop>,
}

impl<'p, D: Domain> Darrt<'p, D> {
    /// `V <- {c_I}`. Random choices are keyed by `(seed, attempt, iteration)`.
    pub fn new(problem: &Problem<D>, strategy: &'p Strategy<D>, seed: u64, attempt: u64, node_limit: usize) -> Self {
        let names = problem.primitives().iter().map(|p| p.name()).collect();
        let mut rng = stream(seed, attempt, 0, Purpose::Attempt);
        let goal_sample = problem.goal().sample(problem.domain(), &mut rng);
        let mut darrt = Self {
            problem: problem.clone(),
            strategy,
            learner: strategy.sampler.for_one_attempt(),
            interrupt: Interrupt::NEVER,
            tree: Tree::rooted_at(problem.domain(), problem.start().clone()),
            accounts: Accounts::new(names),
            seed,
            attempt,
            iteration: 0,
            node_limit: node_limit.min(Tree::<D>::MAX_NODES),
            goal_sample,
            nearest_to_goal: f64::INFINITY,
            nearest: None,
            is_part: false,
            extended: None,
        };
        darrt.note_distance_to_goal(problem.start());
        darrt
    }

    /// The same, asking `interrupt` within an iteration, and while a plan is made shorter, whether to go on.
    #[must_use]
    pub fn interrupted_by(self, interrupt: Interrupt<'p>) -> Self {
        Self { interrupt, ..self }
    }

    fn extender(&self) -> Extender<'_, D> {
        let Self { problem, strategy, interrupt, .. } = self;
        let interrupt = *interrupt;
        Extender { problem, options: &strategy.extend, local_repair: strategy.local_repair.as_deref(), interrupt }
    }

    /// One iteration of the loop of Algorithm 1.
    pub fn step(&mut self) -> Step<D> {
        let s = self.draw();
        let t = self.nearest(&s);
        self.grow(t, &s).step
    }

    /// Begins an iteration, and draws its sample.
    fn draw(&mut self) -> PartialState<D> {
        self.iteration += 1;
        let draw = &mut stream(self.seed, self.attempt, self.iteration, Purpose::Sample);
        let sampler = self.learner.as_ref().unwrap_or(&self.strategy.sampler);
        sampler.sample(self.problem.domain(), self.problem.goal(), draw)
    }

    fn nearest(&self, s: &PartialState<D>) -> NodeId {
        let nearest = self.strategy.distance.nearest(self.problem.domain(), &self.tree, s);
        nearest.unwrap_or(Tree::<D>::ROOT)
    }

    /// Extends node `t` towards `s`, and takes in what is reached.
    fn grow(&mut self, t: NodeId, s: &PartialState<D>) -> Grown<D> {
        let extension = self.extend(t, s);
        let (is_met, buckets) = (extension.is_met, extension.buckets.clone());
        let step = self.absorb(t, extension);
        self.accounts.count(&buckets, step.added, is_met, step.blame.as_ref());
        if let Some((removed, blame)) = &step.withdrawn {
            self.accounts.withdraw(*removed, blame);
        }
        let last = if step.added > 0 { self.tree.last() } else { t };
        Grown { step, last, is_met }
    }

    /// EXTENDTOWARDS of Algorithm 1 from node `t`; what is reached is not in the tree yet.
    fn extend(&mut self, t: NodeId, s: &PartialState<D>) -> Extension<D> {
        let choose = &mut stream(self.seed, self.attempt, self.iteration, Purpose::Extend);
        let from = self.tree.node(t).map_or(self.problem.start(), |node| &node.state);
        let extension = self.extender().extend(from, s, choose);
        let m = self.problem.domain();
        if let (Some(learner), Some(_)) = (&mut self.learner, &extension.blame) {
            learner.learn_block(m, extension.reached.last().map_or(from, |reached| &reached.state), s);
        }
        self.tree.penalise(t, self.strategy.try_penalty_m);
        self.extended = self.tree.births().get(t.index()).copied();
        extension
    }

    /// The empty plan, if the start lies in the goal and the verifier agrees.
    pub fn prove_start(&mut self) -> Option<Result<Solution<D>, Refusal>> {
        let is_goal = self.problem.goal().is_satisfied(self.problem.domain(), self.problem.start());
        let proof = is_goal.then(|| self.pipeline().proved(Plan::new(self.problem.start().clone(), Vec::new())))?;
        self.accounts.refused += u64::from(proof.is_err());
        Some(proof)
    }

    /// `V <- V + {c_1 ... c_l}`, each tested against the goal.
    fn absorb(&mut self, from: NodeId, extension: Extension<D>) -> Step<D> {
        let mut step =
            Step { added: 0, blame: extension.blame, solution: None, refusal: None, withdrawn: None, stop: None };
        let mut parent = from;
        for reached in extension.reached {
            self.note_distance_to_goal(&reached.state);
            let is_goal = self.problem.goal().is_satisfied(self.problem.domain(), &reached.state);
            let edge = Edge { parent, instance: reached.instance, t: reached.t, primitive: reached.primitive };
            let id = if self.tree.len() < self.node_limit {
                self.tree.add(self.problem.domain(), reached.state, edge)
            } else {
                None
            };
            let Some(id) = id else {
                step.stop = Some(Stop::NodeLimit);
                return step;
            };
            parent = id;
            step.added += 1;
            if is_goal {
                match self.prove(id) {
                    Ok(solution) => step.solution = Some(solution),
                    Err(Unproved::NotValidated(NotValidated::Blocked(instance, blame))) => {
                        let removed = self.tree.prune(self.problem.domain(), id, &instance);
                        step.withdrawn = Some((removed, blame));
                    }
                    Err(unproved) => {
                        // A refused state must not stay: nothing would be nearer to the goal, and every
                        // extension towards the goal would begin and end there.
                        self.tree.remove_last();
                        step.added -= 1;
                        // It may have given up only because nobody waits for its answer any more.
                        if self.interrupt.stop() == Some(Stop::Cancelled) {
                            step.stop = Some(Stop::Cancelled);
                        } else if let Unproved::Refused(refusal) = unproved {
                            self.accounts.refused += 1;
                            step.refusal = Some(refusal);
                        }
                    }
                }
                return step;
            }
        }
        step
    }

    /// A shorter plan if one can be had, else the plan to this node.
    fn prove(&self, node: NodeId) -> Result<Solution<D>, Unproved<D>> {
        let lost = || Refusal { step: None, at: 0.0, reason: "the tree has no such node".to_owned() };
        self.prove_plan(&Plan::to_node(&self.tree, node).ok_or_else(|| Unproved::Refused(lost()))?)
    }

    /// Makes a solution of a found plan; see [`Pipeline`].
    fn prove_plan(&self, plan: &Plan<D>) -> Result<Solution<D>, Unproved<D>> {
        self.pipeline().run(plan)
    }

    fn pipeline(&self) -> Pipeline<'_, D> {
        let key = (self.seed, self.attempt, self.iteration);
        let Self { strategy, interrupt, is_part, .. } = *self;
        Pipeline { extender: self.extender(), strategy, interrupt, is_part, key }
    }

    fn note_distance_to_goal(&mut self, state: &State<D>) {
        if let Some(goal) = &self.goal_sample {
            let d = self.strategy.distance.distance(self.problem.domain(), state, goal);
            if d < self.nearest_to_goal {
                (self.nearest_to_goal, self.nearest) = (d, Some(state.clone()));
            }
        }
    }

    /// Counts a plan to `node` and beyond that is no solution; takes back what led to a motion that is blocked, and says how
    /// many nodes those were.
    fn note_unproved(&mut self, unproved: Unproved<D>, node: NodeId, step: &mut Step<D>) -> usize {
        match unproved {
            Unproved::Refused(refusal) => {
                self.accounts.refused += 1;
                step.refusal = Some(refusal);
                0
            }
            Unproved::NotValidated(NotValidated::Blocked(instance, blame)) => {
                let removed = self.tree.prune(self.problem.domain(), node, &instance);
                self.accounts.withdraw(removed, &blame);
                removed
            }
            Unproved::NotValidated(NotValidated::Cancelled) => 0,
        }
    }

    /// The tree so far.
    pub fn tree(&self) -> &Tree<D> {
        &self.tree
    }

    /// The counts so far.
    pub fn accounts(&self) -> &Accounts {
        &self.accounts
    }

    /// Iterations done.
    pub fn iteration(&self) -> u64 {
        self.iteration
    }

    /// Metres from a sample of the goal to the nearest state so far; infinite if the goal has no samples.
    pub fn nearest_to_goal(&self) -> f64 {
        self.nearest_to_goal
    }
}
