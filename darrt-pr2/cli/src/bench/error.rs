//! What can keep a benchmark from being run or told.

use std::path::PathBuf;

use darrt_task::planning_error::PlanningError;
use darrt_task::problem_file::ProblemFileError;
use darrt_task::text_file::TextFileError;

/// Why a benchmark cannot be run, taken up again, merged or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BenchError {
    /// A problem file.
    #[error(transparent)]
    Problem(#[from] ProblemFileError),
    /// A problem cannot be planned at all.
    #[error("{problem}: {source}")]
    Planning {
        /// The problem.
        problem: String,
        /// Why.
        source: Box<PlanningError>,
    },
    /// No variant has this name.
    #[error("there is no variant `{name}`{}; there are: {}", nearest.as_ref().map_or_else(String::new, |n| format!(", did you mean `{n}`?")), available.join(", "))]
    UnknownVariant {
        /// The name.
        name: String,
        /// The name that looks most like it.
        nearest: Option<String>,
        /// All names.
        available: Vec<&'static str>,
    },
    /// Two problems of one name: their runs could not be told apart.
    #[error("two problems are named `{name}`: their runs could not be told apart")]
    SameName {
        /// The name.
        name: String,
    },
    /// A file of results cannot be read.
    #[error(transparent)]
    Unreadable(#[from] TextFileError),
    /// A line of a file of results is not a record.
    #[error("{file}:{line}: is not the record of a run: {message}")]
    Line {
        /// The file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// What is wrong.
        message: String,
    },
    /// The same run is there twice, with different outcomes.
    #[error("{second}: {run} is also in {first}, with another outcome: count one of them only")]
    Twice {
        /// The run.
        run: String,
        /// Where it was seen first.
        first: String,
        /// Where it was seen again.
        second: String,
    },
    /// Runs of one problem under different conditions.
    #[error(transparent)]
    Conditions(Box<Unlike>),
    /// Another process writes to the file of results.
    #[error("{}: another benchmark is writing to this file", file.display())]
    Locked {
        /// The file.
        file: PathBuf,
    },
    /// The plan of a run, or its page, cannot be kept.
    #[error("{}: cannot be kept: {reason}", file.display())]
    Kept {
        /// The file.
        file: PathBuf,
        /// Why not.
        reason: String,
    },
    /// The file of results cannot be written.
    #[error("{}: cannot be written: {source}", file.display())]
    Unwritable {
        /// The file.
        file: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
}

/// A run that is not put together with others of its problem.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{file}: {run} was run with {what} {found}, not {expected}: such runs are not put together; {remedy}")]
pub struct Unlike {
    /// The file.
    pub file: String,
    /// The run.
    pub run: String,
    /// Which condition.
    pub what: &'static str,
    /// That of the run.
    pub found: String,
    /// That of the others.
    pub expected: String,
    /// What to do.
    pub remedy: &'static str,
}

impl From<Unlike> for BenchError {
    fn from(unlike: Unlike) -> Self {
        Self::Conditions(Box::new(unlike))
    }
}
