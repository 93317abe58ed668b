//! Small matters of wording that all messages share.

use std::borrow::Cow;

/// `1 step`, `2 steps`: a count with its noun, `one` being the singular.
pub fn counted(count: u64, one: &str) -> String {
    format!("{count} {one}{}", if count == 1 { "" } else { "s" })
}

/// The text with every character that a terminal acts on, line feeds excepted, written as its escape (`\u{1b}`).
///
/// Names come from files of strangers: printed as they are they could move the cursor, recolour or rewrite what the
/// program says.
pub fn printable(text: &str) -> Cow<'_, str> {
    escaped(text, |c| c != '\n' && acts(c))
}

/// As [`printable`], line feeds included: the text stays on one line.
pub fn on_one_line(text: &str) -> Cow<'_, str> {
    escaped(text, acts)
}

/// Whether a character does something to the terminal instead of being shown: control characters, and the marks that
/// reverse the direction of writing.
pub fn acts(c: char) -> bool {
    c.is_control() || matches!(c, '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// The text as one word of a command that is proposed to the user, as a POSIX shell reads it: in quotes where that needs them.
pub fn shell_word(text: &str) -> Cow<'_, str> {
    // A name with a zero byte is that of no file.
    shlex::try_quote(text).unwrap_or(Cow::Borrowed(text))
}

fn escaped(text: &str, is_bad: impl Fn(char) -> bool) -> Cow<'_, str> {
    if !text.contains(&is_bad) {
        return Cow::Borrowed(text);
    }
    let mut out = String::with_capacity(text.len() + 16);
    for c in text.chars() {
        if is_bad(c) { out.extend(c.escape_default()) } else { out.push(c) }
    }
    Cow::Owned(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_is_singular_and_all_else_plural() {
        assert_eq!([0, 1, 2].map(|n| counted(n, "step")), ["0 steps", "1 step", "2 steps"]);
    }

    #[test]
    fn what_a_shell_would_split_or_read_otherwise_is_in_quotes() {
        for (text, word) in [("a/b-1.toml", "a/b-1.toml"), ("my plan.json", "'my plan.json'"), ("", "''")] {
            assert_eq!(shell_word(text), word);
        }
        let odd = "it's $HOME; *";
        assert_eq!(shlex::split(&shell_word(odd)).unwrap(), [odd]);
    }

    #[test]
    fn what_a_terminal_acts_on_is_written_out() {
        let hostile = "a\u{1b}[2J\u{9b}b\r\u{202e}\nc é";
        assert_eq!(printable(hostile), "a\\u{1b}[2J\\u{9b}b\\r\\u{202e}\nc é");
        assert_eq!(on_one_line(hostile), "a\\u{1b}[2J\\u{9b}b\\r\\u{202e}\\nc é");
        assert!(matches!(printable("plain\n"), Cow::Borrowed(_)));
    }
}
