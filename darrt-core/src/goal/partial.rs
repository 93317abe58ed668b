//! The named components at given configurations, everything else anywhere.

use std::fmt;

use rand::Rng;

use super::Goal;
use crate::domain::Domain;
use crate::partial::PartialState;
use crate::state::State;

/// A test on the mode, for example "released".
pub type ModeTest<D> = Box<dyn Fn(&<D as Domain>::Mode) -> bool + Send + Sync>;

/// A partially specified configuration as goal, optionally with a condition on the mode.
pub struct Reach<D: Domain> {
    target: PartialState<D>,
    mode: Option<ModeTest<D>>,
}

impl<D: Domain> Reach<D> {
    /// Every state that meets `target`.
    pub fn new(target: PartialState<D>) -> Self {
        Self { target, mode: None }
    }

    /// Only those of them whose mode passes `test`.
    #[must_use]
    pub fn in_mode(mut self, test: ModeTest<D>) -> Self {
        self.mode = Some(test);
        self
    }
}

impl<D: Domain> Goal<D> for Reach<D> {
    fn is_satisfied(&self, m: &D, state: &State<D>) -> bool {
        self.mode.as_ref().is_none_or(|test| test(&state.mode)) && self.target.is_met(m, state)
    }

    fn sample(&self, _: &D, _: &mut dyn Rng) -> Option<PartialState<D>> {
        Some(self.target.clone())
    }
}

impl<D: Domain> fmt::Debug for Reach<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Reach").field("target", &self.target).finish_non_exhaustive()
    }
}
