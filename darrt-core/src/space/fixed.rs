//! A component that never moves.

use std::fmt::Debug;

use rand::Rng;

use super::ComponentSpace;

/// The one-point space: an object that takes part in the problem but stays where it is.
#[derive(Debug, Clone, PartialEq)]
pub struct Fixed<C> {
    at: C,
}

impl<C> Fixed<C> {
    /// The space that contains only `at`.
    pub fn new(at: C) -> Self {
        Self { at }
    }
}

impl<C: Clone + PartialEq + Debug + Send + Sync + 'static> ComponentSpace for Fixed<C> {
    type Config = C;

    fn dimension(&self) -> usize {
        0
    }

    fn contains(&self, q: &C) -> bool {
        *q == self.at
    }

    fn distance(&self, _: &C, _: &C) -> f64 {
        0.0
    }

    fn interpolate(&self, a: &C, b: &C, t: f64) -> C {
        if t >= 1.0 { b.clone() } else { a.clone() }
    }

    fn sample(&self, _: &mut dyn Rng) -> C {
        self.at.clone()
    }
}
