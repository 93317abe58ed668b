//! The states last found clear: a primitive asks about a stance, the planner asks again when it has been propagated, and once
//! more where the motions on both sides of it are judged.

use darrt_geom::allowed::AllowedContacts;
use nalgebra::Isometry3;

use super::margins::Terms;

/// How many are kept.
const KEPT: usize = 8;

/// A state in which nothing is too near to anything else.
#[derive(Debug)]
struct Clear {
    /// Links and then objects.
    poses: Vec<Isometry3<f64>>,
    allowed: AllowedContacts,
    terms: Terms,
}

/// The states last found clear. What is found in here would be found again: it saves time and changes no answer.
#[derive(Debug, Default)]
pub(super) struct Known {
    states: Vec<Clear>,
    oldest: usize,
    /// Where the base last stood clear of the fixed bodies.
    pub(super) base: Option<[f64; 3]>,
}

impl Known {
    /// Is it known that with these poses nothing but what is allowed is nearer than these terms say?
    pub(super) fn is_clear(&self, poses: &[Isometry3<f64>], allowed: &AllowedContacts, terms: &Terms) -> bool {
        self.states.iter().any(|state| state.terms.imply(terms) && state.poses == *poses && state.allowed == *allowed)
    }

    /// Takes note of a state that is clear.
    pub(super) fn note(&mut self, poses: &[Isometry3<f64>], allowed: &AllowedContacts, terms: &Terms) {
        let Some(slot) = self.states.get_mut(self.oldest) else {
            self.states.push(Clear { poses: poses.to_vec(), allowed: allowed.clone(), terms: *terms });
            self.oldest = self.states.len() % KEPT;
            return;
        };
        slot.poses.clear();
        slot.poses.extend_from_slice(poses);
        slot.allowed.clone_from(allowed);
        slot.terms = *terms;
        self.oldest = (self.oldest + 1) % KEPT;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::collision_scene::Strict;
    use darrt_geom::allowed::ContactReason;
    use darrt_geom::body_set::BodyIndex;

    fn poses(x: f64) -> [Isometry3<f64>; 2] {
        [Isometry3::identity(), Isometry3::translation(x, 0.0, 0.0)]
    }

    #[test]
    fn what_was_noted_is_known_until_enough_others_are() {
        let (mut known, none, terms) = (Known::default(), AllowedContacts::none(), Terms::default());
        for i in 0..3 * KEPT {
            assert!(!known.is_clear(&poses(i as f64), &none, &terms));
            known.note(&poses(i as f64), &none, &terms);
            assert!(known.is_clear(&poses(i as f64), &none, &terms));
            assert_eq!(i >= KEPT - 1, known.states.len() == KEPT);
            let oldest = i.saturating_sub(KEPT - 1);
            assert!((oldest..i).all(|j| known.is_clear(&poses(j as f64), &none, &terms)));
            assert!((0..oldest).all(|j| !known.is_clear(&poses(j as f64), &none, &terms)));
        }
    }

    #[test]
    fn neither_more_care_nor_other_contacts_are_known() {
        let (mut known, none) = (Known::default(), AllowedContacts::none());
        let terms = |care, is_between| Terms { strict: Strict { care, is_between }, ..Terms::default() };
        known.note(&poses(1.0), &none, &terms(1, false));
        for (care, is_between, is_known) in [(0, false, true), (1, true, true), (0, true, true), (2, true, false)] {
            assert_eq!(known.is_clear(&poses(1.0), &none, &terms(care, is_between)), is_known, "{care} {is_between}");
        }
        let mut touching = AllowedContacts::none();
        touching.allow(BodyIndex::new(0), BodyIndex::new(1), ContactReason::Held);
        assert!(!known.is_clear(&poses(1.0), &touching, &terms(0, false)));
        known.note(&poses(2.0), &none, &terms(0, true));
        assert!(
            known.is_clear(&poses(2.0), &none, &terms(0, true))
                && !known.is_clear(&poses(2.0), &none, &terms(0, false))
        );
    }
}
