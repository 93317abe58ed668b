//! Indices of bodies in a collision model, and sets of them.

/// Most bodies a collision model may have.
pub const MAXIMUM_BODIES: usize = 16_384;
/// Bodies from this index on are the crowd: a set has all of them or none. They never move.
pub const FIRST_OF_CROWD: usize = 511;
const WORDS: usize = FIRST_OF_CROWD / 64 + 1;

/// Which body of a collision model: the order of registration, from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct BodyIndex(u16);

impl BodyIndex {
    /// The body registered as number `index`.
    pub const fn new(index: u16) -> Self {
        Self(index)
    }

    /// The number, for indexing.
    pub const fn get(self) -> usize {
        self.0 as usize
    }

    /// Its place among the bits of a set.
    #[inline]
    fn bit(self) -> usize {
        self.get().min(FIRST_OF_CROWD)
    }
}

impl std::fmt::Display for BodyIndex {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}", self.0)
    }
}

/// A set of bodies as bits; `Copy`, 64 bytes.
///
/// The bodies from [`FIRST_OF_CROWD`] on share one bit: who puts in one of them puts in all. So a set has the same size in a room with
/// ten thousand obstacles as on a desk; obstacles beyond the first few hundred have nothing about them that a set could tell apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct BodySet {
    words: [u64; WORDS],
}

impl BodySet {
    /// No body.
    pub const EMPTY: Self = Self { words: [0; WORDS] };
    /// Every body.
    pub const ALL: Self = Self { words: [u64::MAX; WORDS] };

    /// Adds a body.
    pub fn insert(&mut self, body: BodyIndex) {
        if let Some(word) = self.words.get_mut(body.bit() / 64) {
            *word |= 1 << (body.bit() % 64);
        }
    }

    /// Adds those of the bodies `8 * eight` to `8 * eight + 7` whose bits are set.
    #[inline]
    pub(crate) fn insert_eight(&mut self, eight: usize, bits: u8) {
        if let Some(word) = self.words.get_mut(eight / 8) {
            *word |= u64::from(bits) << (eight % 8 * 8);
        }
    }

    /// Which of the bodies `8 * eight` to `8 * eight + 7` are in the set, as bits.
    #[inline]
    pub(crate) fn eight(&self, eight: usize) -> u8 {
        let word = self.words.get(eight / 8).map_or(0, |word| word >> (eight % 8 * 8));
        word.to_le_bytes()[0]
    }

    /// Takes a body out.
    pub fn remove(&mut self, body: BodyIndex) {
        if let Some(word) = self.words.get_mut(body.bit() / 64) {
            *word &= !(1 << (body.bit() % 64));
        }
    }

    /// Whether the body is in the set.
    #[inline]
    pub fn contains(&self, body: BodyIndex) -> bool {
        self.words.get(body.bit() / 64).is_some_and(|word| word >> (body.bit() % 64) & 1 == 1)
    }

    /// Bodies in either set.
    #[must_use]
    pub fn union(mut self, other: &Self) -> Self {
        self.words.iter_mut().zip(&other.words).for_each(|(a, b)| *a |= b);
        self
    }

    /// Bodies in both sets.
    #[must_use]
    pub fn intersection(mut self, other: &Self) -> Self {
        self.words.iter_mut().zip(&other.words).for_each(|(a, b)| *a &= b);
        self
    }

    /// Bodies in this set but not in the other.
    #[must_use]
    pub fn difference(mut self, other: &Self) -> Self {
        self.words.iter_mut().zip(&other.words).for_each(|(a, b)| *a &= !b);
        self
    }

    /// Whether there is no body in the set.
    pub fn is_empty(&self) -> bool {
        *self == Self::EMPTY
    }

    /// Number of bodies; the crowd counts as one.
    pub fn len(&self) -> usize {
        self.words.iter().map(|word| word.count_ones() as usize).sum()
    }

    /// The bodies in ascending order; of the crowd the first.
    pub fn iter(&self) -> impl Iterator<Item = BodyIndex> + '_ {
        (0_u16..).zip(&self.words).flat_map(|(block, &word)| {
            let rest = |w: &u64| Some(w & (w - 1)).filter(|&w| w != 0);
            let start = Some(word).filter(|&w| w != 0);
            // A trailing zero count of a nonzero word is below 64.
            std::iter::successors(start, rest)
                .map(move |w| BodyIndex(block * 64 + u16::try_from(w.trailing_zeros()).unwrap_or(0)))
        })
    }
}

impl FromIterator<BodyIndex> for BodySet {
    fn from_iter<I: IntoIterator<Item = BodyIndex>>(bodies: I) -> Self {
        let mut set = Self::EMPTY;
        bodies.into_iter().for_each(|body| set.insert(body));
        set
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeSet;

    #[test]
    fn the_crowd_is_in_or_out() {
        let [last, first, other] = [510, 511, 9000].map(BodyIndex::new);
        let mut set = BodySet::EMPTY;
        set.insert(other);
        assert!(set.contains(first) && set.contains(other) && !set.contains(last) && set.len() == 1);
        assert!(set.iter().eq([first]) && BodySet::ALL.contains(other));
        set.remove(first);
        assert!(set.is_empty());
    }

    proptest! {
        #[test]
        fn agrees_with_a_tree_set(a in prop::collection::btree_set(0_u16..256, 0..20), b in prop::collection::btree_set(0_u16..256, 0..20)) {
            let set = |s: &BTreeSet<u16>| s.iter().map(|&i| BodyIndex::new(i)).collect::<BodySet>();
            let list = |s: &BodySet| s.iter().map(|i| u16::try_from(i.get()).unwrap()).collect::<Vec<_>>();
            let (x, y) = (set(&a), set(&b));
            prop_assert_eq!(list(&x), a.iter().copied().collect::<Vec<_>>());
            prop_assert_eq!(list(&x.union(&y)), a.union(&b).copied().collect::<Vec<_>>());
            prop_assert_eq!(list(&x.intersection(&y)), a.intersection(&b).copied().collect::<Vec<_>>());
            prop_assert_eq!(list(&x.difference(&y)), a.difference(&b).copied().collect::<Vec<_>>());
            prop_assert!(x.len() == a.len() && x.is_empty() == a.is_empty());
            prop_assert!((0..300).all(|i| x.contains(BodyIndex::new(i)) == a.contains(&i)));
        }
    }
}
