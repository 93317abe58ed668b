//! A shorter plan through some of the placements of the objects that a plan goes through.
//!
//! A tree wanders: it pushes here, then there, then back. Every placement of the objects on the way of a found plan is a
//! target that can be reached, so from each the farthest later one is looked for that one extension reaches. Nothing of
//! the old plan is replayed: every step is propagated and checked anew, and the verifier judges the whole.

use std::sync::Arc;

use rand::Rng;

use crate::domain::Domain;
use crate::extend::{ExtendOptions, extend_around};
use crate::partial::PartialState;
use crate::plan::{Plan, Step};
use crate::problem::Problem;
use crate::reroute::Reroute;
use crate::state::{ObjectId, State};

/// How often one extension is drawn before the next nearer target is tried.
const DRAWS: usize = 2;

/// How much effort goes into a shorter plan.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ShortenOptions {
    /// How many extensions are made at most; 0: the plan stays as it was found.
    pub extensions: usize,
}

/// A plan to the goal with fewer steps than `plan`, if one was found. Not verified.
pub fn shorten<D: Domain>(
    problem: &Problem<D>,
    extend: &ExtendOptions,
    reroute: Option<&dyn Reroute<D>>,
    plan: &Plan<D>,
    options: ShortenOptions,
    rng: &mut dyn Rng,
) -> Option<Plan<D>> {
    let m = problem.domain();
    let mut left = options.extensions;
    let mut best: Option<Plan<D>> = None;
    while left > 0 {
        let old = best.as_ref().unwrap_or(plan);
        let targets = placements(m, old);
        let count = old.steps().len();
        match retrace(problem, extend, reroute, &targets, &mut left, rng) {
            Some(found) if found.len() < count => best = Some(Plan::new(problem.start().clone(), found)),
            // As short as this gets.
            Some(_) => break,
            // Another round draws other ways.
            None => {}
        }
    }
    best
}

/// Where the objects that the plan moves stand after each step that moves one.
fn placements<D: Domain>(m: &D, plan: &Plan<D>) -> Vec<PartialState<D>> {
    let start = plan.start();
    let mut before = start.clone();
    let mut targets = Vec::new();
    for index in 0..plan.steps().len() {
        let Some(after) = plan.at(m, index, 1.0) else { break };
        if after.objects != before.objects {
            let ids = (0..after.objects.len()).map(ObjectId::new);
            let moved = ids.filter(|id| after.object(*id) != start.object(*id));
            let target = moved.filter_map(|id| Some((id, after.object(id)?.clone())));
            targets.push(target.fold(PartialState::anywhere(m), |target, (id, at)| target.with_object(id, at)));
        }
        before = after;
    }
    targets
}

/// From the start to the goal, each time to the farthest of the targets that an extension reaches. `None` if that fails,
/// or if the extensions are used up.
fn retrace<D: Domain>(
    problem: &Problem<D>,
    extend: &ExtendOptions,
    reroute: Option<&dyn Reroute<D>>,
    targets: &[PartialState<D>],
    left: &mut usize,
    rng: &mut dyn Rng,
) -> Option<Vec<Step<D>>> {
    let m = problem.domain();
    let mut steps: Vec<Step<D>> = Vec::new();
    let mut here = problem.start().clone();
    let mut done = 0;
    loop {
        // The goal itself is the farthest target.
        let mut reached = None;
        for next in (done..=targets.len()).rev() {
            for _ in 0..DRAWS {
                *left = left.checked_sub(1)?;
                let target = match targets.get(next) {
                    Some(target) => target.clone(),
                    None => problem.goal().sample(m, rng)?,
                };
                let extension = extend_around(problem, extend, reroute, &here, &target, rng);
                let is_goal = |state: &State<D>| problem.goal().is_satisfied(m, state);
                let to_goal = extension.reached.iter().position(|r| is_goal(&r.state));
                if extension.is_met || to_goal.is_some() {
                    reached = Some((next, extension, to_goal));
                    break;
                }
            }
            if reached.is_some() {
                break;
            }
        }
        let (next, extension, to_goal) = reached?;
        let kept = to_goal.map_or(extension.reached.len(), |last| last + 1);
        for r in extension.reached.into_iter().take(kept) {
            match steps.last_mut().filter(|last| Arc::ptr_eq(&last.instance, &r.instance)) {
                Some(last) => last.until = r.t,
                None => steps.push(Step { instance: r.instance, until: r.t, primitive: r.primitive }),
            }
            here = r.state;
        }
        if to_goal.is_some() {
            return Some(steps);
        }
        done = next + 1;
        // Beyond the last target only the goal is left, and this extension went there without satisfying it.
        if done > targets.len() {
            return None;
        }
    }
}
