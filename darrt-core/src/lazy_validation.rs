//! Motions that were taken as free are judged once a plan needs them.
//!
//! Whether a whole motion is free is expensive to find out, and mostly it is: primitives ask about its cornerstones before they
//! propose it. A search that puts the question off asks it for the few motions of a plan, not for all those of a tree.

use std::sync::Arc;

use rand::Rng;

use crate::budget::Stop;
use crate::domain::Domain;
use crate::extend::Extender;
use crate::local_repair::NoWay;
use crate::motion::Instance;
use crate::plan::Step;
use crate::state::State;
use crate::validity::Blame;

/// Why steps stay without a verdict.
#[derive(Debug)]
pub enum NotValidated<D: Domain> {
    /// This motion is blocked, and there is no way around that could be found.
    Blocked(Arc<Instance<D>>, Blame),
    /// Nobody waits for them any more.
    Cancelled,
}

/// Steps that begin at `here`, every motion judged: one that is blocked goes another way between its ends if it may turn
/// aside. What may turn aside goes with as much [care](crate::validity::Validity::most_care) as a way is found for. Without [`ExtendOptions::defer`](crate::extend::ExtendOptions::defer) they have been judged before and stay. Only
/// a cancellation stops it: a plan that was found in time is worth the rest.
///
/// # Errors
/// [`NotValidated`] with the first motion that stays blocked.
///
/// # Source
/// Bohlin and Kavraki, Path planning using lazy PRM, ICRA 2000: edges are checked when a path wants them.
pub fn validate_steps<D: Domain>(
    extender: &Extender<'_, D>,
    here: &State<D>,
    steps: impl IntoIterator<Item = Step<D>>,
    rng: &mut dyn Rng,
) -> Result<Vec<Step<D>>, NotValidated<D>> {
    if !extender.options.defer {
        return Ok(steps.into_iter().collect());
    }
    let m = extender.problem.domain();
    let mut here = here.clone();
    let judged = |step: Step<D>| {
        let (step, _) = validate_step(extender, &here, step, rng)?;
        here = step.instance.at(m, step.until, &here);
        Ok(step)
    };
    steps.into_iter().map(judged).collect()
}

/// One step that begins at `here`, judged, and how much less care than there can be it is free with; see [`validate_steps`].
///
/// # Errors
/// [`NotValidated`] if it stays blocked.
pub(crate) fn validate_step<D: Domain>(
    extender: &Extender<'_, D>,
    here: &State<D>,
    mut step: Step<D>,
    rng: &mut dyn Rng,
) -> Result<(Step<D>, usize), NotValidated<D>> {
    let Extender { problem, local_repair, interrupt, .. } = *extender;
    let (m, validity) = (problem.domain(), problem.validity());
    if interrupt.stop() == Some(Stop::Cancelled) {
        return Err(NotValidated::Cancelled);
    }
    let turns = local_repair.filter(|r| r.is_free_to_turn(m, &step.instance));
    let most = turns.map_or(0, |_| validity.most_care());
    let blocked_by = |care: usize, instance: &Instance<D>, until: f64| {
        let free = validity.free_prefix_with(care, m, instance, here);
        free.blame.filter(|_| free.fraction < until)
    };
    let (mut care, mut may_go_around) = (most, true);
    // The way around that was found, and with how much care it is free.
    let mut known: Option<(Instance<D>, usize)> = None;
    while let Some(blame) = blocked_by(care, &step.instance, step.until) {
        if let Some(r) = turns.filter(|_| may_go_around && known.is_none()) {
            let around = r.repair(m, validity, care, &step.instance, here, rng);
            may_go_around = around.as_ref().err() != Some(&NoWay::WithAnyCare);
            known = around.ok().and_then(|around| {
                let kept = (0..=care).rev().find(|care| blocked_by(*care, &around, 1.0).is_none())?;
                Some((around, kept))
            });
        }
        if let Some((around, _)) = known.take_if(|(_, kept)| *kept >= care) {
            step.instance = Arc::new(around);
            break;
        }
        care = care.checked_sub(1).ok_or_else(|| NotValidated::Blocked(Arc::clone(&step.instance), blame))?;
    }
    Ok((step, most - care))
}
