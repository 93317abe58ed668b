//! Writing and reading recordings.

use std::path::Path;

use super::{Recording, VERSION};
use crate::problem_file::paths::folder_of;
use crate::text_file::{self, TextFileError};

/// Largest accepted file in bytes (512 MiB).
const MAX_BYTES: u64 = 512 * 1024 * 1024;

/// Why a recording cannot be read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecordingError {
    /// The file cannot be read.
    #[error(transparent)]
    File(#[from] TextFileError),
    /// It is no recording.
    #[error("{file}:{line}:{column}: {message}")]
    Syntax {
        /// The file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
        /// What is wrong.
        message: String,
    },
    /// Another version.
    #[error("{file}: version {found} of recordings is not known, only {VERSION}")]
    Version {
        /// The file.
        file: String,
        /// Its version.
        found: u32,
    },
    /// An index leads nowhere.
    #[error("{file}: `{key}` is {value}, must be below {bound}")]
    Index {
        /// The file.
        file: String,
        /// Path of the key.
        key: String,
        /// The index.
        value: u64,
        /// How many there are.
        bound: u64,
    },
    /// What must be there is not.
    #[error("{file}: `{key}` {why}")]
    Inconsistent {
        /// The file.
        file: String,
        /// Path of the key.
        key: String,
        /// What is wrong: goes on after the key.
        why: String,
    },
    /// It cannot be written.
    #[error("{file}: cannot be written: {reason}")]
    Write {
        /// The file.
        file: String,
        /// Why not.
        reason: String,
    },
}

impl Recording {
    /// Writes the recording, as a whole or not at all; paths in its problem are written as in plans.
    ///
    /// # Errors
    /// [`RecordingError::Write`].
    pub fn write(&self, path: &Path) -> Result<(), RecordingError> {
        let failed = |reason: String| RecordingError::Write { file: path.display().to_string(), reason };
        let mut moved;
        let mut written = self;
        if self.problem.names_files() {
            moved = self.clone();
            moved.problem.make_paths_start_at(folder_of(path));
            written = &moved;
        }
        let mut text = serde_json::to_vec(written).map_err(|error| failed(error.to_string()))?;
        text.push(b'\n');
        text_file::replace(path, text).map_err(|error| failed(error.to_string()))
    }

    /// Reads a recording; every index in it leads somewhere.
    ///
    /// # Errors
    /// [`RecordingError`].
    pub fn read(path: &Path) -> Result<Self, RecordingError> {
        let text = text_file::read(path, MAX_BYTES)?;
        let mut recording = Self::from_json(&text, &path.display().to_string())?;
        if let Some(folder) = path.canonicalize().ok().as_deref().unwrap_or(path).parent() {
            recording.problem.resolve_paths(folder);
        }
        Ok(recording)
    }

    /// Reads a recording from JSON, which errors call `file`.
    ///
    /// # Errors
    /// As [`Recording::read`].
    pub fn from_json(text: &str, file: &str) -> Result<Self, RecordingError> {
        let recording: Self = serde_json::from_str(text).map_err(|error| RecordingError::Syntax {
            file: file.to_owned(),
            line: error.line(),
            column: error.column(),
            message: text_file::one_line(&error.to_string()),
        })?;
        if recording.version != VERSION {
            return Err(RecordingError::Version { file: file.to_owned(), found: recording.version });
        }
        recording.check(file)?;
        Ok(recording)
    }

    fn check(&self, file: &str) -> Result<(), RecordingError> {
        let below = |key: String, value: u64, bound: usize| {
            let bound = bound as u64;
            let flaw = || RecordingError::Index { file: file.to_owned(), key, value, bound };
            (value < bound).then_some(()).ok_or_else(flaw)
        };
        let must = |is_so: bool, key: String, why: &str| {
            let flaw = || RecordingError::Inconsistent { file: file.to_owned(), key, why: why.to_owned() };
            is_so.then_some(()).ok_or_else(flaw)
        };
        for (a, attempt) in self.attempts.iter().enumerate() {
            let count = attempt.nodes.len();
            let mut before = 0;
            for (n, node) in attempt.nodes.iter().enumerate() {
                let key = |field: usize| format!("attempts[{a}].nodes[{n}][{field}]");
                must((n == 0) == node.0.is_none(), key(0), "must be null for the first node and for no other")?;
                must((n == 0) == node.2.is_none(), key(2), "must be null for the first node and for no other")?;
                node.0.map_or(Ok(()), |parent| below(key(0), u64::from(parent), n))?;
                must(node.1 >= before, key(1), "must not be less than that of the node before")?;
                before = node.1;
                node.2.map_or(Ok(()), |primitive| below(key(2), u64::from(primitive), self.primitives.len()))?;
                for (object, _) in &node.4 {
                    below(key(4), u64::from(*object), self.problem.objects.len())?;
                }
                let is_whole = n > 0 || node.4.len() == self.problem.objects.len();
                must(is_whole, key(4), "must name every object of the problem at the first node")?;
            }
            for (r, (node, _)) in attempt.removed.iter().enumerate() {
                below(format!("attempts[{a}].removed[{r}][0]"), u64::from(*node), count)?;
            }
            for (b, blocked) in attempt.blocked.iter().enumerate() {
                let key = |field: usize| format!("attempts[{a}].blocked[{b}][{field}]");
                below(key(1), u64::from(blocked.1), count)?;
                below(key(2), u64::from(blocked.2), self.bodies.len())?;
                below(key(3), u64::from(blocked.3), self.bodies.len())?;
            }
        }
        Ok(())
    }
}
