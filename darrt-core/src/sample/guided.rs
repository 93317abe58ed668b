//! Targets that somebody proposes.

use rand::{Rng, RngExt};

use super::Sampler;
use crate::domain::Domain;
use crate::error::{Error, in_range};
use crate::goal::Goal;
use crate::partial::PartialState;
use crate::state::State;

/// Takes one of some proposed targets with a fixed probability, else asks the inner sampler: places of an earlier plan, for one.
pub struct Guided<D: Domain, S> {
    inner: S,
    targets: Vec<PartialState<D>>,
    share: f64,
}

// Not derived: a sampler is not printable.
impl<D: Domain, S> std::fmt::Debug for Guided<D, S> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Guided")
            .field("targets", &self.targets.len())
            .field("share", &self.share)
            .finish_non_exhaustive()
    }
}

impl<D: Domain, S> Guided<D, S> {
    /// With `share` in `[0, 1]`. Without targets the samples are those of `inner`, from the same random numbers.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a share outside `[0, 1]`.
    pub fn new(inner: S, targets: Vec<PartialState<D>>, share: f64) -> Result<Self, Error> {
        Ok(Self { inner, targets, share: in_range("guided_share", share, 0.0, 1.0, "in [0, 1]")? })
    }
}

impl<D: Domain, S: Sampler<D>> Sampler<D> for Guided<D, S> {
    fn sample(&self, m: &D, goal: &dyn Goal<D>, rng: &mut dyn Rng) -> PartialState<D> {
        if !self.targets.is_empty()
            && rng.random_bool(self.share)
            && let Some(target) = self.targets.get(rng.random_range(0..self.targets.len()))
        {
            return target.clone();
        }
        self.inner.sample(m, goal, rng)
    }

    fn for_one_attempt(&self) -> Option<Box<dyn Sampler<D>>> {
        let inner = self.inner.for_one_attempt()?;
        Some(Box::new(Guided { inner, targets: self.targets.clone(), share: self.share }))
    }

    fn learn_block(&mut self, m: &D, stopped: &State<D>, to: &PartialState<D>) {
        self.inner.learn_block(m, stopped, to);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Purpose, stream};
    use crate::sample::Full;
    use crate::state::ObjectId;
    use crate::testing::puck::problems::two_pucks;

    #[test]
    fn proposed_targets_come_as_often_as_asked_and_none_change_nothing() {
        let problem = two_pucks().unwrap();
        let m = problem.domain();
        let proposed = PartialState::anywhere(m).with_object(ObjectId::new(0), [0.5, 0.75]);
        let drawn = |targets: Vec<_>, share: f64, seed: u64| {
            let sampler = Guided::new(Full, targets, share).unwrap();
            sampler.sample(m, problem.goal(), &mut stream(seed, 0, 0, Purpose::Sample))
        };
        let plain = |seed: u64| Full.sample(m, problem.goal(), &mut stream(seed, 0, 0, Purpose::Sample));
        assert!((0..20).all(|seed| drawn(Vec::new(), 0.5, seed) == plain(seed)));
        let count = (0..200).filter(|seed| drawn(vec![proposed.clone()], 0.5, *seed) == proposed).count();
        assert!((70..130).contains(&count), "{count}");
        assert!(Guided::new(Full, vec![proposed], 1.5).is_err());
    }
}
