//! What can be wrong with a plan file as a file.

use std::io;

use thiserror::Error;

use crate::problem_file::suggest::hint;

/// A plan file that cannot be read or written, with the place and the reason.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PlanFileError {
    /// The file cannot be opened or read.
    #[error("{file}: cannot be read: {source}")]
    Read {
        /// The file.
        file: String,
        /// What the operating system says.
        source: io::Error,
    },
    /// The file cannot be written; what was there before is untouched.
    #[error("{file}: cannot be written: {source}")]
    Write {
        /// The file.
        file: String,
        /// What the operating system says.
        source: io::Error,
    },
    /// The path is not a regular file.
    #[error("{file}: is not a regular file")]
    NotAFile {
        /// The path.
        file: String,
    },
    /// The file is larger than a plan file may be.
    #[error("{file}: has {bytes} bytes, a plan file may have at most {limit}")]
    TooLarge {
        /// The file.
        file: String,
        /// Its size.
        bytes: u64,
        /// The bound.
        limit: u64,
    },
    /// The file is not UTF-8 text.
    #[error("{file}: is not UTF-8 text, the byte at offset {offset} is not valid")]
    NotUtf8 {
        /// The file.
        file: String,
        /// Offset of the first bad byte.
        offset: usize,
    },
    /// Brackets are nested too deeply.
    #[error("{file}:{line}:{column}: nested deeper than {limit} levels")]
    TooDeep {
        /// The file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// Column in characters, from 1.
        column: usize,
        /// The bound.
        limit: usize,
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
