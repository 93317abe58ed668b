//! Postures to begin with, and the pairs of links that stand in each other.

use darrt_core::random::{Purpose, Stream, stream};
use darrt_primitives::joints::Joints;
use darrt_primitives::manipulator::{Configuration, JointVector as _, LinkGroup, Manipulator as _};
use darrt_primitives::mobile_arm_space::difference;
use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use rand::RngExt as _;

use super::super::FileRobot;
use super::super::apart::{distances, drawn_arm};
use super::super::load::Loaded;
use super::super::sampled;
use super::super::travel::corners;
use crate::problem_file::Limits;
use crate::robot_file::RobotFileError;

/// Places of the hand that are tried for a posture.
const TRIES: usize = 400;
/// So many of the best are looked at for what touches.
const LOOKED_AT: usize = 60;
/// How far links keep from each other in it, metres: the first for which one is found. Some stand nearer in all.
const APART_M: [f64; 3] = [0.01, 0.003, 1e-4];
/// Steps of the way between two postures.
const STEPS: u32 = 24;
/// How far joints keep from their limits in it, as a share of half their range.
const ROOM: f64 = 0.04;
/// How far all but the base keeps from the floor, metres.
const ABOVE_FLOOR_M: f64 = 0.05;
/// HEURISTIC: what is higher than most tables, metres, is seldom in the way.
const TABLES_M: f64 = 0.9;
const ABOVE_TABLES: f64 = 0.5;
const OVER_BASE: f64 = 0.1;

/// What was found.
#[derive(Debug, Clone, Default)]
pub(super) struct Found {
    /// The hand points down in front of the robot, the joints far from their limits, and nothing touches.
    pub(super) hand_down: Option<Vec<f64>>,
    /// The arm is drawn in, nothing touches, neither on the straight way to the other one.
    pub(super) drawn_in: Option<Vec<f64>>,
    /// The pairs that touch anyway, and in which share of all configurations.
    pub(super) ignore: Vec<([String; 2], String)>,
}

/// What a robot stands on, seen from above.
#[derive(Debug, Clone, Copy)]
pub(super) struct Footprint {
    low: [f64; 2],
    high: [f64; 2],
    floor_m: f64,
}

impl Footprint {
    /// The box around points, in a frame whose z axis points up.
    pub(super) fn of(points: impl Iterator<Item = Point3<f64>>, floor_m: f64) -> Self {
        let none = Self { low: [0.0; 2], high: [0.0; 2], floor_m };
        points.filter(|at| at.z - floor_m <= TABLES_M).fold(none, |known, at| Self {
            low: [known.low[0].min(at.x), known.low[1].min(at.y)],
            high: [known.high[0].max(at.x), known.high[1].max(at.y)],
            floor_m,
        })
    }

    /// How much a point of a limb is in the way, metres: how far it is beside what the robot stands on, less above tables; and a
    /// little of how far from the middle, so that what is over the base is drawn in too.
    pub(super) fn in_the_way_m(&self, at: &Point3<f64>) -> f64 {
        let beside = |axis: usize| (at[axis] - self.high[axis]).max(self.low[axis] - at[axis]).max(0.0);
        let share = if at.z - self.floor_m > TABLES_M { ABOVE_TABLES } else { 1.0 };
        share * beside(0).hypot(beside(1)) + OVER_BASE * at.x.hypot(at.y)
    }
}

/// What is rigid to the base.
fn footprint(robot: &FileRobot) -> Footprint {
    let rigid = robot.links.iter().zip(&robot.places).filter(|(link, _)| link.group == LinkGroup::Base);
    Footprint::of(rigid.flat_map(|(link, place)| corners(&link.body).into_iter().map(|at| place.offset * at)), 0.0)
}

pub(super) fn search(loaded: &Loaded) -> Result<Found, RobotFileError> {
    let robot = loaded.robot(Limits::Soft, [0.0; 3])?;
    let mut rng = stream(0, 0, 0, Purpose::Extend);
    let pairs = sampled::pairs(loaded, &robot)?;
    let ignore = pairs.all.iter().filter(|pair| pair.is_joined(pairs.samples)).map(|pair| {
        let why = format!("{:.0} %", 100.0 * pair.share(pairs.samples));
        (pair.links.clone(), why)
    });
    let ignore: Vec<_> = ignore.collect();
    // The file names links, not the pads that take their place.
    let name = |link: usize| robot.links().get(link).map_or("", |link| link.body.name.trim_end_matches("_pad"));
    let is_joined = |a: usize, b: usize| {
        ignore
            .iter()
            .any(|([first, second], _)| [name(a), name(b)] == [first, second] || [name(b), name(a)] == [first, second])
    };
    let kept: Vec<_> = robot.self_pairs().iter().copied().filter(|(a, b)| !is_joined(*a, *b)).collect();
    let tried = Tried { robot: &robot, pairs: &kept, gap_m: robot.hand().max_gap_m(), footprint: footprint(&robot) };
    let found = APART_M.into_iter().find_map(|apart_m| Some((tried.hand_down(apart_m, &mut rng)?, apart_m)));
    // A hand that never points down is drawn in from anywhere.
    let from =
        found.or_else(|| APART_M.into_iter().find_map(|apart_m| Some((tried.anywhere(apart_m, &mut rng)?, apart_m))));
    let drawn_in = from.and_then(|(other, apart_m)| tried.drawn_in(&other, apart_m, &mut rng));
    let hand_down = found.map(|(hand_down, _)| hand_down);
    let values = |arm: Joints| arm.as_ref().to_vec();
    Ok(Found { hand_down: hand_down.map(values), drawn_in: drawn_in.map(values), ignore })
}

/// A robot with what must not touch in it.
struct Tried<'a> {
    robot: &'a FileRobot,
    pairs: &'a [(usize, usize)],
    gap_m: f64,
    footprint: Footprint,
}

impl Tried<'_> {
    /// Of configurations with a hand that points down those are looked at whose joints are far from their limits.
    fn hand_down(&self, apart_m: f64, rng: &mut Stream) -> Option<Joints> {
        let mut drawn: Vec<_> =
            (0..TRIES).filter_map(|_| self.down(rng, 0.2..0.7)).map(|arm| (self.room(&arm), arm)).collect();
        drawn.sort_by(|(a, _), (b, _)| b.total_cmp(a));
        drawn.into_iter().map(|(_, arm)| arm).find(|arm| self.reach(arm).is_some() && self.is_free(arm, apart_m))
    }

    /// Some configuration of an arm that does not lift its hand, or tilt it, in which nothing touches.
    fn anywhere(&self, apart_m: f64, rng: &mut Stream) -> Option<Joints> {
        self.robot.hand_ties().up_in_tool?;
        let mut drawn = (0..TRIES).filter_map(|_| drawn_arm(self.robot, rng));
        drawn.find(|arm| self.room(arm) >= ROOM && self.reach(arm).is_some() && self.is_free(arm, apart_m))
    }

    /// The configuration that is least in the way of those from which a straight way leads to `other`.
    fn drawn_in(&self, other: &Joints, apart_m: f64, rng: &mut Stream) -> Option<Joints> {
        let mut drawn: Vec<Joints> = (0..TRIES).filter_map(|_| self.down(rng, 0.1..0.5)).collect();
        drawn.extend((0..4 * TRIES).filter_map(|_| drawn_arm(self.robot, rng)));
        drawn.push(*other);
        drawn.retain(|arm| self.room(arm) >= ROOM);
        let mut drawn: Vec<_> = drawn.into_iter().filter_map(|arm| Some((self.reach(&arm)?, arm))).collect();
        drawn.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        let free = drawn.into_iter().map(|(_, arm)| arm).filter(|arm| self.is_free(arm, apart_m));
        free.take(LOOKED_AT).find(|arm| self.is_way_free(arm, other))
    }

    /// A configuration in which the hand points down so far ahead.
    fn down(&self, rng: &mut Stream, ahead: std::ops::Range<f64>) -> Option<Joints> {
        let (ahead, side) = (rng.random_range(ahead), rng.random_range(-0.2..0.2));
        let height = rng.random_range(0.2..1.4);
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), rng.random_range(-3.1..3.1));
        let down = turn * UnitQuaternion::from_axis_angle(&Vector3::y_axis(), std::f64::consts::FRAC_PI_2);
        let tool = Isometry3::from_parts(Vector3::new(ahead, side, height).into(), down);
        self.robot.arm_at(0, &tool, rng)
    }

    /// How far the joints are from their limits, as a share of half their range.
    fn room(&self, arm: &Joints) -> f64 {
        let values = arm.as_ref().iter().zip(self.robot.limits());
        let room = values.map(|(value, limit)| {
            if limit.is_unlimited() {
                1.0
            } else {
                (value - limit.lower).min(limit.upper - value) / (0.5 * (limit.upper - limit.lower))
            }
        });
        room.fold(1.0, f64::min)
    }

    /// How much the arm is in the way; `None` if it is too near to the floor.
    fn reach(&self, arm: &Joints) -> Option<f64> {
        let robot = self.robot;
        let mut poses = vec![Isometry3::identity(); robot.links().len()];
        robot.link_poses(&Configuration { base: [0.0; 3], arm: *arm }, self.gap_m, &mut poses);
        let mut reach_m = 0.0_f64;
        for (link, pose) in robot.links().iter().zip(&poses).filter(|(link, _)| link.group != LinkGroup::Base) {
            for corner in corners(&link.body) {
                let at = pose * corner;
                if at.z < ABOVE_FLOOR_M {
                    return None;
                }
                reach_m = reach_m.max(self.footprint.in_the_way_m(&at));
            }
        }
        Some(reach_m)
    }

    fn is_free(&self, arm: &Joints, apart_m: f64) -> bool {
        distances(self.robot, arm, self.gap_m, self.pairs).all(|distance| distance > apart_m)
    }

    fn is_way_free(&self, from: &Joints, to: &Joints) -> bool {
        let ways = from.as_ref().iter().zip(to.as_ref()).zip(self.robot.limits());
        let ways: Vec<f64> = ways.map(|((from, to), limit)| difference(*from, *to, limit)).collect();
        (1..STEPS).all(|step| {
            let share = f64::from(step) / f64::from(STEPS);
            let between: Vec<f64> = from.as_ref().iter().zip(&ways).map(|(from, way)| from + share * way).collect();
            Joints::from_values(&between).is_some_and(|arm| self.is_free(&arm, 0.0))
        })
    }
}
