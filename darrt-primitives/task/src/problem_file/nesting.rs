//! A look at the nesting of a TOML text before it is parsed, so that no file can exhaust the stack.

/// What the scanner is inside of.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Inside {
    Plain,
    Comment,
    /// A string that ends with `quote`, three times if `long`; `escapes` when a backslash hides the next byte.
    Text {
        quote: u8,
        long: bool,
    },
}

/// Checks that open brackets and braces plus the dots of the current key never exceed `limit`.
///
/// Knows comments and the four kinds of strings; takes one pass and no memory. On a text that is not TOML it may
/// refuse or accept, the parser has the last word.
///
/// # Errors
/// The byte offset of the first bracket or dot beyond `limit`.
pub fn check_nesting(text: &str, limit: usize) -> Result<(), usize> {
    let bytes = text.as_bytes();
    let mut inside = Inside::Plain;
    let mut brackets = 0_usize;
    let mut dots = 0_usize;
    let mut offset = 0;
    while let Some(&byte) = bytes.get(offset) {
        let mut width = 1;
        match inside {
            Inside::Comment => {
                if byte == b'\n' {
                    inside = Inside::Plain;
                    dots = 0;
                }
            }
            Inside::Text { quote, long } => {
                let rest = bytes.get(offset..).unwrap_or_default();
                if byte == b'\\' && quote == b'"' {
                    width = 2;
                } else if long && rest.starts_with(&[quote; 3]) {
                    width = 3;
                    inside = Inside::Plain;
                } else if !long && (byte == quote || byte == b'\n') {
                    inside = Inside::Plain;
                }
            }
            Inside::Plain => match byte {
                b'#' => inside = Inside::Comment,
                b'"' | b'\'' => {
                    let rest = bytes.get(offset..).unwrap_or_default();
                    let long = rest.starts_with(&[byte; 3]);
                    width = if long { 3 } else { 1 };
                    inside = Inside::Text { quote: byte, long };
                }
                b'[' | b'{' => {
                    brackets += 1;
                    dots = 0;
                }
                b']' | b'}' => {
                    brackets = brackets.saturating_sub(1);
                    dots = 0;
                }
                b'=' | b',' | b'\n' => dots = 0,
                b'.' => dots += 1,
                _ => {}
            },
        }
        if brackets + dots > limit {
            return Err(offset);
        }
        offset += width;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn brackets_braces_and_dotted_keys_count() {
        for text in ["a = [[[1]]]", "a = {b={c={d=1}}}", "a.b.c.d = 1", "[a.b.c]"] {
            assert!(check_nesting(text, 3).is_ok(), "{text}");
            assert!(check_nesting(text, 2).is_err(), "{text}");
        }
        let deep = format!("a = {}", "[".repeat(10_000));
        assert_eq!(check_nesting(&deep, 64), Err(4 + 64));
        let dotted = format!("{}z = 1", "a.".repeat(10_000));
        assert!(check_nesting(&dotted, 64).is_err());
    }

    #[test]
    fn strings_comments_and_numbers_do_not_count() {
        for text in [
            "a = \"[[[[\\\"[[[[\"",
            "a = '[[[[\\'",
            "a = \"\"\"[[[[\n\"[[[\\\"\"\"[[\"\"\"",
            "a = '''[[[[\n'[[[[\n'''",
            "# [[[[ ....\na = 1",
            "a = [1.5, 2.5, 3.5, 4.5,\n 5.5]\nb = 1.0\nc = 2.0",
        ] {
            assert!(check_nesting(text, 2).is_ok(), "{text}");
        }
    }

    #[test]
    fn unfinished_and_unbalanced_texts_are_left_to_the_parser() {
        for text in ["", "]]]]", "a = \"\\", "'''", "\"", "é = \"é\\é"] {
            assert!(check_nesting(text, 2).is_ok(), "{text}");
        }
    }
}
