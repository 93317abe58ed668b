//! A robot that comes as a file, as a [`Manipulator`]: any arm of up to [`MAX_JOINTS`] joints with a parallel hand, on a base that
//! drives or is bolted down.
//!
//! [`MAX_JOINTS`]: darrt_primitives::joints::MAX_JOINTS

mod abilities;
mod apart;
mod bases;
mod chain;
pub mod choose;
mod few_joints;
pub mod guess;
pub mod inspect;
mod inverse;
mod load;
mod opening;
mod pairs;
mod reach;
mod sampled;
mod semantic;
pub mod shipped;
mod task;
mod ties;
mod travel;
pub mod trial;

use std::collections::BTreeMap;

use arrayvec::ArrayVec;
use darrt_primitives::hand_ties::HandTies;
use darrt_primitives::heading_drive;
use darrt_primitives::joints::{Joints, MAX_JOINTS};
use darrt_primitives::kinematics::JointLimit;
use darrt_primitives::manipulator::{Configuration, Hand, LinkGroup, Manipulator, RobotLink, world_from_base};
use darrt_primitives::mobile_arm_space::difference;
use nalgebra::{Isometry3, Point2};
use rand::{Rng, RngExt as _};

use bases::Ring;
use chain::{ArmChain, Place};
use few_joints::FewJoints;
use inverse::Inverse;
use opening::Opening;
use travel::Levers;

use crate::robot_file::BaseKind;

/// Largest change of any joint between two steps along a straight line of the hand, radians or metres.
const LINE_JOINT_STEP: f64 = 0.3;

/// In so large a share what is round is turned for the base where it stands, not approached from another one.
const STAYS_SHARE: f64 = 0.5;

/// The hand of a robot file.
#[derive(Debug, Clone)]
struct ParallelHand {
    opening: Opening,
    tip_half_width_m: f64,
    pad_length_m: f64,
    grip_force_n: f64,
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

/// Speeds that a robot is planned with.
#[derive(Debug, Clone)]
struct Speeds {
    joints: Vec<f64>,
    /// Metres and radians per second of the base, with an empty hand and with something in it.
    base: [[f64; 2]; 2],
}

/// The robot of a robot file.
#[derive(Debug, Clone)]
pub struct FileRobot {
    base_kind: BaseKind,
    chain: ArmChain,
    limits: Vec<JointLimit>,
    weights_m: Vec<f64>,
    hand: ParallelHand,
    links: Vec<RobotLink>,
    places: Vec<Place>,
    /// By link.
    levers: Vec<Levers>,
    tool_levers: Levers,
    self_pairs: Vec<(usize, usize)>,
    inverse: Inverse,
    ring: Ring,
    /// For an arm of fewer joints than six.
    few: Option<FewJoints>,
    ties: HandTies,
    speeds: Speeds,
    payload_kg: f64,
    push_force_n: f64,
    postures: BTreeMap<String, Joints>,
    home: String,
}

type Ways = ArrayVec<f64, MAX_JOINTS>;

impl FileRobot {
    /// How its base moves.
    pub fn base_kind(&self) -> BaseKind {
        self.base_kind
    }

    /// The lowest point of what is rigid to the base, and the one farthest ahead, metres in the frame of the base.
    fn base_extent_m(&self) -> (f64, f64) {
        let rigid = self.links.iter().zip(&self.places).filter(|(link, _)| link.group == LinkGroup::Base);
        rigid.fold((f64::INFINITY, 0.0), |(lowest, front), (link, place)| {
            let ahead = travel::corners(&link.body).into_iter().map(|corner| (place.offset * corner).x);
            (load::lowest_m(&link.body, &place.offset).min(lowest), ahead.fold(front, f64::max))
        })
    }

    /// The lowest point of what is rigid to the base, metres, and of what its first joint only turns about a vertical axis, less what
    /// that must keep from the floor.
    fn lowest_m(&self) -> f64 {
        let (rigid_m, _) = self.base_extent_m();
        let first = self.chain.joints.first().filter(|joint| !joint.slides);
        let turned = first.filter(|joint| (joint.before.rotation * joint.axis.into_inner()).z.abs() > 1.0 - 1e-9);
        let Some(joint) = turned else { return rigid_m };
        let carried = self.links.iter().zip(&self.places).filter(|(_, at)| at.anchor == 1 && at.steps.is_empty());
        let lowest = carried.map(|(link, place)| load::lowest_m(&link.body, &(joint.before * place.offset)));
        lowest.fold(rigid_m, |lowest, m| lowest.min(m - load::ABOVE_FLOOR_M))
    }

    /// An arm configuration that brings the tool to `base_from_tool`; for an arm of fewer joints than six, turned about its own vertical.
    fn arm_at(&self, base_from_tool: &Isometry3<f64>, rng: &mut dyn Rng) -> Option<Joints> {
        let base = [0.0; 3];
        if !self.may_reach(&base, base_from_tool) {
            return None;
        }
        let turned = self.few.as_ref().and_then(|few| few.turned(&base, base_from_tool, rng));
        self.inverse(&base, &turned.unwrap_or(*base_from_tool), rng)
    }

    /// The height of the first joint, metres.
    fn shoulder_m(&self) -> f64 {
        self.chain.joints.first().map_or(0.0, |joint| joint.before.translation.z)
    }

    /// The ways of the joints, of the base, and of its heading.
    fn ways(&self, a: &Configuration<Joints>, b: &Configuration<Joints>) -> (Ways, [f64; 2]) {
        let joints = a.arm.as_ref().iter().zip(b.arm.as_ref()).zip(&self.limits);
        let joints = joints.map(|((from, to), limit)| difference(*from, *to, limit)).take(MAX_JOINTS).collect();
        let shift = (b.base[0] - a.base[0]).hypot(b.base[1] - a.base[1]);
        (joints, [shift, darrt_core::space::so2::turn(a.base[2], b.base[2]).abs()])
    }
}

impl Manipulator for FileRobot {
    type Joints = Joints;

    fn hand(&self) -> &dyn Hand {
        &self.hand
    }

    fn limits(&self) -> &[JointLimit] {
        &self.limits
    }

    fn world_from_tool(&self, q: &Configuration<Joints>) -> Isometry3<f64> {
        self.chain.world_from_tool(&q.base, q.arm.as_ref())
    }

    fn inverse(&self, base: &[f64; 3], world_from_tool: &Isometry3<f64>, rng: &mut dyn Rng) -> Option<Joints> {
        self.inverse.any(&(world_from_base(base).inverse() * world_from_tool), rng)
    }

    fn inverse_near(&self, base: &[f64; 3], world_from_tool: &Isometry3<f64>, near: &Joints) -> Option<Joints> {
        self.inverse.near(&(world_from_base(base).inverse() * world_from_tool), near, LINE_JOINT_STEP)
    }

    fn base_for(&self, world_from_tool: &Isometry3<f64>, rng: &mut dyn Rng) -> [f64; 3] {
        // The base of an arm that does not come to any pose must stand where it comes to this one.
        let few = self.few.as_ref().filter(|_| !self.ring.is_fixed());
        let base = few.and_then(|few| few.base_for(world_from_tool, rng));
        base.unwrap_or_else(|| self.ring.base_for((&self.chain, &self.limits), world_from_tool, rng))
    }

    fn turn_to_reach(
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

    fn may_reach(&self, base: &[f64; 3], world_from_tool: &Isometry3<f64>) -> bool {
        self.ties.allow(world_from_tool) && self.ring.may_reach(base, world_from_tool)
    }

    fn hand_ties(&self) -> HandTies {
        self.ties
    }

    fn links(&self) -> &[RobotLink] {
        &self.links
    }

    fn self_pairs(&self) -> &[(usize, usize)] {
        &self.self_pairs
    }

    fn link_poses(&self, q: &Configuration<Joints>, gap_m: f64, out: &mut [Isometry3<f64>]) {
        let arm = q.arm.as_ref();
        let frames = self.chain.frames(&q.base, arm);
        let finger = self.hand.opening.joint(gap_m);
        for (slot, place) in out.iter_mut().zip(&self.places) {
            if let Some(frame) = frames.get(place.anchor) {
                *slot = frame * place.in_anchor(arm, finger);
            }
        }
    }

    fn travel_m(&self, a: &Configuration<Joints>, b: &Configuration<Joints>, held_reach_m: f64) -> f64 {
        let (joints, base) = self.ways(a, b);
        let links = self.levers.iter().map(|levers| levers.travel_m(&joints, base, 0.0));
        links.fold(self.tool_levers.travel_m(&joints, base, held_reach_m), f64::max)
    }

    fn link_travel_m(
        &self,
        a: &Configuration<Joints>,
        b: &Configuration<Joints>,
        held_reach_m: f64,
        out: &mut [f64],
    ) -> f64 {
        let (joints, base) = self.ways(a, b);
        for (slot, levers) in out.iter_mut().zip(&self.levers) {
            *slot = levers.travel_m(&joints, base, 0.0);
        }
        self.tool_levers.travel_m(&joints, base, held_reach_m)
    }

    fn payload_kg(&self) -> f64 {
        self.payload_kg
    }

    fn push_force_n(&self) -> f64 {
        self.push_force_n
    }

    fn joint_weights_m(&self) -> &[f64] {
        &self.weights_m
    }

    fn drives_along_heading(&self) -> bool {
        self.base_kind == BaseKind::Differential
    }

    /// The slowest joint decides for the arm; base and arm move one after the other, and the base drives or turns.
    fn duration_s(&self, a: &Configuration<Joints>, b: &Configuration<Joints>, is_loaded: bool) -> f64 {
        let (joints, [shift, turn]) = self.ways(a, b);
        let turn = if self.drives_along_heading() { heading_drive::turned_rad(&a.base, &b.base) } else { turn };
        let arm_s = joints.iter().zip(&self.speeds.joints).map(|(way, speed)| way.abs() / speed).fold(0.0, f64::max);
        let [drive, spin] = self.speeds.base[usize::from(is_loaded)];
        arm_s + shift / drive + turn / spin
    }
}
