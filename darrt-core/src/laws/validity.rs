//! Laws of [`Validity`].

use std::fmt;
use std::sync::Arc;

use rand::RngExt;

use crate::domain::Domain;
use crate::motion::{Instance, Motion};
use crate::random::{Purpose, stream};
use crate::space::ComponentSpace;
use crate::state::{ComponentId, State};
use crate::validity::{Blame, FreePrefix, Validity};

use super::feed::components;
use super::watch::{entering, watched};
use super::{Broken, ensure, equal};

mod oracle;
pub(super) mod outside;

pub use oracle::{Free, check_by_oracle};

/// Pure.
pub const PURE: &str = "validity.pure: the same question has the same answer, whatever was asked in between";
/// Fraction.
pub const FRACTION: &str =
    "validity.fraction: the free fraction lies in [0, 1], and is 1 exactly when nothing is blamed";
/// One by one.
pub const ONE_BY_ONE: &str =
    "validity.one-by-one: check accepts every state of the free prefix, however densely it is looked at";
/// Truncation.
pub const CUT: &str =
    "validity.cut: a motion cut within its free prefix is free altogether, and no piece of it that ends behind is";
/// Blame is real.
pub const BLAME_REAL: &str = "validity.blame-real: just behind the free prefix check rejects a state";
/// Blame names.
pub const BLAME_NAMES: &str = "validity.blame-names: free_prefix blames what check blames just behind the prefix";
/// Blame is readable.
pub const BLAME_TEXT: &str = "validity.blame-text: a blame names both bodies and a finite place";
/// Exemptions.
pub const EXEMPTIONS: &str =
    "validity.exemptions: contacts that may touch never make a valid state invalid, and end with the instance";
/// Care.
pub const CARE: &str = "validity.care: what is free with more care is free with less, a care of 0 are the rules, and check takes the same care as free_prefix";
/// Obstacles.
pub const ENLARGED: &str = "validity.enlarged: enlarging an obstacle never makes an invalid state valid";
/// The oracle.
pub const ORACLE: &str = "validity.oracle: what the fast check calls free, the exact oracle calls free";
/// What is no number.
pub const NAN: &str = "validity.nan: a state with a component that is NaN or infinite is not valid, whatever may touch";
/// In the spaces.
pub const INSIDE: &str = "validity.inside: no state of a free prefix has a component that moves outside of its space";
/// Exemptions end at the object.
pub const EXEMPTS: &str = "validity.exempts: an allowed contact excuses only bodies that the instance names, moves or has at hand, and of two objects only those that touch on its way";
/// Kinds of blame.
pub const BLAME_KIND: &str =
    "validity.blame-kind: the kind of a blame fits the names, and who it names is really to blame";
/// Without the robot.
pub const WITHOUT_ROBOT: &str = "validity.without-robot: without the robot the same objects are in the way wherever it is, and none that are not with it";
/// Held objects.
pub const HELD: &str =
    "validity.held: where an object at rest would be in something else, it is not free in the hand either";
/// The user's oracle.
pub const LAX: &str = "validity.lax: check never calls free what the user's oracle calls blocked";
/// The user's oracle, the other way round.
pub const STRICT: &str = "validity.strict: of what the user's oracle calls free, at least half is accepted";
/// The user's oracle along motions.
pub const ORACLE_PREFIX: &str = "validity.oracle-prefix: no state of a free prefix is blocked for the user's oracle";

/// Places.
pub const BLAME_PLACE: &str = "validity.blame-place: the places of collisions are told, are not all the origin, and are near the robot or an object: no farther than ten times the room";

/// The laws of this file.
pub const LAWS: &[&str] = &[
    PURE,
    FRACTION,
    ONE_BY_ONE,
    CUT,
    BLAME_REAL,
    BLAME_NAMES,
    BLAME_TEXT,
    EXEMPTIONS,
    CARE,
    ENLARGED,
    ORACLE,
    NAN,
    INSIDE,
    EXEMPTS,
    BLAME_KIND,
    BLAME_PLACE,
    WITHOUT_ROBOT,
    HELD,
    LAX,
    STRICT,
    ORACLE_PREFIX,
];

/// How exactly a validity answers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ValidityClaims {
    /// A blocked prefix ends at most this many metres of motion before a state that `check` rejects.
    pub tight_m: f64,
    /// `free_prefix` blames the same bodies as `check`. Where several bodies block at once, both may
    /// blame any of them, and a validity need not claim this.
    pub same_names: bool,
    /// How many random parameters are looked at between the regular ones.
    pub between: usize,
    /// How many states anywhere it is judged by from outside: exemptions, kinds of blames, memory.
    pub anywhere: usize,
}

impl Default for ValidityClaims {
    fn default() -> Self {
        Self { tight_m: 0.02, same_names: true, between: 16, anywhere: 12 }
    }
}

/// All laws of a validity, for the motion of one instance that starts at `from`.
///
/// # Errors
/// The first law that is [`Broken`], with its parameter.
pub fn check_validity<D: Domain>(
    m: &D,
    validity: &dyn Validity<D>,
    instance: &Arc<Instance<D>>,
    from: &State<D>,
    claims: &ValidityClaims,
    seed: u64,
) -> Result<(), Broken> {
    let trial = Trial { m, validity, instance, from, claims };
    let about = || format!("check_validity(&{instance:?}, &{from:?}, {claims:?}, {seed})");
    watched(&about, || trial.run(seed))
        .map_err(|broken| broken.of(format_args!("motion {:?}", instance.primitive)).replayed_by(about))
}

/// Length of the shortest pieces of motions that are looked at, metres.
const PIECE_M: f64 = 0.005;
/// At most so many metres lie between two looks at a free prefix, as long as it is not longer than [`MOST_LOOKS`] of them.
const LOOK_M: f64 = 0.01;
const MOST_LOOKS: f64 = 512.0;

/// In how many steps a prefix is looked at with more care.
const WITH_CARE: u32 = 32;

struct Trial<'a, D: Domain> {
    m: &'a D,
    validity: &'a dyn Validity<D>,
    instance: &'a Arc<Instance<D>>,
    from: &'a State<D>,
    claims: &'a ValidityClaims,
}

impl<D: Domain> Trial<'_, D> {
    fn check(&self, t: f64) -> Result<(), Blame> {
        entering("check");
        self.validity.check(self.m, &self.instance.at(self.m, t, self.from), &self.instance.contacts)
    }

    fn free_prefix(&self, instance: &Instance<D>) -> FreePrefix {
        entering("free_prefix");
        self.validity.free_prefix(self.m, instance, self.from)
    }

    fn run(&self, seed: u64) -> Result<(), Broken> {
        let bare = self.bare_answers();
        let free = self.free_prefix(self.instance);
        shape(&free)?;
        self.prefix(&free, seed)?;
        if let Some(blame) = &free.blame {
            readable(blame)?;
            self.blocked(&free, blame)?;
        }
        self.exemptions(&bare)?;
        equal(PURE, &self.free_prefix(self.instance), &free)?;
        self.care(&free)?;
        self.cut(&free)?;
        self.outside(seed)?;
        // After all the other questions.
        equal(PURE, &self.free_prefix(self.instance), &free)
    }

    /// No state of the prefix is rejected: its end, 2, 7 and 64 equal steps, steps of a centimetre, and random ones.
    fn prefix(&self, free: &FreePrefix, seed: u64) -> Result<(), Broken> {
        if free.fraction <= 0.0 {
            return Ok(());
        }
        let mut rng = stream(seed, 0, 0, Purpose::Sample);
        let random = (0..self.claims.between).map(|_| rng.random_range(0.0..=free.fraction)).collect::<Vec<_>>();
        let metres = self.instance.motion.length() * free.fraction;
        // Not negative, and at most MOST_LOOKS; NaN gives none.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped")]
        let by_metres = (metres / LOOK_M).ceil().clamp(1.0, MOST_LOOKS) as u32;
        let regular = [1_u32, 2, 7, 64, by_metres]
            .into_iter()
            .flat_map(|n| (0..=n).map(move |i| free.fraction * (f64::from(i) / f64::from(n))));
        for t in regular.chain(random) {
            if let Err(blame) = self.check(t) {
                let broken = Broken::new(ONE_BY_ONE, blame.to_string(), format!("free up to {:?}", free.fraction));
                return Err(broken.at(t));
            }
            self.inside(t)?;
        }
        Ok(())
    }

    /// What moves is in its space, if it begins there.
    fn inside(&self, t: f64) -> Result<(), Broken> {
        let state = self.instance.at(self.m, t, self.from);
        for component in components(self.m, self.instance.moves) {
            let is_inside = |state: &State<D>| match component {
                ComponentId::Robot => self.m.robot().contains(&state.robot),
                ComponentId::Object(id) => {
                    let space = self.m.objects().get(id.index());
                    space.zip(state.object(id)).is_none_or(|(space, at)| space.contains(at))
                }
            };
            let holds = is_inside(&state) || !is_inside(self.from);
            ensure(INSIDE, holds, || format!("free through {state:?}"), "inside its space")
                .map_err(|broken| broken.at(t).of(self.m.component_name(component)))?;
        }
        Ok(())
    }

    /// Parameter of a length in metres; all of it for a motion without length.
    fn parameter_of(&self, metres: f64) -> f64 {
        let length = self.instance.motion.length();
        if length > 0.0 { metres / length } else { 1.0 }
    }

    fn blocked(&self, free: &FreePrefix, blame: &Blame) -> Result<(), Broken> {
        let window = self.parameter_of(self.claims.tight_m);
        let scan = |looks: u32| -> Vec<Blame> {
            let ts = (0..=looks).map(|i| (free.fraction + window * f64::from(i) / f64::from(looks)).min(1.0));
            ts.filter_map(|t| self.check(t).err()).collect()
        };
        // A graze may be short: only a close look tells that there is none.
        let found = Some(scan(64)).filter(|found| !found.is_empty()).unwrap_or_else(|| scan(4096));
        if found.is_empty() {
            let against = format!("check accepts all of [{:?}, {:?}]", free.fraction, free.fraction + window);
            let broken = Broken::new(BLAME_REAL, blame.to_string(), against);
            return Err(broken.at(free.fraction).within(self.claims.tight_m));
        }
        let same = |b: &Blame| b.kind == blame.kind && b.first == blame.first && b.second == blame.second;
        if self.claims.same_names && !found.iter().any(same) {
            let against = found.first().map(ToString::to_string).unwrap_or_default();
            return Err(Broken::new(BLAME_NAMES, blame.to_string(), against).at(free.fraction));
        }
        Ok(())
    }

    /// What `check` says about some states when nothing may touch.
    fn bare_answers(&self) -> Vec<(f64, Result<(), Blame>)> {
        let answer = |t| self.validity.check(self.m, &self.instance.at(self.m, t, self.from), &D::Contacts::default());
        [0.0, 0.3, 0.5, 1.0].into_iter().map(|t| (t, answer(t))).collect()
    }

    /// The same answers as before any contact was allowed; and allowing contacts only makes more valid.
    fn exemptions(&self, bare: &[(f64, Result<(), Blame>)]) -> Result<(), Broken> {
        for ((t, before), (_, after)) in bare.iter().zip(self.bare_answers()) {
            equal(EXEMPTIONS, &after, before).map_err(|broken| broken.at(*t))?;
            let with = self.check(*t);
            if before.is_ok() {
                equal(EXEMPTIONS, &with, before).map_err(|broken| broken.at(*t))?;
            }
            equal(PURE, &self.check(*t), &with).map_err(|broken| broken.at(*t))?;
        }
        Ok(())
    }

    /// Each care against the one below it, over the whole motion and state by state.
    fn care(&self, free: &FreePrefix) -> Result<(), Broken> {
        equal(CARE, &self.validity.free_prefix_with(0, self.m, self.instance, self.from), free)?;
        let mut less = free.clone();
        for care in 1..=self.validity.most_care() {
            let more = self.validity.free_prefix_with(care, self.m, self.instance, self.from);
            shape(&more)?;
            let is_more = more.blame.is_none() && less.blame.is_some();
            ensure(CARE, !is_more, || format!("free with care {care}; with less: {less:?}"), "free with less care")?;
            for t in [0.0, 0.3, 0.5, more.fraction, 1.0] {
                let (state, contacts) = (self.instance.at(self.m, t, self.from), &self.instance.contacts);
                let [with_less, with_more] =
                    [care - 1, care].map(|care| self.validity.check_with(care, self.m, &state, contacts));
                let is_more = with_more.is_ok() && with_less.is_err();
                let found = || format!("valid with care {care}; with less: {with_less:?}");
                ensure(CARE, !is_more, found, "valid with less care").map_err(|broken| broken.at(t))?;
            }
            self.one_by_one(care, &more)?;
            less = more;
        }
        Ok(())
    }

    /// With this care as well, check accepts what is in the prefix, and not all that is just behind it.
    fn one_by_one(&self, care: usize, free: &FreePrefix) -> Result<(), Broken> {
        let check = |t: f64| {
            let state = self.instance.at(self.m, t, self.from);
            self.validity.check_with(care, self.m, &state, &self.instance.contacts)
        };
        // The first state is the end of the motion before, in the mode of that one: it may be careless.
        for i in 1..=WITH_CARE {
            let t = free.fraction * f64::from(i) / f64::from(WITH_CARE);
            if let (true, Err(blame)) = (free.fraction > 0.0, check(t)) {
                let against = format!("free up to {:?} with care {care}", free.fraction);
                return Err(Broken::new(CARE, blame.to_string(), against).at(t));
            }
        }
        let window = self.parameter_of(self.claims.tight_m);
        let is_blocked = |looks: u32| {
            (0..=looks).any(|i| check((free.fraction + window * f64::from(i) / f64::from(looks)).min(1.0)).is_err())
        };
        let holds = free.blame.is_none() || is_blocked(64) || is_blocked(4096);
        let text = || format!("{free:?} with care {care}, where check accepts all that follows");
        ensure(CARE, holds, text, "the same care in both").map_err(|broken| broken.at(free.fraction))
    }

    fn cut(&self, free: &FreePrefix) -> Result<(), Broken> {
        let margin = if free.blame.is_some() { self.parameter_of(self.claims.tight_m) } else { 0.0 };
        for share in [1.0, 0.6, 0.25] {
            let until = (free.fraction - margin) * share;
            if until <= 0.0 {
                continue;
            }
            let short = truncated(self.instance, until);
            let again = self.free_prefix(&short);
            if let Some(blame) = &again.blame {
                let left = format!("free up to {:?}, then {blame}", again.fraction * until);
                return Err(Broken::new(CUT, left, format!("free up to {:?}", free.fraction)).at(until));
            }
        }
        if free.blame.is_some() { self.pieces(free) } else { Ok(()) }
    }

    /// Pieces of the motion, long and short, that end in the first state behind the prefix that is not valid.
    fn pieces(&self, free: &FreePrefix) -> Result<(), Broken> {
        let window = self.parameter_of(self.claims.tight_m);
        let behind = (0..=64_u32).map(|i| (free.fraction + window * f64::from(i) / 64.0).min(1.0));
        let Some((until, blame)) = behind.filter(|t| *t > 0.0).find_map(|t| self.check(t).err().map(|b| (t, b))) else {
            return Ok(());
        };
        for metres in [f64::INFINITY, 0.1, PIECE_M] {
            let since = (until - self.parameter_of(metres)).max(0.0);
            let from = self.instance.at(self.m, since, self.from);
            // Where it begins, nothing is in the way yet.
            if since > 0.0 && self.check(since).is_err() {
                continue;
            }
            let piece = piece(self.instance, since, until);
            entering("free_prefix");
            let found = self.validity.free_prefix(self.m, &piece, &from);
            let text = || format!("free from {since:?} to {until:?}, where check says {blame}");
            ensure(CUT, found.blame.is_some(), text, "not free")?;
        }
        Ok(())
    }
}

fn shape(free: &FreePrefix) -> Result<(), Broken> {
    let holds = (0.0..=1.0).contains(&free.fraction) && free.blame.is_none() == (free.fraction == 1.0);
    ensure(FRACTION, holds, || format!("{free:?}"), "1 without blame, or less with blame")
}

fn readable(blame: &Blame) -> Result<(), Broken> {
    let holds = !blame.first.is_empty() && !blame.second.is_empty() && blame.place.iter().all(|x| x.is_finite());
    ensure(BLAME_TEXT, holds, || format!("{blame:?}"), "two names and a finite place")
}

/// `instance` run on `[0, until]` only.
pub fn truncated<D: Domain>(instance: &Arc<Instance<D>>, until: f64) -> Instance<D> {
    piece(instance, 0.0, until)
}

/// `instance` run on `[since, until]` only.
fn piece<D: Domain>(instance: &Arc<Instance<D>>, since: f64, until: f64) -> Instance<D> {
    Instance {
        primitive: instance.primitive,
        motion: Box::new(Cut { instance: Arc::clone(instance), since, until }),
        contacts: instance.contacts.clone(),
        moves: instance.moves,
        object: instance.object,
        reversible: instance.reversible,
    }
}

/// A motion cut short.
struct Cut<D: Domain> {
    instance: Arc<Instance<D>>,
    since: f64,
    until: f64,
}

impl<D: Domain> Motion<D> for Cut<D> {
    fn length(&self) -> f64 {
        self.instance.motion.length() * (self.until - self.since)
    }

    fn at_into(&self, m: &D, t: f64, out: &mut State<D>) {
        let t = t.clamp(0.0, 1.0);
        let at = if t >= 1.0 { self.until } else { self.since + t * (self.until - self.since) };
        self.instance.motion.at_into(m, at, out);
    }
}

impl<D: Domain> fmt::Debug for Cut<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Cut")
            .field("instance", &self.instance)
            .field("since", &self.since)
            .field("until", &self.until)
            .finish()
    }
}

/// Of two validities that differ in the size of obstacles, the one with larger obstacles rejects whatever
/// the other rejects.
///
/// # Errors
/// [`ENLARGED`] with the blame that was lost.
pub fn check_enlarged<D: Domain>(
    m: &D,
    smaller: &dyn Validity<D>,
    larger: &dyn Validity<D>,
    state: &State<D>,
    contacts: &D::Contacts,
) -> Result<(), Broken> {
    match (smaller.check(m, state, contacts), larger.check(m, state, contacts)) {
        (Err(blame), Ok(())) => {
            let broken = Broken::new(ENLARGED, "valid among the larger obstacles", blame.to_string());
            Err(broken.replayed_by(|| format!("check_enlarged(&{state:?}, &{contacts:?})")))
        }
        _ => Ok(()),
    }
}

/// The fast check never calls free what the oracle calls blocked: `looks` equally spaced states of the
/// free prefix, its end among them, are shown to the oracle.
///
/// # Errors
/// [`ORACLE`] with the oracle's blame and the parameter.
pub fn check_against_oracle<D: Domain>(
    m: &D,
    fast: &dyn Validity<D>,
    oracle: &dyn Validity<D>,
    instance: &Instance<D>,
    from: &State<D>,
    looks: u32,
) -> Result<(), Broken> {
    let free = fast.free_prefix(m, instance, from);
    if free.fraction <= 0.0 {
        return Ok(());
    }
    for i in 0..=looks.max(1) {
        let t = free.fraction * (f64::from(i) / f64::from(looks.max(1)));
        if let Err(blame) = oracle.check(m, &instance.at(m, t, from), &instance.contacts) {
            let broken = Broken::new(ORACLE, format!("free up to {:?}", free.fraction), blame.to_string());
            return Err(broken
                .at(t)
                .of(format_args!("motion {:?}", instance.primitive))
                .replayed_by(|| format!("check_against_oracle(&{instance:?}, &{from:?}, {looks})")));
        }
    }
    Ok(())
}
