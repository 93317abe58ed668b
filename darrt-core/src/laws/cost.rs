//! Laws of [`ExecutionCost`].

use crate::cost::ExecutionCost;
use crate::domain::Domain;
use crate::motion::Instance;
use crate::random::{Purpose, stream};
use crate::space::ComponentSpace;
use crate::state::{ComponentSet, State};

use super::watch::{drawing, entering, watched};
use super::{Broken, alike, at_most, ensure, measure};

/// Costs are a measure.
pub const FINITE: &str = "cost.finite: seconds, step_s, between and arrival are finite and not negative";
/// Pure.
pub const PURE: &str = "cost.pure: the same question has the same answer, bit for bit";
/// A part costs at most as much as the whole.
pub const GROWS: &str = "cost.grows: a part of a motion costs at most as much as the whole, and a hundredth of it less";
/// What every step takes is in what it takes.
pub const STEP: &str = "cost.step: step_s is part of what a step takes";
/// The guess is of the order of what it guesses.
pub const BETWEEN: &str = "cost.between: what it guesses for a way that is free is at most ten times what it takes, and no more than a step for no way at all";
/// Stopovers.
pub const STOPOVER: &str = "cost.stopover: what is proposed is the same for the same generator, and names objects of the domain in their spaces and nothing else";

/// The laws of this file.
pub const LAWS: &[&str] = &[FINITE, PURE, GROWS, STEP, BETWEEN, STOPOVER];

/// Where motions are cut.
const CUTS: [f64; 6] = [0.01, 0.1, 0.25, 0.5, 0.9, 1.0];
/// The guess is off by this factor at most.
const FACTOR: f64 = 10.0;
/// Rounding that is forgiven, in seconds per second.
const SLACK: f64 = 1e-9;

/// All laws of a cost, for an instance that begins at `from`.
///
/// # Errors
/// The first law that is [`Broken`].
pub fn check_cost<D: Domain>(
    m: &D,
    cost: &dyn ExecutionCost<D>,
    instance: &Instance<D>,
    from: &State<D>,
) -> Result<(), Broken> {
    let about = || format!("check_cost(&{instance:?}, &{from:?})");
    let of = |broken: Broken| broken.of(format_args!("instance {:?}", instance.primitive));
    watched(&about, || run(m, cost, instance, from)).map_err(|broken| of(broken).replayed_by(about))
}

fn run<D: Domain>(m: &D, cost: &dyn ExecutionCost<D>, instance: &Instance<D>, from: &State<D>) -> Result<(), Broken> {
    let seconds = |until: f64| {
        entering("seconds");
        cost.seconds(m, instance, from, until)
    };
    let end = instance.at(m, 1.0, from);
    let between = |a: &State<D>, b: &State<D>| {
        entering("between");
        cost.between(m, a, b)
    };
    let step_s = cost.step_s();
    measure(FINITE, step_s).map_err(|broken| broken.of("step_s"))?;
    // A step may be left where it begins; what that costs besides, if anything, is its own.
    measure(FINITE, seconds(0.0)).map_err(|broken| broken.of("seconds").at(0.0))?;
    let mut before = 0.0;
    for until in CUTS {
        let found = seconds(until);
        measure(FINITE, found).map_err(|broken| broken.of("seconds").at(until))?;
        alike(PURE, &seconds(until), &found).map_err(|broken| broken.of("seconds").at(until))?;
        at_most(GROWS, before, found, SLACK * (1.0 + found)).map_err(|broken| broken.at(until))?;
        at_most(STEP, step_s, found, SLACK * (1.0 + step_s)).map_err(|broken| broken.at(until))?;
        before = found;
    }
    // What takes no time besides the step may take as long when it is cut.
    let (part, whole) = (seconds(0.01), seconds(1.0));
    let moves = !is_small(m, from, &end);
    let text = || format!("{part:?} s for a hundredth of the motion, {whole:?} s for all of it");
    ensure(GROWS, !moves || part < whole, text, "less for a hundredth of a motion")?;
    for (a, b) in [(from, &end), (&end, from), (from, from)] {
        let found = between(a, b);
        measure(FINITE, found).map_err(|broken| broken.of("between"))?;
        alike(PURE, &between(a, b), &found).map_err(|broken| broken.of("between"))?;
    }
    for (last, entry, exit) in [(from, from, &end), (&end, from, &end), (from, &end, &end), (from, from, from)] {
        let arrival = || {
            entering("arrival");
            cost.arrival(m, last, entry, exit)
        };
        let found = arrival();
        measure(FINITE, found).map_err(|broken| broken.of("arrival"))?;
        alike(PURE, &arrival(), &found).map_err(|broken| broken.of("arrival"))?;
    }
    stopovers(m, cost, from, &end)?;
    at_most(BETWEEN, between(from, from), step_s, SLACK).map_err(|broken| broken.of("to itself"))?;
    let is_free = instance.reversible && instance.moves.is_subset_of(ComponentSet::ROBOT) && instance.object.is_none();
    if is_free && moves {
        at_most(BETWEEN, between(from, &end), FACTOR * whole, SLACK)?;
    }
    Ok(())
}

/// How many stopovers are asked for.
const STOPS: u64 = 4;

fn stopovers<D: Domain>(m: &D, cost: &dyn ExecutionCost<D>, from: &State<D>, end: &State<D>) -> Result<(), Broken> {
    for i in 0..STOPS {
        let ask = || drawing("stopover", stream(i, 0, 0, Purpose::Improve), |rng| cost.stopover(m, from, end, rng));
        let (found, again) = (ask()?, ask()?);
        alike(STOPOVER, &again, &found)?;
        let Some(found) = found else { continue };
        let text = || format!("{found:?}");
        let names = found.objects().count() > 0 && found.robot().is_none();
        ensure(STOPOVER, names, text, "at least one object, and not the robot")?;
        for (id, at) in found.objects() {
            let is_inside = m.objects().get(id.index()).is_some_and(|space| space.contains(at));
            ensure(STOPOVER, is_inside, text, "an object of the domain, in its space")?;
        }
    }
    Ok(())
}

/// Do the two states differ by next to nothing?
fn is_small<D: Domain>(m: &D, a: &State<D>, b: &State<D>) -> bool {
    super::motion::component_travel(m, a, b) <= LEAST_M
}

/// Motions that lead less far are as good as none, metres.
const LEAST_M: f64 = 1e-3;
