//! What is wrong with a text that is no TOML, or not of the format that is read: the place, the key and the nearest valid name.

use crate::problem_file::suggest::{hint, nearest_expected, shown};
use crate::problem_file::toml_path::path_at;
use crate::text_file::{line_and_column, one_line};

/// The text is not TOML, or a key or value is not part of the format.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{file}:{line}:{column}: {}{message}{}", at(key.as_deref()), hint(nearest.as_deref()))]
pub struct TomlError {
    /// The file.
    pub file: String,
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// Path of the key, such as `robot.base[1]`; indices count from 0. `None` when the text is not TOML, or the whole
    /// file lacks something.
    pub key: Option<String>,
    /// What is wrong, with the offending key or value.
    pub message: String,
    /// The nearest valid key or value.
    pub nearest: Option<String>,
}

impl TomlError {
    /// What the parser says of `text`, which errors call `file`.
    pub fn of(error: &toml::de::Error, text: &str, file: &str) -> Self {
        let place = error.span().unwrap_or(0..text.len());
        let (line, column) = line_and_column(text, place.start);
        Self {
            file: file.to_owned(),
            line,
            column,
            key: path_at(text, &place).map(|path| shown(&path)),
            nearest: nearest_expected(error.message()).map(|name| shown(&name)),
            message: one_line(error.message()),
        }
    }
}

fn at(key: Option<&str>) -> String {
    key.map_or_else(String::new, |key| format!("at `{key}`: "))
}
