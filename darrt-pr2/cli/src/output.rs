//! Texts to the standard output and whole files to disk.

use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use super::exit::{Exit, Failure};
use super::table::WIDTH;
use darrt_task::file_kind::FileKind;
use darrt_task::picture::Format;
use darrt_task::text::printable;
use darrt_task::text_file;

/// Where results are printed. A reader that closes its end is not an error: the rest is dropped.
pub(crate) struct Output {
    to: Box<dyn Write>,
    is_closed: bool,
}

impl Output {
    /// The standard output.
    pub(crate) fn stdout() -> Self {
        Self::new(Box::new(io::stdout()))
    }

    /// Any other place.
    pub(crate) fn new(to: Box<dyn Write>) -> Self {
        Self { to, is_closed: false }
    }

    /// Prints sentences: lines that are too long for a terminal go on in the next one, below the text of their first.
    ///
    /// # Errors
    /// As [`Output::print`].
    pub(crate) fn tell(&mut self, text: &str) -> Result<(), Failure> {
        self.print(&folded(text))
    }

    /// Prints one text, ended by a line feed if it has none; what a terminal would act on is escaped.
    ///
    /// # Errors
    /// [`Exit::CannotWrite`] when the text cannot be written, a closed pipe excepted.
    pub(crate) fn print(&mut self, text: &str) -> Result<(), Failure> {
        if self.is_closed {
            return Ok(());
        }
        let text = printable(text);
        let end = if text.ends_with('\n') { "" } else { "\n" };
        let written = self.to.write_all(text.as_bytes()).and_then(|()| self.to.write_all(end.as_bytes()));
        match written.and_then(|()| self.to.flush()) {
            Ok(()) => Ok(()),
            Err(error) if error.kind() == ErrorKind::BrokenPipe => {
                self.is_closed = true;
                Ok(())
            }
            Err(error) => Err(Failure::new(Exit::CannotWrite, format!("standard output: cannot be written: {error}"))),
        }
    }
}

/// `text` in lines of the width of a terminal. A line that goes on is indented as far as what stands behind its label
/// (`notice:   ...`), else by two more than it was. What stands between backticks is to be copied, and stays whole, as names do
/// that are wider by themselves.
pub(crate) fn folded(text: &str) -> String {
    let width = usize::from(WIDTH);
    let fold = |line: &str| {
        if line.chars().count() <= width {
            return line.to_owned();
        }
        let indent = " ".repeat(hang(line));
        // Spaces in what is to be copied are no place to break at.
        let whole: String = line
            .split('`')
            .enumerate()
            .map(|(part, text)| if part % 2 == 1 { text.replace(' ', &GLUE.to_string()) } else { text.to_owned() })
            .collect::<Vec<_>>()
            .join("`");
        let options = textwrap::Options::new(width)
            .subsequent_indent(&indent)
            .break_words(false)
            .word_splitter(textwrap::WordSplitter::NoHyphenation)
            .word_separator(textwrap::WordSeparator::AsciiSpace)
            .wrap_algorithm(textwrap::WrapAlgorithm::FirstFit);
        textwrap::fill(&whole, options).replace(GLUE, " ")
    };
    text.split('\n').map(fold).collect::<Vec<_>>().join("\n")
}

/// Stands for a space at which no line is broken, and is as wide as one.
const GLUE: char = '\u{a0}';

/// How far a line is indented where it goes on.
fn hang(line: &str) -> usize {
    let spaces = line.chars().take_while(|c| *c == ' ').count();
    // A label is one short word, and its text stands in the column of all such texts.
    let Some((label, text)) = line.split_once(": ") else { return spaces + 2 };
    if label.len() > 9 || label.trim_start().contains(' ') {
        return spaces + 2;
    }
    label.chars().count() + 2 + text.chars().take_while(|c| *c == ' ').count()
}

/// A result for programs; `what` names it where it cannot be written.
///
/// # Errors
/// [`Exit::CannotWrite`] for what has no form as JSON.
pub(crate) fn json(value: &impl serde::Serialize, what: &str) -> Result<String, Failure> {
    let text = serde_json::to_string_pretty(value);
    text.map_err(|error| Failure::new(Exit::CannotWrite, format!("{what} cannot be written as JSON: {error}")))
}

/// Does this mean the standard input or output, and no file? Only plans go there.
pub(crate) fn is_standard_stream(path: &Path) -> bool {
    path == Path::new(text_file::STDIN)
}

/// Says before any work whether a file can be put at `path`, and where it will really be: links are followed.
///
/// # Errors
/// [`Exit::CannotWrite`] with the path when its folder does not exist or cannot be written, or when something that is
/// not a regular file is there; [`Exit::BadInput`] when a problem or a robot is there, which a person wrote.
pub(crate) fn writable(path: &Path) -> Result<PathBuf, Failure> {
    placed(path, |_| true)
}

/// [`writable`]; `is_kept` says which of what a person wrote stays.
fn placed(path: &Path, is_kept: impl Fn(&str) -> bool) -> Result<PathBuf, Failure> {
    let refuse = |reason: String| Failure::new(Exit::CannotWrite, format!("{}: {reason}", path.display()));
    if is_standard_stream(path) {
        let why = "is the standard output, where only the plan of `darrt plan` can go; a file of this name is `./-`";
        return Err(refuse(why.to_owned()));
    }
    let place = match std::fs::metadata(path) {
        Ok(there) if !there.is_file() => return Err(refuse("is there already and is not a regular file".to_owned())),
        Ok(_) => path.canonicalize().map_err(|error| refuse(format!("cannot be written: {error}")))?,
        Err(_) => path.to_path_buf(),
    };
    if let Some(what) = source_kind(&place).filter(|what| is_kept(what)) {
        return Err(Failure::input(format!("{}: is there already and is {what}, it would be lost", path.display())));
    }
    if place.file_name().is_none() {
        return Err(refuse("is not the name of a file".to_owned()));
    }
    // The new file is made and dropped again.
    text_file::beside(&place).map_err(|error| refuse(format!("cannot be written: {error}")))?;
    Ok(place)
}

/// [`writable`] for a problem, which may take the place of another one.
///
/// # Errors
/// As [`writable`].
pub(crate) fn writable_problem(path: &Path) -> Result<PathBuf, Failure> {
    placed(path, |what| what != "a problem")
}

/// What a file is that a person wrote, if it is such a one; what this program wrote may be written over.
fn source_kind(place: &Path) -> Option<&'static str> {
    if place.metadata().is_ok_and(|there| there.len() == 0) {
        return None;
    }
    match FileKind::of_file(place)? {
        FileKind::Problem | FileKind::JsonProblem => Some("a problem"),
        FileKind::Robot => Some("a robot file"),
        FileKind::Description => Some("a robot description"),
        FileKind::Plan | FileKind::Recording => None,
    }
}

/// [`writable`] for a page, whose name says that it is one.
///
/// # Errors
/// [`Exit::BadInput`] for another ending than `.html` or `.htm`, else as [`writable`].
pub(crate) fn writable_page(path: &Path) -> Result<PathBuf, Failure> {
    if matches!(Format::of_path(path), Ok(Format::Html)) {
        return writable(path);
    }
    let there = if path.exists() { ", and what is there would be lost" } else { "" };
    Err(Failure::input(format!("{}: a page ends in .html{there}", path.display())))
}

/// Do both name the same file, whether it is there already or not?
pub(crate) fn is_same_file(a: &Path, b: &Path) -> bool {
    let place = |path: &Path| {
        path.canonicalize().ok().or_else(|| {
            let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
            Some(folder.canonicalize().ok()?.join(path.file_name()?))
        })
    };
    a == b || place(a).is_some_and(|a| place(b) == Some(a))
}

/// Nothing that is read is written over, and no two results go to one file. All with what they are.
///
/// # Errors
/// [`Exit::BadInput`] with the file.
pub(crate) fn keep_apart(read: &[(&str, &Path)], written: &[(&str, &Path)]) -> Result<(), Failure> {
    for (place, (what, path)) in written.iter().enumerate() {
        if let Some((input, _)) = read.iter().find(|(_, input)| input.exists() && is_same_file(input, path)) {
            return Err(Failure::input(format!("{}: is the {input} itself, it would be lost", path.display())));
        }
        if let Some((other, _)) = written.iter().skip(place + 1).find(|(_, other)| is_same_file(other, path)) {
            return Err(Failure::input(format!("{}: cannot be both the {what} and the {other}", path.display())));
        }
    }
    Ok(())
}

/// Puts `bytes` at `path` in one move: whoever looks sees the old file, the whole new one, or none.
///
/// # Errors
/// [`Exit::CannotWrite`] with the path.
pub(crate) fn write_file(path: &Path, bytes: impl AsRef<[u8]>) -> Result<(), Failure> {
    text_file::replace(path, bytes)
        .map_err(|error| Failure::new(Exit::CannotWrite, format!("{}: cannot be written: {error}", path.display())))
}

/// A name as part of a file name: letters, digits, dots, dashes and underscores stay, runs of all else become a dash.
pub(crate) fn file_stem(name: &str) -> String {
    let mut stem = String::new();
    for c in name.chars() {
        if c.is_alphanumeric() || matches!(c, '.' | '-' | '_') {
            stem.push(c);
        } else if !stem.ends_with('-') {
            stem.push('-');
        }
    }
    let stem: String = stem.trim_matches(['.', '-']).chars().take(80).collect();
    if stem.is_empty() { "problem".to_owned() } else { stem }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sentences_are_folded_below_their_text_and_what_is_copied_stays_whole() {
        let words = "word ".repeat(18);
        assert_eq!(folded(words.trim_end()), format!("{}\n  word word", "word ".repeat(16).trim_end()));
        let notice = folded(&format!("notice:   {}", words.trim_end()));
        assert_eq!(notice.lines().nth(1), Some("          word word word word"));
        let copied = format!("{}`darrt plan plate3 --seed 7 --time-limit 60`", "word ".repeat(10));
        assert!(folded(&copied).ends_with("\n  `darrt plan plate3 --seed 7 --time-limit 60`"));
        let name = "x".repeat(100);
        assert_eq!(folded(&name), name);
        assert_eq!(folded("short\n  lines\n"), "short\n  lines\n");
        assert!(folded(&format!("aaaa: ä{}", "ö ".repeat(60))).lines().all(|line| line.chars().count() <= 80));
    }

    /// Fails with one kind of error.
    struct Broken(ErrorKind);

    impl Write for Broken {
        fn write(&mut self, _: &[u8]) -> io::Result<usize> {
            Err(self.0.into())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn a_closed_pipe_is_no_error_but_a_full_disk_is() {
        let mut closed = Output::new(Box::new(Broken(ErrorKind::BrokenPipe)));
        assert!(closed.print("a").is_ok() && closed.print("b").is_ok());
        let failure = Output::new(Box::new(Broken(ErrorKind::StorageFull))).print("a").unwrap_err();
        assert_eq!(failure.exit, Exit::CannotWrite);
    }

    #[test]
    fn names_become_harmless_file_names() {
        for (name, stem) in [
            ("plate3", "plate3"),
            ("../../etc/passwd", "etc-passwd"),
            ("My problem: (2)", "My-problem-2"),
            ("///", "problem"),
        ] {
            assert_eq!(file_stem(name), stem);
        }
        assert_eq!(file_stem(&"x".repeat(500)).len(), 80);
    }

    #[test]
    fn a_place_that_can_be_written_is_left_as_it_was() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("picture.svg");
        let place = writable(&path).unwrap();
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
        write_file(&place, "one").unwrap();
        writable(&path).unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "one");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn folders_missing_folders_and_devices_are_refused_beforehand() {
        let folder = tempfile::tempdir().unwrap();
        for path in [folder.path().to_path_buf(), folder.path().join("no/file"), PathBuf::from("/dev/null")] {
            let failure = writable(&path).unwrap_err();
            assert_eq!(failure.exit, Exit::CannotWrite);
            assert!(failure.message.contains(&path.display().to_string()), "{}", failure.message);
        }
    }
}
