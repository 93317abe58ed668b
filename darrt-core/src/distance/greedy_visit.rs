//! The paper's distance: a tour in which the robot always moves the closest object first (section 4.3).

use smallvec::SmallVec;

use super::Distance;
use super::euclidean::object_travel;
use crate::domain::Domain;
use crate::nearest::bounds::{LANES, Lanes, Ways};
use crate::nearest::pruned::nearest_pruned;
use crate::partial::PartialState;
use crate::space::ComponentSpace;
use crate::state::{ObjectId, State};
use crate::tree::{NodeId, Tree};

/// Robot to the nearest object that is not at its target, along with it to the target, on to the next
/// nearest, and finally to the robot's own target.
#[derive(Debug, Clone, Copy, Default)]
pub struct GreedyVisit;

impl<D: Domain> Distance<D> for GreedyVisit {
    fn distance(&self, m: &D, from: &State<D>, to: &PartialState<D>) -> f64 {
        greedy_tour(m, &Departure { state: from, working_point: None }, to)
    }

    fn nearest(&self, m: &D, tree: &Tree<D>, to: &PartialState<D>) -> Option<NodeId> {
        nearest_departure(m, tree, to, |from| greedy_tour(m, from, to))
    }
}

/// Where a tour starts: a state, and its working point if that is already known.
pub(crate) struct Departure<'a, D: Domain> {
    pub(crate) state: &'a State<D>,
    pub(crate) working_point: Option<[f64; 3]>,
}

/// The node with the shortest tour, its penalty included; the lowest index wins a tie.
pub(super) fn nearest_departure<D: Domain>(
    m: &D,
    tree: &Tree<D>,
    to: &PartialState<D>,
    tour: impl Fn(&Departure<'_, D>) -> f64,
) -> Option<NodeId> {
    nearest_pruned(m, tree, to, tour_at_least, |node| {
        tour(&Departure { state: &node.state, working_point: Some(node.working_point()) })
    })
}

/// Every tour has the ways of all open objects, and begins with the way to one of them.
#[inline]
pub(crate) fn tour_at_least(ways: &Ways, out: &mut Lanes) {
    // The way to the nearest object, and the whole tour if none is open.
    let (mut travel, mut alone) = ([f32::INFINITY; LANES], [0.0; LANES]);
    let mut is_open = [false; LANES];
    if let Some(robot_m) = &ways.robot_m {
        alone = *robot_m;
    }
    *out = [0.0; LANES];
    for object in &ways.objects {
        for lane in 0..LANES {
            let (way, reach) = (object.way_m[lane], object.reach_m[lane]);
            // A way within the tolerance does not count.
            let counts = way > object.open_m;
            out[lane] += if counts { way } else { 0.0 };
            is_open[lane] |= counts;
            travel[lane] = if reach < travel[lane] { reach } else { travel[lane] };
        }
    }
    for lane in 0..LANES {
        let first = if is_open[lane] || travel[lane] < alone[lane] { travel[lane] } else { alone[lane] };
        out[lane] += first;
    }
}

/// An object that is not at its target, and how far it is from there.
type Open = SmallVec<[(ObjectId, f64); 8]>;

/// The named objects that are not at their targets, and the sum of their ways.
pub(crate) fn open_objects<D: Domain>(m: &D, from: &State<D>, to: &PartialState<D>) -> (Open, f64) {
    let ways = to.objects().map(|(id, target)| (id, object_travel(m, from, id, target)));
    // A way that is not a number is not met either.
    let is_open = |id: ObjectId, way: f64| {
        m.objects().get(id.index()).is_some_and(|space| way.is_nan() || way > space.tolerance())
    };
    let open: Open = ways.filter(|(id, way)| is_open(*id, *way)).collect();
    let sum = open.iter().map(|(_, way)| way).sum();
    (open, sum)
}

pub(crate) fn greedy_tour<D: Domain>(m: &D, from: &Departure<'_, D>, to: &PartialState<D>) -> f64 {
    let (mut open, mut total) = open_objects(m, from.state, to);
    let mut last: Option<ObjectId> = None;
    while let Some((slot, travel)) = nearest_open(m, from, to, &open, last) {
        last = Some(open.swap_remove(slot).0);
        total += travel;
    }
    total + last_stretch(m, from.state, to, last)
}

/// Which of the `open` objects is closest to where the robot now is, and how far.
fn nearest_open<D: Domain>(
    m: &D,
    from: &Departure<'_, D>,
    to: &PartialState<D>,
    open: &[(ObjectId, f64)],
    last: Option<ObjectId>,
) -> Option<(usize, f64)> {
    let distances = open.iter().enumerate().map(|(slot, (id, _))| (slot, *id, travel_between(m, from, to, last, *id)));
    distances.min_by(|a, b| a.2.total_cmp(&b.2).then(a.1.cmp(&b.1))).map(|(slot, _, travel)| (slot, travel))
}

/// Metres from the target of `last` (or from the robot's start) to the present place of `next`.
pub(super) fn travel_between<D: Domain>(
    m: &D,
    from: &Departure<'_, D>,
    to: &PartialState<D>,
    last: Option<ObjectId>,
    next: ObjectId,
) -> f64 {
    let Some(at) = from.state.object(next) else { return 0.0 };
    match (last.and_then(|id| Some((id, to.object(id)?))), from.working_point) {
        (Some(done), _) => m.travel_between(done, (next, at)),
        (None, Some(point)) => m.reach_from(point, &from.state.robot, next, at),
        (None, None) => m.reach(&from.state.robot, next, at),
    }
}

/// Metres from the last object's target to the robot's own target.
pub(super) fn last_stretch<D: Domain>(m: &D, from: &State<D>, to: &PartialState<D>, last: Option<ObjectId>) -> f64 {
    if to.robot().is_none() {
        return 0.0;
    }
    let goal = to.robot_overlay(m, &from.robot);
    match last.and_then(|id| Some((id, to.object(id)?))) {
        Some((id, at)) => m.reach(&goal, id, at),
        None => m.robot().distance(&from.robot, &goal),
    }
}
