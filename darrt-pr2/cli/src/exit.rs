//! How the program ends.

use std::process::ExitCode;

use crate::bench::BenchError;
use crate::generate::GenerateError;
use darrt_task::picture::PictureError;
use darrt_task::plan_file::PlanFileError;
use darrt_task::planning_error::PlanningError;
use darrt_task::problem_file::ProblemFileError;
use darrt_task::recording::RecordingError;
use darrt_task::robot_file::RobotFileError;
use darrt_task::text::on_one_line;
use darrt_task::viewer::ViewerError;

/// The exit codes, for scripts. They are part of the interface and written in `darrt --help`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Exit {
    /// Done: the problem is solved, the plan is accepted.
    Solved = 0,
    /// The budget ended before a plan was found.
    NotSolved = 1,
    /// Bad input or usage.
    BadInput = 2,
    /// The verifier refuses the plan.
    Refused = 3,
    /// The output cannot be written.
    CannotWrite = 4,
    /// The budget ended before a plan was found, and the beginning of one is written; or a plan that is judged is such a
    /// beginning, and right.
    Partial = 5,
    /// It is proven before the search that the problem, as it is written, has no plan.
    Impossible = 6,
    /// Interrupted by the user.
    Interrupted = 130,
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        Self::from(exit as u8)
    }
}

/// An end with a message for the standard error.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Failure {
    /// The exit code.
    pub exit: Exit,
    /// What went wrong: file, place, name, value and bound.
    pub message: String,
}

impl Failure {
    /// An end with a message.
    pub fn new(exit: Exit, message: impl Into<String>) -> Self {
        Self { exit, message: message.into() }
    }

    /// Bad input or usage: one line, whatever the names in it.
    pub fn input(message: impl AsRef<str>) -> Self {
        Self::new(Exit::BadInput, on_one_line(message.as_ref()))
    }
}

impl From<&PlanningError> for Exit {
    fn from(error: &PlanningError) -> Self {
        if error.is_impossible() { Self::Impossible } else { Self::BadInput }
    }
}

impl From<ProblemFileError> for Failure {
    fn from(error: ProblemFileError) -> Self {
        Self::input(error.to_string())
    }
}

impl From<RobotFileError> for Failure {
    fn from(error: RobotFileError) -> Self {
        Self::input(error.to_string())
    }
}

impl From<PictureError> for Failure {
    fn from(error: PictureError) -> Self {
        Self::input(error.to_string())
    }
}

impl From<ViewerError> for Failure {
    fn from(error: ViewerError) -> Self {
        Self::input(error.to_string())
    }
}

impl From<BenchError> for Failure {
    fn from(error: BenchError) -> Self {
        let exit = match error {
            BenchError::Unwritable { .. } | BenchError::Locked { .. } | BenchError::Kept { .. } => Exit::CannotWrite,
            _ => Exit::BadInput,
        };
        Self::new(exit, on_one_line(&error.to_string()))
    }
}

impl From<GenerateError> for Failure {
    fn from(error: GenerateError) -> Self {
        let exit = match error {
            GenerateError::Cancelled => Exit::Interrupted,
            GenerateError::NoneSolved { .. } => Exit::NotSolved,
        };
        Self::new(exit, on_one_line(&error.to_string()))
    }
}

impl From<RecordingError> for Failure {
    fn from(error: RecordingError) -> Self {
        let exit = match error {
            RecordingError::Write { .. } => Exit::CannotWrite,
            _ => Exit::BadInput,
        };
        Self::new(exit, on_one_line(&error.to_string()))
    }
}

impl From<PlanFileError> for Failure {
    fn from(error: PlanFileError) -> Self {
        let exit = match error {
            PlanFileError::Write { .. } => Exit::CannotWrite,
            _ => Exit::BadInput,
        };
        Self::new(exit, on_one_line(&error.to_string()))
    }
}
