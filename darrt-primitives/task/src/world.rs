//! From a problem file to a problem that the planner can solve: robot, domain, start, goal.

use std::f64::consts::TAU;
use std::sync::Arc;

use darrt_core::primitive::PrimitiveId;
use darrt_core::state::{ObjectId, State};
use darrt_geom::scene::Scene;
use darrt_primitives::collision_scene::NearPair;
use darrt_primitives::contact::MAX_LEAN;
use darrt_primitives::goal::{Grip, ObjectGoal, RobotGoal, TabletopGoal, Whereabouts};
use darrt_primitives::manipulator::{Configuration, Hand, JointVector as _};
use darrt_primitives::mobile_arm_space::MobileArmSpace;
use darrt_primitives::mode::Mode;
use darrt_primitives::object_space::{ObjectSpace, ObjectSpaceParts};
use darrt_primitives::primitive::{BASE_RIGID_TRANSFER, BASE_TRANSIT};
use darrt_primitives::push::edge_stop::{EdgeRule, RimReach};
use darrt_primitives::tabletop::{
    ActionSettings, Movable, ObjectFriction, PlaceSettings, PushSettings, Tabletop, TabletopState,
};
use nalgebra::{Isometry3, Point2, Vector3};

use crate::grasp_families::{families, lift_m};
use crate::planning_error::PlanningError;
use crate::problem_file::geometry::Geometry;
use crate::problem_file::{self as file, GoalState, GoalTarget, ProblemFile, Symmetry};
use crate::registry::Registry;
use crate::robot::{RobotError, TaskRobot};
use crate::supports::Supports;

/// Free distance that a rim grasp keeps between fingertips and edge, metres.
const RIM_CLEARANCE: f64 = 0.01;
/// Share of object samples that stand on a surface.
const SURFACE_SHARE: f64 = 0.7;

/// Everything that a problem file says, built.
#[derive(Debug)]
pub struct Built<M: TaskRobot> {
    /// M.
    pub world: Tabletop<M>,
    /// The initial state.
    pub start: TabletopState<M>,
    /// G.
    pub goal: TabletopGoal<M::Joints>,
    /// The fixed bodies and the surfaces.
    pub scene: Scene,
    /// What the problem itself puts nearer to each other than the least margin.
    pub near: Vec<NearPair>,
}

/// Builds robot, domain, start and goal.
///
/// # Errors
/// [`PlanningError`] with the key at fault when the robot's description, a shape, a grasp or a number cannot be used.
pub fn build<M: TaskRobot>(registry: &Registry<M>, problem: &ProblemFile) -> Result<Built<M>, PlanningError> {
    let (robot, arm) = M::build(&problem.robot)?;
    build_with(registry, problem, robot, arm)
}

/// [`build`], with a robot that is built already, whose arm starts at `arm`.
///
/// # Errors
/// As [`build`].
pub fn build_with<M: TaskRobot>(
    registry: &Registry<M>,
    problem: &ProblemFile,
    robot: M,
    arm: M::Joints,
) -> Result<Built<M>, PlanningError> {
    let geometry = problem.geometry()?;
    let bounds = &problem.bounds;
    let lower = [bounds.base_x[0], bounds.base_y[0]];
    let upper = [bounds.base_x[1], bounds.base_y[1]];
    let space: MobileArmSpace<M::Joints> = MobileArmSpace::new(lower, upper, robot.limits(), robot.joint_weights_m())?;

    let supports = Supports::new(problem, &geometry)?;
    let objects = problem
        .objects
        .iter()
        .zip(&geometry.objects)
        .enumerate()
        .map(|(index, (object, solid))| movable(problem, (index, object), solid, (&geometry, &supports), robot.hand()))
        .collect::<Result<Vec<_>, _>>()?;

    let allowed: Vec<_> = registry.allowed(problem).map(|(id, _)| id).collect();
    let mut settings = settings(problem, &allowed, &robot)?;
    // A posture that the limits in force forbid is no place to travel through.
    settings.postures.retain(|posture| space.contains_arm(posture));
    let robot = Arc::new(robot);
    // A base that no primitive moves is where it is.
    let stays = (settings.drives == [false; 2]).then_some(problem.robot.base);
    let goal = goal(problem, &geometry, &supports, (&*robot, stays))?;
    let rests_on = geometry.objects.iter().enumerate().map(|(index, o)| supports.holding(index, o.surface));
    let mode = Mode::resting(rests_on, settings.travel_gap_m);
    let mut world = Tabletop::new(robot, space, objects, supports.all, geometry.scene.bodies(), settings)?
        .with_primitives(&registry.further());
    let start = State {
        robot: Configuration { base: problem.robot.base, arm },
        objects: geometry.objects.iter().map(|o| o.world_from_object).collect(),
        mode,
    };
    let near = crate::near_pairs::accept(&mut world, &start, &goal);
    Ok(Built { world, start, goal, scene: geometry.scene, near })
}

fn movable(
    problem: &ProblemFile,
    (index, object): (usize, &file::Object),
    solid: &file::geometry::StartingObject,
    (geometry, supports): (&Geometry, &Supports),
    hand: &dyn Hand,
) -> Result<(ObjectSpace, Movable), PlanningError> {
    let plain = Movable::of_body(solid.body.clone());
    let radius = object.shape.round_radius();
    let bounds = &problem.bounds;
    let space = ObjectSpace::new(ObjectSpaceParts {
        lower: [bounds.object_x[0], bounds.object_y[0], bounds.object_z[0]],
        upper: [bounds.object_x[1], bounds.object_y[1], bounds.object_z[1]],
        is_round: object.symmetry() == Symmetry::Z,
        metres_per_rad: radius.unwrap_or(plain.reach_m),
        half_height_m: solid.depth_below_origin,
        surfaces: supports.surfaces_of(index).cloned().collect(),
        surface_share: SURFACE_SHARE,
        edge_margin_m: problem.safety.edge_margin_m,
    })?;
    let rim = RimReach { insertion: object.rim.insertion_m, clearance: RIM_CLEARANCE, ..RimReach::default() };
    let named = |flaw| PlanningError::Grasp { object: object.name.clone(), index, flaw };
    let movable = Movable {
        round_radius_m: radius,
        half_height_m: solid.depth_below_origin,
        is_pushable: object.pushable(),
        surfaces: supports.of_object(index).into(),
        grasps: families(object, hand).map_err(named)?,
        rim,
        lift_m: lift_m(object),
        mass_kg: object.mass_kg,
        friction: ObjectFriction { table: object.friction.table, fingers: object.friction.fingers },
        max_tilt_rad: object.max_tilt_deg().to_radians(),
        brinks: crate::goal_edges::brinks(problem, index, solid.depth_below_origin, geometry, supports),
        ..plain
    };
    Ok((space, movable))
}

fn settings<M: TaskRobot>(
    problem: &ProblemFile,
    allowed: &[PrimitiveId],
    robot: &M,
) -> Result<ActionSettings<M::Joints>, PlanningError> {
    let push = &problem.push;
    let postures = problem.transit.postures.iter().enumerate().map(|(index, name)| {
        let unknown = |known| RobotError::unknown_posture(format!("transit.postures[{index}]"), name, known);
        robot.posture(name).ok_or_else(|| M::posture_names(&problem.robot).map_or_else(|error| error, unknown))
    });
    let usual = ActionSettings::for_robot(robot);
    Ok(ActionSettings {
        push: PushSettings {
            gap_m: push.gap_m.min(robot.hand().max_gap_m()),
            fingertip_clearance_m: push.fingertip_clearance_m,
            leans_rad: push.leans_deg.iter().map(|lean| lean.to_radians().min(MAX_LEAN)).collect(),
            standoff_m: push.standoff_m.planned()?,
            approach_m: push.approach_m.planned()?,
            position_error_m: push.position_error_m,
            max_turn_rad: push.max_turn_deg.to_radians(),
            edge_rule: match push.edge_rule {
                file::EdgeRule::NearestEdgePoint => EdgeRule::NearestEdgePoint,
                file::EdgeRule::LineCrossing => EdgeRule::LineCrossing,
            },
            edge_distance_m: push.edge_distance_m,
        },
        place: PlaceSettings {
            approach_directions: problem
                .place
                .approach_directions
                .iter()
                .filter_map(|d| Vector3::from(*d).try_normalize(1e-9))
                .collect(),
            approach_m: problem.place.approach_m.planned()?,
            retreat_m: problem.place.retreat_m.planned()?,
            release_opening_m: usual.place.release_opening_m,
        },
        safety: problem.safety.settings(),
        retreat_m: push.retreat_m.planned()?,
        drives: [allowed.contains(&BASE_TRANSIT), allowed.contains(&BASE_RIGID_TRANSFER)],
        postures: postures.collect::<Result<_, RobotError>>()?,
        ..usual
    })
}

fn goal<M: TaskRobot>(
    problem: &ProblemFile,
    geometry: &Geometry,
    supports: &Supports,
    (robot, stays): (&M, Option<[f64; 3]>),
) -> Result<TabletopGoal<M::Joints>, PlanningError> {
    let mut groups = Vec::new();
    for (name, alternatives) in problem.goal.by_object() {
        let unknown = || PlanningError::UnknownObject { name: name.to_owned() };
        let index = problem.objects.iter().position(|o| o.name == name).ok_or_else(unknown)?;
        geometry.objects.get(index).ok_or_else(unknown)?;
        let spec = problem.objects.get(index).ok_or_else(unknown)?;
        let group = alternatives.iter().filter_map(|goal| one_goal((index, spec), goal, geometry, supports));
        groups.push(group.collect());
    }
    let robot = problem.goal.robot.as_ref().map(|goal| robot_goal(goal, robot, stays)).transpose()?;
    Ok(TabletopGoal::new(groups).with_robot(robot))
}

/// `stays`: where the base is, if nothing moves it.
fn robot_goal<M: TaskRobot>(
    goal: &file::RobotGoal,
    robot: &M,
    stays: Option<[f64; 3]>,
) -> Result<RobotGoal<M::Joints>, RobotError> {
    let joints = |values: &Vec<f64>| {
        let (found, expected) = (values.len(), robot.limits().len());
        let wrong = RobotError::joint_count("goal.robot.joints", found, expected, robot.hands());
        let arm = M::Joints::from_values(values).filter(|_| found == expected).ok_or(wrong)?;
        for (i, (value, limit)) in values.iter().zip(robot.limits()).enumerate() {
            if limit.is_unlimited() && value.abs() > TAU {
                let why = format!("has {value} for joint {i}, in radians at most a full turn of 6.283");
                return Err(RobotError::Key { key: "goal.robot.joints", why });
            }
            if !limit.contains(*value) {
                let why = format!("has {value} for joint {i}, outside its limits [{}, {}]", limit.lower, limit.upper);
                return Err(RobotError::Key { key: "goal.robot.joints", why });
            }
        }
        Ok(arm)
    };
    Ok(RobotGoal {
        // Elsewhere no arm need be looked for.
        base: goal.base.or(stays.filter(|_| goal.tool.is_some())),
        arm: goal.joints.as_ref().map(joints).transpose()?,
        world_from_tool: goal.tool.map(|tool| tool.world_from_tool()),
        tolerance_m: goal.tolerance_m,
        tolerance_rad: goal.tolerance_rad,
    })
}

/// `None` when the goal's keys contradict each other, which the file's validation has refused.
fn one_goal(
    (object, spec): (usize, &file::Object),
    goal: &file::ObjectGoal,
    geometry: &Geometry,
    supports: &Supports,
) -> Option<ObjectGoal> {
    let scene = &geometry.scene;
    let solid = geometry.objects.get(object)?;
    let centre = |pose: Isometry3<f64>| Whereabouts::At(pose.translation.vector);
    let whereabouts = match goal.target()? {
        GoalTarget::On { .. } | GoalTarget::At { .. } => centre(solid.world_from_goal(goal, scene)?),
        GoalTarget::Within { surface, region } => {
            let index = scene.surfaces().iter().position(|s| s.name() == surface)?;
            let part = scene.surfaces().get(index)?.clone();
            let region = region.over(&part)?;
            let [min, max] = [region.min, region.max].map(Point2::from);
            Whereabouts::Within { support: supports.holding(object, index), part, min, max }
        }
    };
    let grip = match goal.state() {
        GoalState::Released => Grip::Released,
        GoalState::Held => Grip::Held,
        GoalState::Any => Grip::Any,
    };
    // How a round object is turned is nothing that anybody could see.
    let is_round = spec.symmetry() == Symmetry::Z;
    let yaw = goal.yaw.filter(|_| !is_round).map(|yaw| (yaw, goal.yaw_tolerance));
    Some(ObjectGoal { object: ObjectId::new(object), whereabouts, tolerance_m: goal.tolerance_m, yaw, grip })
}
