//! Which key of a TOML text a place belongs to.

use std::ops::Range;

use toml::de::{DeTable, DeValue};

/// The path of the innermost key or entry that contains the whole byte range `place`, such as
/// `object[0].shape.box.size[1]`; indices count from 0.
///
/// `None` for a place outside all keys and for a text that is not TOML. The nesting of the text must be bounded.
pub(crate) fn path_at(text: &str, place: &Range<usize>) -> Option<String> {
    // What the whole file lacks is told of no place at all.
    if *place == (0..0) {
        return None;
    }
    let table = DeTable::parse(text).ok()?;
    let mut search = Search { place, best: None };
    search.table(table.get_ref(), "");
    search.best.map(|(_, path)| path)
}

/// Where the value of `path` stands in a TOML text, as a byte offset; of a path of which only the beginning is there, where that
/// is. `None` for a path of which nothing is there and for a text that is not TOML.
pub(crate) fn line_of(text: &str, path: &str) -> Option<usize> {
    let table = DeTable::parse(text).ok()?;
    let mut found = None;
    let mut here = table.get_ref();
    for part in path.split(['.', '[']) {
        let inside = here.iter().find(|(key, _)| key.get_ref().as_ref() == part.trim_end_matches(']'));
        let Some((key, value)) = inside else { break };
        found = Some(key.span().start);
        let DeValue::Table(table) = value.get_ref() else { break };
        here = table;
    }
    found
}

struct Search<'a> {
    place: &'a Range<usize>,
    /// Length and path of the shortest part that contains the place.
    best: Option<(usize, String)>,
}

impl Search<'_> {
    // The span of a table is only its header, so every part is looked at whether the one around it fits or not.
    fn table(&mut self, table: &DeTable<'_>, path: &str) {
        let separator = if path.is_empty() { "" } else { "." };
        for (key, value) in table {
            let path = format!("{path}{separator}{}", key.get_ref());
            self.consider(&key.span(), &path);
            self.consider(&value.span(), &path);
            self.value(value.get_ref(), &path);
        }
    }

    fn value(&mut self, value: &DeValue<'_>, path: &str) {
        match value {
            DeValue::Table(table) => self.table(table, path),
            DeValue::Array(entries) => {
                for (index, entry) in entries.iter().enumerate() {
                    let path = format!("{path}[{index}]");
                    self.consider(&entry.span(), &path);
                    self.value(entry.get_ref(), &path);
                }
            }
            _ => {}
        }
    }

    fn consider(&mut self, span: &Range<usize>, path: &str) {
        let contains = span.start <= self.place.start && self.place.end <= span.end && !span.is_empty();
        if contains && self.best.as_ref().is_none_or(|(length, _)| span.len() <= *length) {
            self.best = Some((span.len(), path.to_owned()));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str =
        "name = \"x\"\n[robot]\nbase = [1, 22, 3]\n[[object]]\nat = 1\n[[object]]\nshape = { box = { size = 7 } }\n";

    #[test]
    fn what_the_whole_file_lacks_belongs_to_no_key() {
        assert_eq!(path_at(TEXT, &(0..0)), None);
    }

    #[test]
    fn places_know_their_key() {
        for (part, path) in [
            ("\"x\"", "name"),
            ("base", "robot.base"),
            ("22", "robot.base[1]"),
            ("[1, 22", "robot.base"),
            ("at", "object[0].at"),
            ("7", "object[1].shape.box.size"),
            ("box", "object[1].shape.box"),
            ("[robot]", "robot"),
        ] {
            let start = TEXT.find(part).unwrap();
            assert_eq!(path_at(TEXT, &(start..start + part.len())).as_deref(), Some(path), "{part}");
        }
    }

    #[test]
    fn places_beyond_the_keys_have_none() {
        assert_eq!(path_at(TEXT, &(0..TEXT.len())), None);
        assert_eq!(path_at("a = = 1", &(4..5)), None);
        assert_eq!(path_at("", &(0..0)), None);
    }
}
