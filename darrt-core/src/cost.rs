//! What carrying out a plan costs, in seconds.
//!
//! [`TravelCost`] is for domains that know nothing of speeds.

use rand::Rng;

use crate::domain::Domain;
use crate::error::{Error, in_range};
use crate::improve::pieces::{pieces, states};
use crate::motion::Instance;
use crate::partial::PartialState;
use crate::plan::{Plan, Step};
use crate::state::State;

/// Seconds of execution.
///
/// # Laws
/// Finite and never negative; pure; at most as much for a part of a motion as for the whole. `between` is finite and never
/// negative too.
///
/// # Example
/// A robot that takes twice as long for whatever it does to an object:
/// ```
/// use darrt_core::cost::ExecutionCost;
/// use darrt_core::prelude::*;
///
/// #[derive(Debug)]
/// struct Careful;
/// impl<D: Domain> ExecutionCost<D> for Careful {
///     fn seconds(&self, _: &D, instance: &Instance<D>, _: &State<D>, until: f64) -> f64 {
///         let speed_m_per_s = if instance.object.is_some() { 0.5 } else { 1.0 };
///         instance.motion.length() * until / speed_m_per_s
///     }
/// }
/// ```
pub trait ExecutionCost<D: Domain>: Send + Sync {
    /// Seconds that `instance`, which begins at `from`, takes on `[0, until]`.
    fn seconds(&self, m: &D, instance: &Instance<D>, from: &State<D>, until: f64) -> f64;

    /// Seconds that every step takes besides its travel, which two steps save that become one.
    fn step_s(&self) -> f64 {
        0.0
    }

    /// About the seconds that the robot takes from `from` to `to`, two states between which it may move freely. Ways are
    /// looked for in the order of this guess: one that is too low costs work, one that is too high may hide a cheaper way.
    fn between(&self, _m: &D, _from: &State<D>, _to: &State<D>) -> f64 {
        0.0
    }

    /// Seconds that a manipulation, which begins at `entry` and leads to `exit`, costs more because of where the robot comes
    /// from: `last` is where the manipulation before it ended, or the start. A robot that has been driven since it pushed
    /// something knows less well where that is.
    ///
    /// Finite, never negative, and pure.
    fn arrival(&self, _m: &D, _last: &State<D>, _entry: &State<D>, _exit: &State<D>) -> f64 {
        0.0
    }

    /// Objects where they may be left on the way of a manipulation that takes them from where they are in `from` to where they
    /// are in `to`: with another manipulation in the plan the next [`arrival`](Self::arrival) may cost less. `None` if there is
    /// nothing to propose.
    fn stopover(&self, _m: &D, _from: &State<D>, _to: &State<D>, _rng: &mut dyn Rng) -> Option<PartialState<D>> {
        None
    }
}

/// Seconds of the steps of `plan` together, with those of its [arrivals](ExecutionCost::arrival).
pub fn plan_seconds<D: Domain>(cost: &dyn ExecutionCost<D>, m: &D, plan: &Plan<D>) -> f64 {
    let mut here = plan.start().clone();
    let mut seconds = arrival_seconds(cost, m, plan.start(), plan.steps());
    for step in plan.steps() {
        seconds += cost.seconds(m, &step.instance, &here, step.until);
        step.instance.motion.at_into(m, step.until, &mut here);
    }
    seconds
}

/// Seconds that the manipulations of a chain cost more because of where the robot comes from.
pub(crate) fn arrival_seconds<D: Domain>(
    cost: &dyn ExecutionCost<D>,
    m: &D,
    start: &State<D>,
    steps: &[Step<D>],
) -> f64 {
    let states = states(m, start, steps);
    let mut last = 0;
    let mut seconds = 0.0;
    for piece in pieces(m, steps, &states) {
        if let (Some(last), Some(entry), Some(exit)) =
            (states.get(last), states.get(piece.entry), states.get(piece.until))
        {
            seconds += cost.arrival(m, last, entry, exit);
        }
        last = piece.until;
    }
    seconds
}

/// Travel at one speed, and a fixed time for every step: for domains without speeds of their own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TravelCost {
    speed_m_per_s: f64,
    step_s: f64,
}

impl TravelCost {
    /// Metres of [travel](crate::motion::Motion::length) per second, above 0; seconds that every step takes besides, at least 0.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a number out of its range.
    pub fn new(speed_m_per_s: f64, step_s: f64) -> Result<Self, Error> {
        in_range("speed_m_per_s", speed_m_per_s, f64::MIN_POSITIVE, f64::MAX, "finite and positive")?;
        in_range("step_s", step_s, 0.0, f64::MAX, "finite and not negative")?;
        Ok(Self { speed_m_per_s, step_s })
    }
}

impl Default for TravelCost {
    /// A metre per second, and a tenth of a second for every step.
    fn default() -> Self {
        Self { speed_m_per_s: 1.0, step_s: 0.1 }
    }
}

impl<D: Domain> ExecutionCost<D> for TravelCost {
    fn step_s(&self) -> f64 {
        self.step_s
    }

    fn seconds(&self, _: &D, instance: &Instance<D>, _: &State<D>, until: f64) -> f64 {
        self.step_s + instance.motion.length() * until / self.speed_m_per_s
    }
}
