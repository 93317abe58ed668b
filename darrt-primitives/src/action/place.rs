//! Setting the held object down on a surface and letting go.

use darrt_core::domain::Domain;
use darrt_core::motion::Instance;
use darrt_core::primitive::{Infeasible, Instances};
use darrt_core::state::{ComponentId, ComponentSet, ObjectId};
use nalgebra::{Isometry3, Point2, Vector3};
use rand::{Rng, RngExt};

use super::Chain;
use super::line::{follow_in_room, room_for_hand};
use super::retreat::retreat;
use super::stance::{Care, Probe, Refused, Wanted, stance};
use super::travel::travel;
use super::turned::turned;
use crate::arm_motion::{ArmMotion, Carried, Waypoint};
use crate::length_range::LengthRange;
use crate::manipulator::{Configuration, Manipulator};
use crate::mode::{Contacts, Held, SurfaceId, TouchReason};
use crate::object_space::upright;
use crate::primitive;
use crate::tabletop::{Tabletop, TabletopState};

/// A target whose bottom is this near to a surface is meant to stand on it; metres (the authors' `TABLE_CONTAINS`).
pub const ON_SURFACE_M: f64 = 0.05;

/// The arm's way of one place.
struct PlacePath<J> {
    base: [f64; 3],
    /// From the preplace pose to where the object stands.
    down: Vec<J>,
}

/// Transfer to above the place, straight in, let go, and retreat.
///
/// `target` is the pose of the held object; for a round object its yaw is free and drawn anew.
///
/// # Errors
/// [`Infeasible::NoGrasp`] if nothing is held, [`Infeasible::OffSupport`] if the target does not lie on a surface
/// allowed for the object or is nearer to its edge than the object may be left
/// ([`edge_margin_m`](Tabletop::edge_margin_m)), [`Infeasible::Blocked`], [`Infeasible::Unreachable`].
pub fn place<M: Manipulator>(
    m: &Tabletop<M>,
    from: &TabletopState<M>,
    target: &Isometry3<f64>,
    rng: &mut dyn Rng,
) -> Result<Instances<Tabletop<M>>, Infeasible> {
    let held = *from.mode.held().ok_or(Infeasible::NoGrasp)?;
    let surface = m.surface_under(held.object, target, ON_SURFACE_M).ok_or(Infeasible::OffSupport)?;
    if !m.keeps_from_edge(held.object, surface, &Point2::from(target.translation.vector.xy())) {
        return Err(Infeasible::OffSupport);
    }
    let directions = &m.settings().place.approach_directions;
    let down = match directions.len() {
        0 => -Vector3::z(),
        n => directions.get(rng.random_range(0..n)).copied().unwrap_or(-Vector3::z()),
    };
    let released = from.mode.released_on(surface, release_gap_m(m, from)).ok_or(Infeasible::NoGrasp)?;
    let mut why = None;
    let mut in_the_way = None;
    let mut before = Probe::new(m, from, from.mode.clone());
    let mut after = Probe::new(m, from, released);
    let letting_go = contacts(held.object, surface);
    let mut clear = 0;
    for draw in 0..YAW_DRAWS {
        // At first hand and object are to have all the room that is wanted, then what they need.
        let care = if draw < YAW_DRAWS / 2 { m.collision_scene().most_care() } else { 0 };
        let standing = standing_pose(m, &held, surface, target, rng).ok_or(Infeasible::OffSupport)?;
        let object_from_tool = held.tool_from_object.inverse();
        let standing = turned(m, (held.object, from.mode.hand()), &from.robot.base, &standing, &object_from_tool, rng);
        let at_place = standing * object_from_tool;
        before.place(held.object, &standing);
        after.place(held.object, &standing);
        // With the fingers closed as much as opened: the lower one moves beside the surface when it lets go.
        if let Some(probe) =
            [&before, &after].into_iter().find(|probe| !probe.is_hand_clear(&at_place, &letting_go, care))
        {
            // What it is, is found out once.
            in_the_way = in_the_way.or_else(|| probe.check_hand(&at_place, &letting_go).err());
            continue;
        }
        let none = Contacts::default();
        let above = room_for_hand(m, m.settings().place.approach_m, &at_place, &-down, |at, care| {
            before.place(held.object, &(at * held.tool_from_object));
            before.is_hand_clear(at, &none, care)
        });
        let approach_m = match above {
            Ok(approach_m) => approach_m,
            Err(at) => {
                in_the_way = in_the_way.or_else(|| before.check_hand(&at, &none).err());
                continue;
            }
        };
        clear += 1;
        let tries = m.settings().base_tries.div_ceil(2);
        let wanted = Wanted { world_from_tool: &at_place, tries, base: None };
        let way = stance(m, from, &wanted, rng, |q, care| {
            after.check(q, &letting_go, care)?;
            way_of(m, q, &at_place, &down, approach_m, &mut before, care)
        });
        match way {
            Ok(way) => return assemble(m, from, &held, surface, &way, rng),
            Err(refused) => why = Some(refused),
        }
        if clear >= m.settings().grasp_tries {
            break;
        }
    }
    Err(why.or(in_the_way.map(Infeasible::Blocked)).unwrap_or(Infeasible::Unreachable))
}

/// How many turns of the object are drawn: the fingers must find room beside the surface, and at the corner of a table
/// few degrees are left to them.
const YAW_DRAWS: usize = 100;

/// How far the fingers open to let go.
fn release_gap_m<M: Manipulator>(m: &Tabletop<M>, from: &TabletopState<M>) -> f64 {
    (from.mode.gap_m() + m.settings().place.release_opening_m)
        .min(m.manipulator().hand_of(from.mode.hand()).max_gap_m())
}

/// Upright on the surface over the target's x and y.
fn standing_pose<M: Manipulator>(
    m: &Tabletop<M>,
    held: &Held,
    surface: SurfaceId,
    target: &Isometry3<f64>,
    rng: &mut dyn Rng,
) -> Option<Isometry3<f64>> {
    let space = m.objects().get(held.object.index())?;
    let z = m.surface(surface)?.height() + m.movable(held.object)?.half_height_m;
    let yaw = if space.is_round() {
        rng.random_range(-std::f64::consts::PI..std::f64::consts::PI)
    } else {
        target.rotation.euler_angles().2
    };
    Some(upright(Vector3::new(target.translation.x, target.translation.y, z), yaw))
}

fn way_of<M: Manipulator>(
    m: &Tabletop<M>,
    q: &Configuration<M::Joints>,
    at_place: &Isometry3<f64>,
    direction: &Vector3<f64>,
    approach_m: LengthRange,
    before: &mut Probe<'_, M>,
    care: &mut Care,
) -> Result<PlacePath<M::Joints>, Refused<M>> {
    let none = Contacts::default();
    let out = follow_in_room(m, q, at_place, &-direction, approach_m, |q| before.check(q, &none, care))?;
    let down = out.arms.iter().rev().copied().chain([q.arm]).collect();
    Ok(PlacePath { base: q.base, down })
}

/// What may touch while the object is set down and let go.
fn contacts(object: ObjectId, surface: SurfaceId) -> Contacts {
    Contacts { fingers: Some((object, TouchReason::Grasp)), support: Some((object, surface)) }
}

fn assemble<M: Manipulator>(
    m: &Tabletop<M>,
    from: &TabletopState<M>,
    held: &Held,
    surface: SurfaceId,
    way: &PlacePath<M::Joints>,
    rng: &mut dyn Rng,
) -> Result<Instances<Tabletop<M>>, Infeasible> {
    let mut chain = Chain::at(from);
    let (first, rest) = way.down.split_first().ok_or(Infeasible::Unreachable)?;
    let base = way.base;
    travel(m, &mut chain, &Configuration { base, arm: *first }, from.mode.gap_m(), rng);

    let gap_m = release_gap_m(m, from);
    let after = chain.end.mode.released_on(surface, gap_m).ok_or(Infeasible::NoGrasp)?;
    let waypoints: Vec<_> =
        rest.iter().map(|arm| Waypoint { robot: Configuration { base, arm: *arm }, pushed: 0.0 }).collect();
    let during = chain.end.mode.clone();
    let motion = ArmMotion::new(m, &chain.end, &waypoints, Carried::Held(*held), during, after);
    let instance = Instance {
        primitive: primitive::PLACE,
        motion: Box::new(motion),
        contacts: contacts(held.object, surface),
        moves: ComponentSet::ROBOT.with(ComponentId::Object(held.object)),
        object: Some(held.object),
        reversible: false,
    };
    chain.push(m, instance);
    retreat(m, &mut chain, m.settings().place.retreat_m)?;
    chain.finish()
}
