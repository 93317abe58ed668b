//! parry's distance queries behind guards: no panic, no missing pair, a certified bound.

use crate::convert::{self, ParryShape};
use crate::shape::Shape;
use nalgebra::{Isometry3, Point3, Vector3};
use parry3d_f64::math::{Pose, Vector};
use parry3d_f64::query::details::closest_points_support_map_support_map;
use parry3d_f64::query::{ClosestPoints, DefaultQueryDispatcher, QueryDispatcher};
use parry3d_f64::shape::Segment;

/// Farther than any two solids can be apart, small enough that its square is finite.
const EVERYWHERE: f64 = 1e9;
/// Largest coordinate a pose may have here: beyond it squares lose the millimetres.
pub(crate) const FARTHEST: f64 = 1e6;
/// How much the nearest points on a mesh may be off, in metres: parry's iteration is not certified per triangle.
const MESH_SLACK: f64 = 2e-5;

/// A posed shape, ready for parry.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Posed<'a> {
    pub(crate) shape: &'a Shape,
    pub(crate) parry: &'a ParryShape,
    pub(crate) world_from_shape: Isometry3<f64>,
}

impl Posed<'_> {
    /// The pose of parry's frame.
    fn pose(&self) -> Pose {
        convert::pose(&self.world_from_shape) * self.parry.shape_from_parry
    }

    /// Least value of `direction . p` over the points of the shape (world).
    fn lowest(&self, direction: &Vector3<f64>) -> f64 {
        let local = self.world_from_shape.inverse_transform_vector(direction);
        direction.dot(&self.world_from_shape.translation.vector) - self.shape.support_extent(&-local)
    }

    /// A point with the least value of `direction . p` (world).
    fn lowest_point(&self, direction: &Vector3<f64>) -> Point3<f64> {
        let local = self.world_from_shape.inverse_transform_vector(direction);
        self.world_from_shape * self.shape.support_point(&-local)
    }
}

/// How far the shorter way of computing may be off, in metres. parry's iteration is off by micrometres on what is curved.
const LEVEL: f64 = 5e-6;

/// After so many steps the shorter way is given up.
const FEW_STEPS: usize = 4;

/// How two posed shapes lie to each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Gap {
    /// They touch or overlap, or it could not be found out that they do not.
    Closed,
    /// They are apart.
    Open {
        /// Distance between the two points.
        distance: f64,
        /// Never more than the true distance.
        lower: f64,
        /// Nearest point of the first (world).
        first: Point3<f64>,
        /// Nearest point of the second (world).
        second: Point3<f64>,
    },
}

/// Whether a pose is fit for the queries here: finite, within [`FARTHEST`], a unit quaternion to 1e-6.
pub(crate) fn is_sound(pose: &Isometry3<f64>) -> bool {
    let near = pose.translation.vector.iter().all(|x| x.abs() <= FARTHEST);
    near && (pose.rotation.as_ref().norm_squared() - 1.0).abs() < 2e-6
}

/// The gap between two posed shapes. Two half spaces always count as touching, and so does a pose that is not sound.
pub(crate) fn gap(a: &Posed<'_>, b: &Posed<'_>) -> Gap {
    if !is_sound(&a.world_from_shape) || !is_sound(&b.world_from_shape) {
        return Gap::Closed;
    }
    match (a.shape, b.shape) {
        (Shape::HalfSpace { .. }, Shape::HalfSpace { .. }) => Gap::Closed,
        (Shape::HalfSpace { normal }, _) => above_plane(a, normal, b),
        (_, Shape::HalfSpace { normal }) => swapped(above_plane(b, normal, a)),
        _ => bounded_gap(a, b),
    }
}

/// A shape over a half space, exactly.
fn above_plane(plane: &Posed<'_>, normal: &Vector3<f64>, other: &Posed<'_>) -> Gap {
    let normal = plane.world_from_shape * normal;
    let offset = normal.dot(&plane.world_from_shape.translation.vector);
    let distance = other.lowest(&normal) - offset;
    if distance <= 0.0 {
        return Gap::Closed;
    }
    let second = other.lowest_point(&normal);
    Gap::Open { distance, lower: distance, first: second - normal * distance, second }
}

fn swapped(gap: Gap) -> Gap {
    match gap {
        Gap::Closed => Gap::Closed,
        Gap::Open { distance, lower, first, second } => Gap::Open { distance, lower, first: second, second: first },
    }
}

/// The gap between a cylinder and a convex shape, if a few steps find nearest points that are certainly so.
///
/// OPTIMIZATION: parry's iteration needs some twenty rounds on what is curved. From the point that is nearest to the axis it is
/// mostly no way to the nearest points: the other shape lies beside the curved side, or over an end.
fn from_cylinder(cylinder: &Posed<'_>, other: &Posed<'_>) -> Option<Gap> {
    let Shape::Cylinder { radius, half_height } = *cylinder.shape else { return None };
    let map = other.parry.shape.as_support_map()?;
    let (pose, pose_other) = (cylinder.pose(), other.pose());
    let end = Vector::new(0.0, half_height, 0.0);
    let axis = Segment::new(-end, end);
    let own_from_other = pose.inv_mul(&pose_other);
    let points = closest_points_support_map_support_map(&own_from_other, &axis, map, EVERYWHERE);
    let ClosestPoints::WithinMargin(_, mut far) = points else { return None };
    for _ in 0..FEW_STEPS {
        let at = own_from_other * far;
        let away = at.x.hypot(at.z);
        let inwards = if away > radius { radius / away } else { 1.0 };
        let near = Vector::new(at.x * inwards, at.y.clamp(-half_height, half_height), at.z * inwards);
        let (first, second) = (convert::point_from(pose * near), convert::point_from(pose * at));
        let apart = second - first;
        let distance = apart.norm();
        // Written so that a NaN is refused.
        let is_apart = distance > LEVEL;
        if !is_apart {
            return None;
        }
        let lower = certified(cylinder, other, &(apart / distance), distance);
        if distance - lower <= LEVEL {
            return Some(Gap::Open { distance, lower, first, second });
        }
        far = other.parry.shape.project_local_point(own_from_other.inverse_transform_point(near), true).point;
    }
    None
}

/// Two shapes of which neither is a half space.
fn bounded_gap(a: &Posed<'_>, b: &Posed<'_>) -> Gap {
    if let Some(gap) = from_cylinder(a, b).or_else(|| from_cylinder(b, a).map(swapped)) {
        return gap;
    }
    let (pose_a, pose_b) = (a.pose(), b.pose());
    let relative = pose_a.inv_mul(&pose_b);
    let (shape_a, shape_b) = (&*a.parry.shape, &*b.parry.shape);
    let ball = shape_a.as_ball().is_some() || shape_b.as_ball().is_some();
    let hull = shape_a.as_convex_polyhedron().is_some() || shape_b.as_convex_polyhedron().is_some();
    // parry projects a ball's centre on the other shape, which is exact, but for hulls it asserts that an iteration
    // converges; the general iteration reports it instead.
    let points = match (shape_a.as_support_map(), shape_b.as_support_map()) {
        (Some(map_a), Some(map_b)) if hull || !ball => {
            closest_points_support_map_support_map(&relative, map_a, map_b, EVERYWHERE)
        }
        _ => DefaultQueryDispatcher
            .closest_points(&relative, shape_a, shape_b, EVERYWHERE)
            .unwrap_or(ClosestPoints::Intersecting),
    };
    let ClosestPoints::WithinMargin(first, second) = points else { return Gap::Closed };
    let (first, second) = (convert::point_from(pose_a * first), convert::point_from(pose_b * second));
    let apart = second - first;
    let distance = apart.norm();
    // A NaN counts as closed.
    if distance.is_nan() || distance <= 0.0 {
        return Gap::Closed;
    }
    let lower = certified(a, b, &(apart / distance), distance);
    if matches!(a.shape, Shape::Mesh(_)) || matches!(b.shape, Shape::Mesh(_)) {
        // The nearest points on a mesh with slivers may be far from the nearest; another of parry's walks over the
        // triangles finds others (found by fuzzing).
        return match parry3d_f64::query::distance(&pose_a, shape_a, &pose_b, shape_b) {
            Ok(other) if other.distance <= 0.0 || encloses(a, b) || encloses(b, a) => Gap::Closed,
            Ok(other) => {
                let distance = distance.min(other.distance);
                Gap::Open { distance, lower: lower.min(distance), first, second }
            }
            Err(_) => Gap::Closed,
        };
    }
    Gap::Open { distance, lower, first, second }
}

/// Is something of `other`, which does not touch the surface of the mesh, in its solid?
fn encloses(mesh: &Posed<'_>, other: &Posed<'_>) -> bool {
    let Shape::Mesh(triangles) = mesh.shape else { return false };
    let mesh_from_other = mesh.world_from_shape.inv_mul(&other.world_from_shape);
    let is_within = |p: &Point3<f64>| triangles.contains(&(mesh_from_other * p));
    match other.shape {
        Shape::Mesh(others) => others.points_of_pieces().iter().any(is_within),
        convex => is_within(&convex.support_point(&Vector3::x())),
    }
}

/// A lower bound of the distance: the gap along `direction` (unit, from a to b), exact when the direction is that of the
/// nearest points of two convex shapes.
fn certified(a: &Posed<'_>, b: &Posed<'_>, direction: &Vector3<f64>, distance: f64) -> f64 {
    let mesh = matches!(a.shape, Shape::Mesh(_)) || matches!(b.shape, Shape::Mesh(_));
    let lower = if mesh { distance - MESH_SLACK } else { b.lowest(direction) + a.lowest(&-direction) };
    lower.min(distance).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn distance(a: &Shape, world_from_a: Isometry3<f64>, b: &Shape, world_from_b: Isometry3<f64>) -> Gap {
        let (parry_a, parry_b) = (convert::shape(a), convert::shape(b));
        let first = Posed { shape: a, parry: &parry_a, world_from_shape: world_from_a };
        gap(&first, &Posed { shape: b, parry: &parry_b, world_from_shape: world_from_b })
    }

    #[test]
    fn known_distances() {
        let cube = Shape::cuboid(Vector3::repeat(0.5)).unwrap();
        let can = Shape::cylinder(0.5, 1.0).unwrap();
        let ball = Shape::sphere(0.5).unwrap();
        let floor = Shape::half_space(Vector3::z_axis()).unwrap();
        let corners: Vec<_> = (0..8)
            .map(|i| Point3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2)) - Vector3::repeat(0.5))
            .collect();
        let hull = Shape::convex_hull("cube", &corners).unwrap();
        let at = Isometry3::translation;
        let here = Isometry3::identity();
        let cases = [
            (&cube, at(2.0, 2.0, 0.0), &cube, here, 2.0_f64.sqrt()),
            (&can, at(0.0, 0.0, 2.0), &cube, here, 0.5),
            (&can, at(3.0, 0.0, 0.5), &ball, here, 2.0),
            (&hull, at(3.0, 0.0, 0.0), &ball, here, 2.0),
            (&floor, here, &hull, at(0.0, 0.0, 2.0), 1.5),
            (&can, at(0.0, 0.0, 2.0), &floor, here, 1.0),
        ];
        for (a, pose_a, b, pose_b, expected) in cases {
            let Gap::Open { distance: found, lower, first, second } = distance(a, pose_a, b, pose_b) else {
                panic!("{} {}", a.kind(), b.kind())
            };
            assert!((found - expected).abs() < 1e-6 && lower <= expected + 1e-9 && lower > expected - 1e-5);
            assert!(((first - second).norm() - expected).abs() < 1e-6);
        }
        assert_eq!(distance(&cube, at(0.9, 0.0, 0.0), &can, here), Gap::Closed);
        assert_eq!(distance(&floor, here, &floor, at(0.0, 0.0, -9.0)), Gap::Closed);
    }

    proptest! {
        #[test]
        fn near_a_cylinder_it_is_as_parry_says(
            at in prop::array::uniform3(-0.4_f64..0.4), turn in prop::array::uniform3(-3.0_f64..3.0), upright in any::<bool>(),
        ) {
            let can = Shape::cylinder(0.14, 0.03).unwrap();
            let others = [Shape::cuboid(Vector3::new(0.02, 0.01, 0.05)).unwrap(), Shape::capsule(0.02, 0.1).unwrap()];
            let turn = if upright { Vector3::new(0.0, 0.0, turn[2]) } else { Vector3::from(turn) };
            let pose = Isometry3::new(Vector3::from(at), turn);
            for other in others {
                let (parry_can, parry_other) = (convert::shape(&can), convert::shape(&other));
                let first = Posed { shape: &can, parry: &parry_can, world_from_shape: Isometry3::translation(0.1, 0.0, 0.0) };
                let second = Posed { shape: &other, parry: &parry_other, world_from_shape: pose };
                let expected = parry3d_f64::query::distance(
                    &first.pose(), &*first.parry.shape, &second.pose(), &*second.parry.shape,
                ).unwrap().distance;
                match from_cylinder(&first, &second) {
                    Some(Gap::Open { distance, lower, first: near, second: far }) => {
                        // parry may be off by micrometres here; the points below are in the shapes, so ours are nearer.
                        prop_assert!(distance <= expected + LEVEL && lower <= expected + 1e-9, "{distance} {expected}");
                        prop_assert!((near - far).norm() - distance < 1e-12 && distance - lower <= LEVEL);
                        for (posed, point) in [(&first, near), (&second, far)] {
                            let off = posed.parry.shape.distance_to_point(&posed.pose(), convert::vector(&point.coords), true);
                            prop_assert!(off < 1e-9, "{off}");
                        }
                    }
                    Some(Gap::Closed) => prop_assert!(false, "it says only what it is sure of"),
                    // A box beside it, and standing upright, is what it is for.
                    None => prop_assert!(!upright || !matches!(other, Shape::Cuboid { .. }) || expected < 1e-6 || at[2].abs() > 0.05, "{expected}"),
                }
            }
        }
    }

    #[test]
    fn unsound_poses_count_as_touching() {
        let cube = Shape::cuboid(Vector3::repeat(0.5)).unwrap();
        for bad in [f64::NAN, f64::INFINITY, 1e300] {
            assert_eq!(
                distance(&cube, Isometry3::translation(bad, 0.0, 0.0), &cube, Isometry3::identity()),
                Gap::Closed
            );
        }
    }
}
