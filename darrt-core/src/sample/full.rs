//! Every component at once: the classic RRT sample, which figure 3a of the paper shows to fail.

use rand::Rng;

use super::{Sampler, movable, with_random_object, with_random_robot};
use crate::domain::Domain;
use crate::goal::Goal;
use crate::partial::PartialState;

/// Samples the robot and all objects together.
#[derive(Debug, Clone, Copy, Default)]
pub struct Full;

impl<D: Domain> Sampler<D> for Full {
    fn sample(&self, m: &D, _: &dyn Goal<D>, rng: &mut dyn Rng) -> PartialState<D> {
        let s = with_random_robot(m, PartialState::anywhere(m), rng);
        movable(m).into_iter().fold(s, |s, id| with_random_object(m, s, id, rng))
    }
}
