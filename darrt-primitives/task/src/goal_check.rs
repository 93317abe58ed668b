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

use crate::diagnosis::cause::Occupant;
use crate::planning_error::PlanningError;
use darrt_primitives::manipulator::Manipulator;
use darrt_primitives::tabletop::{Tabletop, TabletopState};

/// How many samples of an infinite goal are tried before it counts as blocked.
const SAMPLES: u64 = 64;
/// An object is looked at this far above its goal, metres, so that what it stands on is not in its way.
const LIFT: f64 = 1e-6;
/// What stands on one of several joined surfaces may be this far from the height of all, metres.
const ON_TOP: f64 = FLUSH_HEIGHT + 1e-6;
/// Solids that overlap less than this do not block, metres.
const ROUNDING: f64 = 1e-9;

/// Checks that some goal pose of every named object is free of the fixed bodies, of the objects that never move
/// (`immovable`, at their poses in `start`), and of where the others shall be.
///
/// # Errors
/// [`PlanningError::GoalBlocked`] with the object and what is in the way; [`PlanningError::Geometry`] when that cannot
/// be said.
pub fn check_goal<M: Manipulator>(
    m: &Tabletop<M>,
    goal: &TabletopGoal<M::Joints>,
    scene: &Scene,
    start: &TabletopState<M>,
    immovable: &[ObjectId],
) -> Result<(), PlanningError> {
    let room = Room { m, goal, scene, start, immovable };
    let mut blocked = None;
    for i in 0..SAMPLES {
        let Some(target) = goal.sample(m, &mut stream(0, 0, i, Purpose::Attempt)) else { return Ok(()) };
        match room.first_blocked(&target)? {
            None => return Ok(()),
            found => blocked = found,
        }
    }
    blocked.map_or(Ok(()), Err)
}

/// What an object at its goal can meet.
struct Room<'a, M: Manipulator> {
    m: &'a Tabletop<M>,
    goal: &'a TabletopGoal<M::Joints>,
    scene: &'a Scene,
    start: &'a TabletopState<M>,
    immovable: &'a [ObjectId],
}

impl<M: Manipulator> Room<'_, M> {
    /// The first object of `target` that something is in the way of.
    fn first_blocked(&self, target: &PartialState<Tabletop<M>>) -> Result<Option<PlanningError>, GeomError> {
        for (id, pose) in target.objects() {
            let Some(movable) = self.m.movable(id) else { continue };
            let blame = match in_the_way(self.m, id, &movable.body, pose, self.scene)? {
                None => self.object_in_the_way(id, &movable.body, pose, target)?,
                found => found,
            };
            if let Some((by, occupant)) = blame {
                let (object, at) = (movable.body.name.to_string(), pose.translation.vector.into());
                return Ok(Some(PlanningError::GoalBlocked { object, by, occupant, at }));
            }
        }
        Ok(None)
    }

    /// The object that `body` at `pose` would touch however far both may be off: one that never moves, or one at its own goal.
    fn object_in_the_way(
        &self,
        id: ObjectId,
        body: &Body,
        pose: &Isometry3<f64>,
        target: &PartialState<Tabletop<M>>,
    ) -> Result<Option<(String, Occupant)>, GeomError> {
        let still = self.immovable.iter().filter_map(|other| Some((*other, self.start.object(*other)?, true)));
        for (other, there, is_immovable) in still.chain(target.objects().map(|(other, pose)| (other, pose, false))) {
            let Some(movable) = self.m.movable(other).filter(|_| other != id) else { continue };
            let slack_m = self.tolerance_m(id) + if is_immovable { 0.0 } else { self.tolerance_m(other) };
            // Of meshes it is not known how deep something is in them.
            let is_mesh =
                [body, &movable.body].iter().any(|b| b.parts.iter().any(|p| matches!(p.shape, Shape::Mesh(_))));
            if !is_mesh && between(body, pose, &movable.body, there)?.distance < -(slack_m + ROUNDING) {
                let occupant = if is_immovable { Occupant::Immovable } else { Occupant::Goal };
                return Ok(Some((movable.body.name.to_string(), occupant)));
            }
        }
        Ok(None)
    }

    /// How far an object may be off its goal, metres.
    fn tolerance_m(&self, id: ObjectId) -> f64 {
        let goals = self.goal.groups().iter().flatten().filter(|goal| goal.object == id);
        goals.fold(0.0, |most, goal| goal.tolerance_m.max(most))
    }
}

/// The fixed body that `body` at `pose` would touch, other than what it stands on.
fn in_the_way<M: Manipulator>(
    m: &Tabletop<M>,
    id: ObjectId,
    body: &Body,
    pose: &Isometry3<f64>,
    scene: &Scene,
) -> Result<Option<(String, Occupant)>, GeomError> {
    let under = m.surface_under(id, pose, ON_TOP).and_then(|s| m.supports().get(s.index()));
    let stands_on = |name: &str| under.is_some_and(|s| s.bodies.iter().any(|b| &**b == name));
    let raised = Translation3::new(0.0, 0.0, LIFT) * pose;
    for fixed in scene.bodies().iter().filter(|fixed| !stands_on(&fixed.body.name)) {
        let gap = between(body, &raised, &fixed.body, &fixed.world_from_body)?;
        if overlap(&gap, body, fixed) {
            return Ok(Some((fixed.body.name.to_string(), Occupant::Fixed)));
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
        let Built { world, start, goal, scene, .. } = world::build(&crate::testing::registry(), &problem).unwrap();
        check_goal(&world, &goal, &scene, &start, &[])
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

    /// Two tins on a table, 0.2 m apart, with the goal lines and the second one's keys; how preparing them ends.
    fn tins(second: &str, goals: &str) -> Result<(), PlanningError> {
        let tin = |name: &str, y: f64, keys: &str| {
            format!(
                "[[object]]\nname = \"{name}\"\nshape = {{ cylinder = {{ radius = 0.035, height = 0.10 }} }}\n\
                 on = \"central table\"\nat = [-0.2, {y}]\n{keys}\n"
            )
        };
        let text = builtin_text("plate1").unwrap();
        let (head, _) = text.split_once("[[object]]").unwrap();
        let tins = tin("can", 0.2, "grasps = [\"side\"]") + &tin("jar", -0.1, second);
        let problem = ProblemFile::from_toml(&format!("{head}{tins}{goals}"), "text").unwrap();
        crate::planning::prepare(&crate::testing::registry(), &problem).map(|_| ())
    }

    fn goal(object: &str, y: f64) -> String {
        format!("[[goal.object]]\nobject = \"{object}\"\non = \"central table\"\nat = [-0.2, {y}]\n")
    }

    #[test]
    fn goals_that_cannot_hold_together_are_blocked() {
        let grasps = "grasps = [\"side\"]";
        let message = tins(grasps, &(goal("can", -0.3) + &goal("jar", -0.32))).unwrap_err().to_string();
        assert!(
            message.contains("the goal of `can` is blocked") && message.contains("`jar`, which has its goal there"),
            "{message}"
        );
        tins(grasps, &(goal("can", -0.3) + &goal("jar", -0.38))).unwrap();
        // Each may be off by so much that both have room.
        let loose = |object: &str, y: f64| goal(object, y) + "tolerance_m = 0.03\n";
        tins(grasps, &(loose("can", -0.3) + &loose("jar", -0.32))).unwrap();
    }

    #[test]
    fn a_goal_under_what_never_moves_is_blocked() {
        let message = tins("grasps = []\npushable = false", &goal("can", -0.1)).unwrap_err().to_string();
        assert!(message.contains("`jar`, which never moves"), "{message}");
        tins("grasps = []", &goal("can", -0.1)).unwrap();
    }

    #[test]
    fn what_cannot_be_judged_is_an_error() {
        let text = builtin_text("plate1").unwrap();
        let Built { world, start, goal, scene, .. } =
            world::build(&crate::testing::registry(), &ProblemFile::from_toml(text, "text").unwrap()).unwrap();
        let room = Room { m: &world, goal: &goal, scene: &scene, start: &start, immovable: &[] };
        let far = PartialState::anywhere(&world).with_object(ObjectId::new(0), Isometry3::translation(1e9, 0.0, 1.0));
        let error = room.first_blocked(&far).unwrap_err().to_string();
        assert!(error.contains("plate"), "{error}");
    }
}
