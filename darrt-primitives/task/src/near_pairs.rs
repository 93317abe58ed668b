//! Bodies that the problem itself puts nearer to each other than the least margin: at the start, or where the goal puts an
//! object. What is there already, or is asked for, cannot be refused; it is told.

use darrt_core::state::ObjectId;
use darrt_primitives::action::place::ON_SURFACE_M;
use darrt_primitives::collision_scene::NearPair;
use darrt_primitives::goal::{ObjectGoal, TabletopGoal, Whereabouts};
use darrt_primitives::mode::{Mode, SurfaceId};
use darrt_primitives::object_space::upright;

use darrt_primitives::manipulator::Manipulator;
use darrt_primitives::tabletop::{Tabletop, TabletopState};

/// Lets such pairs be as near as they are there. A goal that is a region forces no place on an object and counts for nothing.
pub(crate) fn accept<M: Manipulator>(
    m: &mut Tabletop<M>,
    start: &TabletopState<M>,
    goal: &TabletopGoal<M::Joints>,
) -> Vec<NearPair> {
    let placed = |state: &TabletopState<M>, goal: &ObjectGoal| at_goal(m, state, goal);
    let each = goal.groups().iter().flatten().filter_map(|goal| placed(start, goal));
    // Of several objects also all at once, each at its first goal.
    let first = goal.groups().iter().filter_map(|alternatives| alternatives.first());
    let together = first.fold(start.clone(), |state, goal| placed(&state, goal).unwrap_or(state));
    let goals: Vec<_> = each.chain([together]).collect();
    let mut found = m.accept_near(start, &goals);
    // A pair that is near in several of these states is told once, as near as it comes; at the start if it is near there.
    found.sort_by(|a, b| {
        (&a.bodies, a.is_at_goal).cmp(&(&b.bodies, b.is_at_goal)).then(a.distance_m.total_cmp(&b.distance_m))
    });
    found.dedup_by(|a, b| a.bodies == b.bodies);
    found
}

/// `state` with one object where this goal puts it; `None` if it may be at many places.
fn at_goal<M: Manipulator>(m: &Tabletop<M>, state: &TabletopState<M>, goal: &ObjectGoal) -> Option<TabletopState<M>> {
    let Whereabouts::At(place) = &goal.whereabouts else { return None };
    let before = state.object(goal.object)?;
    let yaw = goal.yaw.map_or_else(|| before.rotation.euler_angles().2, |(yaw, _)| yaw);
    let mut pose = upright(*place, yaw);
    let surface = m.surface_under(goal.object, &pose, ON_SURFACE_M);
    if let Some(standing) = surface.and_then(|id| m.surface(id)) {
        pose.translation.z = standing.height() + m.movable(goal.object)?.half_height_m;
    }
    let rests_on = |i: usize| {
        let id = ObjectId::new(i);
        let goal_surface = surface.filter(|_| id == goal.object);
        goal_surface.or(state.mode.support_of(id)).unwrap_or(SurfaceId::new(usize::MAX))
    };
    let mut there = state.clone();
    there.mode = Mode::resting((0..state.objects.len()).map(rests_on), state.mode.gap_m());
    *there.objects.get_mut(goal.object.index())? = pose;
    Some(there)
}
