//! Yes or no: is every tested pair clear? For searches that ask about many states and need no reasons.

use super::scan::{too_near, too_near_of};
use super::watch::Other;
use super::{CollisionModel, Poses, Query, Scratch};

/// Two solids that were too near when last looked at, or a solid and a half space.
pub(super) type Met = (usize, Other);

impl CollisionModel {
    /// Is no tested pair nearer than the clearance? The same as [`CollisionModel::lower_bound`] with a cap of 0, without
    /// saying which pair; of `query` the cap does not count.
    ///
    /// The pair that was too near the last time is asked about first: neighbouring states mostly fail for the same reason.
    pub fn is_clear(&self, scratch: &mut Scratch, query: &Query<'_>) -> bool {
        self.ensure_fits(scratch);
        if Self::unsound(&scratch.poses).is_some() {
            return false;
        }
        if let Some((own, other)) = scratch.met
            && let Some(near) = self.asked_near(query, own, other)
            && self.meets(&scratch.poses, own, other, near)
        {
            return false;
        }
        scratch.met = self.first_met(scratch, query);
        scratch.met.is_none()
    }

    /// Below which distance these two are too near; `None` if the query does not ask about them, or the model does not test
    /// them.
    fn asked_near(&self, query: &Query<'_>, own: usize, other: Other) -> Option<f64> {
        let partner = match other {
            Other::Solid(solid) => self.solids.get(solid).map(|solid| solid.body),
            Other::Plane(plane) => self.planes.get(plane).map(|plane| plane.body),
        };
        let (own, partner) = (self.solids.get(own)?.body, partner?);
        let is_moved = query.moved.contains(own) || self.moving.contains(partner);
        let is_asked = is_moved && self.is_tested(own, partner) && Self::asked(query, own, partner);
        is_asked.then(|| too_near_of(query, own, partner))
    }

    fn meets(&self, poses: &Poses, own: usize, other: Other, near: f64) -> bool {
        match other {
            Other::Solid(solid) => self.distance(poses, (own, solid), near, near).is_err(),
            Other::Plane(plane) => self.height_over(poses, own, &self.planes[plane], near) < near,
        }
    }

    fn first_met(&self, scratch: &mut Scratch, query: &Query<'_>) -> Option<Met> {
        let Scratch { poses, near: boxes, .. } = scratch;
        let most = too_near(query);
        for body in query.moved.intersection(&self.moving).iter() {
            let registered = &self.bodies[body.get()];
            self.fixed_boxes.near(&poses.balls.centre(body.get()), most + registered.radius, boxes);
            for found in &*boxes {
                let other = self.fixed_solids[found.index];
                let partner = self.solids[other].body;
                if !registered.partners.contains(partner) || !Self::asked(query, body, partner) {
                    continue;
                }
                let near = too_near_of(query, body, partner);
                let met = |own: &usize| self.meets(poses, *own, Other::Solid(other), near);
                if let Some(own) = registered.solids.clone().find(met) {
                    return Some((own, Other::Solid(other)));
                }
            }
            for (number, plane) in self.planes.iter().enumerate() {
                if !registered.partners.contains(plane.body) || !Self::asked(query, body, plane.body) {
                    continue;
                }
                let near = too_near_of(query, body, plane.body);
                let met = |own: &usize| self.meets(poses, *own, Other::Plane(number), near);
                if let Some(own) = registered.solids.clone().find(met) {
                    return Some((own, Other::Plane(number)));
                }
            }
        }
        self.near_moving(
            poses,
            query,
            |_| most,
            |a, b| {
                let near = too_near_of(query, a, b);
                self.bodies[a.get()].solids.clone().find_map(|own| {
                    let met = |other: &usize| self.meets(poses, own, Other::Solid(*other), near);
                    let other = self.bodies[b.get()].solids.clone().find(met)?;
                    Some((own, Other::Solid(other)))
                })
            },
        )
    }
}
