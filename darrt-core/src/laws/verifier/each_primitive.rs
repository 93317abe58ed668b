//! Does a verifier accept what each primitive does?

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use super::forge::{Change, Forge, LEAST_M};
use super::{ACCEPTS, Broken, Judged};
use crate::domain::Domain;
use crate::laws::ensure;
use crate::laws::feed::components;
use crate::laws::motion::component_travel;
use crate::laws::planner::PATIENCE_FACTOR;
use crate::laws::watch::{entering, patience_s, watched, with_patience};
use crate::motion::Instance;
use crate::partial::PartialState;
use crate::plan::Plan;
use crate::primitive::PrimitiveId;
use crate::problem::Problem;
use crate::search::{Darrt, Strategy};
use crate::state::{ComponentId, State};

/// So many attempts are searched for ways.
const ATTEMPTS: u64 = 2;
const MOST_NODES: usize = 512;
/// So many ways of one primitive are judged at most, and not all refused at the step of that primitive.
const MANY: usize = 6;
/// So many ways that end with a step of one primitive are not all refused at one of their steps.
const MANY_EARLIER: usize = 32;
/// And so many are shown at most: what is refused before its last step says little.
const MOST_ASKED: usize = 64;

/// A goal that only the end of this way satisfies.
pub(in crate::laws) fn its_end<D: Domain>(m: &D, way: &Plan<D>) -> crate::goal::Region<D> {
    let end = way.end(m);
    let mode = end.mode.clone();
    let target = PartialState::of_state(m, &end);
    let is_met = move |m: &D, state: &_| {
        let state: &crate::state::State<D> = state;
        state.mode == mode && target.is_met(m, state)
    };
    crate::goal::Region::<D>::new(Box::new(is_met), Box::new(|_, _| None))
}

/// By primitive: how many ways were refused, and why the last one was.
type Refusals = BTreeMap<usize, (usize, PrimitiveId, String)>;

/// What became of ways whose last step is an instance of a primitive.
#[derive(Debug, Default)]
pub(super) struct Ledger {
    asked: BTreeMap<usize, usize>,
    accepted: BTreeSet<usize>,
    refused: Refusals,
    /// The same, at whichever step.
    earlier: Refusals,
    /// By primitive: objects that moved by themselves, and nobody minded.
    ghosts: BTreeMap<usize, String>,
}

impl Ledger {
    /// Is nothing known yet of the primitive of which this is an instance?
    pub(super) fn is_open<D: Domain>(&self, instance: &Instance<D>) -> bool {
        let index = instance.primitive.index();
        !self.accepted.contains(&index)
            && self.refused.get(&index).is_none_or(|(count, ..)| *count < MANY)
            && self.asked.get(&index).is_none_or(|asked| *asked < MOST_ASKED)
    }

    /// Shows a way to the verifier, for the goal to be where it ends.
    pub(super) fn judge<D: Domain>(&mut self, problem: &Problem<D>, way: &Plan<D>) {
        let m = problem.domain();
        // Whose instance it is, not who proposed it: the transit of a push says nothing about pushes.
        let Some((last, step)) = way.steps().iter().enumerate().next_back() else { return };
        let id = step.instance.primitive;
        *self.asked.entry(id.index()).or_default() += 1;
        entering("verify");
        match problem.verifier().verify(m, problem.start(), &its_end(m, way), way) {
            Ok(_) => {
                self.accepted.insert(id.index());
                if let Some(object) = by_itself(problem, way) {
                    let text =
                        format!("accepted: {object} moves as in a step of {}, while the robot stood still", id.name());
                    self.ghosts.insert(id.index(), text);
                }
            }
            // A verifier may know its goal by itself.
            Err(refusal) => {
                let count = |of: &mut Refusals| {
                    let known = of.get(&id.index()).map_or(0, |(count, ..)| *count);
                    of.insert(id.index(), (known + 1, id, refusal.to_string()));
                };
                if refusal.step == Some(last) {
                    count(&mut self.refused);
                }
                if refusal.step.is_some() {
                    count(&mut self.earlier);
                }
            }
        }
    }

    /// What is no fault in every domain: things may well move by themselves.
    pub(in crate::laws) fn doubts(self) -> Vec<String> {
        self.ghosts.into_values().collect()
    }

    fn verdict(&self) -> Result<(), Broken> {
        // It may refuse what leads to such a step, always, as the touch before a push: that takes more ways.
        let last = (&self.refused, MANY, "ways refused at their last step");
        for (refused, many, which) in [last, (&self.earlier, MANY_EARLIER, "ways that end so refused")] {
            for (primitive, (count, id, why)) in refused {
                let holds = self.accepted.contains(primitive) || *count < many;
                let text = || format!("{count} {which}, the last one because {why}");
                ensure(ACCEPTS, holds, text, "one accepted").map_err(|broken| broken.of(id.name()))?;
            }
        }
        Ok(())
    }
}

/// The object that the last step of an accepted way moves along with the robot, if the way is accepted as well with the robot where
/// that step begins, all the way.
fn by_itself<D: Domain>(problem: &Problem<D>, way: &Plan<D>) -> Option<String> {
    let m = problem.domain();
    let last = way.steps().len().checked_sub(1)?;
    let (before, after) = (way.at(m, last, 0.0)?, way.at(m, last, 1.0)?);
    let robot = State { robot: after.robot.clone(), ..before.clone() };
    let objects = State { robot: before.robot.clone(), ..after.clone() };
    if [&robot, &objects].iter().any(|one| component_travel(m, &before, one) <= LEAST_M) {
        return None;
    }
    let moves = way.steps().get(last)?.instance.moves;
    let object = components(m, moves).into_iter().find(|component| *component != ComponentId::Robot)?;
    let goal = its_end(m, way);
    let judged = Judged {
        domain: m,
        start: problem.start(),
        goal: &goal,
        validity: Some(problem.validity()),
        verifier: problem.verifier(),
    };
    let stands = before.robot;
    let change: Change<D> = Arc::new(move |_, _, state| state.robot.clone_from(&stands));
    let ghost = Forge::new(&judged, way).changed(last, |length| length, change)?;
    entering("verify");
    let is_accepted = problem.verifier().verify(m, problem.start(), &its_end(m, &ghost), &ghost).is_ok();
    is_accepted.then(|| m.component_name(object).into_owned())
}

/// The verifier of `problem` is shown ways that are free, as searches of so many `iterations` and the primitives find them: of
/// those that end with a step of one primitive not all are refused at that step. Up to `most` ways that go on into what is in the
/// way are each refused.
///
/// # Errors
/// [`ACCEPTS`] or [`WAYS_IN`](super::WAYS_IN), with the primitive.
pub fn check_ways<D: Domain>(
    problem: &Problem<D>,
    strategy: &Strategy<D>,
    seed: u64,
    iterations: u64,
    most: usize,
) -> Result<(), Broken> {
    ways_and_doubts(problem, strategy, seed, iterations, most).map(|_| ())
}

/// The same; also what else is worth knowing of the verifier.
pub(in crate::laws) fn ways_and_doubts<D: Domain>(
    problem: &Problem<D>,
    strategy: &Strategy<D>,
    seed: u64,
    iterations: u64,
    most: usize,
) -> Result<Vec<String>, Broken> {
    let about = || format!("check_ways({problem:?}, {strategy:?}, {seed}, {iterations}, {most})");
    // One plan may be looked at for longer than a primitive may take.
    let patience_s = PATIENCE_FACTOR * patience_s();
    let run = || run(problem, strategy, seed, iterations, most);
    with_patience(patience_s, || watched(&about, run)).map_err(|broken| broken.replayed_by(about))
}

fn run<D: Domain>(
    problem: &Problem<D>,
    strategy: &Strategy<D>,
    seed: u64,
    iterations: u64,
    most: usize,
) -> Result<Vec<String>, Broken> {
    let mut ledger = Ledger::default();
    for attempt in 0..ATTEMPTS {
        let mut search = Darrt::new(problem, strategy, seed, attempt, MOST_NODES);
        for _ in 0..iterations {
            entering("an iteration of the search");
            let step = search.step();
            // A solution is no reason to stop: other primitives may not have come yet.
            if step.stop.is_some() {
                break;
            }
        }
        for (id, _) in search.tree().iter() {
            let Some(way) = Plan::to_node(search.tree(), id) else { continue };
            if way.steps().last().is_some_and(|step| ledger.is_open(&step.instance)) {
                ledger.judge(problem, &way);
            }
        }
        if attempt == 0 {
            super::proposed::check(problem, search.tree(), &mut ledger, seed, most)?;
        }
    }
    ledger.verdict()?;
    Ok(ledger.doubts())
}
