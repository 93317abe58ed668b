//! Tells problems, plans, recordings and robots from each other by what a file says about itself, so that a command that is given the wrong one can say
//! so and name the right command.

use std::io::Read as _;
use std::path::Path;

use crate::text::shell_word;
use crate::text_file::{STDIN, STDIN_NAME};

/// As much of a file as is looked at.
const HEAD: u64 = 4096;

/// What a file is, whether it is sound or not.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FileKind {
    /// A problem file (TOML).
    Problem,
    /// A problem as plans embed it, which is no file of its own.
    JsonProblem,
    /// A plan file (JSON).
    Plan,
    /// A recorded search (JSON).
    Recording,
    /// A robot file (TOML).
    Robot,
    /// A robot description (URDF).
    Description,
}

impl FileKind {
    /// What the text says that it is; `None` when it does not say.
    pub fn of_text(text: &str) -> Option<Self> {
        if is_json(text.as_bytes()) {
            if text.contains("\"darrt-plan\"") {
                return Some(Self::Plan);
            }
            // A plan embeds its problem, so only the first word counts.
            let (_, value) = text.split_once("\"format\"")?;
            let value = value.trim_start_matches([' ', '\t', '\r', '\n', ':']);
            if value.starts_with("\"darrt-recording\"") {
                return Some(Self::Recording);
            }
            return value.starts_with("\"darrt-problem\"").then_some(Self::JsonProblem);
        }
        if text.trim_start_matches('\u{feff}').trim_start().starts_with('<') {
            return text.contains("<robot").then_some(Self::Description);
        }
        let formats = [("darrt-problem", Self::Problem), ("darrt-robot", Self::Robot)];
        let said = text.lines().filter(|line| line.trim_start().trim_start_matches(['"', '\'']).starts_with("format"));
        said.flat_map(|line| formats.iter().filter(move |(name, _)| line.contains(name))).map(|(_, kind)| *kind).next()
    }

    /// What the beginning of a file says; for files that are not read as a whole. Of the standard input
    /// nothing is known before it is read.
    pub fn of_file(path: &Path) -> Option<Self> {
        if path == Path::new(STDIN) {
            return None;
        }
        Self::of_text(&String::from_utf8_lossy(&head(path)))
    }

    /// Why a file of this kind is no problem file; `None` if it is one.
    pub fn instead_of_problem(self, file: &str) -> Option<String> {
        if self == Self::Plan && file == STDIN_NAME {
            let why = "is a plan, not a problem; judge it with `darrt check -`, draw it with `darrt show -`";
            return Some(why.to_owned());
        }
        let file = shell_word(file);
        match self {
            Self::Problem => None,
            Self::JsonProblem => Some("is a problem as JSON; problem files are TOML".to_owned()),
            Self::Plan => Some(format!(
                "is a plan, not a problem; judge it with `darrt check {file}`, draw it with `darrt show {file}`"
            )),
            Self::Recording => Some(format!("is a recorded search, not a problem; draw it with `darrt show {file}`")),
            Self::Description => Some(description(&file)),
            Self::Robot => Some(format!(
                "is a robot file, not a problem; plan for it with `darrt plan PROBLEM --robot {file}`, draw it with `darrt show \
                 {file}`"
            )),
        }
    }

    /// Why a file of this kind is no plan file; `None` if it is one.
    pub fn instead_of_plan(self, file: &str) -> Option<String> {
        let file = shell_word(file);
        match self {
            Self::Plan => None,
            Self::JsonProblem => Some("is a problem as JSON, not a plan".to_owned()),
            Self::Recording => Some(format!("is a recorded search, not a plan; draw it with `darrt show {file}`")),
            Self::Description => Some(description(&file)),
            Self::Robot => Some(format!("is a robot file, not a plan; draw it with `darrt show {file}`")),
            Self::Problem => Some(format!("is a problem, not a plan; plan it with `darrt plan {file}`")),
        }
    }
}

fn description(file: &str) -> String {
    format!("is a robot description (URDF); a robot file for it is begun with `darrt robot new {file}`")
}

/// Whether a text begins as JSON does.
pub fn is_json(head: &[u8]) -> bool {
    head.trim_ascii_start().starts_with(b"{")
}

/// The first bytes of a regular file; nothing of anything else, which might never answer.
pub fn head(path: &Path) -> Vec<u8> {
    let mut bytes = Vec::new();
    if path.is_file()
        && let Ok(file) = std::fs::File::open(path)
    {
        // What was read before an error is good enough for a guess.
        let _ = file.take(HEAD).read_to_end(&mut bytes);
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_what_they_say() {
        let plan = "{\"format\": \"darrt-plan\", \"problem\": {\"format\": \"darrt-problem\"}}";
        assert_eq!(FileKind::of_text(plan), Some(FileKind::Plan));
        assert_eq!(FileKind::of_text(" {\"format\": \"darrt-problem\"}"), Some(FileKind::JsonProblem));
        assert_eq!(FileKind::of_text("# mine\n format = 'darrt-problem'\nx = = 2"), Some(FileKind::Problem));
        assert_eq!(FileKind::of_text("# mine\nformat = \"darrt-robot\"\nversion = 1"), Some(FileKind::Robot));
        assert_eq!(FileKind::of_text(&plan.replace("darrt-plan", "darrt-plot")), None);
        assert_eq!(FileKind::of_text(&plan.replace("darrt-plan", "darrt-recording")), Some(FileKind::Recording));
        for text in ["", "{}", "[1]", "format = 1", "name = \"darrt-problem\""] {
            assert_eq!(FileKind::of_text(text), None, "{text}");
        }
    }

    #[test]
    fn files_are_told_by_their_beginning() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("plan");
        assert_eq!(FileKind::of_file(&path), None);
        assert_eq!(FileKind::of_file(folder.path()), None);
        std::fs::write(&path, format!("{{\"format\": \"darrt-plan\"{}", " ".repeat(10_000))).unwrap();
        assert_eq!(FileKind::of_file(&path), Some(FileKind::Plan));
        assert_eq!(head(&path).len(), 4096);
    }
}
