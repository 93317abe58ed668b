//! Reading a plan file: guards first, then JSON. Whether the plan is right is the verifier's question.

use std::fs::File;
use std::io::Read as _;
use std::path::Path;

use serde::Deserialize;

use super::json::{check_nesting, path_at};
use super::{PlanFile, PlanFileError, VERSION};
use crate::problem_file::suggest::{nearest_expected, shown};

/// Largest accepted plan file in bytes (256 MiB).
pub const MAX_BYTES: u64 = 256 * 1024 * 1024;

/// Deepest accepted nesting of brackets.
pub const MAX_NESTING: usize = 64;

/// Longest message of the JSON parser that is passed on, in characters.
const MAX_MESSAGE: usize = 600;

impl PlanFile {
    /// Reads the plan file at `path`.
    ///
    /// # Errors
    /// When the file cannot be read, is larger than [`MAX_BYTES`], nested deeper than [`MAX_NESTING`], is not JSON, or
    /// has unknown, missing or doubled keys or values of the wrong kind; the error names the file, line, column and key.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, PlanFileError> {
        let path = path.as_ref();
        let name = path.display().to_string();
        Self::from_json(&read_text(path, &name)?, &name)
    }

    /// Reads a plan from JSON; `source_name` is how errors call the text.
    ///
    /// # Errors
    /// As [`PlanFile::read`], except for what concerns the file system.
    pub fn from_json(text: &str, source_name: &str) -> Result<Self, PlanFileError> {
        let file = || source_name.to_owned();
        check_nesting(text, MAX_NESTING).map_err(|offset| {
            let (line, column) = line_and_column(text, offset);
            PlanFileError::TooDeep { file: file(), line, column, limit: MAX_NESTING }
        })?;
        let plan: Self = serde_json::from_str(text)
            .map_err(|error| other_version(text, source_name).unwrap_or_else(|| syntax(text, source_name, &error)))?;
        if plan.version != VERSION {
            return Err(PlanFileError::Version { file: file(), found: plan.version, supported: VERSION });
        }
        Ok(plan)
    }
}

/// A file of another version may differ anywhere; its version is then what there is to say.
fn other_version(text: &str, source_name: &str) -> Option<PlanFileError> {
    /// What every version has.
    #[derive(Deserialize)]
    struct Head {
        #[serde(rename = "format")]
        _format: super::PlanFormat,
        version: u32,
    }
    let found = serde_json::from_str::<Head>(text).ok()?.version;
    (found != VERSION).then(|| PlanFileError::Version { file: source_name.to_owned(), found, supported: VERSION })
}

fn syntax(text: &str, source_name: &str, error: &serde_json::Error) -> PlanFileError {
    let (line, column) = (error.line(), error.column());
    let message = error.to_string();
    // The place is said at the start of ours.
    let bare = message.rsplit_once(" at line ").map_or(message.as_str(), |(bare, _)| bare);
    PlanFileError::Syntax {
        file: source_name.to_owned(),
        line,
        column,
        key: shown(&path_at(text, offset_of(text, line, column))),
        nearest: nearest_expected(bare).map(|name| shown(&name)),
        message: bare.chars().take(MAX_MESSAGE).collect(),
    }
}

/// Reads at most [`MAX_BYTES`] of text from a regular file.
fn read_text(path: &Path, name: &str) -> Result<String, PlanFileError> {
    let io = |source| PlanFileError::Read { file: name.to_owned(), source };
    let too_large = |bytes| PlanFileError::TooLarge { file: name.to_owned(), bytes, limit: MAX_BYTES };
    let metadata = std::fs::metadata(path).map_err(io)?;
    if !metadata.is_file() {
        return Err(PlanFileError::NotAFile { file: name.to_owned() });
    }
    if metadata.len() > MAX_BYTES {
        return Err(too_large(metadata.len()));
    }
    let mut bytes = Vec::new();
    File::open(path).map_err(io)?.take(MAX_BYTES + 1).read_to_end(&mut bytes).map_err(io)?;
    if bytes.len() as u64 > MAX_BYTES {
        return Err(too_large(bytes.len() as u64));
    }
    String::from_utf8(bytes)
        .map_err(|error| PlanFileError::NotUtf8 { file: name.to_owned(), offset: error.utf8_error().valid_up_to() })
}

/// Line and column, both from 1, of a byte offset; the column counts characters.
fn line_and_column(text: &str, offset: usize) -> (usize, usize) {
    let before = text.get(..offset).unwrap_or(text);
    let line = before.matches('\n').count() + 1;
    let column = before.chars().rev().take_while(|&c| c != '\n').count() + 1;
    (line, column)
}

/// Byte offset just behind a line and column as the parser counts them (from 1, in bytes).
fn offset_of(text: &str, line: usize, column: usize) -> usize {
    let before: usize = text.split_inclusive('\n').take(line.saturating_sub(1)).map(str::len).sum();
    (before + column).min(text.len())
}

#[cfg(test)]
pub(in crate::plan_file) mod tests;
