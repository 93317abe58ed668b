//! Problems that a program carries inside, by name.

use std::path::Path;

use super::ProblemFile;
use super::error::ProblemFileError;
use super::suggest::{nearest, shown};
use crate::text_file::STDIN;

/// A problem that a program carries inside.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BuiltIn {
    /// Its name.
    pub name: &'static str,
    /// Its text, TOML.
    pub text: &'static str,
}

/// Problems that belong together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ProblemGroup {
    /// What they have in common, for people.
    pub title: &'static str,
    /// The problems, from easy to hard.
    pub problems: &'static [BuiltIn],
}

/// All problems that a program carries inside; the first group is benchmarked where nothing else is asked for.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Collection {
    groups: Vec<ProblemGroup>,
}

impl Collection {
    /// These groups, in the order in which they are listed.
    pub fn new(groups: impl IntoIterator<Item = ProblemGroup>) -> Self {
        Self { groups: groups.into_iter().collect() }
    }

    /// The groups.
    pub fn groups(&self) -> &[ProblemGroup] {
        &self.groups
    }

    /// All problems, group after group.
    pub fn all(&self) -> impl Iterator<Item = &'static BuiltIn> + '_ {
        self.groups.iter().flat_map(|group| group.problems)
    }

    /// The names of the first group, from easy to hard.
    pub fn first_names(&self) -> Vec<&'static str> {
        self.groups.first().map_or_else(Vec::new, |group| group.problems.iter().map(|problem| problem.name).collect())
    }

    /// The problem called `name`, in any case and spelling of the same letters and digits, such as `Plate3 (No Place)`.
    pub fn find(&self, name: &str) -> Option<&'static BuiltIn> {
        let wanted = folded(name);
        self.all().find(|problem| folded(problem.name) == wanted)
    }

    /// The problem called `name`, read.
    ///
    /// # Errors
    /// [`ProblemFileError::UnknownProblem`] with all names and the nearest one.
    pub fn read(&self, name: &str) -> Result<ProblemFile, ProblemFileError> {
        let BuiltIn { name, text } = self.find(name).ok_or_else(|| self.unknown(name))?;
        ProblemFile::from_toml(text, &format!("built-in {name}"))
    }

    /// Opens what a person names on a command line: a problem of the collection, else a file; `-` is the standard input.
    ///
    /// # Errors
    /// [`ProblemFileError::UnknownProblem`] with the nearest name when there is neither; else as [`ProblemFile::read`].
    pub fn open(&self, name_or_path: &str) -> Result<ProblemFile, ProblemFileError> {
        if name_or_path == STDIN {
            return ProblemFile::from_stdin();
        }
        if self.find(name_or_path).is_none() && Path::new(name_or_path).exists() {
            return ProblemFile::read(name_or_path);
        }
        self.read(name_or_path)
    }

    /// The error for a name that is neither in the collection nor a file.
    pub fn unknown(&self, name: &str) -> ProblemFileError {
        ProblemFileError::UnknownProblem {
            name: shown(name),
            nearest: nearest(name, self.all().map(|problem| problem.name)).map(str::to_owned),
            available: self.all().map(|problem| problem.name.to_owned()).collect(),
        }
    }
}

/// Letters and digits only, in lower case: what the spellings of one name have in common.
fn folded(name: &str) -> String {
    name.chars().filter(char::is_ascii_alphanumeric).map(|c| c.to_ascii_lowercase()).collect()
}

#[cfg(test)]
mod tests {
    use crate::testing::{builtin_text, registry};

    #[test]
    fn open_takes_names_in_any_spelling_and_paths() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("copy.toml");
        std::fs::write(&path, builtin_text("bowl").unwrap()).unwrap();
        let registry = registry();
        let problems = registry.problems();
        assert_eq!(problems.open(path.to_str().unwrap()).unwrap(), problems.open("BOWL").unwrap());
        let message = problems.open("bol").unwrap_err().to_string();
        assert!(message.contains("`bol`") && message.contains("did you mean `bowl`?"), "{message}");
    }
}
