//! Closed-form lower bounds of the distance between two placed solids.

use super::rod;
use super::solid::{Kind, Solid};
use crate::batch::PlacedBox;
use nalgebra::{Matrix3, Vector3};

/// Squared sine below which two edges count as parallel; then the face normals alone separate.
const PARALLEL: f64 = 1e-8;

/// A lower bound and what it is worth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Bound {
    /// The distance itself; not positive exactly when they touch or overlap.
    Exact(f64),
    /// Positive exactly when they are apart, but perhaps less than the distance.
    Signed(f64),
    /// Perhaps not positive though they are apart.
    Loose(f64),
}

impl Bound {
    pub(super) fn value(self) -> f64 {
        match self {
            Self::Exact(value) | Self::Signed(value) | Self::Loose(value) => value,
        }
    }
}

/// A lower bound of the distance; as soon as it reaches `enough`, it is not tightened any more.
pub(super) fn bound(a: &Solid, placed_a: &PlacedBox, b: &Solid, placed_b: &PlacedBox, enough: f64) -> Bound {
    match (a.kind, b.kind) {
        (Kind::Sphere, Kind::Sphere) => Bound::Exact((placed_b.centre - placed_a.centre).norm() - a.radius - b.radius),
        (Kind::Sphere, kind) => ball_bound(placed_a, a.radius, kind, placed_b),
        (kind, Kind::Sphere) => ball_bound(placed_b, b.radius, kind, placed_a),
        (Kind::Cuboid, Kind::Cuboid) => Bound::Signed(boxes(placed_a, placed_b, enough)),
        (Kind::Cylinder(radius, half_height), Kind::Cuboid | Kind::Wrapped) => {
            Bound::Loose(rod::to_box(placed_a, radius, half_height, placed_b))
        }
        (Kind::Cuboid | Kind::Wrapped, Kind::Cylinder(radius, half_height)) => {
            Bound::Loose(rod::to_box(placed_b, radius, half_height, placed_a))
        }
        (Kind::Capsule(radius, half_height), Kind::Cuboid | Kind::Wrapped) => {
            Bound::Loose(rod::to_box(placed_a, 0.0, half_height, placed_b) - radius)
        }
        (Kind::Cuboid | Kind::Wrapped, Kind::Capsule(radius, half_height)) => {
            Bound::Loose(rod::to_box(placed_b, 0.0, half_height, placed_a) - radius)
        }
        _ => Bound::Loose(boxes(placed_a, placed_b, enough)),
    }
}

/// A ball against anything but a ball.
fn ball_bound(ball: &PlacedBox, radius: f64, kind: Kind, other: &PlacedBox) -> Bound {
    match kind {
        Kind::Cylinder(other_radius, half_height) => {
            let local = other.axes.tr_mul(&(ball.centre - other.centre));
            let beside = (local.x.hypot(local.y) - other_radius).max(0.0);
            let above = (local.z.abs() - half_height).max(0.0);
            Bound::Exact(beside.hypot(above) - radius)
        }
        Kind::Capsule(other_radius, half_height) => {
            let local = other.axes.tr_mul(&(ball.centre - other.centre));
            let above = (local.z.abs() - half_height).max(0.0);
            Bound::Exact(Vector3::new(local.x, local.y, above).norm() - radius - other_radius)
        }
        Kind::Wrapped => Bound::Loose(other.ball_distance(&ball.centre, radius)),
        Kind::Cuboid | Kind::Sphere => Bound::Exact(other.ball_distance(&ball.centre, radius)),
    }
}

/// What the gaps along three orthogonal axes say about the distance: their diagonal, or the largest when none is open.
#[inline]
pub(super) fn diagonal(gaps: &Vector3<f64>) -> f64 {
    let largest = gaps.max();
    if largest <= 0.0 { largest } else { gaps.map(|g| g.max(0.0)).norm() }
}

/// Separation of two boxes: positive exactly when they are apart, and then at most their distance.
///
/// In the frame of each box the other is wrapped in an aligned box; the distance of the two aligned boxes is a lower bound and
/// exact for parallel boxes. The nine edge-edge axes follow only when they could matter.
///
/// # Source
/// Separating axes: S. Gottschalk, M. C. Lin, D. Manocha, "`OBBTree`", 1996, section 5.
pub(super) fn boxes(a: &PlacedBox, b: &PlacedBox, enough: f64) -> f64 {
    let r = a.axes.tr_mul(&b.axes);
    let t = a.axes.tr_mul(&(b.centre - a.centre));
    let spread = r.abs();
    let in_a = t.abs() - a.half - spread * b.half;
    let in_b = r.tr_mul(&t).abs() - b.half - spread.tr_mul(&a.half);
    let faces = diagonal(&in_a).max(diagonal(&in_b));
    if faces >= enough {
        return faces;
    }
    faces.max(edges(&r, &spread, &t, &a.half, &b.half))
}

/// Largest gap along the nine products of edges.
fn edges(
    r: &Matrix3<f64>,
    spread: &Matrix3<f64>,
    t: &Vector3<f64>,
    half_a: &Vector3<f64>,
    half_b: &Vector3<f64>,
) -> f64 {
    let mut best = f64::NEG_INFINITY;
    for i in 0..3 {
        let (i1, i2) = ((i + 1) % 3, (i + 2) % 3);
        for j in 0..3 {
            let (j1, j2) = ((j + 1) % 3, (j + 2) % 3);
            let sine = r[(i1, j)] * r[(i1, j)] + r[(i2, j)] * r[(i2, j)];
            if sine < PARALLEL {
                continue;
            }
            let apart = (t[i2] * r[(i1, j)] - t[i1] * r[(i2, j)]).abs();
            let of_a = half_a[i1] * spread[(i2, j)] + half_a[i2] * spread[(i1, j)];
            let of_b = half_b[j1] * spread[(i, j2)] + half_b[j2] * spread[(i, j1)];
            best = best.max((apart - of_a - of_b) / sine.sqrt());
        }
    }
    best
}
