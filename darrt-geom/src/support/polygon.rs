//! Simple polygons in the plane: checks, orientation, winding, triangles.

use crate::check;
use crate::error::GeomError;
use nalgebra::{Point2, Vector2};

/// Smallest area of a surface, in square metres.
const MINIMUM_AREA: f64 = 1e-9;

/// The vertices counter-clockwise, once the polygon is known to be simple.
pub(super) fn normalise(name: &str, vertices: &[Point2<f64>]) -> Result<Vec<Point2<f64>>, GeomError> {
    for (i, p) in vertices.iter().enumerate() {
        check::coordinate(format_args!("x of vertex {i} of `{name}`"), p.x)?;
        check::coordinate(format_args!("y of vertex {i} of `{name}`"), p.y)?;
    }
    let degenerate =
        |measure, value, minimum| Err(GeomError::Degenerate { name: name.to_owned(), measure, value, minimum });
    for (a, b) in edges(vertices) {
        let length = (b - a).norm();
        if length < check::MINIMUM_LENGTH {
            return degenerate("edge length in metres", length, check::MINIMUM_LENGTH);
        }
    }
    let area = twice_area(vertices) / 2.0;
    if area.abs() < MINIMUM_AREA {
        return degenerate("area in square metres", area.abs(), MINIMUM_AREA);
    }
    if let Some((first, second)) = crossing(vertices) {
        return Err(GeomError::SelfIntersecting { name: name.to_owned(), first, second });
    }
    let mut vertices = vertices.to_vec();
    if area < 0.0 {
        vertices.reverse();
    }
    Ok(vertices)
}

/// The edges as pairs of ends, each vertex to the next, the last to the first.
pub(super) fn edges(vertices: &[Point2<f64>]) -> impl Iterator<Item = (Point2<f64>, Point2<f64>)> + '_ {
    let next = vertices.iter().cycle().skip(1);
    vertices.iter().copied().zip(next.copied())
}

/// Twice the signed area, positive when counter-clockwise.
pub(super) fn twice_area(vertices: &[Point2<f64>]) -> f64 {
    // Relative to a vertex, so that far-away polygons keep their digits.
    let origin = vertices.first().copied().unwrap_or_else(Point2::origin);
    edges(vertices).map(|(a, b)| (a - origin).perp(&(b - origin))).sum()
}

/// Whether the polygon winds around the point (boundary points may go either way).
pub(super) fn winds_around(vertices: &[Point2<f64>], p: &Point2<f64>) -> bool {
    let mut inside = false;
    for (a, b) in edges(vertices) {
        if (a.y > p.y) != (b.y > p.y) {
            let left_of_edge = (b - a).perp(&(p - a)) > 0.0;
            if left_of_edge == (b.y > a.y) {
                inside = !inside;
            }
        }
    }
    inside
}

/// The first two edges that share a point they should not.
fn crossing(vertices: &[Point2<f64>]) -> Option<(usize, usize)> {
    let count = vertices.len();
    let all: Vec<_> = edges(vertices).collect();
    for (i, &(a, b)) in all.iter().enumerate() {
        for (j, &(c, d)) in all.iter().enumerate().skip(i + 1) {
            let meet = if j == i + 1 {
                folds_back(b - a, d - c)
            } else if i == 0 && j == count - 1 {
                folds_back(d - c, b - a)
            } else {
                segments_touch(a, b, c, d)
            };
            if meet {
                return Some((i, j));
            }
        }
    }
    None
}

/// Whether an edge runs back along the one before it.
fn folds_back(before: Vector2<f64>, after: Vector2<f64>) -> bool {
    before.dot(&after) < 0.0 && before.perp(&after).abs() <= 1e-9 * before.norm() * after.norm()
}

/// Whether two segments share a point.
fn segments_touch(a: Point2<f64>, b: Point2<f64>, c: Point2<f64>, d: Point2<f64>) -> bool {
    let side = |p: Point2<f64>, q: Point2<f64>, r: Point2<f64>| (q - p).perp(&(r - p));
    let (abc, abd, cda, cdb) = (side(a, b, c), side(a, b, d), side(c, d, a), side(c, d, b));
    if (abc > 0.0) != (abd > 0.0) && (cda > 0.0) != (cdb > 0.0) && abc != 0.0 && abd != 0.0 && cda != 0.0 && cdb != 0.0
    {
        return true;
    }
    let within = |p: Point2<f64>, q: Point2<f64>, r: Point2<f64>| (r - p).dot(&(r - q)) <= 0.0;
    (abc == 0.0 && within(a, b, c))
        || (abd == 0.0 && within(a, b, d))
        || (cda == 0.0 && within(c, d, a))
        || (cdb == 0.0 && within(c, d, b))
}

/// Triangles that tile a simple counter-clockwise polygon.
///
/// # Source
/// Ear clipping: G. H. Meisters, "Polygons have ears", American Mathematical Monthly 82 (1975).
pub(super) fn triangulate(vertices: &[Point2<f64>]) -> Vec<[Point2<f64>; 3]> {
    let mut left = vertices.to_vec();
    let mut tiles = Vec::with_capacity(left.len());
    while left.len() > 3 {
        // Rounding can hide the last ears of a very thin polygon; then the corner with the largest signed area is cut,
        // which keeps the tiles' total area true to rounding.
        let ear = (0..left.len()).find(|&i| is_ear(&left, i)).unwrap_or_else(|| widest(&left));
        let Some(tile) = corner(&left, ear) else { break };
        tiles.push(tile);
        left.remove(ear);
    }
    tiles.extend(<[Point2<f64>; 3]>::try_from(left).ok());
    tiles
}

/// The vertex before, the vertex, the vertex after.
fn corner(vertices: &[Point2<f64>], i: usize) -> Option<[Point2<f64>; 3]> {
    let count = vertices.len();
    let at = |k: usize| vertices.get(k % count).copied();
    Some([at(i + count - 1)?, at(i)?, at(i + 1)?])
}

/// Whether the corner at `i` is convex and its triangle holds no other vertex.
fn is_ear(vertices: &[Point2<f64>], i: usize) -> bool {
    let Some([a, b, c]) = corner(vertices, i) else { return false };
    if twice_area(&[a, b, c]) <= 0.0 {
        return false;
    }
    let holds = |p: &Point2<f64>| {
        *p != a && *p != b && *p != c && edges(&[a, b, c]).all(|(s, t)| (t - s).perp(&(p - s)) >= 0.0)
    };
    !vertices.iter().any(holds)
}

/// The corner whose triangle has the largest signed area.
fn widest(vertices: &[Point2<f64>]) -> usize {
    let area = |i: usize| corner(vertices, i).map_or(f64::NEG_INFINITY, |tile| twice_area(&tile));
    (0..vertices.len()).max_by(|&i, &j| area(i).total_cmp(&area(j)).then(j.cmp(&i))).unwrap_or(0)
}
