//! Pushing a round object along the ray through its centre, or on an arc that begins along it.

use darrt_core::primitive::{Infeasible, Instances, PrimitiveId};
use darrt_core::state::ObjectId;
use nalgebra::Isometry3;
use rand::{Rng, RngExt};

use super::Chain;
use super::at_work::at_work;
use super::retreat::retreat;
use super::slide::{SlidingHand, SlidingWay, assemble, find};
use super::stance::Probe;
use crate::contact::HandStance;
use crate::manipulator::Manipulator;
use crate::tabletop::{Tabletop, TabletopState};

mod course;
mod hand;

use course::{Course, end_of_push};
use hand::HandPlace;
pub(super) use hand::Pushable;

/// A push that is cut short, by what stands in the way or because the arm reaches no farther, is not worth the approach if it
/// is shorter than this, metres.
const LEAST_PUSH_M: f64 = 0.02;

/// Share of the pushes that may take object and hand as near to other things as the rules allow; the others keep the wanted
/// margins.
const CLOSE_SHARE: f64 = 0.1;

/// Retreat, transit to the pushing pose, straight down behind the object, and the push: to the object's target or, where
/// that lies off the support or too near to its edge, to the edge. Straight; where that is blocked along an arc, on which the
/// object turns with the hand no more sharply than the fingers hold it; and if that is blocked too, straight up to what is in
/// the way.
///
/// A push is long enough to settle what the object's place may be off
/// ([`steady_push`](crate::push::steady::SlidingDisc::steady_push)), unless its end is nearer than that.
///
/// # Errors
/// [`Infeasible::NoContact`] for an object that cannot be pushed, [`Infeasible::UnstablePush`] for one that would not stay
/// at the fingers or is too heavy, [`Infeasible::OffSupport`] if the way leaves its support, [`Infeasible::NoProgress`] if it
/// is already as near as a push can bring it, [`Infeasible::Blocked`] if the object or every stance of the robot meets
/// something, [`Infeasible::Unreachable`].
pub fn push<M: Manipulator>(
    m: &Tabletop<M>,
    from: &TabletopState<M>,
    object: ObjectId,
    target: &Isometry3<f64>,
    rng: &mut dyn Rng,
) -> Result<Instances<Tabletop<M>>, Infeasible> {
    let at_work = &*at_work(m, from, rng);
    let pushable = Pushable::new(m, at_work, object)?;
    let settle_m = pushable.steady(m)?.settle_m.max(LEAST_PUSH_M);
    let end = end_of_push(m, &pushable, target, settle_m, rng)?;
    let care = if rng.random_bool(CLOSE_SHARE) { 0 } else { m.collision_scene().most_care() };
    let beside = at_work.mode.opened_to(pushable.gap_m).and_then(|mode| mode.engaged_with(object));
    let probe = Probe::new(m, at_work, beside.ok_or(Infeasible::NoContact)?);
    let mut attempt = Attempt { m, from, at_work, pushable: &pushable, probe, twin: rng.random_bool(0.5), care };

    let straight = Course::straight(m, from, &pushable, &end, settle_m, care);
    if let Ok(course) = &straight
        && course.is_whole
    {
        match attempt.run(course, rng) {
            Err(Refusal { is_of_hand: true, .. }) => {}
            done => return done.map_err(|refusal| refusal.why),
        }
    }
    let side = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
    for course in Course::arcs(m, from, &pushable, &end, care, side) {
        match attempt.run(&course, rng) {
            Err(Refusal { is_of_hand: true, .. }) => {}
            done => return done.map_err(|refusal| refusal.why),
        }
    }
    attempt.run(&straight?, rng).map_err(|refusal| refusal.why)
}

/// The straight way of `object` to `target` or, where that lies off the support or too near to its edge, to the edge; not all
/// the way if something stands in its way, but far enough to settle what its place may be off. For primitives of your own;
/// [`push`] has arcs besides.
///
/// # Errors
/// As [`push`], but for what the hand and the arm need.
pub fn straight_way<M: Manipulator>(
    m: &Tabletop<M>,
    from: &TabletopState<M>,
    object: ObjectId,
    target: &Isometry3<f64>,
    rng: &mut dyn Rng,
) -> Result<SlidingWay, Infeasible> {
    let pushable = Pushable::new(m, from, object)?;
    let settle_m = pushable.steady(m)?.settle_m.max(LEAST_PUSH_M);
    let end = end_of_push(m, &pushable, target, settle_m, rng)?;
    let course = Course::straight(m, from, &pushable, &end, settle_m, 0)?;
    Ok(SlidingWay { slide: course.slide, least_m: course.least_m })
}

/// The hand behind `object` on its way, both fingertips at its rim, with room around the hand: as Push stands, for an
/// instance of `primitive`.
///
/// # Errors
/// [`Infeasible::NoContact`] where such a hand does not push, [`Infeasible::Blocked`].
pub fn hand_behind<M: Manipulator>(
    m: &Tabletop<M>,
    from: &TabletopState<M>,
    (object, way): (ObjectId, &SlidingWay),
    stance: &HandStance,
    primitive: PrimitiveId,
) -> Result<SlidingHand, Infeasible> {
    let pushable = Pushable::new(m, from, object)?;
    let beside = from.mode.opened_to(pushable.gap_m).and_then(|mode| mode.engaged_with(object));
    let probe = Probe::new(m, from, beside.ok_or(Infeasible::NoContact)?);
    let heading = way.slide.heading().ok_or(Infeasible::NoProgress)?;
    let place = HandPlace::new(m, &pushable, &heading, stance, 0, &probe)?;
    Ok(SlidingHand { primitive, ..place.hand(&pushable) })
}

/// A try to push an object along some way.
struct Attempt<'a, M: Manipulator> {
    m: &'a Tabletop<M>,
    from: &'a TabletopState<M>,
    /// The same with the hand at work that is to push.
    at_work: &'a TabletopState<M>,
    pushable: &'a Pushable<'a>,
    probe: Probe<'a, M>,
    twin: bool,
    /// With how much care the hand stands at the object.
    care: usize,
}

/// Why there is no push along some way.
struct Refusal {
    why: Infeasible,
    /// Is there no room for the hand alone, wherever the robot stands?
    is_of_hand: bool,
}

impl From<Infeasible> for Refusal {
    fn from(why: Infeasible) -> Self {
        Self { why, is_of_hand: false }
    }
}

impl<M: Manipulator> Attempt<'_, M> {
    /// The push along `course`, with the hand in the first of its leans in which it can be done.
    fn run(&mut self, course: &Course, rng: &mut dyn Rng) -> Result<Instances<Tabletop<M>>, Refusal> {
        let Self { m, from, at_work, pushable, twin, care, .. } = *self;
        let mut refusal = Refusal { why: Infeasible::NoContact, is_of_hand: true };
        let mut chain = None;
        for stance_of_hand in pushable.stances(m, twin) {
            let place = match HandPlace::new(m, pushable, &course.heading, &stance_of_hand, care, &self.probe) {
                Ok(place) => place,
                Err(why) => {
                    refusal.why = why;
                    continue;
                }
            };
            let retreated = if let Some(chain) = chain.take() {
                chain
            } else {
                let mut chain = Chain::at(from);
                retreat(m, &mut chain, m.settings().retreat_m)?;
                chain
            };
            let hand = place.hand(pushable);
            let way = SlidingWay { slide: course.slide, least_m: course.least_m };
            match find(m, at_work, (&hand, &way), &mut self.probe, |_| true, rng) {
                Ok(arm_way) => return Ok(assemble(m, retreated, (&hand, &way), &arm_way, rng)?),
                Err(why) => refusal = Refusal { why, is_of_hand: false },
            }
            chain = Some(retreated);
        }
        Err(refusal)
    }
}
