//! A uniformly random non-empty subset of the components: SAMPLE of Algorithm 1.

use rand::{Rng, RngExt};

use super::{Sampler, movable, with_random_object, with_random_robot};
use crate::domain::Domain;
use crate::goal::Goal;
use crate::partial::PartialState;

/// Names each component with probability one half; never none.
#[derive(Debug, Clone, Copy, Default)]
pub struct RandomSubset;

impl<D: Domain> Sampler<D> for RandomSubset {
    fn sample(&self, m: &D, _: &dyn Goal<D>, rng: &mut dyn Rng) -> PartialState<D> {
        let objects = movable(m);
        // All 2^(n+1) - 1 non-empty subsets equally likely, by rejection of the empty one.
        loop {
            let robot = rng.random_bool(0.5);
            let chosen: Vec<_> = objects.iter().copied().filter(|_| rng.random_bool(0.5)).collect();
            if !robot && chosen.is_empty() {
                continue;
            }
            let s = PartialState::anywhere(m);
            let s = if robot { with_random_robot(m, s, rng) } else { s };
            return chosen.into_iter().fold(s, |s, id| with_random_object(m, s, id, rng));
        }
    }
}
