//! A robot that comes as a file, as a [`Manipulator`]: any arm with a parallel hand, or two of them, of up to [`MAX_JOINTS`] joints
//! together, on a base that drives or is bolted down.
//!
//! [`MAX_JOINTS`]: darrt_primitives::joints::MAX_JOINTS

mod abilities;
mod apart;
mod arm;
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
mod skeleton;
mod task;
mod ties;
mod travel;
pub mod trial;

use std::collections::BTreeMap;

use darrt_primitives::hand_ties::HandTies;
use darrt_primitives::heading_drive;
use darrt_primitives::joints::{Joints, MAX_JOINTS};
use darrt_primitives::kinematics::JointLimit;
use darrt_primitives::manipulator::{Configuration, Hand, JointVector as _, LinkGroup, Manipulator, RobotLink};
use darrt_primitives::mobile_arm_space::difference;
use nalgebra::{Isometry3, Point2};
use rand::Rng;

use arm::PlannedArm;
use chain::{Driver, Fingers, Place, Values};
use load::Loaded;
use travel::Levers;

use crate::problem_file::Limits;
use crate::robot_file::{BaseKind, RobotFileError, Source};

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
    first: PlannedArm,
    second: Option<PlannedArm>,
    /// Of the joints of both arms.
    limits: Vec<JointLimit>,
    weights_m: Vec<f64>,
    links: Vec<RobotLink>,
    places: Vec<Place>,
    /// By link: which arm it belongs to, 1 if the second alone moves it.
    owners: Vec<usize>,
    /// By link.
    levers: Vec<Levers>,
    self_pairs: Vec<(usize, usize)>,
    /// By variable of the tree.
    drivers: Vec<Driver>,
    /// Of the joints that open the hands, where no hand is at work.
    idle: Fingers,
    speeds: Speeds,
    /// As both arms can.
    payload_kg: f64,
    push_force_n: f64,
    postures: BTreeMap<String, Joints>,
    home: String,
    /// The joints in that posture.
    at_home: Joints,
}

impl FileRobot {
    /// The robot of a robot file and its description as texts, for a program that has both inside: within its soft limits, a base
    /// that is bolted down at the origin. Meshes are not looked for: `name` is how errors call the file.
    ///
    /// # Errors
    /// [`RobotFileError`] with the key of the file, or what is wrong with the description.
    ///
    /// # Example
    /// ```
    /// use darrt_primitives::manipulator::Manipulator as _;
    /// use darrt_task::file_robot::{FileRobot, shipped};
    ///
    /// let inside = shipped::find("two-arm")?;
    /// let robot = FileRobot::from_texts(inside.text, inside.urdf, "two-arm.toml")?;
    /// assert_eq!((robot.hands(), robot.limits().len()), (2, 14));
    /// # Ok::<(), darrt_task::robot_file::RobotFileError>(())
    /// ```
    pub fn from_texts(text: &str, urdf: &str, name: &str) -> Result<Self, RobotFileError> {
        Loaded::new(Source::from_text(text, name)?, Some(urdf))?.robot(Limits::Soft, [0.0; 3])
    }

    /// The joints in which it starts where a problem does not say.
    pub fn home(&self) -> Joints {
        self.at_home
    }

    /// How its base moves.
    pub fn base_kind(&self) -> BaseKind {
        self.base_kind
    }

    /// The arm that ends in one of the hands.
    fn arm(&self, hand: usize) -> &PlannedArm {
        self.second.as_ref().filter(|_| hand == 1).unwrap_or(&self.first)
    }

    /// The arm of the hand that is at work.
    fn arm_at_work(&self, joints: &Joints) -> &PlannedArm {
        self.arm(joints.hand_at_work())
    }

    /// The joints that open the hands: that at work by `gap_m`.
    fn fingers(&self, joints: &Joints, gap_m: f64) -> Fingers {
        let [first, second] = self.idle;
        match &self.second {
            Some(arm) if joints.hand_at_work() == 1 => [first, arm.hand.opening.joint(gap_m)],
            _ => [self.first.hand.opening.joint(gap_m), second],
        }
    }

    /// The lowest point of what is rigid to the base, and the one farthest ahead, metres in the frame of the base.
    fn base_extent_m(&self) -> (f64, f64) {
        let rigid = self.links.iter().zip(&self.places).filter(|(link, _)| link.group == LinkGroup::Base);
        rigid.fold((f64::INFINITY, 0.0), |(lowest, front), (link, place)| {
            let ahead = travel::corners(&link.body).into_iter().map(|corner| (place.offset * corner).x);
            (load::lowest_m(&link.body, &place.offset).min(lowest), ahead.fold(front, f64::max))
        })
    }

    /// The lowest point of what is rigid to the base, metres, and of what the first joint of its first arm only turns about a vertical
    /// axis, less what that must keep from the floor.
    fn lowest_m(&self) -> f64 {
        let (rigid_m, _) = self.base_extent_m();
        let first = self.first.chain.joints.first().filter(|joint| !joint.slides);
        let turned = first.filter(|joint| (joint.before.rotation * joint.axis.into_inner()).z.abs() > 1.0 - 1e-9);
        let Some(joint) = turned else { return rigid_m };
        let owned = self.links.iter().zip(&self.places).zip(&self.owners).filter(|(_, owner)| **owner == 0);
        let carried = owned.map(|(link, _)| link).filter(|(_, at)| at.anchor == 1 && at.steps.is_empty());
        let lowest = carried.map(|(link, place)| load::lowest_m(&link.body, &(joint.before * place.offset)));
        lowest.fold(rigid_m, |lowest, m| lowest.min(m - load::ABOVE_FLOOR_M))
    }

    /// A configuration that brings the tool of a hand to `base_from_tool`; for an arm of fewer joints than six, turned about its own
    /// vertical.
    fn arm_at(&self, hand: usize, base_from_tool: &Isometry3<f64>, rng: &mut dyn Rng) -> Option<Joints> {
        self.arm(hand).at(&self.at_home.with_hand_at_work(hand), base_from_tool, rng)
    }

    /// The height of the first joint, metres.
    fn shoulder_m(&self) -> f64 {
        self.first.chain.joints.first().map_or(0.0, |joint| joint.before.translation.z)
    }

    /// The ways of the joints, of the base, and of its heading.
    fn ways(&self, a: &Configuration<Joints>, b: &Configuration<Joints>) -> (Values, [f64; 2]) {
        let joints = a.arm.as_ref().iter().zip(b.arm.as_ref()).zip(&self.limits);
        let joints = joints.map(|((from, to), limit)| difference(*from, *to, limit)).take(MAX_JOINTS).collect();
        let shift = (b.base[0] - a.base[0]).hypot(b.base[1] - a.base[1]);
        (joints, [shift, darrt_core::space::so2::turn(a.base[2], b.base[2]).abs()])
    }
}

impl Manipulator for FileRobot {
    type Joints = Joints;

    fn hand(&self) -> &dyn Hand {
        &self.first.hand
    }

    fn limits(&self) -> &[JointLimit] {
        &self.limits
    }

    fn world_from_tool(&self, q: &Configuration<Joints>) -> Isometry3<f64> {
        self.arm_at_work(&q.arm).world_from_tool(&q.base, q.arm.as_ref())
    }

    /// Of the first hand, the other arm at home.
    fn inverse(&self, base: &[f64; 3], world_from_tool: &Isometry3<f64>, rng: &mut dyn Rng) -> Option<Joints> {
        self.first.inverse(&self.at_home, base, world_from_tool, rng)
    }

    fn inverse_near(&self, base: &[f64; 3], world_from_tool: &Isometry3<f64>, near: &Joints) -> Option<Joints> {
        self.arm_at_work(near).inverse_near(base, world_from_tool, near)
    }

    fn base_for(&self, world_from_tool: &Isometry3<f64>, rng: &mut dyn Rng) -> [f64; 3] {
        self.first.base_for(world_from_tool, rng)
    }

    fn turn_to_reach(
        &self,
        base: &[f64; 3],
        world_from_tool: &Isometry3<f64>,
        centre: &Point2<f64>,
        rng: &mut dyn Rng,
    ) -> Option<f64> {
        self.first.turn_to_reach(base, world_from_tool, centre, rng)
    }

    fn may_reach(&self, base: &[f64; 3], world_from_tool: &Isometry3<f64>) -> bool {
        self.first.may_reach(base, world_from_tool)
    }

    fn hand_ties(&self) -> HandTies {
        self.first.ties
    }

    fn hands(&self) -> usize {
        1 + usize::from(self.second.is_some())
    }

    fn hand_of(&self, hand: usize) -> &dyn Hand {
        &self.arm(hand).hand
    }

    fn inverse_from(
        &self,
        now: &Joints,
        base: &[f64; 3],
        world_from_tool: &Isometry3<f64>,
        rng: &mut dyn Rng,
    ) -> Option<Joints> {
        self.arm_at_work(now).inverse(now, base, world_from_tool, rng)
    }

    fn base_for_hand(&self, hand: usize, world_from_tool: &Isometry3<f64>, rng: &mut dyn Rng) -> [f64; 3] {
        self.arm(hand).base_for(world_from_tool, rng)
    }

    fn may_reach_with(&self, hand: usize, base: &[f64; 3], world_from_tool: &Isometry3<f64>) -> bool {
        self.arm(hand).may_reach(base, world_from_tool)
    }

    fn turn_to_reach_with(
        &self,
        hand: usize,
        base: &[f64; 3],
        world_from_tool: &Isometry3<f64>,
        centre: &Point2<f64>,
        rng: &mut dyn Rng,
    ) -> Option<f64> {
        self.arm(hand).turn_to_reach(base, world_from_tool, centre, rng)
    }

    fn hand_ties_of(&self, hand: usize) -> HandTies {
        self.arm(hand).ties
    }

    fn hand_of_link(&self, link: usize) -> usize {
        self.owners.get(link).copied().unwrap_or(0)
    }

    fn with_others_at(&self, now: &Joints, posture: &Joints) -> Joints {
        self.arm_at_work(now).with_others_at(now, posture)
    }

    fn links(&self) -> &[RobotLink] {
        &self.links
    }

    fn self_pairs(&self) -> &[(usize, usize)] {
        &self.self_pairs
    }

    fn link_poses(&self, q: &Configuration<Joints>, gap_m: f64, out: &mut [Isometry3<f64>]) {
        let joints = q.arm.as_ref();
        let fingers = self.fingers(&q.arm, gap_m);
        let frames = self.first.frames(&q.base, joints);
        let Some(second) = &self.second else {
            for (slot, place) in out.iter_mut().zip(&self.places) {
                if let Some(frame) = frames.get(place.anchor) {
                    *slot = frame * place.in_anchor(joints, fingers);
                }
            }
            return;
        };
        let frames = [frames, second.frames(&q.base, joints)];
        for ((slot, place), owner) in out.iter_mut().zip(&self.places).zip(&self.owners) {
            if let Some(frame) = frames.get(*owner).and_then(|frames| frames.get(place.anchor)) {
                *slot = frame * place.in_anchor(joints, fingers);
            }
        }
    }

    fn travel_m(&self, a: &Configuration<Joints>, b: &Configuration<Joints>, held_reach_m: f64) -> f64 {
        let (joints, base) = self.ways(a, b);
        let links = self.levers.iter().map(|levers| levers.travel_m(&joints, base, 0.0));
        links.fold(self.arm_at_work(&a.arm).held_travel_m(&joints, base, held_reach_m), f64::max)
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
        self.arm_at_work(&a.arm).held_travel_m(&joints, base, held_reach_m)
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
