//! The nearest valid name for one that is not.

use crate::text::on_one_line;

/// Longer names are compared and shown only up to this many characters.
const LONGEST: usize = 80;

/// How many names a message lists.
const MOST_LISTED: usize = 16;

/// Names less alike than this are no help (0 = nothing in common, 1 = equal).
const LEAST_LIKENESS: f64 = 0.3;

/// The candidate most like `wanted`, ignoring case; ties go to the first, `None` when nothing is alike.
pub fn nearest<'a>(wanted: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let wanted = shown(wanted).to_lowercase();
    let mut best: Option<(f64, &'a str)> = None;
    for candidate in candidates {
        let likeness = likeness(&wanted, &shown(candidate).to_lowercase());
        if likeness >= LEAST_LIKENESS && best.is_none_or(|(highest, _)| likeness > highest) {
            best = Some((likeness, candidate));
        }
    }
    best.map(|(_, candidate)| candidate)
}

fn likeness(a: &str, b: &str) -> f64 {
    let edits = strsim::normalized_damerau_levenshtein(a, b);
    let contained = a.len().min(b.len()) >= 3 && (a.contains(b) || b.contains(a));
    if contained { edits.max(0.6) } else { edits }
}

/// `text`, cut to a length that fits a message and without anything that a terminal acts on.
pub(crate) fn shown(text: &str) -> String {
    if text.chars().count() <= LONGEST {
        on_one_line(text).into_owned()
    } else {
        let start: String = text.chars().take(LONGEST).collect();
        format!("{}...", on_one_line(&start))
    }
}

/// `; did you mean ...?` or nothing.
pub(crate) fn hint(nearest: Option<&str>) -> String {
    nearest.map_or_else(String::new, |name| format!(" (did you mean `{}`?)", shown(name)))
}

/// The names in one line, shortened when there are many.
pub(crate) fn listed(names: &[String]) -> String {
    if names.is_empty() {
        return "none".to_owned();
    }
    let line = names.iter().take(MOST_LISTED).map(|name| shown(name)).collect::<Vec<_>>().join(", ");
    match names.len().checked_sub(MOST_LISTED) {
        None | Some(0) => line,
        Some(more) => format!("{line} and {more} more"),
    }
}

/// Takes a message of the TOML reader apart: the nearest of the names that it expected.
///
/// There are two wordings: serde's "unknown field `x`, expected one of `a`, `b`", and the reader's own for the keys of a
/// shape, "unexpected keys in table: x, available keys: a, b".
pub(crate) fn nearest_expected(message: &str) -> Option<String> {
    if let Some(keys) = message.strip_prefix("unexpected keys in table: ") {
        let (found, expected) = keys.split_once(", available keys: ")?;
        return nearest(found.split(", ").next()?, expected.split(", ")).map(str::to_owned);
    }
    let (found, expected) = message.split_once(", expected ")?;
    if !found.starts_with("unknown ") {
        return None;
    }
    let wanted = found.split('`').nth(1)?;
    nearest(wanted, expected.split('`').skip(1).step_by(2)).map(str::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_most_alike_wins_and_ties_go_to_the_first() {
        assert_eq!(nearest("obstacel", ["surface", "obstacle"]), Some("obstacle"));
        assert_eq!(nearest("push", ["Pick", "Push"]), Some("Push"));
        assert_eq!(nearest("ab", ["ac", "ad"]), Some("ac"));
        assert_eq!(nearest("table", ["central table", "shelf"]), Some("central table"));
        assert_eq!(nearest("zzz", ["Pick", "Push"]), None);
        assert_eq!(nearest("x", []), None);
    }

    #[test]
    fn serde_messages_are_taken_apart() {
        let many = "unknown field `sise`, expected one of `size`, `radius`";
        assert_eq!(nearest_expected(many).as_deref(), Some("size"));
        let one = "unknown field `sise`, expected `size`";
        assert_eq!(nearest_expected(one).as_deref(), Some("size"));
        let keys = "unexpected keys in table: hieght, x, available keys: radius, height";
        assert_eq!(nearest_expected(keys).as_deref(), Some("height"));
        assert_eq!(nearest_expected("missing field `name`"), None);
        assert_eq!(nearest_expected("unknown field, expected "), None);
    }

    #[test]
    fn long_names_and_lists_are_cut() {
        assert_eq!(shown(&"é".repeat(1000)).chars().count(), LONGEST + 3);
        let names: Vec<String> = (0..20).map(|i| i.to_string()).collect();
        assert!(listed(&names).ends_with("15 and 4 more"));
        assert_eq!(listed(&[]), "none");
    }
}
