//! Laws of [`Primitive`].

use std::fmt;

use rand::RngExt;

use crate::domain::Domain;
use crate::motion::Instance;
use crate::partial::PartialState;
use crate::primitive::{Infeasible, Instances, Primitive, PrimitiveId};
use crate::random::{Purpose, stream};
use crate::space::ComponentSpace;
use crate::state::{ComponentId, ObjectId, State};
use crate::validity::{Blame, BlockKind, Validity};

use super::feed::{cornered, elsewhere, rng_of, spoilt_states};
use super::motion::{MotionClaims, check_instance};
use super::partial::with_other_unnamed;
use super::validity::outside::{borders, exempts};
use super::watch::{bounded, entering, guarded, watched};
use super::{Broken, at_most, ensure, equal, measure};

mod at_most;
mod holds;
mod progress;

use progress::progress;

/// No panic.
pub const PANICS: &str = "primitive.panics: useful, approach and propagate never panic";
/// Termination.
pub const ENDS: &str = "primitive.ends: propagate ends within the declared number of random draws and instances";
/// Usefulness is pure.
pub const USEFUL_PURE: &str = "primitive.useful-pure: useful and approach answer the same question in the same way";
/// Nothing is useful for a target that is met.
pub const USEFUL_MET: &str = "primitive.useful-met: no primitive is useful for a target that is already met";
/// Approach is a measure and a lower bound.
pub const APPROACH: &str =
    "primitive.approach: approach is finite, not negative, and at most the travel of the propagation";
/// Seeded.
pub const SEEDED: &str = "primitive.seeded: the same arguments and the same generator give the same instances";
/// Arguments stay.
pub const UNTOUCHED: &str = "primitive.untouched: the state and the target that are handed in do not change";
/// Unnamed parts.
pub const UNNAMED: &str = "primitive.unnamed: robot groups that the target does not name have no influence";
/// Not empty.
pub const NOT_EMPTY: &str = "primitive.not-empty: a propagation that succeeds has at least one instance";
/// Chained.
pub const CHAINED: &str = "primitive.chained: the first instance starts at the given state and each next one where the last ended, bit for bit";
/// Progress.
pub const PROGRESS: &str = "primitive.progress: a named object that moves ends nearer to its target; if none moves, the robot ends nearer to its own, or an object is grasped or let go";
/// Truncation.
pub const TRUNCATED: &str = "primitive.truncated: where propagation is claimed to be cut anywhere, propagating to a state on the way ends there";
/// Contacts.
pub const CONTACTS: &str = "primitive.contacts: an instance allows the contact with the object that it manipulates";
/// Moves at most.
pub const MOVES: &str =
    "primitive.moves: an instance moves at most the robot and the object that it names, whatever it declares";
/// Harm.
pub const HARM: &str = "primitive.harm: a named object that is at its target is still there at the end";
/// Changes of mode.
pub const AT_HAND: &str = "primitive.at-hand: the mode changes only where the robot can act on the object, or where motions may go on over it";
/// Reversible.
pub const REVERSIBLE: &str =
    "primitive.reversible: what claims that it can be run backwards need not go anywhere else to bring its object back";
/// Feasible now and then.
pub const FEASIBLE: &str = "primitive.feasible: of a thousand calls in which it is useful one at least finds a way, whatever is still to be done";
/// Free now and then.
pub const FREE: &str = "primitive.free: of a hundred ways that it finds one at least is free to its end";
/// Names.
pub const NAME: &str = "primitive.name: a primitive has one name, which does not change";

/// Ids.
pub const IDS: &str = "primitive.ids: an instance that has the name or the index of a primitive has both";

/// Holding.
pub const HOLDS: &str = "primitive.holds: what is carried stays as far from the working point as it is, and what is moved otherwise stays as near to the hand";

/// The laws of this file.
pub const LAWS: &[&str] = &[
    MOVES,
    HARM,
    AT_HAND,
    REVERSIBLE,
    FEASIBLE,
    FREE,
    NAME,
    IDS,
    PANICS,
    ENDS,
    USEFUL_PURE,
    USEFUL_MET,
    APPROACH,
    SEEDED,
    UNTOUCHED,
    UNNAMED,
    NOT_EMPTY,
    CHAINED,
    PROGRESS,
    TRUNCATED,
    CONTACTS,
    HOLDS,
];

/// What a primitive claims, and where it is looked at.
pub struct PrimitiveClaims<'a, D: Domain> {
    /// How travel is measured.
    pub motion: MotionClaims<'a, D>,
    /// Parameters in `[0, 1]` at which the instances are looked at, besides 0 and 1.
    pub ts: &'a [f64],
    /// At most this many numbers are drawn in one propagation.
    pub max_draws: u64,
    /// At most this many instances in one propagation.
    pub max_instances: usize,
    /// A propagation towards a state on the way of the last instance ends there: claimed by primitives
    /// that go straight to their target, not by those that choose among several ways.
    pub truncates: bool,
    /// What ends nearer to its target ends nearer by at least this many metres, or at the target.
    pub least_m: f64,
    /// Where the mode changes, the object is at most so far ([`Domain::reach`], metres).
    pub hand_m: f64,
    /// Instances may move objects that they do not name, a tray with what stands on it for example.
    pub moves_others: bool,
    /// Why an end that is not nearer is progress all the same: true excuses it. For a grasp that lifts the
    /// object away from its target, say.
    pub excuse: Option<Excuse<'a, D>>,
}

/// Is the way from the first state to the second, for the sake of the target, progress of another kind?
pub type Excuse<'a, D> = &'a dyn Fn(&D, &State<D>, &PartialState<D>, &State<D>) -> bool;

impl<D: Domain> fmt::Debug for PrimitiveClaims<'_, D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("PrimitiveClaims")
            .field("motion", &self.motion)
            .field("ts", &self.ts)
            .field("max_draws", &self.max_draws)
            .field("max_instances", &self.max_instances)
            .field("truncates", &self.truncates)
            .field("least_m", &self.least_m)
            .field("hand_m", &self.hand_m)
            .field("moves_others", &self.moves_others)
            .finish_non_exhaustive()
    }
}

impl<D: Domain> Default for PrimitiveClaims<'_, D> {
    fn default() -> Self {
        Self {
            motion: MotionClaims::default(),
            ts: &[0.125, 0.25, 0.5, 0.71, 0.999],
            max_draws: 100_000,
            max_instances: 64,
            truncates: false,
            least_m: 1e-4,
            hand_m: 0.5,
            moves_others: false,
            excuse: None,
        }
    }
}

/// What a check found: laws that hold because nothing happened are no proof, so count these.
pub enum Tried<D: Domain> {
    /// The primitive was not useful; only the laws of `useful` were looked at.
    NotUseful,
    /// It was useful, but found no way.
    Infeasible(Infeasible),
    /// It was propagated, and every law was looked at.
    Propagated(Instances<D>),
}

// Not derived: that would ask the domain to be printable.
impl<D: Domain> fmt::Debug for Tried<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotUseful => f.write_str("NotUseful"),
            Self::Infeasible(why) => f.debug_tuple("Infeasible").field(why).finish(),
            Self::Propagated(instances) => f.debug_tuple("Propagated").field(instances).finish(),
        }
    }
}

/// All laws of a primitive, for one state, target and seed, with the default [`PrimitiveClaims`].
///
/// # Errors
/// The first law that is [`Broken`].
pub fn check_primitive<D: Domain>(
    m: &D,
    primitive: &dyn Primitive<D>,
    from: &State<D>,
    to: &PartialState<D>,
    seed: u64,
) -> Result<(), Broken> {
    try_primitive(m, primitive, from, to, seed, &PrimitiveClaims::default()).map(|_| ())
}

/// Like [`check_primitive`], with claims; tells what happened, for a test that wants to see success.
///
/// # Errors
/// The first law that is [`Broken`].
pub fn try_primitive<D: Domain>(
    m: &D,
    primitive: &dyn Primitive<D>,
    from: &State<D>,
    to: &PartialState<D>,
    seed: u64,
    claims: &PrimitiveClaims<'_, D>,
) -> Result<Tried<D>, Broken> {
    let name = primitive.name();
    let about = || format!("check_primitive(&{name}, &{from:?}, &{to:?}, {seed})");
    let trial = Trial { m, primitive, from, to, seed, claims };
    watched(&about, || trial.run()).map_err(|broken| broken.of(name).replayed_by(about))
}

struct Trial<'a, 'c, D: Domain> {
    m: &'a D,
    primitive: &'a dyn Primitive<D>,
    from: &'a State<D>,
    to: &'a PartialState<D>,
    seed: u64,
    claims: &'a PrimitiveClaims<'c, D>,
}

/// `found`, of an instance, is `id` as a whole or in nothing.
pub(in crate::laws) fn is_whole(found: PrimitiveId, id: PrimitiveId) -> Result<(), Broken> {
    let holds = (found.index() == id.index()) == (found.name() == id.name());
    let text = |id: PrimitiveId| format!("{} with the index {}", id.name(), id.index());
    if holds { Ok(()) } else { Err(Broken::new(IDS, text(found), text(id))) }
}

type Propagated<D> = Result<Instances<D>, Infeasible>;

impl<D: Domain> Trial<'_, '_, D> {
    fn run(&self) -> Result<Tried<D>, Broken> {
        let (from_before, to_before) = (self.from.clone(), self.to.clone());
        let id = self.primitive.id();
        let useful = self.usefulness()?;
        self.extremes()?;
        let tried = if useful { self.propagation()? } else { Tried::NotUseful };
        equal(UNTOUCHED, self.from, &from_before)?;
        equal(UNTOUCHED, self.to, &to_before)?;
        let now = self.primitive.id();
        equal(NAME, &(now.index(), now.name()), &(id.index(), id.name()))?;
        Ok(tried)
    }

    fn is_useful(&self, to: &PartialState<D>) -> Result<bool, Broken> {
        self.is_useful_from(self.from, to)
    }

    fn is_useful_from(&self, from: &State<D>, to: &PartialState<D>) -> Result<bool, Broken> {
        entering("useful");
        guarded(PANICS, || self.primitive.useful(self.m, from, to))
    }

    fn approach(&self, to: &PartialState<D>) -> Result<Option<f64>, Broken> {
        entering("approach");
        guarded(PANICS, || self.primitive.approach(self.m, self.from, to))
    }

    fn propagate(&self, to: &PartialState<D>, attempt: u64) -> Result<Propagated<D>, Broken> {
        self.propagate_from(self.from, to, attempt)
    }

    fn propagate_from(&self, from: &State<D>, to: &PartialState<D>, attempt: u64) -> Result<Propagated<D>, Broken> {
        let rng = stream(self.seed, attempt, 0, Purpose::Extend);
        entering("propagate");
        bounded(PANICS, ENDS, self.claims.max_draws, rng, |rng| self.primitive.propagate(self.m, from, to, rng))
    }

    fn is_excused(&self, end: &State<D>) -> bool {
        self.claims.excuse.is_some_and(|excuse| excuse(self.m, self.from, self.to, end))
    }

    /// Targets in the corners and targets that are no numbers: what is asked comes back, whatever it answers.
    fn extremes(&self) -> Result<(), Broken> {
        let mut rng = rng_of(&(self.from, self.to, self.seed));
        let corner = cornered(self.m, self.from, &mut rng);
        let near = self.from.clone();
        let spoilt = spoilt_states(self.m, &corner);
        let strange = rng.random_range(0..spoilt.len().max(1));
        let strange = spoilt.into_iter().nth(strange).map(|spoilt| spoilt.state);
        for state in [Some(corner), Some(near), strange].into_iter().flatten() {
            let target = PartialState::of_state(self.m, &state);
            // Of the robot alone, of the objects alone, and of everything.
            let of_objects =
                target.objects().fold(PartialState::anywhere(self.m), |all, (id, at)| all.with_object(id, at.clone()));
            let of_robot = PartialState::anywhere(self.m).with_robot(self.m, state.robot.clone());
            for to in [target, of_objects, of_robot] {
                if self.is_useful(&to)? {
                    let _ = self.propagate(&to, 2)?;
                }
                let _ = self.approach(&to)?;
            }
        }
        Ok(())
    }

    /// A target that asks the same, but holds other values where it asks nothing.
    fn twin(&self) -> PartialState<D> {
        let mut rng = stream(self.seed, 0, 0, Purpose::Sample);
        let elsewhere = State { robot: self.m.robot().sample(&mut rng), ..self.from.clone() };
        with_other_unnamed(self.m, self.to, &elsewhere)
    }

    fn usefulness(&self) -> Result<bool, Broken> {
        let useful = self.is_useful(self.to)?;
        let here = PartialState::of_state(self.m, self.from);
        for met in [&here, &PartialState::anywhere(self.m), self.to] {
            if met.is_met(self.m, self.from) {
                let text = || format!("useful for {met:?}");
                ensure(USEFUL_MET, !self.is_useful(met)?, text, "not useful: the target is met")?;
            }
        }
        equal(USEFUL_PURE, &self.is_useful(self.to)?, &useful)?;
        equal(UNNAMED, &self.is_useful(&self.twin())?, &useful).map_err(|broken| broken.of("useful"))?;
        let approach = self.approach(self.to)?;
        approach.map_or(Ok(()), |metres| measure(APPROACH, metres))?;
        equal(USEFUL_PURE, &self.approach(self.to)?, &approach)?;
        equal(UNNAMED, &self.approach(&self.twin())?, &approach).map_err(|broken| broken.of("approach"))?;
        Ok(useful)
    }

    fn propagation(&self) -> Result<Tried<D>, Broken> {
        let first = self.propagate(self.to, 0)?;
        self.same(SEEDED, &self.propagate(self.to, 0)?, &first)?;
        // Another draw in between brings hidden state to light.
        let _ = self.propagate(self.to, 1)?;
        self.same(SEEDED, &self.propagate(self.to, 0)?, &first)?;
        self.same(UNNAMED, &self.propagate(&self.twin(), 0)?, &first)?;
        match first {
            Err(why) => Ok(Tried::Infeasible(why)),
            Ok(instances) => {
                self.instances(&instances)?;
                Ok(Tried::Propagated(instances))
            }
        }
    }

    fn instances(&self, instances: &[Instance<D>]) -> Result<(), Broken> {
        ensure(NOT_EMPTY, !instances.is_empty(), || "no instances".to_owned(), "at least one")?;
        let most = self.claims.max_instances;
        ensure(ENDS, instances.len() <= most, || format!("{} instances", instances.len()), "the declared bound")?;
        let mut end = self.from.clone();
        for (i, instance) in instances.iter().enumerate() {
            let of = |broken: Broken| broken.of(format_args!("instance {i} {:?}", instance.primitive));
            is_whole(instance.primitive, self.primitive.id()).map_err(of)?;
            equal(CHAINED, &instance.at(self.m, 0.0, self.from), &end).map_err(|broken| of(broken).at(0.0))?;
            check_instance(self.m, instance, &end, self.claims.ts, &self.claims.motion)
                .map_err(|broken| Broken { replay: Box::default(), ..broken })?;
            end = instance.at(self.m, 1.0, self.from);
            self.on_the_way(&end).map_err(of)?;
        }
        if let Some(metres) = self.approach(self.to)? {
            let travel = instances.iter().map(|instance| instance.motion.length()).sum();
            at_most(APPROACH, metres, travel, self.claims.motion.slack_m)?;
        }
        if !self.is_excused(&end) {
            progress(self.m, self.from, self.to, &end, (instances, self.claims.least_m))?;
        }
        self.at_most(instances, &end)?;
        if self.claims.truncates { self.truncation(instances) } else { Ok(()) }
    }

    /// Where an instance ends the same may be asked again: just there two things may be at no distance.
    fn on_the_way(&self, here: &State<D>) -> Result<(), Broken> {
        entering("approach");
        let approach = guarded(PANICS, || self.primitive.approach(self.m, here, self.to))?;
        approach.map_or(Ok(()), |metres| measure(APPROACH, metres)).map_err(|broken| broken.of("on the way"))?;
        if self.is_useful_from(here, self.to)? {
            let _ = self.propagate_from(here, self.to, 3)?;
        }
        Ok(())
    }

    /// Propagates towards a state on the way of the last instance: same named components, cut values.
    fn truncation(&self, instances: &[Instance<D>]) -> Result<(), Broken> {
        let Some(last) = instances.last() else { return Ok(()) };
        for t in self.claims.ts {
            let cut = last.at(self.m, *t, self.from);
            let mut target = PartialState::anywhere(self.m);
            if let Some(robot) = self.to.robot() {
                target = target.with_robot_groups(cut.robot.clone(), robot.groups);
            }
            for (id, _) in self.to.objects() {
                if let Some(config) = cut.object(id) {
                    target = target.with_object(id, config.clone());
                }
            }
            if !self.is_useful(&target)? {
                continue;
            }
            let end = match self.propagate(&target, 0)? {
                Ok(again) => again.last().map(|last| last.at(self.m, 1.0, self.from)),
                Err(_) => None,
            };
            let near = end.as_ref().is_some_and(|end| target.is_met(self.m, end));
            ensure(TRUNCATED, near, || format!("{end:?}"), "the state at t, in every named component")
                .map_err(|broken| broken.at(*t))?;
        }
        Ok(())
    }

    /// The same outcome: the same refusal, or instances that agree wherever they are looked at.
    fn same(&self, law: &'static str, found: &Propagated<D>, against: &Propagated<D>) -> Result<(), Broken> {
        let (Ok(found), Ok(against)) = (found, against) else {
            return equal(law, &format!("{:?}", found.as_ref().err()), &format!("{:?}", against.as_ref().err()));
        };
        equal(law, &found.len(), &against.len()).map_err(|broken| broken.of("number of instances"))?;
        for (i, (p, q)) in found.iter().zip(against).enumerate() {
            let of = |broken: Broken| broken.of(format_args!("instance {i} {:?}", q.primitive));
            equal(law, &head(p), &head(q)).map_err(of)?;
            equal(law, &p.contacts, &q.contacts).map_err(of)?;
            for t in self.claims.ts.iter().copied().chain([0.0, 1.0]) {
                equal(law, &p.at(self.m, t, self.from), &q.at(self.m, t, self.from))
                    .map_err(|broken| of(broken).at(t))?;
            }
        }
        Ok(())
    }
}

/// Everything of an instance that can be compared at a glance.
fn head<D: Domain>(instance: &Instance<D>) -> impl PartialEq + std::fmt::Debug + use<D> {
    (instance.primitive, instance.motion.length(), instance.moves, instance.object, instance.reversible)
}

/// An instance allows the contact with the object that it names: `validity` may find other reasons why
/// the motion is not free, but not that robot and this object touch. Whether it is the robot that touches the object is not
/// believed of the kind of the blame alone: it is also when the same place is free as soon as the robot is elsewhere. And it
/// allows no more than that: among states anywhere only what it names, moves or has at hand is excused.
///
/// # Errors
/// [`CONTACTS`] with the blame, or [`validity.exempts`](super::validity::EXEMPTS).
pub fn check_contacts<D: Domain>(
    m: &D,
    validity: &dyn Validity<D>,
    instances: &[Instance<D>],
    from: &State<D>,
    ts: &[f64],
) -> Result<(), Broken> {
    let about = || format!("check_contacts(&{instances:?}, &{from:?}, &{ts:?})");
    let check = || {
        for instance in instances {
            let mut rng = rng_of(from);
            let half = instance.at(m, 0.5, from);
            let mut states: Vec<_> = (0..ANYWHERE).map(|_| elsewhere(m, &half, &mut rng)).collect();
            // Where only the robot is elsewhere more is free.
            states.extend((0..ANYWHERE).map(|_| State { robot: m.robot().sample(&mut rng), ..half.clone() }));
            states.extend(borders(m, validity, &states, &mut rng));
            exempts(m, validity, instance, from, &states)
                .map_err(|broken| broken.of(format_args!("instance {:?}", instance.primitive)))?;
            let Some(name) = instance.object.map(|id: ObjectId| m.component_name(ComponentId::Object(id))) else {
                continue;
            };
            for t in ts.iter().copied().chain([0.0, 1.0]) {
                let state = instance.at(m, t, from);
                entering("check");
                let Err(blame) = validity.check(m, &state, &instance.contacts) else { continue };
                let names_it = *blame.first == *name || *blame.second == *name;
                if names_it && is_of_the_robot(m, validity, instance, &state, &blame) {
                    let broken = Broken::new(CONTACTS, blame.to_string(), format!("contact with {name} allowed"));
                    return Err(broken.at(t).of(format_args!("instance {:?}", instance.primitive)));
                }
            }
        }
        Ok(())
    };
    watched(&about, check).map_err(|broken| broken.replayed_by(about))
}

/// How many states anywhere show what contacts excuse.
const ANYWHERE: usize = 48;

/// Is it the robot that touches?
fn is_of_the_robot<D: Domain>(
    m: &D,
    validity: &dyn Validity<D>,
    instance: &Instance<D>,
    state: &State<D>,
    blame: &Blame,
) -> bool {
    let mut rng = rng_of(state);
    blame.kind == BlockKind::RobotObject
        || (0..8).any(|_| {
            let away = State { robot: m.robot().sample(&mut rng), ..state.clone() };
            validity.check(m, &away, &instance.contacts).is_ok()
        })
}
