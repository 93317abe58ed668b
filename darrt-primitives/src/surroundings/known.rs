//! The states last found clear: a primitive asks about a stance, the planner asks again when it has been propagated, and once
//! more where the motions on both sides of it are judged.

use darrt_geom::allowed::AllowedContacts;
use nalgebra::Isometry3;

/// How many are kept.
const KEPT: usize = 8;

/// A state in which nothing is too near to anything else.
#[derive(Debug)]
struct Clear {
    /// Links and then objects.
    poses: Vec<Isometry3<f64>>,
    allowed: AllowedContacts,
    clearance_m: f64,
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
    /// Is it known that with these poses nothing but what is allowed is nearer than the clearance?
    pub(super) fn is_clear(&self, poses: &[Isometry3<f64>], allowed: &AllowedContacts, clearance_m: f64) -> bool {
        self.states
            .iter()
            .any(|state| state.clearance_m >= clearance_m && state.poses == *poses && state.allowed == *allowed)
    }

    /// Takes note of a state that is clear.
    pub(super) fn note(&mut self, poses: &[Isometry3<f64>], allowed: &AllowedContacts, clearance_m: f64) {
        let Some(slot) = self.states.get_mut(self.oldest) else {
            self.states.push(Clear { poses: poses.to_vec(), allowed: allowed.clone(), clearance_m });
            self.oldest = self.states.len() % KEPT;
            return;
        };
        slot.poses.clear();
        slot.poses.extend_from_slice(poses);
        slot.allowed.clone_from(allowed);
        slot.clearance_m = clearance_m;
        self.oldest = (self.oldest + 1) % KEPT;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use darrt_geom::allowed::ContactReason;
    use darrt_geom::body_set::BodyIndex;

    fn poses(x: f64) -> [Isometry3<f64>; 2] {
        [Isometry3::identity(), Isometry3::translation(x, 0.0, 0.0)]
    }

    #[test]
    fn what_was_noted_is_known_until_enough_others_are() {
        let (mut known, none) = (Known::default(), AllowedContacts::none());
        for i in 0..3 * KEPT {
            assert!(!known.is_clear(&poses(i as f64), &none, 0.01));
            known.note(&poses(i as f64), &none, 0.01);
            assert!(known.is_clear(&poses(i as f64), &none, 0.01));
            assert_eq!(i >= KEPT - 1, known.states.len() == KEPT);
            let oldest = i.saturating_sub(KEPT - 1);
            assert!((oldest..i).all(|j| known.is_clear(&poses(j as f64), &none, 0.01)));
            assert!((0..oldest).all(|j| !known.is_clear(&poses(j as f64), &none, 0.01)));
        }
    }

    #[test]
    fn neither_a_wider_clearance_nor_other_contacts_are_known() {
        let (mut known, none) = (Known::default(), AllowedContacts::none());
        known.note(&poses(1.0), &none, 0.01);
        assert!(known.is_clear(&poses(1.0), &none, 0.005));
        assert!(!known.is_clear(&poses(1.0), &none, 0.011));
        let mut touching = AllowedContacts::none();
        touching.allow(BodyIndex::new(0), BodyIndex::new(1), ContactReason::Held);
        assert!(!known.is_clear(&poses(1.0), &touching, 0.01));
    }
}
