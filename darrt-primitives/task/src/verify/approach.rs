//! How fast two solids can approach each other: only the joints between them count, and what drives only one of them.
//!
//! # Source
//! The bound on relative travel of Schwarzer, Saha and Latombe, Adaptive dynamic collision checking for single and
//! multiple articulated robots in complex environments, 2005, section 3.

use darrt_primitives::kinematics::tree::LinkMotion;

use super::hands::Hands;
use super::motion::Segment;
use super::robot::Role;

/// What moves a solid: one bit for each moving joint above it, one for the base, one for a push.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub(super) struct Movers(u64);

impl Movers {
    /// It stands still.
    pub(super) const NONE: Self = Self(0);
    /// It is pushed.
    pub(super) const PUSH: Self = Self(1);
    const BASE: Self = Self(2);
    const FIRST_JOINT: usize = 2;
    const MOST_JOINTS: usize = 62;

    /// What moves one of two solids and not the other: what changes how they stand to each other.
    pub(super) fn between(self, other: Self) -> Self {
        Self(self.0 ^ other.0)
    }

    fn includes(self, bit: usize) -> bool {
        self.0 & (1 << bit) != 0
    }
}

/// A joint that a step may move, with the link below it.
#[derive(Debug)]
struct Joint {
    link: usize,
    variable: usize,
    multiplier: f64,
    turns: bool,
}

/// The joints of the robot that may move, and the links that they move.
#[derive(Debug)]
pub(super) struct Approach {
    joints: Vec<Joint>,
    /// By link.
    movers: Vec<Movers>,
}

/// Bounds of travel in one segment, metres, by the bits of [`Movers`].
#[derive(Debug)]
pub(super) struct Speeds(Vec<f64>);

impl Speeds {
    /// How much nearer two solids with these movers between them can come.
    pub(super) fn of(&self, between: Movers) -> f64 {
        self.0.iter().enumerate().filter(|(bit, _)| between.includes(*bit)).map(|(_, speed)| speed).sum()
    }
}

impl Approach {
    /// `None` if more joints move than a robot has; then nothing is known.
    pub(super) fn new(hands: &Hands) -> Option<Self> {
        let robot = &hands.first;
        let moves = |variable: usize| hands.all().any(|robot| robot.roles.get(variable) != Some(&Role::Parked));
        let count = robot.tree.link_count();
        let mut joints = Vec::new();
        let mut movers = vec![Movers::BASE; count];
        // Parents come before their children.
        for link in 0..count {
            let above = robot.tree.parent(link).and_then(|parent| movers.get(parent)).copied();
            let mut here = above.unwrap_or(Movers::BASE);
            let (drive, turns) = match robot.tree.motion(link) {
                Some(LinkMotion::Turning { drive, .. }) => (Some(drive), true),
                Some(LinkMotion::Sliding { drive, .. }) => (Some(drive), false),
                _ => (None, false),
            };
            if let Some(drive) = drive.filter(|drive| moves(drive.variable)) {
                if joints.len() == Movers::MOST_JOINTS {
                    return None;
                }
                here.0 |= 1 << (Movers::FIRST_JOINT + joints.len());
                joints.push(Joint { link, variable: drive.variable, multiplier: drive.multiplier.abs(), turns });
            }
            if let Some(slot) = movers.get_mut(link) {
                *slot = here;
            }
        }
        Some(Self { joints, movers })
    }

    /// What moves a link.
    pub(super) fn of_link(&self, link: usize) -> Movers {
        self.movers.get(link).copied().unwrap_or(Movers::NONE)
    }

    /// Bounds for one segment. `extents`: see [`extents`](super::robot::Robot::extents).
    /// Of a pushed object also how far it reaches from its centre, metres.
    pub(super) fn speeds(&self, segment: &Segment<'_>, extents: &[f64], pushed: Option<(usize, f64)>) -> Speeds {
        let way = |(object, reach_m): (usize, f64)| {
            let slide = segment.slide(object)?;
            Some(slide.length_m + slide.turn.abs() * reach_m)
        };
        let [x, y, yaw] = segment.base;
        let reach = |link: usize| extents.get(link).copied().unwrap_or(f64::INFINITY);
        let base = x.hypot(y) + if yaw == 0.0 { 0.0 } else { yaw.abs() * reach(0) };
        let joints = self.joints.iter().map(|joint| {
            let turn = segment.joints.get(joint.variable).copied().unwrap_or(f64::INFINITY).abs();
            let arm = if joint.turns { reach(joint.link) } else { 1.0 };
            if turn == 0.0 { 0.0 } else { turn * joint.multiplier * arm }
        });
        Speeds([pushed.and_then(way).unwrap_or(0.0), base].into_iter().chain(joints).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan_file::PlanFile;
    use crate::planning::PlanRequest;
    use crate::testing::builtin;
    use crate::testing::{facts, planned};
    use crate::verify::motion::State;
    use crate::verify::solid::exact;
    use crate::verify::world::World;
    use rand::{RngExt as _, SeedableRng as _};

    /// A robot somewhere, and the same one a little farther on.
    fn bowl() -> PlanFile {
        planned(&PlanRequest::new(builtin("bowl").unwrap(), 1)).plan.unwrap()
    }

    #[test]
    fn no_two_solids_come_nearer_than_the_speeds_say() {
        let file = bowl();
        let hands = Hands::new(&facts(&file.problem)).unwrap();
        let robot = &hands.first;
        let world = World::new(&file.problem).unwrap();
        let approach = Approach::new(&hands).unwrap();
        let extents = robot.extents(0.0);
        let start = State::read(&file.start, robot, &world).unwrap();
        let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(4);
        let mut draw = |from: &State, size: f64| {
            let mut state = from.clone();
            for (i, value) in state.joints.iter_mut().enumerate() {
                if robot.roles[i] != Role::Parked {
                    *value += rng.random_range(-size..size);
                }
            }
            state.base.iter_mut().for_each(|value| *value += rng.random_range(-size..size));
            state
        };
        let mut poses = (Vec::new(), Vec::new());
        let mut tight = 0;
        for round in 0..40 {
            let from = draw(&start, 0.8);
            let mut to = draw(&from, 0.05);
            // With the base at rest the arm alone counts.
            if round % 2 == 0 {
                to.base = from.base;
            }
            let speeds = approach.speeds(&Segment::new(&from, &to, robot), &extents, None);
            robot.link_poses(&from.joints, &mut poses.0);
            robot.link_poses(&to.joints, &mut poses.1);
            for (i, a) in robot.solids.iter().enumerate() {
                for b in robot.solids.iter().skip(i + 1).step_by(2) {
                    let distance = |links: &[nalgebra::Isometry3<f64>]| {
                        let (pose_a, pose_b) = (links[a.link] * a.link_from_solid, links[b.link] * b.link_from_solid);
                        exact(&a.solid, &pose_a, &b.solid, &pose_b).unwrap().distance
                    };
                    let bound = speeds.of(approach.of_link(a.link).between(approach.of_link(b.link)));
                    let change = (distance(&poses.0) - distance(&poses.1)).abs();
                    let names = (a.solid.name(), b.solid.name());
                    assert!(change <= bound + 1e-6, "{names:?}: {change} m nearer, bound {bound} m");
                    tight += u32::from(change > 0.3 * bound && bound > 0.01);
                }
            }
        }
        assert!(tight > 20, "the bounds say little: {tight}");
    }

    #[test]
    fn only_what_lies_between_counts() {
        let hands = Hands::new(&facts(&builtin("bowl").unwrap())).unwrap();
        let (robot, approach) = (&hands.first, Approach::new(&hands).unwrap());
        let of = |name: &str| approach.of_link(robot.tree.link_index(name).unwrap());
        let count = |a: &str, b: &str| of(a).between(of(b)).0.count_ones();
        assert_eq!(count("base_link", "torso_lift_link"), 0);
        assert_eq!(count("base_link", "r_shoulder_pan_link"), 1);
        assert_eq!(count("r_shoulder_pan_link", "r_forearm_link"), 4);
        assert_eq!(count("r_gripper_palm_link", "r_gripper_l_finger_link"), 1);
        assert_eq!(of("base_link").between(Movers::NONE).0.count_ones(), 1);
        assert_eq!(of("r_wrist_roll_link").between(Movers::NONE).0.count_ones(), 8);
    }
}
