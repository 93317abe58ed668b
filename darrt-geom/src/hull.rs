//! Convex hulls of points, checked after they are built.

mod cover;

use crate::check;
use crate::convert;
use crate::error::GeomError;
use nalgebra::Point3;
use parry3d_f64::shape::{ConvexPolyhedron, SharedShape};
use parry3d_f64::transformation::try_convex_hull;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Most different points a hull is made from.
pub const MAXIMUM_POINTS: usize = 100_000;
/// Most points it is given, equal ones counted each: the corners of the largest mesh.
const MAXIMUM_CORNERS: usize = 3 * crate::mesh::MAXIMUM_TRIANGLES;
/// Smallest ratio of a hull's thinnest to its widest extent.
pub const MINIMUM_THICKNESS_RATIO: f64 = 1e-3;
/// How far, relative to its size, an input point may lie outside the finished hull.
const TOLERANCE: f64 = 1e-6;

/// The convex hull of a set of points.
#[derive(Clone)]
pub struct ConvexHull {
    vertices: Vec<Point3<f64>>,
    triangles: Vec<[u32; 3]>,
    parry: SharedShape,
}

impl ConvexHull {
    /// The hull of `points` (metres, own frame); `name` appears in error messages.
    ///
    /// # Errors
    /// When there are fewer than 4 or more than [`MAXIMUM_POINTS`] different points, a coordinate is not finite or beyond 1e4 m,
    /// the points are thinner in some direction than [`MINIMUM_THICKNESS_RATIO`] of their extent, or rounding keeps
    /// the finished hull from holding every point.
    pub fn new(name: &str, points: &[Point3<f64>]) -> Result<Self, GeomError> {
        let (distinct, size) = Self::checked(name, points)?;
        Self::sound(name, Self::built(&distinct), &distinct, size)
    }

    /// The hull of different points as it is built; `None` if that fails.
    fn built(distinct: &[Point3<f64>]) -> Option<Self> {
        let (vertices, triangles, polyhedron) = build(distinct)?;
        Some(Self { vertices, triangles, parry: SharedShape::new(polyhedron) })
    }

    /// How far the point that is farthest outside lies beyond a face, as a share of the extent of the points.
    fn outlier(&self, points: &[Point3<f64>], size: f64) -> f64 {
        largest_outlier(&self.vertices, &self.triangles, points) / size
    }

    /// `hull` if there is one, and it holds the points.
    fn sound(name: &str, hull: Option<Self>, points: &[Point3<f64>], size: f64) -> Result<Self, GeomError> {
        let failed = |outlier| GeomError::UnsoundHull { name: name.to_owned(), outlier, maximum: TOLERANCE };
        let hull = hull.ok_or_else(|| failed(1.0))?;
        let outlier = hull.outlier(points, size);
        if outlier.is_nan() || outlier > TOLERANCE { Err(failed(outlier)) } else { Ok(hull) }
    }

    /// The different points, and their extent.
    fn checked(name: &str, points: &[Point3<f64>]) -> Result<(Vec<Point3<f64>>, f64), GeomError> {
        check::count(format_args!("points of {name}"), points.len(), 4, MAXIMUM_CORNERS)?;
        for (i, p) in points.iter().enumerate() {
            check::point(format_args!("point {i} of {name}"), p)?;
        }
        let size = check_thickness(name, points)?;
        let distinct = without_duplicates(points, size * 1e-9);
        check::count(format_args!("different points of {name}"), distinct.len(), 4, MAXIMUM_POINTS)?;
        Ok((distinct, size))
    }

    /// Corners of the hull, own frame.
    pub fn vertices(&self) -> &[Point3<f64>] {
        &self.vertices
    }

    /// Triangles of the surface as indices into [`Self::vertices`], counter-clockwise from outside.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    pub(crate) fn parry(&self) -> &SharedShape {
        &self.parry
    }
}

impl PartialEq for ConvexHull {
    fn eq(&self, other: &Self) -> bool {
        self.vertices == other.vertices && self.triangles == other.triangles
    }
}

impl std::fmt::Debug for ConvexHull {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ConvexHull").field("vertices", &self.vertices.len()).finish_non_exhaustive()
    }
}

/// Refuses points that nearly lie in a plane; returns their extent.
fn check_thickness(name: &str, points: &[Point3<f64>]) -> Result<f64, GeomError> {
    let count = points.len() as f64;
    let centre = points.iter().fold(nalgebra::Vector3::zeros(), |sum, p| sum + p.coords) / count;
    let covariance = points.iter().fold(nalgebra::Matrix3::zeros(), |sum, p| {
        let d = p.coords - centre;
        sum + d * d.transpose()
    }) / count;
    let axes = covariance.symmetric_eigen().eigenvectors;
    let mut extents: Vec<f64> = axes
        .column_iter()
        .map(|axis| {
            let along = points.iter().map(|p| axis.dot(&p.coords));
            let (low, high) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
            high - low
        })
        .collect();
    extents.sort_by(f64::total_cmp);
    let (thin, wide) = (extents.first().copied().unwrap_or(0.0), extents.last().copied().unwrap_or(0.0));
    let minimum = (wide * MINIMUM_THICKNESS_RATIO).max(check::MINIMUM_LENGTH);
    // A NaN must be refused too.
    if thin.is_nan() || thin < minimum {
        return Err(GeomError::Degenerate {
            name: name.to_owned(),
            measure: "thickness in metres",
            value: thin,
            minimum,
        });
    }
    Ok(wide)
}

/// Points rounded to the same cell of a fine grid are one point; first come, first kept.
fn without_duplicates(points: &[Point3<f64>], cell: f64) -> Vec<Point3<f64>> {
    let mut seen = std::collections::BTreeSet::new();
    let key = |p: &Point3<f64>| [p.x, p.y, p.z].map(|x| (x / cell).round().to_bits());
    points.iter().filter(|p| seen.insert(key(p))).copied().collect()
}

/// What [`build`] makes: corners, triangles, and parry's view of both.
type Built = (Vec<Point3<f64>>, Vec<[u32; 3]>, ConvexPolyhedron);

/// The hull as parry builds it, or `None` when parry gives up.
fn build(points: &[Point3<f64>]) -> Option<Built> {
    let input: Vec<_> = points.iter().map(|p| convert::vector(&p.coords)).collect();
    // parry asserts its own invariants while building; rounding on hostile input can break them. The input is owned and
    // dropped, so nothing half-made survives the unwinding.
    catch_unwind(AssertUnwindSafe(|| {
        let (corners, triangles) = try_convex_hull(&input).ok()?;
        let vertices = corners.iter().map(|&v| convert::point_from(v)).collect();
        let polyhedron = ConvexPolyhedron::from_convex_mesh(corners, &triangles)?;
        Some((vertices, triangles, polyhedron))
    }))
    .ok()
    .flatten()
}

/// Greatest signed distance of a point beyond a face of the hull (metres); NaN when a face is broken.
fn largest_outlier(vertices: &[Point3<f64>], triangles: &[[u32; 3]], points: &[Point3<f64>]) -> f64 {
    let corner = |i: u32| vertices.get(i as usize);
    let mut worst = f64::NEG_INFINITY;
    for [a, b, c] in triangles {
        let (Some(a), Some(b), Some(c)) = (corner(*a), corner(*b), corner(*c)) else { return f64::NAN };
        let Some(normal) = (b - a).cross(&(c - a)).try_normalize(1e-18) else { continue };
        for p in points {
            worst = worst.max(normal.dot(&(p - a)));
        }
    }
    if worst.is_finite() { worst } else { f64::NAN }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn cube() -> Vec<Point3<f64>> {
        (0..8).map(|i| Point3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2 & 1))).collect()
    }

    #[test]
    fn a_cube_with_inner_and_double_points_has_eight_corners() {
        let mut points = cube();
        points.push(Point3::new(0.5, 0.5, 0.5));
        points.extend(cube());
        let hull = ConvexHull::new("cube", &points).unwrap();
        assert_eq!((hull.vertices().len(), hull.triangles().len()), (8, 12));
    }

    #[test]
    fn flat_few_and_broken_points_are_refused() {
        let flat: Vec<_> = cube().iter().map(|p| Point3::new(p.x, p.y, 0.0)).collect();
        assert!(matches!(ConvexHull::new("flat", &flat), Err(GeomError::Degenerate { .. })));
        assert!(matches!(ConvexHull::new("few", &cube()[..3]), Err(GeomError::Count { .. })));
        let mut broken = cube();
        broken[3].y = f64::NAN;
        assert!(matches!(ConvexHull::new("nan", &broken), Err(GeomError::NotFinite { .. })));
        assert!(ConvexHull::new("one point", &[Point3::origin(); 9]).is_err());
    }

    proptest! {
        #[test]
        fn random_and_grid_points_give_a_sound_hull_or_an_error(
            raw in prop::collection::vec(prop::array::uniform3(-4_i32..5), 4..60), scale in 1e-3_f64..10.0,
        ) {
            let points: Vec<_> = raw.iter().map(|c| Point3::from(c.map(|x| f64::from(x) * scale))).collect();
            if let Ok(hull) = ConvexHull::new("grid", &points) {
                prop_assert!(largest_outlier(hull.vertices(), hull.triangles(), &points) < 1e-5 * scale);
            }
        }
    }
}
