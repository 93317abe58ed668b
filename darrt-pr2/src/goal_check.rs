//! Can the objects be at their goal at all? Asked once, before the search, so that an impossible goal is an error with
//! a name instead of a search without end.

use darrt_core::goal::Goal;
use darrt_core::random::{Purpose, stream};
use darrt_geom::clearance::between;
use darrt_geom::scene::Scene;
use darrt_primitives::goal::TabletopGoal;
use nalgebra::Isometry3;

use crate::planning_error::PlanningError;
use crate::world::World;

/// How many samples of an infinite goal are tried before it counts as blocked.
const SAMPLES: u64 = 64;

/// Checks that some goal pose of every named object is free of the fixed bodies.
///
/// # Errors
/// [`PlanningError::GoalBlocked`] with the object and what is in the way.
pub fn check_goal(m: &World, goal: &TabletopGoal, scene: &Scene) -> Result<(), PlanningError> {
    let mut blocked = None;
    for i in 0..SAMPLES {
        let Some(target) = goal.sample(m, &mut stream(0, 0, i, Purpose::Attempt)) else { return Ok(()) };
        let found = target.objects().find_map(|(id, pose)| {
            let movable = m.movable(id)?;
            let what = in_the_way(m, id, pose, scene)?;
            Some(PlanningError::GoalBlocked { object: movable.body.name.to_string(), blame: what })
        });
        match found {
            None => return Ok(()),
            Some(error) => blocked = Some(error),
        }
    }
    blocked.map_or(Ok(()), Err)
}

/// The fixed body that an object at `pose` would touch, other than what it stands on.
fn in_the_way(m: &World, id: darrt_core::state::ObjectId, pose: &Isometry3<f64>, scene: &Scene) -> Option<String> {
    let movable = m.movable(id)?;
    let under = m.surface_under(id, pose, 1e-6).and_then(|s| m.supports().get(s.index()));
    let stands_on = |name: &str| under.is_some_and(|s| s.bodies.iter().any(|b| &**b == name));
    scene.bodies().iter().filter(|fixed| !stands_on(&fixed.body.name)).find_map(|fixed| {
        let gap = between(&movable.body, pose, &fixed.body, &fixed.world_from_body);
        let touches = gap.is_ok_and(|gap| gap.distance < -1e-9);
        let [x, y, z] = <[f64; 3]>::from(pose.translation.vector);
        touches.then(|| format!("at ({x:.3}, {y:.3}, {z:.3}) it touches `{}`", fixed.body.name))
    })
}
