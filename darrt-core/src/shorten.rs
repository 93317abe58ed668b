//! A shorter plan through some of the placements of the objects that a plan goes through.
//!
//! A tree wanders: it pushes here, then there, then back. Every placement of the objects on the way of a found plan is a
//! target that can be reached, so from each a later one is looked for that one extension reaches. Where none is found the
//! old steps stay. The motions of the shortest plan are then judged if the search took them as free, and one that is not is
//! passed by other leaps. The verifier judges the whole.

use std::sync::Arc;

use rand::Rng;

use crate::domain::Domain;
use crate::extend::{Extender, Reached};
use crate::partial::PartialState;
use crate::plan::{Plan, Step};
use crate::settle::settle;
use crate::state::{ObjectId, State};

/// How often one extension is drawn before the next nearer target is tried.
const DRAWS: usize = 2;

/// The plan is as short as it gets when this many rounds found nothing.
const FRUITLESS_ROUNDS: usize = 2;

/// How much effort goes into a shorter plan.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ShortenOptions {
    /// How many extensions are made at most; 0: the plan stays as it was found.
    pub extensions: usize,
}

/// A plan to the goal with fewer steps than `plan`, or with as many whose motions have been judged if the search put that
/// off, if one was found before the extender is interrupted. Not verified.
pub fn shorten<D: Domain>(
    extender: &Extender<'_, D>,
    plan: &Plan<D>,
    options: ShortenOptions,
    rng: &mut dyn Rng,
) -> Option<Plan<D>> {
    let mut left = options.extensions;
    let mut best: Option<Plan<D>> = None;
    let mut fruitless = 0;
    while left > 0 && fruitless < FRUITLESS_ROUNDS && extender.interrupt.stop().is_none() {
        let old = best.as_ref().unwrap_or(plan);
        let found = retrace(extender, old, &mut left, rng);
        if found.len() < old.steps().len() {
            best = Some(Plan::new(plan.start().clone(), found));
            fruitless = 0;
        } else {
            fruitless += 1;
        }
    }
    if !extender.options.defer {
        return best;
    }
    let steps = mend(extender, best.as_ref().unwrap_or(plan), options.extensions, rng)?;
    Some(Plan::new(plan.start().clone(), steps))
}

/// Where the objects stand after a step that moves one.
struct Placement<D: Domain> {
    /// Index of the step.
    step: usize,
    /// The objects that the plan has moved so far, where they are.
    target: PartialState<D>,
}

fn placements<D: Domain>(m: &D, plan: &Plan<D>) -> Vec<Placement<D>> {
    let start = plan.start();
    let mut before = start.clone();
    let mut placements = Vec::new();
    for step in 0..plan.steps().len() {
        let Some(after) = plan.at(m, step, 1.0) else { break };
        if after.objects != before.objects {
            let ids = (0..after.objects.len()).map(ObjectId::new);
            let moved = ids.filter(|id| after.object(*id) != start.object(*id));
            let named = moved.filter_map(|id| Some((id, after.object(id)?.clone())));
            let target = named.fold(PartialState::anywhere(m), |target, (id, at)| target.with_object(id, at));
            placements.push(Placement { step, target });
        }
        before = after;
    }
    placements
}

/// The last place at which the new plan lies on the old one.
#[derive(Clone, Copy)]
struct Anchor {
    /// How many steps the new plan has there.
    kept: usize,
    /// The step of the old plan that begins there.
    step: usize,
    /// How many placements lie behind.
    done: usize,
}

/// From the start to the goal: leaps from placement to placement where an extension reaches one, and keeps the old
/// steps where none does.
fn retrace<D: Domain>(extender: &Extender<'_, D>, old: &Plan<D>, left: &mut usize, rng: &mut dyn Rng) -> Vec<Step<D>> {
    let m = extender.problem.domain();
    let placements = placements(m, old);
    let mut steps: Vec<Step<D>> = Vec::new();
    let mut here = old.start().clone();
    let mut done = 0;
    let mut anchor = Anchor { kept: 0, step: 0, done: 0 };
    loop {
        let ahead = placements.get(done..).unwrap_or_default();
        if let Some(leap) = leap(extender, &here, ahead, left, &mut |_, steps, _| Some(steps), rng) {
            steps.extend(leap.steps);
            here = leap.end;
            match leap.passed {
                Some(passed) => done += passed,
                None => return steps,
            }
            continue;
        }
        steps.truncate(anchor.kept);
        let known = |last: usize| old.steps().get(anchor.step..=last).unwrap_or_default().iter().cloned();
        let kept = placements.get(anchor.done).and_then(|next| Some((next.step, old.at(m, next.step, 1.0)?)));
        let Some((last, state)) = kept else {
            steps.extend(known(old.steps().len().saturating_sub(1)));
            return steps;
        };
        steps.extend(known(last));
        here = state;
        done = anchor.done + 1;
        anchor = Anchor { kept: steps.len(), step: last + 1, done };
    }
}

/// Judges the old plan from placement to placement. Behind a motion that is blocked it goes on in leaps that are judged, of
/// at most `left` extensions; where they end nowhere others are tried.
fn mend<D: Domain>(
    extender: &Extender<'_, D>,
    old: &Plan<D>,
    mut left: usize,
    rng: &mut dyn Rng,
) -> Option<Vec<Step<D>>> {
    let m = extender.problem.domain();
    let placements = placements(m, old);
    let mut steps: Vec<Step<D>> = Vec::new();
    let mut here = old.start().clone();
    let mut done = 0;
    loop {
        let begin = steps.len();
        let end = placements.get(done).map_or(old.steps().len(), |next| next.step + 1);
        let known = old.steps().get(begin..end).unwrap_or_default().iter().cloned();
        let Ok(known) = settle(extender, &here, known, rng) else { break };
        steps.extend(known);
        if done == placements.len() {
            return Some(steps);
        }
        here = old.at(m, end - 1, 1.0)?;
        done += 1;
    }
    while left > 0 && extender.interrupt.stop().is_none() {
        let ahead = placements.get(done..).unwrap_or_default();
        if let Some(behind) = leaps(extender, here.clone(), ahead, &mut left, rng) {
            steps.extend(behind);
            return Some(steps);
        }
    }
    None
}

/// To the goal in leaps that are judged, if each is followed by another.
fn leaps<D: Domain>(
    extender: &Extender<'_, D>,
    mut here: State<D>,
    mut ahead: &[Placement<D>],
    left: &mut usize,
    rng: &mut dyn Rng,
) -> Option<Vec<Step<D>>> {
    let judge = &mut |here: &State<D>, steps: Vec<Step<D>>, rng: &mut dyn Rng| settle(extender, here, steps, rng).ok();
    let mut steps = Vec::new();
    loop {
        let leap = leap(extender, &here, ahead, left, judge, rng)?;
        steps.extend(leap.steps);
        here = leap.end;
        match leap.passed {
            Some(passed) => ahead = ahead.get(passed..).unwrap_or_default(),
            None => return Some(steps),
        }
    }
}

/// What becomes of the steps of a leap from a state; `None`: it is not made.
type Judge<'a, D> = &'a mut dyn FnMut(&State<D>, Vec<Step<D>>, &mut dyn Rng) -> Option<Vec<Step<D>>>;

/// An extension to a placement, or to the goal.
struct Leap<D: Domain> {
    steps: Vec<Step<D>>,
    end: State<D>,
    /// How many placements lie behind now; `None` at the goal.
    passed: Option<usize>,
}

/// The goal if one extension reaches it, else the placement half as far ahead, and so on down to the next.
fn leap<D: Domain>(
    extender: &Extender<'_, D>,
    here: &State<D>,
    ahead: &[Placement<D>],
    left: &mut usize,
    judge: Judge<'_, D>,
    rng: &mut dyn Rng,
) -> Option<Leap<D>> {
    let Extender { problem, interrupt, .. } = *extender;
    let m = problem.domain();
    let mut count = ahead.len() + 1;
    while count > 0 {
        for _ in 0..DRAWS {
            *left = left.checked_sub(1)?;
            if interrupt.stop().is_some() {
                return None;
            }
            let goal = if count > ahead.len() { Some(problem.goal().sample(m, rng)?) } else { None };
            let Some(target) = goal.as_ref().or(ahead.get(count - 1).map(|p| &p.target)) else { break };
            let mut extension = extender.extend(here, target, rng);
            let is_goal = |reached: &Reached<D>| problem.goal().is_satisfied(m, &reached.state);
            let passed = if let Some(last) = extension.reached.iter().position(is_goal) {
                extension.reached.truncate(last + 1);
                None
            } else if extension.is_met && count <= ahead.len() {
                Some(count)
            } else {
                continue;
            };
            let end = extension.reached.last().map_or_else(|| here.clone(), |last| last.state.clone());
            if let Some(steps) = judge(here, joined(extension.reached), rng) {
                return Some(Leap { steps, end, passed });
            }
        }
        count /= 2;
    }
    None
}

/// What an extension reached, the states of one instance as one step.
pub(crate) fn joined<D: Domain>(reached: Vec<Reached<D>>) -> Vec<Step<D>> {
    let mut steps: Vec<Step<D>> = Vec::new();
    for r in reached {
        match steps.last_mut().filter(|last| Arc::ptr_eq(&last.instance, &r.instance)) {
            Some(last) => last.until = r.t,
            None => steps.push(Step { instance: r.instance, until: r.t, primitive: r.primitive }),
        }
    }
    steps
}
