//! What problem files and plan files share as texts: how they are read without trusting them, and replaced whole.

use std::io::{self, Write as _};
use std::path::Path;

use darrt_geom::FileError;
use darrt_geom::bounded_file;
use thiserror::Error;

use crate::text::on_one_line;

/// Deepest accepted nesting of brackets (and of dotted keys in TOML).
pub const MAX_NESTING: usize = 64;

/// Longest message of a parser that is passed on, in characters.
const MAX_MESSAGE: usize = 600;

/// Why a text was not even given to its parser.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum TextFileError {
    /// The file was not read, or is no text.
    #[error(transparent)]
    File(#[from] FileError),
    /// Brackets or dotted keys are nested too deeply.
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
}

/// The text of the regular file at `path`, at most `max_bytes` long.
///
/// # Errors
/// [`TextFileError::File`] with the path when it leads to anything but a regular file, the file is too large, cannot be
/// read, or is not UTF-8.
pub fn read(path: &Path, max_bytes: u64) -> Result<String, TextFileError> {
    Ok(bounded_file::read_text(path, max_bytes)?)
}

/// What a person writes for the standard input in the place of a file.
pub const STDIN: &str = "-";

/// How errors call the standard input.
pub const STDIN_NAME: &str = "standard input";

/// The text on the standard input, at most `max_bytes` long.
///
/// # Errors
/// [`TextFileError::File`] when it is longer, cannot be read, or is not UTF-8.
pub fn read_stdin(max_bytes: u64) -> Result<String, TextFileError> {
    Ok(bounded_file::read_stream(io::stdin().lock(), STDIN_NAME, max_bytes)?)
}

/// Refuses a text that is too long or, by the scanner of its format, nested too deeply; the scanner gives the byte offset
/// of the first bracket beyond the limit that it is given. `file` is how errors call the text.
///
/// # Errors
/// [`TextFileError`] with the size or the place, and the bound.
pub fn check(
    text: &str,
    file: &str,
    max_bytes: u64,
    nesting: impl FnOnce(&str, usize) -> Result<(), usize>,
) -> Result<(), TextFileError> {
    bounded_file::check_length(text.len() as u64, file, max_bytes)?;
    nesting(text, MAX_NESTING).map_err(|offset| {
        let (line, column) = line_and_column(text, offset);
        TextFileError::TooDeep { file: file.to_owned(), line, column, limit: MAX_NESTING }
    })
}

/// Line and column, both from 1, of a byte offset; the column counts characters.
pub fn line_and_column(text: &str, offset: usize) -> (usize, usize) {
    let before = text.get(..offset).unwrap_or(text);
    let line = before.matches('\n').count() + 1;
    let column = before.chars().rev().take_while(|&c| c != '\n').count() + 1;
    (line, column)
}

/// A parser's message on one line, cut to a length that a person reads; names in it cannot act on a terminal.
pub fn one_line(message: &str) -> String {
    let cut = message.chars().take(MAX_MESSAGE).collect::<String>().trim_end().replace('\n', "; ");
    on_one_line(&cut).into_owned()
}

/// Puts `bytes` at `path` in one move: whoever looks sees the old file, the whole new one, or none.
///
/// # Errors
/// What the system says; what was at `path` before is then untouched, and nothing is left beside it.
pub fn replace(path: &Path, bytes: impl AsRef<[u8]>) -> io::Result<()> {
    let mut file = beside(path)?;
    file.write_all(bytes.as_ref())?;
    file.as_file().sync_all()?;
    file.persist(path).map_err(|error| error.error)?;
    Ok(())
}

/// A new file in the folder of `path` that disappears unless it is kept.
///
/// # Errors
/// When the folder does not exist or cannot be written.
pub fn beside(path: &Path) -> io::Result<tempfile::NamedTempFile> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    // Asked first, because the answer to this has a plainer message.
    if !std::fs::metadata(folder)?.is_dir() {
        return Err(io::ErrorKind::NotADirectory.into());
    }
    let mut builder = tempfile::Builder::new();
    builder.prefix(".darrt-").suffix(".part");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        // As for any new file: the process's mask decides.
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    // The message would name the new file, of which nobody has heard.
    builder.tempfile_in(folder).map_err(|error| error.kind().into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_count_lines_and_characters() {
        for (offset, place) in [(0, (1, 1)), (2, (1, 2)), (4, (2, 1)), (5, (2, 2)), (99, (2, 2))] {
            assert_eq!(line_and_column("éa\nb", offset), place, "{offset}");
        }
    }

    #[test]
    fn long_and_deep_texts_are_refused_with_the_bound() {
        let at_start = |_: &str, limit: usize| if limit == MAX_NESTING { Err(0) } else { Ok(()) };
        let deep = check("[", "a", 9, at_start).unwrap_err().to_string();
        assert_eq!(deep, "a:1:1: nested deeper than 64 levels");
        let long = check("0123456789", "a", 9, at_start).unwrap_err().to_string();
        assert_eq!(long, "a: has 10 bytes, at most 9 are read");
        assert!(check("012345678", "a", 9, |_, _| Ok(())).is_ok());
    }

    #[test]
    fn messages_are_one_line_of_bounded_length() {
        assert_eq!(one_line("a\nb\n"), "a; b");
        assert_eq!(one_line(&"é".repeat(1000)).chars().count(), MAX_MESSAGE);
    }

    #[test]
    fn files_are_replaced_whole_and_nothing_is_left_behind() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        for text in ["one", "two"] {
            replace(&path, text).unwrap();
            assert_eq!(std::fs::read_to_string(&path).unwrap(), text);
        }
        let blocked = folder.path().join("folder");
        std::fs::create_dir(&blocked).unwrap();
        assert!(replace(&blocked, "three").is_err());
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2, "no part is left behind");
    }
}
