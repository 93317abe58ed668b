//! The PR2 as a [`Manipulator`]: one arm and the base move; torso, head and the other arm stay.

use std::f64::consts::TAU;
use std::sync::Arc;

use darrt_primitives::kinematics::JointLimit;
use darrt_primitives::manipulator::{Configuration, Hand, LinkGroup, Manipulator, RobotLink};
use nalgebra::{Isometry3, Vector3};
use rand::{Rng, RngExt};

use crate::arm::{Arm, ArmConfiguration, JOINT_NAMES, LimitKind, Side};
use crate::forward::{
    ArmChain, ArmPoses, FOREARM, Frame, SHOULDER_X, SHOULDER_Y, SHOULDER_Z, TOOL, UPPER_ARM, UPPER_ARM_OFFSET,
    world_from_base,
};
use crate::gripper;
use crate::model::{ArmBody, ModelError, Pr2Model, WholeBody};
use crate::self_collision::link_pairs;
use crate::variants::reachability::Reachability;

/// Largest change of any joint between two steps along a straight line of the hand, radians.
const LINE_JOINT_STEP: f64 = 0.3;
/// Horizontal distance from the shoulder to the wrist when a base is drawn: least, metres (the authors' `MIN_BASE_DIST`).
const LEAST_WRIST_DISTANCE: f64 = 0.3;
/// Reach from the shoulder to the wrist when a base is drawn, metres: a little less than the stretched arm's 0.821.
const DRAWN_REACH: f64 = 0.78;
/// Shoulder pan for which a base is drawn, radians for the right arm: the arm works in front of its own side.
const DRAWN_PAN: [f64; 2] = [-1.4, 0.45];
/// The heaviest object that an arm carries, kilograms (Willow Garage, PR2 hardware specifications).
pub const PAYLOAD_KG: f64 = 1.8;
/// The largest force with which the hand pushes sideways, newton: the 30 N m that every joint of shoulder and elbow gives,
/// over a stretched arm of 1 m. The wrist's 10 N m reach 50 N at the fingertips.
pub const PUSH_FORCE_N: f64 = 30.0;
/// Speeds of the arm's joints, radians per second: the caps with which `MoveIt` plans for the PR2, which are below those of its
/// description.
pub(crate) const JOINT_SPEED_RAD_PER_S: [f64; 7] = [1.0, 1.0, 1.5, 1.5, 1.5, 1.5, 1.12];
/// Metres and radians per second of the base with an empty hand: a careful indoor pace, half of the metre per second that the
/// wheels can do.
pub(crate) const BASE_SPEED: [f64; 2] = [0.5, 1.0];
/// The same with something in the hand, at which simulated plates kept still between the fingers.
pub(crate) const LOADED_BASE_SPEED: [f64; 2] = [0.3, 0.6];
/// Held objects are rounded up to this when travel is bounded, metres.
const HELD_STEP: f64 = 0.05;

/// The gripper.
#[derive(Debug, Clone, Copy, Default)]
pub struct Gripper;

impl Hand for Gripper {
    fn max_gap_m(&self) -> f64 {
        gripper::MAX_GAP
    }

    fn tip_beyond_tool_m(&self, gap_m: f64) -> f64 {
        gripper::fingertip_x(gripper::finger_angle(gap_m)) - TOOL
    }

    fn tip_half_width_m(&self) -> f64 {
        gripper::TIP_HALF_WIDTH
    }

    fn pad_length_m(&self) -> f64 {
        gripper::PAD_LENGTH
    }

    fn grip_force_n(&self) -> f64 {
        gripper::GRIP_FORCE_N
    }
}

/// The planning robot.
#[derive(Debug, Clone)]
pub struct Pr2 {
    model: Pr2Model,
    arm: Arm,
    chain: ArmChain,
    rest: WholeBody,
    links: Vec<RobotLink>,
    /// The frame of each link of the moving arm; these come first.
    arm_frames: Vec<Frame>,
    /// Poses of all other links in the base frame.
    base_from_link: Vec<Isometry3<f64>>,
    self_pairs: Vec<(usize, usize)>,
    /// Joint radii by held reach, in steps of [`HELD_STEP`].
    joint_radius: Vec<[f64; 7]>,
    base_radius: f64,
    /// Levers of the moving links, see [`Pr2Model::link_levers`].
    levers: Vec<[f64; 7]>,
    /// Where bases are drawn from, if not from a ring around the wrist.
    reachability: Option<Arc<Reachability>>,
}

impl Pr2 {
    /// Held objects may reach this far beyond the tool frame, metres.
    pub const MAX_HELD_REACH: f64 = 1.0;

    /// The robot with one arm moving within `limits`; `rest` says where that arm starts, and where torso, head and the
    /// other arm stand, which may use its whole range.
    ///
    /// # Errors
    /// [`ModelError::Torso`], [`ModelError::StartOutside`] if the torso or a joint of an arm is outside its limits.
    pub fn new(model: Pr2Model, side: Side, limits: LimitKind, rest: WholeBody) -> Result<Self, ModelError> {
        check_start(&model, side, limits, &rest)?;
        check_start(&model, side.other(), LimitKind::Hard, &rest)?;
        let arm = model.arm(side, rest.torso_m, limits)?;
        let at_origin = model.link_poses(&WholeBody { base: [0.0; 3], ..rest.clone() });
        let moving: Vec<ArmBody> = model.arm_bodies(side).to_vec();
        let parked = model.arm_bodies(side.other()).iter().map(|b| b.link);
        let rigid: Vec<usize> = model.trunk_links().chain(parked).collect();
        let order: Vec<usize> = moving.iter().map(|b| b.link).chain(rigid.iter().copied()).collect();
        let links = moving
            .iter()
            .filter_map(|b| Some(RobotLink { body: model.body(b.link)?.clone(), group: group_of(b.frame) }))
            .chain(
                rigid.iter().filter_map(|l| Some(RobotLink { body: model.body(*l)?.clone(), group: LinkGroup::Base })),
            )
            .collect();
        let place = |link: usize| order.iter().position(|l| *l == link);
        let self_pairs = link_pairs(&model, side).iter().filter_map(|[a, b]| Some((place(*a)?, place(*b)?))).collect();
        let base_from_link = rigid.iter().filter_map(|l| at_origin.get(*l).copied()).collect();
        let steps = 0..=20_u32;
        let extents = model.arm_extents(side);
        let joint_radius = steps.map(|i| extents.joint_radius(HELD_STEP * f64::from(i))).collect();
        let base_radius = model.travel_bound(side, Self::MAX_HELD_REACH.min(0.3), &rest).base;
        let chain = ArmChain::new(side, rest.torso_m);
        let arm_frames = moving.iter().map(|b| b.frame).collect();
        let levers = model.link_levers(side);
        Ok(Self {
            model,
            arm,
            chain,
            rest,
            links,
            arm_frames,
            base_from_link,
            self_pairs,
            joint_radius,
            base_radius,
            levers,
            reachability: None,
        })
    }

    /// The same robot with its bases drawn from an inverse reachability model of its arm instead of from a ring around the
    /// wrist; see [`Reachability`].
    ///
    /// In the rooms of the paper 93 % of the bases that keep clear of the furniture reach then, instead of 85 %, and a
    /// stance free of collisions takes 9 % fewer draws. That saves less than the slices of the model cost in the seconds
    /// that such a problem takes, so it is not the default: it is for many queries with one robot.
    #[must_use]
    pub fn with_bases_from_reachability(mut self) -> Self {
        self.reachability = Some(Arc::new(Reachability::new(&self.arm, LEAST_WRIST_DISTANCE)));
        self
    }

    /// The kinematic model.
    pub fn model(&self) -> &Pr2Model {
        &self.model
    }

    /// The moving arm.
    pub fn arm(&self) -> &Arm {
        &self.arm
    }

    /// The whole body in one configuration, the active gripper open by `gap_m`.
    pub fn whole_body(&self, q: &Configuration<ArmConfiguration>, gap_m: f64) -> WholeBody {
        let mut body = WholeBody { base: q.base, ..self.rest.clone() };
        if let Some(arm) = body.arms.get_mut(self.arm.side.index()) {
            *arm = q.arm;
        }
        if let Some(angle) = body.finger_angles.get_mut(self.arm.side.index()) {
            *angle = gripper::finger_angle(gap_m);
        }
        body
    }

    /// The shoulder's centre (pan axis at the height of the lift axis) in the base frame.
    fn base_from_shoulder(&self) -> Vector3<f64> {
        Vector3::new(SHOULDER_X, self.arm.side.sign() * SHOULDER_Y, SHOULDER_Z + self.rest.torso_m)
    }

    fn radii(&self, held_reach_m: f64) -> [f64; 7] {
        let steps = (held_reach_m / HELD_STEP).ceil().clamp(0.0, 20.0);
        let last = self.joint_radius.len().saturating_sub(1);
        let found = self.joint_radius.iter().enumerate().find(|(i, _)| *i as f64 >= steps || *i == last);
        found.map_or([f64::INFINITY; 7], |(_, radii)| *radii)
    }
}

/// Every joint of an arm is inside its limits.
fn check_start(model: &Pr2Model, side: Side, kind: LimitKind, rest: &WholeBody) -> Result<(), ModelError> {
    let values = rest.arms.get(side.index()).into_iter().flatten();
    let limits = model.limits(side, kind).into_iter().zip(model.limits(side, LimitKind::Hard));
    for ((name, (limit, hard)), &value) in JOINT_NAMES.iter().zip(limits).zip(values) {
        // A joint that turns on and on is where it is after any number of turns; so many are degrees.
        let limit = if limit.is_unlimited() { JointLimit::new(-TAU, TAU) } else { limit };
        if !limit.contains(value) {
            let which = match kind {
                LimitKind::Soft => "soft",
                LimitKind::Hard => "hard",
            };
            let joint = format!("{}_{name}_joint", side.prefix());
            let would_do_hard = kind == LimitKind::Soft && hard.contains(value);
            let (lower, upper) = (limit.lower, limit.upper);
            return Err(ModelError::StartOutside { joint, value, which, lower, upper, would_do_hard });
        }
    }
    Ok(())
}

fn group_of(frame: Frame) -> LinkGroup {
    match frame {
        Frame::LeftFinger | Frame::RightFinger | Frame::LeftFingerTip | Frame::RightFingerTip => LinkGroup::Finger,
        Frame::WristRoll | Frame::Tool => LinkGroup::Hand,
        _ => LinkGroup::Arm,
    }
}

/// The wrist's centre for a tool pose.
fn wrist_of(world_from_tool: &Isometry3<f64>) -> Vector3<f64> {
    world_from_tool.translation.vector - world_from_tool.rotation * Vector3::new(TOOL, 0.0, 0.0)
}

impl Manipulator for Pr2 {
    type Joints = ArmConfiguration;

    fn hand(&self) -> &dyn Hand {
        &Gripper
    }

    fn limits(&self) -> &[JointLimit] {
        &self.arm.limits
    }

    fn world_from_tool(&self, q: &Configuration<ArmConfiguration>) -> Isometry3<f64> {
        self.chain.world_from_tool(&q.base, &q.arm)
    }

    fn inverse(
        &self,
        base: &[f64; 3],
        world_from_tool: &Isometry3<f64>,
        rng: &mut dyn Rng,
    ) -> Option<ArmConfiguration> {
        self.arm.inverse_any(&(world_from_base(base).inverse() * world_from_tool), rng)
    }

    fn inverse_near(
        &self,
        base: &[f64; 3],
        world_from_tool: &Isometry3<f64>,
        near: &ArmConfiguration,
    ) -> Option<ArmConfiguration> {
        self.arm.inverse_near(&(world_from_base(base).inverse() * world_from_tool), near, LINE_JOINT_STEP)
    }

    /// The shoulder in a ring around the wrist, uniform over its area, the robot roughly facing the wrist; or what the
    /// reachability model draws, where there is one that knows a base.
    fn base_for(&self, world_from_tool: &Isometry3<f64>, rng: &mut dyn Rng) -> [f64; 3] {
        if let Some(base) = self.reachability.as_ref().and_then(|model| model.base_for(world_from_tool, rng)) {
            return base;
        }
        let wrist = wrist_of(world_from_tool);
        let shoulder = self.base_from_shoulder();
        let dz = wrist.z - shoulder.z;
        let least = LEAST_WRIST_DISTANCE * LEAST_WRIST_DISTANCE;
        let most = (DRAWN_REACH * DRAWN_REACH - dz * dz).max(least + 1e-6);
        let distance = rng.random_range(least..most).sqrt();
        let bearing = rng.random_range(-std::f64::consts::PI..std::f64::consts::PI);
        // Positive pan turns left; the left arm mirrors the right one.
        let pan = -self.arm.side.sign() * rng.random_range(DRAWN_PAN[0]..DRAWN_PAN[1]);
        let yaw = darrt_core::space::so2::wrap(bearing - pan);
        let (sin, cos) = yaw.sin_cos();
        let x = wrist.x - distance * bearing.cos() - (cos * shoulder.x - sin * shoulder.y);
        let y = wrist.y - distance * bearing.sin() - (sin * shoulder.x + cos * shoulder.y);
        [x, y, yaw]
    }

    fn may_reach(&self, base: &[f64; 3], world_from_tool: &Isometry3<f64>) -> bool {
        let shoulder = world_from_base(base) * nalgebra::Point3::from(self.base_from_shoulder());
        (wrist_of(world_from_tool) - shoulder.coords).norm() <= UPPER_ARM_OFFSET + UPPER_ARM + FOREARM
    }

    fn links(&self) -> &[RobotLink] {
        &self.links
    }

    fn self_pairs(&self) -> &[(usize, usize)] {
        &self.self_pairs
    }

    fn link_poses(&self, q: &Configuration<ArmConfiguration>, gap_m: f64, out: &mut [Isometry3<f64>]) {
        let mut poses = ArmPoses::default();
        self.chain.world_from_links(&q.base, &q.arm, gripper::finger_angle(gap_m), &mut poses);
        let base = world_from_base(&q.base);
        let (moving, rigid) = out.split_at_mut(self.arm_frames.len().min(out.len()));
        for (slot, frame) in moving.iter_mut().zip(&self.arm_frames) {
            *slot = *poses.pose(*frame);
        }
        for (slot, base_from_link) in rigid.iter_mut().zip(&self.base_from_link) {
            *slot = base * base_from_link;
        }
    }

    fn travel_m(
        &self,
        a: &Configuration<ArmConfiguration>,
        b: &Configuration<ArmConfiguration>,
        held_reach_m: f64,
    ) -> f64 {
        let joints = crate::arm::joint_differences(&self.arm.limits, &a.arm, &b.arm);
        let radii = self.radii(held_reach_m);
        let arm: f64 = joints.iter().zip(&radii).map(|(d, radius)| d.abs() * radius).sum();
        let turn = darrt_core::space::so2::turn(a.base[2], b.base[2]).abs();
        let base = (b.base[0] - a.base[0]).hypot(b.base[1] - a.base[1]) + turn * (self.base_radius + held_reach_m);
        arm + base
    }

    fn link_travel_m(
        &self,
        a: &Configuration<ArmConfiguration>,
        b: &Configuration<ArmConfiguration>,
        held_reach_m: f64,
        out: &mut [f64],
    ) -> f64 {
        let joints = crate::arm::joint_differences(&self.arm.limits, &a.arm, &b.arm);
        let shift = (b.base[0] - a.base[0]).hypot(b.base[1] - a.base[1]);
        let turn = darrt_core::space::so2::turn(a.base[2], b.base[2]).abs();
        let drive = shift + turn * (self.base_radius + held_reach_m);
        let lever_travel =
            |levers: &[f64; 7]| drive + joints.iter().zip(levers).map(|(d, lever)| d.abs() * lever).sum::<f64>();
        let (moving, rigid) = out.split_at_mut(self.levers.len().min(out.len()));
        for (slot, levers) in moving.iter_mut().zip(&self.levers) {
            *slot = lever_travel(levers);
        }
        rigid.fill(drive);
        lever_travel(&self.radii(held_reach_m))
    }

    fn payload_kg(&self) -> f64 {
        PAYLOAD_KG
    }

    fn push_force_n(&self) -> f64 {
        PUSH_FORCE_N
    }

    fn joint_weights_m(&self) -> &[f64] {
        // About half of what each joint moves the hand in a bent posture.
        &[0.6, 0.6, 0.3, 0.4, 0.1, 0.2, 0.05]
    }

    /// The slowest joint decides for the arm. The wheels drive and turn the base with what speed they have, so the times of
    /// both add up; and they do so while the arm rests, so base and arm add up too.
    fn duration_s(
        &self,
        a: &Configuration<ArmConfiguration>,
        b: &Configuration<ArmConfiguration>,
        is_loaded: bool,
    ) -> f64 {
        let joints = crate::arm::joint_differences(&self.arm.limits, &a.arm, &b.arm);
        let arm_s = joints.iter().zip(&JOINT_SPEED_RAD_PER_S).map(|(d, speed)| d.abs() / speed).fold(0.0, f64::max);
        let drive_m = (b.base[0] - a.base[0]).hypot(b.base[1] - a.base[1]);
        let turn_rad = darrt_core::space::so2::turn(a.base[2], b.base[2]).abs();
        let [drive, turn] = if is_loaded { LOADED_BASE_SPEED } else { BASE_SPEED };
        arm_s + drive_m / drive + turn_rad / turn
    }
}
