//! Samples near the places where extensions were blocked.
//!
//! What blocks an extension is often passed a little aside (paper section 6.2: most of the time goes into getting the hand
//! around the plate). Every blocked extension leaves the place where it stopped and what its target named; a sample takes one
//! of them and asks for the same components a little away from there.

use std::fmt;
use std::sync::Arc;

use rand::{Rng, RngExt};

use crate::domain::Domain;
use crate::error::{Error, in_range};
use crate::goal::Goal;
use crate::partial::PartialState;
use crate::sample::Sampler;
use crate::space::ComponentSpace;
use crate::state::State;

/// How many places are remembered; the oldest is forgotten first.
const PLACES: usize = 64;

/// With probability `share` near a place where an extension of this attempt was blocked, else as the inner sampler.
pub struct Frontier<D: Domain> {
    inner: Arc<dyn Sampler<D>>,
    share: f64,
    radius: f64,
    /// What each blocked extension was about, with the values at which it stopped.
    places: Vec<PartialState<D>>,
    /// The place to be forgotten next.
    oldest: usize,
}

impl<D: Domain> Frontier<D> {
    /// `share` in `[0, 1]`; `radius` in `(0, 1]`: the largest part of the way from the blocked place to a random configuration
    /// that a sample lies away from it.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a number outside its range.
    pub fn new(inner: impl Sampler<D> + 'static, share: f64, radius: f64) -> Result<Self, Error> {
        Ok(Self {
            inner: Arc::new(inner),
            share: in_range("frontier_share", share, 0.0, 1.0, "in [0, 1]")?,
            radius: in_range("frontier_radius", radius, f64::MIN_POSITIVE, 1.0, "in (0, 1]")?,
            places: Vec::new(),
            oldest: 0,
        })
    }

    fn near(&self, m: &D, place: &PartialState<D>, rng: &mut dyn Rng) -> PartialState<D> {
        let mut s = PartialState::anywhere(m);
        let a_little = |rng: &mut dyn Rng| self.radius * rng.random_range(0.0..=1.0);
        if let Some(robot) = place.robot() {
            let away = m.robot().sample(rng);
            let config = m.robot().interpolate(&robot.config, &away, a_little(rng));
            s = s.with_robot_groups(config, robot.groups);
        }
        for (id, at) in place.objects() {
            let Some(space) = m.objects().get(id.index()) else { continue };
            let away = space.sample(rng);
            s = s.with_object(id, space.interpolate(at, &away, a_little(rng)));
        }
        s
    }
}

impl<D: Domain> Sampler<D> for Frontier<D> {
    fn sample(&self, m: &D, goal: &dyn Goal<D>, rng: &mut dyn Rng) -> PartialState<D> {
        let is_asked = rng.random_bool(self.share);
        if is_asked && !self.places.is_empty() {
            let pick = rng.random_range(0..self.places.len());
            if let Some(place) = self.places.get(pick) {
                return self.near(m, place, rng);
            }
        }
        self.inner.sample(m, goal, rng)
    }

    fn for_one_attempt(&self) -> Option<Box<dyn Sampler<D>>> {
        let inner = Arc::clone(&self.inner);
        Some(Box::new(Self { inner, share: self.share, radius: self.radius, places: Vec::new(), oldest: 0 }))
    }

    fn learn_block(&mut self, m: &D, stopped: &State<D>, to: &PartialState<D>) {
        let mut place = PartialState::anywhere(m);
        // A held object may be outside the space that objects are drawn from.
        if let Some(target) = to.robot().filter(|_| m.robot().contains(&stopped.robot)) {
            place = place.with_robot_groups(stopped.robot.clone(), target.groups);
        }
        for (id, _) in to.objects() {
            let (Some(at), Some(space)) = (stopped.object(id), m.objects().get(id.index())) else { continue };
            if space.contains(at) {
                place = place.with_object(id, at.clone());
            }
        }
        if place.components().is_empty() {
            return;
        }
        if self.places.len() < PLACES {
            self.places.push(place);
        } else if let Some(slot) = self.places.get_mut(self.oldest) {
            *slot = place;
            self.oldest = (self.oldest + 1) % PLACES;
        }
    }
}

// Not derived: that would ask the domain to be printable.
impl<D: Domain> fmt::Debug for Frontier<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Frontier").field("share", &self.share).field("radius", &self.radius).finish_non_exhaustive()
    }
}

#[cfg(all(test, feature = "testing"))]
mod tests {
    use super::*;
    use crate::goal::Region;
    use crate::random::{Purpose, stream};
    use crate::sample::Full;
    use crate::state::ObjectId;
    use crate::testing::broken::bench::{Bench, cart_at, state};

    #[test]
    fn samples_lie_near_what_was_blocked_and_name_the_same() {
        let (m, goal) = (Bench::default(), Region::<Bench>::new(Box::new(|_, _| false), Box::new(|_, _| None)));
        let mut frontier = Frontier::new(Full, 1.0, 0.1).unwrap();
        let draw = |frontier: &Frontier<Bench>, i| frontier.sample(&m, &goal, &mut stream(i, 0, 0, Purpose::Sample));
        assert!(draw(&frontier, 1).robot().is_some(), "nothing learnt yet: as the inner sampler");
        // Cart 0 stopped at 2 m on its way to 3.5 m.
        for _ in 0..2 * PLACES {
            frontier.learn_block(&m, &state([0.5, 0.0]), &cart_at([3.5, 0.0]));
        }
        assert_eq!(frontier.places.len(), PLACES);
        for i in 0..100 {
            let s = draw(&frontier, i);
            let at = s.object(ObjectId::new(0)).unwrap();
            assert!(s.robot().is_none() && (at[0] - 2.0).abs() <= 0.2 + 1e-12, "{s:?}");
        }
        assert!(draw(&frontier, 1) != draw(&frontier, 2));
        let fresh = frontier.for_one_attempt().unwrap();
        assert!(fresh.sample(&m, &goal, &mut stream(1, 0, 0, Purpose::Sample)).robot().is_some());
    }

    #[test]
    fn what_lies_outside_its_space_is_not_remembered() {
        let m = Bench::default();
        let mut frontier = Frontier::new(Full, 1.0, 0.1).unwrap();
        let outside = State { objects: [[9.0, 0.0], [3.0, 0.5]].into_iter().collect(), ..state([0.5, 0.0]) };
        frontier.learn_block(&m, &outside, &cart_at([3.5, 0.0]));
        assert!(frontier.places.is_empty());
    }
}
