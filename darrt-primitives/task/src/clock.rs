//! The clock: when the robot is where, so that a controller can carry a plan out.
//!
//! | question | file |
//! |---|---|
//! | how does a plan file say it? | [`timing`](crate::plan_file::timing) |
//! | how fast may robot and objects move? | [`limits`] |
//! | how does one number go from rest to rest in bounded jerk? | `profile` |
//! | along which curve? | `way` |
//! | which pieces does a step have, how fast is each? | `build`, `pace` |
//! | where is the robot at a time, and what happens besides? | [`timed`] |
//! | is a clock in a file one? | `check` |
//! | how far may corners be rounded? | `accepted` |
//!
//! No decision is taken by the name of a primitive: what is slow, and where the robot waits, follows from the contracts in the
//! plan file. `docs/timed-plan.md` explains it to readers without this code.

mod accepted;
mod build;
pub(crate) mod check;
pub mod limits;
mod pace;
pub(crate) mod profile;
mod rounded_path;
pub mod timed;
mod track;

use darrt_primitives::contract::Contract;

use crate::plan_file::timing::Timing;
use crate::plan_file::{PlanFile, UnknownTool};
use crate::robot::RobotFacts;

pub use accepted::{NoClock, give_clock};
pub use limits::{Bounds, MotionLimits};
pub(crate) use timed::waypoint_times_s;
pub use timed::{Event, EventKind, Moment, TimedPlan};

/// A plan that cannot be timed, or a clock that does not fit its plan.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ClockError {
    /// The robot cannot be built.
    #[error("the robot of the problem cannot be timed: {0}")]
    Robot(String),
    /// A number of the robot's limits is out of range.
    #[error("the robot's motion limit `{name}` is {value}, which is out of its range")]
    Limits {
        /// Its name.
        name: String,
        /// Its value.
        value: f64,
    },
    /// A waypoint does not fit the robot.
    #[error("`{place}`: {why}")]
    Waypoint {
        /// Path of the key in the plan file.
        place: String,
        /// What is wrong.
        why: String,
    },
    /// A step refers to something that is not there.
    #[error("step {step} lacks the {what} `{name}`")]
    Missing {
        /// Number of the step, from 1.
        step: usize,
        /// Kind of thing.
        what: &'static str,
        /// Its name.
        name: String,
    },
    /// A step names a tool that the robot does not have.
    #[error("step {step}: {error}")]
    Tool {
        /// Number of the step, from 1.
        step: usize,
        /// What is wrong.
        error: UnknownTool,
    },
    /// The clock in the file is none for this plan.
    #[error("`{place}` {why}")]
    Timing {
        /// Path of the key in the plan file.
        place: String,
        /// What is wrong: goes on after the path.
        why: String,
    },
}

/// How far anything may pass a corner of a way that is free, metres, unless the verifier finds that too far.
pub const FREE_TUBE_M: f64 = 0.02;

/// The same where the hand is at work: far below what the verifier grants straight lines and contacts.
pub const WORK_TUBE_M: f64 = 2e-4;

/// The fastest clock of `plan` at the limits of its robot that this method finds: straight lines and rounded corners, each with
/// its own bounds.
///
/// # Laws
/// A function of plan and robot alone.
///
/// # Errors
/// [`ClockError`] when plan and robot do not fit together, or a limit is out of range.
pub fn time(plan: &PlanFile, facts: &RobotFacts) -> Result<Timing, ClockError> {
    build::time(plan, facts, |_, contract| tube_m(*contract))
}

/// How far anything may pass a corner in such a step, metres.
const fn tube_m(contract: Contract) -> f64 {
    if contract.is_free() { FREE_TUBE_M } else { WORK_TUBE_M }
}
