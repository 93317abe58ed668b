//! Laws of [`Motion`] and of the [`Instance`] around it.

use std::fmt;

use crate::domain::Domain;
use crate::motion::{Instance, Motion};
use crate::space::ComponentSpace;
use crate::state::{ComponentId, ObjectId, State};

use super::watch::{entering, watched};
use super::{Broken, ensure, equal};

mod looks;

/// Length is a measure.
pub const LENGTH: &str = "motion.length: length is finite and not negative";
/// Start.
pub const START: &str = "motion.start: at t = 0 it is the state that it was propagated from, bit for bit";
/// Pure.
pub const PURE: &str = "motion.pure: the same t gives the same state, whatever the output held before";
/// Clamped.
pub const CLAMPED: &str = "motion.clamped: below 0 it is the state at 0, above 1 the state at 1";
/// Travel bound.
pub const TRAVEL: &str = "motion.travel: between t1 and t2 nothing travels farther than length * |t2 - t1|";
/// Mode.
pub const MODE: &str = "motion.mode: the mode is constant between the ends";
/// Frame rule.
pub const FRAME: &str = "motion.frame: a component that the instance does not name in `moves` stays bit for bit";
/// Everything named in `moves` exists.
pub const NAMED: &str =
    "motion.named: `moves` and `object` name components of the domain, and the state keeps its objects";

/// Numbers.
pub const FINITE: &str = "motion.finite: every state of a motion is made of numbers";
/// No jumps.
pub const CONTINUOUS: &str = "motion.continuous: in a billionth of a thousandth of a motion nothing travels farther than a micrometre, however long it is";
/// Knots.
pub const KNOTS: &str = "motion.knots: knots ascend and lie in [0, 1], and between two of them the robot follows the interpolation of its space";

/// Not too long.
pub const TIGHT: &str = "motion.tight: length is at most a hundred times what anything travels, and ten metres more";

/// The laws of this file.
pub const LAWS: &[&str] = &[LENGTH, START, PURE, CLAMPED, TRAVEL, MODE, FRAME, NAMED, FINITE, CONTINUOUS, KNOTS, TIGHT];

/// How far apart two states are: metres that the farthest point of any component travels between them.
pub type Travel<'a, D> = &'a dyn Fn(&D, &State<D>, &State<D>) -> f64;

/// How travel is measured, and how exactly.
pub struct MotionClaims<'a, D: Domain> {
    /// Default: the largest distance of any component in its own space, [`component_travel`]. A domain
    /// that knows its bodies can give the travel of their farthest points instead.
    pub travel: Travel<'a, D>,
    /// Rounding that is forgiven in the travel bound, metres.
    pub slack_m: f64,
    /// At how many evenly spaced parameters a motion is looked at besides the given ones; half as many random ones come
    /// on top, both sides of the ends and of the knots, and a search for jumps where it moves fastest.
    pub looks: u32,
}

impl<D: Domain> Default for MotionClaims<'_, D> {
    fn default() -> Self {
        Self { travel: &component_travel, slack_m: 1e-7, looks: 64 }
    }
}

impl<D: Domain> Clone for MotionClaims<'_, D> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<D: Domain> Copy for MotionClaims<'_, D> {}

impl<D: Domain> fmt::Debug for MotionClaims<'_, D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("MotionClaims").field("slack_m", &self.slack_m).finish_non_exhaustive()
    }
}

/// The largest distance of any component between two states, each measured in its own space, metres.
pub fn component_travel<D: Domain>(m: &D, a: &State<D>, b: &State<D>) -> f64 {
    let objects = m.objects().iter().zip(&a.objects).zip(&b.objects).map(|((space, p), q)| space.distance(p, q));
    objects.fold(m.robot().distance(&a.robot, &b.robot), f64::max)
}

/// All laws of a motion that was propagated from `from`, looked at 0, 1, the parameters `ts` in `[0, 1]`, and as densely as
/// the claims say. Where the looks are that nobody asked for depends on `from` and `ts` alone.
///
/// # Errors
/// The first law that is [`Broken`], with its parameter.
pub fn check_motion<D: Domain>(
    m: &D,
    motion: &dyn Motion<D>,
    from: &State<D>,
    ts: &[f64],
    claims: &MotionClaims<'_, D>,
) -> Result<(), Broken> {
    let about = || format!("check_motion(&{motion:?}, &{from:?}, &{ts:?})");
    let trial = looks::Trial { m, motion, from, claims };
    watched(&about, || trial.run(ts)).map_err(|broken| broken.replayed_by(about))
}

/// All laws of an instance that was propagated from `from`: those of its motion and the frame rule.
///
/// # Errors
/// The first law that is [`Broken`], with the primitive of the instance, and the component.
pub fn check_instance<D: Domain>(
    m: &D,
    instance: &Instance<D>,
    from: &State<D>,
    ts: &[f64],
    claims: &MotionClaims<'_, D>,
) -> Result<(), Broken> {
    let about = || format!("check_instance(&{instance:?}, &{from:?}, &{ts:?})");
    let check = || {
        named(m, instance)?;
        check_motion(m, &*instance.motion, from, ts, claims)
            .map_err(|broken| Broken { replay: Box::default(), ..broken })?;
        for t in looks::all(&*instance.motion, from, ts, claims.looks) {
            entering("at_into");
            frame(m, instance, from, &instance.at(m, t, from)).map_err(|broken| broken.at(t))?;
        }
        Ok(())
    };
    watched(&about, check).map_err(|broken: Broken| {
        let broken = broken.of(format_args!("instance {:?}", instance.primitive));
        broken.replayed_by(about)
    })
}

fn named<D: Domain>(m: &D, instance: &Instance<D>) -> Result<(), Broken> {
    let ids = (0..m.objects().len()).map(|i| ComponentId::Object(ObjectId::new(i)));
    let all = ids.fold(crate::state::ComponentSet::ROBOT, crate::state::ComponentSet::with);
    let text = || format!("moves {:?}", instance.moves);
    ensure(NAMED, instance.moves.is_subset_of(all), text, "components of the domain")?;
    let known = instance.object.is_none_or(|id| id.index() < m.objects().len());
    ensure(NAMED, known, || format!("object {:?}", instance.object), "an object of the domain")
}

fn frame<D: Domain>(m: &D, instance: &Instance<D>, from: &State<D>, here: &State<D>) -> Result<(), Broken> {
    if !instance.moves.contains(ComponentId::Robot) {
        equal(FRAME, &here.robot, &from.robot).map_err(|broken| broken.of(m.component_name(ComponentId::Robot)))?;
    }
    for (i, (p, q)) in here.objects.iter().zip(&from.objects).enumerate() {
        let id = ComponentId::Object(ObjectId::new(i));
        if !instance.moves.contains(id) {
            equal(FRAME, p, q).map_err(|broken| broken.of(m.component_name(id)))?;
        }
    }
    Ok(())
}
