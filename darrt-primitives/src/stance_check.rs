//! What a primitive may know about a stance before the obstacles are asked: the robot's own shape and the surfaces that
//! things stand on are facts of M (a table top is in every sample of an object), so a stance in which the robot passes
//! through itself or through a support surface is not worth proposing.

use std::sync::Mutex;

use darrt_geom::allowed::AllowedContacts;
use darrt_geom::body::{Body, Part};
use darrt_geom::body_set::{BodyIndex, BodySet};
use darrt_geom::collide::{CollisionModel, Query, Scratch};
use darrt_geom::error::GeomError;
use darrt_geom::shape::Shape;
use darrt_geom::support::SupportSurface;
use nalgebra::{Isometry3, Point2, Point3};

use crate::manipulator::{Configuration, LinkGroup, Manipulator};

/// How thick a support surface is taken to be below its top, metres: the thinnest table there is.
const PLATE_THICKNESS: f64 = 0.02;
/// How far below the surface the plate begins, metres: what stands on the surface does not touch it.
const PLATE_DEPTH: f64 = 0.001;

/// The robot and the support surfaces as thin plates.
pub struct StanceCheck {
    model: CollisionModel,
    links: Vec<BodyIndex>,
    base_links: BodySet,
    workers: Mutex<Vec<(Scratch, Vec<Isometry3<f64>>)>>,
}

impl StanceCheck {
    /// For this robot among these surfaces.
    ///
    /// # Errors
    /// [`GeomError`] if there are too many bodies or a link's shape cannot be used.
    pub fn new<M: Manipulator>(robot: &M, surfaces: &[SupportSurface]) -> Result<Self, GeomError> {
        let mut model = CollisionModel::builder();
        let mut links = Vec::new();
        let mut base_links = BodySet::EMPTY;
        for link in robot.links() {
            let id = model.add_moving(&link.body)?;
            if link.group == LinkGroup::Base {
                base_links.insert(id);
            }
            links.push(id);
        }
        for (i, a) in links.iter().enumerate() {
            for (j, b) in links.iter().enumerate().skip(i + 1) {
                if !robot.self_pairs().contains(&(i, j)) && !robot.self_pairs().contains(&(j, i)) {
                    model.disable(*a, *b)?;
                }
            }
        }
        for (i, surface) in surfaces.iter().enumerate() {
            // The convex hull of an indented polygon covers more than the surface; such a surface is left to the
            // obstacles that carry it.
            if let (true, Some(plate)) = (is_convex(surface.vertices()), plate(surface)) {
                let body = Body::new(format!("surface {i}"), vec![Part::centred(plate)])?;
                model.add_fixed(&body, &Isometry3::identity())?;
            }
        }
        Ok(Self { model: model.build(), links, base_links, workers: Mutex::new(Vec::new()) })
    }

    /// Do base, trunk and parked arm keep clear of the surfaces? Needs no arm configuration worth the name.
    pub fn is_base_clear<M: Manipulator>(&self, robot: &M, q: &Configuration<M::Joints>) -> bool {
        self.is_clear_among(robot, q, robot.hand().max_gap_m(), &self.base_links)
    }

    /// Does the whole robot keep clear of itself and of the surfaces?
    pub fn is_clear<M: Manipulator>(&self, robot: &M, q: &Configuration<M::Joints>, gap_m: f64) -> bool {
        self.is_clear_among(robot, q, gap_m, &BodySet::ALL)
    }

    fn is_clear_among<M: Manipulator>(
        &self,
        robot: &M,
        q: &Configuration<M::Joints>,
        gap_m: f64,
        moved: &BodySet,
    ) -> bool {
        let spare = self.workers.lock().ok().and_then(|mut w| w.pop());
        let (mut scratch, mut poses) =
            spare.unwrap_or_else(|| (self.model.scratch(), vec![Isometry3::identity(); self.links.len()]));
        robot.link_poses(q, gap_m, &mut poses);
        self.model.set_poses(&mut scratch, &poses);
        // For the base alone, what the arm does must not count.
        let against = if *moved == BodySet::ALL { BodySet::ALL } else { BodySet::ALL.difference(self.model.moving()) };
        let allowed = AllowedContacts::none();
        let query = Query { moved, against: &against, allowed: &allowed, clearance: 0.0, cap: 0.0 };
        let is_clear = self.model.lower_bound(&mut scratch, &query).is_ok();
        if let Ok(mut workers) = self.workers.lock() {
            workers.push((scratch, poses));
        }
        is_clear
    }
}

impl std::fmt::Debug for StanceCheck {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("StanceCheck").field("links", &self.links.len()).finish_non_exhaustive()
    }
}

/// A thin slab just below the surface.
fn plate(surface: &SupportSurface) -> Option<Shape> {
    let top = surface.height() - PLATE_DEPTH;
    let corners: Vec<Point3<f64>> = surface
        .vertices()
        .iter()
        .flat_map(|v| [Point3::new(v.x, v.y, top), Point3::new(v.x, v.y, top - PLATE_THICKNESS)])
        .collect();
    Shape::convex_hull(surface.name(), &corners).ok()
}

/// Does the counter-clockwise polygon never turn right?
fn is_convex(vertices: &[Point2<f64>]) -> bool {
    let ring = vertices.iter().zip(vertices.iter().cycle().skip(1)).zip(vertices.iter().cycle().skip(2));
    ring.take(vertices.len()).all(|((a, b), c)| (b - a).perp(&(c - b)) >= 0.0)
}
