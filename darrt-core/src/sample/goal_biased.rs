//! Some fixed fraction of samples from the goal set (paper section 4.2, last paragraph).

use rand::{Rng, RngExt};

use super::Sampler;
use crate::domain::Domain;
use crate::error::{Error, in_range};
use crate::goal::Goal;
use crate::partial::PartialState;
use crate::state::State;

/// Samples the goal with probability `bias`, else asks the inner sampler.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GoalBiased<S> {
    inner: S,
    bias: f64,
}

impl<S> GoalBiased<S> {
    /// `bias` in `[0, 1]`; the authors' experiments used 0.2.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a bias outside `[0, 1]`.
    pub fn new(inner: S, bias: f64) -> Result<Self, Error> {
        Ok(Self { inner, bias: in_range("goal_bias", bias, 0.0, 1.0, "in [0, 1]")? })
    }
}

impl<D: Domain, S: Sampler<D>> Sampler<D> for GoalBiased<S> {
    fn sample(&self, m: &D, goal: &dyn Goal<D>, rng: &mut dyn Rng) -> PartialState<D> {
        if rng.random_bool(self.bias)
            && let Some(target) = goal.sample(m, rng)
        {
            return target;
        }
        self.inner.sample(m, goal, rng)
    }

    fn for_one_attempt(&self) -> Option<Box<dyn Sampler<D>>> {
        Some(Box::new(GoalBiased { inner: self.inner.for_one_attempt()?, bias: self.bias }))
    }

    fn learn_block(&mut self, m: &D, stopped: &State<D>, to: &PartialState<D>) {
        self.inner.learn_block(m, stopped, to);
    }
}

impl<D: Domain> Sampler<D> for Box<dyn Sampler<D>> {
    fn sample(&self, m: &D, goal: &dyn Goal<D>, rng: &mut dyn Rng) -> PartialState<D> {
        (**self).sample(m, goal, rng)
    }

    fn for_one_attempt(&self) -> Option<Box<dyn Sampler<D>>> {
        (**self).for_one_attempt()
    }

    fn learn_block(&mut self, m: &D, stopped: &State<D>, to: &PartialState<D>) {
        (**self).learn_block(m, stopped, to);
    }
}
