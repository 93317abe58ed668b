//! `DARRTH`: the objects are planned first, as if the robot could pass through everything; the changes of primitive in that plan
//! become subgoals, and the whole is planned from one to the next.
//!
//! Needs rules that are separate for robot and objects ([`Validity::without_robot`](crate::validity::Validity::without_robot)); without them it
//! is the search that its parts are. A subgoal says where the objects that the plan has moved so far stand when one primitive ends and another
//! begins. One that is not reached within [`SUBGOAL_ITERATIONS`] is given up, and everything begins anew with other random
//! numbers. The parts are searched by [`Darrt`], or by [`Connect`] (`DARRTHConnect`).
//!
//! # Source
//! The authors' later software: J. Barry, L. Kaelbling, T. Lozano-Pérez, *A hierarchical approach to manipulation with diverse
//! actions*, ICRA 2013.

use std::sync::Arc;

use rand::Rng;

use super::connect::Connect;
use super::{Darrt, Part, Planner, Start, Step, Strategy};
use crate::domain::Domain;
use crate::goal::{Goal, Reach};
use crate::lazy_validation::NotValidated;
use crate::observe::accounts::Accounts;
use crate::partial::PartialState;
use crate::pipeline::Unproved;
use crate::plan::{Plan, Step as PlanStep};
use crate::problem::Problem;
use crate::random::{Purpose, stream};
use crate::state::{ObjectId, State};
use crate::verify::{Refusal, Solution};

/// Iterations for the objects alone, and for each subgoal.
pub const SUBGOAL_ITERATIONS: u64 = 300;

/// A search that is begun for one part.
type Search<'p, D> = Box<dyn Planner<D> + 'p>;

/// One attempt.
pub struct Hierarchical<'p, D: Domain> {
    /// The whole problem; judges what is put together, its tree is not grown.
    whole: Darrt<'p, D>,
    /// The search of the whole problem, if the rules are not separate for robot and objects.
    alone: Option<Search<'p, D>>,
    problem: Problem<D>,
    relaxed: Option<Problem<D>>,
    strategy: &'p Strategy<D>,
    start: Start<'p>,
    /// How parts are searched.
    search: fn(&Problem<D>, &'p Strategy<D>, Start<'p>) -> Search<'p, D>,
    /// The search for the objects alone, or from one subgoal to the next.
    part: Search<'p, D>,
    /// How many parts have been begun.
    parts: u64,
    /// The subgoals ahead, the next one last; `None` while the objects are planned.
    ahead: Option<Vec<PartialState<D>>>,
    /// The plan so far.
    steps: Vec<PlanStep<D>>,
    /// Over the parts that have ended.
    accounts: Accounts,
    iterations: u64,
    nodes: usize,
}

// Not derived: that would ask the searches to be printable.
impl<D: Domain> std::fmt::Debug for Hierarchical<'_, D> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Hierarchical")
            .field("whole", &self.whole)
            .field("parts", &self.parts)
            .field("ahead", &self.ahead)
            .finish_non_exhaustive()
    }
}

impl<'p, D: Domain> Hierarchical<'p, D> {
    /// Begins with the objects; all parts are searched by [`Darrt`].
    pub fn new(problem: &Problem<D>, strategy: &'p Strategy<D>, start: Start<'p>) -> Self {
        let search = |problem: &Problem<D>, strategy: &'p Strategy<D>, start: Start<'p>| -> Search<'p, D> {
            Box::new(Darrt::begin(problem, strategy, start))
        };
        Self::of_parts(problem, strategy, start, search)
    }

    /// The same with all parts searched by [`Connect`].
    pub fn connecting(problem: &Problem<D>, strategy: &'p Strategy<D>, start: Start<'p>) -> Self {
        let search = |problem: &Problem<D>, strategy: &'p Strategy<D>, start: Start<'p>| -> Search<'p, D> {
            Box::new(Connect::new(problem, strategy, start))
        };
        Self::of_parts(problem, strategy, start, search)
    }

    fn of_parts(
        problem: &Problem<D>,
        strategy: &'p Strategy<D>,
        start: Start<'p>,
        search: fn(&Problem<D>, &'p Strategy<D>, Start<'p>) -> Search<'p, D>,
    ) -> Self {
        let relaxed = problem
            .validity()
            .without_robot()
            .map(|validity| problem.part(problem.start().clone(), problem.shared_goal()).under(validity));
        let first = relaxed.as_ref().unwrap_or(problem);
        Self {
            whole: Darrt::begin(problem, strategy, start),
            alone: relaxed.is_none().then(|| search(problem, strategy, start)),
            part: search(first, strategy, start.of_part(0)),
            problem: problem.clone(),
            relaxed,
            strategy,
            start,
            search,
            parts: 0,
            ahead: None,
            steps: Vec::new(),
            accounts: Accounts::new(problem.primitives().iter().map(|p| p.name()).collect()),
            iterations: 0,
            nodes: 1,
        }
    }

    /// Ends the present part and begins one at `problem`.
    fn begin(&mut self, problem: &Problem<D>) {
        self.parts += 1;
        let next = (self.search)(problem, self.strategy, self.start.of_part(self.parts));
        let ended = std::mem::replace(&mut self.part, next);
        self.accounts.merge(&ended.accounts());
        self.iterations += ended.iteration();
        self.nodes = self.nodes.max(ended.nodes());
    }

    fn begin_anew(&mut self) {
        self.ahead = None;
        self.steps.clear();
        if let Some(relaxed) = self.relaxed.clone() {
            self.begin(&relaxed);
        }
    }

    /// Plans from `from` to the next subgoal, or to the goal if there is none.
    fn begin_next(&mut self, from: State<D>) {
        let m = self.problem.domain();
        let ahead = self.ahead.get_or_insert_default();
        let mut next = ahead.pop();
        while next.as_ref().is_some_and(|target| target.is_met(m, &from)) {
            next = ahead.pop();
        }
        let goal: Arc<dyn Goal<D>> = match next {
            Some(target) => Arc::new(Reach::new(target)),
            None => self.problem.shared_goal(),
        };
        let problem = self.problem.part(from, goal);
        self.begin(&problem);
    }

    /// Goes on behind a part that has reached what it was for.
    fn go_on(&mut self, plan: &Plan<D>, step: &mut Step<D>) {
        let m = self.problem.domain();
        if self.ahead.is_none() {
            self.ahead = Some(subgoals(m, plan));
            self.begin_next(self.problem.start().clone());
            return;
        }
        self.steps.extend(plan.steps().iter().cloned());
        let whole = Plan::new(self.problem.start().clone(), self.steps.clone());
        if !self.problem.goal().is_satisfied(m, &whole.end(m)) {
            let here = plan.end(m);
            self.begin_next(here);
            return;
        }
        match self.whole.prove_plan(&whole) {
            Ok(solution) => step.solution = Some(solution),
            Err(unproved) => {
                match unproved {
                    Unproved::Refused(refusal) => {
                        self.accounts.refused += 1;
                        step.refusal = Some(refusal);
                    }
                    Unproved::NotValidated(NotValidated::Blocked(_, blame)) => self.accounts.withdraw(0, &blame),
                    Unproved::NotValidated(NotValidated::Cancelled) => {}
                }
                self.begin_anew();
            }
        }
    }
}

impl Start<'_> {
    /// Where a part begins, with random numbers of its own.
    fn of_part(self, part: u64) -> Self {
        Self { seed: stream(self.seed, self.attempt, part, Purpose::Attempt).next_u64(), is_part: true, ..self }
    }
}

/// Where the objects stand that `plan` has moved by then, whenever a run of one primitive ends that has moved any; the last run
/// leads to the goal. The next subgoal last.
fn subgoals<D: Domain>(m: &D, plan: &Plan<D>) -> Vec<PartialState<D>> {
    let mut subgoals = Vec::new();
    let mut before = plan.start().clone();
    for (i, pair) in plan.steps().windows(2).enumerate() {
        let ends = matches!(pair, [step, next] if step.primitive != next.primitive);
        let Some(after) = plan.at(m, i, 1.0).filter(|_| ends) else { continue };
        if after.objects != before.objects {
            let ids = (0..after.objects.len()).map(ObjectId::new);
            let moved = ids.filter(|id| after.object(*id) != plan.start().object(*id));
            let named = moved.filter_map(|id| Some((id, after.object(id)?.clone())));
            subgoals.push(named.fold(PartialState::anywhere(m), |target, (id, at)| target.with_object(id, at)));
            before = after;
        }
    }
    subgoals.reverse();
    subgoals
}

impl<D: Domain> Planner<D> for Hierarchical<'_, D> {
    fn prove_start(&mut self) -> Option<Result<Solution<D>, Refusal>> {
        if let Some(alone) = &mut self.alone {
            return alone.prove_start();
        }
        let proof = self.whole.prove_start()?;
        self.accounts.refused += u64::from(proof.is_err());
        Some(proof)
    }

    fn step(&mut self) -> Step<D> {
        if let Some(alone) = &mut self.alone {
            return alone.step();
        }
        let mut step = self.part.step();
        if let Some(reached) = step.solution.take() {
            self.go_on(reached.plan(), &mut step);
        } else if self.part.iteration() >= SUBGOAL_ITERATIONS {
            self.begin_anew();
        }
        step
    }

    fn iteration(&self) -> u64 {
        self.alone.as_ref().map_or_else(|| self.iterations + self.part.iteration(), |alone| alone.iteration())
    }

    fn nodes(&self) -> usize {
        self.alone.as_ref().map_or_else(|| self.nodes.max(self.part.nodes()), |alone| alone.nodes())
    }

    fn accounts(&self) -> Accounts {
        if let Some(alone) = &self.alone {
            return alone.accounts();
        }
        let mut all = self.accounts.clone();
        all.merge(&self.part.accounts());
        all
    }

    fn nearest_to_goal(&self) -> f64 {
        self.alone.as_ref().map_or_else(|| self.whole.nearest_to_goal(), |alone| alone.nearest_to_goal())
    }

    fn nearest(&self) -> Option<&State<D>> {
        self.alone.as_ref().and_then(|alone| alone.nearest())
    }

    fn parts(&self) -> Vec<Part<D>> {
        // The parts of the others begin elsewhere, or have no robot.
        self.alone.as_ref().map_or_else(Vec::new, |alone| alone.parts())
    }
}
