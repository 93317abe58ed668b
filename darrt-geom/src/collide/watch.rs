//! Watching a motion: which pairs may come near on a segment of it, and until when each is known to be clear.
//!
//! Most pairs are too far apart to matter on the whole segment and are looked at once. Each of the others is looked at again
//! only when what was known of it has run out, or when it is what keeps the motion from going farther.

use super::scan::{hit_plane, too_near};
use super::{CollisionModel, Hit, Poses, Query, Scratch};
use crate::body_set::{BodyIndex, BodySet};

/// How the bodies may travel on a segment of a motion.
#[derive(Debug, Clone, Copy)]
pub struct Travel<'a> {
    /// By body: how many metres any point of it travels at most per unit of the motion's parameter; bodies beyond the end
    /// of the slice stand.
    pub reach: &'a [f64],
    /// Two bodies in here belong to one kinematic chain: they approach each other no faster than the faster of them
    /// travels, because only the joints between them count. Any other two may each do their worst.
    pub chain: &'a BodySet,
    /// The parameter at the current poses.
    pub from: f64,
    /// The parameter at the end of the segment.
    pub to: f64,
}

impl Travel<'_> {
    #[inline]
    fn of(&self, body: BodyIndex) -> f64 {
        self.reach.get(body.get()).copied().unwrap_or(0.0)
    }

    #[inline]
    fn speed(&self, a: BodyIndex, b: BodyIndex) -> f64 {
        let (a_alone, b_alone) = (self.of(a), self.of(b));
        if self.chain.contains(a) && self.chain.contains(b) { a_alone.max(b_alone) } else { a_alone + b_alone }
    }
}

/// What a solid is watched against.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Other {
    /// Number in [`CollisionModel::solids`].
    Solid(usize),
    /// Number in [`CollisionModel::planes`].
    Plane(usize),
}

/// A pair that may come near before the segment ends.
#[derive(Debug, Clone, Copy)]
struct Watched {
    /// Number in [`CollisionModel::solids`].
    own: usize,
    other: Other,
    /// Metres by which the two approach at most per unit of the parameter; positive.
    speed: f64,
    /// Metres, at least 0.
    clearance: f64,
    /// The pair keeps the clearance up to this parameter.
    until: f64,
}

/// What is watched on one segment.
#[derive(Debug, Clone, Default)]
pub(super) struct Watch {
    pairs: Vec<Watched>,
    to: f64,
}

impl CollisionModel {
    /// Begins to watch a segment that starts at the current poses: afterwards [`CollisionModel::free_until`] answers for it.
    /// Of `query` the cap does not count. Pairs of which neither body travels are not looked at.
    pub fn watch(&self, scratch: &mut Scratch, query: &Query<'_>, travel: &Travel<'_>) {
        self.ensure_fits(scratch);
        let Scratch { poses, near, watch, .. } = scratch;
        let Watch { pairs, to } = watch;
        pairs.clear();
        *to = travel.to;
        let most = query.clearance.max(0.0);
        let clearance_of = |a, b| query.clearance_of(a, b).max(0.0);
        let too_near = too_near(query);
        let span = travel.to - travel.from;
        // A pair farther apart than this does not matter on this segment.
        let enough = |speed: f64| (most + span * speed).max(too_near);
        for body in query.moved.intersection(&self.moving).iter() {
            let registered = &self.bodies[body.get()];
            // Fixed bodies do not travel.
            let speed = travel.of(body);
            if speed <= 0.0 {
                continue;
            }
            self.fixed_boxes.near(&poses.balls.centre(body.get()), enough(speed) + registered.radius, near);
            for found in &*near {
                let other = self.fixed_solids[found.index];
                let partner = self.solids[other].body;
                if !registered.partners.contains(partner) || !Self::asked(query, body, partner) {
                    continue;
                }
                let (other, clearance) = (Other::Solid(other), clearance_of(body, partner));
                let own = registered.solids.clone();
                pairs.extend(own.map(|own| Watched { own, other, speed, clearance, until: travel.from }));
            }
            for (number, plane) in self.planes.iter().enumerate() {
                if registered.partners.contains(plane.body) && Self::asked(query, body, plane.body) {
                    let (other, clearance) = (Other::Plane(number), clearance_of(body, plane.body));
                    let own = registered.solids.clone();
                    pairs.extend(own.map(|own| Watched { own, other, speed, clearance, until: travel.from }));
                }
            }
        }
        let fastest = self.moving.iter().map(|body| travel.of(body)).fold(0.0, f64::max);
        self.near_moving(
            poses,
            query,
            |body| enough(travel.of(body) + fastest),
            |a, b| {
                let speed = travel.speed(a, b);
                let (of_a, of_b) = (&self.bodies[a.get()], &self.bodies[b.get()]);
                let apart = enough(speed) + of_a.radius + of_b.radius;
                // OPTIMIZATION: squares compare without a root.
                let centres = (poses.balls.centre(b.get()) - poses.balls.centre(a.get())).norm_squared();
                if speed > 0.0 && centres < apart * apart {
                    let clearance = clearance_of(a, b);
                    for own in of_a.solids.clone() {
                        let others = of_b.solids.clone().map(Other::Solid);
                        pairs.extend(others.map(|other| Watched { own, other, speed, clearance, until: travel.from }));
                    }
                }
                None::<()>
            },
        );
    }

    /// The parameter up to which nothing that is watched can come nearer than its clearance, when the bodies stand where
    /// they are at `now`: at most `now + cap`, and at most the end of the segment.
    ///
    /// # Errors
    /// A pair that is nearer than its clearance now, touches (to 1e-7 m) or overlaps.
    ///
    /// # Source
    /// Conservative advancement: B. Mirtich, "Impulse-based dynamic simulation of rigid body systems", 1996, section 2.3,
    /// with its heap of pairs by the time until which they are safe; per-pair bounds as in F. Schwarzer, M. Saha,
    /// J.-C. Latombe, "Adaptive dynamic collision checking", 2005.
    pub fn free_until(&self, scratch: &mut Scratch, now: f64, cap: f64) -> Result<f64, Hit> {
        let Scratch { poses, watch, .. } = scratch;
        if let Some(hit) = Self::unsound(poses) {
            return Err(hit);
        }
        let Watch { pairs, to } = watch;
        let mut best = (now + cap).min(*to);
        let mut first = 0;
        let mut i = 0;
        while let Some(pair) = pairs.get_mut(i) {
            // What is known of it reaches far enough.
            if pair.until >= best && pair.until > now {
                i += 1;
                continue;
            }
            let near = pair.clearance.max(super::scan::TOUCHING);
            let enough = (pair.clearance + (best - now) * pair.speed).max(near);
            let distance = match pair.other {
                Other::Solid(other) => {
                    let solids = (pair.own, other);
                    let distance = self.distance(poses, solids, enough, near);
                    distance.map_err(|separation| self.hit(poses, solids, separation))?
                }
                Other::Plane(plane) => self.height(poses, (pair.own, plane), enough, near)?,
            };
            pair.until = now + (distance - pair.clearance) / pair.speed;
            if pair.until >= *to && now < *to {
                pairs.swap_remove(i);
                continue;
            }
            if pair.until < best {
                best = pair.until;
                first = i;
            }
            i += 1;
        }
        // The most urgent pair first: it rules out most of the others next time.
        if first < pairs.len() {
            pairs.swap(0, first);
        }
        Ok(best.max(now))
    }

    /// Lower bound of the distance of two solids, as tight as need be to tell whether it is `enough`.
    ///
    /// # Errors
    /// See [`CollisionModel::settle`].
    pub(super) fn distance(&self, poses: &Poses, (i, j): (usize, usize), enough: f64, near: f64) -> Result<f64, f64> {
        let (a, b) = (&self.solids[i], &self.solids[j]);
        let (placed_a, placed_b) = (&poses.placed[i], &poses.placed[j]);
        let bound = if self.bodies[b.body.get()].fixed.is_some() {
            placed_b.ball_distance(&placed_a.centre, a.radius)
        } else {
            (placed_b.centre - placed_a.centre).norm() - a.radius - b.radius
        };
        if bound >= enough { Ok(bound) } else { self.settle(poses, (i, j), bound, enough, near) }
    }

    /// Lower bound of the height of a solid over a half space.
    fn height(&self, poses: &Poses, (i, plane): (usize, usize), enough: f64, near: f64) -> Result<f64, Hit> {
        let (solid, plane) = (&self.solids[i], &self.planes[plane]);
        let height = self.height_over(poses, i, plane, enough);
        if height < near { Err(hit_plane(poses, solid, plane, height)) } else { Ok(height) }
    }
}
