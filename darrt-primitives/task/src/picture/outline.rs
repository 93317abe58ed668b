//! Silhouettes: the corners of posed solids and the convex hull of their shadows.

use std::f64::consts::TAU;

use darrt_geom::{Body, Shape};
use nalgebra::{Isometry3, Point2, Point3, Vector3};

/// Corners that stand in for a circle.
const CIRCLE: u32 = 40;

/// Points whose convex hull is the solid (to the resolution of a drawn circle), in the frame that `frame_from_body`
/// leads to; empty for an unbounded solid.
pub(super) fn body_points(body: &Body, frame_from_body: &Isometry3<f64>) -> Vec<Point3<f64>> {
    let parts = body.parts.iter();
    parts.flat_map(|part| shape_points(&part.shape, &(frame_from_body * part.body_from_shape))).collect()
}

/// As [`body_points`], for one shape.
pub(super) fn shape_points(shape: &Shape, frame_from_shape: &Isometry3<f64>) -> Vec<Point3<f64>> {
    let posed = |points: &[Point3<f64>]| points.iter().map(|p| frame_from_shape * p).collect();
    match shape {
        Shape::Cuboid { half_extents, .. } => {
            let corner = |i: u32| {
                let sign = Vector3::from_fn(|axis, _| if i >> axis & 1 == 0 { -1.0 } else { 1.0 });
                frame_from_shape * Point3::from(half_extents.component_mul(&sign))
            };
            (0..8).map(corner).collect()
        }
        Shape::Cylinder { radius, half_height, .. } => [-half_height, *half_height]
            .into_iter()
            .flat_map(|z| circle(*radius).map(move |(x, y)| frame_from_shape * Point3::new(x, y, z)))
            .collect(),
        Shape::Sphere { radius, .. } => ball(*radius, &(frame_from_shape * Point3::origin())),
        Shape::Capsule { radius, half_height, .. } => [-half_height, *half_height]
            .into_iter()
            .flat_map(|z| ball(*radius, &(frame_from_shape * Point3::new(0.0, 0.0, z))))
            .collect(),
        Shape::ConvexHull(hull) => posed(hull.vertices()),
        Shape::Mesh(mesh) => posed(mesh.vertices()),
        // An unbounded solid, or a kind that this file does not know.
        _ => Vec::new(),
    }
}

fn circle(radius: f64) -> impl Iterator<Item = (f64, f64)> {
    (0..CIRCLE).map(move |i| {
        let (sine, cosine) = (TAU * f64::from(i) / f64::from(CIRCLE)).sin_cos();
        (radius * cosine, radius * sine)
    })
}

/// Great circles in the three coordinate planes, so that the shadow along each axis is round.
fn ball(radius: f64, centre: &Point3<f64>) -> Vec<Point3<f64>> {
    let rings = |(a, b): (f64, f64)| [Vector3::new(a, b, 0.0), Vector3::new(a, 0.0, b), Vector3::new(0.0, a, b)];
    circle(radius).flat_map(rings).map(|offset| centre + offset).collect()
}

/// The convex hull of `points`, counter-clockwise, without points on its edges.
///
/// # Source
/// Andrew, "Another efficient algorithm for convex hulls in two dimensions", 1979.
pub(super) fn hull(points: impl IntoIterator<Item = Point2<f64>>) -> Vec<Point2<f64>> {
    let mut sorted: Vec<_> = points.into_iter().filter(|p| p.x.is_finite() && p.y.is_finite()).collect();
    sorted.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    sorted.dedup();
    if sorted.len() < 3 {
        return sorted;
    }
    let mut lower = chain(sorted.iter());
    let mut upper = chain(sorted.iter().rev());
    lower.pop();
    upper.pop();
    lower.append(&mut upper);
    lower
}

/// The part of a hull from the first to the last of sorted points.
fn chain<'a>(points: impl Iterator<Item = &'a Point2<f64>>) -> Vec<Point2<f64>> {
    let mut chain: Vec<Point2<f64>> = Vec::new();
    for &point in points {
        while let [.., a, b] = chain.as_slice() {
            if (b - a).perp(&(point - b)) > 0.0 {
                break;
            }
            chain.pop();
        }
        chain.push(point);
    }
    chain
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(polygon: &[Point2<f64>]) -> f64 {
        let next = polygon.iter().cycle().skip(1);
        polygon.iter().zip(next).map(|(a, b)| a.coords.perp(&b.coords)).sum::<f64>() / 2.0
    }

    #[test]
    fn inner_double_and_collinear_points_are_dropped() {
        let grid = (0..5).flat_map(|i| (0..5).map(move |j| Point2::new(f64::from(i), f64::from(j))));
        let found = hull(grid.clone().chain(grid).chain([Point2::new(f64::NAN, 0.0)]));
        assert_eq!(found.len(), 4);
        assert_eq!(area(&found), 16.0);
    }

    #[test]
    fn few_points_are_their_own_hull() {
        assert!(hull([]).is_empty());
        assert_eq!(hull([Point2::origin(); 3]).len(), 1);
        let line = (0..4).map(|i| Point2::new(f64::from(i), f64::from(i)));
        assert_eq!(hull(line).len(), 2);
    }

    #[test]
    fn shadows_have_the_right_area() {
        let above = |shape: &Shape| area(&hull(shape_points(shape, &Isometry3::identity()).iter().map(Point3::xy)));
        let round = std::f64::consts::PI * 0.01;
        assert!((above(&Shape::cuboid(Vector3::new(0.1, 0.2, 0.3)).unwrap()) - 0.08).abs() < 1e-12);
        for shape in [Shape::cylinder(0.1, 1.0), Shape::sphere(0.1), Shape::capsule(0.1, 0.2)] {
            assert!((above(&shape.unwrap()) - round).abs() < 0.01 * round);
        }
        assert!(shape_points(&Shape::half_space(Vector3::z_axis()).unwrap(), &Isometry3::identity()).is_empty());
    }
}
