//! Can the objects be at their goal at all? Asked once, before the search, so that an impossible goal is an error with
//! a name instead of a search without end.
//!
//! An error is proven: at every place that the goals allow something is in the way, or a closed mesh lies between the start and
//! the goal. What was only found at all places tried is a doubt.

mod base;
mod shrunk;

use darrt_core::goal::Goal;
use darrt_core::partial::PartialState;
use darrt_core::random::{Purpose, stream};
use darrt_core::state::ObjectId;
use darrt_geom::clearance::{Clearance, between};
use darrt_geom::scene::Scene;
use darrt_geom::support::FLUSH_HEIGHT;
use darrt_geom::{Body, GeomError, Shape};
use darrt_primitives::goal::{Grip, ObjectGoal, TabletopGoal, Whereabouts};
use darrt_primitives::object_space::upright;
use nalgebra::{Isometry3, Point3, Translation3, Vector3};

use crate::diagnosis::cause::Occupant;
use crate::planning_error::PlanningError;
use darrt_primitives::manipulator::Manipulator;
use darrt_primitives::tabletop::{Tabletop, TabletopState};

/// How many samples of an infinite goal are tried before it is doubted.
const SAMPLES: u64 = 64;
/// Up to so many combinations of places are looked at one by one.
const COMBINATIONS: usize = 64;
/// An object is looked at this far above its goal, metres, so that what it stands on is not in its way.
const LIFT: f64 = 1e-6;
/// What stands on one of several joined surfaces may be this far from the height of all, metres.
const ON_TOP: f64 = FLUSH_HEIGHT + 1e-6;
/// What rests may be so much higher or lower than its goal says, metres.
const RESTING_M: f64 = 1e-3;
/// Solids that overlap less than this do not block, metres.
const ROUNDING: f64 = 1e-9;

/// Checks that some goal pose of every named object is free of the fixed bodies, of the objects that never move
/// (`immovable`, at their poses in `start`), and of where the others shall be. What could not be proven, but was found at all
/// places tried, is returned in words.
///
/// # Errors
/// [`PlanningError::GoalBlocked`] with the object and what is in the way, [`PlanningError::GoalEnclosed`],
/// [`PlanningError::BaseGoalBlocked`]; [`PlanningError::Geometry`] when that cannot be said.
pub fn check_goal<M: Manipulator>(
    m: &Tabletop<M>,
    goal: &TabletopGoal<M::Joints>,
    scene: &Scene,
    start: &TabletopState<M>,
    immovable: &[ObjectId],
) -> Result<Option<String>, PlanningError> {
    let room = Room { m, goal, scene, start, immovable };
    room.check_enclosed()?;
    base::check(m, goal, scene, start)?;
    let mut blocked = None;
    let objects = goal.of_objects();
    for i in 0..SAMPLES {
        let Some(target) = objects.sample(m, &mut stream(0, 0, i, Purpose::Attempt)) else {
            return room.check_places().map(|()| None);
        };
        match room.first_blocked(&target)? {
            // What is certainly blocked is blocked at every place: nothing is left to prove.
            None => return Ok(None),
            found => blocked = found,
        }
    }
    room.check_places()?;
    Ok(blocked
        .map(|error| format!("{error}; so it is at all of {SAMPLES} places tried, and not for certain at all others")))
}

/// What an object at its goal can meet.
struct Room<'a, M: Manipulator> {
    m: &'a Tabletop<M>,
    goal: &'a TabletopGoal<M::Joints>,
    scene: &'a Scene,
    start: &'a TabletopState<M>,
    immovable: &'a [ObjectId],
}

/// An object at one place that its goal names.
struct Placed<'a> {
    goal: &'a ObjectGoal,
    pose: Isometry3<f64>,
}

impl<'a> Placed<'a> {
    /// `None` for a goal that is a region.
    fn new(goal: &'a ObjectGoal) -> Option<Self> {
        let Whereabouts::At(at) = &goal.whereabouts else { return None };
        Some(Self { goal, pose: upright(*at, goal.yaw.map_or(0.0, |(yaw, _)| yaw)) })
    }
}

/// How much higher or lower than its goal an object may be.
fn up_slack_m(goal: &ObjectGoal) -> f64 {
    // What rests is as high as what it rests on.
    if goal.grip == Grip::Released { RESTING_M } else { goal.tolerance_m }
}

impl<M: Manipulator> Room<'_, M> {
    /// Checks that of the places, where goals name places, some combination is free.
    fn check_places(&self) -> Result<(), PlanningError> {
        let groups = self.goal.groups().iter();
        // A group with a region can always be met elsewhere, as far as this is asked.
        let groups: Vec<Vec<Placed<'_>>> =
            groups.filter_map(|group| group.iter().map(Placed::new).collect::<Option<_>>()).collect();
        let count = groups.iter().fold(1_usize, |product, group| product.saturating_mul(group.len()));
        if count == 0 || count > COMBINATIONS || groups.is_empty() {
            return Ok(());
        }
        let mut blocked = None;
        for number in 0..count {
            let mut rest = number;
            let choice = groups.iter().filter_map(|group| {
                let index = rest % group.len();
                rest /= group.len();
                group.get(index)
            });
            match self.certainly_blocked(&choice.collect::<Vec<_>>())? {
                None => return Ok(()),
                found => blocked = found,
            }
        }
        blocked.map_or(Ok(()), Err)
    }

    /// The first of these objects that something is in the way of wherever it is within its tolerance.
    fn certainly_blocked(&self, choice: &[&Placed<'_>]) -> Result<Option<PlanningError>, GeomError> {
        for one in choice {
            let id = one.goal.object;
            let Some(movable) = self.m.movable(id) else { continue };
            let (yaw_slack_m, is_turned) = match one.goal.yaw {
                _ if movable.round_radius_m.is_some() => (0.0, false),
                Some((_, tolerance)) => (tolerance * movable.reach_m, false),
                None => (0.0, true),
            };
            let aside_m = one.goal.tolerance_m + yaw_slack_m;
            let up_m = up_slack_m(one.goal);
            let refuse =
                |by: &Body, occupant| Ok(Some(goal_blocked(&movable.body, &one.pose, (by.name.to_string(), occupant))));
            if let Some(core) = shrunk::shrunk(&movable.body, [aside_m, up_m], is_turned) {
                if let Some(blame) = in_the_way(self.m, id, &core, &one.pose, self.scene)? {
                    return Ok(Some(goal_blocked(&movable.body, &one.pose, blame)));
                }
                for other in self.immovable.iter().filter(|other| **other != id) {
                    let (Some(body), Some(pose)) = (self.m.movable(*other), self.start.object(*other)) else {
                        continue;
                    };
                    if meets(&core, &one.pose, &body.body, pose)? {
                        return refuse(&body.body, Occupant::Immovable);
                    }
                }
            }
            for other in choice.iter().filter(|other| other.goal.object != id) {
                let Some(body) = self.m.movable(other.goal.object) else { continue };
                // The other one turned about its axis is not what it is here.
                if body.round_radius_m.is_none() && other.goal.yaw.is_none_or(|(_, tolerance)| tolerance > 0.0) {
                    continue;
                }
                let slack_m = [aside_m + other.goal.tolerance_m, up_m + up_slack_m(other.goal)];
                let Some(core) = shrunk::shrunk(&movable.body, slack_m, is_turned) else {
                    continue;
                };
                if meets(&core, &one.pose, &body.body, &other.pose)? {
                    return refuse(&body.body, Occupant::Goal);
                }
            }
        }
        Ok(None)
    }

    /// Checks that no closed mesh is around the goal of an object and not around its start, or the other way round: its centre
    /// would have to pass the surface.
    fn check_enclosed(&self) -> Result<(), PlanningError> {
        for group in self.goal.groups() {
            let mut found = None;
            for goal in group {
                found = self.enclosure(goal)?;
                if found.is_none() {
                    break;
                }
            }
            found.map_or(Ok(()), Err)?;
        }
        Ok(())
    }

    /// Says so if a body lies around the place of a goal, with all that its tolerance allows, and not around the start.
    fn enclosure(&self, goal: &ObjectGoal) -> Result<Option<PlanningError>, GeomError> {
        let Whereabouts::At(at) = &goal.whereabouts else { return Ok(None) };
        let (Some(start), Some(movable)) = (self.start.object(goal.object), self.m.movable(goal.object)) else {
            return Ok(None);
        };
        let reach =
            Body::single("all places", Shape::sphere(goal.tolerance_m.max(ROUNDING) + darrt_geom::MINIMUM_LENGTH)?)?;
        for fixed in self.scene.bodies() {
            for part in &fixed.body.parts {
                let Shape::Mesh(mesh) = &part.shape else { continue };
                let world_from_mesh = fixed.world_from_body * part.body_from_shape;
                let local = |p: &Vector3<f64>| world_from_mesh.inverse_transform_point(&Point3::from(*p));
                if mesh.separates(&local(&start.translation.vector), &local(at)) {
                    let alone = Body::single(std::sync::Arc::clone(&fixed.body.name), part.shape.clone())?;
                    let gap = between(&reach, &Isometry3::from(*at), &alone, &world_from_mesh)?;
                    if gap.distance > 0.0 {
                        let (object, by) = (movable.body.name.to_string(), fixed.body.name.to_string());
                        return Ok(Some(PlanningError::GoalEnclosed { object, by, at: (*at).into() }));
                    }
                }
            }
        }
        Ok(None)
    }

    /// The first object of `target` that something is in the way of.
    fn first_blocked(&self, target: &PartialState<Tabletop<M>>) -> Result<Option<PlanningError>, GeomError> {
        for (id, pose) in target.objects() {
            let Some(movable) = self.m.movable(id) else { continue };
            let blame = match in_the_way(self.m, id, &movable.body, pose, self.scene)? {
                None => self.object_in_the_way(id, &movable.body, pose, target)?,
                found => found,
            };
            if let Some(blame) = blame {
                return Ok(Some(goal_blocked(&movable.body, pose, blame)));
            }
        }
        Ok(None)
    }

    /// The object that `body` at `pose` would touch: one that never moves, or one at its own goal.
    fn object_in_the_way(
        &self,
        id: ObjectId,
        body: &Body,
        pose: &Isometry3<f64>,
        target: &PartialState<Tabletop<M>>,
    ) -> Result<Option<(String, Occupant)>, GeomError> {
        let still =
            self.immovable.iter().filter_map(|other| Some((*other, self.start.object(*other)?, Occupant::Immovable)));
        for (other, there, occupant) in still.chain(target.objects().map(|(other, pose)| (other, pose, Occupant::Goal)))
        {
            let Some(movable) = self.m.movable(other).filter(|_| other != id) else { continue };
            if meets(body, pose, &movable.body, there)? {
                return Ok(Some((movable.body.name.to_string(), occupant)));
            }
        }
        Ok(None)
    }
}

/// The goal of `body` at `pose` is not free.
fn goal_blocked(body: &Body, pose: &Isometry3<f64>, (by, occupant): (String, Occupant)) -> PlanningError {
    PlanningError::GoalBlocked { object: body.name.to_string(), by, occupant, at: pose.translation.vector.into() }
}

/// Do the two overlap?
fn meets(a: &Body, at_a: &Isometry3<f64>, b: &Body, at_b: &Isometry3<f64>) -> Result<bool, GeomError> {
    let gap = between(a, at_a, b, at_b)?;
    Ok(is_overlap(&gap, a, b))
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
        if is_overlap(&gap, body, &fixed.body) {
            return Ok(Some((fixed.body.name.to_string(), Occupant::Fixed)));
        }
    }
    Ok(None)
}

/// Of meshes it is not said how deep something is in them, so whatever touches one has a depth of zero in it.
fn is_overlap(gap: &Clearance, a: &Body, b: &Body) -> bool {
    let is_mesh = |body: &Body, part: usize| body.parts.get(part).is_some_and(|p| matches!(p.shape, Shape::Mesh(_)));
    let surface = is_mesh(a, gap.parts.0) || is_mesh(b, gap.parts.1);
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
    fn checked(goal: &str, more: &str) -> Result<Option<String>, PlanningError> {
        let text = builtin_text("plate1").unwrap();
        let (head, tail) = text.split_once("on = \"side table\"\nat = [-2.14, -1.09]").unwrap();
        let tail = tail.replacen("state = \"released\"", "", 1);
        let is_own = |line: &&str| goal.contains("tolerance_m") && line.trim_start().starts_with("tolerance_m");
        let tail = tail.lines().filter(|line| !is_own(line)).collect::<Vec<_>>().join("\n");
        let problem = ProblemFile::from_toml(&format!("{head}{goal}{tail}\n{more}"), "text").unwrap();
        let Built { world, start, goal, scene, .. } = world::build(&crate::testing::registry(), &problem).unwrap();
        check_goal(&world, &goal, &scene, &start, &[])
    }

    #[test]
    fn goals_in_obstacles_are_blocked_and_those_beside_are_not() {
        assert_eq!(checked("on = \"central table\"\nat = [-0.2, 0.05]", "").unwrap(), None);
        let message = checked("on = \"central table\"\nat = [0.07, 0.05]", "").unwrap_err().to_string();
        assert_eq!(message, "the goal of `plate` is blocked: at (0.070, 0.050, 0.760) it touches `big bowl`");
        let message = checked("position = [0.0, 0.0, 0.73]\ntolerance_m = 0.005", "").unwrap_err().to_string();
        assert!(message.contains("it touches `central table top`"), "{message}");
    }

    #[test]
    fn a_base_in_a_table_is_blocked_and_one_beside_it_is_not() {
        let goal = "on = \"central table\"\nat = [-0.2, 0.05]";
        let at = |x: f64| checked(goal, &format!("[goal.robot]\nbase = [{x}, 0.0, 0.0]\n"));
        let message = at(0.0).unwrap_err().to_string();
        assert!(message.contains("`goal.robot.base` is blocked") && message.contains("central table"), "{message}");
        assert!(at(0.0).unwrap_err().is_impossible());
        assert_eq!(at(-1.5).unwrap(), None);
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

    /// A box of 12 triangles, half as wide as said, in the format OBJ; `first` is the number of its first corner.
    fn block(half: f64, first: usize) -> String {
        let corner = |i: usize| [0, 1, 2].map(|bit| if i >> bit & 1 == 1 { half } else { -half });
        let corners = (0..8).map(|i| format!("v {} {} {}\n", corner(i)[0], corner(i)[1], corner(i)[2]));
        let faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]];
        let faces =
            faces.iter().map(|f| format!("f {} {} {} {}\n", f[0] + first, f[1] + first, f[2] + first, f[3] + first));
        corners.chain(faces).collect()
    }

    #[test]
    fn a_goal_in_the_cavity_of_a_mesh_is_enclosed() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("safe.obj");
        std::fs::write(&file, block(0.5, 1) + &block(0.4, 9)).unwrap();
        let safe = |at: [f64; 3]| {
            format!(
                "[[obstacle]]\nname = \"safe\"\nshape = {{ mesh = {{ file = '{}' }} }}\nat = {at:?}\n",
                file.display()
            )
        };
        let goal = "position = [-1.0, 2.0, 1.0]";
        let error = checked(goal, &safe([-1.0, 2.0, 1.0])).unwrap_err();
        assert!(
            matches!(&error, PlanningError::GoalEnclosed { object, by, .. } if object == "plate" && by == "safe"),
            "{error}"
        );
        // In the wall it is blocked, beside it free.
        assert!(matches!(checked(goal, &safe([-0.55, 2.0, 1.0])).unwrap_err(), PlanningError::GoalBlocked { .. }));
        checked(goal, &safe([-0.2, 2.0, 1.0])).unwrap();
    }

    #[test]
    fn what_a_tolerance_may_save_is_only_doubted() {
        // The bowl has a half width of 0.09 m, the plate a radius of 0.14 m: they overlap by three millimetres, and five are allowed.
        let place = "on = \"central table\"\nat = [-0.157, 0.05]";
        let doubt = checked(place, "").unwrap().unwrap();
        assert!(doubt.contains("the goal of `plate` is blocked") && doubt.contains("`big bowl`"), "{doubt}");
        let exact = format!("{place}\ntolerance_m = 0.001");
        assert!(matches!(checked(&exact, "").unwrap_err(), PlanningError::GoalBlocked { .. }));
        // Nor is a region proven to be full by samples of it.
        let region = "on = \"central table\"\nregion = { min = [0.05, 0.03], max = [0.09, 0.07] }";
        assert!(checked(region, "").unwrap().is_some());
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
