//! How near the robot, and what it moves, come to what they may not touch: for the eye, at some moments of each step.
//!
//! The verifier judges; this only shows. It does not look at the robot against itself or against what it holds.

use std::sync::Arc;

use darrt_geom::clearance::between;
use darrt_geom::{Body, Clearance};
use nalgebra::{Isometry3, Point3, Vector3};

use super::data::{self, ClearanceData, rounded};
use super::scene::RobotModel;
use super::timeline::{Act, Moment};
use crate::problem_file::geometry::Geometry;

/// About how many moments of a plan are looked at.
const MOMENTS: usize = 400;
/// An object stands on a surface from which its lower end is no farther than this, metres.
const STANDS_M: f64 = 2e-3;

/// What may come near to something, or something to which it may come near.
struct Thing<'a> {
    body: &'a Body,
    world_from_body: Isometry3<f64>,
    /// The box around it in its own frame,
    middle: Point3<f64>,
    half: Vector3<f64>,
    /// and the ball around that, in the world; without end for what has none.
    centre: Point3<f64>,
    radius: f64,
}

impl<'a> Thing<'a> {
    fn new(body: &'a Body, world_from_body: Isometry3<f64>) -> Self {
        let (low, high) = body.local_aabb();
        let half = (high - low) / 2.0;
        let radius = half.norm();
        let middle = if radius.is_finite() { nalgebra::center(&low, &high) } else { Point3::origin() };
        Self { body, world_from_body, middle, half, centre: world_from_body * middle, radius }
    }

    /// No more than their distance.
    fn bound(&self, other: &Self) -> f64 {
        // The one body without end is the floor.
        match (self.radius.is_finite(), other.radius.is_finite()) {
            // A ball around a wall is mostly air, a box is not.
            (true, true) => self.box_to_ball(other).max(other.box_to_ball(self)),
            (true, false) => self.centre.z - self.radius,
            (false, _) => f64::NEG_INFINITY,
        }
    }

    fn box_to_ball(&self, other: &Self) -> f64 {
        let inside = self.world_from_body.inverse_transform_point(&other.centre) - self.middle;
        (inside.abs() - self.half).sup(&Vector3::zeros()).norm() - other.radius
    }
}

/// Two bodies by their place in the lists of movers and of others.
type Pair = (usize, usize);

/// Looks at moments of every step, more of those that have more waypoints.
pub(super) fn of_steps(acts: &[Act<'_>], robot: &RobotModel, geometry: &Geometry) -> Vec<Vec<ClearanceData>> {
    let waypoints: usize = acts.iter().map(|act| act.moments.len()).sum();
    let of_step = |act: &Act<'_>| {
        let share = (MOMENTS * act.moments.len()).div_ceil(waypoints.max(1)).clamp(2, 2 * MOMENTS);
        let last = act.moments.len().saturating_sub(1) as f64;
        let mut world_from_link = vec![Isometry3::identity(); robot.tree.link_count()];
        let mut nearest_before = None;
        let times = (0..share).map(|index| last * index as f64 / (share - 1) as f64);
        let nearest = times.filter_map(|at| {
            let moment = act.at(robot, at, &mut world_from_link)?;
            let scene = Scene::new(act, robot, geometry, &moment, &world_from_link);
            let (pair, clearance) = scene.nearest(nearest_before)?;
            nearest_before = Some(pair);
            Some(ClearanceData {
                at: data::to(at, 1e3),
                distance: data::to(clearance.distance, 1e5),
                bodies: scene.names(pair)?.map(ToString::to_string),
                points: [clearance.first, clearance.second].map(|point| [point.x, point.y, point.z].map(rounded)),
            })
        });
        nearest.collect()
    };
    acts.iter().map(of_step).collect()
}

/// One moment.
struct Scene<'a> {
    act: &'a Act<'a>,
    movers: Vec<Thing<'a>>,
    others: Vec<Thing<'a>>,
    /// The movers that stand on the floor as the base does, and how many of the movers are links.
    is_rigid: Vec<bool>,
    links: usize,
    /// Names of the bodies on which the pushed object slides.
    under: Vec<Arc<str>>,
}

impl<'a> Scene<'a> {
    fn new(
        act: &'a Act<'a>,
        robot: &'a RobotModel,
        geometry: &'a Geometry,
        moment: &Moment,
        world_from_link: &[Isometry3<f64>],
    ) -> Self {
        let solid = |(link, (body, pose)): (usize, (&'a Option<Body>, &Isometry3<f64>))| {
            Some((robot.is_rigid_to_root(link), Thing::new(body.as_ref()?, *pose)))
        };
        let links = robot.bodies.iter().zip(world_from_link).enumerate().filter_map(solid);
        let (is_rigid, mut movers): (Vec<_>, Vec<_>) = links.unzip();
        let links = movers.len();
        let moved = act.holds.map(|(object, _)| object).or(act.pushes);
        let fixed = geometry.scene.bodies().iter().map(|fixed| Thing::new(&fixed.body, fixed.world_from_body));
        let mut others: Vec<_> = fixed.collect();
        for (index, (object, pose)) in geometry.objects.iter().zip(&moment.objects).enumerate() {
            let thing = Thing::new(&object.body, *pose);
            if moved == Some(index) {
                movers.push(thing);
            } else {
                others.push(thing);
            }
        }
        // The hand may touch what it pushes only where the step says so.
        if let Some(pushed) = act.pushes
            && let (Some(object), Some(pose)) = (geometry.objects.get(pushed), moment.objects.get(pushed))
        {
            others.push(Thing::new(&object.body, *pose));
        }
        Self { act, movers, others, is_rigid, links, under: under(act, geometry, moment) }
    }

    fn names(&self, (mover, other): Pair) -> Option<[&'a Arc<str>; 2]> {
        Some([&self.movers.get(mover)?.body.name, &self.others.get(other)?.body.name])
    }

    /// May these two touch, or do they always?
    fn is_free(&self, (mover, other): Pair) -> bool {
        let Some([a, b]) = self.names((mover, other)) else { return true };
        let is_one = |pair: &crate::plan_file::AllowedContact| {
            (*pair.a == **a && *pair.b == **b) || (*pair.a == **b && *pair.b == **a)
        };
        if mover >= self.links {
            return a == b || self.under.contains(b) || self.act.step.allowed_contacts.iter().any(is_one);
        }
        let is_floor = self.others.get(other).is_some_and(|other| !other.radius.is_finite());
        (is_floor && self.is_rigid.get(mover) == Some(&true)) || self.act.step.allowed_contacts.iter().any(is_one)
    }

    /// The nearest two, those that were nearest a moment ago first: they mostly are still.
    fn nearest(&self, before: Option<Pair>) -> Option<(Pair, Clearance)> {
        let mut best: Option<(Pair, Clearance)> = None;
        if let Some(pair) = before {
            self.look(pair, &mut best);
        }
        // OPTIMIZATION: of many bodies in a large room few are nearer to any mover than that.
        let least = best.as_ref().map_or(f64::INFINITY, |(_, clearance)| clearance.distance);
        let (centre, radius) = self.around_movers();
        let is_near = |other: &usize| {
            let other = self.others.get(*other);
            other.is_some_and(|other| (other.centre - centre).norm() - other.radius - radius < least)
        };
        let near: Vec<_> = (0..self.others.len()).filter(is_near).collect();
        for mover in 0..self.movers.len() {
            for other in &near {
                self.look((mover, *other), &mut best);
            }
        }
        best
    }

    /// Keeps the pair if it is the nearest so far.
    fn look(&self, (mover, other): Pair, best: &mut Option<(Pair, Clearance)>) {
        let (Some(a), Some(b)) = (self.movers.get(mover), self.others.get(other)) else { return };
        let least = best.as_ref().map_or(f64::INFINITY, |(_, clearance)| clearance.distance);
        if a.bound(b) >= least || self.is_free((mover, other)) {
            return;
        }
        if let Ok(found) = between(a.body, &a.world_from_body, b.body, &b.world_from_body)
            && found.distance < least
        {
            *best = Some(((mover, other), found));
        }
    }

    /// A ball around all movers; without end where one of them has none.
    fn around_movers(&self) -> (Point3<f64>, f64) {
        let count = self.movers.len().max(1) as f64;
        let sum = self.movers.iter().fold(Vector3::zeros(), |sum, mover| sum + mover.centre.coords);
        let centre = Point3::from(sum / count);
        let reach = |mover: &Thing<'_>| (mover.centre - centre).norm() + mover.radius;
        (centre, self.movers.iter().map(reach).fold(0.0, f64::max))
    }
}

/// The bodies under the pushed object.
fn under(act: &Act<'_>, geometry: &Geometry, moment: &Moment) -> Vec<Arc<str>> {
    let Some((object, pose)) = act.pushes.and_then(|i| Some((geometry.objects.get(i)?, moment.objects.get(i)?))) else {
        return Vec::new();
    };
    let lower_end = pose.translation.z - object.depth_below_origin;
    let surfaces = geometry.scene.surfaces().iter().zip(&geometry.carriers);
    let near = surfaces.filter(|(surface, _)| (surface.height() - lower_end).abs() < STANDS_M);
    near.filter_map(|(_, carrier)| geometry.scene.bodies().get((*carrier)?))
        .map(|fixed| fixed.body.name.clone())
        .collect()
}
