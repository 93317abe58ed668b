//! The gantry's kinematics.

use std::f64::consts::{FRAC_PI_2, PI};

use darrt_core::space::so2::{turn, wrap};
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use rand::{Rng, RngExt};

use super::TOOL_M;
use crate::kinematics::JointLimit;
use crate::kinematics::limit::wrap_to_pi;
use crate::manipulator;

/// `[x, y, z, reach, swing, bend, turn]`, metres and radians.
pub type Joints = [f64; 7];
/// Base and arm.
pub type Configuration = manipulator::Configuration<Joints>;

/// Limits of the joints; the swing is continuous.
pub const LIMITS: [JointLimit; 7] = [
    JointLimit::new(-1.2, 1.2),
    JointLimit::new(-1.2, 1.2),
    JointLimit::new(0.4, 1.8),
    JointLimit::new(0.0, 0.5),
    JointLimit::UNLIMITED,
    JointLimit::new(0.1, 3.0),
    JointLimit::new(-2.5, 2.5),
];
/// Farthest corner of hand and fingers from the tool frame, rounded up, metres.
const HAND_REACH_M: f64 = 0.12;
/// Values outside a limit by this little are rounding errors, metres or radians.
const SLACK: f64 = 1e-12;

/// The base's frame in the world.
pub fn world_from_base(&[x, y, yaw]: &[f64; 3]) -> Isometry3<f64> {
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw);
    Isometry3::from_parts(Translation3::new(x, y, 0.0), turn)
}

/// Where the wrist is in the base's frame.
pub fn base_from_wrist(&[x, y, z, reach, ..]: &Joints) -> Vector3<f64> {
    Vector3::new(x + reach, y, z)
}

/// How the hand is turned against the base: about z, y and z again.
pub fn base_from_hand(&[.., swing, bend, turn]: &Joints) -> UnitQuaternion<f64> {
    let about = UnitQuaternion::from_axis_angle;
    about(&Vector3::z_axis(), swing) * about(&Vector3::y_axis(), bend) * about(&Vector3::z_axis(), turn)
}

/// Pose of the tool.
pub fn forward(q: &Configuration) -> Isometry3<f64> {
    let wrist = Isometry3::from_parts(base_from_wrist(&q.arm).into(), base_from_hand(&q.arm));
    world_from_base(&q.base) * wrist * Translation3::new(TOOL_M, 0.0, 0.0)
}

/// Solution with the reach drawn at random.
pub fn inverse(base: &[f64; 3], world_from_tool: &Isometry3<f64>, rng: &mut dyn Rng) -> Option<Joints> {
    let reach = rng.random_range(LIMITS[3].lower..=LIMITS[3].upper);
    solve(base, world_from_tool, reach)
}

/// Solution with the reach of `near`, or the nearest that the slide along x leaves.
pub fn near(base: &[f64; 3], world_from_tool: &Isometry3<f64>, near: &Joints) -> Option<Joints> {
    solve(base, world_from_tool, near[3])
}

/// The solution whose reach is as near to `reach` as the limits allow.
pub fn solve(base: &[f64; 3], world_from_tool: &Isometry3<f64>, reach: f64) -> Option<Joints> {
    let tool = world_from_base(base).inverse() * world_from_tool;
    let wrist = tool * nalgebra::Point3::new(-TOOL_M, 0.0, 0.0);
    // Rows of the rotation matrix: the hand's z axis, and the base's z axis in the hand.
    let (own_z, base_z) = (tool.rotation * Vector3::z(), tool.rotation.inverse() * Vector3::z());
    let bend = own_z.x.hypot(own_z.y).atan2(own_z.z);
    let swing = own_z.y.atan2(own_z.x);
    let turn = base_z.y.atan2(-base_z.x);
    // The two slides along x share the way.
    let least = LIMITS[3].lower.max(wrist.x - LIMITS[0].upper);
    let most = LIMITS[3].upper.min(wrist.x - LIMITS[0].lower);
    let reach = reach.min(most).max(least);
    let mut joints = [wrist.x - reach, wrist.y, wrist.z, reach, wrap_to_pi(swing), bend, turn];
    for (value, limit) in joints.iter_mut().zip(LIMITS) {
        let wide = JointLimit::new(limit.lower - SLACK, limit.upper + SLACK);
        if !wide.contains(*value) {
            return None;
        }
        *value = limit.clamp(*value);
    }
    Some(joints)
}

/// The base somewhere near the place under the hand, in any direction.
pub fn base_for(world_from_tool: &Isometry3<f64>, rng: &mut dyn Rng) -> [f64; 3] {
    let [dx, dy] = [0, 1].map(|_| rng.random_range(-0.4..0.4));
    let at = world_from_tool.translation.vector;
    [at.x + dx, at.y + dy, rng.random_range(-PI..PI)]
}

/// Is the hand no farther than slides and wrist together reach?
pub fn may_reach(base: &[f64; 3], world_from_tool: &Isometry3<f64>) -> bool {
    let at = (world_from_base(base).inverse() * world_from_tool).translation.vector;
    at.x.hypot(at.y) <= (1.7_f64).hypot(1.2) + TOOL_M && at.z <= 1.8 + TOOL_M && at.z >= 0.4 - TOOL_M
}

/// Slides count as they are, turns by the farthest point that they carry.
pub fn travel(a: &Configuration, b: &Configuration, held_reach_m: f64) -> f64 {
    let carried = TOOL_M + HAND_REACH_M.max(held_reach_m);
    let [x, y, z, reach, _, bend, spin] = std::array::from_fn(|i| (b.arm[i] - a.arm[i]).abs());
    let slides = (x + reach).hypot(y).hypot(z);
    let turns = turn(a.arm[4], b.arm[4]).abs() + bend + spin;
    let base = (b.base[0] - a.base[0]).hypot(b.base[1] - a.base[1]);
    let farthest = 1.7_f64.hypot(1.2) + carried;
    slides + turns * carried + base + turn(a.base[2], b.base[2]).abs() * farthest
}

/// The arm with its hand pointing down, the wrist at this place in the base's frame, fingers turned by `swing`.
pub fn pointing_down(x: f64, y: f64, z: f64, swing: f64) -> Joints {
    [x, y, z, 0.0, wrap(swing), FRAC_PI_2, 0.0]
}
