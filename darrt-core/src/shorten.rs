//! A shorter plan through some of the placements of the objects that a plan goes through.
//!
//! A tree wanders: it pushes here, then there, then back. Every placement of the objects on the way of a found plan is a
//! target that can be reached, so from each a later one is looked for that one extension reaches with fewer steps
//! (`leap`). Between two of them the robot alone moves, so what leapt can come back to the old plan (`rejoin`), which goes
//! on from there. The motions of the shortest plan are then judged if the search took them as free, and one that is not is
//! passed by other leaps (`mend`). The verifier judges the whole.

mod leap;
mod mend;
mod rejoin;

use rand::Rng;

use crate::domain::Domain;
use crate::extend::Extender;
use crate::plan::{Plan, Step};

pub(crate) use leap::joined;
use leap::{Leap, Old, leap};
use mend::mend;
use rejoin::rejoin;

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
    let best = retraced(extender, plan, options, rng);
    if extender.options.defer { mended(extender, plan, best.as_ref(), options, rng) } else { best }
}

/// A plan to the goal with fewer steps than `plan`, whose motions have not been judged if the search puts that off.
pub(crate) fn retraced<D: Domain>(
    extender: &Extender<'_, D>,
    plan: &Plan<D>,
    options: ShortenOptions,
    rng: &mut dyn Rng,
) -> Option<Plan<D>> {
    let mut left = options.extensions;
    let mut best: Option<Plan<D>> = None;
    let m = extender.problem.domain();
    while left > 0 && extender.interrupt.stop().is_none() {
        let old = best.as_ref().unwrap_or(plan);
        let found = retrace(extender, &Old::new(m, old), &mut left, rng);
        if found.len() >= old.steps().len() {
            break;
        }
        best = Some(Plan::new(plan.start().clone(), found));
    }
    best
}

/// The plan that was made `short`, or else the plan itself, with every motion judged and those that are blocked passed by
/// others.
pub(crate) fn mended<D: Domain>(
    extender: &Extender<'_, D>,
    plan: &Plan<D>,
    short: Option<&Plan<D>>,
    options: ShortenOptions,
    rng: &mut dyn Rng,
) -> Option<Plan<D>> {
    // What cannot be mended may have been leapt to for nothing: the plan itself has more placements to come through.
    let m = extender.problem.domain();
    let mut mended = |old: &Plan<D>| mend(extender, &Old::new(m, old), options.extensions, rng);
    let steps = short.and_then(&mut mended).or_else(|| mended(plan))?;
    Some(Plan::new(plan.start().clone(), steps))
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

/// From the start to the goal: leaps from placement to placement where an extension reaches one with fewer steps, back to
/// the old plan where none does, and along it where that takes no more steps than it saved.
fn retrace<D: Domain>(
    extender: &Extender<'_, D>,
    old: &Old<'_, D>,
    left: &mut usize,
    rng: &mut dyn Rng,
) -> Vec<Step<D>> {
    let m = extender.problem.domain();
    let mut steps: Vec<Step<D>> = Vec::new();
    let mut here = old.plan.start().clone();
    let mut anchor = Anchor { kept: 0, step: 0, done: 0 };
    let mut done = 0;
    let mut is_on_old = true;
    loop {
        // While it lies on the old plan, where it stands there is known; else it stands at a placement.
        let at = if is_on_old { anchor.step } else { old.begin(done) };
        let is_shorter = |passed: Option<usize>, steps: &[Step<D>]| {
            let until = passed.map_or(old.len(), |passed| old.begin(done + passed));
            steps.len() < until - at
        };
        let judge = &mut |_: &_, passed, steps: Vec<_>, _: &mut dyn Rng| is_shorter(passed, &steps).then_some(steps);
        if let Some(Leap { steps: leapt, end, passed }) = leap(extender, &here, old.ahead(done), left, judge, rng) {
            steps.extend(leapt);
            here = end;
            is_on_old = false;
            match passed {
                Some(passed) => done += passed,
                None => return steps,
            }
            continue;
        }
        if !is_on_old {
            let joint = rejoin(extender, old, done, &here, left, rng);
            let saves = |step: usize, joining: usize| anchor.kept + (step - anchor.step) > steps.len() + joining;
            if let Some(joint) = joint.filter(|joint| saves(joint.step, joint.steps.len())) {
                steps.extend(joint.steps);
                anchor = Anchor { kept: steps.len(), step: joint.step, done };
            } else {
                steps.truncate(anchor.kept);
                done = anchor.done;
            }
        }
        let end = old.end(done);
        steps.extend(old.steps(anchor.step..end));
        let next = (done < old.placements.len()).then(|| old.plan.at(m, end - 1, 1.0)).flatten();
        let Some(state) = next else { return steps };
        here = state;
        done += 1;
        anchor = Anchor { kept: steps.len(), step: end, done };
        is_on_old = true;
    }
}
