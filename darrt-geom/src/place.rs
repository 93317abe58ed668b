//! A point to show when two solids touch or overlap.

use crate::shape::Shape;
use nalgebra::{Isometry3, Point3, Vector2};

/// Rounds of projecting to and fro.
const ROUNDS: usize = 24;
/// A round that moves the point less than this, in metres, is the last.
const SETTLED: f64 = 1e-4;

/// A point common to two posed solids, or midway between their nearest points; hulls and meshes count as their boxes.
///
/// # Source
/// Projecting alternately on two convex sets converges to a common point, or to a nearest pair when there is none
/// (Cheney and Goldstein, "Proximity maps for convex sets", 1959). A few rounds are enough for a picture.
pub(crate) fn shared(
    first: &Shape,
    world_from_first: &Isometry3<f64>,
    second: &Shape,
    world_from_second: &Isometry3<f64>,
) -> Point3<f64> {
    let onto = |shape: &Shape, pose: &Isometry3<f64>, p: &Point3<f64>| {
        pose * nearest_in(shape, &pose.inverse_transform_point(p))
    };
    let (shape, pose) = if first.is_bounded() { (first, world_from_first) } else { (second, world_from_second) };
    let mut on_second = pose * shape.bounding_sphere().0;
    let mut on_first = on_second;
    for _ in 0..ROUNDS {
        let before = on_second;
        on_first = onto(first, world_from_first, &on_second);
        on_second = onto(second, world_from_second, &on_first);
        if nalgebra::distance_squared(&before, &on_second) < SETTLED * SETTLED {
            break;
        }
    }
    nalgebra::center(&on_first, &on_second)
}

/// The point of the solid nearest to `p`, own frame; `p` itself when it is inside. Hulls and meshes count as their boxes.
fn nearest_in(shape: &Shape, p: &Point3<f64>) -> Point3<f64> {
    match shape {
        Shape::Cuboid { .. } | Shape::ConvexHull(_) | Shape::Mesh(_) => {
            let (low, high) = shape.local_aabb();
            p.sup(&low).inf(&high)
        }
        Shape::Sphere { radius } => Point3::from(p.coords.cap_magnitude(*radius)),
        Shape::Cylinder { radius, half_height } => {
            let flat = Vector2::new(p.x, p.y).cap_magnitude(*radius);
            Point3::new(flat.x, flat.y, p.z.clamp(-half_height, *half_height))
        }
        Shape::Capsule { radius, half_height } => {
            let spine = Point3::new(0.0, 0.0, p.z.clamp(-half_height, *half_height));
            spine + (p - spine).cap_magnitude(*radius)
        }
        Shape::HalfSpace { normal } => p - normal.as_ref() * normal.dot(&p.coords).max(0.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;

    #[test]
    fn the_place_lies_in_both_or_between() {
        let shapes = [
            Shape::cuboid(Vector3::new(0.5, 0.5, 0.5)).unwrap(),
            Shape::sphere(0.5).unwrap(),
            Shape::cylinder(0.5, 0.5).unwrap(),
            Shape::capsule(0.25, 0.25).unwrap(),
        ];
        let floor = Shape::half_space(Vector3::z_axis()).unwrap();
        for shape in &shapes {
            let overlapping = Isometry3::translation(0.8, 0.0, 0.0);
            for other in &shapes {
                let place = shared(shape, &overlapping, other, &Isometry3::identity());
                let inner = place - nearest_in(other, &place);
                assert!(inner.norm() < 0.4, "{} {}", shape.kind(), other.kind());
                assert!((0.0..=0.8).contains(&place.x) && place.y.abs() < 1e-9);
            }
            let above = Isometry3::translation(3.0, 0.0, 0.7);
            let place = shared(&floor, &Isometry3::identity(), shape, &above);
            assert!((place.z - 0.1).abs() < 1e-9 && (place.x - 3.0).abs() < 0.6);
        }
    }
}
