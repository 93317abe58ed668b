//! What checks feed: seeds made of their own inputs, configurations that are no numbers, faces and corners.

use std::fmt::{Debug, Write};

use rand::{Rng, RngExt};

use crate::domain::Domain;
use crate::random::{Purpose, Stream, stream};
use crate::space::ComponentSpace;
use crate::state::{ComponentId, ComponentSet, ObjectId, State};

/// Coordinates beyond this many are not spoilt one by one.
const MOST_COORDINATES: usize = 24;

/// Faces nearer than this are not gone to: a quaternion may be bent by this much before its norm leaves its tolerance.
const FORGIVEN: f64 = 0.01;

/// A seed made of what is printed: the same inputs are looked at in the same places, other inputs in others.
pub(super) fn seed_of(inputs: &dyn Debug) -> u64 {
    struct Fnv(u64);
    impl Write for Fnv {
        fn write_str(&mut self, text: &str) -> std::fmt::Result {
            text.bytes().for_each(|byte| self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3));
            Ok(())
        }
    }
    let mut hash = Fnv(0xcbf2_9ce4_8422_2325);
    // Writing to a hash cannot fail.
    let _ = write!(hash, "{inputs:?}");
    hash.0
}

/// A generator made of what is printed.
pub(super) fn rng_of(inputs: &dyn Debug) -> Stream {
    stream(seed_of(inputs), 0, 0, Purpose::Attempt)
}

/// Is everything in it a finite number, as far as one can tell from outside?
pub(super) fn is_number<T: PartialEq + Debug>(value: &T) -> bool {
    // Not equal to itself: NaN.
    #[allow(clippy::eq_op, reason = "only NaN differs from itself")]
    let is_itself = value == value;
    is_itself && {
        let text = format!("{value:?}");
        !text.contains("NaN") && !text.split(|c: char| !c.is_alphanumeric()).any(|word| word == "inf")
    }
}

/// How many numbers a configuration has.
pub(super) fn count<S: ComponentSpace>(space: &S, q: &S::Config) -> usize {
    let mut count = 0;
    space.numbers(&mut q.clone(), &mut |_| count += 1);
    count
}

/// The numbers of a configuration.
pub(super) fn values<S: ComponentSpace>(space: &S, q: &S::Config) -> Vec<f64> {
    let mut all = Vec::new();
    space.numbers(&mut q.clone(), &mut |x| all.push(*x));
    all
}

/// `q` with its number `index` at `value`.
pub(super) fn with<S: ComponentSpace>(space: &S, q: &S::Config, index: usize, value: f64) -> S::Config {
    let (mut q, mut i) = (q.clone(), 0);
    space.numbers(&mut q, &mut |x| {
        if i == index {
            *x = value;
        }
        i += 1;
    });
    q
}

/// A configuration that is none.
pub(super) struct Spoilt<C> {
    /// What is wrong with it.
    pub(super) what: String,
    /// The one number that is wrong; `None` if several are.
    pub(super) coordinate: Option<usize>,
    pub(super) config: C,
}

/// `q` with one of its numbers after the other NaN or infinite, with all of them NaN, and what interpolation makes of NaN.
pub(super) fn spoilt<S: ComponentSpace>(space: &S, q: &S::Config, other: &S::Config) -> Vec<Spoilt<S::Config>> {
    let mut all = Vec::new();
    let count = count(space, q);
    for i in 0..count.min(MOST_COORDINATES) {
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let what = format!("coordinate {i} is {value:?}");
            all.push(Spoilt { what, coordinate: Some(i), config: with(space, q, i, value) });
        }
    }
    if count > 0 {
        let mut none = q.clone();
        space.numbers(&mut none, &mut |x| *x = f64::NAN);
        all.push(Spoilt { what: "every coordinate is NaN".to_owned(), coordinate: None, config: none });
    } else {
        // A type that shows no numbers: most interpolations make NaN of NaN.
        let strange = space.interpolate(q, other, f64::NAN);
        if !is_number(&strange) {
            all.push(Spoilt { what: "interpolated at NaN".to_owned(), coordinate: None, config: strange });
        }
    }
    all
}

/// The configuration on the face of the space that is met from `q` along one coordinate; `q` itself where there is none.
pub(super) fn face<S: ComponentSpace>(space: &S, q: &S::Config, index: usize, is_upper: bool) -> S::Config {
    let Some(start) = values(space, q).get(index).copied().filter(|x| x.is_finite()) else { return q.clone() };
    let at = |step: f64| with(space, q, index, if is_upper { start + step } else { start - step });
    let (mut inside, mut step) = (0.0, 1e-3);
    while space.contains(&at(step)) {
        inside = step;
        step *= 4.0;
        if step > 1e9 {
            // Unbounded: no face.
            return q.clone();
        }
    }
    let mut outside = step;
    for _ in 0..64 {
        let middle = 0.5 * (inside + outside);
        if middle <= inside || middle >= outside {
            break;
        }
        *(if space.contains(&at(middle)) { &mut inside } else { &mut outside }) = middle;
    }
    at(inside)
}

/// A configuration in a corner of the space, or on a face, near nothing in particular: from `q` to a random side along
/// every coordinate, or along only one.
pub(super) fn corner<S: ComponentSpace>(space: &S, q: &S::Config, rng: &mut dyn Rng) -> S::Config {
    let count = count(space, q).min(MOST_COORDINATES);
    if count == 0 {
        return q.clone();
    }
    let only = rng.random_bool(0.3).then(|| rng.random_range(0..count));
    let mut at = q.clone();
    for i in (0..count).filter(|i| only.is_none_or(|only| only == *i)) {
        let there = face(space, &at, i, rng.random_bool(0.5));
        // Less than this is no face, but the rounding that `contains` forgives in a quaternion.
        let far = |(x, y): (f64, f64)| (x - y).abs() > FORGIVEN;
        if values(space, &there).into_iter().zip(values(space, &at)).any(far) {
            at = there;
        }
    }
    at
}

/// `state` with every component in a corner of its space.
pub(super) fn cornered<D: Domain>(m: &D, state: &State<D>, rng: &mut dyn Rng) -> State<D> {
    let mut at = state.clone();
    at.robot = corner(m.robot(), &state.robot, rng);
    for (slot, space) in at.objects.iter_mut().zip(m.objects()) {
        *slot = corner(space, slot, rng);
    }
    at
}

/// `state` with every component anywhere in its space; the mode is kept.
pub(super) fn elsewhere<D: Domain>(m: &D, state: &State<D>, rng: &mut dyn Rng) -> State<D> {
    let mut at = state.clone();
    at.robot = m.robot().sample(rng);
    for (slot, space) in at.objects.iter_mut().zip(m.objects()) {
        *slot = space.sample(rng);
    }
    at
}

/// A state of which one component is no configuration.
pub(super) struct SpoiltState<D: Domain> {
    pub(super) component: ComponentId,
    /// What is wrong with it.
    pub(super) what: String,
    pub(super) coordinate: Option<usize>,
    pub(super) state: State<D>,
}

/// `state` with one component spoilt after the other. Only where the component's space says that this is not one of its
/// configurations, so nobody has to accept it.
pub(super) fn spoilt_states<D: Domain>(m: &D, state: &State<D>) -> Vec<SpoiltState<D>> {
    let mut all = Vec::new();
    let rng = &mut rng_of(&"spoilt");
    for Spoilt { what, coordinate, config } in spoilt(m.robot(), &state.robot, &m.robot().sample(rng)) {
        if !m.robot().contains(&config) {
            let state = State { robot: config, ..state.clone() };
            all.push(SpoiltState { component: ComponentId::Robot, what, coordinate, state });
        }
    }
    for (i, (space, q)) in m.objects().iter().zip(&state.objects).enumerate() {
        for Spoilt { what, coordinate, config } in spoilt(space, q, &space.sample(rng)) {
            let mut at = state.clone();
            if let (false, Some(slot)) = (space.contains(&config), at.objects.get_mut(i)) {
                *slot = config;
                let component = ComponentId::Object(ObjectId::new(i));
                all.push(SpoiltState { component, what, coordinate, state: at });
            }
        }
    }
    all
}

/// `state` with one number of one component on a face of its space.
pub(super) fn on_face<D: Domain>(
    m: &D,
    state: &State<D>,
    component: ComponentId,
    coordinate: usize,
    is_upper: bool,
) -> State<D> {
    let mut at = state.clone();
    match component {
        ComponentId::Robot => at.robot = face(m.robot(), &state.robot, coordinate, is_upper),
        ComponentId::Object(id) => {
            if let (Some(space), Some(slot)) = (m.objects().get(id.index()), at.objects.get_mut(id.index())) {
                *slot = face(space, slot, coordinate, is_upper);
            }
        }
    }
    at
}

/// `state` with one number of one component so many metres beyond the face of its space.
pub(super) fn beyond_face<D: Domain>(
    m: &D,
    state: &State<D>,
    component: ComponentId,
    coordinate: usize,
    is_upper: bool,
    metres: f64,
) -> State<D> {
    fn push<S: ComponentSpace>(space: &S, q: &S::Config, coordinate: usize, by: f64) -> S::Config {
        let value = values(space, q).get(coordinate).copied().unwrap_or(0.0);
        with(space, q, coordinate, value + by)
    }
    let by = if is_upper { metres } else { -metres };
    let mut at = on_face(m, state, component, coordinate, is_upper);
    match component {
        ComponentId::Robot => at.robot = push(m.robot(), &at.robot, coordinate, by),
        ComponentId::Object(id) => {
            if let (Some(space), Some(slot)) = (m.objects().get(id.index()), at.objects.get_mut(id.index())) {
                *slot = push(space, slot, coordinate, by);
            }
        }
    }
    at
}

/// How many numbers one component has.
pub(super) fn count_of<D: Domain>(m: &D, state: &State<D>, component: ComponentId) -> usize {
    match component {
        ComponentId::Robot => count(m.robot(), &state.robot),
        ComponentId::Object(id) => match (m.objects().get(id.index()), state.object(id)) {
            (Some(space), Some(q)) => count(space, q),
            _ => 0,
        },
    }
}

/// `state` with one component somewhere else in its space.
pub(super) fn moved<D: Domain>(m: &D, state: &State<D>, component: ComponentId, rng: &mut dyn Rng) -> State<D> {
    let mut at = state.clone();
    match component {
        ComponentId::Robot => at.robot = m.robot().sample(rng),
        ComponentId::Object(id) => {
            if let (Some(space), Some(slot)) = (m.objects().get(id.index()), at.objects.get_mut(id.index())) {
                *slot = space.sample(rng);
            }
        }
    }
    at
}

/// Brings one component of `state` by a share of the way towards where it is in `there`.
pub(super) fn drift<D: Domain>(m: &D, state: &mut State<D>, there: &State<D>, component: ComponentId, share: f64) {
    match component {
        ComponentId::Robot => state.robot = m.robot().interpolate(&state.robot, &there.robot, share),
        ComponentId::Object(id) => {
            if let (Some(space), Some(slot), Some(to)) =
                (m.objects().get(id.index()), state.objects.get_mut(id.index()), there.object(id))
            {
                *slot = space.interpolate(slot, to, share);
            }
        }
    }
}

/// `state` with one object in the place of another, if there are two that can be there.
pub(super) fn piled<D: Domain>(m: &D, state: &State<D>, rng: &mut dyn Rng) -> Option<State<D>> {
    let count = state.objects.len();
    let (from, to) = (rng.random_range(0..count.max(1)), rng.random_range(0..count.max(1)));
    let place = state.objects.get(from).filter(|_| from != to)?.clone();
    let mut pile = state.clone();
    let slot = pile.objects.get_mut(to).filter(|_| m.objects().get(to).is_some_and(|space| space.contains(&place)))?;
    *slot = place;
    Some(pile)
}

/// The robot and all objects.
pub(super) fn everything<D: Domain>(m: &D) -> Vec<ComponentId> {
    let objects = (0..m.objects().len()).map(|i| ComponentId::Object(ObjectId::new(i)));
    std::iter::once(ComponentId::Robot).chain(objects).collect()
}

/// The components that `set` holds.
pub(super) fn components<D: Domain>(m: &D, set: ComponentSet) -> Vec<ComponentId> {
    everything(m).into_iter().filter(|component| set.contains(*component)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::{RealBox, Se2};

    #[test]
    fn numbers_are_told_from_what_is_none() {
        assert!(is_number(&[1.0, -2.0]) && is_number(&"infinite"));
        assert!(!is_number(&[1.0, f64::NAN]) && !is_number(&Some(f64::NEG_INFINITY)));
    }

    #[test]
    fn faces_are_found_to_the_last_digit() {
        let space = RealBox::new([-2.0, 0.5], [7.0, 0.5]).unwrap_or_else(|_| unreachable!());
        assert_eq!(face(&space, &[1.0, 0.5], 0, true), [7.0, 0.5]);
        assert_eq!(face(&space, &[1.0, 0.5], 0, false), [-2.0, 0.5]);
        assert_eq!(face(&space, &[1.0, 0.5], 1, true), [1.0, 0.5]);
        let plane = Se2::new([0.0; 2], [1.0; 2], 0.5).unwrap_or_else(|_| unreachable!());
        assert_eq!(face(&plane, &[0.5, 0.5, 3.0], 2, false)[2], -std::f64::consts::PI);
    }

    #[test]
    fn everything_is_spoilt_in_turn() {
        let space = RealBox::new([0.0; 2], [1.0; 2]).unwrap_or_else(|_| unreachable!());
        let all = spoilt(&space, &[0.5; 2], &[0.1; 2]);
        assert_eq!(all.len(), 7);
        assert!(all.iter().all(|bad| !is_number(&bad.config)));
    }
}
