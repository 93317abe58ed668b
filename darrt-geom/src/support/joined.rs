//! Surfaces that lie flush, as one: a push goes on across the seam between two tables, and only the outer edge counts.
//!
//! The gap of a seam is filled, so that the joined surface is a union of polygons without slits. Its boundary is what is left
//! of their sides when everything has gone that has another of them right behind it.

use super::{Edge, SupportSurface, polygon};
use crate::check;
use crate::error::GeomError;
use nalgebra::{Point2, Vector2};
use std::sync::Arc;

/// Surfaces whose heights differ by no more than this may lie flush, metres. A step of more is one that what is pushed may
/// catch on.
pub const FLUSH_HEIGHT: f64 = 1e-4;
/// The widest gap between two surfaces that lie flush, metres.
pub const FLUSH_GAP: f64 = 2e-3;
/// The shortest seam that joins two surfaces, metres: tables that touch at a corner are two.
pub const LEAST_SEAM: f64 = 0.01;

/// Most surfaces that are joined to one.
const MOST_PIECES: usize = 64;
/// Sides run along each other when the sine of the angle between them is at most this (about 6 degrees).
const ALONG: f64 = 0.1;
/// How far behind a side another polygon is looked for, metres; shorter sides than a hundredth of it are dropped.
const BEHIND: f64 = 1e-7;
/// Points this near to a polygon count as in it where only rounding could tell, metres.
const ROUNDING: f64 = 1e-9;

/// Whether the closed polygon has the point in it, up to [`ROUNDING`].
pub(super) fn holds(piece: &[Point2<f64>], p: &Point2<f64>) -> bool {
    polygon::winds_around(piece, p) || polygon::edges(piece).any(|(a, b)| distance(&a, &b, p) <= ROUNDING)
}

/// Distance of a point from a segment that is not a point.
fn distance(a: &Point2<f64>, b: &Point2<f64>, p: &Point2<f64>) -> f64 {
    let along = b - a;
    let t = ((p - a).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
    (p - (a + along * t)).norm()
}

impl SupportSurface {
    /// Whether this surface and another lie flush: heights within [`FLUSH_HEIGHT`], and a seam of at least [`LEAST_SEAM`] along
    /// which they overlap or are no farther apart than [`FLUSH_GAP`].
    pub fn is_flush_with(&self, other: &Self) -> bool {
        if (self.height - other.height).abs() > FLUSH_HEIGHT {
            return false;
        }
        let mut pieces: Vec<_> = self.pieces.iter().chain(&other.pieces).cloned().collect();
        let counts = [self.pieces.len(), pieces.len()];
        fill_gaps(&mut pieces);
        let length = |edges: &[Edge]| edges.iter().map(|edge| (edge.end - edge.start).norm()).sum::<f64>();
        let lost = |surface: &Self, own: std::ops::Range<usize>| {
            length(&surface.edges) - length(&own.flat_map(|piece| outer_edges(&pieces, piece)).collect::<Vec<_>>())
        };
        // A surface within another has all of its edge inside, the other none; two that are alike have the same middle.
        lost(self, 0..counts[0]).max(lost(other, counts[0]..counts[1])) >= LEAST_SEAM || other.contains(&self.middle())
    }

    /// Which surfaces lie flush, directly or by way of others of them: groups of indices, ascending, in the order of their
    /// first ones.
    pub fn flush_groups(surfaces: &[&Self]) -> Vec<Vec<usize>> {
        let mut groups: Vec<Vec<usize>> = Vec::new();
        for (index, surface) in surfaces.iter().enumerate() {
            let meets = |group: &Vec<usize>| {
                group.iter().filter_map(|other| surfaces.get(*other)).any(|other| surface.is_flush_with(other))
            };
            let (mut met, mut others): (Vec<_>, Vec<_>) = std::mem::take(&mut groups).into_iter().partition(meets);
            met.push(vec![index]);
            let mut group: Vec<usize> = met.into_iter().flatten().collect();
            group.sort_unstable();
            others.push(group);
            others.sort_unstable();
            groups = others;
        }
        groups
    }

    /// The middle of the first tile.
    fn middle(&self) -> Point2<f64> {
        self.tiles
            .first()
            .map_or_else(Point2::origin, |([a, b, c], _)| Point2::from((a.coords + b.coords + c.coords) / 3.0))
    }

    /// The union of surfaces as one, at the height of the highest: gaps of at most [`FLUSH_GAP`] along sides that face each other
    /// are filled, and what is then no longer an edge of the whole is none. Heights are not compared.
    ///
    /// # Laws
    /// A surface that is cut into pieces, at most [`FLUSH_GAP`] of it lost in each cut, and joined again has the depths, nearest
    /// edge points and crossings of the whole. A point is over the union exactly when it is over a part or in a filled gap.
    ///
    /// # Errors
    /// When the name is empty, or there are no surfaces or more than 64.
    pub fn joined(name: impl Into<Arc<str>>, surfaces: &[&Self]) -> Result<Self, GeomError> {
        let name = name.into();
        if name.is_empty() {
            return Err(GeomError::EmptyName { what: "support surface" });
        }
        let mut pieces: Vec<_> = surfaces.iter().flat_map(|surface| surface.pieces.iter().cloned()).collect();
        check::count(format_args!("surfaces joined to `{name}`"), pieces.len(), 1, MOST_PIECES)?;
        let height = surfaces.iter().map(|surface| surface.height).fold(f64::NEG_INFINITY, f64::max);
        if let [only] = surfaces {
            return Ok(Self { name, ..(*only).clone() });
        }
        fill_gaps(&mut pieces);
        let edges = (0..pieces.len()).flat_map(|piece| outer_edges(&pieces, piece)).collect();
        Ok(Self::of_pieces(name, height, pieces, edges))
    }
}

/// Adds a polygon for every gap between two sides that face each other.
fn fill_gaps(pieces: &mut Vec<Vec<Point2<f64>>>) {
    let mut gaps = Vec::new();
    for (i, piece) in pieces.iter().enumerate() {
        for other in pieces.iter().skip(i + 1) {
            for side in polygon::edges(piece).map(Edge::new) {
                gaps.extend(polygon::edges(other).filter_map(|facing| gap(&side, &Edge::new(facing))));
            }
        }
    }
    pieces.extend(gaps);
}

/// The polygon between two sides where they face each other across a gap, counter-clockwise.
fn gap(side: &Edge, facing: &Edge) -> Option<Vec<Point2<f64>>> {
    let opposite = -side.outward.dot(&facing.outward);
    if opposite <= 0.0 || side.outward.perp(&facing.outward).abs() > ALONG {
        return None;
    }
    let along = side.end - side.start;
    // At `t` along the side the other line is `width_m(t)` away across it, which is linear in `t`.
    let width = |t: f64| (side.start + along * t - facing.start).dot(&facing.outward) / opposite;
    let place = |p: &Point2<f64>| (p - side.start).dot(&along) / along.norm_squared();
    let (mut low, mut high) = (place(&facing.end).max(0.0), place(&facing.start).min(1.0));
    let (at_start, per_t) = (width(0.0), width(1.0) - width(0.0));
    for bound in [0.0, FLUSH_GAP + ROUNDING] {
        // Where the width is on the right side of the bound: all of the side, none of it, or up to one point.
        let crossing = (bound - at_start) / per_t;
        let is_kept = |t: f64| if bound > 0.0 { width(t) <= bound } else { width(t) >= bound };
        match (is_kept(low), is_kept(high)) {
            (true, true) => {}
            (false, false) => return None,
            (true, false) => high = high.min(crossing),
            (false, true) => low = low.max(crossing),
        }
    }
    if (high - low) * along.norm() < BEHIND {
        return None;
    }
    let at = |t: f64| side.start + along * t;
    let across = |t: f64| at(t) + side.outward.into_inner() * width(t);
    let mut corners = vec![at(high), at(low), across(low), across(high)];
    corners.dedup_by(|a, b| (*a - *b).norm() < ROUNDING);
    if corners.len() > 1 && corners.first().zip(corners.last()).is_some_and(|(a, b)| (a - b).norm() < ROUNDING) {
        corners.pop();
    }
    (corners.len() > 2).then_some(corners)
}

/// What is left of the sides of one piece when everything has gone that has another piece right behind it.
fn outer_edges(pieces: &[Vec<Point2<f64>>], own: usize) -> Vec<Edge> {
    let mut edges = Vec::new();
    for (a, b) in pieces.get(own).iter().flat_map(|piece| polygon::edges(piece)) {
        let along = b - a;
        if along.norm() < BEHIND / 100.0 {
            continue;
        }
        let edge = Edge::new((a, b));
        let others = || pieces.iter().enumerate().filter(|(i, _)| *i != own).map(|(_, piece)| piece);
        let mut cuts: Vec<f64> = others().flat_map(|piece| cuts(&edge, piece)).chain([0.0, 1.0]).collect();
        cuts.sort_by(f64::total_cmp);
        // A cut that cuts nothing off would only make two edges of one, so what is left is put together again.
        let mut runs: Vec<[f64; 2]> = Vec::new();
        let is_tiny = |share: f64| share * along.norm() < BEHIND / 100.0;
        for part in cuts.windows(2) {
            let &[from, to] = part else { continue };
            let behind = a + along * f64::midpoint(from, to) + edge.outward.into_inner() * BEHIND;
            if is_tiny(to - from) || others().any(|piece| holds(piece, &behind)) {
                continue;
            }
            match runs.last_mut() {
                Some([_, end]) if is_tiny(from - *end) => *end = to,
                _ => runs.push([from, to]),
            }
        }
        let point = |t: f64| if t >= 1.0 { b } else { a + along * t };
        edges.extend(runs.iter().map(|&[from, to]| Edge { start: point(from), end: point(to), outward: edge.outward }));
    }
    edges
}

/// Where along an edge (0 at its start, 1 at its end) the outline of another piece crosses it or ends on it.
fn cuts(edge: &Edge, piece: &[Point2<f64>]) -> Vec<f64> {
    let along = edge.end - edge.start;
    let beyond = |p: &Point2<f64>| (p - edge.start).dot(&edge.outward);
    let place = |p: &Point2<f64>| (p - edge.start).dot(&along) / along.norm_squared();
    let mut found = Vec::new();
    for (c, d) in polygon::edges(piece) {
        let (of_c, of_d) = (beyond(&c), beyond(&d));
        if of_c.abs() <= BEHIND {
            found.push(place(&c));
        }
        if (of_c > 0.0) != (of_d > 0.0) {
            let way: Vector2<f64> = d - c;
            found.push(place(&(c + way * (of_c / (of_c - of_d)))));
        }
    }
    found.retain(|t| (0.0..=1.0).contains(t));
    found
}

#[cfg(test)]
mod tests;
