//! The hand in physics: it yields against its arm, and its fingers press with limited force.

use nalgebra::{Isometry3, Translation3};
use rapier3d_f64::prelude::{
    ColliderHandle, GenericJoint, GenericJointBuilder, ImpulseJointHandle, JointAxesMask, JointAxis, MassProperties,
    MotorModel, PhysicsWorld, Pose, RigidBodyBuilder, RigidBodyHandle, Vector,
};

use crate::robot::{Opening, Robot};
use crate::solids;
use crate::stage::{add_link, link_solid, pose_of};

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

/// The hand in physics.
#[derive(Debug)]
pub(crate) struct Fingers {
    tips: [RigidBodyHandle; 2],
    joints: [ImpulseJointHandle; 2],
    /// Where the arm has the tool frame,
    pub(crate) arm: RigidBodyHandle,
    /// and the hand, which yields: its frame is the tool frame.
    pub(crate) palm: RigidBodyHandle,
    /// The solids of the links between hand and tip: which tip, which of [`Hand`](crate::robot::Hand)'s links, and where in it.
    between: Vec<(usize, usize, Pose, ColliderHandle)>,
}

impl Fingers {
    pub(crate) fn new(world: &mut PhysicsWorld, robot: &Robot, poses: &[Isometry3<f64>], opening: &Opening) -> Self {
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
    pub(crate) fn offsets(&self, world: &PhysicsWorld) -> [f64; 2] {
        let pose = |handle| world.bodies.get(handle).map_or(Pose::IDENTITY, |body| *body.position());
        let tool_from_world = pose(self.palm).inverse();
        self.tips.map(|tip| (tool_from_world * pose(tip)).translation.y)
    }

    /// The two fingers are geared together: they follow a command as one, with the grip force at most, and what pushes both to
    /// one side is resisted by the stiffness of the gear.
    pub(crate) fn command(&self, world: &mut PhysicsWorld, robot: &Robot, finger: f64, now: &Opening) {
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
    (middle.into(), Isometry3::from_parts(Translation3::identity(), tool_from_tip.rotation.inverse()).into())
}
