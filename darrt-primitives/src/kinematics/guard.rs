//! A scan of XML bytes before any recursive reader sees them.
//!
//! The URDF reader recurses once per nesting level and clones its namespace table once per element, so a small file
//! can overflow the stack (which cannot be caught) or take minutes. This scan is linear, needs no stack, and refuses
//! such files first. It keeps to the strict grammar of XML: where a lenient reader could see other nesting than this
//! scan (a stray quote, a `?` inside an instruction), the text is refused.

use super::urdf::UrdfError;

/// Largest accepted text, bytes (16 MiB).
pub const MAX_BYTES: usize = 16 << 20;
/// Deepest accepted nesting of elements.
pub const MAX_DEPTH: usize = 64;
/// Most elements accepted.
pub const MAX_ELEMENTS: usize = 100_000;
/// Longest accepted tag, bytes: bounds the number of attributes of one element.
pub const MAX_TAG_BYTES: usize = 64 << 10;
/// Most namespace declarations (`xmlns`) accepted.
pub const MAX_NAMESPACES: usize = 32;

/// Checks size, nesting depth, element count and tag lengths of an XML text, and that it has no document type.
///
/// # Errors
/// [`UrdfError::TooLarge`], [`UrdfError::TooDeep`], [`UrdfError::TooMany`] with the number found and the bound;
/// [`UrdfError::DocumentType`] for a DTD; [`UrdfError::Malformed`] with the byte offset where the text stops being
/// well-formed.
pub fn check(text: &str) -> Result<(), UrdfError> {
    if text.len() > MAX_BYTES {
        return Err(UrdfError::TooLarge { what: "text", bytes: text.len(), bound: MAX_BYTES });
    }
    let mut scan = Scan { bytes: text.as_bytes(), at: 0, depth: 0, elements: 0, namespaces: 0 };
    scan.document()
}

/// The scanner: a position, and the counts that are bounded.
struct Scan<'a> {
    bytes: &'a [u8],
    at: usize,
    depth: usize,
    elements: usize,
    namespaces: usize,
}

impl Scan<'_> {
    fn document(&mut self) -> Result<(), UrdfError> {
        while let Some(offset) = self.rest().iter().position(|b| *b == b'<') {
            self.nothing_beside_root(offset)?;
            self.at += offset;
            self.markup()?;
        }
        self.nothing_beside_root(self.rest().len())?;
        if self.depth == 0 {
            Ok(())
        } else {
            self.at = self.bytes.len();
            Err(self.malformed("an element is not closed"))
        }
    }

    /// Outside the root element there is no text in the next `length` bytes.
    fn nothing_beside_root(&mut self, length: usize) -> Result<(), UrdfError> {
        // A byte-order mark may come first.
        let is_text = |b: &u8| !matches!(b, b' ' | b'\t' | b'\r' | b'\n' | 0xEF | 0xBB | 0xBF);
        let found = self.rest().iter().take(length).position(is_text).filter(|_| self.depth == 0);
        found.map_or(Ok(()), |offset| {
            self.at += offset;
            Err(self.malformed("text outside the root element"))
        })
    }

    /// One construct that starts with `<`.
    fn markup(&mut self) -> Result<(), UrdfError> {
        let rest = self.rest();
        if rest.starts_with(b"<!--") {
            self.at += 4;
            self.skip_past(b"--", "a comment is not closed")?;
            self.expect(b'>', "-- inside a comment")
        } else if rest.starts_with(b"<![CDATA[") {
            self.at += 9;
            self.skip_past(b"]]>", "a CDATA section is not closed")
        } else if rest.starts_with(b"<!") {
            Err(UrdfError::DocumentType { offset: self.at })
        } else if rest.starts_with(b"<?") {
            self.at += 2;
            self.skip_past(b"?", "a processing instruction is not closed")?;
            self.expect(b'>', "? inside a processing instruction")
        } else if rest.starts_with(b"</") {
            self.at += 2;
            self.close_tag()
        } else {
            self.at += 1;
            self.open_tag()
        }
    }

    fn close_tag(&mut self) -> Result<(), UrdfError> {
        self.name("a closing tag without a name")?;
        self.blanks();
        self.expect(b'>', "a closing tag is not closed")?;
        self.depth =
            self.depth.checked_sub(1).ok_or_else(|| self.malformed("a closing tag without its opening tag"))?;
        Ok(())
    }

    fn open_tag(&mut self) -> Result<(), UrdfError> {
        let start = self.at;
        if self.depth == 0 && self.elements > 0 {
            return Err(self.malformed("a second root element"));
        }
        self.name("a tag without a name")?;
        self.elements += 1;
        bounded("elements", self.elements, MAX_ELEMENTS)?;
        loop {
            if self.at - start > MAX_TAG_BYTES {
                return Err(UrdfError::TooLarge { what: "tag", bytes: self.at - start, bound: MAX_TAG_BYTES });
            }
            let blank = self.blanks();
            match self.peek() {
                Some(b'>') => {
                    self.at += 1;
                    self.depth += 1;
                    return if self.depth > MAX_DEPTH {
                        Err(UrdfError::TooDeep { depth: self.depth, bound: MAX_DEPTH, offset: start })
                    } else {
                        Ok(())
                    };
                }
                Some(b'/') => {
                    self.at += 1;
                    return self.expect(b'>', "/ inside a tag");
                }
                Some(_) if blank => self.attribute()?,
                _ => return Err(self.malformed("a tag is not closed")),
            }
        }
    }

    fn attribute(&mut self) -> Result<(), UrdfError> {
        if self.rest().starts_with(b"xmlns") {
            self.namespaces += 1;
            bounded("namespaces", self.namespaces, MAX_NAMESPACES)?;
        }
        self.name("an attribute without a name")?;
        self.blanks();
        self.expect(b'=', "an attribute without a value")?;
        self.blanks();
        let Some(quote @ (b'"' | b'\'')) = self.peek() else {
            return Err(self.malformed("an attribute value without quotes"));
        };
        self.at += 1;
        let end = self.rest().iter().position(|b| *b == quote || *b == b'<');
        self.at += end.ok_or_else(|| self.malformed("an attribute value is not closed"))?;
        self.expect(quote, "< inside an attribute value")
    }

    /// Skips a name: everything up to a blank or a delimiter.
    fn name(&mut self, complaint: &'static str) -> Result<(), UrdfError> {
        let is_name = |b: &u8| {
            !matches!(b, b' ' | b'\t' | b'\r' | b'\n' | b'<' | b'>' | b'/' | b'=' | b'"' | b'\'' | b'&' | b'!' | b'?')
        };
        let length = self.rest().iter().take_while(|b| is_name(b)).count();
        self.at += length;
        if length == 0 { Err(self.malformed(complaint)) } else { Ok(()) }
    }

    /// Skips blanks; whether there was one.
    fn blanks(&mut self) -> bool {
        let is_blank = |b: &u8| matches!(b, b' ' | b'\t' | b'\r' | b'\n');
        let length = self.rest().iter().take_while(|b| is_blank(b)).count();
        self.at += length;
        length > 0
    }

    fn skip_past(&mut self, mark: &[u8], complaint: &'static str) -> Result<(), UrdfError> {
        let found = self.rest().windows(mark.len()).position(|w| w == mark);
        match found {
            Some(offset) => {
                self.at += offset + mark.len();
                Ok(())
            }
            None => Err(self.malformed(complaint)),
        }
    }

    fn expect(&mut self, byte: u8, complaint: &'static str) -> Result<(), UrdfError> {
        if self.peek() == Some(byte) {
            self.at += 1;
            Ok(())
        } else {
            Err(self.malformed(complaint))
        }
    }

    fn rest(&self) -> &[u8] {
        self.bytes.get(self.at..).unwrap_or_default()
    }

    fn peek(&self) -> Option<u8> {
        self.bytes.get(self.at).copied()
    }

    fn malformed(&self, what: &'static str) -> UrdfError {
        UrdfError::Malformed { what, offset: self.at }
    }
}

/// # Errors
/// [`UrdfError::TooMany`] when `count` exceeds `bound`.
pub(super) fn bounded(what: &'static str, count: usize, bound: usize) -> Result<(), UrdfError> {
    if count > bound { Err(UrdfError::TooMany { what, count, bound }) } else { Ok(()) }
}

#[cfg(test)]
mod tests;
