//! A short name for a text, the same on every machine and in every build.

/// 64 bits of a text, as sixteen hexadecimal digits. Not for defence: two texts by chance share one with 2^-64.
///
/// # Source
/// Fowler, Noll, Vo: FNV-1a, 64 bits.
pub fn digest(text: &[u8]) -> String {
    format!("{:016x}", digest_bits(text))
}

/// The same as a number.
pub(crate) fn digest_bits(text: &[u8]) -> u64 {
    text.iter().fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values from the authors' test vectors.
    #[test]
    fn digests_are_those_of_the_published_vectors() {
        for (text, expected) in [("", "cbf29ce484222325"), ("a", "af63dc4c8601ec8c"), ("foobar", "85944171f73967e8")] {
            assert_eq!(digest(text.as_bytes()), expected);
        }
    }
}
