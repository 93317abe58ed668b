//! Two hands on one bridge, which is bolted down: the smallest robot with more than one hand, and neither reaches all of a table.
//!
//! The joints are `[x, y, z, turn]` of the first hand and then of the second: three slides along the axes of the base, and a turn of
//! the hand, which points down, about the vertical. The first hand reaches what is left of the middle, the second what is right of
//! it, and both a strip between.

use std::f64::consts::{FRAC_PI_2, PI};

use darrt_core::space::so2;
use darrt_geom::body::{Body, Part};
use darrt_geom::error::GeomError;
use darrt_geom::shape::Shape;
use nalgebra::{Isometry3, Translation3, Unit, UnitQuaternion, Vector3};
use rand::Rng;

use super::gantry::{Gripper, LINKS, MAX_GAP_M, TIP_HALF_WIDTH_M};
use crate::hand_ties::HandTies;
use crate::joints::Joints;
use crate::kinematics::JointLimit;
use crate::manipulator::{Configuration, Hand, JointVector, LinkGroup, Manipulator, RobotLink, world_from_base};

/// Where the bridge is bolted down.
pub const BASE: [f64; 3] = [0.0; 3];
/// Joints of a hand.
const OWN: usize = 4;
/// How far beyond the middle a hand reaches, metres.
pub const OVERLAP_M: f64 = 0.2;
/// How far a slide along x goes to the outside, metres.
const OUT_M: f64 = 1.2;
/// Limits of the joints of both hands.
const LIMITS: [JointLimit; 2 * OWN] = [
    JointLimit::new(-OUT_M, OVERLAP_M),
    JointLimit::new(-0.8, 0.8),
    JointLimit::new(0.5, 1.6),
    JointLimit::UNLIMITED,
    JointLimit::new(-OVERLAP_M, OUT_M),
    JointLimit::new(-0.8, 0.8),
    JointLimit::new(0.5, 1.6),
    JointLimit::UNLIMITED,
];
/// Half the thickness of a finger, metres.
const FINGER_HALF_M: f64 = 0.01;
/// How far a pose may be off and count as reached, metres and radians.
const ROUNDING: f64 = 1e-9;
/// Farthest corner of a hand from its tool frame, rounded up, metres.
const HAND_REACH_M: f64 = 0.2;
/// Farthest point of the robot from the axis of its base, metres.
const FARTHEST_M: f64 = 2.0;

/// The robot. All functions are the honest ones by default.
#[derive(Debug, Clone)]
pub struct Twins {
    /// [`Manipulator::inverse_from`].
    pub inverse_from: fn(&Joints, &[f64; 3], &Isometry3<f64>) -> Option<Joints>,
    /// [`Manipulator::hand_of_link`].
    pub hand_of_link: fn(usize) -> usize,
    /// [`Manipulator::with_others_at`].
    pub with_others_at: fn(&Joints, &Joints) -> Joints,
    /// [`Manipulator::idle_gap_m`].
    pub idle_gap_m: fn() -> f64,
    /// Is a hand that is not at work open by the gap of the one that is?
    pub opens_all: bool,
    /// [`Manipulator::may_reach_with`].
    pub may_reach_with: fn(usize, &[f64; 3], &Isometry3<f64>) -> bool,
    links: Vec<RobotLink>,
    self_pairs: Vec<(usize, usize)>,
}

impl Twins {
    /// The honest robot.
    ///
    /// # Errors
    /// None that could happen: the sizes are constants.
    pub fn new() -> Result<Self, GeomError> {
        let own = LINKS.into_iter().filter(|(_, group, _)| matches!(group, LinkGroup::Hand | LinkGroup::Finger));
        let link = |side: &str, (name, group, half): (&str, LinkGroup, [f64; 3])| {
            let shape = Shape::cuboid(Vector3::from(half))?;
            Ok(RobotLink { body: Body::new(format!("{side} {name}"), vec![Part::centred(shape)])?, group })
        };
        let links = ["first", "second"].into_iter().flat_map(|side| own.clone().map(move |part| link(side, part)));
        let links: Vec<_> = links.collect::<Result<_, GeomError>>()?;
        let half = links.len() / 2;
        Ok(Self {
            inverse_from,
            hand_of_link: |link| link / 3,
            with_others_at,
            idle_gap_m: || 0.08,
            opens_all: false,
            may_reach_with: |hand, base, tool| solve(hand, base, tool).is_some(),
            self_pairs: (0..half).flat_map(|a| (half..links.len()).map(move |b| (a, b))).collect(),
            links,
        })
    }
}

/// Both hands at these places (x, y, z, metres), not turned, this one at work.
pub fn hands_at(first: [f64; 3], second: [f64; 3], at_work: usize) -> Option<Joints> {
    let [[x, y, z], [u, v, w]] = [first, second];
    Some(Joints::from_values(&[x, y, z, 0.0, u, v, w, 0.0])?.with_hand_at_work(at_work))
}

/// The joints of a hand.
fn own(arm: &Joints, hand: usize) -> [f64; OWN] {
    let mut own = [0.0; OWN];
    own.iter_mut().zip(arm.as_ref().iter().skip(hand * OWN)).for_each(|(slot, value)| *slot = *value);
    own
}

/// `arm` with these joints of a hand.
fn with_own(mut arm: Joints, hand: usize, own: [f64; OWN]) -> Joints {
    arm.as_mut().iter_mut().skip(hand * OWN).zip(own).for_each(|(slot, value)| *slot = value);
    arm
}

fn base_from_tool([x, y, z, turn]: [f64; OWN]) -> Isometry3<f64> {
    let down = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), FRAC_PI_2);
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn);
    Isometry3::from_parts(Translation3::new(x, y, z), turn * down)
}

/// The joints of a hand that bring it to a pose.
fn solve(hand: usize, base: &[f64; 3], world_from_tool: &Isometry3<f64>) -> Option<[f64; OWN]> {
    let wanted = world_from_base(base).inverse() * world_from_tool;
    let opening = wanted.rotation * Vector3::y();
    let at = wanted.translation.vector;
    let mut own = [at.x, at.y, at.z, so2::wrap((-opening.x).atan2(opening.y))];
    if own[3] <= -PI {
        own[3] = PI;
    }
    let is_down = wanted.rotation.angle_to(&base_from_tool(own).rotation) <= ROUNDING;
    if !(is_down && own.iter().all(|value| value.is_finite())) {
        return None;
    }
    for (value, limit) in own.iter_mut().zip(LIMITS.iter().skip(hand * OWN)).take(3) {
        if *value < limit.lower - ROUNDING || *value > limit.upper + ROUNDING {
            return None;
        }
        *value = limit.clamp(*value);
    }
    Some(own)
}

/// The other hand stays.
pub fn inverse_from(now: &Joints, base: &[f64; 3], world_from_tool: &Isometry3<f64>) -> Option<Joints> {
    let hand = now.hand_at_work();
    Some(with_own(*now, hand, solve(hand, base, world_from_tool)?))
}

/// The hand at work stays.
pub fn with_others_at(now: &Joints, posture: &Joints) -> Joints {
    let other = 1 - now.hand_at_work().min(1);
    with_own(*now, other, own(posture, other))
}

impl Manipulator for Twins {
    type Joints = Joints;

    fn hand(&self) -> &dyn Hand {
        &Gripper { max_gap_m: MAX_GAP_M, pad_length_m: 2.0 * TIP_HALF_WIDTH_M, grip_force_n: 50.0 }
    }

    fn limits(&self) -> &[JointLimit] {
        &LIMITS
    }

    fn world_from_tool(&self, q: &Configuration<Joints>) -> Isometry3<f64> {
        world_from_base(&q.base) * base_from_tool(own(&q.arm, q.arm.hand_at_work()))
    }

    fn inverse(&self, base: &[f64; 3], world_from_tool: &Isometry3<f64>, _: &mut dyn Rng) -> Option<Joints> {
        inverse_from(&hands_at([0.0; 3], [0.8, 0.0, 1.4], 0)?, base, world_from_tool)
    }

    fn inverse_near(&self, base: &[f64; 3], world_from_tool: &Isometry3<f64>, near: &Joints) -> Option<Joints> {
        (self.inverse_from)(near, base, world_from_tool)
    }

    fn base_for(&self, _: &Isometry3<f64>, _: &mut dyn Rng) -> [f64; 3] {
        BASE
    }

    fn may_reach(&self, base: &[f64; 3], world_from_tool: &Isometry3<f64>) -> bool {
        self.may_reach_with(0, base, world_from_tool)
    }

    fn hand_ties(&self) -> HandTies {
        HandTies { up_in_tool: Some(Unit::new_unchecked(-Vector3::x())), height_m: None }
    }

    fn hands(&self) -> usize {
        2
    }

    fn idle_gap_m(&self) -> f64 {
        (self.idle_gap_m)()
    }

    fn inverse_from(
        &self,
        now: &Joints,
        base: &[f64; 3],
        world_from_tool: &Isometry3<f64>,
        _: &mut dyn Rng,
    ) -> Option<Joints> {
        (self.inverse_from)(now, base, world_from_tool)
    }

    fn may_reach_with(&self, hand: usize, base: &[f64; 3], world_from_tool: &Isometry3<f64>) -> bool {
        (self.may_reach_with)(hand, base, world_from_tool)
    }

    fn hand_of_link(&self, link: usize) -> usize {
        (self.hand_of_link)(link)
    }

    fn with_others_at(&self, now: &Joints, posture: &Joints) -> Joints {
        (self.with_others_at)(now, posture)
    }

    fn links(&self) -> &[RobotLink] {
        &self.links
    }

    fn self_pairs(&self) -> &[(usize, usize)] {
        &self.self_pairs
    }

    fn link_poses(&self, q: &Configuration<Joints>, gap_m: f64, out: &mut [Isometry3<f64>]) {
        for (hand, links) in out.chunks_mut(3).enumerate() {
            let tool = world_from_base(&q.base) * base_from_tool(own(&q.arm, hand));
            let is_at_work = self.opens_all || hand == q.arm.hand_at_work();
            let gap_m = if is_at_work { gap_m } else { self.idle_gap_m() };
            let finger = |side: f64| tool * Translation3::new(0.0, side * (0.5 * gap_m + FINGER_HALF_M), 0.0);
            let poses = [tool * Translation3::new(-0.08, 0.0, 0.0), finger(1.0), finger(-1.0)];
            links.iter_mut().zip(poses).for_each(|(slot, pose)| *slot = pose);
        }
    }

    fn travel_m(&self, a: &Configuration<Joints>, b: &Configuration<Joints>, held_reach_m: f64) -> f64 {
        let of_hand = |hand: usize| {
            let ([x, y, z, turn], [u, v, w, spin]) = (own(&a.arm, hand), own(&b.arm, hand));
            let slid = Vector3::new(u - x, v - y, w - z).norm();
            slid + so2::turn(turn, spin).abs() * HAND_REACH_M.max(held_reach_m)
        };
        let drive = (b.base[0] - a.base[0]).hypot(b.base[1] - a.base[1]);
        let turn = so2::turn(a.base[2], b.base[2]).abs() * (FARTHEST_M + held_reach_m);
        of_hand(0).hypot(of_hand(1)) + drive + turn
    }

    fn joint_weights_m(&self) -> &[f64] {
        &[1.0, 1.0, 1.0, 0.2, 1.0, 1.0, 1.0, 0.2]
    }
}
