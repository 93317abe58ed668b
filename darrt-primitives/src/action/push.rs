//! Pushing a round object along the ray through its centre, or on an arc that begins along it.

use darrt_core::motion::Instance;
use darrt_core::primitive::{Infeasible, Instances};
use darrt_core::state::{ComponentId, ComponentSet, ObjectId};
use nalgebra::{Isometry3, Point2};
use rand::{Rng, RngExt};

use super::Chain;
use super::line::{Line, follow_in_room, follow_path, moved};
use super::retreat::retreat;
use super::stance::{Care, Probe, Refused, Wanted, at_end, stance};
use super::travel::travel;
use crate::arm_motion::{ArmMotion, Carried, Waypoint};
use crate::contact::HandStance;
use crate::manipulator::{Configuration, Manipulator};
use crate::mode::{Contacts, TouchReason};
use crate::primitive;
use crate::tabletop::{Tabletop, TabletopState};

mod course;
mod hand;

use course::{Course, end_of_push};
use hand::HandPlace;
pub(super) use hand::Pushable;

/// A push that is cut short, by what stands in the way or because the arm reaches no farther, is not worth the approach if it
/// is shorter than this, metres.
const LEAST_PUSH_M: f64 = 0.02;
/// Rounding that is forgiven in the length of a push, metres.
const ROUNDING_M: f64 = 1e-9;

/// The arm's way of one push: down behind the object, to the contact, along the push.
struct Way<J> {
    base: [f64; 3],
    /// From high above the standoff point down to it.
    down: Vec<J>,
    /// At the contact.
    contact: J,
    /// Along the push as far as the arm reaches.
    along: Line<J>,
}

/// Share of the pushes that may take the object as near to other things as the rules allow; the others keep the wanted margin.
const CLOSE_SHARE: f64 = 0.25;

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
    let pushable = Pushable::new(m, from, object)?;
    let settle_m = pushable.steady(m)?.settle_m.max(LEAST_PUSH_M);
    let end = end_of_push(m, &pushable, target, settle_m, rng)?;
    let care = if rng.random_bool(CLOSE_SHARE) { 0 } else { m.surroundings().most_care() };
    let beside = from.mode.opened_to(pushable.gap_m).and_then(|mode| mode.engaged_with(object));
    let probe = Probe::new(m, from, beside.ok_or(Infeasible::NoContact)?);
    let mut attempt = Attempt { m, from, pushable: &pushable, probe, twin: rng.random_bool(0.5) };

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

/// A try to push an object along some way.
struct Attempt<'a, M: Manipulator> {
    m: &'a Tabletop<M>,
    from: &'a TabletopState<M>,
    pushable: &'a Pushable<'a>,
    probe: Probe<'a, M>,
    twin: bool,
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
        let Self { m, from, pushable, twin, .. } = *self;
        let mut refusal = Refusal { why: Infeasible::NoContact, is_of_hand: true };
        let mut chain = None;
        for &lean in &m.settings().push.leans_rad {
            let stance_of_hand = HandStance { twin, lean };
            let place = match HandPlace::new(m, pushable, &course.heading, &stance_of_hand, &self.probe) {
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
            let wanted = Wanted { world_from_tool: &place.at_contact, tries: m.settings().base_tries };
            let push = Pushing { pushable, place: &place, course };
            match stance(m, from, &wanted, rng, |q, care| way_of(m, q, &push, &mut self.probe, care)) {
                Ok(way) => return Ok(assemble(m, retreated, &push, &way, rng)?),
                Err(why) => refusal = Refusal { why, is_of_hand: false },
            }
            chain = Some(retreated);
        }
        Err(refusal)
    }
}

/// What is pushed, from where, and how.
struct Pushing<'a> {
    pushable: &'a Pushable<'a>,
    place: &'a HandPlace,
    course: &'a Course,
}

impl Pushing<'_> {
    /// Would the object be left far enough from the edge when `share` of the push is done?
    fn keeps_from_edge<M: Manipulator>(&self, m: &Tabletop<M>, share: f64) -> bool {
        let at = self.course.slide.at(share).translation.vector.xy();
        m.keeps_from_edge(self.pushable.object, self.pushable.on, &Point2::from(at))
    }
}

/// The arm's way from a configuration at the contact, if it reaches far enough and its cornerstones are clear.
fn way_of<M: Manipulator>(
    m: &Tabletop<M>,
    q: &Configuration<M::Joints>,
    push: &Pushing<'_>,
    probe: &mut Probe<'_, M>,
    care: &mut Care,
) -> Result<Way<M::Joints>, Refused<M>> {
    let Pushing { pushable, place, course } = push;
    let touching = contacts(pushable.object);
    probe.check(q, &touching, care)?;
    // The first step decides most often, so it is tried before anything else.
    let object_from_tool = course.slide.from().inverse() * place.at_contact;
    let along =
        follow_path(m, &q.base, &q.arm, course.slide.length_m(), |share| course.slide.at(share) * object_from_tool);
    if along.reached_m() < course.least_m - ROUNDING_M || !push.keeps_from_edge(m, along.share()) {
        return Err(Refused::Unreachable);
    }
    probe.place(pushable.object, &course.slide.at(along.share()));
    let pushed = probe.check(&at_end(q.base, &along.arms)?, &touching, care);
    probe.place(pushable.object, pushable.pose);
    pushed?;
    let mut is_clear = |q: &Configuration<M::Joints>| probe.check(q, &Contacts::default(), care);
    let back = follow_in_room(m, q, &place.at_contact, &-place.ahead, place.standoff_m, &mut is_clear)?;
    let standoff = at_end(q.base, &back.arms)?;
    let behind = moved(&place.at_contact, &-place.ahead, back.reached_m());
    let up = follow_in_room(m, &standoff, &behind, &-place.pointing, place.approach_m, &mut is_clear)?;
    let down = up.arms.iter().rev().copied().chain([standoff.arm]).collect();
    Ok(Way { base: q.base, down, contact: q.arm, along })
}

/// What a push may touch.
fn contacts(object: ObjectId) -> Contacts {
    Contacts { fingers: Some((object, TouchReason::Push)), support: None }
}

fn assemble<M: Manipulator>(
    m: &Tabletop<M>,
    mut chain: Chain<M>,
    push: &Pushing<'_>,
    way: &Way<M::Joints>,
    rng: &mut dyn Rng,
) -> Result<Instances<Tabletop<M>>, Infeasible> {
    let (object, gap_m) = (push.pushable.object, push.pushable.gap_m);
    approach(m, &mut chain, object, way.base, &way.down, gap_m, Contacts::default(), rng)?;

    let robot = |arm: &M::Joints| Configuration { base: way.base, arm: *arm };
    let reached = way.along.share();
    let contact = Waypoint { robot: robot(&way.contact), pushed: 0.0 };
    let along = way.along.arms.iter().zip(&way.along.shares);
    let waypoints: Vec<_> = std::iter::once(contact)
        .chain(along.map(|(arm, share)| Waypoint { robot: robot(arm), pushed: share / reached }))
        .collect();
    let mode = chain.end.mode.clone();
    let carried = Carried::Pushed(object, push.course.slide.at(reached));
    let motion = ArmMotion::new(m, &chain.end, &waypoints, carried, mode.clone(), mode);
    let instance = Instance {
        primitive: primitive::PUSH,
        motion: Box::new(motion),
        contacts: contacts(object),
        moves: ComponentSet::ROBOT.with(ComponentId::Object(object)),
        object: Some(object),
        reversible: false,
    };
    chain.push(m, instance);
    chain.finish()
}

/// Travel to the first of `arms`, then straight on through the others: the hand comes to stand at `object`.
#[expect(clippy::too_many_arguments, reason = "the approach is one motion with these independent facts")]
pub(super) fn approach<M: Manipulator>(
    m: &Tabletop<M>,
    chain: &mut Chain<M>,
    object: ObjectId,
    base: [f64; 3],
    arms: &[M::Joints],
    gap_m: f64,
    contacts: Contacts,
    rng: &mut dyn Rng,
) -> Result<(), Infeasible> {
    let (first, rest) = arms.split_first().ok_or(Infeasible::Unreachable)?;
    travel(m, chain, &Configuration { base, arm: *first }, gap_m, rng);
    let mode =
        chain.end.mode.opened_to(gap_m).and_then(|mode| mode.engaged_with(object)).ok_or(Infeasible::NoContact)?;
    let waypoints: Vec<_> =
        rest.iter().map(|arm| Waypoint { robot: Configuration { base, arm: *arm }, pushed: 0.0 }).collect();
    let mut instance =
        super::travel::carry(m, chain, &waypoints, &mode, primitive::STRAIGHT_LINE_ARM_TRANSIT, contacts);
    instance.object = Some(object);
    chain.push(m, instance);
    Ok(())
}
