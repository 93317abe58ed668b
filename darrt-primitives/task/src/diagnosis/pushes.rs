//! What becomes of pushes: of one object, from where it stands and from where pushes have brought it.

use std::collections::BTreeMap;

use darrt_core::primitive::Infeasible;
use darrt_core::random::{Purpose, stream};
use darrt_core::state::ObjectId;
use darrt_primitives::action::pick::{lies_flat, pick};
use darrt_primitives::action::push::push;
use darrt_primitives::manipulator::Manipulator;
use darrt_primitives::tabletop::TabletopState;
use nalgebra::{Isometry3, Point2, Translation3};
use rand::{Rng, RngExt as _};

use super::cause::{EdgeReach, Place, Pushes};
use super::hands::{Look, culprit, ranked};

/// Pushes that are tried.
const PUSHES: u64 = 384;
/// Picks that are tried at the end of each push that may lead to one.
const PICKS: u64 = 4;
/// Ends of pushes that are pushed on from at most.
const ENDS: usize = 48;
/// Places along each edge.
const PLACES: u32 = 3;
/// How far it is tried to push an object, metres.
const LENGTHS_M: std::ops::Range<f64> = 0.05..1.5;
/// So many ends at which it can be taken are enough.
const ENOUGH: u64 = 3;

impl<M: Manipulator> Look<'_, M> {
    /// What becomes of pushes of the object, the others standing as in `state`.
    pub(super) fn pushing(&self, state: &TabletopState<M>, id: ObjectId) -> Pushes {
        let mut blockers = BTreeMap::<String, u64>::new();
        let object = self.m.movable(id).map_or_else(String::new, |movable| movable.body.name.to_string());
        let mut pushes =
            Pushes { object, tried: 0, made: 0, taken: 0, at_goal: 0, blockers: Vec::new(), unreachable: 0 };
        let mut ends = vec![state.clone()];
        while pushes.tried < PUSHES && pushes.taken < ENOUGH && pushes.at_goal < ENOUGH && !self.cancel.is_cancelled() {
            let rng = &mut stream(0, 3, pushes.tried, Purpose::Attempt);
            pushes.tried += 1;
            let Some(from) = ends.get(rng.random_range(0..ends.len())) else { break };
            let Some(target) = self.push_target(from, id, rng) else { break };
            match push(self.m, from, id, &target, rng) {
                Ok(way) => {
                    pushes.made += 1;
                    let end = way.iter().fold(from.clone(), |state, instance| instance.at(self.m, 1.0, &state));
                    let goals = self.goal.groups().iter().flatten().filter(|goal| goal.object == id);
                    // The hand still stands at it.
                    let is_there = goals.into_iter().any(|goal| {
                        let free = end.mode.disengaged().unwrap_or_else(|| end.mode.clone());
                        goal.is_met(&TabletopState::<M> { mode: free, ..end.clone() })
                    });
                    pushes.at_goal += u64::from(is_there);
                    let takes = |i| pick(self.m, &end, id, &mut stream(i, 4, pushes.tried, Purpose::Attempt));
                    if !lies_flat(self.m, &end, id) && (0..PICKS).any(|i| takes(i).is_ok()) {
                        pushes.taken += 1;
                    }
                    if ends.len() < ENDS {
                        ends.push(end);
                    }
                }
                Err(Infeasible::Blocked(blame)) => {
                    *blockers.entry(culprit(self.m, id, &blame)).or_default() += 1;
                }
                Err(Infeasible::Unreachable | Infeasible::Limits) => pushes.unreachable += 1,
                Err(_) => {}
            }
        }
        pushes.blockers = ranked(blockers);
        pushes
    }

    /// A place around the object, also beyond the edge of what it stands on, or one of its goals.
    fn push_target(&self, from: &TabletopState<M>, id: ObjectId, rng: &mut dyn Rng) -> Option<Isometry3<f64>> {
        use darrt_core::goal::Goal as _;
        if rng.random_bool(0.25)
            && let Some(target) =
                self.goal.of_objects().sample(self.m, rng).and_then(|target| target.object(id).copied())
        {
            return Some(target);
        }
        let (y, x) = rng.random_range(-std::f64::consts::PI..std::f64::consts::PI).sin_cos();
        let far_m = rng.random_range(LENGTHS_M);
        Some(Translation3::new(far_m * x, far_m * y, 0.0) * from.object(id)?)
    }

    /// What becomes of the hands that take the object at each edge of what it stands on.
    pub(super) fn at_edges(&self, state: &TabletopState<M>, id: ObjectId) -> Vec<EdgeReach> {
        let Some(movable) = self.m.movable(id) else { return Vec::new() };
        let Some(surface) = state.mode.support_of(id).and_then(|id| self.m.surface(id)) else { return Vec::new() };
        let (Some(radius_m), Some(pose)) = (movable.round_radius_m, state.object(id)) else { return Vec::new() };
        let Ok(Some(inside)) = movable.rim.edge_distances(radius_m) else { return Vec::new() };
        let of_edge = |edge: &darrt_geom::support::Edge| {
            let places = (1..=PLACES).map(|i| f64::from(i) / f64::from(PLACES + 1)).map(|share| {
                let at = edge.start + (edge.end - edge.start) * share - edge.outward.into_inner() * inside.middle();
                let mut there = state.clone();
                if let Some(slot) = there.objects.get_mut(id.index()) {
                    *slot = Translation3::new(at.x - pose.translation.x, at.y - pose.translation.y, 0.0) * *pose;
                }
                self.taking(&there, id, Place::Edge).hands
            });
            let best = places.max_by_key(|hands| (hands.good, hands.last_stage()))?;
            let middle = Point2::from((edge.start.coords + edge.end.coords) / 2.0);
            let outward = edge.outward.into_inner().into();
            Some(EdgeReach { surface: surface.name().to_owned(), middle: middle.coords.into(), outward, hands: best })
        };
        surface.edges().iter().filter_map(of_edge).collect()
    }
}
