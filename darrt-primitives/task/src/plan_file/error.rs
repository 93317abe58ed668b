//! What can be wrong with a plan file as a file.

use std::io;

use thiserror::Error;

use crate::problem_file::suggest::hint;
use crate::text_file::TextFileError;

/// A plan file that cannot be read or written, with the place and the reason.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PlanFileError {
    /// The file or text is none that is given to the parser.
    #[error(transparent)]
    Text(#[from] TextFileError),
    /// The file is something else, and says so.
    #[error("{file}: {what}")]
    OtherKind {
        /// The file.
        file: String,
        /// What it is, and which command takes it.
        what: String,
    },
    /// The file cannot be written; what was there before is untouched.
    #[error("{file}: cannot be written: {source}")]
    Write {
        /// The file.
        file: String,
        /// What the operating system says.
        source: io::Error,
    },
    /// The text is not JSON, or a key or value is not part of the format.
    #[error("{file}:{line}:{column}: at `{key}`: {message}{}", hint(nearest.as_deref()))]
    Syntax {
        /// The file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// Column in bytes, from 1.
        column: usize,
        /// Path of the key, such as `steps[3].waypoints[0].base[1]`; indices count from 0.
        key: String,
        /// What is wrong, with the offending key or value.
        message: String,
        /// The nearest valid key or value.
        nearest: Option<String>,
    },
    /// The file says that it has a version that this program does not know.
    #[error("{file}: `version` is {found}, this program reads version {supported}")]
    Version {
        /// The file.
        file: String,
        /// The version found.
        found: u32,
        /// The version read.
        supported: u32,
    },
    /// A number cannot be written as JSON.
    #[error("`{key}` is {value}, only finite numbers can be written")]
    NotFinite {
        /// Path of the key.
        key: String,
        /// The number.
        value: f64,
    },
    /// The plan cannot be written as JSON.
    #[error("the plan cannot be written as JSON: {0}")]
    Json(#[source] serde_json::Error),
}
