//! Distance and nearest points of two posed bodies, for verifying plans and for pictures.

use crate::body::{Body, Part};
use crate::check;
use crate::convert;
use crate::error::GeomError;
use crate::narrow::{self, Gap, Posed};
use crate::place;
use crate::shape::Shape;
use nalgebra::{Isometry3, Point3, Vector3};

/// How two posed bodies lie to each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clearance {
    /// Metres. Positive: the distance (to 1e-5 m; parry is no better on curved shapes). Zero or negative: they touch or
    /// overlap, and its size is an upper bound of the shift that would part the two parts (exact for two boxes, a box and a
    /// half space, or two balls; always zero for meshes).
    pub distance: f64,
    /// Nearest point of the first body (world); when they overlap, a point in both.
    pub first: Point3<f64>,
    /// Nearest point of the second body (world); when they overlap, the same point.
    pub second: Point3<f64>,
    /// The parts the two points belong to.
    pub parts: (usize, usize),
}

/// The clearance between two bodies: that of their nearest (or deepest) parts; ties go to the earlier parts.
///
/// Two half spaces always count as touching.
///
/// # Errors
/// When a body or a pose is unfit, see [`Body::check`].
pub fn between(
    a: &Body,
    world_from_a: &Isometry3<f64>,
    b: &Body,
    world_from_b: &Isometry3<f64>,
) -> Result<Clearance, GeomError> {
    for (body, pose) in [(a, world_from_a), (b, world_from_b)] {
        body.check()?;
        check::pose(format_args!("pose of `{}`", body.name), pose)?;
    }
    let mut best =
        Clearance { distance: f64::INFINITY, first: Point3::origin(), second: Point3::origin(), parts: (0, 0) };
    for (i, part_a) in a.parts.iter().enumerate() {
        for (j, part_b) in b.parts.iter().enumerate() {
            let found = parts(part_a, world_from_a, part_b, world_from_b);
            if found.distance < best.distance {
                best = Clearance { parts: (i, j), ..found };
            }
        }
    }
    Ok(best)
}

/// The clearance between two parts of bodies at the given poses.
fn parts(a: &Part, world_from_a: &Isometry3<f64>, b: &Part, world_from_b: &Isometry3<f64>) -> Clearance {
    let (parry_a, parry_b) = (convert::shape(&a.shape), convert::shape(&b.shape));
    let a = Posed { shape: &a.shape, parry: &parry_a, world_from_shape: world_from_a * a.body_from_shape };
    let b = Posed { shape: &b.shape, parry: &parry_b, world_from_shape: world_from_b * b.body_from_shape };
    match narrow::gap(&a, &b) {
        Gap::Open { distance, first, second, .. } => Clearance { distance, first, second, parts: (0, 0) },
        Gap::Closed => {
            let place = place::shared(a.shape, &a.world_from_shape, b.shape, &b.world_from_shape);
            Clearance { distance: -depth(&a, &b), first: place, second: place, parts: (0, 0) }
        }
    }
}

/// The smallest shift, along a few promising directions, that parts two overlapping shapes.
fn depth(a: &Posed<'_>, b: &Posed<'_>) -> f64 {
    if [a, b].iter().any(|posed| matches!(posed.shape, Shape::Mesh(_))) {
        return 0.0;
    }
    let extent = |posed: &Posed<'_>, direction: &Vector3<f64>| {
        let local = posed.world_from_shape.inverse_transform_vector(direction);
        direction.dot(&posed.world_from_shape.translation.vector) + posed.shape.support_extent(&local)
    };
    let overlap = |n: Vector3<f64>| extent(a, &n) + extent(b, &-n);
    let least = directions(a, b)
        .into_iter()
        .filter_map(|n| n.try_normalize(1e-9))
        .flat_map(|n| [overlap(n), overlap(-n)])
        .fold(f64::INFINITY, f64::min);
    // Two half spaces overlap without end.
    if least.is_finite() { least.max(0.0) } else { 0.0 }
}

/// Directions along which shapes part easily: axes of both frames, their products, centre to centre, normals.
fn directions(a: &Posed<'_>, b: &Posed<'_>) -> Vec<Vector3<f64>> {
    let axes = |posed: &Posed<'_>| [0, 1, 2].map(|i| posed.world_from_shape * Vector3::ith(i, 1.0));
    let mut directions: Vec<_> = [a, b]
        .iter()
        .filter_map(|posed| match posed.shape {
            Shape::HalfSpace { normal } => Some(posed.world_from_shape * normal.into_inner()),
            _ => None,
        })
        .collect();
    if directions.is_empty() {
        let (of_a, of_b) = (axes(a), axes(b));
        directions.extend(of_a.iter().chain(&of_b));
        directions.extend(of_a.iter().flat_map(|u| of_b.iter().map(move |v| u.cross(v))));
        let centre = |posed: &Posed<'_>| posed.world_from_shape * posed.shape.bounding_sphere().0;
        directions.push(centre(b) - centre(a));
    }
    directions
}

#[cfg(test)]
mod tests {
    use super::*;

    fn clear(a: Shape, world_from_a: Isometry3<f64>, b: Shape, world_from_b: Isometry3<f64>) -> Clearance {
        let (a, b) = (Body::single("a", a).unwrap(), Body::single("b", b).unwrap());
        let there = between(&a, &world_from_a, &b, &world_from_b).unwrap();
        let back = between(&b, &world_from_b, &a, &world_from_a).unwrap();
        assert!((there.distance - back.distance).abs() < 1e-6);
        there
    }

    #[test]
    fn signs_sizes_and_points() {
        let cube = || Shape::cuboid(Vector3::repeat(0.5)).unwrap();
        let ball = || Shape::sphere(0.5).unwrap();
        let floor = || Shape::half_space(Vector3::z_axis()).unwrap();
        let here = Isometry3::identity();
        let at = Isometry3::translation;
        assert!((clear(cube(), here, cube(), at(3.0, 0.0, 0.0)).distance - 2.0).abs() < 1e-9);
        assert!((clear(cube(), here, cube(), at(0.9, 0.2, 0.0)).distance + 0.1).abs() < 1e-9);
        assert!((clear(ball(), here, ball(), at(0.6, 0.6, 0.0)).distance - (0.72_f64.sqrt() - 1.0)).abs() < 1e-9);
        let sunk = clear(floor(), here, cube(), at(5.0, 0.0, 0.3));
        assert!((sunk.distance + 0.2).abs() < 1e-9 && (sunk.first.x - 5.0).abs() < 0.6);
        let above = clear(floor(), here, ball(), at(5.0, 1.0, 0.75));
        assert!((above.distance - 0.25).abs() < 1e-12 && (above.first - Point3::new(5.0, 1.0, 0.0)).norm() < 1e-9);
        assert_eq!(clear(floor(), here, floor(), at(0.0, 0.0, 1.0)).distance, 0.0);
    }

    #[test]
    fn the_nearest_parts_are_named_and_bad_poses_refused() {
        let ball = Shape::sphere(0.1).unwrap();
        let two = vec![
            Part::centred(ball.clone()),
            Part { shape: ball.clone(), body_from_shape: Isometry3::translation(1.0, 0.0, 0.0) },
        ];
        let (a, b) = (Body::new("two", two).unwrap(), Body::single("one", ball).unwrap());
        let found = between(&a, &Isometry3::identity(), &b, &Isometry3::translation(1.5, 0.0, 0.0)).unwrap();
        assert!(found.parts == (1, 0) && (found.distance - 0.3).abs() < 1e-9);
        assert!(between(&a, &Isometry3::translation(f64::NAN, 0.0, 0.0), &b, &Isometry3::identity()).is_err());
    }
}
