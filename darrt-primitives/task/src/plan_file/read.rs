//! Reading a plan file: guards first, then JSON. Whether the plan is right is the verifier's question.

use std::path::Path;

use serde::Deserialize;

use super::json::{check_nesting, path_at};
use super::{PlanFile, PlanFileError, VERSION};
use crate::file_kind::FileKind;
use crate::problem_file::suggest::{nearest_expected, shown};
use crate::text_file;
pub use crate::text_file::MAX_NESTING;

/// Largest accepted plan file in bytes (256 MiB).
pub const MAX_BYTES: u64 = 256 * 1024 * 1024;

impl PlanFile {
    /// Reads the plan file at `path`; `-` is the standard input.
    ///
    /// Relative paths of meshes and of a robot description are taken from the folder of the file.
    ///
    /// # Errors
    /// When the file is not a regular one, cannot be read, is larger than [`MAX_BYTES`], nested deeper than [`MAX_NESTING`], is not JSON, or
    /// has unknown, missing or doubled keys or values of the wrong kind; the error names the file, line, column and key.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, PlanFileError> {
        let path = path.as_ref();
        if path == Path::new(text_file::STDIN) {
            return Self::from_json(&text_file::read_stdin(MAX_BYTES)?, text_file::STDIN_NAME);
        }
        let name = path.display().to_string();
        let mut plan = Self::from_json(&text_file::read(path, MAX_BYTES)?, &name)?;
        // Plans are written through links, so their files lie where the link leads.
        let real = if path.is_symlink() { path.canonicalize().ok() } else { None };
        if let Some(folder) = real.as_deref().unwrap_or(path).parent() {
            plan.problem.resolve_paths(folder);
        }
        Ok(plan)
    }

    /// Reads a plan from JSON; `source_name` is how errors call the text.
    ///
    /// Relative paths inside are left as they are, that is relative to the working folder.
    ///
    /// # Errors
    /// As [`PlanFile::read`], except for what concerns the file system.
    pub fn from_json(text: &str, source_name: &str) -> Result<Self, PlanFileError> {
        let plan = parse(text, source_name).map_err(|error| {
            let what = FileKind::of_text(text).and_then(|kind| kind.instead_of_plan(source_name));
            what.map_or(error, |what| PlanFileError::OtherKind { file: source_name.to_owned(), what })
        })?;
        if plan.version != VERSION {
            return Err(PlanFileError::Version {
                file: source_name.to_owned(),
                found: plan.version,
                supported: VERSION,
            });
        }
        Ok(plan)
    }
}

/// Guards and JSON.
fn parse(text: &str, source_name: &str) -> Result<PlanFile, PlanFileError> {
    text_file::check(text, source_name, MAX_BYTES, check_nesting)?;
    serde_json::from_str(text)
        .map_err(|error| other_version(text, source_name).unwrap_or_else(|| syntax(text, source_name, &error)))
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
        message: text_file::one_line(bare),
    }
}

/// Byte offset just behind a line and column as the parser counts them (from 1, in bytes).
fn offset_of(text: &str, line: usize, column: usize) -> usize {
    let before: usize = text.split_inclusive('\n').take(line.saturating_sub(1)).map(str::len).sum();
    (before + column).min(text.len())
}

#[cfg(test)]
pub(in crate::plan_file) mod tests;
