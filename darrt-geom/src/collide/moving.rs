//! Which pairs of moving bodies may be near each other.

use super::{CollisionModel, Poses, Query};
use crate::body_set::BodyIndex;

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
        let is_every = moved == self.moving;
        for body in moved.iter() {
            let registered = &self.bodies[body.get()];
            let partners = registered.partners.intersection(&self.moving);
            let first = if is_every { body.get() } else { 0 };
            let near = poses.balls.near(first, &poses.balls.centre(body.get()), reach(body) + registered.radius);
            for other in near.intersection(&partners).iter() {
                let is_done = other < body && moved.contains(other);
                if !is_done
                    && Self::asked(query, body, other)
                    && let Some(said) = visit(body.min(other), body.max(other))
                {
                    return Some(said);
                }
            }
        }
        None
    }
}
