//! Branch and bound over the tested pairs.

use super::pair::{self, Bound};
use super::solid::{Kind, Plane, Solid};
use super::{CollisionModel, Hit, Poses, Query, Scratch};
use crate::batch::NearBox;
use crate::body_set::BodyIndex;
use crate::narrow::{self, Gap, Posed};
use crate::place;
use nalgebra::{Isometry3, Point3};

/// Loose bounds below this, in metres, are replaced by parry's distance. Above it a step of conservative advancement is
/// long enough as it is.
const REFINE_BELOW: f64 = 0.01;

/// Solids nearer than this, in metres, touch: rounding cannot tell such a gap from none.
pub(super) const TOUCHING: f64 = 1e-7;

/// A pair of solids that could lower the minimum.
#[derive(Debug, Clone, Copy)]
pub(super) struct Candidate {
    /// Lower bound of the distance.
    bound: f64,
    /// Numbers in [`CollisionModel::solids`].
    solids: (usize, usize),
}

/// No pair farther apart than this is a hit.
#[inline]
pub(super) fn too_near(query: &Query<'_>) -> f64 {
    query.clearance.max(TOUCHING)
}

/// The two are a hit when they are nearer than this.
#[inline]
pub(super) fn too_near_of(query: &Query<'_>, a: BodyIndex, b: BodyIndex) -> f64 {
    query.clearance_of(a, b).max(TOUCHING)
}

/// Distances from here on cannot lower `best`; never so little that a hit could be passed over.
#[inline]
fn enough(query: &Query<'_>, best: f64) -> f64 {
    best.max(too_near(query))
}

impl CollisionModel {
    /// A lower bound of the least distance over the tested pairs, at most `start`.
    pub(super) fn scan(&self, scratch: &mut Scratch, query: &Query<'_>, start: f64) -> Result<f64, Hit> {
        self.ensure_fits(scratch);
        let Scratch { poses, near, candidates, .. } = scratch;
        if let Some(hit) = Self::unsound(poses) {
            return Err(hit);
        }
        candidates.clear();
        self.against_fixed(poses, query, start, near, candidates);
        self.against_moving(poses, query, start, candidates);
        let mut best = self.against_planes(poses, query, start)?;
        // The most promising candidate first: it rules out most of the others.
        let least = (0..candidates.len()).min_by(|&i, &j| candidates[i].bound.total_cmp(&candidates[j].bound));
        if let Some(least) = least {
            candidates.swap(0, least);
        }
        for candidate in &*candidates {
            best = self.resolve(poses, query, candidate, best)?;
        }
        Ok(best)
    }

    /// A body without a sound pose, as a hit.
    pub(super) fn unsound(poses: &Poses) -> Option<Hit> {
        let body = poses.unsound.iter().next()?;
        Some(Hit { first: body, second: body, place: Point3::origin(), separation: f64::NEG_INFINITY })
    }

    /// Whether a tested pair is asked for.
    #[inline]
    pub(super) fn asked(query: &Query<'_>, a: BodyIndex, b: BodyIndex) -> bool {
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
        near: &mut Vec<NearBox>,
        candidates: &mut Vec<Candidate>,
    ) {
        for body in query.moved.intersection(&self.moving).iter() {
            let registered = &self.bodies[body.get()];
            let enough = enough(query, start);
            self.fixed_boxes.near(&poses.balls.centre(body.get()), enough + registered.radius, near);
            for found in &*near {
                let other = self.fixed_solids[found.index];
                let partner = self.solids[other].body;
                if !registered.partners.contains(partner) || !Self::asked(query, body, partner) {
                    continue;
                }
                let distance = found.distance - registered.radius;
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
    fn against_moving(&self, poses: &Poses, query: &Query<'_>, start: f64, candidates: &mut Vec<Candidate>) {
        let enough = enough(query, start);
        self.near_moving(
            poses,
            query,
            |_| enough,
            |a, b| {
                for i in self.bodies[a.get()].solids.clone() {
                    for j in self.bodies[b.get()].solids.clone() {
                        let between = (poses.placed[j].centre - poses.placed[i].centre).norm();
                        let bound = between - self.solids[i].radius - self.solids[j].radius;
                        if bound < enough {
                            candidates.push(Candidate { bound, solids: (i, j) });
                        }
                    }
                }
                None::<()>
            },
        );
    }

    /// Settles the pairs with half spaces.
    fn against_planes(&self, poses: &Poses, query: &Query<'_>, start: f64) -> Result<f64, Hit> {
        let mut best = start;
        for plane in &self.planes {
            for body in query.moved.intersection(&self.moving).iter() {
                let registered = &self.bodies[body.get()];
                if !registered.partners.contains(plane.body) || !Self::asked(query, body, plane.body) {
                    continue;
                }
                let near = too_near_of(query, body, plane.body);
                for i in registered.solids.clone() {
                    let height = self.height_over(poses, i, plane, enough(query, best));
                    if height < near {
                        return Err(hit_plane(poses, &self.solids[i], plane, height));
                    }
                    best = best.min(height);
                }
            }
        }
        Ok(best)
    }

    /// Lower bound of the height of a solid over a half space; of those that only have a box it is tightened when that is
    /// not `enough`.
    pub(super) fn height_over(&self, poses: &Poses, i: usize, plane: &Plane, enough: f64) -> f64 {
        let (solid, placed) = (&self.solids[i], &poses.placed[i]);
        let height = plane.height(solid, placed);
        if height >= enough || !matches!(solid.kind, Kind::Wrapped) {
            return height;
        }
        let local = placed.axes.tr_mul(&plane.normal);
        let origin = poses.world_from_shape(solid).translation.vector;
        plane.normal.dot(&origin) - plane.offset - solid.shape.support_extent(&-local)
    }

    /// Settles a candidate: the new minimum, or a hit.
    fn resolve(&self, poses: &Poses, query: &Query<'_>, candidate: &Candidate, best: f64) -> Result<f64, Hit> {
        let enough = enough(query, best);
        if candidate.bound >= enough {
            return Ok(best);
        }
        let (i, j) = candidate.solids;
        let near = too_near_of(query, self.solids[i].body, self.solids[j].body);
        let settled = self.settle(poses, (i, j), candidate.bound, enough, near);
        settled.map(|bound| best.min(bound)).map_err(|separation| self.hit(poses, (i, j), separation))
    }

    /// A lower bound of the distance of two solids that is at least `bound`; tightened until it is `enough` or cannot be
    /// tightened any more.
    ///
    /// # Errors
    /// What [`Hit::separation`] is to say, if they are nearer than `near`.
    pub(super) fn settle(
        &self,
        poses: &Poses,
        (i, j): (usize, usize),
        bound: f64,
        enough: f64,
        near: f64,
    ) -> Result<f64, f64> {
        let (a, b) = (&self.solids[i], &self.solids[j]);
        let closed_form = pair::bound(a, &poses.placed[i], b, &poses.placed[j], enough);
        let mut value = closed_form.value().max(bound);
        if value >= enough {
            return Ok(value);
        }
        let doubtful = match closed_form {
            Bound::Exact(_) => false,
            Bound::Signed(value) => value > 0.0 && value < near,
            Bound::Loose(value) => value < near.max(REFINE_BELOW),
        };
        if doubtful {
            match narrow::gap(&posed(poses, a), &posed(poses, b)) {
                Gap::Closed => return Err(value.min(0.0)),
                Gap::Open { distance, lower, .. } => {
                    if distance < near {
                        return Err(distance);
                    }
                    value = value.max(lower);
                }
            }
        } else if value < near {
            return Err(value);
        }
        Ok(value)
    }

    /// Distance of two solids in metres, or a lower bound of it that is at least `enough`; 0 when they touch or overlap.
    pub(super) fn gap_between(&self, poses: &Poses, (i, j): (usize, usize), enough: f64) -> f64 {
        let (a, b) = (&self.solids[i], &self.solids[j]);
        let bound = (poses.placed[j].centre - poses.placed[i].centre).norm() - a.radius - b.radius;
        if bound >= enough {
            return bound;
        }
        match narrow::gap(&posed(poses, a), &posed(poses, b)) {
            Gap::Closed => 0.0,
            Gap::Open { distance, .. } => distance,
        }
    }

    /// Two solids that are too near.
    pub(super) fn hit(&self, poses: &Poses, (i, j): (usize, usize), separation: f64) -> Hit {
        let (a, b) = (&self.solids[i], &self.solids[j]);
        let (first, second) = (poses.world_from_shape(a), poses.world_from_shape(b));
        let place = place::shared(&a.shape, &first, &b.shape, &second);
        Hit { first: a.body, second: b.body, place, separation }
    }
}

/// A solid as the narrow phase wants it.
fn posed<'a>(poses: &Poses, solid: &'a Solid) -> Posed<'a> {
    Posed { shape: &solid.shape, parry: &solid.parry, world_from_shape: poses.world_from_shape(solid) }
}

/// A solid that is too near to a half space.
pub(super) fn hit_plane(poses: &Poses, solid: &Solid, plane: &Plane, separation: f64) -> Hit {
    let pose: Isometry3<f64> = poses.world_from_shape(solid);
    let place = place::shared(&solid.shape, &pose, &plane.shape, &plane.world_from_shape);
    Hit { first: solid.body, second: plane.body, place, separation }
}
