//! A crane that is bolted down: two slides, and a hand that always points down, at one height. The smallest robot whose hand is
//! tied, made of functions like the [`Gantry`](super::gantry::Gantry).
//!
//! The arm's joints are `[x, y]`, along the axes of the base. The hand is never turned: what looks alike from all sides has to be
//! turned for it.

use std::f64::consts::FRAC_PI_2;

use darrt_core::space::so2;
use darrt_geom::body::Body;
use darrt_geom::error::GeomError;
use darrt_geom::shape::Shape;
use nalgebra::{Isometry3, Point2, Translation3, Unit, UnitQuaternion, Vector3};
use rand::Rng;

use super::gantry::{Gripper, MAX_GAP_M, TIP_BEYOND_TOOL_M, TIP_HALF_WIDTH_M};
use crate::hand_ties::HandTies;
use crate::kinematics::JointLimit;
use crate::manipulator::{Configuration, Hand, LinkGroup, Manipulator, RobotLink, world_from_base};

/// Where the base is bolted down.
pub const BASE: [f64; 3] = [0.2, -0.1, 0.4];
/// How high the tool frame is, metres.
pub const HEIGHT_M: f64 = 0.6;
/// How far both slides go, metres.
const SLIDE_M: f64 = 0.8;
const LIMITS: [JointLimit; 2] = [JointLimit::new(-SLIDE_M, SLIDE_M); 2];
/// Half the thickness of a finger, metres.
const FINGER_HALF_M: f64 = 0.01;
/// How far a pose may be off and count as reached, metres and radians.
const ROUNDING: f64 = 1e-9;
/// Farthest point of the robot from the axis of its base: slides and fingers, metres.
const FARTHEST_M: f64 = 1.5;

/// What a robot answers when it is asked how to turn something.
pub type Turn = fn(&[f64; 3], &Isometry3<f64>, &Point2<f64>, &mut dyn Rng) -> Option<f64>;

/// The robot. All functions are the honest ones by default.
#[derive(Debug, Clone)]
pub struct Crane {
    /// [`Manipulator::hand_ties`].
    pub ties: fn() -> HandTies,
    /// [`Manipulator::turn_to_reach`].
    pub turn: Turn,
    /// [`Manipulator::payload_kg`].
    pub payload_kg: fn() -> f64,
    links: Vec<RobotLink>,
}

impl Crane {
    /// The honest robot.
    ///
    /// # Errors
    /// None that could happen: the sizes are constants.
    pub fn new() -> Result<Self, GeomError> {
        let finger = |name: &str| -> Result<RobotLink, GeomError> {
            let half = Vector3::new(TIP_BEYOND_TOOL_M, FINGER_HALF_M, TIP_HALF_WIDTH_M);
            Ok(RobotLink { body: Body::single(name, Shape::cuboid(half)?)?, group: LinkGroup::Finger })
        };
        let links = vec![finger("left finger")?, finger("right finger")?];
        Ok(Self { ties, turn, payload_kg: || 2.0, links })
    }
}

/// Up is against the hand, which points down, and it neither rises nor sinks.
pub fn ties() -> HandTies {
    HandTies { up_in_tool: Some(Unit::new_unchecked(-Vector3::x())), height_m: Some(HEIGHT_M) }
}

/// The turn that brings the fingers back into line with the base.
pub fn turn(base: &[f64; 3], world_from_tool: &Isometry3<f64>, _: &Point2<f64>, _: &mut dyn Rng) -> Option<f64> {
    let opening = world_from_tool.rotation * Vector3::y();
    Some(so2::wrap(base[2] + FRAC_PI_2 - opening.y.atan2(opening.x)))
}

fn base_from_tool([x, y]: [f64; 2]) -> Isometry3<f64> {
    let down = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), FRAC_PI_2);
    Isometry3::from_parts(Translation3::new(x, y, HEIGHT_M), down)
}

fn solve(base: &[f64; 3], world_from_tool: &Isometry3<f64>) -> Option<[f64; 2]> {
    let wanted = world_from_base(base).inverse() * world_from_tool;
    let at = wanted.translation.vector;
    let arm = [at.x, at.y];
    let off = base_from_tool(arm);
    let fits = (at.z - HEIGHT_M).abs() <= ROUNDING && wanted.rotation.angle_to(&off.rotation) <= ROUNDING;
    // Rounding of the last place, at the stops.
    let holds = arm.iter().all(|x| x.abs() <= SLIDE_M + ROUNDING);
    (fits && holds).then(|| arm.map(|x| x.clamp(-SLIDE_M, SLIDE_M)))
}

impl Manipulator for Crane {
    type Joints = [f64; 2];

    fn hand(&self) -> &dyn Hand {
        &Gripper { max_gap_m: MAX_GAP_M, pad_length_m: 2.0 * TIP_HALF_WIDTH_M, grip_force_n: 50.0 }
    }

    fn limits(&self) -> &[JointLimit] {
        &LIMITS
    }

    fn world_from_tool(&self, q: &Configuration<[f64; 2]>) -> Isometry3<f64> {
        world_from_base(&q.base) * base_from_tool(q.arm)
    }

    fn inverse(&self, base: &[f64; 3], world_from_tool: &Isometry3<f64>, _: &mut dyn Rng) -> Option<[f64; 2]> {
        solve(base, world_from_tool)
    }

    fn inverse_near(&self, base: &[f64; 3], world_from_tool: &Isometry3<f64>, _: &[f64; 2]) -> Option<[f64; 2]> {
        solve(base, world_from_tool)
    }

    fn base_for(&self, _: &Isometry3<f64>, _: &mut dyn Rng) -> [f64; 3] {
        BASE
    }

    fn may_reach(&self, base: &[f64; 3], world_from_tool: &Isometry3<f64>) -> bool {
        solve(base, world_from_tool).is_some()
    }

    fn links(&self) -> &[RobotLink] {
        &self.links
    }

    fn self_pairs(&self) -> &[(usize, usize)] {
        &[]
    }

    fn turn_to_reach(
        &self,
        base: &[f64; 3],
        world_from_tool: &Isometry3<f64>,
        centre: &Point2<f64>,
        rng: &mut dyn Rng,
    ) -> Option<f64> {
        (self.turn)(base, world_from_tool, centre, rng)
    }

    fn link_poses(&self, q: &Configuration<[f64; 2]>, gap_m: f64, out: &mut [Isometry3<f64>]) {
        let tool = self.world_from_tool(q);
        for (slot, side) in out.iter_mut().zip([1.0, -1.0]) {
            *slot = tool * Translation3::new(0.0, side * (0.5 * gap_m + FINGER_HALF_M), 0.0);
        }
    }

    fn travel_m(&self, a: &Configuration<[f64; 2]>, b: &Configuration<[f64; 2]>, held_reach_m: f64) -> f64 {
        let slide = (b.arm[0] - a.arm[0]).hypot(b.arm[1] - a.arm[1]);
        let drive = (b.base[0] - a.base[0]).hypot(b.base[1] - a.base[1]);
        slide + drive + so2::turn(a.base[2], b.base[2]).abs() * (FARTHEST_M + held_reach_m)
    }

    fn payload_kg(&self) -> f64 {
        (self.payload_kg)()
    }

    fn hand_ties(&self) -> HandTies {
        (self.ties)()
    }

    fn joint_weights_m(&self) -> &[f64] {
        &[1.0; 2]
    }
}
