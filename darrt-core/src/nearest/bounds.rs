//! Lower bounds on the parts of a distance, for many nodes (or boxes around nodes) in one pass.

use smallvec::SmallVec;

use super::mirror::narrow;
use crate::domain::Domain;
use crate::partial::PartialState;
use crate::space::ComponentSpace;
use crate::state::{ObjectId, RobotConfig, State};

/// How many nodes or boxes are bounded in one pass.
pub const LANES: usize = 32;
/// One number for each of them.
pub type Lanes = [f32; LANES];

/// Coordinates of one point.
const POINT: usize = 3;
/// Share of the largest coordinate by which a sum of bounds in single precision may be too large: some twenty roundings of
/// half a unit in the last place of 2^-23.
const ROUNDING: f64 = 2e-6;

/// The coordinates of one node: working point, point of every object, shadow of the robot.
pub(crate) type Coordinates = SmallVec<[f64; 32]>;

/// Writes the coordinates of `state`; not a number where an object is missing.
pub(crate) fn coordinates<D: Domain>(m: &D, state: &State<D>, working_point: [f64; 3], out: &mut Coordinates) {
    out.clear();
    out.extend(working_point);
    for id in (0..m.objects().len()).map(ObjectId::new) {
        out.extend(state.object(id).map_or([f64::NAN; POINT], |at| m.object_point(id, at)));
    }
    m.robot().shadow(&state.robot, &mut |_, x| out.push(x));
}

/// What a distance is at least made of.
#[derive(Debug)]
pub struct Ways {
    /// The objects that the target names.
    pub objects: SmallVec<[ObjectWay; 2]>,
    /// Metres of the robot alone to its own target; `None` if the target does not name it.
    pub robot_m: Option<Lanes>,
}

/// The way of one object, and the way to it.
#[derive(Debug)]
pub struct ObjectWay {
    /// Which.
    pub id: ObjectId,
    /// If its way is at least this many metres, it is certainly not where it should be.
    pub open_m: f32,
    /// Metres to its target, at least.
    pub way_m: Lanes,
    /// Metres that the working point travels to it, at least.
    pub reach_m: Lanes,
}

/// A target in the coordinates of the mirror.
#[derive(Debug)]
pub(crate) struct Aim {
    objects: SmallVec<[(usize, [f32; POINT]); 2]>,
    /// Row and value.
    robot: SmallVec<[(usize, f32); 16]>,
    /// By how much a bound may be too large, metres.
    pub(crate) slack_m: f64,
}

impl Aim {
    /// `None` if a coordinate of the target is too large to reckon with, or no number. `scale_m` is the largest coordinate
    /// of a node.
    pub(crate) fn new<D: Domain>(m: &D, to: &PartialState<D>, scale_m: f64) -> Option<(Self, Ways)> {
        let mut scale_m = scale_m;
        let mut is_plain = true;
        let mut take = |x: f64| {
            is_plain &= x.abs() <= super::mirror::LARGEST_M;
            scale_m = scale_m.max(x.abs());
            narrow(x)
        };
        let objects: SmallVec<[_; 2]> =
            to.objects().map(|(id, at)| (id.index(), m.object_point(id, at).map(&mut take))).collect();
        let mut robot = SmallVec::new();
        if let Some(target) = to.robot() {
            let mut row = POINT * (1 + m.objects().len());
            m.robot().shadow(&target.config, &mut |group, x| {
                if target.groups.contains(group) {
                    robot.push((row, take(x)));
                }
                row += 1;
            });
        }
        let slack_m = ROUNDING * scale_m * (objects.len() + 2) as f64;
        let tolerance_m = |i: usize| m.objects().get(i).map_or(0.0, ComponentSpace::tolerance);
        let way = |(i, _): &(usize, _)| ObjectWay {
            id: ObjectId::new(*i),
            open_m: narrow((tolerance_m(*i) + slack_m) * (1.0 + 1e-6)),
            way_m: [0.0; LANES],
            reach_m: [0.0; LANES],
        };
        let ways = Ways { objects: objects.iter().map(way).collect(), robot_m: to.robot().map(|_| [0.0; LANES]) };
        is_plain.then_some((Self { objects, robot, slack_m }, ways))
    }

    /// Bounds for what lies between the coordinates `lower` and `upper`.
    pub(crate) fn look<D: Domain>(&self, m: &D, lower: &[Lanes], upper: &[Lanes], ways: &mut Ways) {
        for ((index, at), way) in self.objects.iter().zip(&mut ways.objects) {
            let (mut to_target, mut to_tool) = ([0.0; LANES], [0.0; LANES]);
            for (d, x) in at.iter().enumerate() {
                let row = POINT * (1 + index) + d;
                let rows = (lower.get(row), upper.get(row), lower.get(d), upper.get(d));
                let (Some(low), Some(high), Some(tool_low), Some(tool_high)) = rows else { return };
                add_square_to(low, high, *x, &mut to_target);
                add_square(low, high, tool_low, tool_high, &mut to_tool);
            }
            for lane in 0..LANES {
                way.way_m[lane] = to_target[lane].sqrt();
            }
            for lane in 0..LANES {
                way.reach_m[lane] = narrow(m.reach_at_least(way.id, f64::from(to_tool[lane].sqrt())));
            }
        }
        if let Some(robot_m) = &mut ways.robot_m {
            let mut square = [0.0; LANES];
            for (row, x) in &self.robot {
                let (Some(low), Some(high)) = (lower.get(*row), upper.get(*row)) else { return };
                add_square_to(low, high, *x, &mut square);
            }
            for lane in 0..LANES {
                robot_m[lane] = square[lane].sqrt();
            }
        }
    }
}

/// Adds the squares of the distances of `x` from the intervals `[low, high]`.
fn add_square_to(low: &Lanes, high: &Lanes, x: f32, sum: &mut Lanes) {
    for lane in 0..LANES {
        let (below, above) = (low[lane] - x, x - high[lane]);
        let gap = if below > above { below } else { above };
        let gap = if gap > 0.0 { gap } else { 0.0 };
        sum[lane] += gap * gap;
    }
}

/// Adds the squares of the gaps between the intervals `[a, b]` and `[c, d]`. Written so that the compiler makes vector
/// instructions of it.
fn add_square(a: &Lanes, b: &Lanes, c: &Lanes, d: &Lanes, sum: &mut Lanes) {
    for lane in 0..LANES {
        let (below, above) = (a[lane] - d[lane], c[lane] - b[lane]);
        let gap = if below > above { below } else { above };
        let gap = if gap > 0.0 { gap } else { 0.0 };
        sum[lane] += gap * gap;
    }
}

/// The names and number of a robot's coordinates.
pub(crate) fn robot_width<D: Domain>(m: &D, robot: &RobotConfig<D>) -> usize {
    let mut count = 0;
    m.robot().shadow(robot, &mut |_, _| count += 1);
    count
}
