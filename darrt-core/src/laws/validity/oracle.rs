//! A validity against the user's own slow oracle: a function that says of a state whether it is free.

use crate::primitive::PrimitiveId;
use rand::RngExt;

use super::{LAX, ORACLE_PREFIX, PURE, STRICT};
use crate::domain::Domain;
use crate::laws::Broken;
use crate::laws::feed::{cornered, drift, elsewhere, everything, piled, rng_of};
use crate::laws::motion::component_travel;
use crate::laws::watch::{entering, watched};
use crate::motion::{Instance, Waypoints};
use crate::state::{ComponentId, ComponentSet, State};
use crate::validity::Validity;

/// Is a state free, if nothing may touch? As slow and as obvious as its author likes.
pub type Free<'a, D> = &'a (dyn Fn(&D, &State<D>) -> bool + Sync);

/// How often a border between free and blocked is halved.
const HALVINGS: u32 = 12;
/// How many pairs of states a border is looked for between.
const BORDERS: usize = 160;
/// Of what the oracle calls free at least this share is accepted, of at least [`ENOUGH`] states.
const LEAST_SHARE: f64 = 0.5;
const ENOUGH: usize = 60;
/// States looked at along a motion.
const LOOKS: u32 = 96;

/// `validity` never calls free what `oracle` calls blocked: not of the given states, not of states anywhere and in the corners,
/// not on either side of the borders between free and blocked, and not on the free prefix of straight motions of the robot
/// between them. They are asked in random order, with repeats. And it is not so careful that half of what is free is lost.
///
/// # Errors
/// [`LAX`], [`STRICT`], [`ORACLE_PREFIX`] or [`PURE`].
pub fn check_by_oracle<D: Domain>(
    m: &D,
    validity: &dyn Validity<D>,
    oracle: Free<'_, D>,
    states: &[&State<D>],
    seed: u64,
) -> Result<(), Broken> {
    let about = || format!("check_by_oracle(&validity, &oracle, &{states:?}, {seed})");
    let trial = Trial { m, validity, oracle };
    watched(&about, || trial.run(states, seed)).map_err(|broken| broken.replayed_by(about))
}

struct Trial<'a, D: Domain> {
    m: &'a D,
    validity: &'a dyn Validity<D>,
    oracle: Free<'a, D>,
}

impl<D: Domain> Trial<'_, D> {
    fn free(&self, state: &State<D>) -> bool {
        entering("oracle");
        (self.oracle)(self.m, state)
    }

    fn answer(&self, state: &State<D>) -> String {
        entering("check");
        let answer = self.validity.check(self.m, state, &D::Contacts::default());
        answer.map_or_else(|blame| blame.to_string(), |()| FREE.to_owned())
    }

    fn run(&self, states: &[&State<D>], seed: u64) -> Result<(), Broken> {
        let mut rng = rng_of(&(states, seed));
        let mut all: Vec<(State<D>, bool)> = Vec::new();
        // States anywhere are no fair measure of how much is lost: only given ones and these are counted.
        let mut fair = 0;
        for state in states {
            let anywhere = elsewhere(self.m, state, &mut rng);
            let robot = State { robot: anywhere.robot.clone(), ..(*state).clone() };
            for state in [(*state).clone(), anywhere, robot] {
                let is_free = self.free(&state);
                all.push((state, is_free));
                fair += 1;
            }
        }
        for state in states {
            let corner = cornered(self.m, state, &mut rng);
            for state in std::iter::once(corner).chain(piled(self.m, state, &mut rng)) {
                let is_free = self.free(&state);
                all.push((state, is_free));
            }
        }
        let borders = self.borders(&all, &mut rng);
        all.extend(borders);
        self.in_any_order(&all, fair, &mut rng)?;
        self.along(&all)
    }

    /// Both sides of the border between a free state and a blocked one, one component straight between them.
    fn borders(&self, all: &[(State<D>, bool)], rng: &mut crate::random::Stream) -> Vec<(State<D>, bool)> {
        let (mut found, movable) = (Vec::new(), everything(self.m));
        for _ in 0..BORDERS {
            let pick = |rng: &mut crate::random::Stream| all.get(rng.random_range(0..all.len().max(1)));
            let (Some((a, true)), Some((b, false))) = (pick(rng), pick(rng)) else { continue };
            // Of the robot as often as of all objects.
            let component = movable.get(rng.random_range(0..movable.len())).filter(|_| rng.random_bool(0.5));
            let component = component.copied().unwrap_or(ComponentId::Robot);
            let between = |t: f64| {
                let mut state = a.clone();
                drift(self.m, &mut state, b, component, t);
                state
            };
            let (mut free, mut blocked) = (0.0, 1.0);
            if self.free(&between(1.0)) {
                continue;
            }
            for _ in 0..HALVINGS {
                let t = 0.5 * (free + blocked);
                *(if self.free(&between(t)) { &mut free } else { &mut blocked }) = t;
            }
            found.extend([(between(free), true), (between(blocked), false)]);
        }
        found
    }

    fn in_any_order(
        &self,
        all: &[(State<D>, bool)],
        fair: usize,
        rng: &mut crate::random::Stream,
    ) -> Result<(), Broken> {
        let mut answers: Vec<Option<String>> = vec![None; all.len()];
        for round in 0..3 * all.len() {
            // At last every state has been asked once.
            let i = if round < 2 * all.len() { rng.random_range(0..all.len()) } else { round - 2 * all.len() };
            let (Some((state, is_free)), Some(slot)) = (all.get(i), answers.get_mut(i)) else { continue };
            let answer = self.answer(state);
            if answer == FREE && !is_free {
                return Err(Broken::new(LAX, format!("free: {state:?}"), "blocked, says the oracle"));
            }
            match slot {
                Some(before) if *before != answer => {
                    return Err(Broken::new(PURE, format!("{answer}, for {state:?}"), before.as_str()));
                }
                _ => *slot = Some(answer),
            }
        }
        let free = all.iter().zip(&answers).take(fair).filter(|((_, is_free), _)| *is_free);
        let (asked, accepted) = free.fold((0_usize, 0_usize), |(asked, accepted), (_, answer)| {
            (asked + 1, accepted + usize::from(answer.as_deref() == Some(FREE)))
        });
        if asked >= ENOUGH && (accepted as f64) < LEAST_SHARE * asked as f64 {
            let found = format!("{accepted} of {asked} free states accepted");
            return Err(Broken::new(STRICT, found, format!("at least {LEAST_SHARE:?} of them")));
        }
        Ok(())
    }

    /// The robot straight from one state to the next: the batch against the oracle, state by state.
    fn along(&self, all: &[(State<D>, bool)]) -> Result<(), Broken> {
        for pair in all.windows(2).take(24) {
            // A motion begins where it may: from there on everything that moves is looked at.
            let ([(a, true), (b, _)] | [(b, _), (a, true)]) = pair else { continue };
            let end = State { robot: b.robot.clone(), ..a.clone() };
            let metres = component_travel(self.m, a, &end);
            let Some(motion) = Waypoints::new(vec![a.clone(), end], &[metres], a.mode.clone()) else { continue };
            let instance = Instance {
                primitive: PrimitiveId::new(10, "straight"),
                motion: Box::new(motion),
                contacts: D::Contacts::default(),
                moves: ComponentSet::ROBOT,
                object: None,
                reversible: true,
            };
            entering("free_prefix");
            let prefix = self.validity.free_prefix(self.m, &instance, a);
            if prefix.fraction <= 0.0 {
                continue;
            }
            for i in 0..=LOOKS {
                let t = prefix.fraction * (f64::from(i) / f64::from(LOOKS));
                let state = instance.at(self.m, t, a);
                if !self.free(&state) {
                    // Is it the batch alone?
                    let law = if self.answer(&state) == FREE { LAX } else { ORACLE_PREFIX };
                    let found = format!("free up to {:?}, through {state:?}", prefix.fraction);
                    return Err(Broken::new(law, found, "blocked, says the oracle").at(t));
                }
            }
        }
        Ok(())
    }
}

/// What stands for a state that is accepted.
const FREE: &str = "free";
