//! Laws of [`Goal`].

use crate::domain::Domain;
use crate::goal::Goal;
use crate::partial::PartialState;
use crate::random::{Purpose, Stream, stream};
use crate::state::{ComponentId, ObjectId, State};

mod extent;

use super::feed::{components, moved, on_face, rng_of, spoilt_states};
use super::watch::{drawing, entering, watched};
use super::{Broken, alike, ensure, equal};

/// Samples lie in the goal set.
pub const SAMPLED: &str =
    "goal.sampled: a state that meets a sample of the goal, in a mode that it accepts, satisfies the goal";
/// Samples fit the domain.
pub const FITS: &str = "goal.fits: samples of the goal have the objects of the domain and lie in its spaces";
/// Pure.
pub const PURE: &str = "goal.pure: the same state and the same generator have the same answer";
/// What is no number.
pub const NAN: &str = "goal.nan: what the goal looks at is not NaN: no such state satisfies it";
/// It says no at times.
pub const DISCERNS: &str = "goal.discerns: a goal is not satisfied by every state";

/// What a sample names counts.
pub const ASKS: &str = "goal.asks: what a sample names matters: not every other place of it satisfies the goal as well";

/// Parts.
pub const PARTS: &str = "goal.parts: a state that satisfies the goal meets at least one part of it, no state meets more parts, and some that do not satisfy it meet fewer";
/// Near.
pub const NEAR: &str = "goal.near: where a goal always samples the same place, a seventh of the way to somewhere else no longer satisfies it";

/// The laws of this file.
pub const LAWS: &[&str] = &[SAMPLED, FITS, PURE, NAN, DISCERNS, ASKS, PARTS, NEAR];

/// How many samples are drawn: a fault in one of a thousand is then seen in the cases of one test.
const DRAWS: u64 = 16;
/// In how many places a component is tried to see whether the goal asks for it.
const PLACES: usize = 8;
/// How many states anywhere must not all satisfy it. A goal that covers 19 of 20 states passes in 96 of 100 checks.
const ANYWHERE: u64 = 64;

/// All laws of a goal, for one seed; `from` lends the components that a sample leaves open, and must be
/// in a mode that the goal accepts.
///
/// # Errors
/// The first law that is [`Broken`].
pub fn check_goal<D: Domain>(m: &D, goal: &dyn Goal<D>, from: &State<D>, seed: u64) -> Result<(), Broken> {
    let about = || format!("check_goal(&{from:?}, {seed})");
    let trial = Trial { m, goal, from };
    watched(&about, || trial.run(seed)).map_err(|broken| broken.replayed_by(about))
}

struct Trial<'a, D: Domain> {
    m: &'a D,
    goal: &'a dyn Goal<D>,
    from: &'a State<D>,
}

impl<D: Domain> Trial<'_, D> {
    fn is_satisfied(&self, state: &State<D>) -> bool {
        entering("is_satisfied");
        self.goal.is_satisfied(self.m, state)
    }

    fn run(&self, seed: u64) -> Result<(), Broken> {
        let draw = |i| {
            let rng = stream(seed, 0, i, Purpose::Sample);
            drawing("sample of the goal", rng, |rng| self.goal.sample(self.m, rng))
        };
        let satisfied = self.is_satisfied(self.from);
        let (mut first, mut is_anything) = (None, false);
        let mut is_same = true;
        for i in 0..DRAWS {
            let sample = draw(i)?;
            if let Some(target) = &sample {
                self.sampled(target, satisfied)?;
                is_anything |= target.components().is_empty();
            }
            if i == 0 {
                first = sample;
            } else {
                is_same &= sample == first;
            }
        }
        alike(PURE, &draw(0)?, &first)?;
        let mut rng = rng_of(&(self.from, seed));
        if let Some(target) = &first {
            self.not_a_number(target, &mut rng)?;
        }
        // A target that names nothing is met by every state, and so is a union with it.
        if !is_anything {
            self.discerns(first.as_ref(), &mut rng)?;
        }
        if let Some(target) = first.as_ref().filter(|_| !satisfied) {
            self.asks(target, &mut rng)?;
            if is_same {
                self.one_place(target, &mut rng)?;
            }
            self.parts(target, &mut rng)?;
        }
        equal(PURE, &self.is_satisfied(self.from), &satisfied)
    }

    fn sampled(&self, target: &PartialState<D>, satisfied: bool) -> Result<(), Broken> {
        target.check(self.m).map_err(|error| Broken::new(FITS, error.to_string(), "a target of the domain"))?;
        let met = target.overlay(self.m, self.from);
        let text = || format!("{met:?} does not satisfy the goal");
        ensure(SAMPLED, self.is_satisfied(&met), text, "satisfied: it meets a sample")?;
        let text = || format!("{:?} does not satisfy it", self.from);
        ensure(SAMPLED, satisfied || !target.is_met(self.m, self.from), text, "satisfied: it meets a sample")
    }

    /// Components that the sample names: all of them NaN, and each number that the goal looks at. It looks at a number if it
    /// makes a difference when it is on a face of the space.
    fn not_a_number(&self, target: &PartialState<D>, rng: &mut Stream) -> Result<(), Broken> {
        let met = target.overlay(self.m, self.from);
        for bad in spoilt_states(self.m, &met) {
            // Infinitely far may well be far enough; contains and validity refuse it.
            let is_asked = target.components().contains(bad.component) && !bad.what.contains("inf");
            if !is_asked || !self.is_satisfied(&bad.state) {
                continue;
            }
            let is_read = match bad.coordinate {
                Some(coordinate) => [false, true]
                    .iter()
                    .any(|is_upper| !self.is_satisfied(&on_face(self.m, &met, bad.component, coordinate, *is_upper))),
                // Another goal of a union may not ask for this component.
                None => (0..PLACES).any(|_| !self.is_satisfied(&moved(self.m, &met, bad.component, rng))),
            };
            ensure(NAN, !is_read, || format!("satisfied by {:?}", bad.state), "not satisfied")
                .map_err(|broken| broken.of(&bad.what).of(self.m.component_name(bad.component)))?;
        }
        Ok(())
    }

    /// One component that the sample names is anywhere, the others are where it wants them. What was satisfied without the
    /// sample asks for something else.
    fn asks(&self, target: &PartialState<D>, rng: &mut Stream) -> Result<(), Broken> {
        let met = target.overlay(self.m, self.from);
        for component in components(self.m, target.components()) {
            let places: Vec<_> = (0..ANYWHERE).map(|_| moved(self.m, &met, component, rng)).collect();
            let differs = places.iter().any(|place| !target.is_met(self.m, place));
            let is_always = differs && places.iter().all(|place| self.is_satisfied(place));
            let text = || format!("satisfied wherever it is, in {ANYWHERE} of {ANYWHERE} places");
            ensure(ASKS, !is_always, text, "not satisfied in some")
                .map_err(|broken| broken.of(self.m.component_name(component)))?;
        }
        Ok(())
    }

    /// Everything is anywhere, from a state that meets the sample on.
    fn discerns(&self, target: Option<&PartialState<D>>, rng: &mut Stream) -> Result<(), Broken> {
        let all = (0..self.m.objects().len())
            .fold(crate::state::ComponentSet::ROBOT, |set, i| set.with(ComponentId::Object(ObjectId::new(i))));
        let start = target.map_or_else(|| self.from.clone(), |target| target.overlay(self.m, self.from));
        let is_always = (0..ANYWHERE).all(|_| {
            let away = components(self.m, all).into_iter().fold(start.clone(), |s, c| moved(self.m, &s, c, rng));
            self.is_satisfied(&away) || away == start
        });
        let moves = components(self.m, all).into_iter().any(|c| moved(self.m, &start, c, rng) != start);
        let text = || format!("satisfied by {ANYWHERE} of {ANYWHERE} states anywhere");
        ensure(DISCERNS, !is_always || !moves, text, "not satisfied by some")
    }
}
