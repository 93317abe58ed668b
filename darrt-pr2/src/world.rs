//! From a problem file to a problem that the planner can solve: robot, domain, start, goal, primitives, validity.

use std::path::Path;
use std::sync::Arc;

use darrt_core::primitive::Primitive;
use darrt_core::state::{ObjectId, State};
use darrt_geom::scene::Scene;
use darrt_primitives::arm_space::ArmSpace;
use darrt_primitives::contact::MAX_LEAN;
use darrt_primitives::goal::{Grip, ObjectGoal, TabletopGoal, Whereabouts};
use darrt_primitives::manipulator::{Configuration, Manipulator};
use darrt_primitives::mode::Mode;
use darrt_primitives::object_space::{ObjectSpace, ObjectSpaceParts};
use darrt_primitives::push::edge_stop::{EdgeRule, RimReach};
use darrt_primitives::surroundings::NearPair;
use darrt_primitives::tabletop::{
    ActionSettings, Movable, ObjectFriction, PlaceSettings, PushSettings, Tabletop, TabletopState,
};
use nalgebra::{Isometry3, Point2, Vector3};

use crate::arm::{ArmConfiguration, LimitKind, Side};
use crate::grasp_families::{families, lift_m};
use crate::model::{Pr2Model, WholeBody};
use crate::planning_error::PlanningError;
use crate::postures::ArmPosture;
use crate::problem_file::geometry::Geometry;
use crate::problem_file::{self as file, GoalState, GoalTarget, PrimitiveName, ProblemFile, Symmetry};
use crate::robot::Pr2;
use crate::supports::Supports;

/// The domain: the PR2 at tables.
pub type World = Tabletop<Pr2>;
/// Its state.
pub type WorldState = TabletopState<Pr2>;

/// Gap of the empty gripper where no action asks for another, metres.
const TRAVEL_GAP: f64 = 0.08;
/// Free distance that a rim grasp keeps between fingertips and edge, metres.
const RIM_CLEARANCE: f64 = 0.01;
/// How much the fingers open to let go of an object, metres: at a table's corner there is no room for more.
const RELEASE_OPENING: f64 = 0.01;
/// Share of object samples that stand on a surface.
const SURFACE_SHARE: f64 = 0.7;

/// Everything that a problem file says, built.
#[derive(Debug)]
pub struct Built {
    /// M.
    pub world: World,
    /// The initial state.
    pub start: WorldState,
    /// G.
    pub goal: TabletopGoal,
    /// The fixed bodies and the surfaces.
    pub scene: Scene,
    /// What the problem itself puts nearer to each other than the least margin.
    pub near: Vec<NearPair>,
}

/// Builds robot, domain, start and goal.
///
/// # Errors
/// [`PlanningError`] with the key at fault when the robot's description, a shape, a grasp or a number cannot be used.
pub fn build(problem: &ProblemFile) -> Result<Built, PlanningError> {
    build_with(problem, |robot| robot)
}

/// [`build`], with the robot changed before anything is made of it.
///
/// # Errors
/// As [`build`].
pub fn build_with(problem: &ProblemFile, change: impl FnOnce(Pr2) -> Pr2) -> Result<Built, PlanningError> {
    let (robot, arm) = robot_of(problem)?;
    let robot = change(robot);
    let geometry = problem.geometry()?;
    let bounds = &problem.bounds;
    let lower = [bounds.base_x[0], bounds.base_y[0]];
    let upper = [bounds.base_x[1], bounds.base_y[1]];
    let space: ArmSpace<ArmConfiguration> = ArmSpace::new(lower, upper, robot.limits(), robot.joint_weights_m())?;

    let supports = Supports::new(problem, &geometry)?;
    let objects = problem
        .objects
        .iter()
        .zip(&geometry.objects)
        .enumerate()
        .map(|(index, (object, solid))| movable(problem, (index, object), solid, (&geometry, &supports), &robot))
        .collect::<Result<Vec<_>, _>>()?;

    let mut settings = settings(problem, robot.arm().side)?;
    // A posture that the limits in force forbid is no place to travel through.
    settings.postures.retain(|posture| space.contains_arm(posture));
    let robot = Arc::new(robot);
    let goal = goal(problem, &geometry, &supports)?;
    let rests_on = geometry.objects.iter().enumerate().map(|(index, o)| supports.holding(index, o.surface));
    let mode = Mode::resting(rests_on, TRAVEL_GAP);
    let mut world = World::new(robot, space, objects, supports.all, geometry.scene.bodies(), settings)?;
    let start = State {
        robot: Configuration { base: problem.robot.base, arm },
        objects: geometry.objects.iter().map(|o| o.world_from_object).collect(),
        mode,
    };
    let near = crate::near_pairs::accept(&mut world, &start, &goal);
    Ok(Built { world, start, goal, scene: geometry.scene, near })
}

/// The primitives that the problem allows, in the order of the paper.
pub fn primitives(problem: &ProblemFile) -> Vec<Box<dyn Primitive<World>>> {
    let one = |name: PrimitiveName| -> Box<dyn Primitive<World>> {
        match name {
            PrimitiveName::ArmTransit => Box::new(crate::arm_transit::ArmTransit),
            PrimitiveName::StraightLineArmTransit => Box::new(crate::straight_line_arm_transit::StraightLineArmTransit),
            PrimitiveName::ArmRigidTransfer => Box::new(crate::arm_rigid_transfer::ArmRigidTransfer),
            PrimitiveName::BaseTransit => Box::new(crate::base_transit::BaseTransit),
            PrimitiveName::BaseRigidTransfer => Box::new(crate::base_rigid_transfer::BaseRigidTransfer),
            PrimitiveName::Pick => Box::new(crate::pick::Pick),
            PrimitiveName::Place => Box::new(crate::place::Place),
            PrimitiveName::Push => Box::new(crate::push::Push),
        }
    };
    PrimitiveName::ALL.into_iter().filter(|name| problem.allows(*name)).map(one).collect()
}

/// The robot, and the start of its planned arm.
fn robot_of(problem: &ProblemFile) -> Result<(Pr2, ArmConfiguration), PlanningError> {
    let robot = &problem.robot;
    let model = match &robot.urdf {
        Some(path) => Pr2Model::from_file(path, &[path.parent().unwrap_or(Path::new(".")).to_path_buf()])?,
        None => Pr2Model::embedded()?,
    };
    let side = match robot.arm {
        file::ArmSide::Right => Side::Right,
        file::ArmSide::Left => Side::Left,
    };
    let limits = match robot.limits {
        file::Limits::Soft => LimitKind::Soft,
        file::Limits::Hard => LimitKind::Hard,
    };
    let arm = arm_start("robot", robot.posture.as_deref(), robot.joints.as_deref(), side)?;
    let other = arm_start("robot.other", robot.other_posture.as_deref(), robot.other_joints.as_deref(), side.other())?;
    let mut rest = WholeBody { base: robot.base, torso_m: robot.torso_m, ..WholeBody::at_rest() };
    for (at, value) in [(side, arm), (side.other(), other)] {
        if let Some(slot) = rest.arms.get_mut(at.index()) {
            *slot = value;
        }
    }
    Ok((Pr2::new(model, side, limits, rest)?, arm))
}

fn arm_start(
    key: &'static str,
    posture: Option<&str>,
    joints: Option<&[f64]>,
    side: Side,
) -> Result<ArmConfiguration, PlanningError> {
    if let Some(joints) = joints {
        let found = joints.len();
        return joints.try_into().map_err(|_| PlanningError::JointCount { key, found });
    }
    Ok(posture_named(posture.unwrap_or(file::robot::DEFAULT_POSTURE))?.values(side))
}

fn posture_named(name: &str) -> Result<ArmPosture, PlanningError> {
    ArmPosture::from_name(name).ok_or_else(|| PlanningError::UnknownPosture { name: name.to_owned() })
}

fn movable(
    problem: &ProblemFile,
    (index, object): (usize, &file::Object),
    solid: &file::geometry::StartingObject,
    (geometry, supports): (&Geometry, &Supports),
    robot: &Pr2,
) -> Result<(ObjectSpace, Movable), PlanningError> {
    let reach_m = solid.body.parts.iter().fold(0.0_f64, |most, part| {
        let (centre, radius) = part.shape.bounding_sphere();
        most.max((part.body_from_shape * centre).coords.norm() + radius)
    });
    let radius = object.shape.round_radius();
    let bounds = &problem.bounds;
    let space = ObjectSpace::new(ObjectSpaceParts {
        lower: [bounds.object_x[0], bounds.object_y[0], bounds.object_z[0]],
        upper: [bounds.object_x[1], bounds.object_y[1], bounds.object_z[1]],
        is_round: object.symmetry() == Symmetry::Z,
        metres_per_rad: radius.unwrap_or(reach_m),
        half_height_m: solid.depth_below_origin,
        surfaces: supports.surfaces_of(index).cloned().collect(),
        surface_share: SURFACE_SHARE,
        edge_margin_m: problem.safety.edge_margin_m,
    })?;
    let rim = RimReach { insertion: object.rim.insertion_m, clearance: RIM_CLEARANCE, ..RimReach::default() };
    let named = |flaw| PlanningError::Grasp { object: object.name.clone(), index, flaw };
    let movable = Movable {
        body: solid.body.clone(),
        round_radius_m: radius,
        half_height_m: solid.depth_below_origin,
        reach_m,
        is_pushable: object.pushable(),
        surfaces: supports.of_object(index).into(),
        grasps: families(object, robot.hand()).map_err(named)?,
        rim,
        lift_m: lift_m(object),
        mass_kg: object.mass_kg,
        friction: ObjectFriction { table: object.friction.table, fingers: object.friction.fingers },
        max_tilt_rad: object.max_tilt_deg().to_radians(),
        brinks: crate::goal_edges::brinks(problem, index, solid.depth_below_origin, geometry, supports),
    };
    Ok((space, movable))
}

fn settings(problem: &ProblemFile, side: Side) -> Result<ActionSettings<ArmConfiguration>, PlanningError> {
    let push = &problem.push;
    let postures = problem.transit.postures.iter().map(|name| Ok(posture_named(name)?.values(side)));
    Ok(ActionSettings {
        push: PushSettings {
            gap_m: push.gap_m,
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
            release_opening_m: RELEASE_OPENING,
        },
        safety: problem.safety.settings(),
        retreat_m: push.retreat_m.planned()?,
        line_step_m: 0.05,
        drives: [problem.allows(PrimitiveName::BaseTransit), problem.allows(PrimitiveName::BaseRigidTransfer)],
        base_tries: 24,
        grasp_tries: 4,
        postures: postures.collect::<Result<_, PlanningError>>()?,
        travel_gap_m: TRAVEL_GAP,
    })
}

fn goal(problem: &ProblemFile, geometry: &Geometry, supports: &Supports) -> Result<TabletopGoal, PlanningError> {
    let mut groups = Vec::new();
    for (name, alternatives) in problem.goal.by_object() {
        let unknown = || PlanningError::UnknownObject { name: name.to_owned() };
        let index = problem.objects.iter().position(|o| o.name == name).ok_or_else(unknown)?;
        geometry.objects.get(index).ok_or_else(unknown)?;
        let group = alternatives.iter().filter_map(|goal| one_goal(index, goal, geometry, supports));
        groups.push(group.collect());
    }
    Ok(TabletopGoal::new(groups))
}

/// `None` when the goal's keys contradict each other, which the file's validation has refused.
fn one_goal(object: usize, goal: &file::ObjectGoal, geometry: &Geometry, supports: &Supports) -> Option<ObjectGoal> {
    let scene = &geometry.scene;
    let solid = geometry.objects.get(object)?;
    let centre = |pose: Isometry3<f64>| Whereabouts::At(pose.translation.vector);
    let whereabouts = match goal.target()? {
        GoalTarget::On { .. } | GoalTarget::At { .. } => centre(solid.world_from_goal(goal, scene)?),
        GoalTarget::Within { surface, region } => {
            let index = scene.surfaces().iter().position(|s| s.name() == surface)?;
            Whereabouts::Within {
                support: supports.holding(object, index),
                part: scene.surfaces().get(index)?.clone(),
                min: Point2::from(region.min),
                max: Point2::from(region.max),
            }
        }
    };
    let grip = match goal.state() {
        GoalState::Released => Grip::Released,
        GoalState::Held => Grip::Held,
        GoalState::Any => Grip::Any,
    };
    let yaw = goal.yaw.map(|yaw| (yaw, goal.yaw_tolerance));
    Some(ObjectGoal { object: ObjectId::new(object), whereabouts, tolerance_m: goal.tolerance_m, yaw, grip })
}
