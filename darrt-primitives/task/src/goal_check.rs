//! Can the objects be at their goal at all? Asked once, before the search, so that an impossible goal is an error with
//! a name instead of a search without end.

use darrt_core::goal::Goal;
use darrt_core::partial::PartialState;
use darrt_core::random::{Purpose, stream};
use darrt_core::state::ObjectId;
use darrt_geom::clearance::{Clearance, between};
use darrt_geom::scene::Scene;
use darrt_geom::support::FLUSH_HEIGHT;
use darrt_geom::{Body, FixedBody, GeomError, Shape};
use darrt_primitives::goal::TabletopGoal;
use nalgebra::{Isometry3, Translation3};

use crate::planning_error::PlanningError;
use darrt_primitives::manipulator::Manipulator;
use darrt_primitives::tabletop::Tabletop;

/// How many samples of an infinite goal are tried before it counts as blocked.
const SAMPLES: u64 = 64;
/// An object is looked at this far above its goal, metres, so that what it stands on is not in its way.
const LIFT: f64 = 1e-6;
/// What stands on one of several joined surfaces may be this far from the height of all, metres.
const ON_TOP: f64 = FLUSH_HEIGHT + 1e-6;
/// Solids that overlap less than this do not block, metres.
const ROUNDING: f64 = 1e-9;

/// Checks that some goal pose of every named object is free of the fixed bodies.
///
/// # Errors
/// [`PlanningError::GoalBlocked`] with the object and what is in the way; [`PlanningError::Geometry`] when that cannot
/// be said.
pub fn check_goal<M: Manipulator>(
    m: &Tabletop<M>,
    goal: &TabletopGoal<M::Joints>,
    scene: &Scene,
) -> Result<(), PlanningError> {
    let mut blocked = None;
    for i in 0..SAMPLES {
        let Some(target) = goal.sample(m, &mut stream(0, 0, i, Purpose::Attempt)) else { return Ok(()) };
        match first_blocked(m, &target, scene)? {
            None => return Ok(()),
            found => blocked = found,
        }
    }
    blocked.map_or(Ok(()), Err)
}

/// The first object of `target` that something fixed is in the way of.
fn first_blocked<M: Manipulator>(
    m: &Tabletop<M>,
    target: &PartialState<Tabletop<M>>,
    scene: &Scene,
) -> Result<Option<PlanningError>, GeomError> {
    for (id, pose) in target.objects() {
        let Some(movable) = m.movable(id) else { continue };
        if let Some(blame) = in_the_way(m, id, &movable.body, pose, scene)? {
            return Ok(Some(PlanningError::GoalBlocked { object: movable.body.name.to_string(), blame }));
        }
    }
    Ok(None)
}

/// The fixed body that `body` at `pose` would touch, other than what it stands on.
fn in_the_way<M: Manipulator>(
    m: &Tabletop<M>,
    id: ObjectId,
    body: &Body,
    pose: &Isometry3<f64>,
    scene: &Scene,
) -> Result<Option<String>, GeomError> {
    let under = m.surface_under(id, pose, ON_TOP).and_then(|s| m.supports().get(s.index()));
    let stands_on = |name: &str| under.is_some_and(|s| s.bodies.iter().any(|b| &**b == name));
    let raised = Translation3::new(0.0, 0.0, LIFT) * pose;
    for fixed in scene.bodies().iter().filter(|fixed| !stands_on(&fixed.body.name)) {
        let gap = between(body, &raised, &fixed.body, &fixed.world_from_body)?;
        if overlap(&gap, body, fixed) {
            let [x, y, z] = <[f64; 3]>::from(pose.translation.vector);
            return Ok(Some(format!("at ({x:.3}, {y:.3}, {z:.3}) it touches `{}`", fixed.body.name)));
        }
    }
    Ok(None)
}

/// A mesh has no inside, so whatever touches one has a depth of zero in it.
fn overlap(gap: &Clearance, body: &Body, fixed: &FixedBody) -> bool {
    let is_mesh = |body: &Body, part: usize| body.parts.get(part).is_some_and(|p| matches!(p.shape, Shape::Mesh(_)));
    let surface = is_mesh(body, gap.parts.0) || is_mesh(&fixed.body, gap.parts.1);
    gap.distance < -ROUNDING || (surface && gap.distance <= 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem_file::ProblemFile;
    use crate::testing::builtin_text;
    use crate::world::{self, Built};

    /// A tetrahedron around the origin, 0.2 m high.
    const OBJ: &str =
        "v 0.1 0 -0.1\nv -0.1 0.1 -0.1\nv -0.1 -0.1 -0.1\nv 0 0 0.1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

    /// Plate1 with other goal lines, and what the check says.
    fn checked(goal: &str, more: &str) -> Result<(), PlanningError> {
        let text = builtin_text("plate1").unwrap();
        let (head, tail) = text.split_once("on = \"side table\"\nat = [-2.14, -1.09]").unwrap();
        let tail = tail.replacen("state = \"released\"", "", 1);
        let problem = ProblemFile::from_toml(&format!("{head}{goal}{tail}\n{more}"), "text").unwrap();
        let Built { world, goal, scene, .. } = world::build(&crate::testing::registry(), &problem).unwrap();
        check_goal(&world, &goal, &scene)
    }

    #[test]
    fn goals_in_obstacles_are_blocked_and_those_beside_are_not() {
        checked("on = \"central table\"\nat = [-0.2, 0.05]", "").unwrap();
        let message = checked("on = \"central table\"\nat = [0.07, 0.05]", "").unwrap_err().to_string();
        assert_eq!(message, "the goal of `plate` is blocked: at (0.070, 0.050, 0.760) it touches `big bowl`");
        let message = checked("position = [0.0, 0.0, 0.73]", "").unwrap_err().to_string();
        assert!(message.contains("it touches `central table top`"), "{message}");
    }

    #[test]
    fn goals_in_a_mesh_are_blocked_too() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("stone.obj");
        std::fs::write(&file, OBJ).unwrap();
        let stone = |at: [f64; 3]| {
            format!(
                "[[obstacle]]\nname = \"stone\"\nshape = {{ mesh = {{ file = '{}' }} }}\nat = {at:?}\n",
                file.display()
            )
        };
        let goal = "position = [-1.0, 1.0, 1.0]";
        let message = checked(goal, &stone([-1.0, 1.0, 1.0])).unwrap_err().to_string();
        assert!(message.contains("it touches `stone`"), "{message}");
        checked(goal, &stone([-1.0, 1.5, 1.0])).unwrap();
    }

    #[test]
    fn what_cannot_be_judged_is_an_error() {
        let text = builtin_text("plate1").unwrap();
        let Built { world, scene, .. } =
            world::build(&crate::testing::registry(), &ProblemFile::from_toml(text, "text").unwrap()).unwrap();
        let far = PartialState::anywhere(&world).with_object(ObjectId::new(0), Isometry3::translation(1e9, 0.0, 1.0));
        let error = first_blocked(&world, &far, &scene).unwrap_err().to_string();
        assert!(error.contains("plate"), "{error}");
    }
}
