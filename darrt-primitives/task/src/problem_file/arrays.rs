//! Arrays of a fixed length: the TOML reader drops what is too much of them without a word, and takes lists for tables.

use serde::Serialize;
use toml::Value;

use super::error::{Flaw, Located};

/// Every array of the text has as many entries as what was read from it, and none stands for a table.
///
/// # Errors
/// The first that has not, with its key.
pub(crate) fn check_lengths(text: &Value, read: &impl Serialize) -> Result<(), Located> {
    // What cannot be written is refused later, with a better reason.
    let Ok(read) = Value::try_from(read) else { return Ok(()) };
    walk(text, &read, "")
}

fn walk(text: &Value, read: &Value, key: &str) -> Result<(), Located> {
    match (text, read) {
        (Value::Array(text), Value::Array(read)) => {
            if text.len() > read.len() {
                let bound = format!("{}", read.len());
                return Err(Flaw::WrongLength { found: text.len(), bound }.at(key));
            }
            let both = text.iter().zip(read).enumerate();
            both.into_iter().try_for_each(|(index, (text, read))| walk(text, read, &format!("{key}[{index}]")))
        }
        (Value::Table(text), Value::Table(read)) => text.iter().try_for_each(|(name, text)| {
            let separator = if key.is_empty() { "" } else { "." };
            read.get(name).map_or(Ok(()), |read| walk(text, read, &format!("{key}{separator}{name}")))
        }),
        // By position, without names, nobody could tell what is what.
        (Value::Array(_), Value::Table(_)) => {
            Err(Flaw::Inconsistent("must be a table with keys, not a list".to_owned()).at(key))
        }
        _ => Ok(()),
    }
}
