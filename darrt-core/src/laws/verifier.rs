//! Laws of [`Verifier`]: good plans are broken on purpose, and each must be refused.

use std::sync::Arc;

use rand::RngExt;

use crate::domain::Domain;
use crate::goal::Goal;
use crate::plan::Plan;
use crate::state::State;
use crate::validity::Validity;
use crate::verify::{Refusal, Verified, Verifier};

use super::feed::rng_of;
use super::watch::{entering, watched};
use super::{Broken, ensure, equal};

pub(in crate::laws) mod each_primitive;
mod forge;
mod motions;
mod proposed;
mod steps;

pub use each_primitive::check_ways;

/// Broken plans.
pub const REFUSES: &str = "verifier.refuses: a good plan that was broken on purpose is refused";
/// Steady.
pub const STEADY: &str = "verifier.steady: the same plan gets the same verdict, whatever was judged in between";
/// Other problems.
pub const ITS_GOAL: &str = "verifier.its-goal: a plan is judged by the goal and the start that are handed in";

/// Refusals.
pub const REFUSAL: &str =
    "verifier.refusal: a refusal says why, and names a step of the plan and a fraction in [0, 1] of it, or no step";
/// Measured clearances.
pub const CLEARANCE: &str = "verifier.clearance: a clearance of an accepted plan is finite and not negative";
/// Accepts.
pub const ACCEPTS: &str = "verifier.accepts: of many ways that the search found free not all are refused at one of their steps, for the goal to be where each ends, nor are four plans to the goal of the problem all refused, nor all of six ways at the step of one primitive, or all of thirty-two that end with one";
/// Blocked proposals.
pub const WAYS_IN: &str = "verifier.ways-in: a plan that goes on by what a primitive proposes until it is well inside of what blocks it, by 5 cm at least whichever way one looks, is refused";

/// The laws of this file.
pub const LAWS: &[&str] = &[REFUSES, STEADY, ITS_GOAL, REFUSAL, CLEARANCE, ACCEPTS, WAYS_IN];

/// How often each way is tried, at other steps and with other numbers.
const TRIES: u64 = 3;

/// What was tried on a verifier.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Tampered {
    /// The ways in which the plan could be broken, and was.
    pub tried: Vec<&'static str>,
    /// The ways in which this plan cannot be broken: it has too few steps, or nothing that could be moved.
    pub left_out: Vec<&'static str>,
}

/// The parts of a problem that a verifier is judged with.
pub struct Judged<'a, D: Domain> {
    /// M.
    pub domain: &'a D,
    /// Where the plan starts.
    pub start: &'a State<D>,
    /// Where it should end.
    pub goal: &'a dyn Goal<D>,
    /// What tells which states are in the way of something: to lead plans through them.
    pub validity: Option<&'a dyn Validity<D>>,
    /// The judge.
    pub verifier: &'a dyn Verifier<D>,
}

impl<D: Domain> std::fmt::Debug for Judged<'_, D> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Judged").field("start", &self.start).finish_non_exhaustive()
    }
}

impl<D: Domain> Judged<'_, D> {
    fn verdict(&self, plan: &Plan<D>) -> Result<Verified, Refusal> {
        entering("verify");
        self.verifier.verify(self.domain, self.start, self.goal, plan)
    }
}

/// One way to break a plan: `None` if this plan cannot be broken like this.
struct Tampering<D: Domain> {
    name: &'static str,
    change: fn(&forge::Forge<'_, D>, &mut crate::random::Stream) -> Option<Plan<D>>,
}

/// Breaks `plan`, which the verifier accepts, in all the ways that this plan allows: steps missing, swapped, twice, backwards,
/// cut; jumps, penetrations, wrong ends, moved bystanders, early releases, numbers that are none. The verifier must refuse all
/// of them, and go on accepting the plan itself.
///
/// # Errors
/// [`REFUSES`] with the way that was accepted, [`STEADY`] or [`ITS_GOAL`]; [`STEADY`] also if the plan itself is refused.
pub fn check_verifier<D: Domain>(judged: &Judged<'_, D>, plan: &Plan<D>, seed: u64) -> Result<Tampered, Broken> {
    let about = || format!("check_verifier({seed}), for a plan of {} steps", plan.steps().len());
    let check = || {
        accepted(judged, plan)?;
        let forge = forge::Forge::new(judged, plan);
        let mut tampered = Tampered::default();
        for way in steps::ways().into_iter().chain(motions::ways()) {
            let mut is_tried = false;
            for attempt in 0..TRIES {
                let mut rng = rng_of(&(seed, attempt, way.name));
                let Some(broken) = (way.change)(&forge, &mut rng) else { continue };
                is_tried = true;
                match judged.verdict(&broken) {
                    Ok(verified) => {
                        let found = format!("accepted, with a clearance of {:?}", verified.clearance_m);
                        return Err(Broken::new(REFUSES, found, "refused").of(way.name));
                    }
                    Err(refusal) => readable(&refusal, &broken).map_err(|broken| broken.of(way.name))?,
                }
            }
            (if is_tried { &mut tampered.tried } else { &mut tampered.left_out }).push(way.name);
        }
        other_problems(judged, plan, seed)?;
        accepted(judged, plan)?;
        Ok(tampered)
    };
    watched(&about, check).map_err(|broken| broken.replayed_by(about))
}

/// Twice, with the same clearance.
fn accepted<D: Domain>(judged: &Judged<'_, D>, plan: &Plan<D>) -> Result<(), Broken> {
    let [first, second] = [(), ()].map(|()| judged.verdict(plan));
    let refused = |refusal: Refusal| Broken::new(STEADY, refusal.to_string(), "accepted, as before");
    let (first, second) = (first.map_err(refused)?, second.map_err(refused)?);
    clearance(&first)?;
    equal(STEADY, &second.clearance_m, &first.clearance_m).map_err(|broken| broken.of("clearance"))
}

/// Overlaps by less are rounding, metres.
const ROUNDING_M: f64 = 1e-6;

/// What it measured can be.
pub(super) fn clearance(verified: &Verified) -> Result<(), Broken> {
    let holds = verified.clearance_m.is_none_or(|metres| metres.is_finite() && metres >= -ROUNDING_M);
    ensure(CLEARANCE, holds, || format!("{:?} m", verified.clearance_m), "finite and not negative, or none")
}

/// A refusal that people can read.
fn readable<D: Domain>(refusal: &Refusal, plan: &Plan<D>) -> Result<(), Broken> {
    let is_step = refusal.step.is_none_or(|step| step < plan.steps().len());
    let holds = !refusal.reason.trim().is_empty() && is_step && (0.0..=1.0).contains(&refusal.at);
    let text = || format!("{refusal:?} of {} steps", plan.steps().len());
    ensure(REFUSAL, holds, text, "a reason, and a step that there is")
}

/// What shares of the way elsewhere a component of the start is aside.
const SHARES: [f64; 3] = [0.3, 0.1, 0.03];

/// The same plan for a goal that nothing satisfies, and for another start.
fn other_problems<D: Domain>(judged: &Judged<'_, D>, plan: &Plan<D>, seed: u64) -> Result<(), Broken> {
    let m = judged.domain;
    let never = crate::goal::AnyOf::new(Vec::new());
    entering("verify");
    if judged.verifier.verify(m, judged.start, &never, plan).is_ok() {
        return Err(Broken::new(ITS_GOAL, "accepted for a goal that no state satisfies", "refused"));
    }
    let mut rng = rng_of(&(seed, "start"));
    let _: u64 = rng.random();
    let far = super::feed::elsewhere(m, judged.start, &mut rng);
    // All of it elsewhere, and one component a little aside.
    let aside = super::feed::everything(m).into_iter().flat_map(|component| {
        SHARES.map(|share| {
            let mut near = judged.start.clone();
            super::feed::drift(m, &mut near, &far, component, share);
            near
        })
    });
    for other in std::iter::once(far.clone()).chain(aside) {
        if other != *judged.start && judged.verifier.verify(m, &other, judged.goal, plan).is_ok() {
            let found = format!("accepted for the start {other:?}");
            return Err(Broken::new(ITS_GOAL, found, "refused: it starts elsewhere"));
        }
    }
    Ok(())
}

/// A state that a plan can be led through, though it must not: rejected with and without contacts.
fn rejected<D: Domain>(judged: &Judged<'_, D>, state: &State<D>, instance: &Arc<crate::motion::Instance<D>>) -> bool {
    let Some(validity) = judged.validity else { return false };
    let is_rejected = |contacts: &D::Contacts| validity.check(judged.domain, state, contacts).is_err();
    is_rejected(&D::Contacts::default()) && is_rejected(&instance.contacts)
}
