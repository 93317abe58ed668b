//! Is a part inside a mesh? By other code than the checker's: rays in a few directions, against all triangles, one by one.

use super::Placed;
use crate::shape::Shape;
use nalgebra::{Point3, Vector3};
use std::collections::BTreeMap;

/// Rays that pass an edge this near, as a share of the triangle, say nothing.
const DOUBTFUL: f64 = 1e-9;
/// Directions that are tried until one passes every edge far enough.
const DIRECTIONS: [[f64; 3]; 6] = [
    [0.62, -0.55, 0.56],
    [-0.31, 0.87, -0.38],
    [0.11, 0.29, -0.95],
    [-0.83, -0.17, 0.53],
    [0.47, 0.71, 0.52],
    [-0.05, -0.96, -0.27],
];

/// Is something of `other`, which does not touch the surface of the mesh, in its solid?
pub(super) fn is_in(mesh: &Placed<'_>, other: &Placed<'_>) -> bool {
    let Shape::Mesh(surface) = mesh.shape else { return false };
    if !other.shape.is_bounded() {
        return false;
    }
    let (low, high) = mesh.shape.local_aabb();
    let is_within = |p: &Point3<f64>| {
        let p = mesh.world_from_shape.inverse_transform_point(&(other.world_from_shape * p));
        let is_in_box = (0..3).all(|i| (low[i]..=high[i]).contains(&p[i]));
        // A ray through an edge in every direction: on the safe side.
        is_in_box && DIRECTIONS.iter().find_map(|way| depth(surface, &p, &Vector3::from(*way))).is_none_or(|d| d > 0)
    };
    match other.shape {
        Shape::Mesh(others) => others.points_of_pieces().iter().any(is_within),
        convex => is_within(&convex.support_point(&-Vector3::z())),
    }
}

/// In how many solids the point is, cavities taken off; `None` if the ray passes an edge too near to tell.
fn depth(surface: &crate::TriangleMesh, p: &Point3<f64>, way: &Vector3<f64>) -> Option<i32> {
    let mut crossed: BTreeMap<usize, (u32, i32)> = BTreeMap::new();
    for ([a, b, c], piece, count) in surface.closed_triangles() {
        let (u, v) = (b - a, c - a);
        let across = way.cross(&v);
        let volume = u.dot(&across);
        let flat = DOUBTFUL * u.norm() * v.norm();
        if volume.abs() <= flat {
            // Along the triangle: only a ray in its plane can meet it.
            let normal = u.cross(&v);
            let is_apart = normal.dot(&(p - a)).abs() > DOUBTFUL * normal.norm();
            if is_apart || normal.norm() <= flat {
                continue;
            }
            return None;
        }
        let from = p - a;
        let first = from.dot(&across) / volume;
        let second = way.dot(&from.cross(&u)) / volume;
        let third = 1.0 - first - second;
        let least = first.min(second).min(third);
        if least < -DOUBTFUL {
            continue;
        }
        if v.dot(&from.cross(&u)) / volume <= 0.0 {
            continue;
        }
        if least < DOUBTFUL {
            return None;
        }
        crossed.entry(piece).or_insert((0, count)).0 += 1;
    }
    Some(crossed.values().filter(|(times, _)| times % 2 == 1).map(|(_, count)| count).sum())
}
