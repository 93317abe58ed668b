//! Which pairs of moving bodies may be near each other.

use super::{CollisionModel, Poses, Query};
use crate::body_set::{BodyIndex, BodySet};

impl CollisionModel {
    /// Visits the tested pairs of moving bodies that are asked for and may be near each other, smaller index first, each once,
    /// until a visit says something. All pairs are visited of which the balls are nearer than `reach` of the moved one in
    /// metres (of either, if both have moved).
    #[inline]
    pub(super) fn near_moving<T>(
        &self,
        poses: &Poses,
        query: &Query<'_>,
        reach: impl Fn(BodyIndex) -> f64,
        mut visit: impl FnMut(BodyIndex, BodyIndex) -> Option<T>,
    ) -> Option<T> {
        let moved = query.moved.intersection(&self.moving);
        // The turn of a pair that has moved altogether is that of its smaller index.
        let mut is_done = BodySet::EMPTY;
        for body in moved.iter() {
            let registered = &self.bodies[body.get()];
            // OPTIMIZATION: only those that are asked for, so that of what moves rigidly together nobody is looked at.
            let asked = if query.against.contains(body) { query.against.union(query.moved) } else { *query.against };
            let partners = registered.partners.intersection(&self.moving).difference(&is_done).intersection(&asked);
            is_done.insert(body);
            if partners.is_empty() {
                continue;
            }
            let centre = poses.balls.centre(body.get());
            for other in poses.balls.near(&partners, &centre, reach(body) + registered.radius).iter() {
                if Self::asked(query, body, other)
                    && let Some(said) = visit(body.min(other), body.max(other))
                {
                    return Some(said);
                }
            }
        }
        None
    }
}
