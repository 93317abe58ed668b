//! What a partial target asks of a state: the questions that every `useful` is made of.

use darrt_core::domain::Domain;
use darrt_core::partial::PartialState;
use darrt_core::primitive::Infeasible;
use darrt_core::space::GroupSet;
use darrt_core::state::ObjectId;
use nalgebra::{Isometry3, Point2, Vector3};
use rand::{Rng, RngExt};

use crate::action::place::ON_SURFACE_M;
use crate::goal::UPRIGHT_TOLERANCE_RAD;
use crate::manipulator::Manipulator;
use crate::mobile_arm_space::{ARM, BASE};
use crate::mode::SurfaceId;
use crate::object_space::OBJECT_TOLERANCE_M;
use crate::tabletop::{Tabletop, TabletopState};

/// A target for objects and robot of a table-top domain.
pub type Target<M> = PartialState<Tabletop<M>>;

/// Does the target name this group of the robot, and is the robot elsewhere?
pub fn asks_for_group<M: Manipulator>(from: &TabletopState<M>, to: &Target<M>, group: GroupSet) -> bool {
    to.robot().is_some_and(|target| {
        target.groups.covers(group)
            && ((group.covers(BASE) && target.config.base != from.robot.base)
                || (group.covers(ARM) && target.config.arm != from.robot.arm))
    })
}

/// Where the target wants the base, if it names it.
pub fn named_base<M: Manipulator>(to: &Target<M>) -> Option<[f64; 3]> {
    to.robot().filter(|target| target.groups.covers(BASE)).map(|target| target.config.base)
}

/// Named objects that are not where they should be and that pass `test`.
pub fn unmet_objects<'a, M: Manipulator>(
    m: &'a Tabletop<M>,
    from: &'a TabletopState<M>,
    to: &'a Target<M>,
    test: impl Fn(ObjectId, &Isometry3<f64>) -> bool + 'a,
) -> impl Iterator<Item = (ObjectId, &'a Isometry3<f64>)> + 'a {
    to.objects().filter(move |(id, target)| !to.is_object_met(m, from, *id) && test(*id, target))
}

/// One of those, at random.
pub fn random_unmet_object<'a, M: Manipulator>(
    m: &'a Tabletop<M>,
    from: &'a TabletopState<M>,
    to: &'a Target<M>,
    test: impl Fn(ObjectId, &Isometry3<f64>) -> bool + Copy + 'a,
    rng: &mut dyn Rng,
) -> Option<(ObjectId, &'a Isometry3<f64>)> {
    one_of(|| unmet_objects(m, from, to, test), rng)
}

/// One of what `all` names, at random.
fn one_of<T, I: Iterator<Item = T>>(all: impl Fn() -> I, rng: &mut dyn Rng) -> Option<T> {
    let count = all().count();
    if count == 0 { None } else { all().nth(rng.random_range(0..count)) }
}

/// Does `object` rest, may it be pushed, and does the target ask for another place in the plane? To a place that is not on
/// its surface it is pushed only if that may help: what can be grasped wherever it stands is better picked up at once.
pub fn asks_to_push<M: Manipulator>(
    m: &Tabletop<M>,
    from: &TabletopState<M>,
    object: ObjectId,
    target: &Isometry3<f64>,
) -> bool {
    let (Some(on), Some(movable)) = (from.mode.support_of(object), m.movable(object)) else { return false };
    let is_there = || m.keeps_from_edge(object, on, &Point2::from(target.translation.vector.xy()));
    let helps = || is_there() || movable.grasps.iter().all(|family| family.needs_overhang());
    let moves = from.object(object).is_some_and(|pose| {
        (pose.translation.vector.xy() - target.translation.vector.xy()).norm() > OBJECT_TOLERANCE_M
    });
    movable.is_pushable && moves && helps()
}

/// The objects that an empty hand is asked to push, and where to; none if something is held.
pub fn objects_to_push<'a, M: Manipulator>(
    m: &'a Tabletop<M>,
    from: &'a TabletopState<M>,
    to: &'a Target<M>,
) -> impl Iterator<Item = (ObjectId, &'a Isometry3<f64>)> + 'a {
    let is_empty = from.mode.held().is_none();
    unmet_objects(m, from, to, move |id, pose| is_empty && asks_to_push(m, from, id, pose))
}

/// One of those, at random.
///
/// # Errors
/// [`Infeasible::NoProgress`] if there is none.
pub fn object_to_push<'a, M: Manipulator>(
    m: &'a Tabletop<M>,
    from: &'a TabletopState<M>,
    to: &'a Target<M>,
    rng: &mut dyn Rng,
) -> Result<(ObjectId, &'a Isometry3<f64>), Infeasible> {
    one_of(|| objects_to_push(m, from, to), rng).ok_or(Infeasible::NoProgress)
}

/// Does `object` rest, and can it be grasped at all?
pub fn asks_to_pick<M: Manipulator>(m: &Tabletop<M>, from: &TabletopState<M>, object: ObjectId) -> bool {
    from.mode.support_of(object).is_some() && m.movable(object).is_some_and(|o| !o.grasps.is_empty())
}

/// The pose in the air that the target asks the held object to take, if that is what it asks. What is a little above a surface
/// may be meant so, or [to stand on it](held_target_on_surface): only what stands for certain is not in the air.
pub fn held_target_in_air<'a, M: Manipulator>(
    m: &Tabletop<M>,
    from: &TabletopState<M>,
    to: &'a Target<M>,
) -> Option<&'a Isometry3<f64>> {
    let held = from.mode.held()?.object;
    let target = to.object(held)?;
    let in_air = surface_of_target(m, held, target, OBJECT_TOLERANCE_M).is_none();
    (in_air && !to.is_object_met(m, from, held)).then_some(target)
}

/// The pose on a surface that the target asks the held object to take, if that is what it asks.
pub fn held_target_on_surface<'a, M: Manipulator>(
    m: &Tabletop<M>,
    from: &TabletopState<M>,
    to: &'a Target<M>,
) -> Option<&'a Isometry3<f64>> {
    let held = from.mode.held()?.object;
    let target = to.object(held)?;
    surface_of_target(m, held, target, ON_SURFACE_M).map(|_| target)
}

/// The surface within `slack_m` under an object at `target`. What leans does not stand, however near the surface is:
/// it could only be set down upright, away from its target.
fn surface_of_target<M: Manipulator>(
    m: &Tabletop<M>,
    object: ObjectId,
    target: &Isometry3<f64>,
    slack_m: f64,
) -> Option<SurfaceId> {
    let up = target.rotation * Vector3::z();
    let leans = up.xy().norm() > UPRIGHT_TOLERANCE_RAD || up.z < 0.0;
    if leans { None } else { m.surface_under(object, target, slack_m) }
}

/// Is something held that the target does not name, while another object has to be moved? The hand must be emptied.
pub fn asks_for_empty_hand<M: Manipulator>(m: &Tabletop<M>, from: &TabletopState<M>, to: &Target<M>) -> bool {
    let Some(held) = from.mode.held() else { return false };
    to.object(held.object).is_none() && !to.are_objects_met(m, from)
}

/// Is something held, are all named objects met and is the held one free to go anywhere?
pub fn may_carry_along<M: Manipulator>(m: &Tabletop<M>, from: &TabletopState<M>, to: &Target<M>) -> bool {
    from.mode.held().is_some_and(|held| to.object(held.object).is_none()) && to.are_objects_met(m, from)
}

/// A random place on a surface on which `object` may stand, far enough from its edge to be left there.
pub fn random_standing_pose<M: Manipulator>(
    m: &Tabletop<M>,
    object: ObjectId,
    rng: &mut dyn Rng,
) -> Option<Isometry3<f64>> {
    let allowed = &m.movable(object)?.surfaces;
    if allowed.is_empty() {
        return None;
    }
    let surface = m.surface(*allowed.get(rng.random_range(0..allowed.len()))?)?;
    let at = surface.sample(rng, m.settings().safety.edge_margin_m)?;
    Some(m.objects().get(object.index())?.standing(surface, &at, rng.random_range(-3.0..3.0)))
}
