//! A plan whose motions were taken as free, with those replaced that are not.

use rand::Rng;

use super::leap::{Leap, Old, leap};
use super::rejoin::rejoin;
use crate::domain::Domain;
use crate::extend::Extender;
use crate::lazy_validation::validate_steps;
use crate::plan::Step;
use crate::state::State;

/// How often it is tried to go on from one place before that place is given up, and how often from the first.
const TRIES: usize = 2;
const FIRST_TRIES: usize = 6;

/// A place from which a leap was made: there the new plan can go on otherwise.
struct Fork<D: Domain> {
    /// How many steps the new plan has there.
    kept: usize,
    here: State<D>,
    /// How many placements lie behind.
    done: usize,
    /// How often it may still be tried to go on.
    tries_left: usize,
}

/// Judges the old plan from placement to placement. A motion that is blocked is passed by leaps that are judged, of at most
/// `left` extensions, which come back to the old plan where they can.
pub(super) fn mend<D: Domain>(
    extender: &Extender<'_, D>,
    old: &Old<'_, D>,
    mut left: usize,
    rng: &mut dyn Rng,
) -> Option<Vec<Step<D>>> {
    let m = extender.problem.domain();
    let mut steps: Vec<Step<D>> = Vec::new();
    let mut here = old.plan.start().clone();
    let mut done = 0;
    // The step of the old plan that goes on from here, if it lies there.
    let mut next = Some(0);
    // By number of placements behind: is what follows known to be blocked?
    let mut is_blocked = vec![false; old.placements.len() + 1];
    let mut forks: Vec<Fork<D>> = Vec::new();
    loop {
        if let Some(at) = next.take() {
            let end = old.end(done);
            if let Ok(known) = validate_steps(extender, &here, old.steps(at..end), rng) {
                steps.extend(known);
                if done == old.placements.len() {
                    return Some(steps);
                }
                here = old.plan.at(m, end - 1, 1.0)?;
                done += 1;
                next = Some(end);
                continue;
            }
            *is_blocked.get_mut(done)? = true;
        } else if !*is_blocked.get(done)?
            && let Some(joint) = rejoin(extender, old, done, &here, &mut left, rng)
            && let Ok(joining) = validate_steps(extender, &here, joint.steps, rng)
        {
            steps.extend(joining);
            here = old.plan.at(m, joint.step - 1, 1.0)?;
            next = Some(joint.step);
            continue;
        }
        let tries_left = if forks.is_empty() { FIRST_TRIES } else { TRIES };
        forks.push(Fork { kept: steps.len(), here: here.clone(), done, tries_left });
        let judge = &mut |here: &State<D>, _, steps: Vec<Step<D>>, rng: &mut dyn Rng| {
            validate_steps(extender, here, steps, rng).ok()
        };
        loop {
            if left == 0 || extender.interrupt.stop().is_some() {
                return None;
            }
            while forks.last().is_some_and(|last| last.tries_left == 0) {
                forks.pop();
            }
            let fork = forks.last_mut()?;
            fork.tries_left -= 1;
            steps.truncate(fork.kept);
            let Some(Leap { steps: leapt, end, passed }) =
                leap(extender, &fork.here, old.ahead(fork.done), &mut left, judge, rng)
            else {
                continue;
            };
            steps.extend(leapt);
            let Some(passed) = passed else { return Some(steps) };
            here = end;
            done = fork.done + passed;
            break;
        }
    }
}
