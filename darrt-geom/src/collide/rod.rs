//! A cylinder (or, with radius 0, a segment) against a box.

use super::pair::diagonal;
use crate::batch::PlacedBox;
use nalgebra::Vector3;

/// A lower bound of the distance between a cylinder along its own z and a box; may be negative though they are apart.
///
/// Three views, each a lower bound: the box's frame, where the cylinder's exact shadow on each axis is known; along and across
/// the cylinder's axis, where the direction across is that of the box's point nearest to the cylinder's centre. Exact for
/// an upright cylinder beside, above or diagonally above an upright box.
pub(super) fn to_box(rod: &PlacedBox, radius: f64, half_height: f64, other: &PlacedBox) -> f64 {
    let axis: Vector3<f64> = rod.axes.column(2).into_owned();
    let apart = rod.centre - other.centre;
    let t = other.axes.tr_mul(&apart);
    let u = other.axes.tr_mul(&axis);
    let shadow = u.map(|c| half_height * c.abs() + radius * (1.0 - c * c).max(0.0).sqrt());
    let in_box = diagonal(&(t.abs() - other.half - shadow));
    let along = t.dot(&u).abs() - half_height - other.half.dot(&u.abs());
    // From the cylinder's centre to the nearest point of the box, without its part along the axis; box frame.
    let nearest = t.sup(&-other.half).inf(&other.half) - t;
    let across = nearest - u * nearest.dot(&u);
    let Some(direction) = across.try_normalize(1e-9) else {
        return in_box.max(along);
    };
    let beside = -t.dot(&direction) - radius - other.half.dot(&direction.abs());
    let in_rod = if along <= 0.0 || beside <= 0.0 { along.max(beside) } else { along.hypot(beside) };
    in_box.max(in_rod)
}
