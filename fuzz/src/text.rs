//! Texts from bytes: either the bytes themselves, or small edits of a text that is right.
//!
//! Random bytes hardly ever get past a parser; edits of a right text get far behind it.

use std::borrow::Cow;

use arbitrary::{Arbitrary, Unstructured};

/// Most edits of one text.
const MOST_EDITS: usize = 32;

/// What numbers in files should not be, and what they just may be.
const NUMBERS: [&str; 16] = [
    "nan",
    "inf",
    "-inf",
    "NaN",
    "1e400",
    "-1",
    "0",
    "-0.0",
    "5e-324",
    "1e308",
    "1e-9",
    "1e4",
    "9223372036854775807",
    "18446744073709551616",
    "1e",
    "0x10",
];

/// One edit; `at` counts pieces of the text, modulo their number.
#[derive(Debug, Arbitrary)]
struct Edit {
    at: u16,
    what: What,
}

#[derive(Debug, Arbitrary)]
enum What {
    /// The next number from here becomes this one.
    Number(f64),
    /// The next number from here becomes one of [`NUMBERS`].
    Special(u8),
    /// The next quoted word from here becomes the next quoted word from there.
    Quoted(u16),
    /// The piece here becomes the piece there.
    Copied(u16),
    /// This many pieces and one more go.
    Cut(u8),
    /// This many pieces and one more come twice.
    Twice(u8),
    /// These letters are put before the piece.
    Typed([u8; 4]),
}

/// The text that `data` stands for: edits of `bases[data[0]]` if there is such a text, else the bytes themselves.
///
/// There must be fewer than eight bases: no text begins with a character that small.
#[must_use]
pub fn text<'a>(data: &'a [u8], bases: &[&str]) -> Cow<'a, str> {
    debug_assert!(bases.len() < 8);
    match data.split_first().and_then(|(first, edits)| Some((bases.get(usize::from(*first))?, edits))) {
        Some((base, edits)) => Cow::Owned(edited(base, edits)),
        None => String::from_utf8_lossy(data),
    }
}

fn edited(base: &str, bytes: &[u8]) -> String {
    let mut pieces: Vec<Cow<'_, str>> = pieces(base).into_iter().map(Cow::Borrowed).collect();
    let mut bytes = Unstructured::new(bytes);
    for _ in 0..MOST_EDITS {
        if bytes.is_empty() || pieces.is_empty() {
            break;
        }
        let Ok(edit) = Edit::arbitrary(&mut bytes) else { break };
        apply(&mut pieces, &edit);
    }
    pieces.concat()
}

fn apply(pieces: &mut Vec<Cow<'_, str>>, edit: &Edit) {
    let count = pieces.len();
    let at = usize::from(edit.at) % count;
    let next = |from: usize, is: fn(&str) -> bool| (from..count).chain(0..from).find(|&i| is(&pieces[i]));
    match edit.what {
        What::Number(x) => {
            if let Some(i) = next(at, is_number) {
                pieces[i] = format!("{x:?}").into();
            }
        }
        What::Special(which) => {
            if let Some(i) = next(at, is_number) {
                pieces[i] = NUMBERS[usize::from(which) % NUMBERS.len()].into();
            }
        }
        What::Quoted(from) => {
            if let (Some(i), Some(j)) = (next(at, is_quoted), next(usize::from(from) % count, is_quoted)) {
                pieces[i] = pieces[j].clone();
            }
        }
        What::Copied(from) => pieces[at] = pieces[usize::from(from) % count].clone(),
        What::Cut(more) => drop(pieces.drain(at..(at + 1 + usize::from(more)).min(count))),
        What::Twice(more) => {
            let again = pieces[at..(at + 1 + usize::from(more)).min(count)].to_vec();
            drop(pieces.splice(at..at, again));
        }
        What::Typed(letters) => pieces.insert(at, String::from_utf8_lossy(&letters).into_owned().into()),
    }
}

fn is_number(piece: &str) -> bool {
    piece.starts_with(|c: char| c.is_ascii_digit() || c == '-') && piece.parse::<f64>().is_ok()
}

fn is_quoted(piece: &str) -> bool {
    piece.len() > 2 && piece.starts_with('"') && piece.ends_with('"')
}

/// Quoted words, words and numbers, and single other characters.
fn pieces(text: &str) -> Vec<&str> {
    let is_word = |c: char| c.is_ascii_alphanumeric() || "_.+-".contains(c);
    let mut pieces = Vec::new();
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let length = if first == '"' {
            rest[1..].find(['"', '\n']).map_or(rest.len(), |end| end + 2)
        } else if is_word(first) {
            rest.find(|c: char| !is_word(c)).unwrap_or(rest.len())
        } else {
            first.len_utf8()
        };
        let (piece, behind) = rest.split_at(length);
        pieces.push(piece);
        rest = behind;
    }
    pieces
}
