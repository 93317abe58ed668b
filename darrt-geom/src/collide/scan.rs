//! Branch and bound over the tested pairs.

use super::pair::{self, Bound};
use super::solid::{Kind, Plane, Solid};
use super::{CollisionModel, Hit, Poses, Query, Scratch};
use crate::batch::PlacedBox;
use crate::body_set::{BodyIndex, BodySet};
use crate::narrow::{self, Gap, Posed};
use crate::place;
use nalgebra::{Isometry3, Point3};

/// Loose bounds below this, in metres, are replaced by parry's distance. Above it a step of conservative advancement is
/// long enough as it is.
const REFINE_BELOW: f64 = 0.01;

/// Solids nearer than this, in metres, touch: rounding cannot tell such a gap from none.
const TOUCHING: f64 = 1e-7;

/// A pair of solids that could lower the minimum.
#[derive(Debug, Clone, Copy)]
pub(super) struct Candidate {
    /// Lower bound of the distance.
    bound: f64,
    /// Numbers in [`CollisionModel::solids`].
    solids: (usize, usize),
}

/// What is minimised over the pairs: a value that grows with the distance.
pub(super) trait Measure {
    /// Distances from here on cannot lower `best`.
    fn enough(&self, best: f64, a: BodyIndex, b: BodyIndex) -> f64;
    /// The value of a pair at this distance.
    fn value(&self, distance: f64, a: BodyIndex, b: BodyIndex) -> f64;
}

/// The distance itself.
pub(super) struct Metres;

impl Measure for Metres {
    #[inline]
    fn enough(&self, best: f64, _: BodyIndex, _: BodyIndex) -> f64 {
        best
    }
    #[inline]
    fn value(&self, distance: f64, _: BodyIndex, _: BodyIndex) -> f64 {
        distance
    }
}

/// How much of a motion's parameter the distance is worth.
pub(super) struct Steps<'a> {
    pub(super) reach: &'a [f64],
    pub(super) chain: &'a BodySet,
    pub(super) clearance: f64,
}

impl Steps<'_> {
    #[inline]
    fn speed(&self, a: BodyIndex, b: BodyIndex) -> f64 {
        let of = |body: BodyIndex| self.reach.get(body.get()).copied().unwrap_or(0.0);
        if self.chain.contains(a) && self.chain.contains(b) { of(a).max(of(b)) } else { of(a) + of(b) }
    }
}

impl Measure for Steps<'_> {
    #[inline]
    fn enough(&self, best: f64, a: BodyIndex, b: BodyIndex) -> f64 {
        self.clearance + best * self.speed(a, b)
    }
    #[inline]
    fn value(&self, distance: f64, a: BodyIndex, b: BodyIndex) -> f64 {
        let speed = self.speed(a, b);
        // A pair that does not approach never blocks.
        if speed > 0.0 { (distance - self.clearance) / speed } else { f64::INFINITY }
    }
}

/// Pairs nearer than this are hits.
#[inline]
fn too_near(query: &Query<'_>) -> f64 {
    query.clearance.max(TOUCHING)
}

/// [`Measure::enough`], but never so little that a hit could be passed over.
#[inline]
fn enough(measure: &impl Measure, query: &Query<'_>, best: f64, a: BodyIndex, b: BodyIndex) -> f64 {
    measure.enough(best, a, b).max(too_near(query))
}

impl CollisionModel {
    /// The least value over the tested pairs, at most `start`.
    pub(super) fn scan(
        &self,
        scratch: &mut Scratch,
        query: &Query<'_>,
        start: f64,
        measure: &impl Measure,
    ) -> Result<f64, Hit> {
        self.ensure_fits(scratch);
        let Scratch { poses, distances, candidates } = scratch;
        if let Some(body) = poses.unsound.iter().next() {
            let nowhere = Hit { first: body, second: body, place: Point3::origin(), separation: f64::NEG_INFINITY };
            return Err(nowhere);
        }
        candidates.clear();
        self.against_fixed(poses, query, start, measure, distances, candidates);
        self.against_moving(poses, query, start, measure, candidates);
        let mut best = self.against_planes(poses, query, start, measure)?;
        // The most promising candidate first: it rules out most of the others.
        let least = (0..candidates.len()).min_by(|&i, &j| candidates[i].bound.total_cmp(&candidates[j].bound));
        if let Some(least) = least {
            candidates.swap(0, least);
        }
        for candidate in &*candidates {
            best = self.resolve(poses, query, candidate, best, measure)?;
        }
        Ok(best)
    }

    /// Whether a tested pair is asked for.
    #[inline]
    fn asked(query: &Query<'_>, a: BodyIndex, b: BodyIndex) -> bool {
        let paired = query.moved.contains(a) && query.against.contains(b)
            || query.moved.contains(b) && query.against.contains(a);
        paired && !query.allowed.contains(a, b)
    }

    /// Collects the candidates between moved bodies and fixed ones.
    fn against_fixed(
        &self,
        poses: &Poses,
        query: &Query<'_>,
        start: f64,
        measure: &impl Measure,
        distances: &mut Vec<f64>,
        candidates: &mut Vec<Candidate>,
    ) {
        for body in query.moved.intersection(&self.moving).iter() {
            let registered = &self.bodies[body.get()];
            self.fixed_boxes.distances(&poses.centres[body.get()], registered.radius, distances);
            for (&other, &distance) in self.fixed_solids.iter().zip(&*distances) {
                let partner = self.solids[other].body;
                let enough = enough(measure, query, start, body, partner);
                if distance >= enough || !registered.partners.contains(partner) || !Self::asked(query, body, partner) {
                    continue;
                }
                for own in registered.solids.clone() {
                    let bound = if registered.solids.len() == 1 {
                        distance
                    } else {
                        poses.placed[other].ball_distance(&poses.placed[own].centre, self.solids[own].radius)
                    };
                    if bound < enough {
                        candidates.push(Candidate { bound, solids: (own, other) });
                    }
                }
            }
        }
    }

    /// Collects the candidates between moving bodies.
    fn against_moving(
        &self,
        poses: &Poses,
        query: &Query<'_>,
        start: f64,
        measure: &impl Measure,
        candidates: &mut Vec<Candidate>,
    ) {
        for &(a, b) in &self.moving_pairs {
            let (of_a, of_b) = (&self.bodies[a.get()], &self.bodies[b.get()]);
            let enough = enough(measure, query, start, a, b);
            let reach = enough + of_a.radius + of_b.radius;
            // OPTIMIZATION: squares compare without a root.
            let apart = (poses.centres[b.get()] - poses.centres[a.get()]).norm_squared();
            if apart >= reach * reach || !Self::asked(query, a, b) {
                continue;
            }
            for i in of_a.solids.clone() {
                for j in of_b.solids.clone() {
                    let between = (poses.placed[j].centre - poses.placed[i].centre).norm();
                    let bound = between - self.solids[i].radius - self.solids[j].radius;
                    if bound < enough {
                        candidates.push(Candidate { bound, solids: (i, j) });
                    }
                }
            }
        }
    }

    /// Settles the pairs with half spaces.
    fn against_planes(&self, poses: &Poses, query: &Query<'_>, start: f64, measure: &impl Measure) -> Result<f64, Hit> {
        let mut best = start;
        for plane in &self.planes {
            for body in query.moved.intersection(&self.moving).iter() {
                let registered = &self.bodies[body.get()];
                if !registered.partners.contains(plane.body) || !Self::asked(query, body, plane.body) {
                    continue;
                }
                for i in registered.solids.clone() {
                    let (solid, placed) = (&self.solids[i], &poses.placed[i]);
                    let enough = enough(measure, query, best, body, plane.body);
                    let mut height = plane.height(solid, placed);
                    if height < enough && matches!(solid.kind, Kind::Wrapped) {
                        let local = placed.axes.tr_mul(&plane.normal);
                        let origin = poses.world_from_shape(solid).translation.vector;
                        height = plane.normal.dot(&origin) - plane.offset - solid.shape.support_extent(&-local);
                    }
                    if height < too_near(query) {
                        return Err(hit_plane(poses, solid, plane, height));
                    }
                    best = best.min(measure.value(height, body, plane.body));
                }
            }
        }
        Ok(best)
    }

    /// Settles a candidate: the new minimum, or a hit.
    fn resolve(
        &self,
        poses: &Poses,
        query: &Query<'_>,
        candidate: &Candidate,
        best: f64,
        measure: &impl Measure,
    ) -> Result<f64, Hit> {
        let (i, j) = candidate.solids;
        let (a, b) = (&self.solids[i], &self.solids[j]);
        let (placed_a, placed_b): (&PlacedBox, &PlacedBox) = (&poses.placed[i], &poses.placed[j]);
        let enough = enough(measure, query, best, a.body, b.body);
        if candidate.bound >= enough {
            return Ok(best);
        }
        let bound = pair::bound(a, placed_a, b, placed_b, enough);
        let mut value = bound.value().max(candidate.bound);
        if value >= enough {
            return Ok(best);
        }
        let doubtful = match bound {
            Bound::Exact(_) => false,
            Bound::Signed(value) => value > 0.0 && value < too_near(query),
            Bound::Loose(value) => value < too_near(query).max(REFINE_BELOW),
        };
        if doubtful {
            match narrow::gap(&posed(poses, a), &posed(poses, b)) {
                Gap::Closed => return Err(hit(poses, a, b, value.min(0.0))),
                Gap::Open { distance, lower, .. } => {
                    if distance < too_near(query) {
                        return Err(hit(poses, a, b, distance));
                    }
                    value = value.max(lower);
                }
            }
        } else if value < too_near(query) {
            return Err(hit(poses, a, b, value));
        }
        Ok(best.min(measure.value(value, a.body, b.body)))
    }
}

/// A solid as the narrow phase wants it.
fn posed<'a>(poses: &Poses, solid: &'a Solid) -> Posed<'a> {
    Posed { shape: &solid.shape, parry: &solid.parry, world_from_shape: poses.world_from_shape(solid) }
}

/// Two solids that are too near.
fn hit(poses: &Poses, a: &Solid, b: &Solid, separation: f64) -> Hit {
    let (first, second) = (poses.world_from_shape(a), poses.world_from_shape(b));
    let place = place::shared(&a.shape, &first, &b.shape, &second);
    Hit { first: a.body, second: b.body, place, separation }
}

/// A solid that is too near to a half space.
fn hit_plane(poses: &Poses, solid: &Solid, plane: &Plane, separation: f64) -> Hit {
    let pose: Isometry3<f64> = poses.world_from_shape(solid);
    let place = place::shared(&solid.shape, &pose, &plane.shape, &plane.world_from_shape);
    Hit { first: solid.body, second: plane.body, place, separation }
}
