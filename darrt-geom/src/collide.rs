//! The planner's collision checker: how far are the moved bodies from everything they may not touch?
//!
//! A [`CollisionModel`] is built once and never changes; what changes between queries lives in a [`Scratch`], so many threads
//! can share a model. A query answers with a lower bound of the smallest distance, which conservative advancement can spend
//! as a step, or with the pair that is too near.
//!
//! Cheapest first: the ball around each moved body against the boxes around all fixed solids in one batch, balls against balls
//! for moving pairs, then (only for pairs that could still lower the minimum) a tight closed-form bound, and last of all
//! parry's iteration.

mod clear;
mod model;
mod moving;
mod pair;
mod rod;
mod scan;
mod solid;
mod watch;

use crate::allowed::AllowedContacts;
use crate::batch::{BallBatch, BoxBatch, NearBox, PlacedBox};
use crate::body_set::{BodyIndex, BodySet};
use crate::narrow;
use nalgebra::{Isometry3, Point3};
use solid::{Plane, Solid};
use std::ops::Range;
use std::sync::Arc;

pub use model::CollisionModelBuilder;
pub use watch::Travel;

/// Two bodies that are too near.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// The moving one; of two moving ones the one with the smaller index.
    pub first: BodyIndex,
    /// The other. Equal to `first` when that body has no sound pose.
    pub second: BodyIndex,
    /// A point in both, or between them (world). For pictures: hulls and meshes count as their boxes.
    pub place: Point3<f64>,
    /// Distance in metres when positive; otherwise they touch or overlap, and the size tells little. Negative infinity when a
    /// body has no sound pose.
    pub separation: f64,
}

/// What to look at in a query.
#[derive(Debug, Clone, Copy)]
pub struct Query<'a> {
    /// Pairs need one body in here.
    pub moved: &'a BodySet,
    /// And the other one in here; [`BodySet::ALL`] unless some bodies move rigidly with `moved`.
    pub against: &'a BodySet,
    /// Pairs in here are skipped.
    pub allowed: &'a AllowedContacts,
    /// Pairs nearer than this are hits, in metres. Pairs nearer than 1e-7 m touch, which always is a hit.
    pub clearance: f64,
    /// Pairs that may be nearer than that; of several that name a pair the first counts.
    pub closer: &'a [Closer],
    /// No need to know bounds above this, in metres. Small values make queries fast.
    pub cap: f64,
}

/// Pairs that may be nearer than the clearance of a query.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Closer {
    /// One body of a pair is in here,
    pub ones: BodySet,
    /// and the other one in here.
    pub others: BodySet,
    /// Such pairs are hits when they are nearer than this, in metres; more than the clearance of the query counts as that.
    pub clearance: f64,
    /// Of these pairs only this one, the smaller index first: sets do not tell the bodies of the crowd apart.
    pub only: Option<(BodyIndex, BodyIndex)>,
}

impl Closer {
    #[inline]
    fn names(&self, a: BodyIndex, b: BodyIndex) -> bool {
        let is_named =
            self.ones.contains(a) && self.others.contains(b) || self.ones.contains(b) && self.others.contains(a);
        is_named && self.only.is_none_or(|only| only == (a.min(b), a.max(b)))
    }
}

impl Query<'_> {
    /// The clearance of one pair, in metres.
    #[inline]
    pub fn clearance_of(&self, a: BodyIndex, b: BodyIndex) -> f64 {
        let closer = self.closer.iter().find(|closer| closer.names(a, b));
        closer.map_or(self.clearance, |closer| closer.clearance.min(self.clearance))
    }
}

/// A registered body.
#[derive(Debug, Clone)]
struct Registered {
    name: Arc<str>,
    /// Its pose when it is fixed.
    fixed: Option<Isometry3<f64>>,
    /// Its solids in [`CollisionModel::solids`].
    solids: Range<usize>,
    /// Ball around the body, own frame. Meaningless for a body of half spaces only.
    centre: Point3<f64>,
    radius: f64,
    /// The bodies it is tested against.
    partners: BodySet,
}

/// Bodies, fixed and moving, and which pairs of them are tested. Immutable; share it between threads.
///
/// Fixed bodies are tested against moving ones only; moving ones against all others but the disabled pairs.
///
/// # Laws
/// With o(a, b) the distance the [`crate::oracle`] finds: a query never returns more than the least o over the tested pairs
/// (to 1e-9 m); it never returns `Ok` when some tested pair intersects; when every tested pair of boxes and balls is farther apart
/// than its clearance, it returns `Ok`.
#[derive(Debug, Clone)]
pub struct CollisionModel {
    bodies: Vec<Registered>,
    /// Solids of all bodies, body by body.
    solids: Vec<Solid>,
    /// Half spaces; their bodies are fixed.
    planes: Vec<Plane>,
    moving: BodySet,
    /// Solids of the fixed bodies, for the batch, and their numbers in `solids`.
    fixed_boxes: BoxBatch,
    fixed_solids: Vec<usize>,
    /// Poses before anything has moved; what [`CollisionModel::scratch`] starts from.
    initial: Poses,
}

/// Where everything is.
#[derive(Debug, Clone)]
struct Poses {
    /// By body.
    world_from_body: Vec<Isometry3<f64>>,
    /// The balls around the bodies, in the world.
    balls: BallBatch,
    /// By solid.
    placed: Vec<PlacedBox>,
    /// Bodies whose pose is missing or unsound.
    unsound: BodySet,
}

/// Memory of one thread: poses of the moving bodies and lists that keep their capacity between queries.
#[derive(Debug, Clone)]
pub struct Scratch {
    poses: Poses,
    near: Vec<NearBox>,
    candidates: Vec<scan::Candidate>,
    watch: watch::Watch,
    met: Option<clear::Met>,
}

impl CollisionModel {
    /// Starts an empty model.
    pub fn builder() -> CollisionModelBuilder {
        CollisionModelBuilder::default()
    }

    /// Fresh memory for queries. Until a moving body gets its first pose, every query returns a [`Hit`] that names it.
    pub fn scratch(&self) -> Scratch {
        Scratch {
            poses: self.initial.clone(),
            near: Vec::new(),
            candidates: Vec::new(),
            watch: watch::Watch::default(),
            met: None,
        }
    }

    /// Number of bodies.
    pub fn len(&self) -> usize {
        self.bodies.len()
    }

    /// Whether there are no bodies.
    pub fn is_empty(&self) -> bool {
        self.bodies.is_empty()
    }

    /// What the body is called; `None` when there is no such body.
    pub fn name(&self, body: BodyIndex) -> Option<&Arc<str>> {
        self.bodies.get(body.get()).map(|registered| &registered.name)
    }

    /// The body of that name.
    pub fn find(&self, name: &str) -> Option<BodyIndex> {
        self.indices().find(|body| self.name(*body).is_some_and(|n| &**n == name))
    }

    /// All bodies in order of registration.
    pub fn indices(&self) -> impl Iterator<Item = BodyIndex> + '_ {
        (0_u16..).map(BodyIndex::new).take(self.bodies.len())
    }

    /// The moving bodies.
    pub fn moving(&self) -> &BodySet {
        &self.moving
    }

    /// Whether the pair is tested at all (order does not matter).
    pub fn is_tested(&self, a: BodyIndex, b: BodyIndex) -> bool {
        self.bodies.get(a.get()).is_some_and(|registered| registered.partners.contains(b))
    }

    /// Places the moving bodies, in order of registration. Poses beyond the last moving body are ignored; bodies without a
    /// pose stay where they were.
    pub fn set_poses(&self, scratch: &mut Scratch, world_from_body: &[Isometry3<f64>]) {
        for (body, pose) in self.moving.iter().zip(world_from_body) {
            self.set_pose(scratch, body, pose);
        }
    }

    /// Places one moving body; a fixed or unknown one is left alone.
    ///
    /// A pose that is not finite, is farther than 1e6 m away or has no unit quaternion makes every query a [`Hit`] until the
    /// body gets a sound one.
    pub fn set_pose(&self, scratch: &mut Scratch, body: BodyIndex, world_from_body: &Isometry3<f64>) {
        if !self.moving.contains(body) {
            return;
        }
        self.ensure_fits(scratch);
        self.place(&mut scratch.poses, body, world_from_body);
    }

    /// Writes the pose of a body and of what hangs on it.
    fn place(&self, poses: &mut Poses, body: BodyIndex, world_from_body: &Isometry3<f64>) {
        let Some(registered) = self.bodies.get(body.get()) else { return };
        // OPTIMIZATION: of one question to the next most bodies stand still.
        if poses.world_from_body.get(body.get()) == Some(world_from_body) && !poses.unsound.contains(body) {
            return;
        }
        if !narrow::is_sound(world_from_body) {
            poses.unsound.insert(body);
            return;
        }
        poses.unsound.remove(body);
        self.put(poses, body, registered, world_from_body);
    }

    /// Places a body, whose pose is sound.
    fn put(&self, poses: &mut Poses, body: BodyIndex, registered: &Registered, world_from_body: &Isometry3<f64>) {
        let axes = world_from_body.rotation.to_rotation_matrix().into_inner();
        let origin = world_from_body.translation.vector;
        if let Some(pose) = poses.world_from_body.get_mut(body.get()) {
            *pose = *world_from_body;
        }
        poses.balls.put(body.get(), &solid::carried(&axes, &origin, &registered.centre));
        let range = registered.solids.clone();
        let (Some(placed), Some(solids)) = (poses.placed.get_mut(range.clone()), self.solids.get(range)) else {
            return;
        };
        for (placed, solid) in placed.iter_mut().zip(solids) {
            *placed = solid.placed(&axes, &origin);
        }
    }

    /// Lower bound in metres (at least 0) of the smallest distance over all tested pairs with at least one body in `moved`,
    /// capped at `cap`; pairs in `allowed` are skipped. Fixed bodies in `moved` do not count as moved.
    ///
    /// # Errors
    /// The first pair found that is nearer than `clearance` metres, touches (to 1e-7 m) or overlaps; not necessarily the nearest
    /// pair.
    pub fn clearance(
        &self,
        scratch: &mut Scratch,
        moved: &BodySet,
        allowed: &AllowedContacts,
        clearance: f64,
        cap: f64,
    ) -> Result<f64, Hit> {
        self.lower_bound(scratch, &Query { moved, against: &BodySet::ALL, allowed, clearance, closer: &[], cap })
    }

    /// [`Self::clearance`] with all its choices.
    ///
    /// # Errors
    /// As [`Self::clearance`].
    pub fn lower_bound(&self, scratch: &mut Scratch, query: &Query<'_>) -> Result<f64, Hit> {
        // Bounds between the cap and the clearance decide about hits, so the scan must see them.
        let start = query.cap.max(query.clearance);
        let found = self.scan(scratch, query, start)?;
        Ok(found.min(query.cap).max(0.0))
    }

    /// Distance of two bodies in metres, at their present poses; 0 when they touch or overlap, or one has no sound pose. From
    /// `enough` on any lower bound of it that is at least `enough`. Whether the pair is tested does not matter.
    pub fn distance_between(&self, scratch: &Scratch, a: BodyIndex, b: BodyIndex, enough: f64) -> f64 {
        let poses = &scratch.poses;
        let (Some(of_a), Some(of_b)) = (self.bodies.get(a.get()), self.bodies.get(b.get())) else { return 0.0 };
        let is_fitting = poses.placed.len() == self.solids.len() && poses.world_from_body.len() == self.bodies.len();
        if !is_fitting || [a, b].iter().any(|body| poses.unsound.contains(*body)) {
            return 0.0;
        }
        let mut least = f64::INFINITY;
        for i in of_a.solids.clone() {
            for j in of_b.solids.clone() {
                least = least.min(self.gap_between(poses, (i, j), enough));
            }
        }
        for (plane, other) in self.planes.iter().flat_map(|plane| [(plane, (a, of_b)), (plane, (b, of_a))]) {
            if plane.body == other.0 {
                let heights = other.1.solids.clone().map(|i| self.height_over(poses, i, plane, f64::INFINITY));
                least = heights.fold(least, f64::min);
            }
        }
        least.max(0.0)
    }

    /// A ball around the body in its own frame: centre and radius in metres. `None` for a body without a bounded solid.
    pub fn ball(&self, body: BodyIndex) -> Option<(Point3<f64>, f64)> {
        let registered = self.bodies.get(body.get()).filter(|registered| !registered.solids.is_empty())?;
        Some((registered.centre, registered.radius))
    }

    /// Makes a scratch of another model fit this one (everything unposed), so that mixing them up cannot panic.
    fn ensure_fits(&self, scratch: &mut Scratch) {
        let poses = &scratch.poses;
        if poses.placed.len() != self.solids.len() || poses.world_from_body.len() != self.bodies.len() {
            scratch.poses = self.initial.clone();
        }
    }
}

impl Poses {
    /// The pose of a solid's own frame.
    fn world_from_shape(&self, solid: &Solid) -> Isometry3<f64> {
        self.world_from_body.get(solid.body.get()).copied().unwrap_or_else(Isometry3::identity) * solid.body_from_shape
    }
}

#[cfg(test)]
mod tests;
