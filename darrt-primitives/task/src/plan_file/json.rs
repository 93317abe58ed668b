//! A look at a JSON text without a parser: how deep it is nested, and which key an offset belongs to.

/// Checks that brackets and braces never nest deeper than `limit`; one pass, no memory.
///
/// # Errors
/// The byte offset of the first bracket beyond `limit`.
pub(super) fn check_nesting(text: &str, limit: usize) -> Result<(), usize> {
    let mut depth = 0_usize;
    let mut inside_string = false;
    let mut escaped = false;
    for (offset, byte) in text.bytes().enumerate() {
        if inside_string {
            match byte {
                _ if escaped => escaped = false,
                b'\\' => escaped = true,
                b'"' => inside_string = false,
                _ => {}
            }
            continue;
        }
        match byte {
            b'"' => inside_string = true,
            b'[' | b'{' => depth += 1,
            b']' | b'}' => depth = depth.saturating_sub(1),
            _ => {}
        }
        if depth > limit {
            return Err(offset);
        }
    }
    Ok(())
}

/// One open bracket.
enum Open {
    /// `[`, with the index of the entry.
    Array(usize),
    /// `{`, with the last key.
    Object { key: String, expects_key: bool },
}

/// The path of the key or entry at byte `offset`, such as `steps[3].primitive`; `the whole file` at the top level.
pub(super) fn path_at(text: &str, offset: usize) -> String {
    let mut open: Vec<Open> = Vec::new();
    let mut string_start = None;
    let mut escaped = false;
    for (at, byte) in text.bytes().enumerate().take(offset) {
        if let Some(start) = string_start {
            match byte {
                _ if escaped => escaped = false,
                b'\\' => escaped = true,
                b'"' => {
                    string_start = None;
                    if let Some(Open::Object { key, expects_key: true }) = open.last_mut() {
                        text.get(start..at).unwrap_or_default().clone_into(key);
                    }
                }
                _ => {}
            }
            continue;
        }
        match byte {
            b'"' => string_start = Some(at + 1),
            b'[' => open.push(Open::Array(0)),
            b'{' => open.push(Open::Object { key: String::new(), expects_key: true }),
            // A missing key is noticed at the closing brace: keep the object it is missing from.
            b']' | b'}' if at + 1 < offset => drop(open.pop()),
            b',' | b':' => match open.last_mut() {
                Some(Open::Array(index)) => *index += usize::from(byte == b','),
                Some(Open::Object { expects_key, .. }) => *expects_key = byte == b',',
                None => {}
            },
            _ => {}
        }
    }
    // What is missing is missing from the object that ends here, not from its last key.
    if string_start.is_none()
        && text.as_bytes().get(offset.saturating_sub(1)) == Some(&b'}')
        && let Some(Open::Object { key, .. }) = open.last_mut()
    {
        key.clear();
    }
    written(&open)
}

fn written(open: &[Open]) -> String {
    let mut path = String::new();
    for level in open {
        match level {
            Open::Array(index) => {
                path.push('[');
                path.push_str(&index.to_string());
                path.push(']');
            }
            Open::Object { key, .. } if key.is_empty() => {}
            Open::Object { key, .. } => {
                if !path.is_empty() {
                    path.push('.');
                }
                path.push_str(key);
            }
        }
    }
    if path.is_empty() { "the whole file".to_owned() } else { path }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn depth_counts_brackets_outside_strings() {
        assert!(check_nesting(r#"{"a": [1, [2]], "[[[[\"[[[": "{{{{"}"#, 3).is_ok());
        assert_eq!(check_nesting("[[[[", 3), Err(3));
        let deep = "[".repeat(10_000);
        assert_eq!(check_nesting(&deep, 64), Err(64));
        assert!(check_nesting("]]]]}}", 1).is_ok());
    }

    #[test]
    fn offsets_know_their_key() {
        let text = r#"{"a": {"b,:[{": [1, {"c": 2.5, "d": "x"}]}, "e": 7}"#;
        for (part, path) in [("2.5", "a.b,:[{[1].c"), ("\"x\"", "a.b,:[{[1].d"), ("7", "e"), ("1, ", "a.b,:[{[0]")] {
            assert_eq!(path_at(text, text.find(part).unwrap() + 1), path);
        }
        assert_eq!(path_at(text, 0), "the whole file");
        // What is missing is noticed at the end of what it is missing from.
        let nested = r#"{"a": {"b": 1}}"#;
        assert_eq!([14, 15].map(|offset| path_at(nested, offset)), ["a", "the whole file"]);
        assert_eq!(path_at("\"\\", 99), "the whole file");
    }
}
