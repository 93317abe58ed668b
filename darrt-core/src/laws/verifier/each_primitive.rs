//! Does a verifier accept what each primitive does?

use std::collections::BTreeMap;

use super::{ACCEPTS, Broken};
use crate::domain::Domain;
use crate::laws::ensure;
use crate::laws::watch::entering;
use crate::partial::PartialState;
use crate::plan::Plan;
use crate::problem::Problem;
use crate::search::{Darrt, Strategy};

/// So many attempts are searched for ways.
const ATTEMPTS: u64 = 2;
const MOST_NODES: usize = 512;
/// So many ways of one primitive are judged at most, and not all refused at the step of that primitive.
const MANY: usize = 6;

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

/// Ways that the search found free and that end with a step of a primitive: of none of them all are refused at that step.
pub(in crate::laws) fn check<D: Domain>(
    problem: &Problem<D>,
    strategy: &Strategy<D>,
    seed: u64,
    iterations: u64,
) -> Result<(), Broken> {
    let m = problem.domain();
    let mut refused: BTreeMap<u16, (usize, String)> = BTreeMap::new();
    let mut accepted = Vec::new();
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
            let Some((last, step)) = way.steps().iter().enumerate().next_back() else { continue };
            let primitive = step.primitive;
            let count = refused.get(&primitive).map_or(0, |(count, _)| *count);
            if accepted.contains(&primitive) || count >= MANY {
                continue;
            }
            entering("verify");
            match problem.verifier().verify(m, problem.start(), &its_end(m, &way), &way) {
                Ok(_) => accepted.push(primitive),
                // What it refuses earlier is another's, and a verifier may know its goal by itself.
                Err(refusal) if refusal.step == Some(last) => {
                    refused.insert(primitive, (count + 1, refusal.to_string()));
                }
                Err(_) => {}
            }
        }
    }
    for (primitive, (count, why)) in &refused {
        let holds = accepted.contains(primitive) || *count < MANY;
        let text = || format!("{count} ways refused at their last step, the last one because {why}");
        let name = problem.primitives().get(usize::from(*primitive)).map_or("a primitive", |p| p.name());
        ensure(ACCEPTS, holds, text, "one accepted").map_err(|broken| broken.of(name))?;
    }
    Ok(())
}
