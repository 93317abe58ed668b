//! A hull with few corners around one with many: what a distance costs grows with the corners.

use super::{ConvexHull, TOLERANCE};
use crate::error::GeomError;
use nalgebra::{Matrix3, Point3, Vector3};

/// Three planes nearer to having no common point than this (the determinant of their normals) have none.
const PARALLEL: f64 = 1e-9;
/// What rounding does, as a share of the size.
const ROUNDING: f64 = 1e-9;
/// Corners that cannot be farther outside than this share of the size are as good as none.
const ENOUGH: f64 = 1e-3;

/// The half space `normal . p <= offset`.
#[derive(Debug, Clone, Copy)]
struct Plane {
    normal: Vector3<f64>,
    offset: f64,
}

/// A corner of the cover with the face of the hull that it is farthest beyond, metres.
#[derive(Debug, Clone, Copy)]
struct Corner {
    at: Point3<f64>,
    beyond_m: f64,
    face: usize,
}

impl ConvexHull {
    /// A solid with at most about `most` corners that holds the hull of `points` (metres, own frame), and how far its corners lie
    /// beyond faces of that hull at most, metres: a few of the planes of the hull's faces, where they cut away most. A hull that has
    /// no more corners is itself.
    ///
    /// # Errors
    /// As [`ConvexHull::new`].
    ///
    /// # Laws
    /// No point lies outside, but for rounding.
    pub fn around(name: &str, points: &[Point3<f64>], most: usize) -> Result<(Self, f64), GeomError> {
        let (distinct, size) = Self::checked(name, points)?;
        let hull = Self::built(&distinct);
        if let Some(hull) = hull.as_ref().filter(|hull| hull.vertices.len() > most) {
            let cover = planes_around(hull, most);
            let cover = cover.and_then(|(corners, beyond_m)| Some((Self::new(name, &corners).ok()?, beyond_m)));
            // A cover that rounding has spoilt, or that saves nothing, is none; a NaN neither.
            let is_good = |cover: &Self| {
                cover.vertices.len() < hull.vertices.len() && cover.outlier(&distinct, size) <= TOLERANCE
            };
            if let Some(found) = cover.filter(|(cover, _)| is_good(cover)) {
                return Ok(found);
            }
        }
        Ok((Self::sound(name, hull, &distinct, size)?, 0.0))
    }
}

fn extent(points: &[Point3<f64>]) -> f64 {
    let (low, high) =
        points.iter().fold((Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY)), |(l, h), p| {
            (l.inf(&p.coords), h.sup(&p.coords))
        });
    (high - low).max()
}

/// The corners of what a few planes of the hull's faces leave, and how far they are outside the hull at most.
fn planes_around(hull: &ConvexHull, most: usize) -> Option<(Vec<Point3<f64>>, f64)> {
    let size = extent(&hull.vertices);
    let touching = |normal: Vector3<f64>| {
        let offset = hull.vertices.iter().map(|p| normal.dot(&p.coords)).fold(f64::NEG_INFINITY, f64::max);
        Plane { normal, offset }
    };
    let corner = |i: u32| hull.vertices.get(i as usize);
    let faces = hull.triangles.iter().filter_map(|[a, b, c]| {
        let (a, b, c) = (corner(*a)?, corner(*b)?, corner(*c)?);
        let normal = (b - a).cross(&(c - a)).try_normalize(1e-12 * size * size)?;
        Some(Plane { normal, offset: normal.dot(&a.coords) })
    });
    let faces: Vec<Plane> = faces.collect();
    let placed = |at: Point3<f64>| {
        let beyond = faces.iter().enumerate().map(|(face, plane)| (plane.normal.dot(&at.coords) - plane.offset, face));
        beyond.reduce(|best, next| if next.0 > best.0 { next } else { best }).map(|(beyond_m, face)| Corner {
            at,
            beyond_m,
            face,
        })
    };
    let mut planes: Vec<Plane> =
        (0..3).flat_map(|axis| [Vector3::ith(axis, 1.0), Vector3::ith(axis, -1.0)]).map(touching).collect();
    let mut corners = Vec::new();
    for bits in 0..8_usize {
        let side = |axis: usize| {
            let (high, low) = (planes.get(2 * axis)?, planes.get(2 * axis + 1)?);
            Some(if bits & (1 << axis) == 0 { -low.offset } else { high.offset })
        };
        corners.push(placed(Point3::new(side(0)?, side(1)?, side(2)?))?);
    }
    let worst = |corners: &[Corner]| {
        corners.iter().copied().reduce(|best, next| if next.beyond_m > best.beyond_m { next } else { best })
    };
    loop {
        let worst = worst(&corners)?;
        // A cut takes one corner and leaves three in its place, or more.
        if worst.beyond_m <= ENOUGH * size || corners.len() + 2 > most {
            return Some((corners.iter().map(|corner| corner.at).collect(), worst.beyond_m.max(0.0)));
        }
        let cut = touching(faces.get(worst.face)?.normal);
        let before = corners.len();
        corners.retain(|corner| cut.normal.dot(&corner.at.coords) <= cut.offset + ROUNDING * size);
        if corners.len() == before {
            // The touching plane of a face is farther out than the face: the hull is as rounding left it.
            return Some((corners.iter().map(|corner| corner.at).collect(), worst.beyond_m));
        }
        for (i, first) in planes.iter().enumerate() {
            for second in planes.iter().skip(i + 1) {
                let Some(at) = common(&[*first, *second, cut]) else { continue };
                let is_inside = |plane: &Plane| plane.normal.dot(&at.coords) <= plane.offset + ROUNDING * size;
                let is_known = || corners.iter().any(|corner| (corner.at - at).amax() <= ROUNDING * size);
                if planes.iter().all(is_inside) && !is_known() {
                    corners.push(placed(at)?);
                }
            }
        }
        planes.push(cut);
    }
}

/// The point of three planes.
fn common(planes: &[Plane; 3]) -> Option<Point3<f64>> {
    let rows = Matrix3::from_rows(&planes.map(|plane| plane.normal.transpose()));
    if rows.determinant().abs() <= PARALLEL {
        return None;
    }
    let offsets = Vector3::from(planes.map(|plane| plane.offset));
    Some(Point3::from(rows.lu().solve(&offsets)?))
}

#[cfg(test)]
mod tests {
    use super::super::largest_outlier;
    use super::*;
    use std::f64::consts::PI;

    fn ball(count: u32) -> Vec<Point3<f64>> {
        // Spread evenly: a spiral.
        let at = |i: u32| {
            let z = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(count);
            let turn = f64::from(i) * PI * (3.0 - 5.0_f64.sqrt());
            let r = (1.0 - z * z).sqrt();
            Point3::new(r * turn.cos(), r * turn.sin(), 0.3 * z)
        };
        (0..count).map(at).collect()
    }

    #[test]
    fn a_cover_holds_every_point_with_few_corners_and_little_air() {
        let points = ball(3000);
        let hull = ConvexHull::new("ball", &points).unwrap();
        for (most, excess_m) in [(40, 0.2), (80, 0.1), (160, 0.05)] {
            let (cover, beyond_m) = ConvexHull::around("ball", &points, most).unwrap();
            assert!(cover.vertices().len() <= most + 8, "{} of {most}", cover.vertices().len());
            assert!(largest_outlier(cover.vertices(), cover.triangles(), &points) < 1e-6);
            assert!(beyond_m > 0.0 && beyond_m < excess_m, "{most}: {beyond_m}");
            let farthest = |direction: Vector3<f64>| {
                let along = |hull: &ConvexHull| {
                    hull.vertices().iter().map(|p| p.coords.dot(&direction)).fold(f64::NEG_INFINITY, f64::max)
                };
                along(&cover) - along(&hull)
            };
            assert!(farthest(Vector3::new(1.0, 2.0, 3.0).normalize()) < 2.0 * excess_m);
        }
    }

    #[test]
    fn few_corners_stay_as_they_are() {
        let cube: Vec<_> =
            (0..8).map(|i| Point3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2 & 1))).collect();
        let hull = ConvexHull::new("cube", &cube).unwrap();
        assert_eq!(ConvexHull::around("cube", &cube, 8).unwrap(), (hull, 0.0));
        // Fewer corners than a box has cannot be had.
        assert_eq!(ConvexHull::around("cube", &cube, 4).unwrap().0.vertices().len(), 8);
        assert!(ConvexHull::around("few", &cube[..3], 8).is_err());
    }
}
