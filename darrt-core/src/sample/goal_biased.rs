//! Some fixed fraction of samples from the goal set (paper section 4.2, last paragraph).
//!
//! A goal for several objects may also be sampled in part. Where all are named, the nearest node is one at which most objects
//! are in place, and if one of those blocks the way of another, no extension from there leads on. A sample that names only
//! the other begins as well where nothing is in its way yet.

use rand::{Rng, RngExt};
use smallvec::SmallVec;

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
    part_share: f64,
}

impl<S> GoalBiased<S> {
    /// `bias` in `[0, 1]`; the authors' experiments used 0.2.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a bias outside `[0, 1]`.
    pub fn new(inner: S, bias: f64) -> Result<Self, Error> {
        Ok(Self { inner, bias: in_range("goal_bias", bias, 0.0, 1.0, "in [0, 1]")?, part_share: 0.0 })
    }

    /// With this share of those samples from the goal that name several objects cut down to some of the objects. Goals for
    /// one object are sampled as before, with the same random numbers.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a share outside `[0, 1]`.
    pub fn in_part(self, share: f64) -> Result<Self, Error> {
        Ok(Self { part_share: in_range("goal_part_share", share, 0.0, 1.0, "in [0, 1]")?, ..self })
    }

    /// `target`, or a random part of it.
    fn part_of<D: Domain>(&self, m: &D, target: PartialState<D>, rng: &mut dyn Rng) -> PartialState<D> {
        let count = target.objects().count();
        if self.part_share <= 0.0 || count < 2 || !rng.random_bool(self.part_share) {
            return target;
        }
        loop {
            let chosen: SmallVec<[_; 8]> = target.objects().filter(|_| rng.random_bool(0.5)).collect();
            if !chosen.is_empty() && chosen.len() < count {
                let nothing = PartialState::anywhere(m);
                return chosen.into_iter().fold(nothing, |part, (id, config)| part.with_object(id, config.clone()));
            }
        }
    }
}

impl<D: Domain, S: Sampler<D>> Sampler<D> for GoalBiased<S> {
    fn sample(&self, m: &D, goal: &dyn Goal<D>, rng: &mut dyn Rng) -> PartialState<D> {
        if rng.random_bool(self.bias)
            && let Some(target) = goal.sample(m, rng)
        {
            return self.part_of(m, target, rng);
        }
        self.inner.sample(m, goal, rng)
    }

    fn for_one_attempt(&self) -> Option<Box<dyn Sampler<D>>> {
        let inner = self.inner.for_one_attempt()?;
        Some(Box::new(GoalBiased { inner, bias: self.bias, part_share: self.part_share }))
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::goal::Reach;
    use crate::random::{Purpose, stream};
    use crate::sample::Full;
    use crate::state::ObjectId;
    use crate::testing::puck::problems::two_pucks;
    use crate::testing::puck::world::PuckWorld;

    #[test]
    fn parts_name_some_of_the_objects_where_the_goal_wants_them() {
        let problem = two_pucks().unwrap();
        let m = problem.domain();
        let places = [[0.5, 0.75], [1.5, 1.25]];
        let goal_for = |count: usize| {
            let named = places.iter().take(count).enumerate();
            named.fold(PartialState::<PuckWorld>::anywhere(m), |target, (i, at)| {
                target.with_object(ObjectId::new(i), *at)
            })
        };
        let draw = |goal: &Reach<PuckWorld>, share: f64, seed: u64| {
            let sampler = GoalBiased::new(Full, 1.0).unwrap().in_part(share).unwrap();
            sampler.sample(m, goal, &mut stream(seed, 0, 0, Purpose::Sample))
        };
        let (one, two) = (Reach::new(goal_for(1)), Reach::new(goal_for(2)));
        let mut counts = [0; 3];
        for seed in 0..100 {
            assert_eq!(draw(&one, 1.0, seed), goal_for(1), "one object has no parts");
            assert_eq!(draw(&two, 0.0, seed), goal_for(2));
            assert_eq!(draw(&two, 1.0, seed).objects().count(), 1);
            let part = draw(&two, 0.5, seed);
            assert!(part.objects().all(|(id, at)| goal_for(2).object(id) == Some(at)) && part.robot().is_none());
            counts[part.objects().count()] += 1;
        }
        assert!(counts[0] == 0 && counts[1] > 20 && counts[2] > 20, "{counts:?}");
        assert!(GoalBiased::new(Full, 0.2).unwrap().in_part(f64::NAN).is_err());
    }
}
