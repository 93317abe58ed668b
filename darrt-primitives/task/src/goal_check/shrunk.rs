//! What a body covers wherever it is, if it may be off by a little: what is met by that is met by the body in every place that
//! its goal allows.

use std::sync::Arc;

use darrt_geom::{Body, ConvexHull, Shape};
use nalgebra::Point3;

/// A part that is thinner than this after it was made smaller is left out, metres.
const THINNEST_M: f64 = 1e-4;
/// Triangles of a hull that are smaller than this say nothing of its width, square metres.
const SLIVER_M2: f64 = 1e-14;

/// The body made smaller by so much to the sides and up and down, as far as its parts can be; of a part that may be turned about the
/// vertical by any angle, the round core. `None` if nothing is left.
pub(super) fn shrunk(body: &Body, by_m: [f64; 2], is_turned: bool) -> Option<Body> {
    let parts = body.parts.iter().filter_map(|part| {
        let shape = of_shape(&part.shape, by_m, is_turned)?;
        // A part beside the axis goes around it.
        let is_on_axis =
            part.body_from_shape.translation.vector.xy().norm() == 0.0 && part.body_from_shape.rotation.angle() == 0.0;
        (is_on_axis || !is_turned).then(|| darrt_geom::Part { shape, ..part.clone() })
    });
    let parts: Vec<_> = parts.collect();
    Body::new(Arc::clone(&body.name), parts).ok()
}

fn of_shape(shape: &Shape, [aside_m, up_m]: [f64; 2], is_turned: bool) -> Option<Shape> {
    let less_by = |length: f64, by_m: f64| Some(length - by_m).filter(|rest| *rest >= THINNEST_M);
    let less = |length: f64| less_by(length, aside_m);
    let less_up = |length: f64| less_by(length, up_m);
    let any_m = aside_m.hypot(up_m);
    match shape {
        Shape::Cuboid { half_extents: half, .. } if is_turned => {
            Shape::cylinder(less(half.x.min(half.y))?, less_up(half.z)?).ok()
        }
        Shape::Cuboid { half_extents: half, .. } => {
            let [x, y, z] = [less(half.x)?, less(half.y)?, less_up(half.z)?];
            Shape::cuboid(nalgebra::Vector3::new(x, y, z)).ok()
        }
        Shape::Sphere { radius, .. } => Shape::sphere(less_by(*radius, any_m)?).ok(),
        Shape::Cylinder { radius, half_height, .. } => Shape::cylinder(less(*radius)?, less_up(*half_height)?).ok(),
        Shape::Capsule { radius, half_height, .. } => Shape::capsule(less_by(*radius, any_m)?, *half_height).ok(),
        Shape::ConvexHull(hull) if !is_turned => of_hull(hull, any_m),
        _ => None,
    }
}

/// Towards its middle: what is scaled by s is in the hull with all that is nearer than 1 - s times the width of the hull around the
/// middle.
fn of_hull(hull: &ConvexHull, by_m: f64) -> Option<Shape> {
    let corners = hull.vertices();
    let middle = Point3::from(corners.iter().map(|p| p.coords).sum::<nalgebra::Vector3<f64>>() / corners.len() as f64);
    let corner = |index: u32| corners.get(index as usize);
    let width_m = hull.triangles().iter().filter_map(|[a, b, c]| {
        let (a, b, c) = (corner(*a)?, corner(*b)?, corner(*c)?);
        let normal = (b - a).cross(&(c - a));
        (normal.norm() > SLIVER_M2).then(|| (normal.dot(&(middle - a)) / normal.norm()).abs())
    });
    let width_m = width_m.fold(f64::INFINITY, f64::min);
    let scale = 1.0 - by_m / width_m;
    if !scale.is_finite() || scale * width_m < THINNEST_M {
        return None;
    }
    let points: Vec<_> = corners.iter().map(|p| middle + (p - middle) * scale).collect();
    Shape::convex_hull("the middle of a hull", &points).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use darrt_geom::clearance::between;
    use nalgebra::{Isometry3, UnitQuaternion, Vector3};

    /// Wherever a body is within the allowance, it holds what is left of it.
    #[test]
    fn what_is_left_is_covered_everywhere() {
        let corners: Vec<_> =
            (0..8).map(|i| Point3::new([0.1, -0.1][i & 1], [0.05, -0.05][i >> 1 & 1], [0.03, -0.02][i >> 2])).collect();
        let shapes = [
            Shape::cuboid(Vector3::new(0.1, 0.05, 0.03)).unwrap(),
            Shape::cylinder(0.05, 0.03).unwrap(),
            Shape::sphere(0.05).unwrap(),
            Shape::capsule(0.04, 0.03).unwrap(),
            Shape::convex_hull("hull", &corners).unwrap(),
        ];
        let by_m = 0.01;
        for (shape, is_turned) in shapes.iter().flat_map(|shape| [(shape, false), (shape, true)]) {
            let body = Body::single("body", shape.clone()).unwrap();
            let Some(less) = shrunk(&body, [by_m, 0.002], is_turned) else {
                assert!(is_turned, "{}", shape.kind());
                continue;
            };
            let (low, high) = less.local_aabb();
            // A point on the surface of what is left must be in the body at every place.
            for i in 0..26_u32 {
                let side = |k: u32| [-1.0, 0.0, 1.0][((i + i / 13) / 3_u32.pow(k) % 3) as usize];
                let way = Vector3::new(side(0), side(1), side(2));
                if way == Vector3::zeros() {
                    continue;
                }
                let point = less.parts[0].shape.support_point(&way);
                let dot = Body::single("dot", Shape::sphere(1e-6).unwrap()).unwrap();
                for j in 0..8_u8 {
                    let angle = f64::from(j) * 0.785;
                    let off =
                        Vector3::new(by_m * angle.cos(), by_m * angle.sin(), [0.002, -0.002][j as usize % 2]) * 0.999;
                    let yaw = if is_turned { angle } else { 0.0 };
                    let pose = Isometry3::from_parts(off.into(), UnitQuaternion::from_euler_angles(0.0, 0.0, yaw));
                    let gap = between(&body, &pose, &dot, &Isometry3::from(point.coords)).unwrap();
                    assert!(gap.distance <= 0.0, "{} {way:?} {gap:?}", shape.kind());
                }
            }
            assert!((high - low).min() > 0.0);
        }
        let thin = Body::single("thin", Shape::cuboid(Vector3::new(0.1, 0.1, 0.005)).unwrap()).unwrap();
        assert!(shrunk(&thin, [0.0, by_m], false).is_none());
    }
}
