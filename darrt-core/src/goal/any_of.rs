//! The union of several goals.

use std::fmt;

use rand::{Rng, RngExt};

use super::Goal;
use crate::domain::Domain;
use crate::partial::PartialState;
use crate::state::State;

/// Satisfied when any of its goals is; samples one of them at random.
pub struct AnyOf<D: Domain> {
    goals: Vec<Box<dyn Goal<D>>>,
}

impl<D: Domain> AnyOf<D> {
    /// The union of `goals`; an empty list is never satisfied and never sampled.
    pub fn new(goals: Vec<Box<dyn Goal<D>>>) -> Self {
        Self { goals }
    }
}

impl<D: Domain> Goal<D> for AnyOf<D> {
    fn is_satisfied(&self, m: &D, state: &State<D>) -> bool {
        self.goals.iter().any(|g| g.is_satisfied(m, state))
    }

    fn sample(&self, m: &D, rng: &mut dyn Rng) -> Option<PartialState<D>> {
        if self.goals.is_empty() {
            return None;
        }
        let index = rng.random_range(0..self.goals.len());
        self.goals.get(index)?.sample(m, rng)
    }
}

impl<D: Domain> fmt::Debug for AnyOf<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "AnyOf({} goals)", self.goals.len())
    }
}
