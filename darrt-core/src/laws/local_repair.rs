//! Laws of [`LocalRepair`].

use crate::domain::Domain;
use crate::local_repair::{LocalRepair, NoWay};
use crate::motion::Instance;
use crate::random::{Purpose, stream};
use crate::state::{ComponentSet, State};
use crate::validity::Validity;

use super::watch::{drawing, entering, watched};
use super::{Broken, MotionClaims, alike, check_instance, ensure, identical};

/// The ends.
pub const ENDS: &str =
    "local-repair.ends: a way around begins and ends as the motion that it replaces, in the same modes, bit for bit";
/// Nothing else.
pub const SAME: &str =
    "local-repair.same: a way around moves the same components, for the same object, and touches nothing more";
/// What may turn.
pub const TURNS: &str = "local-repair.turns: only what can be run backwards and moves nothing but the robot and what it carries may turn aside";
/// Pure.
pub const PURE: &str = "local-repair.pure: is_free_to_turn answers the same question in the same way";
/// Seeded.
pub const SEEDED: &str = "local-repair.seeded: the same generator gives the same way around";
/// Refusals.
pub const REFUSES: &str = "local-repair.refuses: of what may not turn aside there is no way around, with any care";
/// Free.
pub const FREE: &str = "local-repair.free: a way around is free";

/// The laws of this file.
pub const LAWS: &[&str] = &[ENDS, SAME, TURNS, PURE, SEEDED, REFUSES, FREE];

/// Where two ways are compared.
const LOOKS: [f64; 7] = [0.0, 0.125, 0.3, 0.5, 0.77, 0.9, 1.0];

/// All laws of a way around for `instance`, which begins at `from`, and those of the motion that is found, as `claims` say.
/// True if a way was found.
///
/// # Errors
/// The first law that is [`Broken`].
pub fn check_local_repair<D: Domain>(
    m: &D,
    local_repair: &dyn LocalRepair<D>,
    validity: &dyn Validity<D>,
    (instance, from): (&Instance<D>, &State<D>),
    seed: u64,
    claims: &MotionClaims<'_, D>,
) -> Result<bool, Broken> {
    let about = || format!("check_local_repair(&{instance:?}, &{from:?}, {seed})");
    let trial = Trial { m, local_repair, validity, instance, from };
    let of = |broken: Broken| broken.of(format_args!("way around for {:?}", instance.primitive));
    watched(&about, || trial.run(seed, claims)).map_err(|broken| of(broken).replayed_by(about))
}

struct Trial<'a, D: Domain> {
    m: &'a D,
    local_repair: &'a dyn LocalRepair<D>,
    validity: &'a dyn Validity<D>,
    instance: &'a Instance<D>,
    from: &'a State<D>,
}

impl<D: Domain> Trial<'_, D> {
    fn run(&self, seed: u64, claims: &MotionClaims<'_, D>) -> Result<bool, Broken> {
        let Self { m, instance, from, .. } = *self;
        let turns = || {
            entering("is_free_to_turn");
            self.local_repair.is_free_to_turn(m, instance)
        };
        let may = turns();
        for _ in 0..3 {
            alike(PURE, &turns(), &may)?;
        }
        let carried = m.carried(&instance.at(m, 0.5, from).mode).union(ComponentSet::ROBOT);
        let is_bound = !instance.reversible || !instance.moves.is_subset_of(carried);
        let text = || format!("may turn: reversible {}, moves {:?}", instance.reversible, instance.moves);
        ensure(TURNS, !may || !is_bound, text, "may not")?;
        let found = self.find(seed)?;
        if !may {
            let text = || format!("{:?}", found.as_ref().map(|_| "a way"));
            ensure(REFUSES, found.as_ref().err() == Some(&NoWay::WithAnyCare), text, "NoWay::WithAnyCare")?;
        }
        let again = self.find(seed)?;
        let along = |found: &Result<Instance<D>, NoWay>| match found {
            Ok(way) => Ok(LOOKS.map(|t| way.at(m, t, from))),
            Err(why) => Err(*why),
        };
        alike(SEEDED, &along(&again), &along(&found))?;
        let Ok(way) = found else { return Ok(false) };
        for t in [0.0, 1.0] {
            identical(ENDS, &way.at(m, t, from), &instance.at(m, t, from)).map_err(|broken| broken.at(t))?;
        }
        let none = D::Contacts::default();
        let touches = way.contacts == instance.contacts || way.contacts == none;
        ensure(SAME, touches, || format!("{:?}", way.contacts), "the contacts of the motion, or none")?;
        alike(SAME, &way.moves, &instance.moves).map_err(|broken| broken.of("moves"))?;
        alike(SAME, &way.object, &instance.object).map_err(|broken| broken.of("object"))?;
        ensure(SAME, instance.reversible || !way.reversible, || "reversible".to_owned(), "not reversible")?;
        check_instance(m, &way, from, &LOOKS, claims).map_err(|broken| Broken { replay: Box::default(), ..broken })?;
        entering("free_prefix");
        let free = self.validity.free_prefix(m, &way, from);
        let blame = free.blame.as_ref().map_or_else(String::new, ToString::to_string);
        let text = || format!("free up to {:?}, then {blame}", free.fraction);
        let is_free = free.fraction >= 1.0 && free.blame.is_none();
        ensure(FREE, is_free, text, "free")?;
        Ok(true)
    }

    fn find(&self, seed: u64) -> Result<Result<Instance<D>, NoWay>, Broken> {
        let Self { m, instance, from, validity, .. } = *self;
        let rng = stream(seed, 0, 0, Purpose::Extend);
        drawing("local_repair", rng, |rng| self.local_repair.repair(m, validity, 0, instance, from, rng))
    }
}
