//! A hand that comes down behind an object, straight to the contact, and makes the object slide: what Push does, and what a
//! primitive of your own does that pushes, hooks or draws.

use darrt_core::motion::Instance;
use darrt_core::primitive::{Infeasible, Instances, PrimitiveId};
use darrt_core::state::{ComponentId, ComponentSet, ObjectId};
use nalgebra::{Isometry3, Point2, Vector3};
use rand::Rng;

use super::Chain;
use super::at_work::at_work;
use super::line::{Line, follow_in_room, follow_path, moved};
use super::retreat::retreat;
use super::stance::{Care, Probe, Refused, Wanted, at_end, stance};
use super::travel::travel;
use crate::arm_motion::{ArmMotion, Carried, Waypoint};
use crate::length_range::LengthRange;
use crate::manipulator::{Configuration, JointVector as _, Manipulator};
use crate::mode::{Contacts, SurfaceId, TouchReason};
use crate::primitive;
use crate::push::slide::Slide;
use crate::tabletop::{Tabletop, TabletopState};

/// Rounding that is forgiven in the length of a way, metres.
const ROUNDING_M: f64 = 1e-9;

/// A hand at work on an object that slides with it.
#[derive(Debug, Clone, Copy)]
pub struct SlidingHand {
    /// Whose instance the slide is.
    pub primitive: PrimitiveId,
    /// The object.
    pub object: ObjectId,
    /// What it rests on.
    pub on: SurfaceId,
    /// The hand at the contact, before the object moves.
    pub at_contact: Isometry3<f64>,
    /// Where the contact lies from the place where the hand comes down, a unit vector of the world.
    pub ahead: Vector3<f64>,
    /// Where it comes down along, a unit vector of the world.
    pub down: Vector3<f64>,
    /// How far behind the contact it comes down.
    pub standoff_m: LengthRange,
    /// How long it comes straight down before.
    pub approach_m: LengthRange,
    /// Gap between the fingers, metres.
    pub gap_m: f64,
}

/// The way of an object.
#[derive(Debug, Clone, Copy)]
pub struct SlidingWay {
    /// The whole of it.
    pub slide: Slide,
    /// How much of it the arm must follow, metres.
    pub least_m: f64,
}

/// The arm's way: down behind the object, to the contact, along with it.
pub(super) struct ArmWay<J> {
    base: [f64; 3],
    /// From high above the standoff point down to it.
    down: Vec<J>,
    /// At the contact.
    contact: J,
    /// Along the way as far as the arm reaches.
    along: Line<J>,
}

/// What fingers may touch that make `object` slide.
pub fn contacts(object: ObjectId) -> Contacts {
    Contacts { fingers: Some((object, TouchReason::Push)), support: None }
}

/// Retreat, transit to above the standoff point, straight down, and the slide as far as the arm reaches, from a base that
/// `accepts` likes. Nothing in the way of the object is asked about; the room of the hand and the arm is.
///
/// # Errors
/// [`Infeasible::NoContact`] if the hand cannot come to stand at the object, [`Infeasible::Unreachable`],
/// [`Infeasible::Blocked`] if every stance of the robot meets something.
pub fn slide<M: Manipulator>(
    m: &Tabletop<M>,
    from: &TabletopState<M>,
    hand: &SlidingHand,
    way: &SlidingWay,
    accepts: impl Fn(&Configuration<M::Joints>) -> bool,
    rng: &mut dyn Rng,
) -> Result<Instances<Tabletop<M>>, Infeasible> {
    let at_work = at_work(m, from, rng);
    let beside = at_work.mode.opened_to(hand.gap_m).and_then(|mode| mode.engaged_with(hand.object));
    let mut probe = Probe::new(m, &at_work, beside.ok_or(Infeasible::NoContact)?);
    let mut chain = Chain::at(from);
    retreat(m, &mut chain, m.settings().retreat_m)?;
    let arm_way = find(m, &at_work, (hand, way), &mut probe, accepts, rng)?;
    assemble(m, chain, (hand, way), &arm_way, rng)
}

/// A stance of the robot from which the arm does it.
pub(super) fn find<M: Manipulator>(
    m: &Tabletop<M>,
    from: &TabletopState<M>,
    (hand, way): (&SlidingHand, &SlidingWay),
    probe: &mut Probe<'_, M>,
    accepts: impl Fn(&Configuration<M::Joints>) -> bool,
    rng: &mut dyn Rng,
) -> Result<ArmWay<M::Joints>, Infeasible> {
    let wanted = Wanted { world_from_tool: &hand.at_contact, tries: m.settings().base_tries, base: None };
    stance(m, from, &wanted, rng, |q, care| {
        if accepts(q) { arm_way(m, q, (hand, way), probe, care) } else { Err(Refused::Unreachable) }
    })
}

/// The arm's way from a configuration at the contact, if it reaches far enough and its cornerstones are clear.
fn arm_way<M: Manipulator>(
    m: &Tabletop<M>,
    q: &Configuration<M::Joints>,
    (hand, way): (&SlidingHand, &SlidingWay),
    probe: &mut Probe<'_, M>,
    care: &mut Care,
) -> Result<ArmWay<M::Joints>, Refused<M>> {
    let touching = contacts(hand.object);
    probe.check(q, &touching, care)?;
    // The first step decides most often, so it is tried before anything else.
    let object_from_tool = way.slide.from().inverse() * hand.at_contact;
    let along = follow_path(m, &q.base, &q.arm, way.slide.length_m(), |share| way.slide.at(share) * object_from_tool);
    let end = way.slide.at(along.share());
    // It would be left too near to an edge.
    let is_inside = m.keeps_from_edge(hand.object, hand.on, &Point2::from(end.translation.vector.xy()));
    if along.reached_m() < way.least_m - ROUNDING_M || !is_inside {
        return Err(Refused::Unreachable);
    }
    probe.place(hand.object, &end);
    let moved_along = probe.check(&at_end(q.base, &along.arms)?, &touching, care);
    probe.place(hand.object, way.slide.from());
    moved_along?;
    let mut is_clear = |q: &Configuration<M::Joints>| probe.check(q, &Contacts::default(), care);
    let back = follow_in_room(m, q, &hand.at_contact, &-hand.ahead, hand.standoff_m, &mut is_clear)?;
    let standoff = at_end(q.base, &back.arms)?;
    let behind = moved(&hand.at_contact, &-hand.ahead, back.reached_m());
    let up = follow_in_room(m, &standoff, &behind, &-hand.down, hand.approach_m, &mut is_clear)?;
    let down = up.arms.iter().rev().copied().chain([standoff.arm]).collect();
    Ok(ArmWay { base: q.base, down, contact: q.arm, along })
}

/// The instances, after a hand that has retreated already.
pub(super) fn assemble<M: Manipulator>(
    m: &Tabletop<M>,
    mut chain: Chain<M>,
    (hand, way): (&SlidingHand, &SlidingWay),
    arm_way: &ArmWay<M::Joints>,
    rng: &mut dyn Rng,
) -> Result<Instances<Tabletop<M>>, Infeasible> {
    let object = hand.object;
    approach(m, &mut chain, object, arm_way.base, &arm_way.down, hand.gap_m, Contacts::default(), rng)?;

    let robot = |arm: &M::Joints| Configuration { base: arm_way.base, arm: *arm };
    let reached = arm_way.along.share();
    let contact = Waypoint { robot: robot(&arm_way.contact), pushed: 0.0 };
    let along = arm_way.along.arms.iter().zip(&arm_way.along.shares);
    let waypoints: Vec<_> = std::iter::once(contact)
        .chain(along.map(|(arm, share)| Waypoint { robot: robot(arm), pushed: share / reached }))
        .collect();
    let mode = chain.end.mode.clone();
    let carried = Carried::Pushed(object, way.slide.at(reached));
    let motion = ArmMotion::new(m, &chain.end, &waypoints, carried, mode.clone(), mode);
    let instance = Instance {
        primitive: hand.primitive,
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
///
/// # Errors
/// [`Infeasible::Unreachable`] without arms, [`Infeasible::NoContact`] if the hand holds something or the object does not rest.
#[expect(clippy::too_many_arguments, reason = "the approach is one motion with these independent facts")]
pub fn approach<M: Manipulator>(
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
    let opened = chain.end.mode.opened_to(gap_m).map(|mode| mode.with_hand(first.hand_at_work()));
    let mode = opened.and_then(|mode| mode.engaged_with(object)).ok_or(Infeasible::NoContact)?;
    let waypoints: Vec<_> =
        rest.iter().map(|arm| Waypoint { robot: Configuration { base, arm: *arm }, pushed: 0.0 }).collect();
    let mut instance =
        super::travel::carry(m, chain, &waypoints, &mode, primitive::STRAIGHT_LINE_ARM_TRANSIT, contacts);
    instance.object = Some(object);
    chain.push(m, instance);
    Ok(())
}
