//! Laws of [`Motion`] and of the [`Instance`] around it.

use std::fmt;

use crate::domain::Domain;
use crate::motion::{Instance, Motion};
use crate::space::ComponentSpace;
use crate::state::{ComponentId, ObjectId, State};

use super::{Broken, at_most, ensure, equal, measure};

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

/// The laws of this file.
pub const LAWS: &[&str] = &[LENGTH, START, PURE, CLAMPED, TRAVEL, MODE, FRAME, NAMED];

/// How far apart two states are: metres that the farthest point of any component travels between them.
pub type Travel<'a, D> = &'a dyn Fn(&D, &State<D>, &State<D>) -> f64;

/// How travel is measured, and how exactly.
pub struct MotionClaims<'a, D: Domain> {
    /// Default: the largest distance of any component in its own space, [`component_travel`]. A domain
    /// that knows its bodies can give the travel of their farthest points instead.
    pub travel: Travel<'a, D>,
    /// Rounding that is forgiven in the travel bound, metres.
    pub slack_m: f64,
}

impl<D: Domain> Default for MotionClaims<'_, D> {
    fn default() -> Self {
        Self { travel: &component_travel, slack_m: 1e-7 }
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

/// All laws of a motion that was propagated from `from`, looked at 0, 1 and the parameters `ts` in
/// `[0, 1]`.
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
    let at = |t: f64, garbage: &State<D>| {
        let mut out = garbage.clone();
        motion.at_into(m, t, &mut out);
        out
    };
    let check = || {
        measure(LENGTH, motion.length())?;
        let (start, end) = (at(0.0, from), at(1.0, from));
        equal(START, &start, from).map_err(|broken| broken.at(0.0))?;
        let mut between: Vec<f64> = ts.to_vec();
        between.extend([0.0, 1.0]);
        between.sort_by(f64::total_cmp);
        let mut before: Option<(f64, State<D>)> = None;
        for t in between {
            let here = at(t, from);
            // Whatever was written before, and in whatever order it is asked.
            equal(PURE, &at(t, &end), &here).map_err(|broken| broken.at(t))?;
            equal(NAMED, &here.objects.len(), &from.objects.len()).map_err(|broken| broken.at(t))?;
            if let Some((t0, there)) = &before {
                let bound = motion.length() * (t - t0);
                at_most(TRAVEL, (claims.travel)(m, there, &here), bound, claims.slack_m)
                    .map_err(|broken| broken.at(t))?;
                if *t0 > 0.0 && t < 1.0 {
                    equal(MODE, &here.mode, &there.mode).map_err(|broken| broken.at(t))?;
                }
            }
            before = Some((t, here));
        }
        equal(CLAMPED, &at(-1.0, &end), &start).map_err(|broken| broken.at(-1.0))?;
        equal(CLAMPED, &at(2.0, &start), &end).map_err(|broken| broken.at(2.0))
    };
    check().map_err(|broken| broken.replayed_by(|| format!("check_motion(&{motion:?}, &{from:?}, &{ts:?})")))
}

/// All laws of an instance that was propagated from `from`: those of its motion and the frame rule.
///
/// # Errors
/// The first law that is [`Broken`], with the label of the instance, and the component.
pub fn check_instance<D: Domain>(
    m: &D,
    instance: &Instance<D>,
    from: &State<D>,
    ts: &[f64],
    claims: &MotionClaims<'_, D>,
) -> Result<(), Broken> {
    let check = || {
        named(m, instance)?;
        check_motion(m, &*instance.motion, from, ts, claims)?;
        for t in ts.iter().copied().chain([0.0, 1.0]) {
            frame(m, instance, from, &instance.at(m, t, from)).map_err(|broken| broken.at(t))?;
        }
        Ok(())
    };
    check().map_err(|broken: Broken| {
        let broken = broken.of(format_args!("instance {:?}", instance.label));
        broken.replayed_by(|| format!("check_instance(&{instance:?}, &{from:?}, &{ts:?})"))
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
