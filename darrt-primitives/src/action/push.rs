//! Pushing a round object along the ray through its centre.

use darrt_core::motion::Instance;
use darrt_core::primitive::{Infeasible, Instances};
use darrt_core::state::{ComponentId, ComponentSet, ObjectId};
use nalgebra::{Isometry3, Point2, Vector3};
use rand::{Rng, RngExt};

use super::retreat::retreat;
use super::stance::{Care, Probe, Refused, Wanted, at_end, stance};
use super::travel::travel;
use super::{Chain, label, line};
use crate::arm_motion::{ArmMotion, Carried, Waypoint};
use crate::contact::{HandStance, RimContact};
use crate::manipulator::{Configuration, Manipulator};
use crate::mode::{Contacts, TouchReason};
use crate::push::edge_stop::{EdgeStop, NoPush, PushEnd};
use crate::tabletop::{Tabletop, TabletopState};

/// A push that reaches less than this far, or than its whole length, is not worth the approach; metres.
const LEAST_PUSH_M: f64 = 0.02;

/// The arm's way of one push: down behind the object, to the contact, along the push.
struct Way<J> {
    base: [f64; 3],
    /// From high above the standoff point down to it.
    down: Vec<J>,
    /// At the contact.
    contact: J,
    /// Along the push as far as the arm reaches.
    along: line::Line<J>,
}

/// Share of the pushes that may take the object as near to other things as the rules allow; the others keep the wanted margin.
const CLOSE_SHARE: f64 = 0.25;

/// How far before what is in its way the object stops, metres.
const STOP_BEFORE_M: f64 = 0.01;

/// Retreat, transit to the pushing pose, straight down behind the object, and the push: to the object's target or, where
/// that lies off the support, to the edge; not so far if something stands in the object's way.
///
/// # Errors
/// [`Infeasible::NoContact`] for an object that cannot be pushed, [`Infeasible::OffSupport`] if the way leaves its
/// support, [`Infeasible::NoProgress`] if it is already as near as a push can bring it, [`Infeasible::Blocked`] if the
/// object or every stance of the robot meets something, [`Infeasible::Unreachable`].
pub fn push<M: Manipulator>(
    m: &Tabletop<M>,
    from: &TabletopState<M>,
    object: ObjectId,
    target: &Isometry3<f64>,
    rng: &mut dyn Rng,
) -> Result<Instances<Tabletop<M>>, Infeasible> {
    let settings = &m.settings().push;
    let movable = m.movable(object).filter(|o| o.is_pushable).ok_or(Infeasible::NoContact)?;
    let radius = movable.round_radius_m.ok_or(Infeasible::NoContact)?;
    if settings.fingertip_clearance_m >= 2.0 * movable.half_height_m {
        // The fingertips would pass above it.
        return Err(Infeasible::NoContact);
    }
    let surface = from.mode.support_of(object).and_then(|s| m.surface(s)).ok_or(Infeasible::OffSupport)?;
    let pose = from.object(object).ok_or(Infeasible::NoContact)?;

    let mut end = end_of_push(m, surface, pose, target, rng)?;
    let care = if rng.random_bool(CLOSE_SHARE) { 0 } else { m.surroundings().most_care() };
    shorten_to_free(m, from, object, &mut end, care)?;
    let hand = m.manipulator().hand();
    let contact =
        RimContact::new(radius, settings.gap_m, hand.tip_half_width_m()).map_err(|_| Infeasible::NoContact)?;
    let height = surface.height() + settings.fingertip_clearance_m + hand.tip_beyond_tool_m(settings.gap_m);
    let twin = HandStance { twin: rng.random_bool(0.5), ..HandStance::default() };
    let center = Point2::new(pose.translation.x, pose.translation.y);
    let at_contact =
        contact.world_from_tool(&center, &end.direction, height, &twin).map_err(|_| Infeasible::NoContact)?;

    let wanted = Wanted { world_from_tool: &at_contact, tries: m.settings().base_tries };
    let beside = from.mode.opened_to(settings.gap_m).and_then(|mode| mode.engaged_with(object));
    let mut probe = Probe::new(m, from, beside.ok_or(Infeasible::NoContact)?);
    let push = Pushing { object, pose, at_contact: &at_contact, end: &end };
    probe.check_hand(&at_contact, &contacts(object)).map_err(Infeasible::Blocked)?;
    let mut chain = Chain::at(from);
    retreat(m, &mut chain, m.settings().retreat_m)?;
    let way = stance(m, from, &wanted, rng, |q, care| way_of(m, q, &push, &mut probe, care))?;
    assemble(m, chain, &push, &way, rng)
}

/// What is pushed, from where, and how.
struct Pushing<'a> {
    object: ObjectId,
    pose: &'a Isometry3<f64>,
    at_contact: &'a Isometry3<f64>,
    end: &'a PushEnd,
}

impl Pushing<'_> {
    /// Where the object is when `share` of the push is done.
    fn pose_at(&self, share: f64) -> Isometry3<f64> {
        let mut pose = *self.pose;
        let flat = pose.translation.vector.xy();
        // The whole push ends exactly where it should: who pushes there again comes to the same state.
        let at = if share >= 1.0 { self.end.center.coords } else { flat.lerp(&self.end.center.coords, share) };
        (pose.translation.x, pose.translation.y) = (at.x, at.y);
        pose
    }
}

/// Ends the push before what stands in the object's way. This costs next to nothing and needs no arm.
fn shorten_to_free<M: Manipulator>(
    m: &Tabletop<M>,
    from: &TabletopState<M>,
    object: ObjectId,
    end: &mut PushEnd,
    care: usize,
) -> Result<(), Infeasible> {
    let way = Vector3::new(end.direction.x, end.direction.y, 0.0) * end.length;
    let (free_m, blame) = m.surroundings().free_slide(from, object, &way, care);
    if let Some(blame) = blame {
        let length = free_m - STOP_BEFORE_M;
        if length < LEAST_PUSH_M {
            return Err(Infeasible::Blocked(blame));
        }
        end.center -= end.direction.into_inner() * (end.length - length);
        end.length = length;
        end.limited_by_edge = false;
    }
    Ok(())
}

fn end_of_push<M: Manipulator>(
    m: &Tabletop<M>,
    surface: &darrt_geom::support::SupportSurface,
    pose: &Isometry3<f64>,
    target: &Isometry3<f64>,
    rng: &mut dyn Rng,
) -> Result<PushEnd, Infeasible> {
    let settings = &m.settings().push;
    let [least, most] = settings.edge_distance_m;
    let edge_distance = if least < most { rng.random_range(least..=most) } else { least };
    let stop = EdgeStop { rule: settings.edge_rule, target_margin: least, edge_distance };
    let flat = |p: &Isometry3<f64>| Point2::new(p.translation.x, p.translation.y);
    stop.end_of_push(surface, &flat(pose), &flat(target)).map_err(|why| match why {
        NoPush::NothingToDo => Infeasible::NoProgress,
        _ => Infeasible::OffSupport,
    })
}

/// The arm's way from a configuration at the contact, if it reaches far enough and its cornerstones are clear.
fn way_of<M: Manipulator>(
    m: &Tabletop<M>,
    q: &Configuration<M::Joints>,
    push: &Pushing<'_>,
    probe: &mut Probe<'_, M>,
    care: &mut Care,
) -> Result<Way<M::Joints>, Refused<M>> {
    let settings = &m.settings().push;
    let Pushing { at_contact, end, .. } = push;
    let touching = contacts(push.object);
    probe.check(q, &touching, care)?;
    let ahead = Vector3::new(end.direction.x, end.direction.y, 0.0);
    // The first step decides most often, so it is tried before anything else.
    let along = line::follow(m, &q.base, &q.arm, at_contact, &(ahead * end.length));
    if along.share() * end.length < LEAST_PUSH_M.min(end.length) {
        return Err(Refused::Unreachable);
    }
    probe.place(push.object, &push.pose_at(along.share()));
    let pushed = probe.check(&at_end(q.base, &along.arms)?, &touching, care);
    probe.place(push.object, push.pose);
    pushed?;
    let back = line::follow(m, &q.base, &q.arm, at_contact, &(-ahead * settings.standoff_m));
    let standoff = *back.arms.last().filter(|_| back.share() >= 1.0).ok_or(Refused::Unreachable)?;
    let mut behind = **at_contact;
    behind.translation.vector -= ahead * settings.standoff_m;
    let up = line::follow(m, &q.base, &standoff, &behind, &(Vector3::z() * settings.approach_m));
    if up.share() < m.settings().least_line_share {
        return Err(Refused::Unreachable);
    }
    probe.check(&at_end(q.base, &up.arms)?, &Contacts::default(), care)?;
    let down = up.arms.iter().rev().copied().chain([standoff]).collect();
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
    let object = push.object;
    approach(m, &mut chain, object, way.base, &way.down, m.settings().push.gap_m, Contacts::default(), rng)?;

    let robot = |arm: &M::Joints| Configuration { base: way.base, arm: *arm };
    let reached = way.along.share();
    let contact = Waypoint { robot: robot(&way.contact), pushed: 0.0 };
    let along = way.along.arms.iter().zip(&way.along.shares);
    let waypoints: Vec<_> = std::iter::once(contact)
        .chain(along.map(|(arm, share)| Waypoint { robot: robot(arm), pushed: share / reached }))
        .collect();
    let mode = chain.end.mode.clone();
    let carried = Carried::Pushed(object, push.pose_at(reached));
    let motion = ArmMotion::new(m, &chain.end, &waypoints, carried, mode.clone(), mode);
    let instance = Instance {
        label: label::PUSH,
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
    let mut instance = super::travel::carry(m, chain, &waypoints, &mode, label::STRAIGHT_LINE_ARM_TRANSIT, contacts);
    instance.object = Some(object);
    chain.push(m, instance);
    Ok(())
}
