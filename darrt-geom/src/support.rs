//! Horizontal surfaces things rest on and are pushed across.
//!
//! Surfaces that lie flush, with no step and hardly a gap between them, are joined to one whose edge is that of all together:
//! [`SupportSurface::joined`].

mod joined;
mod polygon;

use crate::check;
use crate::error::GeomError;
use nalgebra::{Point2, Rotation2, Unit, Vector2};
use rand::RngExt as _;
use std::sync::Arc;

pub use joined::{FLUSH_GAP, FLUSH_HEIGHT, LEAST_SEAM};

/// Most vertices a surface may have.
pub const MAXIMUM_VERTICES: usize = 512;
/// How near to the boundary, in metres, a point counts as on it.
pub const ON_BOUNDARY: f64 = 1e-12;
/// How often [`SupportSurface::sample`] tries before it gives up.
const TRIES: usize = 1000;

/// A point of a surface's boundary.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EdgePoint {
    /// The point, world x and y.
    pub point: Point2<f64>,
    /// Unit normal of the edge, away from the surface.
    pub outward: Unit<Vector2<f64>>,
    /// Which edge, in the order of [`SupportSurface::edges`].
    pub edge: usize,
    /// Distance in metres from the point asked about (never negative).
    pub distance: f64,
}

/// A straight part of a surface's boundary; the surface lies on its left.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Edge {
    /// Where it begins, world x and y.
    pub start: Point2<f64>,
    /// Where it ends.
    pub end: Point2<f64>,
    /// Unit normal away from the surface.
    pub outward: Unit<Vector2<f64>>,
}

impl Edge {
    fn new((start, end): (Point2<f64>, Point2<f64>)) -> Self {
        let along = end - start;
        Self { start, end, outward: Unit::new_normalize(Vector2::new(along.y, -along.x)) }
    }
}

/// A horizontal surface at one height: a simple polygon in world x and y (convex or not), or several joined.
#[derive(Debug, Clone, PartialEq)]
pub struct SupportSurface {
    name: Arc<str>,
    height: f64,
    /// Simple polygons, counter-clockwise, whose union is the surface.
    pieces: Vec<Vec<Point2<f64>>>,
    /// The boundary: of a single polygon its sides in order, from the first vertex.
    edges: Vec<Edge>,
    /// Triangles that tile the pieces, each with the area of itself and all before it.
    tiles: Vec<([Point2<f64>; 3], f64)>,
}

impl SupportSurface {
    /// A surface with the given boundary (world x and y, metres, either orientation) at height `z`.
    ///
    /// # Errors
    /// When the name is empty; when there are fewer than 3 or more than [`MAXIMUM_VERTICES`] vertices; when a number is not
    /// finite or beyond 1e4 m; when an edge is shorter than 1e-6 m; when two edges touch or cross; when the area is below
    /// 1e-9 m^2.
    pub fn new(name: impl Into<Arc<str>>, vertices: &[Point2<f64>], z: f64) -> Result<Self, GeomError> {
        let name = name.into();
        if name.is_empty() {
            return Err(GeomError::EmptyName { what: "support surface" });
        }
        check::coordinate(format_args!("height of `{name}`"), z)?;
        check::count(format_args!("vertices of `{name}`"), vertices.len(), 3, MAXIMUM_VERTICES)?;
        let vertices = polygon::normalise(&name, vertices)?;
        let edges = polygon::edges(&vertices).map(Edge::new).collect();
        Ok(Self::of_pieces(name, z, vec![vertices], edges))
    }

    /// A surface of sound pieces with this boundary.
    fn of_pieces(name: Arc<str>, height: f64, pieces: Vec<Vec<Point2<f64>>>, edges: Vec<Edge>) -> Self {
        let mut total = 0.0;
        let tiles = pieces
            .iter()
            .flat_map(|piece| polygon::triangulate(piece))
            .map(|tile| {
                total += polygon::twice_area(&tile).abs() / 2.0;
                (tile, total)
            })
            .collect();
        Self { name, height, pieces, edges, tiles }
    }

    /// A rectangle with full side lengths `size`, turned by `yaw` about its `centre`.
    ///
    /// # Errors
    /// When the name is empty, a number is not finite or out of range (lengths in `[1e-6, 1e4]` m).
    pub fn rectangle(
        name: impl Into<Arc<str>>,
        centre: Point2<f64>,
        size: Vector2<f64>,
        yaw: f64,
        z: f64,
    ) -> Result<Self, GeomError> {
        let name = name.into();
        for length in size.iter() {
            check::length(format_args!("side of `{name}`"), *length)?;
        }
        check::coordinate(format_args!("yaw of `{name}`"), yaw)?;
        let turn = Rotation2::new(yaw);
        let half = size / 2.0;
        let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
            .map(|(sx, sy)| centre + turn * Vector2::new(sx * half.x, sy * half.y));
        Self::new(name, &corners, z)
    }

    /// What the surface is called.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Height of the surface above the floor (world z).
    pub fn height(&self) -> f64 {
        self.height
    }

    /// The boundary; of a single polygon counter-clockwise from its first vertex, of a joined surface in no particular order.
    pub fn edges(&self) -> &[Edge] {
        &self.edges
    }

    /// Where the edges begin: of a single polygon its vertices, counter-clockwise.
    pub fn vertices(&self) -> impl DoubleEndedIterator<Item = Point2<f64>> + ExactSizeIterator + '_ {
        self.edges.iter().map(|edge| edge.start)
    }

    /// Area in square metres; what two joined polygons share counts twice.
    pub fn area(&self) -> f64 {
        self.tiles.last().map_or(0.0, |tile| tile.1)
    }

    /// Corners `(minimum, maximum)` of the axis-aligned rectangle around the surface.
    pub fn bounds(&self) -> (Point2<f64>, Point2<f64>) {
        let first = self.vertices().next().unwrap_or_else(Point2::origin);
        self.vertices().fold((first, first), |(low, high), p| (low.inf(&p), high.sup(&p)))
    }

    /// Whether the point lies over the surface; its boundary (to [`ON_BOUNDARY`]) belongs to it.
    pub fn contains(&self, p: &Point2<f64>) -> bool {
        self.is_inside(p) || self.nearest_edge_point(p).distance <= ON_BOUNDARY
    }

    /// Signed distance in metres to the boundary: positive over the surface, negative beside it.
    pub fn depth(&self, p: &Point2<f64>) -> f64 {
        let distance = self.nearest_edge_point(p).distance;
        if distance <= ON_BOUNDARY || self.is_inside(p) { distance } else { -distance }
    }

    /// Whether the point lies inside; points of the boundary may go either way, points of a seam are inside.
    fn is_inside(&self, p: &Point2<f64>) -> bool {
        match &self.pieces[..] {
            [only] => polygon::winds_around(only, p),
            pieces => pieces.iter().any(|piece| joined::holds(piece, p)),
        }
    }

    /// The boundary point nearest to `p`; of several the one on the edge with the smallest index.
    pub fn nearest_edge_point(&self, p: &Point2<f64>) -> EdgePoint {
        let mut best = EdgePoint { point: *p, outward: Vector2::x_axis(), edge: 0, distance: f64::INFINITY };
        for (edge, Edge { start: a, end: b, outward }) in self.edges.iter().enumerate() {
            let along = b - a;
            let t = ((p - a).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
            let point = a + along * t;
            let distance = (p - point).norm();
            if distance < best.distance {
                best = EdgePoint { point, outward: *outward, edge, distance };
            }
        }
        best
    }

    /// Where the ray from `from` along `direction` first leaves the surface; `None` when `from` is not over it.
    ///
    /// Only edges the ray leaves through count (`direction . outward > 0`). Passing exactly through a reentrant corner may
    /// count as leaving.
    pub fn first_crossing(&self, from: &Point2<f64>, direction: &Unit<Vector2<f64>>) -> Option<EdgePoint> {
        /// Slack along an edge, as a fraction of it, so that no ray slips between two edges.
        const SLACK: f64 = 1e-9;
        if !self.contains(from) {
            return None;
        }
        let mut best: Option<EdgePoint> = None;
        for (edge, Edge { start: a, end: b, outward }) in self.edges.iter().enumerate() {
            let leaving = direction.dot(outward);
            if leaving <= 1e-12 {
                continue;
            }
            let distance = (a - from).dot(outward) / leaving;
            let along = b - a;
            let fraction = (from + direction.as_ref() * distance - a).dot(&along) / along.norm_squared();
            let ahead = distance >= -1e-9 && (-SLACK..=1.0 + SLACK).contains(&fraction);
            if ahead && best.is_none_or(|b| distance < b.distance) {
                let point = a + along * fraction.clamp(0.0, 1.0);
                best = Some(EdgePoint { point, outward: *outward, edge, distance: distance.max(0.0) });
            }
        }
        best
    }

    /// How far a disc sticks out over the edge at its worst point (metres, 0 when the disc is wholly over the surface).
    ///
    /// Defined as `max(0, radius - depth(centre))`. For a convex surface this is exactly the greatest distance of any point
    /// of the disc from the surface: the distance of q is the greatest of `n . q - h(n)` over unit normals n with
    /// support function h, and over the disc that is `radius - min (h(n) - n . centre)`, whose minimum is the depth. On a
    /// surface with reentrant corners it is an upper bound, because the disc may reach across a notch.
    pub fn overhang(&self, centre: &Point2<f64>, radius: f64) -> f64 {
        (radius - self.depth(centre)).max(0.0)
    }

    /// A point drawn uniformly from those at least `inset` metres inside the boundary (twice as often from what two joined
    /// polygons share); `None` when a thousand draws found none (the surface is too narrow, or `inset` is NaN).
    pub fn sample(&self, rng: &mut dyn rand::Rng, inset: f64) -> Option<Point2<f64>> {
        (0..TRIES).map(|_| self.draw(rng)).find(|p| self.depth(p) >= inset)
    }

    /// A point drawn uniformly from the whole surface.
    fn draw(&self, rng: &mut dyn rand::Rng) -> Point2<f64> {
        let at = rng.random::<f64>() * self.area();
        let index = self.tiles.partition_point(|tile| tile.1 <= at).min(self.tiles.len().saturating_sub(1));
        let (mut u, mut v) = (rng.random::<f64>(), rng.random::<f64>());
        if u + v > 1.0 {
            (u, v) = (1.0 - u, 1.0 - v);
        }
        self.tiles.get(index).map_or_else(Point2::origin, |([a, b, c], _)| a + (b - a) * u + (c - a) * v)
    }
}

#[cfg(test)]
mod tests;
