//! Reading a problem file: guards first, then TOML, then defaults, then validation.

use std::f64::consts::TAU;
use std::path::Path;

use darrt_primitives::kinematics::limit::wrap_to_pi;

use super::error::{Flaw, ProblemFileError};
use super::nesting::check_nesting;
use super::suggest::shown;
use super::{ProblemFile, VERSION, arrays};
use crate::file_kind::FileKind;
use crate::text_file;
pub use crate::text_file::MAX_NESTING;
use crate::toml_error::TomlError;

/// Largest accepted problem file in bytes (4 MiB).
pub const MAX_BYTES: u64 = 4 * 1024 * 1024;

impl ProblemFile {
    /// Reads, completes and validates the problem file at `path`.
    ///
    /// Relative paths of meshes and of a robot description are taken from the folder of the file.
    ///
    /// # Errors
    /// When the file is not a regular one, cannot be read, is larger than [`MAX_BYTES`], nested deeper than [`MAX_NESTING`], is not TOML, or
    /// breaks a rule of the format; the error names the file, the place, the value and the bound.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, ProblemFileError> {
        let path = path.as_ref();
        let name = path.display().to_string();
        // Plans may be larger than problems, so even what is too large is looked at.
        let text = text_file::read(path, MAX_BYTES)
            .map_err(|error| other_kind(FileKind::of_file(path), &name).unwrap_or_else(|| error.into()))?;
        let mut problem = parse(&text, &name)?;
        problem.validate(&name)?;
        if let Some(folder) = path.parent() {
            problem.resolve_paths(folder);
        }
        Ok(problem)
    }

    /// Reads, completes and validates a problem on the standard input. Relative paths are taken from the working folder.
    ///
    /// # Errors
    /// As [`ProblemFile::read`].
    pub fn from_stdin() -> Result<Self, ProblemFileError> {
        Self::from_toml(&text_file::read_stdin(MAX_BYTES)?, text_file::STDIN_NAME)
    }

    /// Parses, completes and validates a problem in TOML; `source_name` is how errors call the text.
    ///
    /// Relative paths inside are left as they are, that is relative to the working folder.
    ///
    /// # Errors
    /// As [`ProblemFile::read`], except for what concerns the file system.
    pub fn from_toml(text: &str, source_name: &str) -> Result<Self, ProblemFileError> {
        let problem = parse(text, source_name)?;
        problem.validate(source_name)?;
        Ok(problem)
    }

    /// The problem as a complete problem file, every default written out.
    ///
    /// # Errors
    /// When a count exceeds what TOML can hold (2^63 - 1); no problem that was read from TOML has one.
    pub fn to_toml(&self) -> Result<String, toml::ser::Error> {
        toml::to_string(self)
    }
}

/// The error for a file of another kind.
fn other_kind(kind: Option<FileKind>, file: &str) -> Option<ProblemFileError> {
    let what = kind?.instead_of_problem(file)?;
    Some(ProblemFileError::OtherKind { file: file.to_owned(), what })
}

/// Guards, TOML and defaults; no validation.
fn parse(text: &str, source_name: &str) -> Result<ProblemFile, ProblemFileError> {
    parse_toml(text, source_name).map_err(|error| other_kind(FileKind::of_text(text), source_name).unwrap_or(error))
}

fn parse_toml(text: &str, source_name: &str) -> Result<ProblemFile, ProblemFileError> {
    text_file::check(text, source_name, MAX_BYTES, check_nesting)?;
    let raw = toml::from_str::<toml::Value>(text);
    // A newer file may have keys that this program cannot know: that it is newer is said first.
    if let Ok(raw) = &raw
        && let Some(version) = raw.get("version").and_then(toml::Value::as_integer)
        && version > i64::from(VERSION)
    {
        let bound = format!("{VERSION}: the file is newer than what this program reads");
        let flaw = Flaw::OutOfRange { value: version as f64, bound };
        return Err(ProblemFileError::Invalid {
            file: source_name.to_owned(),
            key: "version".to_owned(),
            flaw: Box::new(flaw),
        });
    }
    let mut problem: ProblemFile = toml::from_str(text).map_err(|error| TomlError::of(&error, text, source_name))?;
    if let Ok(raw) = raw {
        arrays::check_lengths(&raw, &problem).map_err(|(key, flaw)| ProblemFileError::Invalid {
            file: source_name.to_owned(),
            key: shown(&key),
            flaw: Box::new(flaw),
        })?;
    }
    problem.normalise();
    Ok(problem)
}

impl ProblemFile {
    /// Fills in the defaults that depend on other keys.
    fn normalise(&mut self) {
        // Yaws are angles: what lies a little beyond half a turn means the other side of it.
        let yaws = [Some(&mut self.robot.base), self.goal.robot.as_mut().and_then(|goal| goal.base.as_mut())];
        for [_, _, yaw] in yaws.into_iter().flatten() {
            // What is more than a turn was meant in degrees, and is refused.
            if yaw.abs() <= TAU {
                *yaw = wrap_to_pi(*yaw);
            }
        }
        for corners in self.surfaces.iter_mut().filter_map(|surface| surface.polygon.as_mut()) {
            // A polygon may be written closed.
            if corners.len() > 3 && corners.first() == corners.last() {
                corners.pop();
            }
        }
        for object in &mut self.objects {
            object.normalise();
        }
        for goal in &mut self.goal.objects {
            goal.normalise();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem_file::ShapeSpec;
    use crate::text_file::TextFileError as T;
    use darrt_geom::FileError as F;

    fn message(text: &str) -> String {
        ProblemFile::from_toml(text, "bad.toml").unwrap_err().to_string()
    }

    #[test]
    fn broken_toml_names_the_line_and_column() {
        assert!(message("format = \"darrt-problem\"\nversion = = 1\n").starts_with("bad.toml:2:"));
        assert!(message("\"é\" = 1\n").contains("bad.toml:1:1: at `é`: unknown field `é`"));
        assert!(message("").contains("missing field `format`"));
    }

    #[test]
    fn deep_nesting_is_refused_before_parsing() {
        let arrays = format!("name = {}", "[".repeat(10_000));
        assert!(message(&arrays).contains("bad.toml:1:72: nested deeper than 64 levels"));
        let dots = format!("a{} = 1", ".a".repeat(10_000));
        assert!(message(&dots).contains("nested deeper than 64"));
        let tables = format!("name = {}", "{a=".repeat(10_000));
        assert!(message(&tables).contains("nested deeper than 64"));
        // As deep as allowed, still no trouble for the stack.
        let allowed = format!("name = {}1{}", "[".repeat(63), "]".repeat(63));
        assert!(ProblemFile::from_toml(&allowed, "bad.toml").is_err());
    }

    #[test]
    fn large_files_are_refused_by_their_size_alone() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("large.toml");
        // A sparse file: 100 MB that are never written.
        std::fs::File::create(&path).unwrap().set_len(100_000_000).unwrap();
        let message = ProblemFile::read(&path).unwrap_err().to_string();
        assert!(message.contains("large.toml"), "{message}");
        assert!(message.contains("100000000") && message.contains("4194304"), "{message}");
        let text = " ".repeat(usize::try_from(MAX_BYTES).unwrap() + 1);
        assert!(self::tests::message(&text).contains("4194305"));
    }

    #[test]
    fn missing_files_folders_and_binary_files_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let missing = folder.path().join("missing.toml");
        assert!(matches!(ProblemFile::read(&missing), Err(ProblemFileError::Text(T::File(F::Unreadable { .. })))));
        let not_a_file = ProblemFile::read(folder.path());
        assert!(matches!(not_a_file, Err(ProblemFileError::Text(T::File(F::NotAFile { .. })))));
        let binary = folder.path().join("binary.toml");
        std::fs::write(&binary, b"abc\xff\xfe").unwrap();
        let not_text = ProblemFile::read(&binary);
        assert!(matches!(not_text, Err(ProblemFileError::Text(T::File(F::NotUtf8 { offset: 3, .. })))));
    }

    #[test]
    fn meshes_are_found_beside_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mesh.toml");
        let text = crate::testing::builtin_text("bowl").unwrap();
        let mesh = "\n[[obstacle]]\nname = \"lamp\"\nshape = { mesh = { file = \"lamp.stl\" } }\nat = [0, 1, 0]\n";
        std::fs::write(&path, format!("{text}{mesh}")).unwrap();
        let problem = ProblemFile::read(&path).unwrap();
        let ShapeSpec::Mesh { file, scale } = &problem.obstacle("lamp").unwrap().shape else {
            panic!("the lamp is a mesh");
        };
        assert_eq!((file, *scale), (&folder.path().join("lamp.stl"), 1.0));
        let message = problem.scene().unwrap_err().to_string();
        assert!(message.contains("lamp.stl") && message.contains("obstacle["), "{message}");
    }
}
