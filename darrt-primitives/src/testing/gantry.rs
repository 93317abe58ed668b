//! A gantry on wheels: the smallest mobile manipulator with a redundant arm and a closed-form inverse, and a robot that
//! is made of functions, so that a broken one differs from it in exactly the function that is wrong.
//!
//! The arm's joints are `[x, y, z, reach, swing, bend, turn]`: three slides in the base's axes, a fourth slide along x
//! that makes it redundant, and a wrist that turns about z, y and z again. The tool frame is [`TOOL_M`] ahead of the
//! wrist along its x axis. The hand points down for `bend = pi/2` and `turn = 0`.

use darrt_geom::body::{Body, Part};
use darrt_geom::error::GeomError;
use darrt_geom::shape::Shape;
use nalgebra::{Isometry3, Translation3, Vector3};
use rand::Rng;

use crate::kinematics::JointLimit;
use crate::manipulator::{Hand, LinkGroup, Manipulator, RobotLink};

pub mod motion;

pub use motion::{Configuration, Joints};

/// From the wrist to the tool frame, metres.
pub const TOOL_M: f64 = 0.15;
/// How far the fingertips reach beyond the tool frame, metres.
pub const TIP_BEYOND_TOOL_M: f64 = 0.03;
/// Half the width of a fingertip, metres.
pub const TIP_HALF_WIDTH_M: f64 = 0.01;
/// Widest gap, metres.
pub const MAX_GAP_M: f64 = 0.1;
/// Half the thickness of a finger, metres.
const FINGER_HALF_M: f64 = 0.01;

/// The robot. All functions are the honest ones by default.
#[derive(Debug, Clone)]
pub struct Gantry {
    /// [`Manipulator::world_from_tool`].
    pub forward: fn(&Configuration) -> Isometry3<f64>,
    /// [`Manipulator::inverse`].
    pub inverse: fn(&[f64; 3], &Isometry3<f64>, &mut dyn Rng) -> Option<Joints>,
    /// [`Manipulator::inverse_near`].
    pub near: fn(&[f64; 3], &Isometry3<f64>, &Joints) -> Option<Joints>,
    /// [`Manipulator::base_for`].
    pub base_for: fn(&Isometry3<f64>, &mut dyn Rng) -> [f64; 3],
    /// [`Manipulator::may_reach`].
    pub may_reach: fn(&[f64; 3], &Isometry3<f64>) -> bool,
    /// [`Manipulator::link_poses`], in the order of [`LINKS`].
    pub poses: fn(&Configuration, f64) -> [Isometry3<f64>; 5],
    /// [`Manipulator::travel_m`].
    pub travel: fn(&Configuration, &Configuration, f64) -> f64,
    /// [`Manipulator::link_travel_m`].
    pub link_travel: fn(&Configuration, &Configuration, f64, &mut [f64]) -> f64,
    /// [`Manipulator::duration_s`].
    pub duration: fn(&Configuration, &Configuration, bool) -> f64,
    /// [`Manipulator::limits`].
    pub limits: Vec<JointLimit>,
    /// [`Manipulator::joint_weights_m`].
    pub weights_m: Vec<f64>,
    /// [`Manipulator::self_pairs`].
    pub self_pairs: Vec<(usize, usize)>,
    /// [`Manipulator::links`].
    pub links: Vec<RobotLink>,
    /// [`Manipulator::hand`].
    pub hand: Gripper,
    /// [`Manipulator::payload_kg`].
    pub payload_kg: f64,
}

/// The gripper: two plates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gripper {
    /// [`Hand::max_gap_m`].
    pub max_gap_m: f64,
    /// [`Hand::pad_length_m`].
    pub pad_length_m: f64,
    /// [`Hand::grip_force_n`].
    pub grip_force_n: f64,
}

impl Hand for Gripper {
    fn max_gap_m(&self) -> f64 {
        self.max_gap_m
    }

    fn tip_beyond_tool_m(&self, _: f64) -> f64 {
        TIP_BEYOND_TOOL_M
    }

    fn tip_half_width_m(&self) -> f64 {
        TIP_HALF_WIDTH_M
    }

    fn pad_length_m(&self) -> f64 {
        self.pad_length_m
    }

    fn grip_force_n(&self) -> f64 {
        self.grip_force_n
    }
}

/// Names, groups and half sizes (metres) of the links.
pub const LINKS: [(&str, LinkGroup, [f64; 3]); 5] = [
    ("wagon", LinkGroup::Base, [0.15, 0.15, 0.1]),
    ("wrist", LinkGroup::Arm, [0.03, 0.03, 0.03]),
    ("palm", LinkGroup::Hand, [0.03, 0.06, 0.03]),
    ("left finger", LinkGroup::Finger, [TIP_BEYOND_TOOL_M, FINGER_HALF_M, TIP_HALF_WIDTH_M]),
    ("right finger", LinkGroup::Finger, [TIP_BEYOND_TOOL_M, FINGER_HALF_M, TIP_HALF_WIDTH_M]),
];

impl Gantry {
    /// The honest robot.
    ///
    /// # Errors
    /// None that could happen: the sizes are constants.
    pub fn new() -> Result<Self, GeomError> {
        let link = |(name, group, half): (&str, LinkGroup, [f64; 3])| {
            let shape = Shape::cuboid(Vector3::from(half))?;
            Ok(RobotLink { body: Body::new(name, vec![Part::centred(shape)])?, group })
        };
        Ok(Self {
            forward: motion::forward,
            inverse: motion::inverse,
            near: motion::near,
            base_for: motion::base_for,
            may_reach: motion::may_reach,
            poses,
            travel: motion::travel,
            link_travel,
            duration: |a, b, _| 2.0 * motion::travel(a, b, 0.0),
            limits: motion::LIMITS.to_vec(),
            weights_m: vec![1.0, 1.0, 1.0, 1.0, 0.2, 0.2, 0.2],
            self_pairs: vec![(0, 2), (0, 3), (0, 4)],
            links: LINKS.into_iter().map(link).collect::<Result<_, GeomError>>()?,
            hand: Gripper { max_gap_m: MAX_GAP_M, pad_length_m: 2.0 * TIP_HALF_WIDTH_M, grip_force_n: f64::INFINITY },
            payload_kg: f64::INFINITY,
        })
    }
}

/// Every link as far as the farthest.
pub fn link_travel(a: &Configuration, b: &Configuration, held_reach_m: f64, out: &mut [f64]) -> f64 {
    let bound = motion::travel(a, b, held_reach_m);
    out.fill(bound);
    bound
}

/// Poses of all links.
pub fn poses(q: &Configuration, gap_m: f64) -> [Isometry3<f64>; 5] {
    let tool = motion::forward(q);
    let finger = |side: f64| tool * Translation3::new(0.0, side * (0.5 * gap_m + FINGER_HALF_M), 0.0);
    let base = motion::world_from_base(&q.base);
    [
        base * Translation3::new(0.0, 0.0, 0.12),
        base * Translation3::from(motion::base_from_wrist(&q.arm)),
        tool * Translation3::new(-0.08, 0.0, 0.0),
        finger(1.0),
        finger(-1.0),
    ]
}

impl Manipulator for Gantry {
    type Joints = Joints;

    fn hand(&self) -> &dyn Hand {
        &self.hand
    }

    fn limits(&self) -> &[JointLimit] {
        &self.limits
    }

    fn world_from_tool(&self, q: &Configuration) -> Isometry3<f64> {
        (self.forward)(q)
    }

    fn inverse(&self, base: &[f64; 3], world_from_tool: &Isometry3<f64>, rng: &mut dyn Rng) -> Option<Joints> {
        (self.inverse)(base, world_from_tool, rng)
    }

    fn inverse_near(&self, base: &[f64; 3], world_from_tool: &Isometry3<f64>, near: &Joints) -> Option<Joints> {
        (self.near)(base, world_from_tool, near)
    }

    fn base_for(&self, world_from_tool: &Isometry3<f64>, rng: &mut dyn Rng) -> [f64; 3] {
        (self.base_for)(world_from_tool, rng)
    }

    fn may_reach(&self, base: &[f64; 3], world_from_tool: &Isometry3<f64>) -> bool {
        (self.may_reach)(base, world_from_tool)
    }

    fn links(&self) -> &[RobotLink] {
        &self.links
    }

    fn self_pairs(&self) -> &[(usize, usize)] {
        &self.self_pairs
    }

    fn link_poses(&self, q: &Configuration, gap_m: f64, out: &mut [Isometry3<f64>]) {
        out.iter_mut().zip((self.poses)(q, gap_m)).for_each(|(slot, pose)| *slot = pose);
    }

    fn travel_m(&self, a: &Configuration, b: &Configuration, held_reach_m: f64) -> f64 {
        (self.travel)(a, b, held_reach_m)
    }

    fn link_travel_m(&self, a: &Configuration, b: &Configuration, held_reach_m: f64, out: &mut [f64]) -> f64 {
        (self.link_travel)(a, b, held_reach_m, out)
    }

    fn duration_s(&self, a: &Configuration, b: &Configuration, is_loaded: bool) -> f64 {
        (self.duration)(a, b, is_loaded)
    }

    fn joint_weights_m(&self) -> &[f64] {
        &self.weights_m
    }

    fn payload_kg(&self) -> f64 {
        self.payload_kg
    }
}
