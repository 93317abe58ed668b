//! When a plan is where: the clock of its steps, as a plan file has it.
//!
//! A step is cut into phases, each of which begins and ends at rest. In a phase the robot goes by some of the step's
//! waypoints, its knots; the others lie on the straight lines between them. Every line has a length, in seconds that it takes at
//! full speed, and the way is told by `s`, the length gone. The profile says how `s` grows with time: from rest, with a jerk that
//! is constant in each of its pieces. `docs/timed-plan.md` explains it to readers without this code.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The clock of a plan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Timing {
    /// Seconds of all steps.
    pub duration_s: f64,
    /// The steps of the plan in order.
    pub steps: Vec<StepTiming>,
}

/// The clock of a step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StepTiming {
    /// One after the other; each begins at the knot at which the one before ended.
    pub phases: Vec<Phase>,
}

/// A part of a step from rest to rest.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Phase {
    /// The waypoints, as indices from 0, between which it goes in straight lines; at least two, growing.
    #[schemars(length(min = 2))]
    pub knots: Vec<usize>,
    /// Length of each line, seconds at full speed; > 0, one fewer than knots.
    pub lengths: Vec<f64>,
    /// How far before and behind each inner knot its corner is rounded, in the unit of the lengths; two fewer than knots. With 0
    /// the way goes through the knot.
    pub blends: Vec<f64>,
    /// How the length gone grows: `[seconds, jerk]` of each piece, the jerk in lengths per second cubed. Speed and acceleration
    /// are zero at the beginning and at the end.
    pub profile: Vec<[f64; 2]>,
    /// Seconds that everything stands before this phase begins to move.
    pub wait_s: f64,
    /// Seconds that everything stands after it.
    pub rest_s: f64,
}

impl Phase {
    /// Seconds in motion.
    pub fn moving_s(&self) -> f64 {
        self.profile.iter().map(|[seconds, _]| seconds).sum()
    }

    /// Seconds in all.
    pub fn duration_s(&self) -> f64 {
        self.wait_s + self.moving_s() + self.rest_s
    }

    /// The length of its way.
    pub fn length(&self) -> f64 {
        self.lengths.iter().sum()
    }
}

impl StepTiming {
    /// Seconds of the step.
    pub fn duration_s(&self) -> f64 {
        self.phases.iter().map(Phase::duration_s).sum()
    }
}
