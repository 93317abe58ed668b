//! The paper's distance: a tour in which the robot always moves the closest object first (section 4.3).

use smallvec::SmallVec;

use super::Distance;
use super::euclidean::object_travel;
use crate::domain::Domain;
use crate::partial::PartialState;
use crate::space::ComponentSpace;
use crate::state::{ObjectId, State};

/// Robot to the nearest object that is not at its target, along with it to the target, on to the next
/// nearest, and finally to the robot's own target.
#[derive(Debug, Clone, Copy, Default)]
pub struct GreedyVisit;

impl<D: Domain> Distance<D> for GreedyVisit {
    fn distance(&self, m: &D, from: &State<D>, to: &PartialState<D>) -> f64 {
        let mut open: SmallVec<[ObjectId; 8]> =
            to.objects().map(|(id, _)| id).filter(|id| !to.is_object_met(m, from, *id)).collect();
        let mut total = 0.0;
        let mut last: Option<ObjectId> = None;
        while let Some((slot, hop)) = nearest_open(m, from, to, &open, last) {
            let id = open.swap_remove(slot);
            total += hop + to.object(id).map_or(0.0, |target| object_travel(m, from, id, target));
            last = Some(id);
        }
        total + last_leg(m, from, to, last)
    }
}

/// Which of the `open` objects is closest to where the robot now is, and how far.
fn nearest_open<D: Domain>(
    m: &D,
    from: &State<D>,
    to: &PartialState<D>,
    open: &[ObjectId],
    last: Option<ObjectId>,
) -> Option<(usize, f64)> {
    let hops = open.iter().enumerate().map(|(slot, id)| (slot, *id, hop(m, from, to, last, *id)));
    hops.min_by(|a, b| a.2.total_cmp(&b.2).then(a.1.cmp(&b.1))).map(|(slot, _, hop)| (slot, hop))
}

/// Metres from the target of `last` (or from the robot's start) to the present place of `next`.
pub(super) fn hop<D: Domain>(
    m: &D,
    from: &State<D>,
    to: &PartialState<D>,
    last: Option<ObjectId>,
    next: ObjectId,
) -> f64 {
    let Some(at) = from.object(next) else { return 0.0 };
    match last.and_then(|id| Some((id, to.object(id)?))) {
        Some(done) => m.hop(done, (next, at)),
        None => m.reach(&from.robot, next, at),
    }
}

/// Metres from the last object's target to the robot's own target.
pub(super) fn last_leg<D: Domain>(m: &D, from: &State<D>, to: &PartialState<D>, last: Option<ObjectId>) -> f64 {
    if to.robot().is_none() {
        return 0.0;
    }
    let goal = to.robot_overlay(m, &from.robot);
    match last.and_then(|id| Some((id, to.object(id)?))) {
        Some((id, at)) => m.reach(&goal, id, at),
        None => m.robot().distance(&from.robot, &goal),
    }
}
