//! Pairs of bodies that may touch, each with the reason why.

use crate::body_set::BodyIndex;

/// How many pairs fit without heap memory.
const INLINE: usize = 8;

/// Why two bodies may touch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ContactReason {
    /// One stands on the other.
    RestsOn,
    /// One is held by the other.
    Held,
    /// One pushes the other.
    PushContact,
    /// One is closing its fingers around the other, or opening them.
    GraspContact,
    /// They are joined, so their shapes overlap at every posture.
    Adjacent,
    /// Anything else, in a few words.
    Other(&'static str),
}

impl ContactReason {
    /// The reason in words, as written into plan files.
    pub fn name(&self) -> &'static str {
        match self {
            Self::RestsOn => "rests on",
            Self::Held => "held",
            Self::PushContact => "push contact",
            Self::GraspContact => "grasp contact",
            Self::Adjacent => "adjacent",
            Self::Other(words) => words,
        }
    }

    /// The reason whose [`Self::name`] this is; [`Self::Other`] is never returned.
    pub fn from_name(name: &str) -> Option<Self> {
        [Self::RestsOn, Self::Held, Self::PushContact, Self::GraspContact, Self::Adjacent]
            .into_iter()
            .find(|reason| reason.name() == name)
    }
}

impl std::fmt::Display for ContactReason {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

/// An unordered pair of bodies that may touch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct AllowedContact {
    /// The body with the smaller index.
    pub first: BodyIndex,
    /// The body with the larger index.
    pub second: BodyIndex,
    /// Why they may touch.
    pub reason: ContactReason,
}

/// A small set of unordered pairs that may touch; up to eight of them need no heap memory.
///
/// # Laws
/// `contains(a, b) == contains(b, a)`; after `allow(a, b, _)` both hold; a pair is in the set at most once.
#[derive(Debug, Clone, Default)]
pub struct AllowedContacts {
    /// Filled from the front.
    inline: [Option<AllowedContact>; INLINE],
    /// Only used when `inline` is full.
    more: Vec<AllowedContact>,
}

impl AllowedContacts {
    /// No pair at all.
    pub fn none() -> Self {
        Self::default()
    }

    /// Adds a pair; when it is already there, the first reason stays. A body with itself is not a pair and is ignored.
    pub fn allow(&mut self, a: BodyIndex, b: BodyIndex, reason: ContactReason) {
        if a == b || self.contains(a, b) {
            return;
        }
        let entry = AllowedContact { first: a.min(b), second: a.max(b), reason };
        match self.inline.iter_mut().find(|slot| slot.is_none()) {
            Some(slot) => *slot = Some(entry),
            None => self.more.push(entry),
        }
    }

    /// This set with one more pair.
    #[must_use]
    pub fn with(mut self, a: BodyIndex, b: BodyIndex, reason: ContactReason) -> Self {
        self.allow(a, b, reason);
        self
    }

    /// Adds every pair of another set.
    pub fn extend_from(&mut self, other: &Self) {
        for entry in other.iter() {
            self.allow(entry.first, entry.second, entry.reason);
        }
    }

    /// Whether the two may touch (order does not matter).
    pub fn contains(&self, a: BodyIndex, b: BodyIndex) -> bool {
        self.reason(a, b).is_some()
    }

    /// Why the two may touch.
    pub fn reason(&self, a: BodyIndex, b: BodyIndex) -> Option<ContactReason> {
        let (first, second) = (a.min(b), a.max(b));
        self.iter().find(|entry| entry.first == first && entry.second == second).map(|entry| entry.reason)
    }

    /// The pairs in the order they were added.
    pub fn iter(&self) -> impl Iterator<Item = &AllowedContact> + '_ {
        self.inline.iter().map_while(Option::as_ref).chain(&self.more)
    }

    /// Number of pairs.
    pub fn len(&self) -> usize {
        self.iter().count()
    }

    /// Whether no pair may touch.
    pub fn is_empty(&self) -> bool {
        self.inline.first().is_none_or(Option::is_none)
    }
}

/// Equal when they hold the same pairs with the same reasons, in whatever order.
impl PartialEq for AllowedContacts {
    fn eq(&self, other: &Self) -> bool {
        self.len() == other.len()
            && self.iter().all(|entry| other.reason(entry.first, entry.second) == Some(entry.reason))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_are_unordered_and_single() {
        let (a, b, c) = (BodyIndex::new(0), BodyIndex::new(1), BodyIndex::new(2));
        let set = AllowedContacts::none().with(b, a, ContactReason::RestsOn).with(a, b, ContactReason::Held).with(
            c,
            c,
            ContactReason::Held,
        );
        assert!(set.contains(a, b) && set.contains(b, a) && !set.contains(a, c) && !set.contains(c, c));
        assert_eq!((set.len(), set.reason(a, b)), (1, Some(ContactReason::RestsOn)));
    }

    #[test]
    fn many_pairs_spill_over_and_equality_ignores_order() {
        let index = BodyIndex::new;
        let pairs: Vec<_> = (0..6).flat_map(|i| (i + 1..6).map(move |j| (index(i), index(j)))).collect();
        let mut forward = AllowedContacts::none();
        let mut backward = AllowedContacts::none();
        for &(a, b) in &pairs {
            forward.allow(a, b, ContactReason::Adjacent);
        }
        for &(a, b) in pairs.iter().rev() {
            backward.allow(b, a, ContactReason::Adjacent);
        }
        assert!(forward.len() == 15 && pairs.iter().all(|&(a, b)| forward.contains(b, a)));
        assert_eq!(forward, backward);
        let mut joined = AllowedContacts::none();
        assert!(joined.is_empty() && joined != forward);
        joined.extend_from(&forward);
        assert!(joined == forward && !joined.is_empty());
    }

    #[test]
    fn reasons_have_names_that_lead_back() {
        for reason in [ContactReason::RestsOn, ContactReason::Held, ContactReason::PushContact, ContactReason::Adjacent]
        {
            assert_eq!(ContactReason::from_name(&reason.to_string()), Some(reason));
        }
        assert_eq!(ContactReason::from_name("because"), None);
        assert_eq!(ContactReason::Other("because").name(), "because");
    }
}
