//! What of a robot is about one of its arms: its chain, its hand, and where that gets to.

use darrt_primitives::hand_ties::HandTies;
use darrt_primitives::joints::Joints;
use darrt_primitives::kinematics::JointLimit;
use darrt_primitives::manipulator::{Hand, JointVector as _, world_from_base};
use nalgebra::{Isometry3, Point2};
use rand::{Rng, RngExt as _};

use super::bases::Ring;
use super::chain::{ArmChain, Frames, Own, Values};
use super::few_joints::FewJoints;
use super::inverse::Inverse;
use super::opening::Opening;
use super::travel::Levers;

/// Largest change of any joint between two steps along a straight line of the hand, radians or metres.
const LINE_JOINT_STEP: f64 = 0.3;

/// In so large a share what is round is turned for the base where it stands, not approached from another one.
const STAYS_SHARE: f64 = 0.5;

/// The hand of a robot file.
#[derive(Debug, Clone)]
pub(super) struct ParallelHand {
    pub(super) opening: Opening,
    pub(super) tip_half_width_m: f64,
    pub(super) pad_length_m: f64,
    pub(super) grip_force_n: f64,
}

impl Hand for ParallelHand {
    fn max_gap_m(&self) -> f64 {
        self.opening.max_gap_m
    }

    fn tip_beyond_tool_m(&self, gap_m: f64) -> f64 {
        self.opening.end_m(gap_m)
    }

    fn tip_half_width_m(&self) -> f64 {
        self.tip_half_width_m
    }

    fn pad_length_m(&self) -> f64 {
        self.pad_length_m
    }

    fn grip_force_n(&self) -> f64 {
        self.grip_force_n
    }
}

/// One of the arms, with its hand.
#[derive(Debug, Clone)]
pub(super) struct PlannedArm {
    pub(super) chain: ArmChain,
    /// Which of the robot's joints are those of the chain.
    pub(super) own: Own,
    /// Of the joints of the chain.
    pub(super) limits: Vec<JointLimit>,
    pub(super) hand: ParallelHand,
    /// By joint of the chain.
    pub(super) tool_levers: Levers,
    pub(super) inverse: Inverse,
    pub(super) ring: Ring,
    /// For an arm of fewer joints than six.
    pub(super) few: Option<FewJoints>,
    pub(super) ties: HandTies,
    pub(super) payload_kg: f64,
    pub(super) push_force_n: f64,
}

impl PlannedArm {
    /// The tool in the world, for these joints of the robot.
    pub(super) fn world_from_tool(&self, base: &[f64; 3], joints: &[f64]) -> Isometry3<f64> {
        self.chain.world_from_tool(base, self.own.of(joints, &mut Values::new()))
    }

    /// The frames of base and joints in the world, for these joints of the robot.
    pub(super) fn frames(&self, base: &[f64; 3], joints: &[f64]) -> Frames {
        self.chain.frames(base, self.own.of(joints, &mut Values::new()))
    }

    /// Some configuration that brings the tool to `world_from_tool`; the other joints of the robot as in `now`.
    pub(super) fn inverse(
        &self,
        now: &Joints,
        base: &[f64; 3],
        world_from_tool: &Isometry3<f64>,
        rng: &mut dyn Rng,
    ) -> Option<Joints> {
        let found = self.inverse.any(&(world_from_base(base).inverse() * world_from_tool), rng)?;
        Some(self.with_own(now, &found))
    }

    /// The one near `near`; the other joints of the robot stay.
    pub(super) fn inverse_near(
        &self,
        base: &[f64; 3],
        world_from_tool: &Isometry3<f64>,
        near: &Joints,
    ) -> Option<Joints> {
        let base_from_tool = world_from_base(base).inverse() * world_from_tool;
        let mut place = Values::new();
        let found = self.inverse.near(&base_from_tool, self.own.of(near.as_ref(), &mut place), LINE_JOINT_STEP)?;
        Some(self.with_own(near, &found))
    }

    /// `joints` of the robot with these values of the chain's joints.
    fn with_own(&self, joints: &Joints, values: &[f64]) -> Joints {
        let mut joints = *joints;
        let slots = joints.as_mut();
        for (joint, value) in self.own.indices().zip(values) {
            if let Some(slot) = slots.get_mut(joint) {
                *slot = *value;
            }
        }
        joints
    }

    /// `now`, but for the joints of other arms, which are as in `posture`.
    pub(super) fn with_others_at(&self, now: &Joints, posture: &Joints) -> Joints {
        let mut place = Values::new();
        self.with_own(&posture.with_hand_at_work(now.hand_at_work()), self.own.of(now.as_ref(), &mut place))
    }

    pub(super) fn base_for(&self, world_from_tool: &Isometry3<f64>, rng: &mut dyn Rng) -> [f64; 3] {
        // The base of an arm that does not come to any pose must stand where it comes to this one.
        let few = self.few.as_ref().filter(|_| !self.ring.is_fixed());
        let base = few.and_then(|few| few.base_for(world_from_tool, rng));
        base.unwrap_or_else(|| self.ring.base_for((&self.chain, &self.limits), world_from_tool, rng))
    }

    pub(super) fn turn_to_reach(
        &self,
        base: &[f64; 3],
        world_from_tool: &Isometry3<f64>,
        centre: &Point2<f64>,
        rng: &mut dyn Rng,
    ) -> Option<f64> {
        let few = self.few.as_ref()?;
        // A base that drives may as well stand elsewhere.
        let stays = self.ring.is_fixed() || rng.random_bool(STAYS_SHARE);
        if stays { few.turn(base, world_from_tool, centre, rng) } else { None }
    }

    pub(super) fn may_reach(&self, base: &[f64; 3], world_from_tool: &Isometry3<f64>) -> bool {
        self.ties.allow(world_from_tool) && self.ring.may_reach(base, world_from_tool)
    }

    /// An arm configuration that brings the tool to `base_from_tool`; for an arm of fewer joints than six, turned about its own
    /// vertical.
    pub(super) fn at(&self, now: &Joints, base_from_tool: &Isometry3<f64>, rng: &mut dyn Rng) -> Option<Joints> {
        let base = [0.0; 3];
        if !self.may_reach(&base, base_from_tool) {
            return None;
        }
        let turned = self.few.as_ref().and_then(|few| few.turned(&base, base_from_tool, rng));
        self.inverse(now, &base, &turned.unwrap_or(*base_from_tool), rng)
    }

    /// Metres that what the hand holds travels at most, for these ways of the robot's joints and of the base.
    pub(super) fn held_travel_m(&self, joints: &[f64], base: [f64; 2], held_reach_m: f64) -> f64 {
        self.tool_levers.travel_m(self.own.of(joints, &mut Values::new()), base, held_reach_m)
    }
}
