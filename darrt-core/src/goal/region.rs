//! A goal set given by a test and a generator: regions, tolerances, anything infinite.

use std::fmt;

use rand::Rng;

use super::Goal;
use crate::domain::Domain;
use crate::partial::PartialState;
use crate::state::State;

type Test<D> = Box<dyn Fn(&D, &State<D>) -> bool + Send + Sync>;
type Draw<D> = Box<dyn Fn(&D, &mut dyn Rng) -> Option<PartialState<D>> + Send + Sync>;

/// An infinite goal set. The caller vouches that what `draw` gives passes `test` once it is met.
pub struct Region<D: Domain> {
    test: Test<D>,
    draw: Draw<D>,
}

impl<D: Domain> Region<D> {
    /// The set of states that pass `test`, sampled by `draw`.
    pub fn new(test: Test<D>, draw: Draw<D>) -> Self {
        Self { test, draw }
    }
}

impl<D: Domain> Goal<D> for Region<D> {
    fn is_satisfied(&self, m: &D, state: &State<D>) -> bool {
        (self.test)(m, state)
    }

    fn sample(&self, m: &D, rng: &mut dyn Rng) -> Option<PartialState<D>> {
        (self.draw)(m, rng)
    }
}

impl<D: Domain> fmt::Debug for Region<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Region")
    }
}
