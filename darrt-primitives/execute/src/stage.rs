//! The world in physics: the room stands, objects are free, the robot goes where it is told, its fingers press.
//!
//! Nothing is welded: what is in the hand is there by the pressure and friction of two fingertips.

use darrt_primitives::manipulator::world_from_base;
use darrt_task::problem_file::{ProblemFile, geometry::FLOOR};
use nalgebra::{Isometry3, Vector3};
use rapier3d_f64::prelude::{
    ActiveCollisionTypes, CoefficientCombineRule, ColliderBuilder, FrictionModel, Group, InteractionGroups,
    InteractionTestMode, PhysicsWorld, Pose, RigidBodyBuilder, RigidBodyHandle, SpringCoefficients, Vector,
};

use crate::error::ExecuteError;
use crate::fingers::Fingers;
use crate::robot::{Opening, Robot};
use crate::solids::{self, Piece};

/// Time step, s. At 1/60 s pads sink into what they hold.
pub(crate) const STEP_S: f64 = 1.0 / 240.0;
/// How stiff contacts are, Hz: at the engine's 30 a plate is thrown out of the hand by 100 N, at 1000 contacts jitter.
const CONTACT_HZ: f64 = 240.0;
/// Iterations of the solver, outer and inner. With the engine's 4 and 1 a plate creeps through the hand that carries it, 3 to
/// 55 mm in a plan, with these 0.2 to 1.1 mm.
const ITERATIONS: [usize; 2] = [8, 4];
/// Gravity, m/s^2.
pub(crate) const GRAVITY: f64 = 9.81;

/// Fingers nearer than this to being closed altogether have nothing between them, m.
const CLOSED_M: f64 = 0.0005;

const ROOM: Group = Group::GROUP_1;
/// Objects for room and objects,
const OBJECT: Group = Group::GROUP_2;
/// and once more for the robot, with another friction.
const TOUCHED: Group = Group::GROUP_3;
const ROBOT: Group = Group::GROUP_4;

/// Whom a solid belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Owner {
    /// A fixed body, by its index in the scene.
    Room(usize),
    /// A movable object, by its index in the problem.
    Object(usize),
    /// A link of the robot.
    Link(usize),
}

impl Owner {
    fn code(self) -> u128 {
        let (kind, index) = match self {
            Self::Room(index) => (0, index),
            Self::Object(index) => (1, index),
            Self::Link(index) => (2, index),
        };
        (index as u128) * 3 + kind
    }

    fn of(code: u128) -> Self {
        let index = usize::try_from(code / 3).unwrap_or(usize::MAX);
        match code % 3 {
            0 => Self::Room(index),
            1 => Self::Object(index),
            _ => Self::Link(index),
        }
    }
}

/// A movable object as it truly is.
#[derive(Debug, Clone)]
pub(crate) struct TrueObject {
    pub(crate) world_from_object: Isometry3<f64>,
    pub(crate) mass_kg: f64,
    pub(crate) table_friction: f64,
    pub(crate) finger_friction: f64,
}

/// What does not change from run to run.
#[derive(Debug)]
pub(crate) struct Scenery {
    /// Each with the index of its body.
    fixed: Vec<(usize, Piece)>,
    pub(crate) names: Vec<String>,
    pub(crate) floor: Option<usize>,
    objects: Vec<Vec<Piece>>,
}

impl Scenery {
    pub(crate) fn new(problem: &ProblemFile) -> Result<Self, ExecuteError> {
        let scene = problem.scene()?;
        let mut fixed = Vec::new();
        for (index, body) in scene.bodies().iter().enumerate() {
            for part in &body.body.parts {
                let world_from_part = body.world_from_body * part.body_from_shape;
                fixed.push((index, solids::of_part(&body.body.name, &part.shape, &world_from_part)?));
            }
        }
        let names: Vec<_> = scene.bodies().iter().map(|body| body.body.name.to_string()).collect();
        let floor = names.iter().position(|name| name == FLOOR);
        let objects = problem.objects.iter().map(|object| solids::of_object(&object.name, &object.shape));
        Ok(Self { fixed, names, floor, objects: objects.collect::<Result<_, _>>()? })
    }
}

#[cfg(test)]
impl Scenery {
    /// A room of one body.
    pub(crate) fn of_pieces(pieces: Vec<Piece>) -> Self {
        let fixed = pieces.into_iter().map(|piece| (0, piece)).collect();
        Self { fixed, names: vec!["room".to_owned()], floor: None, objects: Vec::new() }
    }

    /// No room and one object.
    pub(crate) fn of_object(pieces: Vec<Piece>) -> Self {
        Self { fixed: Vec::new(), names: Vec::new(), floor: None, objects: vec![pieces] }
    }
}

/// The world of one run.
pub(crate) struct Stage<'a> {
    robot: &'a Robot,
    pub(crate) world: PhysicsWorld,
    objects: Vec<RigidBodyHandle>,
    /// Links with solids but for those of the hand.
    links: Vec<(usize, RigidBodyHandle)>,
    fingers: Fingers,
    poses: Vec<Isometry3<f64>>,
}

impl std::fmt::Debug for Stage<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Stage").field("objects", &self.objects).field("links", &self.links).finish_non_exhaustive()
    }
}

/// An empty world with the settings that were measured.
pub(crate) fn empty_world() -> PhysicsWorld {
    let mut world = PhysicsWorld { gravity: Vector::new(0.0, 0.0, -GRAVITY), ..PhysicsWorld::default() };
    let softness = SpringCoefficients { natural_frequency: CONTACT_HZ, damping_ratio: 1.0 };
    let how = &mut world.integration_parameters;
    how.dt = STEP_S;
    how.contact_softness = softness;
    how.static_contact_softness = softness;
    how.friction_model = FrictionModel::Coulomb;
    // A contact may be seen as it was only as long as nothing has moved by 5 cm: far too long for us.
    how.contact_recycling = false;
    how.num_solver_iterations = ITERATIONS[0];
    how.num_internal_pgs_iterations = ITERATIONS[1];
    world
}

fn groups(member: Group, with: Group) -> InteractionGroups {
    InteractionGroups::new(member, with, InteractionTestMode::And)
}

/// What the robot's solids meet.
#[cfg(test)]
pub(crate) fn robot_group() -> InteractionGroups {
    groups(ROBOT, ROOM | TOUCHED)
}

fn collider(piece: &Piece, owner: Owner, friction: f64, groups: InteractionGroups) -> ColliderBuilder {
    ColliderBuilder::new(piece.shape.clone())
        .position(piece.body_from_piece)
        .density(0.0)
        .friction(friction)
        // The room and the robot have friction 1: that of a pair is the object's.
        .friction_combine_rule(CoefficientCombineRule::Multiply)
        .restitution(0.0)
        .collision_groups(groups)
        .user_data(owner.code())
}

/// Puts the room into a world.
pub(crate) fn add_room(world: &mut PhysicsWorld, scenery: &Scenery) {
    for (index, piece) in &scenery.fixed {
        let solid = collider(piece, Owner::Room(*index), 1.0, groups(ROOM, OBJECT | ROBOT));
        world.insert(RigidBodyBuilder::fixed(), solid);
    }
}

/// Puts an object into a world.
pub(crate) fn add_object(world: &mut PhysicsWorld, index: usize, pieces: &[Piece], is: &TrueObject) -> RigidBodyHandle {
    let body = RigidBodyBuilder::dynamic()
        .pose(is.world_from_object.into())
        .additional_mass_properties(solids::mass_properties(pieces, is.mass_kg))
        .can_sleep(false);
    let body = world.bodies.insert(body);
    for piece in pieces {
        let kinds = [(OBJECT, ROOM | OBJECT, is.table_friction), (TOUCHED, ROBOT, is.finger_friction)];
        for (member, with, friction) in kinds {
            let solid = collider(piece, Owner::Object(index), friction, groups(member, with));
            world.colliders.insert_with_parent(solid, body, &mut world.bodies);
        }
    }
    body
}

impl<'a> Stage<'a> {
    /// The world at the start of a plan.
    pub(crate) fn new(
        robot: &'a Robot,
        scenery: &Scenery,
        objects: &[TrueObject],
        base: [f64; 3],
        joints: &[f64],
    ) -> Self {
        let mut world = empty_world();
        add_room(&mut world, scenery);
        let pairs = scenery.objects.iter().zip(objects).enumerate();
        let objects = pairs.map(|(index, (pieces, is))| add_object(&mut world, index, pieces, is)).collect();
        let mut poses = Vec::new();
        robot.link_poses(&world_from_base(&base), joints, &mut poses);
        let mut links = Vec::new();
        for (link, pieces) in robot.pieces.iter().enumerate() {
            if pieces.is_empty() || robot.hand.links.contains(&link) {
                continue;
            }
            let body = RigidBodyBuilder::kinematic_position_based().pose(pose_of(&poses, link));
            links.push((link, add_link(&mut world, robot, link, body)));
        }
        let opening = robot.hand.at_joint(joints.get(robot.finger).copied().unwrap_or_default());
        let fingers = Fingers::new(&mut world, robot, &poses, &opening);
        Self { robot, world, objects, links, fingers, poses }
    }

    /// One time step, in which the robot goes to these values of base and joints.
    ///
    /// The joint of the fingers stands where they are, whatever `joints` says of it; `finger` commands it.
    pub(crate) fn step(&mut self, base: [f64; 3], joints: &mut [f64], finger: f64) {
        let now = self.opening();
        if let Some(slot) = joints.get_mut(self.robot.finger) {
            *slot = now.joint;
        }
        self.robot.link_poses(&world_from_base(&base), joints, &mut self.poses);
        for (link, handle) in &self.links {
            go_to(&mut self.world, *handle, pose_of(&self.poses, *link));
        }
        go_to(&mut self.world, self.fingers.arm, pose_of(&self.poses, self.robot.tool));
        self.fingers.command(&mut self.world, self.robot, finger, &now);
        self.world.step();
    }

    /// The robot.
    pub(crate) const fn robot(&self) -> &'a Robot {
        self.robot
    }

    /// Have the fingers closed on nothing?
    pub(crate) fn is_closed(&self) -> bool {
        let closed = self.robot.hand.at_joint(self.robot.hand.closed()).half_width();
        self.opening().half_width() - closed < CLOSED_M
    }

    /// How far the fingers are open.
    pub(crate) fn opening(&self) -> Opening {
        let [a, b] = self.fingers.offsets(&self.world);
        self.robot.hand.at_half_width((a - b) / 2.0)
    }

    /// Where an object is.
    pub(crate) fn object(&self, index: usize) -> Isometry3<f64> {
        let body = self.objects.get(index).and_then(|handle| self.world.bodies.get(*handle));
        body.map_or_else(Isometry3::identity, |body| (*body.position()).into())
    }

    /// Where the tool frame is.
    pub(crate) fn world_from_tool(&self) -> Isometry3<f64> {
        self.pose(self.fingers.palm)
    }

    /// How far the hand is from where the arm has it, m.
    pub(crate) fn lag_m(&self) -> f64 {
        (self.pose(self.fingers.arm).translation.vector - self.world_from_tool().translation.vector).norm()
    }

    fn pose(&self, body: RigidBodyHandle) -> Isometry3<f64> {
        self.world.bodies.get(body).map_or_else(Isometry3::identity, |body| (*body.position()).into())
    }

    /// Every touching pair: who, how deep (m), and the force on the first (N).
    pub(crate) fn contacts(&self) -> impl Iterator<Item = Contact> + '_ {
        self.world.contact_pairs().filter_map(|pair| {
            let owner = |handle| self.world.colliders.get(handle).map(|collider| Owner::of(collider.user_data));
            let (first, second) = (owner(pair.collider1)?, owner(pair.collider2)?);
            let points = pair.manifolds().iter().flat_map(|manifold| &manifold.points);
            let depth_m = points.map(|point| -point.dist).reduce(f64::max)?;
            // The normal points from the first to the second.
            let impulse = pair.total_impulse();
            let force = -Vector3::new(impulse.x, impulse.y, impulse.z) / STEP_S;
            Some(if first <= second {
                Contact { pair: (first, second), depth_m, force }
            } else {
                Contact { pair: (second, first), depth_m, force: -force }
            })
        })
    }
}

/// Two solids that touch or nearly do.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Contact {
    /// In order: room, object, link.
    pub(crate) pair: (Owner, Owner),
    pub(crate) depth_m: f64,
    /// On the first of the pair, N.
    pub(crate) force: Vector3<f64>,
}

/// Where a link is.
pub(crate) fn pose_of(poses: &[Isometry3<f64>], link: usize) -> Pose {
    poses.get(link).copied().unwrap_or_else(Isometry3::identity).into()
}

/// Moves a kinematic body within the next time step.
///
/// The engine takes the velocity from the difference of the quaternions: of the two that mean one rotation it gets the nearer.
fn go_to(world: &mut PhysicsWorld, body: RigidBodyHandle, mut pose: Pose) {
    if let Some(body) = world.bodies.get_mut(body) {
        if pose.rotation.dot(body.position().rotation) < 0.0 {
            pose.rotation = -pose.rotation;
        }
        body.set_next_kinematic_position(pose);
    }
}

/// Adds a body with the solids of a link.
pub(crate) fn add_link(
    world: &mut PhysicsWorld,
    robot: &Robot,
    link: usize,
    body: RigidBodyBuilder,
) -> RigidBodyHandle {
    let body = world.bodies.insert(body);
    for piece in robot.pieces.get(link).into_iter().flatten() {
        world.colliders.insert_with_parent(link_solid(piece, link), body, &mut world.bodies);
    }
    body
}

/// A solid of a link.
pub(crate) fn link_solid(piece: &Piece, link: usize) -> ColliderBuilder {
    let kinds = ActiveCollisionTypes::default() | ActiveCollisionTypes::KINEMATIC_FIXED;
    collider(piece, Owner::Link(link), 1.0, groups(ROBOT, ROOM | TOUCHED)).active_collision_types(kinds)
}
