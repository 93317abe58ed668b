//! A clock that the verifier accepts: corners are rounded as far as what stands around them allows.

use darrt_core::budget::Cancel;

use super::{ClockError, build, tube_m};
use crate::plan_file::PlanFile;
use crate::robot::RobotFacts;
use crate::verify::{Refusal, VerifyOptions, verify_clock};

/// What is left of how far a step may pass its corners after each refusal; then it stops at them.
const AFTER_REFUSALS: [f64; 3] = [1.0, 0.2, 0.0];

/// Gives a plan that has been accepted the clock of [`super::time`]. Where its rounded corners come too near to something, they are
/// rounded less, and at last stopped at; so the clock is accepted too.
///
/// # Laws
/// A function of plan and robot alone, but for `cancel`. Without a clock the plan stays as it is.
///
/// # Errors
/// [`ClockError`] as [`super::time`]; [`NoClock::Refused`] if even a clock that stops at all corners is refused.
pub fn give_clock(
    plan: &mut PlanFile,
    facts: &RobotFacts,
    options: &VerifyOptions,
    cancel: &Cancel,
) -> Result<(), NoClock> {
    let mut refusals = vec![0; plan.steps.len()];
    loop {
        let share =
            |step: usize| refusals.get(step).and_then(|count| AFTER_REFUSALS.get(*count)).copied().unwrap_or(0.0);
        plan.timing = Some(build::time(plan, facts, |step, contract| share(step) * tube_m(*contract))?);
        let Err(refusal) = verify_clock(plan, facts, options, cancel) else { return Ok(()) };
        let step = refusal.step.and_then(|number| usize::try_from(number).ok()?.checked_sub(1));
        match step.and_then(|step| refusals.get_mut(step)) {
            Some(count) if *count + 1 < AFTER_REFUSALS.len() => *count += 1,
            _ => {
                plan.timing = None;
                return Err(NoClock::Refused(Box::new(refusal)));
            }
        }
    }
}

/// Why a plan has no clock.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NoClock {
    /// It cannot be timed.
    #[error(transparent)]
    Clock(#[from] ClockError),
    /// Whatever its clock, the verifier refuses it.
    #[error("no clock is accepted: {0}")]
    Refused(Box<Refusal>),
}
