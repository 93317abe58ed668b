//! Laws of [`Goal`].

use crate::domain::Domain;
use crate::goal::Goal;
use crate::random::{Purpose, stream};
use crate::state::State;

use super::{Broken, ensure, equal};

/// Samples lie in the goal set.
pub const SAMPLED: &str =
    "goal.sampled: a state that meets a sample of the goal, in a mode that it accepts, satisfies the goal";
/// Samples fit the domain.
pub const FITS: &str = "goal.fits: samples of the goal have the objects of the domain and lie in its spaces";
/// Pure.
pub const PURE: &str = "goal.pure: the same state and the same generator have the same answer";

/// The laws of this file.
pub const LAWS: &[&str] = &[SAMPLED, FITS, PURE];

/// All laws of a goal, for one seed; `from` lends the components that a sample leaves open, and must be
/// in a mode that the goal accepts.
///
/// # Errors
/// The first law that is [`Broken`].
pub fn check_goal<D: Domain>(m: &D, goal: &dyn Goal<D>, from: &State<D>, seed: u64) -> Result<(), Broken> {
    let draw = |i| goal.sample(m, &mut stream(seed, 0, i, Purpose::Sample));
    let check = || {
        let satisfied = goal.is_satisfied(m, from);
        let sample = draw(0);
        let _ = draw(1);
        equal(PURE, &draw(0), &sample)?;
        if let Some(target) = &sample {
            target.check(m).map_err(|error| Broken::new(FITS, error.to_string(), "a target of the domain"))?;
            let met = target.overlay(m, from);
            let text = || format!("{met:?} does not satisfy the goal");
            ensure(SAMPLED, goal.is_satisfied(m, &met), text, "satisfied: it meets a sample")?;
            if target.is_met(m, from) {
                ensure(SAMPLED, satisfied, || format!("{from:?} does not satisfy it"), "satisfied: it meets a sample")?;
            }
        }
        equal(PURE, &goal.is_satisfied(m, from), &satisfied)
    };
    check().map_err(|broken| broken.replayed_by(|| format!("check_goal(&{from:?}, {seed})")))
}
