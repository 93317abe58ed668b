//! What can be wrong with a robot file.

use darrt_primitives::kinematics::UrdfError;

use crate::problem_file::suggest::{hint, nearest, shown};
use crate::text_file::TextFileError;
use crate::toml_error::TomlError;

/// A robot file that cannot be used, with the place and the reason.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RobotFileError {
    /// The file or text is none that is given to the parser.
    #[error(transparent)]
    Text(#[from] TextFileError),
    /// The text is not TOML, or a key or value is not part of the format.
    #[error(transparent)]
    Syntax(#[from] TomlError),
    /// A key holds a value that does not fit the description or breaks a rule.
    #[error("{file}:{line}: `{key}` {why}")]
    Invalid {
        /// The file.
        file: String,
        /// Line of the key, from 1.
        line: usize,
        /// Path of the key.
        key: String,
        /// Why not: goes on after the key.
        why: String,
    },
    /// It is another kind of file.
    #[error("{file}: {why}")]
    OtherKind {
        /// The file.
        file: String,
        /// What it is, and what is done with it.
        why: String,
    },
    /// The robot description cannot be used.
    #[error("{}", described(file, source))]
    Description {
        /// The robot file.
        file: String,
        /// What is wrong with the description.
        source: UrdfError,
    },
    /// No robot of this name comes with the program.
    #[error("there is no robot `{}`{}; there are {}", shown(name), hint(nearest.as_deref()), available.join(", "))]
    UnknownRobot {
        /// The name.
        name: String,
        /// The nearest name.
        nearest: Option<String>,
        /// All names.
        available: Vec<String>,
    },
}

/// A key and what is wrong with it: goes on after the key.
#[derive(Debug, Clone, PartialEq)]
pub struct Fault {
    /// Path of the key.
    pub key: String,
    /// Why not.
    pub why: String,
}

impl Fault {
    /// What is wrong with `key`.
    pub(crate) fn new(key: impl Into<String>, why: impl Into<String>) -> Self {
        Self { key: key.into(), why: why.into() }
    }

    /// `key` names a `kind` that the description does not have.
    pub(crate) fn unknown<'a>(
        key: impl Into<String>,
        kind: &str,
        name: &str,
        known: impl IntoIterator<Item = &'a str>,
    ) -> Self {
        let near = nearest(name, known).map(str::to_owned);
        let why =
            format!("names the {kind} `{}`, which the description does not have{}", shown(name), hint(near.as_deref()));
        Self::new(key, why)
    }
}

/// An error that names the file by itself is not given its name again.
fn described(file: &str, source: &UrdfError) -> String {
    let said = source.to_string();
    if said.starts_with(&format!("{file}: ")) { said } else { format!("{file}: {said}") }
}
