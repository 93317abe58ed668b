//! Grasping an object and lifting it from its support.

use darrt_core::motion::Instance;
use darrt_core::primitive::{Infeasible, Instances};
use darrt_core::state::{ComponentId, ComponentSet, ObjectId};
use nalgebra::{Isometry3, Point2, Vector3};
use rand::{Rng, RngExt};

use super::Chain;
use super::at_work::at_work;
use super::line::{self, follow_in_room, room_for_hand};
use super::retreat::retreat;
use super::slide::approach;
use super::stance::{Care, Probe, Refused, Wanted, at_end, stance};
use super::turned::turned;
use crate::arm_motion::{ArmMotion, Carried, Waypoint};
use crate::grasp::hold::Hold;
use crate::grasp::rim::{rim_is_graspable, rim_overhangs};
use crate::grasp::{Grasp, GraspFamily, GraspKind};
use crate::manipulator::{Configuration, JointVector as _, Manipulator};
use crate::mode::{Contacts, Held, TouchReason};
use crate::primitive;
use crate::tabletop::{Movable, Tabletop, TabletopState};

/// The arm's way of one pick.
struct PickPath<J> {
    base: [f64; 3],
    /// From the pregrasp pose to the grasp.
    in_: Vec<J>,
    /// From the grasp up.
    up: Vec<J>,
}

/// Retreat, transit to the pregrasp pose, straight in, attach and lift.
///
/// # Errors
/// [`Infeasible::NoGrasp`] if no grasp fits where the object stands (a plate whose rim does not overhang),
/// [`Infeasible::NoHold`] if none of those that fit holds its weight, [`Infeasible::Blocked`] or [`Infeasible::Unreachable`] if the arm comes to none of those tried.
pub fn pick<M: Manipulator>(
    m: &Tabletop<M>,
    from: &TabletopState<M>,
    object: ObjectId,
    rng: &mut dyn Rng,
) -> Result<Instances<Tabletop<M>>, Infeasible> {
    let movable = m.movable(object).ok_or(Infeasible::NoGrasp)?;
    let pose = from.object(object).ok_or(Infeasible::NoGrasp)?;
    let overhangs = overhangs(m, from, object, movable, pose);
    if movable.grasps.iter().all(|family| family.needs_overhang() && !overhangs) {
        return Err(Infeasible::NoGrasp);
    }
    let mut chain = Chain::at(from);
    retreat(m, &mut chain, m.settings().retreat_m)?;
    let at_work = &*at_work(m, from, rng);
    let hand = at_work.robot.arm.hand_at_work();
    let beside = at_work.mode.engaged_with(object).ok_or(Infeasible::NoGrasp)?;
    let mut fitted = 0;
    let mut why = Infeasible::NoGrasp;
    let draws = m.settings().grasp_tries * GRASPS_PER_TRY;
    for draw in 0..draws {
        // At first the hand is to have all the room that is wanted, then what it needs.
        let care = if draw < draws / 2 { m.collision_scene().most_care() } else { 0 };
        let Some(family) = movable.grasps.get(rng.random_range(0..movable.grasps.len())) else { continue };
        if family.needs_overhang() && !overhangs {
            continue;
        }
        let Some(mut grasp) = drawn_grasp(m, hand, &**family, rng) else { continue };
        grasp.open_gap_m = grasp.open_gap_m.min(m.manipulator().hand_of(hand).max_gap_m());
        let seen = turned(m, (object, hand), &from.robot.base, pose, &grasp.object_from_tool, rng);
        if !fits(m, from, object, movable, &seen, &grasp) {
            continue;
        }
        let Ok(hold) = m.hold(hand, movable, &**family, &grasp) else {
            why = Infeasible::NoHold;
            continue;
        };
        let at_grasp = grasp.world_from_tool(&seen);
        let tries = m.settings().base_tries.div_ceil(2);
        let wanted = Wanted { world_from_tool: &at_grasp, tries, base: None };
        let mode = beside.opened_to(grasp.open_gap_m).ok_or(Infeasible::NoGrasp)?;
        let mut probe = Probe::new(m, at_work, mode);
        let open = straddling(object, &grasp);
        if let Err(blame) = probe.check_hand(&at_grasp, &open) {
            why = Infeasible::Blocked(blame);
            continue;
        }
        if care > 0 && !probe.is_hand_clear(&at_grasp, &open, care) {
            continue;
        }
        let (back, none) = (at_grasp.rotation * -Vector3::x(), Contacts::default());
        let out = |at: &Isometry3<f64>, care| probe.is_hand_clear(at, &none, care);
        match room_for_hand(m, grasp.approach_m, &at_grasp, &back, out) {
            Ok(approach_m) => grasp.approach_m = approach_m,
            Err(at) => {
                why = probe.check_hand(&at, &none).err().map_or(why, Infeasible::Blocked);
                continue;
            }
        }
        fitted += 1;
        let picking = Picking { object, pose, grasp: &grasp, hold, at_grasp: &at_grasp };
        match stance(m, at_work, &wanted, rng, |q, care| way_of(m, q, &picking, movable, &mut probe, care)) {
            Ok(way) => return assemble(m, chain, &picking, &way, rng),
            Err(refused) => why = refused,
        }
        if fitted >= m.settings().grasp_tries {
            break;
        }
    }
    Err(why)
}

/// What is picked up, and how.
struct Picking<'a> {
    object: ObjectId,
    pose: &'a Isometry3<f64>,
    grasp: &'a Grasp,
    hold: Hold,
    at_grasp: &'a Isometry3<f64>,
}

impl Picking<'_> {
    /// The object in the hand.
    fn held(&self, tool_from_object: Isometry3<f64>) -> Held {
        Held { object: self.object, tool_from_object, max_tilt_rad: self.hold.max_tilt_rad }
    }
}

/// A grasp of the family for one of the robot's hands, which may be tilted as it likes, or one of its grid for which the hand is tilted as it is, the
/// object upright; `None` where there is none.
pub fn drawn_grasp<M: Manipulator>(
    m: &Tabletop<M>,
    hand: usize,
    family: &dyn GraspFamily,
    rng: &mut dyn Rng,
) -> Option<Grasp> {
    let ties = m.manipulator().hand_ties_of(hand);
    if ties.up_in_tool.is_none() {
        return Some(family.sample(rng));
    }
    let mut fitting = family.grid();
    fitting.retain(|grasp| ties.allow_tilt(&grasp.object_from_tool));
    let index = rng.random_range(0..fitting.len().max(1));
    fitting.get(index).copied()
}

/// How many grasps are drawn for one that is tried: most rim grasps meet the table.
const GRASPS_PER_TRY: usize = 16;

/// Does no grasp of `object` fit where it stands, because all of them need its rim to overhang an edge and it does not?
pub fn lies_flat<M: Manipulator>(m: &Tabletop<M>, at: &TabletopState<M>, object: ObjectId) -> bool {
    let (Some(movable), Some(pose)) = (m.movable(object), at.object(object)) else { return false };
    movable.grasps.iter().all(|family| family.needs_overhang()) && !overhangs(m, at, object, movable, pose)
}

/// Does the rim stick out anywhere, so that it is worth asking where?
pub(super) fn overhangs<M: Manipulator>(
    m: &Tabletop<M>,
    from: &TabletopState<M>,
    object: ObjectId,
    movable: &Movable,
    pose: &Isometry3<f64>,
) -> bool {
    let Some(surface) = from.mode.support_of(object).and_then(|s| m.surface(s)) else { return true };
    let Some(radius) = movable.round_radius_m else { return false };
    let center = Point2::new(pose.translation.x, pose.translation.y);
    rim_overhangs(surface, &center, radius, movable.rim.insertion, movable.rim.clearance)
}

/// Could the fingers close here, as far as the object and its own support can tell?
fn fits<M: Manipulator>(
    m: &Tabletop<M>,
    from: &TabletopState<M>,
    object: ObjectId,
    movable: &Movable,
    pose: &Isometry3<f64>,
    grasp: &Grasp,
) -> bool {
    let GraspKind::Rim { azimuth, .. } = grasp.kind else { return true };
    let Some(surface) = from.mode.support_of(object).and_then(|s| m.surface(s)) else { return true };
    let Some(radius) = movable.round_radius_m else { return false };
    let yaw = pose.rotation.euler_angles().2;
    let center = Point2::new(pose.translation.x, pose.translation.y);
    rim_is_graspable(surface, &center, radius, azimuth + yaw, movable.rim.insertion, movable.rim.clearance)
}

fn way_of<M: Manipulator>(
    m: &Tabletop<M>,
    q: &Configuration<M::Joints>,
    picking: &Picking<'_>,
    movable: &Movable,
    probe: &mut Probe<'_, M>,
    care: &mut Care,
) -> Result<PickPath<M::Joints>, Refused<M>> {
    let Picking { object, grasp, at_grasp, .. } = *picking;
    let open = straddling(object, grasp);
    probe.check(q, &open, care)?;
    let (back, none) = (at_grasp.rotation * -Vector3::x(), Contacts::default());
    let out = follow_in_room(m, q, at_grasp, &back, grasp.approach_m, |q| probe.check(q, &none, care))?;
    let [least, best] = movable.lift_m;
    let up = line::follow(m, &q.base, &q.arm, at_grasp, &(Vector3::z() * best));
    if up.share() * best < least {
        return Err(Refused::Unreachable);
    }
    check_lifted(m, picking, &at_end(q.base, &up.arms)?, probe, care)?;
    let in_ = out.arms.iter().rev().copied().chain([q.arm]).collect();
    Ok(PickPath { base: q.base, in_, up: up.arms })
}

/// Is nothing in the way of the object and the hand at the end of the lift?
fn check_lifted<M: Manipulator>(
    m: &Tabletop<M>,
    picking: &Picking<'_>,
    lifted: &Configuration<M::Joints>,
    probe: &Probe<'_, M>,
    care: &mut Care,
) -> Result<(), Refused<M>> {
    let beside = probe.state().mode.clone();
    let held = picking.held(picking.at_grasp.inverse() * picking.pose);
    let mode = beside.attached(held, picking.grasp.closed_gap_m).ok_or(Refused::Unreachable)?;
    Probe::new(m, probe.state(), mode).check(lifted, &Contacts::default(), care)
}

fn assemble<M: Manipulator>(
    m: &Tabletop<M>,
    mut chain: Chain<M>,
    picking: &Picking<'_>,
    way: &PickPath<M::Joints>,
    rng: &mut dyn Rng,
) -> Result<Instances<Tabletop<M>>, Infeasible> {
    let Picking { object, pose, grasp, .. } = *picking;
    let support = chain.end.mode.support_of(object).ok_or(Infeasible::OffSupport)?;
    approach(m, &mut chain, object, way.base, &way.in_, grasp.open_gap_m, straddling(object, grasp), rng)?;

    // The grasp as the hand really stands, so that the object does not jump by a rounding error.
    let held = picking.held(m.manipulator().world_from_tool(&chain.end.robot).inverse() * pose);
    let mode = chain.end.mode.attached(held, grasp.closed_gap_m).ok_or(Infeasible::NoGrasp)?;
    let waypoints: Vec<_> =
        way.up.iter().map(|arm| Waypoint { robot: Configuration { base: way.base, arm: *arm }, pushed: 0.0 }).collect();
    let motion = ArmMotion::new(m, &chain.end, &waypoints, Carried::Held(held), mode.clone(), mode);
    let instance = Instance {
        primitive: primitive::PICK,
        motion: Box::new(motion),
        contacts: Contacts { fingers: Some((object, TouchReason::Grasp)), support: Some((object, support)) },
        moves: ComponentSet::ROBOT.with(ComponentId::Object(object)),
        object: Some(object),
        reversible: false,
    };
    chain.push(m, instance);
    chain.finish()
}

/// What the open fingers may touch around the object. A bowl's inner finger stands inside the solid that stands for the
/// bowl; every other grasp keeps clear until it closes.
pub(super) fn straddling(object: ObjectId, grasp: &Grasp) -> Contacts {
    match grasp.kind {
        GraspKind::Wall { .. } => Contacts { fingers: Some((object, TouchReason::Grasp)), support: None },
        _ => Contacts::default(),
    }
}
