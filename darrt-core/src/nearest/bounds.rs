//! Lower bounds on the parts of a distance, for many nodes (or boxes around nodes) in one pass.

use smallvec::SmallVec;

use super::coordinate_index::{CoordinateIndex, LARGEST_M, narrow};
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
/// Single precision loses up to half of 2^-23 of the largest coordinate, of a node and of a target, along each of at most 64
/// coordinates: so much of it, in all, is taken off every distance.
const LOST: f64 = 2e-6;
/// And so much of the distance itself for the squares, their sum and the root.
const KEPT: f32 = 1.0 - 4e-6;

/// The indices of a tree. Targets for objects and targets for the robot alone constrain different coordinates, and an index
/// that is sorted by both serves neither.
#[derive(Debug)]
pub(crate) struct CoordinateIndices {
    /// Working point and points of the objects.
    places: CoordinateIndex,
    /// Index coordinates of the robot.
    robot: CoordinateIndex,
}

type Coordinates = SmallVec<[f64; 32]>;

impl CoordinateIndices {
    /// Empty indices for the nodes of a tree in `m`; `robot` is any configuration.
    pub(crate) fn new<D: Domain>(m: &D, robot: &RobotConfig<D>) -> Self {
        let mut count = 0;
        m.robot().index_coordinates(robot, &mut |_, _| count += 1);
        Self { places: CoordinateIndex::new(POINT * (1 + m.objects().len())), robot: CoordinateIndex::new(count) }
    }

    /// Both.
    pub(crate) fn all(&mut self) -> [&mut CoordinateIndex; 2] {
        [&mut self.places, &mut self.robot]
    }

    /// Adds the next node.
    pub(crate) fn push<D: Domain>(
        &mut self,
        m: &D,
        state: &State<D>,
        working_point: [f64; 3],
        placement: u32,
        penalties_m: &[f64],
    ) {
        let mut all: Coordinates = working_point.into_iter().collect();
        for id in (0..m.objects().len()).map(ObjectId::new) {
            // An object that is missing is no number.
            all.extend(state.object(id).map_or([f64::NAN; POINT], |at| m.object_point(id, at)));
        }
        self.places.push(&all, placement, penalties_m);
        all.clear();
        m.robot().index_coordinates(&state.robot, &mut |_, x| all.push(x));
        self.robot.push(&all, placement, penalties_m);
    }
}

/// What a distance is at least made of.
#[derive(Debug)]
pub struct Ways {
    /// The objects that the target names.
    pub objects: SmallVec<[ObjectWay; 2]>,
    /// Metres of the robot alone to its own target; zero if the target names objects too, `None` if it does not name the robot.
    pub robot_m: Option<Lanes>,
}

/// The way of one object, and the way to it.
#[derive(Debug)]
pub struct ObjectWay {
    /// Which.
    pub id: ObjectId,
    /// If its way is more than this many metres, it is certainly not where it should be.
    pub open_m: f32,
    /// Metres to its target, at least.
    pub way_m: Lanes,
    /// Metres that the working point travels to it, at least.
    pub reach_m: Lanes,
}

/// A target in the coordinates of the index.
#[derive(Debug)]
pub(crate) struct Aim {
    objects: SmallVec<[(usize, [f32; POINT]); 2]>,
    /// Row and value.
    robot: SmallVec<[(usize, f32); 16]>,
    /// Metres that rounding may have added to the distance between a node and the target.
    lost_m: f32,
}

impl Aim {
    /// The index that serves this target, and the target in its coordinates. `None` if one of them is too large to reckon
    /// with, or no number.
    pub(crate) fn new<'a, D: Domain>(
        m: &D,
        to: &PartialState<D>,
        indices: &'a CoordinateIndices,
    ) -> Option<(&'a CoordinateIndex, Self, Ways)> {
        let names_objects = to.objects().next().is_some();
        let coordinate_index = if names_objects { &indices.places } else { &indices.robot };
        let mut scale_m = coordinate_index.scale_m();
        let mut is_plain = true;
        let mut take = |x: f64| {
            is_plain &= x.abs() <= LARGEST_M;
            scale_m = scale_m.max(x.abs());
            narrow(x)
        };
        let objects: SmallVec<[_; 2]> =
            to.objects().map(|(id, at)| (id.index(), m.object_point(id, at).map(&mut take))).collect();
        let mut robot = SmallVec::new();
        if let Some(target) = to.robot().filter(|_| !names_objects) {
            let mut row = 0;
            m.robot().index_coordinates(&target.config, &mut |group, x| {
                if target.groups.contains(group) {
                    robot.push((row, take(x)));
                }
                row += 1;
            });
        }
        let tolerance_m = |i: usize| m.objects().get(i).map_or(0.0, ComponentSpace::tolerance);
        let way = |(i, _): &(usize, _)| ObjectWay {
            id: ObjectId::new(*i),
            open_m: narrow(tolerance_m(*i) * (1.0 + 1e-6)),
            way_m: [0.0; LANES],
            reach_m: [0.0; LANES],
        };
        let ways = Ways { objects: objects.iter().map(way).collect(), robot_m: to.robot().map(|_| [0.0; LANES]) };
        is_plain.then_some((coordinate_index, Self { objects, robot, lost_m: narrow(LOST * scale_m) }, ways))
    }

    /// Bounds for nodes at the coordinates `lower`, or for boxes from `lower` to `upper`.
    pub(crate) fn look<D: Domain>(&self, m: &D, lower: &[Lanes], upper: Option<&[Lanes]>, ways: &mut Ways) {
        for ((index, at), way) in self.objects.iter().zip(&mut ways.objects) {
            let (mut to_target, mut to_tool) = ([0.0; LANES], [0.0; LANES]);
            for (d, x) in at.iter().enumerate() {
                let row = POINT * (1 + index) + d;
                add_square(Rows::of(lower, upper, row), Rows::of(lower, upper, d), &mut to_tool);
                add_square_to(Rows::of(lower, upper, row), *x, &mut to_target);
            }
            self.root(&to_target, &mut way.way_m);
            self.root(&to_tool, &mut way.reach_m);
            for reach_m in &mut way.reach_m {
                *reach_m = narrow(m.reach_at_least(way.id, f64::from(*reach_m)));
            }
        }
        if let Some(robot_m) = &mut ways.robot_m {
            let mut square = [0.0; LANES];
            for (row, x) in &self.robot {
                add_square_to(Rows::of(lower, upper, *row), *x, &mut square);
            }
            self.root(&square, robot_m);
        }
    }

    /// The roots, rounded down.
    #[inline]
    fn root(&self, squares: &Lanes, out: &mut Lanes) {
        for (out, square) in out.iter_mut().zip(squares) {
            let metres = square.sqrt() * KEPT - self.lost_m;
            *out = if metres > 0.0 { metres } else { 0.0 };
        }
    }
}

/// One coordinate of [`LANES`] nodes, or its lower and upper bounds in as many boxes.
#[derive(Clone, Copy)]
enum Rows<'a> {
    /// No such coordinate: it may be anything.
    Unknown,
    Nodes(&'a Lanes),
    Boxes(&'a Lanes, &'a Lanes),
}

impl<'a> Rows<'a> {
    #[inline]
    fn of(lower: &'a [Lanes], upper: Option<&'a [Lanes]>, row: usize) -> Self {
        match (lower.get(row), upper) {
            (Some(nodes), None) => Self::Nodes(nodes),
            (Some(low), Some(upper)) => upper.get(row).map_or(Self::Unknown, |high| Self::Boxes(low, high)),
            (None, _) => Self::Unknown,
        }
    }
}

// The loops below are written so that the compiler makes vector instructions of them: no early ends, and comparisons instead
// of `max`, which must look for numbers that are none.

/// Adds the squares of the distances from `x`.
#[inline]
fn add_square_to(rows: Rows<'_>, x: f32, sum: &mut Lanes) {
    match rows {
        Rows::Unknown => {}
        Rows::Nodes(at) => {
            for (sum, at) in sum.iter_mut().zip(at) {
                *sum += (at - x) * (at - x);
            }
        }
        Rows::Boxes(low, high) => {
            for ((sum, low), high) in sum.iter_mut().zip(low).zip(high) {
                let (below, above) = (low - x, x - high);
                let gap = if below > above { below } else { above };
                let gap = if gap > 0.0 { gap } else { 0.0 };
                *sum += gap * gap;
            }
        }
    }
}

/// Adds the squares of the gaps between two coordinates.
#[inline]
fn add_square(a: Rows<'_>, b: Rows<'_>, sum: &mut Lanes) {
    match (a, b) {
        (Rows::Nodes(a), Rows::Nodes(b)) => {
            for ((sum, a), b) in sum.iter_mut().zip(a).zip(b) {
                *sum += (a - b) * (a - b);
            }
        }
        (Rows::Boxes(low, high), Rows::Boxes(lower, upper)) => {
            let lanes = low.iter().zip(high).zip(lower.iter().zip(upper));
            for (sum, ((low, high), (lower, upper))) in sum.iter_mut().zip(lanes) {
                let (below, above) = (low - upper, lower - high);
                let gap = if below > above { below } else { above };
                let gap = if gap > 0.0 { gap } else { 0.0 };
                *sum += gap * gap;
            }
        }
        _ => {}
    }
}
