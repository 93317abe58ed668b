//! Laws of [`Manipulator`].

use darrt_core::laws::Broken;
use darrt_core::laws::watch::watched;
use darrt_core::random::{Purpose, Stream, stream};
use darrt_core::space::ComponentSpace as _;
use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use rand::Rng;

use crate::manipulator::{Configuration, Hand, JointVector, LinkGroup, Manipulator};
use crate::mobile_arm_space::MobileArmSpace;

mod description;
mod extremes;
mod hand;
mod inverse;
mod line;
mod links;
mod pairs;
mod reaches;
mod ties;
mod travel;
mod turn;
mod vector;

pub use reaches::{ReachClaims, check_reaches};
pub use vector::check_joint_vector;

/// Numbers of things.
pub const COUNTS: &str = "manipulator.counts: there is one limit and one positive weight for every joint";
/// Limits.
pub const LIMITS: &str = "manipulator.limits: a limit is a closed interval of two finite ends, or has none at all";
/// Links.
pub const LINKS: &str = "manipulator.links: links have names of their own, and pairs name two different links";
/// The gripper.
pub const HAND: &str =
    "manipulator.hand: the facts about the gripper are finite, and its widest gap is positive and at most a metre";
/// Rigid poses.
pub const RIGID: &str = "manipulator.rigid: every pose is finite, and its rotation is a unit quaternion";
/// The base's frame.
pub const BASE_FRAME: &str =
    "manipulator.base-frame: when only the base moves, tool and links move with it as one rigid body";
/// Base links.
pub const BASE_LINKS: &str = "manipulator.base-links: links of the base do not move with the arm or the fingers";
/// Finger links.
pub const FINGERS_FOLLOW: &str = "manipulator.fingers-follow: for a constant gap the fingers are rigid to the tool";
/// The gap.
pub const GAP: &str = "manipulator.gap: opening the hand moves the fingers and nothing else";
/// Pure.
pub const PURE: &str =
    "manipulator.pure: the same question has the same answer, bit for bit, whatever was asked in between";
/// Seeded.
pub const SEEDED: &str = "manipulator.seeded: the same generator gives the same configuration and the same base";
/// Pose of the inverse.
pub const INVERSE_POSE: &str =
    "manipulator.inverse-pose: forward of what inverse or inverse_near returns is the pose asked for";
/// Limits of the inverse.
pub const INVERSE_LIMITS: &str = "manipulator.inverse-limits: what inverse or inverse_near returns lies within the limits, continuous joints in (-pi, pi]";
/// Near itself.
pub const NEAR_SELF: &str =
    "manipulator.near-self: near a configuration, the inverse of its own pose is that configuration";
/// Necessary condition.
pub const MAY_REACH: &str =
    "manipulator.may-reach: may_reach is true wherever a configuration within the limits reaches";
/// Continuity.
pub const LINE_STEP: &str =
    "manipulator.line-step: on a line followed in small steps, every step of every joint is small";
/// Between the steps.
pub const LINE_BOW: &str = "manipulator.line-bow: half-way between two configurations of a line, joints straight, the hand is still near the line";
/// Travel is a measure.
pub const TRAVEL_MEASURE: &str = "manipulator.travel-measure: travel_m is finite, 0 from a configuration to itself, the same backwards, and not less for a larger held object";
/// Travel is a bound.
pub const TRAVEL: &str = "manipulator.travel: no point of the robot travels farther than travel_m says";
/// See the text.
pub const TRAVEL_LINKS: &str =
    "manipulator.travel-links: no point of a link, or of what is held, travels farther than link_travel_m says of it";
/// Travel of the held object.
pub const TRAVEL_HELD: &str =
    "manipulator.travel-held: no point within the held reach of the tool travels farther than travel_m says";
/// Base.
pub const BASE_FOR: &str = "manipulator.base-for: base_for draws a finite place and a yaw in [-pi, pi]";
/// Inverse is of use.
pub const INVERSE_FINDS: &str =
    "manipulator.inverse-finds: for enough of the poses that can be reached, inverse finds a configuration";
/// Bases are of use.
pub const BASE_FINDS: &str = "manipulator.base-finds: from enough of the bases that base_for draws, may_reach is true";

/// What is no pose.
pub const NAN: &str = "manipulator.nan: a pose with NaN in it is not reached, and a place with NaN in it is no answer";
/// Too far away.
pub const MAY_NOT_REACH: &str =
    "manipulator.may-not-reach: may_reach is false for what is twenty metres away, in any direction";
/// Pairs.
pub const PAIRS: &str = "manipulator.pairs: a robot of more than two links names pairs that can collide, each once, and none that always does";
/// Travel is of use.
pub const TRAVEL_TIGHT: &str = "manipulator.travel-tight: travel_m and what link_travel_m says are at most a hundred times as far as the farthest point of the robot travels";
/// Strength.
pub const STRENGTH: &str = "manipulator.strength: grip, payload and push force are positive, the payload weighs at most a hundred times the grip, and the pads have a length";

/// The palm.
pub const HAND_FOLLOWS: &str = "manipulator.hand-follows: links of the hand are rigid to the tool";
/// The arm.
pub const ARM_MOVES: &str = "manipulator.arm-moves: a link of the arm stands elsewhere when every joint does";
/// Unit of the gap.
pub const GAP_METRES: &str =
    "manipulator.gap-metres: the links of the fingers span the gap, and move apart as it opens";
/// Unit of the tips.
pub const TIPS: &str = "manipulator.tips: the links of the fingers reach as far beyond the tool as the tips do, and are about as wide and as long as tips and pads";
/// Unit of the weights.
pub const WEIGHTS: &str =
    "manipulator.weights: the weight of a joint is what the hand travels with it, within a factor of thirty";
/// Missing pairs.
pub const SELF_PAIRS: &str = "manipulator.self-pairs: two links with four joints between them that overlap in one configuration and not in another are a pair";

/// Durations.
pub const DURATION: &str = "manipulator.duration: duration_s is finite, 0 from a configuration to itself, more for every joint and coordinate that moves, at 1 mm/s to 20 m/s, not less with something in the hand, and not more than by way of the middle";

/// Joints.
pub const JOINTS: &str = "manipulator.joints: every joint moves something";
/// Fingers.
pub const CENTRED: &str = "manipulator.centred: the tool is midway between the fingers, at every gap";
/// Room for what is grasped.
pub const CLEAR: &str = "manipulator.clear: no link of the hand is between the tips, or ahead of them";
/// Variety of bases.
pub const BASE_VARIED: &str =
    "manipulator.base-varied: base_for of a robot that drives does not always draw the same base";
/// Variety of configurations.
pub const INVERSE_VARIED: &str = "manipulator.inverse-varied: inverse of an arm of more than six joints does not always draw the same configuration for a pose";
/// Steps.
pub const NEAR_FINDS: &str =
    "manipulator.near-finds: of twelve short straight steps of the hand an arm of six joints or more can take one";
/// Joint vectors.
pub const VECTOR: &str = "manipulator.vector: a joint vector has the values that it is made of or written to, zeros where zeros are asked for, no other number of them, and is equal to itself and to none that differs";

/// What a hand is tied to.
pub const TIES: &str = "manipulator.ties: where the hand gets to, it is tilted and as high as hand_ties says";
/// All of it.
pub const TIES_ALL: &str = "manipulator.ties-all: hand_ties tells a tilt and a height that no joint changes";
/// Turns.
pub const TURN: &str = "manipulator.turn: a pose turned by what turn_to_reach says is reached, in at least half of the cases, and what it says is an angle of a turn at most";
/// Turns are of use.
pub const TURN_FINDS: &str = "manipulator.turn-finds: for an arm of fewer than six joints that does not drive, enough of the poses that it reaches are reached or turned to reach, whichever way they are turned";

/// The laws of this file.
pub const LAWS: &[&str] = &[
    VECTOR,
    TIES,
    TIES_ALL,
    TURN,
    TURN_FINDS,
    JOINTS,
    CENTRED,
    CLEAR,
    BASE_VARIED,
    INVERSE_VARIED,
    NEAR_FINDS,
    NAN,
    MAY_NOT_REACH,
    PAIRS,
    TRAVEL_TIGHT,
    STRENGTH,
    HAND_FOLLOWS,
    ARM_MOVES,
    GAP_METRES,
    TIPS,
    WEIGHTS,
    SELF_PAIRS,
    DURATION,
    COUNTS,
    LIMITS,
    LINKS,
    HAND,
    RIGID,
    BASE_FRAME,
    BASE_LINKS,
    FINGERS_FOLLOW,
    GAP,
    PURE,
    SEEDED,
    INVERSE_POSE,
    INVERSE_LIMITS,
    NEAR_SELF,
    MAY_REACH,
    LINE_STEP,
    TRAVEL_LINKS,
    LINE_BOW,
    TRAVEL_MEASURE,
    TRAVEL,
    TRAVEL_HELD,
    BASE_FOR,
    INVERSE_FINDS,
    BASE_FINDS,
];

/// How exactly a robot answers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ManipulatorClaims {
    /// How far two poses that should be one may be apart, metres and radians.
    pub pose: f64,
    /// How far `inverse_near` may end from where it began when nothing has to move, radians or metres per joint.
    pub near_self: f64,
    /// Length of the lines that are followed, metres.
    pub line_m: f64,
    /// Length of one step, metres.
    pub step_m: f64,
    /// No joint moves farther than this in one step, radians or metres.
    pub joint_step: f64,
    /// How far the hand may be off the line half-way between two steps, metres.
    pub bow_m: f64,
    /// How far held objects reach beyond the tool, metres.
    pub held_reach_m: [f64; 2],
}

impl Default for ManipulatorClaims {
    fn default() -> Self {
        Self {
            pose: 1e-9,
            near_self: 1e-6,
            line_m: 0.16,
            step_m: 0.02,
            joint_step: 0.3,
            bow_m: 0.01,
            held_reach_m: [0.12, 0.3],
        }
    }
}

/// All laws of a robot, for two configurations within its limits and two openings of the hand (metres). Of a robot with several hands
/// it is about the one that is at work in the first configuration, and takes that to be at work in the second too.
///
/// # Errors
/// The first law that is [`Broken`], with the link, joint or function at fault.
pub fn check_manipulator<M: Manipulator>(
    robot: &M,
    [a, b]: [&Configuration<M::Joints>; 2],
    gaps_m: [f64; 2],
    seed: u64,
    claims: &ManipulatorClaims,
) -> Result<(), Broken> {
    let about = || format!("check_manipulator(&robot, [&{a:?}, &{b:?}], {gaps_m:?}, {seed}, &{claims:?})");
    let check = || {
        description::check(robot)?;
        let b = &with_hand(b, a.arm.hand_at_work());
        let trial = Trial { robot, space: space_of(robot)?, a, b, gaps_m, seed, claims };
        let told = trial.told();
        trial.tells_the_same(&told)?;
        trial.links()?;
        trial.ties()?;
        trial.hand()?;
        trial.pairs()?;
        trial.pairs_part()?;
        trial.inverse()?;
        trial.turn()?;
        trial.line()?;
        trial.travel()?;
        trial.extremes()?;
        // Once more, after all the other questions.
        trial.purity()?;
        trial.tells_the_same(&told)
    };
    watched(&about, check).map_err(|broken| broken.replayed_by(about))
}

struct Trial<'a, M: Manipulator> {
    robot: &'a M,
    space: MobileArmSpace<M::Joints>,
    a: &'a Configuration<M::Joints>,
    b: &'a Configuration<M::Joints>,
    gaps_m: [f64; 2],
    seed: u64,
    claims: &'a ManipulatorClaims,
}

impl<M: Manipulator> Trial<'_, M> {
    fn rng(&self, attempt: u64) -> Stream {
        stream(self.seed, attempt, 0, Purpose::Extend)
    }

    /// The hand that is at work.
    fn at_work(&self) -> usize {
        self.a.arm.hand_at_work()
    }

    fn hand_facts(&self) -> &dyn Hand {
        self.robot.hand_of(self.at_work())
    }

    /// Is a link one of another hand, which is not at work?
    fn is_idle(&self, link: usize) -> bool {
        let group = self.robot.links().get(link).map(|link| link.group);
        let is_of_hand = matches!(group, Some(LinkGroup::Hand | LinkGroup::Finger));
        is_of_hand && self.robot.hand_of_link(link) != self.at_work()
    }

    /// Some arm configuration of the hand at work, the other arms as in the first configuration.
    fn solved(&self, base: &[f64; 3], tool: &Isometry3<f64>, rng: &mut dyn Rng) -> Option<M::Joints> {
        self.robot.inverse_from(&self.a.arm, base, tool, rng)
    }

    fn may_reach(&self, base: &[f64; 3], tool: &Isometry3<f64>) -> bool {
        self.robot.may_reach_with(self.at_work(), base, tool)
    }

    /// A configuration anywhere.
    fn anywhere(&self, rng: &mut Stream) -> Configuration<M::Joints> {
        with_hand(&self.space.sample(rng), self.at_work())
    }

    fn poses(&self, q: &Configuration<M::Joints>, gap_m: f64) -> Vec<Isometry3<f64>> {
        let mut poses = vec![Isometry3::identity(); self.robot.links().len()];
        self.robot.link_poses(q, gap_m, &mut poses);
        poses
    }

    fn link_name(&self, link: usize) -> &str {
        self.robot.links().get(link).map_or("link", |l| &*l.body.name)
    }
}

/// The same configuration with another hand at work.
fn with_hand<J: JointVector>(q: &Configuration<J>, hand: usize) -> Configuration<J> {
    Configuration { arm: q.arm.with_hand_at_work(hand), ..*q }
}

/// The space of a robot's configurations, its base anywhere within a kilometre.
fn space_of<M: Manipulator>(robot: &M) -> Result<MobileArmSpace<M::Joints>, Broken> {
    MobileArmSpace::new([-1e3; 2], [1e3; 2], robot.limits(), robot.joint_weights_m())
        .map_err(|error| Broken::new(COUNTS, error.to_string(), "limits and weights that make a space"))
}

/// The base's frame in the world.
fn world_from_base(&[x, y, yaw]: &[f64; 3]) -> Isometry3<f64> {
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw);
    Isometry3::from_parts(Vector3::new(x, y, 0.0).into(), turn)
}

/// How far two poses are apart: the larger of metres and radians.
pub(super) fn gap(p: &Isometry3<f64>, q: &Isometry3<f64>) -> f64 {
    (p.translation.vector - q.translation.vector).norm().max(p.rotation.angle_to(&q.rotation))
}

/// `found` is `against`, up to `tolerance` in metres and radians; not a number fails.
pub(super) fn same_pose(
    law: &'static str,
    found: &Isometry3<f64>,
    against: &Isometry3<f64>,
    tolerance: f64,
) -> Result<(), Broken> {
    if gap(found, against) <= tolerance {
        return Ok(());
    }
    let text = |p: &Isometry3<f64>| {
        format!("{:?} turned {:?}", p.translation.vector.as_slice(), p.rotation.quaternion().coords.as_slice())
    };
    Err(Broken::new(law, text(found), text(against)).within(tolerance))
}
