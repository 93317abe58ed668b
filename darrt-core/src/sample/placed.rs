//! Objects drawn where they can stand, or close to an edge of what they stand on.
//!
//! Poses on a surface have measure zero among all poses, and those close to its edge, where a plate can be grasped or pushed
//! off, are few among those on it. The space of an object knows both ([`ComponentSpace::sample_at`]).

use rand::{Rng, RngExt};

use super::Sampler;
use crate::domain::Domain;
use crate::error::{Error, in_range};
use crate::goal::Goal;
use crate::partial::PartialState;
use crate::space::{ComponentSpace, Place};
use crate::state::State;

/// Samples of an inner sampler, in which an object is drawn anew at a kind of place with probability `share`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placed<S> {
    inner: S,
    place: Place,
    share: f64,
}

impl<S> Placed<S> {
    /// `share` in `[0, 1]`. Spaces that know no such place keep the inner sample.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a share outside `[0, 1]`.
    pub fn new(inner: S, place: Place, share: f64) -> Result<Self, Error> {
        Ok(Self { inner, place, share: in_range("placed_share", share, 0.0, 1.0, "in [0, 1]")? })
    }
}

impl<D: Domain, S: Sampler<D>> Sampler<D> for Placed<S> {
    fn sample(&self, m: &D, goal: &dyn Goal<D>, rng: &mut dyn Rng) -> PartialState<D> {
        let mut s = self.inner.sample(m, goal, rng);
        let named: Vec<_> = s.objects().map(|(id, _)| id).collect();
        for id in named {
            if rng.random_bool(self.share)
                && let Some(config) = m.objects().get(id.index()).and_then(|space| space.sample_at(self.place, rng))
            {
                s = s.with_object(id, config);
            }
        }
        s
    }

    fn for_one_attempt(&self) -> Option<Box<dyn Sampler<D>>> {
        let inner = self.inner.for_one_attempt()?;
        Some(Box::new(Placed { inner, place: self.place, share: self.share }))
    }

    fn learn_block(&mut self, m: &D, stopped: &State<D>, to: &PartialState<D>) {
        self.inner.learn_block(m, stopped, to);
    }
}
