//! The slow, obvious judge: every part of every body against every part of every other, through parry.
//!
//! It shares nothing with [`crate::collide`] but the shapes themselves, so that tests can hold the fast checker against it and a
//! plan can be judged by code that did not make it.

mod enclosed;

use crate::body::{Body, Part};
use crate::check;
use crate::convert::{self, ParryShape};
use crate::error::GeomError;
use crate::place;
use crate::shape::Shape;
use nalgebra::{Isometry3, Point3, Vector3};
use parry3d_f64::math::Pose;
use parry3d_f64::query::details::closest_points_support_map_support_map;
use parry3d_f64::query::{ClosestPoints, closest_points, distance, intersection_test};

/// How much the nearest points on a mesh may be off, metres: parry's iteration is not certified per triangle.
const MESH_SLACK: f64 = 2e-5;

/// A body at a pose in the world.
#[derive(Debug, Clone, Copy)]
pub struct PosedBody<'a> {
    /// The body.
    pub body: &'a Body,
    /// Its pose.
    pub world_from_body: Isometry3<f64>,
}

/// What the judge found about a pair of bodies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Finding {
    /// Index of the first body (the smaller one) in the list given.
    pub first: usize,
    /// Index of the second body.
    pub second: usize,
    /// The parts concerned, of the first and of the second body.
    pub parts: (usize, usize),
    /// Distance in metres between the two parts; 0 when they intersect.
    pub distance: f64,
    /// Never more than the true distance of the two parts, metres: what a bound on motions may rely on.
    pub lower: f64,
    /// The unit direction from the first to the second part (world) across which `lower` was measured; zero if it was
    /// measured otherwise.
    pub across: Vector3<f64>,
    /// Whether the parts touch or overlap.
    pub intersects: bool,
    /// A point in both or between them (world); hulls and meshes count as their boxes here.
    pub place: Point3<f64>,
}

/// Every pair of bodies that touch or overlap, except those `skip` says to leave out (asked with the smaller index first).
///
/// Of a pair of bodies the first intersecting parts are told. Two half spaces touch unless they face away
/// from each other.
///
/// # Errors
/// When a body or a pose is unfit, see [`Body::check`].
pub fn intersections(bodies: &[PosedBody<'_>], skip: &dyn Fn(usize, usize) -> bool) -> Result<Vec<Finding>, GeomError> {
    let mut found = Vec::new();
    each_pair(bodies, skip, &mut |pair| {
        let hit = each_parts(pair).find(|(_, a, b)| intersect(a, b) || is_inside(a, b));
        found.extend(hit.map(|(parts, a, b)| finding(pair, parts, &a, &b, Apart::NONE, true)));
    })?;
    Ok(found)
}

/// The nearest parts of any pair of bodies, except those `skip` says to leave out (asked with the smaller index first); `None`
/// when no pair is left. Ties go to the earlier pair.
///
/// # Errors
/// When a body or a pose is unfit, see [`Body::check`].
pub fn nearest(bodies: &[PosedBody<'_>], skip: &dyn Fn(usize, usize) -> bool) -> Result<Option<Finding>, GeomError> {
    let mut best: Option<Finding> = None;
    each_pair(bodies, skip, &mut |pair| {
        for (parts, a, b) in each_parts(pair) {
            let mut apart = separation(&a, &b);
            // A plane between the two proves that they do not touch.
            let intersects = !apart.is_proved() && (apart.distance <= 0.0 || intersect(&a, &b));
            if intersects {
                apart = Apart::NONE;
            }
            if best.is_none_or(|b| apart.distance < b.distance || (intersects && !b.intersects)) {
                best = Some(finding(pair, parts, &a, &b, apart, intersects));
            }
        }
    })?;
    Ok(best)
}

/// Two bodies with their indices.
#[derive(Clone, Copy)]
struct Pair<'a> {
    indices: (usize, usize),
    first: PosedBody<'a>,
    second: PosedBody<'a>,
}

/// A part in the world, for us and for parry.
struct Placed<'a> {
    shape: &'a Shape,
    world_from_shape: Isometry3<f64>,
    parry: ParryShape,
    pose: Pose,
}

impl<'a> Placed<'a> {
    fn new(part: &'a Part, world_from_body: &Isometry3<f64>) -> Self {
        let world_from_shape = world_from_body * part.body_from_shape;
        let parry = convert::shape(&part.shape);
        let pose = convert::pose(&world_from_shape) * parry.shape_from_parry;
        Self { shape: &part.shape, world_from_shape, parry, pose }
    }
}

/// Checks the bodies and visits the pairs that are not skipped.
fn each_pair<'a>(
    bodies: &[PosedBody<'a>],
    skip: &dyn Fn(usize, usize) -> bool,
    visit: &mut dyn FnMut(Pair<'a>),
) -> Result<(), GeomError> {
    for posed in bodies {
        posed.body.check()?;
        check::pose(format_args!("pose of `{}`", posed.body.name), &posed.world_from_body)?;
    }
    for (i, first) in bodies.iter().enumerate() {
        for (j, second) in bodies.iter().enumerate().skip(i + 1) {
            if !skip(i, j) {
                visit(Pair { indices: (i, j), first: *first, second: *second });
            }
        }
    }
    Ok(())
}

/// Every part of the first body with every part of the second, and their numbers.
fn each_parts(pair: Pair<'_>) -> impl Iterator<Item = ((usize, usize), Placed<'_>, Placed<'_>)> {
    let Pair { first, second, .. } = pair;
    first.body.parts.iter().enumerate().flat_map(move |(i, a)| {
        second.body.parts.iter().enumerate().map(move |(j, b)| {
            ((i, j), Placed::new(a, &first.world_from_body), Placed::new(b, &second.world_from_body))
        })
    })
}

fn finding(
    pair: Pair<'_>,
    parts: (usize, usize),
    a: &Placed<'_>,
    b: &Placed<'_>,
    apart: Apart,
    intersects: bool,
) -> Finding {
    let place = place::shared(a.shape, &a.world_from_shape, b.shape, &b.world_from_shape);
    let Apart { distance, lower, across } = apart;
    Finding { first: pair.indices.0, second: pair.indices.1, parts, distance, lower, across, intersects, place }
}

/// Whether one of two parts is inside a mesh that the other is.
fn is_inside(a: &Placed<'_>, b: &Placed<'_>) -> bool {
    enclosed::is_in(a, b) || enclosed::is_in(b, a)
}

/// Whether the surfaces of two parts meet, or solids overlap.
fn intersect(a: &Placed<'_>, b: &Placed<'_>) -> bool {
    match (a.shape, b.shape) {
        (Shape::HalfSpace { .. }, Shape::HalfSpace { .. } | Shape::Mesh(_))
        | (Shape::Mesh(_), Shape::HalfSpace { .. }) => separation(a, b).distance <= 0.0,
        (Shape::Sphere { .. }, Shape::ConvexHull(_)) | (Shape::ConvexHull(_), Shape::Sphere { .. }) => {
            convex(a, b).distance <= 0.0
        }
        _ => intersection_test(&a.pose, &*a.parry.shape, &b.pose, &*b.parry.shape)
            .map_or(true, |answer| answer.intersecting),
    }
}

/// How far two parts are apart.
#[derive(Debug, Clone, Copy)]
struct Apart {
    distance: f64,
    /// See [`Finding::lower`].
    lower: f64,
    /// See [`Finding::across`].
    across: Vector3<f64>,
}

impl Apart {
    /// They touch or overlap.
    const NONE: Self = Self { distance: 0.0, lower: 0.0, across: Vector3::new(0.0, 0.0, 0.0) };

    fn exactly(distance: f64) -> Self {
        Self { distance, lower: distance, ..Self::NONE }
    }

    /// Is there a plane between the two?
    fn is_proved(&self) -> bool {
        self.lower > 0.0 && self.across != Vector3::zeros()
    }
}

/// Distance of two parts, 0 when they touch or overlap.
fn separation(a: &Placed<'_>, b: &Placed<'_>) -> Apart {
    match (a.shape, b.shape) {
        (Shape::HalfSpace { .. }, Shape::HalfSpace { .. }) => Apart::exactly(facing_away(a, b)),
        (Shape::HalfSpace { .. }, Shape::Mesh(_)) => Apart::exactly(over_plane(a, b)),
        (Shape::Mesh(_), Shape::HalfSpace { .. }) => Apart::exactly(over_plane(b, a)),
        (Shape::HalfSpace { .. }, _) | (_, Shape::HalfSpace { .. }) => Apart::exactly(measured(a, b)),
        (Shape::Mesh(_), _) | (_, Shape::Mesh(_)) => {
            // Each of parry's walks over the triangles misses the nearest now and then.
            let margin = 1e9;
            let other = match closest_points(&a.pose, &*a.parry.shape, &b.pose, &*b.parry.shape, margin) {
                Ok(ClosestPoints::WithinMargin(p, q)) => (p - q).length(),
                _ => 0.0,
            };
            let distance = measured(a, b).min(other);
            if distance <= 0.0 || is_inside(a, b) {
                return Apart::NONE;
            }
            Apart { distance, lower: (distance - MESH_SLACK).max(0.0), ..Apart::NONE }
        }
        _ => convex(a, b),
    }
}

/// What parry says; 0 when it cannot say.
fn measured(a: &Placed<'_>, b: &Placed<'_>) -> f64 {
    distance(&a.pose, &*a.parry.shape, &b.pose, &*b.parry.shape).map_or(0.0, |answer| answer.distance)
}

/// Two convex solids by the general iteration. Parry's own choice for two boxes takes the corners of one face for the
/// nearest points and so is centimetres off at times; that for a ball and a hull asserts that an iteration converges.
fn convex(a: &Placed<'_>, b: &Placed<'_>) -> Apart {
    let (Some(map_a), Some(map_b)) = (a.parry.shape.as_support_map(), b.parry.shape.as_support_map()) else {
        return Apart::NONE;
    };
    let relative = a.pose.inv_mul(&b.pose);
    let ClosestPoints::WithinMargin(p, q) = closest_points_support_map_support_map(&relative, map_a, map_b, 1e9) else {
        return Apart::NONE;
    };
    let (p, q) = (convert::point_from(a.pose * p), convert::point_from(b.pose * q));
    let distance = (q - p).norm();
    if distance.is_nan() || distance <= 0.0 {
        return Apart::NONE;
    }
    // Any plane between the two gives a lower bound, and the one across the nearest points the distance itself.
    let across = (q - p) / distance;
    let extent = |part: &Placed<'_>, direction: &Vector3<f64>| {
        let local = part.world_from_shape.inverse_transform_vector(direction);
        direction.dot(&part.world_from_shape.translation.vector) + part.shape.support_extent(&local)
    };
    let lower = -extent(b, &-across) - extent(a, &across);
    Apart { distance, lower: lower.clamp(0.0, distance), across }
}

/// Gap between two half spaces: positive only when they face away from each other.
fn facing_away(a: &Placed<'_>, b: &Placed<'_>) -> f64 {
    let (Shape::HalfSpace { normal: n }, Shape::HalfSpace { normal: m }) = (a.shape, b.shape) else { return 0.0 };
    let (n, m) = (a.world_from_shape * n, b.world_from_shape * m);
    if (n.as_ref() + m.as_ref()).norm() > 1e-12 {
        return 0.0;
    }
    let apart = b.world_from_shape.translation.vector - a.world_from_shape.translation.vector;
    n.dot(&apart).max(0.0)
}

/// Height of a mesh over a half space: that of its lowest vertex.
fn over_plane(plane: &Placed<'_>, mesh: &Placed<'_>) -> f64 {
    let (Shape::HalfSpace { normal }, Shape::Mesh(mesh_shape)) = (plane.shape, mesh.shape) else { return 0.0 };
    let height = |p: &Point3<f64>| {
        normal.dot(&plane.world_from_shape.inverse_transform_point(&(mesh.world_from_shape * p)).coords)
    };
    mesh_shape.vertices().iter().map(height).fold(f64::INFINITY, f64::min).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Translation3, UnitQuaternion};
    use rand::{RngExt as _, SeedableRng as _};

    type Corners = Vec<Point3<f64>>;
    type Edges = Vec<(Point3<f64>, Point3<f64>)>;

    /// Corners and edges of a box in the world.
    fn skeleton(half: &Vector3<f64>, pose: &Isometry3<f64>) -> (Corners, Edges) {
        let sign = |bit: usize| if bit == 0 { -1.0 } else { 1.0 };
        let corner = |i: usize| {
            pose * Point3::from(half.component_mul(&Vector3::new(sign(i & 1), sign(i >> 1 & 1), sign(i >> 2 & 1))))
        };
        let pairs =
            (0..8_usize).flat_map(|i| (i + 1..8).filter(move |j| (i ^ j).is_power_of_two()).map(move |j| (i, j)));
        ((0..8).map(corner).collect(), pairs.map(|(i, j)| (corner(i), corner(j))).collect())
    }

    /// Distance of two boxes that are apart, from all corners and all pairs of edges.
    fn brute_force(a: (&Vector3<f64>, &Isometry3<f64>), b: (&Vector3<f64>, &Isometry3<f64>)) -> f64 {
        let to_box = |(half, pose): (&Vector3<f64>, &Isometry3<f64>), p: &Point3<f64>| {
            let p = pose.inverse_transform_point(p).coords;
            (p.abs() - half).sup(&Vector3::zeros()).norm()
        };
        let ((corners_a, edges_a), (corners_b, edges_b)) = (skeleton(a.0, a.1), skeleton(b.0, b.1));
        let corners = corners_a.iter().map(|p| to_box(b, p)).chain(corners_b.iter().map(|p| to_box(a, p)));
        let edges = edges_a.iter().flat_map(|p| {
            edges_b.iter().map(move |q| {
                let (u, v, w) = (p.1 - p.0, q.1 - q.0, p.0 - q.0);
                let (uu, uv, vv) = (u.dot(&u), u.dot(&v), v.dot(&v));
                let flat = uu * vv - uv * uv;
                if flat <= 1e-12 {
                    return f64::INFINITY;
                }
                let (uw, vw) = (u.dot(&w), v.dot(&w));
                let (s, t) = ((uv * vw - vv * uw) / flat, (uu * vw - uv * uw) / flat);
                let inside = (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t);
                if inside { (w + u * s - v * t).norm() } else { f64::INFINITY }
            })
        });
        corners.chain(edges).fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn boxes_are_as_far_apart_as_their_corners_and_edges() {
        let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(11);
        let mut apart = 0;
        for _ in 0..4000 {
            let mut vector = |low: f64, high: f64| Vector3::from_fn(|_, _| rng.random_range(low..high));
            let (half_a, half_b) = (vector(0.02, 0.3), vector(0.02, 0.3));
            let (at, turn) = (vector(-0.7, 0.7), vector(-3.0, 3.0));
            let pose_a = Isometry3::translation(0.3, -0.2, 0.9);
            let pose_b = pose_a * Isometry3::from_parts(Translation3::from(at), UnitQuaternion::from_scaled_axis(turn));
            let body = |half| Body::single("box", Shape::cuboid(half).unwrap()).unwrap();
            let (a, b) = (body(half_a), body(half_b));
            let bodies =
                [(&a, pose_a), (&b, pose_b)].map(|(body, world_from_body)| PosedBody { body, world_from_body });
            let found = nearest(&bodies, &|_, _| false).unwrap().unwrap();
            if found.intersects {
                continue;
            }
            let expected = brute_force((&half_a, &pose_a), (&half_b, &pose_b));
            assert!((found.distance - expected).abs() < 1e-6, "{found:?}, by force {expected}");
            assert!(found.lower <= expected + 1e-9 && found.lower > expected - 1e-5, "{found:?}, by force {expected}");
            apart += 1;
        }
        assert!(apart > 1000);
    }

    #[test]
    fn overlaps_are_found_and_skipped_pairs_are_not() {
        let ball = Body::single("ball", Shape::sphere(0.5).unwrap()).unwrap();
        let floor = Body::single("floor", Shape::half_space(Vector3::z_axis()).unwrap()).unwrap();
        let at = |body, x, z| PosedBody { body, world_from_body: Isometry3::translation(x, 0.0, z) };
        let bodies = [at(&floor, 0.0, 0.0), at(&ball, 0.0, 0.25), at(&ball, 0.75, 1.0), at(&ball, 5.0, 1.0)];
        let all = intersections(&bodies, &|_, _| false).unwrap();
        let pairs: Vec<_> = all.iter().map(|f| (f.first, f.second)).collect();
        assert_eq!(pairs, [(0, 1)]);
        let near = nearest(&bodies, &|i, j| (i, j) == (0, 1)).unwrap().unwrap();
        assert_eq!((near.first, near.second, near.intersects), (1, 2, false));
        assert!((near.distance - (2.0 * 0.75_f64.powi(2)).sqrt() + 1.0).abs() < 1e-9);
        assert_eq!(nearest(&bodies, &|_, _| true).unwrap(), None);
        assert!(nearest(&[at(&ball, f64::NAN, 0.0)], &|_, _| false).is_err());
    }

    #[test]
    fn half_spaces_and_meshes() {
        let floor = Body::single("floor", Shape::half_space(Vector3::z_axis()).unwrap()).unwrap();
        let roof = Body::single("roof", Shape::half_space(-Vector3::z_axis()).unwrap()).unwrap();
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.5], [0.0, 1.0, 0.5]].map(Point3::from);
        let mesh = crate::TriangleMesh::new("t", &corners, &[[0, 1, 2]]).unwrap();
        let mesh = Body::single("mesh", Shape::Mesh(mesh.into())).unwrap();
        let at = |body, z| PosedBody { body, world_from_body: Isometry3::translation(0.0, 0.0, z) };
        let gap = |a, b| nearest(&[a, b], &|_, _| false).unwrap().unwrap();
        assert!((gap(at(&floor, 0.0), at(&roof, 2.0)).distance - 2.0).abs() < 1e-12);
        assert!(gap(at(&floor, 0.0), at(&floor, 2.0)).intersects);
        assert!((gap(at(&mesh, 0.5), at(&floor, 0.0)).distance - 0.5).abs() < 1e-12);
        assert!(gap(at(&floor, 0.0), at(&mesh, -0.5)).intersects);
    }
}
