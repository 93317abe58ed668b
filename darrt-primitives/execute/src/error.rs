//! Why a plan cannot be executed.

use darrt_geom::GeomError;
use darrt_primitives::kinematics::UrdfError;
use darrt_task::clock::{ClockError, NoClock};
use darrt_task::problem_file::ProblemFileError;

/// A plan that cannot be executed at all; one that fails when it is executed is no error.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExecuteError {
    /// The robot of the problem cannot be built.
    #[error("the robot of the problem cannot be built: {0}")]
    Robot(#[from] UrdfError),
    /// The robot lacks a link or joint that it says it has.
    #[error("the robot has no {what} `{name}`")]
    NoSuchPart {
        /// `link` or `joint`.
        what: &'static str,
        /// Its name.
        name: String,
    },
    /// The robot says something of its hand that cannot be.
    #[error("the hand of the robot: {0}")]
    Hand(String),
    /// The scene of the problem cannot be built.
    #[error("the scene of the problem cannot be built: {0}")]
    Scene(#[from] ProblemFileError),
    /// The solid of a body cannot be built.
    #[error("`{body}`: {reason}")]
    Solid {
        /// Its name.
        body: String,
        /// Why not.
        reason: String,
    },
    /// The plan has no clock, and none can be made for it.
    #[error(transparent)]
    Clock(#[from] ClockError),
    /// The plan has no clock, and none is accepted by the verifier.
    #[error(transparent)]
    NoClock(#[from] NoClock),
    /// A step that moves more than the robot's first arm and hand.
    #[error("step {step} {what}, but plans are executed with the first arm and hand of a robot only")]
    SecondArm {
        /// Number of the step, from 1.
        step: usize,
        /// What it does.
        what: String,
    },
    /// Something that the plan should have and does not.
    #[error("{place}: there is no {what} `{name}`")]
    Missing {
        /// Where in the plan.
        place: String,
        /// What kind of thing.
        what: &'static str,
        /// Its name.
        name: String,
    },
}

impl ExecuteError {
    /// The geometry crate refuses a solid.
    pub(crate) fn solid(body: &str, error: &GeomError) -> Self {
        Self::Solid { body: body.to_owned(), reason: error.to_string() }
    }
}
