//! Whether a clock is one, for the plan that it belongs to: counts, order and numbers. Whether the robot can follow it is the
//! verifier's question.

use super::ClockError;
use crate::plan_file::PlanFile;
use crate::plan_file::timing::{Phase, Timing};

/// How much the lengths of a profile may be off the way, and sums of seconds off each other, as a part of them.
const SLACK: f64 = 1e-6;

/// Longest time of a piece, a phase or a plan, seconds.
const LONGEST_S: f64 = 1e7;

/// # Errors
/// [`ClockError::Timing`] with the first place at fault.
pub(crate) fn check(plan: &PlanFile, timing: &Timing) -> Result<(), ClockError> {
    let fault = |place: String, why: String| Err(ClockError::Timing { place, why });
    let (found, expected) = (timing.steps.len(), plan.steps.len());
    if found != expected {
        return fault(
            "timing.steps".to_owned(),
            format!(
                "has {found} entries for {expected} steps; a plan whose steps were edited gets a new clock if `timing` is deleted"
            ),
        );
    }
    let mut sum_s = 0.0;
    for (index, (step, clock)) in plan.steps.iter().zip(&timing.steps).enumerate() {
        let mut at = 0;
        for (number, phase) in clock.phases.iter().enumerate() {
            let place = || format!("timing.steps[{index}].phases[{number}]");
            match flaw(phase, at, step.waypoints.len()) {
                Some(why) => return fault(place(), why),
                None => at = phase.knots.last().copied().unwrap_or(at),
            }
            sum_s += phase.duration_s();
        }
        let end = step.waypoints.len().saturating_sub(1);
        if at != end && !clock.phases.is_empty() {
            return fault(format!("timing.steps[{index}]"), format!("ends at waypoint {at}, the step at {end}"));
        }
        if clock.phases.is_empty() && step.waypoints.iter().any(|waypoint| Some(waypoint) != step.waypoints.first()) {
            return fault(format!("timing.steps[{index}]"), "has no phases, but the robot moves".to_owned());
        }
    }
    let said = timing.duration_s;
    if said.is_nan() || (said - sum_s).abs() > SLACK * (1.0 + sum_s) {
        return fault("timing.duration_s".to_owned(), format!("is {said}, but the steps take {sum_s}"));
    }
    Ok(())
}

/// What is wrong with a phase that begins at the waypoint `at`, of `count`.
fn flaw(phase: &Phase, at: usize, count: usize) -> Option<String> {
    let Phase { knots, lengths, blends, profile, wait_s, rest_s } = phase;
    if knots.len() < 2 || lengths.len() + 1 != knots.len() || blends.len() + 2 != knots.len() {
        let [k, l, b] = [knots.len(), lengths.len(), blends.len()];
        return Some(format!("has {k} knots, {l} lengths and {b} blends; n, n - 1 and n - 2 are wanted, n at least 2"));
    }
    if knots.first() != Some(&at) {
        return Some(format!("begins at waypoint {}, must begin at {at}", knots.first().unwrap_or(&0)));
    }
    if let Some(knot) = knots.iter().find(|knot| **knot >= count) {
        return Some(format!("there is no waypoint {knot}, the step has {count}"));
    }
    if !knots.windows(2).all(|pair| pair.first() < pair.last()) {
        return Some("the knots must grow".to_owned());
    }
    let wait = |value: f64| (0.0..=LONGEST_S).contains(&value);
    if let Some(value) = lengths.iter().find(|value| !(1e-12..=LONGEST_S).contains(*value)) {
        return Some(format!("a length is {value}, must be in [1e-12, {LONGEST_S:e}]"));
    }
    if let Some(value) = blends.iter().chain([wait_s, rest_s]).find(|value| !wait(**value)) {
        return Some(format!("a blend, a wait or a rest is {value}, must be in [0, {LONGEST_S:e}]"));
    }
    let radius = |knot: usize| knot.checked_sub(1).and_then(|inner| blends.get(inner)).copied().unwrap_or(0.0);
    for (line, length) in lengths.iter().enumerate() {
        let both = radius(line) + radius(line + 1);
        if both > length * (1.0 + SLACK) {
            return Some(format!("the blends at the ends of line {line} are {both} together, it is {length} long"));
        }
    }
    if let Some([seconds, jerk]) = profile.iter().find(|[seconds, jerk]| !wait(*seconds) || !jerk.is_finite()) {
        return Some(format!("a piece of the profile is [{seconds}, {jerk}]"));
    }
    ends(phase)
}

/// A profile goes forwards only, and ends where the way does, at rest.
fn ends(phase: &Phase) -> Option<String> {
    let mut here = super::profile::Progress::default();
    let (mut fastest, mut hardest) = (0.0_f64, 0.0_f64);
    for [seconds, jerk] in &phase.profile {
        here = here.after(*seconds, *jerk);
        if here.speed < -SLACK * (1.0 + fastest) {
            return Some(format!("the profile goes backwards: its speed is {}", here.speed));
        }
        (fastest, hardest) = (fastest.max(here.speed), hardest.max(here.acceleration.abs()));
    }
    let length = phase.length();
    // Written so that what is no number is at fault.
    let fits = (here.length - length).abs() <= SLACK * length
        && here.speed.abs() <= SLACK * fastest
        && here.acceleration.abs() <= SLACK * hardest;
    let found = format!("length {}, speed {} and acceleration {}", here.length, here.speed, here.acceleration);
    (!fits).then(|| format!("the profile ends at {found}; wanted are {length}, 0 and 0"))
}
