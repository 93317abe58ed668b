//! Where the goal puts an object near to something, a plan must come as near.

use nalgebra::{Isometry3, UnitQuaternion, Vector3};

use super::margins::Placed;
use super::stage::Stage;
use super::world::World;
use crate::problem_file::{GoalTarget, ObjectGoal, ProblemFile};

/// Lets every object that has one place as its goal be as near to what is around that place as it is there, among the other
/// objects at `starts` or at their own first goals.
pub(super) fn at_goals(
    problem: &ProblemFile,
    world: &World<'_>,
    starts: &[Isometry3<f64>],
    stage: &mut Stage,
) -> Vec<Placed> {
    let goals = problem.goal.by_object();
    let named = goals.iter().filter_map(|(name, goals)| Some((world.object(name)?, goals)));
    let places: Vec<(usize, Vec<_>)> = named
        .map(|(object, goals)| (object, goals.iter().filter_map(|goal| place(world, object, goal, starts)).collect()))
        .collect();
    let mut ends = starts.to_vec();
    for (object, places) in &places {
        if let (Some(slot), Some((pose, _))) = (ends.get_mut(*object), places.first()) {
            *slot = *pose;
        }
    }
    let mut found = Vec::new();
    for (object, places) in &places {
        for (pose, surface) in places {
            for others in [starts, &ends] {
                let carries = |fixed| surface.is_some_and(|surface| world.carries(*object, surface, fixed));
                found.extend(stage.accept_at(*object, pose, carries, others));
            }
        }
    }
    found
}

/// Where a goal puts its object, and on which surface; `None` for a region, which has many places.
fn place(
    world: &World<'_>,
    object: usize,
    goal: &ObjectGoal,
    starts: &[Isometry3<f64>],
) -> Option<(Isometry3<f64>, Option<usize>)> {
    let movable = world.movables.get(object)?;
    let yaw = goal.yaw.or_else(|| starts.get(object).map(|start| start.rotation.euler_angles().2))?;
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw);
    match goal.target()? {
        GoalTarget::On { surface, at } => {
            let index =
                movable.surfaces.iter().copied().find(|i| world.surface(*i).is_some_and(|s| s.name() == surface))?;
            let z = world.surface(index)?.height() + movable.depth_below_origin;
            Some((Isometry3::from_parts(Vector3::new(at[0], at[1], z).into(), turn), Some(index)))
        }
        GoalTarget::At { position } => Some((Isometry3::from_parts(Vector3::from(position).into(), turn), None)),
        GoalTarget::Within { .. } => None,
    }
}
