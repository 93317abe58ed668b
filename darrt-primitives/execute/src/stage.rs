//! The world in physics: the room stands, objects are free, the robot goes where it is told, its fingers press.
//!
//! Nothing is welded: what is in the hand is there by the pressure and friction of two fingertips.

use darrt_task::problem_file::{ProblemFile, geometry::FLOOR};
use nalgebra::{Isometry3, Vector3};
use rapier3d_f64::prelude::{
    ActiveCollisionTypes, CoefficientCombineRule, ColliderBuilder, ColliderHandle, FrictionModel, GenericJoint,
    GenericJointBuilder, Group, ImpulseJointHandle, InteractionGroups, InteractionTestMode, JointAxesMask, JointAxis,
    MassProperties, MotorModel, PhysicsWorld, Pose, RigidBodyBuilder, RigidBodyHandle, SpringCoefficients, Vector,
};

use crate::error::ExecuteError;
use crate::robot::{Opening, Robot, world_from_base};
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

/// Mass of a fingertip with what drives it, kg.
const TIP_KG: f64 = 1.0;
/// Stiffness with which a fingertip is held where it is commanded, N/m,
const TIP_STIFFNESS: f64 = 20_000.0;
/// and the damping that makes this critical, N s/m.
const TIP_DAMPING: f64 = 283.0;

/// How the hand yields against where the arm has it, N/m: about what position gains of 1200 to 2400 N m/rad in the shoulder give
/// at 0.7 m from it.
const ARM_STIFFNESS: f64 = 4000.0;
/// The same for turning, N m/rad.
const ARM_TURNING_STIFFNESS: f64 = 500.0;
/// Mass of the hand without its fingers, kg,
const PALM_KG: f64 = 2.0;
/// and its moment of inertia with them and what it holds, kg m^2.
const HAND_INERTIA: f64 = 0.05;
/// An arm presses at most this many times harder than it is planned to push.
const STALL: f64 = 2.0;
/// The lever with which it then turns the hand, m.
const STALL_LEVER_M: f64 = 0.3;

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

/// The hand in physics.
#[derive(Debug)]
struct Fingers {
    tips: [RigidBodyHandle; 2],
    joints: [ImpulseJointHandle; 2],
    /// Where the arm has the tool frame,
    arm: RigidBodyHandle,
    /// and the hand, which yields: its frame is the tool frame.
    palm: RigidBodyHandle,
    /// The solids of the links between hand and tip: which tip, which of [`Hand`](crate::robot::Hand)'s links, and where in it.
    between: Vec<(usize, usize, Pose, ColliderHandle)>,
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
        robot.link_poses(&world_from_base(base), joints, &mut poses);
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
        self.robot.link_poses(&world_from_base(base), joints, &mut self.poses);
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

fn pose_of(poses: &[Isometry3<f64>], link: usize) -> Pose {
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

fn add_link(world: &mut PhysicsWorld, robot: &Robot, link: usize, body: RigidBodyBuilder) -> RigidBodyHandle {
    let body = world.bodies.insert(body);
    for piece in robot.pieces.get(link).into_iter().flatten() {
        world.colliders.insert_with_parent(link_solid(piece, link), body, &mut world.bodies);
    }
    body
}

fn link_solid(piece: &Piece, link: usize) -> ColliderBuilder {
    let kinds = ActiveCollisionTypes::default() | ActiveCollisionTypes::KINEMATIC_FIXED;
    collider(piece, Owner::Link(link), 1.0, groups(ROBOT, ROOM | TOUCHED)).active_collision_types(kinds)
}

impl Fingers {
    fn new(world: &mut PhysicsWorld, robot: &Robot, poses: &[Isometry3<f64>], opening: &Opening) -> Self {
        let at_tool = pose_of(poses, robot.tool);
        let world_from_tool: Isometry3<f64> = at_tool.into();
        let arm = world.bodies.insert(RigidBodyBuilder::kinematic_position_based().pose(at_tool));
        let mass = MassProperties::new(Vector::ZERO, PALM_KG, Vector::splat(HAND_INERTIA));
        let palm = RigidBodyBuilder::dynamic().pose(at_tool).additional_mass_properties(mass).gravity_scale(0.0);
        let palm = world.bodies.insert(palm.can_sleep(false));
        let is_finger = |link| robot.tips.contains(&link) || robot.hand.between.iter().any(|(_, at)| *at == link);
        for link in robot.hand.links.iter().copied().filter(|link| !is_finger(*link)) {
            let tool_from_link = at_tool.inverse() * pose_of(poses, link);
            for piece in robot.pieces.get(link).into_iter().flatten() {
                let solid = link_solid(piece, link).position(tool_from_link * piece.body_from_piece);
                world.colliders.insert_with_parent(solid, palm, &mut world.bodies);
            }
        }
        world.impulse_joints.insert(arm, palm, yielding(STALL * robot.push_force_n), true);
        let tip = |world: &mut PhysicsWorld, index: usize| {
            let mass = robot.pieces.get(robot.tips[index]).map(|pieces| solids::mass_properties(pieces, TIP_KG));
            let body = RigidBodyBuilder::dynamic()
                .pose((world_from_tool * opening.tool_from_tip[index]).into())
                .additional_mass_properties(mass.unwrap_or_default())
                .gravity_scale(0.0)
                .can_sleep(false);
            add_link(world, robot, robot.tips[index], body)
        };
        let tips = [tip(world, 0), tip(world, 1)];
        let joints = [0, 1].map(|index| {
            let frames = frames(&opening.tool_from_tip[index]);
            let joint = GenericJointBuilder::new(JointAxesMask::all() - JointAxesMask::LIN_Y)
                .local_frame1(frames.0)
                .local_frame2(frames.1)
                .contacts_enabled(false)
                .motor_model(JointAxis::LinY, MotorModel::ForceBased)
                .motor_position(JointAxis::LinY, opening.tool_from_tip[index].translation.y, TIP_STIFFNESS, TIP_DAMPING)
                // The gripper presses with its force, and its gear bears as much again from one side.
                .motor_max_force(JointAxis::LinY, 2.0 * robot.grip_force_n);
            world.impulse_joints.insert(palm, tips[index], joint, true)
        });
        let mut between = Vec::new();
        for (index, (tip, link)) in robot.hand.between.iter().enumerate() {
            for piece in robot.pieces.get(*link).into_iter().flatten() {
                let at = opening.tip_from_between(index, *tip) * piece.body_from_piece;
                let solid = link_solid(piece, *link).position(at);
                let solid = world.colliders.insert_with_parent(solid, tips[*tip], &mut world.bodies);
                between.push((*tip, index, piece.body_from_piece, solid));
            }
        }
        Self { tips, joints, arm, palm, between }
    }

    /// Where the tips are along the opening axis of the tool, metres.
    fn offsets(&self, world: &PhysicsWorld) -> [f64; 2] {
        let pose = |handle| world.bodies.get(handle).map_or(Pose::IDENTITY, |body| *body.position());
        let tool_from_world = pose(self.palm).inverse();
        self.tips.map(|tip| (tool_from_world * pose(tip)).translation.y)
    }

    /// The two fingers are geared together: they follow a command as one, with the grip force at most, and what pushes both to
    /// one side is resisted by the stiffness of the gear.
    fn command(&self, world: &mut PhysicsWorld, robot: &Robot, finger: f64, now: &Opening) {
        let wanted = robot.hand.at_joint(finger);
        let [a, b] = self.offsets(world);
        let most = robot.grip_force_n / TIP_STIFFNESS;
        // How much farther open than commanded they are.
        let open = (a - b) / 2.0 - wanted.half_width();
        let shift = 0.0_f64.clamp(open - most, open + most);
        for (tip, index, link_from_piece, solid) in &self.between {
            if let Some(solid) = world.colliders.get_mut(*solid) {
                solid.set_position_wrt_parent(now.tip_from_between(*index, *tip) * *link_from_piece);
            }
        }
        for (index, outward) in [(0, 1.0), (1, -1.0)] {
            let frames = frames(&now.tool_from_tip[index]);
            if let Some(joint) = world.impulse_joints.get_mut(self.joints[index], false) {
                let target = wanted.tool_from_tip[index].translation.y + outward * shift;
                joint.data.set_local_frame1(frames.0).set_local_frame2(frames.1);
                joint.data.set_motor_position(JointAxis::LinY, target, TIP_STIFFNESS, TIP_DAMPING);
            }
        }
    }
}

/// What holds the hand where the arm has it: springs in all six directions, with limited force.
fn yielding(most_n: f64) -> GenericJoint {
    let straight = damping(ARM_STIFFNESS, PALM_KG + 2.0 * TIP_KG);
    let turning = damping(ARM_TURNING_STIFFNESS, HAND_INERTIA);
    let axes = [JointAxis::LinX, JointAxis::LinY, JointAxis::LinZ].map(|axis| (axis, ARM_STIFFNESS, straight, most_n));
    let turns = [JointAxis::AngX, JointAxis::AngY, JointAxis::AngZ];
    let turns = turns.map(|axis| (axis, ARM_TURNING_STIFFNESS, turning, most_n * STALL_LEVER_M));
    let mut joint = GenericJoint::new(JointAxesMask::empty());
    for (axis, stiffness, damping, most) in axes.into_iter().chain(turns) {
        joint.set_motor_model(axis, MotorModel::ForceBased);
        joint.set_motor_position(axis, 0.0, stiffness, damping);
        joint.set_motor_max_force(axis, most);
    }
    joint.set_contacts_enabled(false);
    joint
}

/// Damping with which a mass on a spring comes to rest soonest.
fn damping(stiffness: f64, mass: f64) -> f64 {
    2.0 * (stiffness * mass).sqrt()
}

/// Frames of the joint between tool and tip: it slides along the y axis of the tool, through the middle of the hand.
fn frames(tool_from_tip: &Isometry3<f64>) -> (Pose, Pose) {
    let mut middle = Isometry3::from(tool_from_tip.translation);
    middle.translation.y = 0.0;
    (middle.into(), Isometry3::from_parts(Default::default(), tool_from_tip.rotation.inverse()).into())
}
