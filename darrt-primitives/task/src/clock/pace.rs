//! How fast a phase is gone: bounds of the single number `s` from those of everything that moves with it.
//!
//! Along a way `q(s)` gone at speed `v`, acceleration `a` and jerk `j` of `s`, every quantity has the speed `q' v`, the
//! acceleration `q'' v^2 + q' a` and the jerk `q''' v^3 + 3 q'' v a + q' j`. On a straight line the derivatives above the first are
//! zero and `s` has all of the bounds; in a corner they are shared between the curve and the change of pace.
//!
//! A way is cut into stretches on which the bounds of `s` are constant, and each is gone in a double-S profile; where two meet, the
//! acceleration is zero. A way of many short pieces is one stretch, with the least bounds of all; pieces that are much slower than
//! the others are cut out, as long as that saves time.

use super::limits::Bounds;
use super::profile::{Pieces, between, reachable, seconds};

/// What part of an acceleration a corner may spend on its curve.
const CURVE_ACCELERATION: f64 = 0.5;
/// What part of a jerk it may spend on its curve, and as much on the curve while the pace changes.
const CURVE_JERK: f64 = 1.0 / 3.0;
/// Savings below this are not worth a cut, seconds.
const WORTH_S: f64 = 1e-6;

/// Something that is bounded along a piece: the largest sizes of its derivatives with respect to the length gone.
#[derive(Debug, Clone, Copy)]
pub(super) struct Channel {
    pub(super) first: f64,
    pub(super) second: f64,
    pub(super) third: f64,
    pub(super) bounds: Bounds,
}

/// A piece of a way: a straight line or a corner.
#[derive(Debug, Clone, Default)]
pub(super) struct Piece {
    pub(super) length: f64,
    pub(super) channels: Vec<Channel>,
}

/// The bounds of `s` over these pieces.
fn bounds_of(pieces: &[Piece]) -> Bounds {
    let channels = || pieces.iter().flat_map(|piece| &piece.channels);
    let least = |of: &dyn Fn(&Channel) -> f64| channels().map(of).fold(f64::INFINITY, f64::min);
    let velocity = least(&|c| {
        let by_acceleration = (CURVE_ACCELERATION * c.bounds.acceleration / c.second).sqrt();
        let by_jerk = (CURVE_JERK * c.bounds.jerk / c.third).cbrt();
        (c.bounds.velocity / c.first).min(by_acceleration).min(by_jerk)
    });
    let acceleration = least(&|c| {
        let left = (c.bounds.acceleration - c.second * velocity * velocity) / c.first;
        left.min(CURVE_JERK * c.bounds.jerk / (3.0 * c.second * velocity))
    });
    let jerk = least(&|c| {
        let curve = c.third * velocity.powi(3) + 3.0 * c.second * velocity * acceleration;
        (c.bounds.jerk - curve) / c.first
    });
    Bounds { velocity, acceleration, jerk }
}

/// Pieces `from..to` that are gone in one profile.
#[derive(Debug, Clone)]
struct Stretch {
    from: usize,
    to: usize,
    length: f64,
    bounds: Bounds,
}

impl Stretch {
    fn of(pieces: &[Piece], from: usize, to: usize) -> Self {
        let own = pieces.get(from..to).unwrap_or_default();
        Self { from, to, length: own.iter().map(|piece| piece.length).sum(), bounds: bounds_of(own) }
    }
}

/// The speeds at the ends of the stretches, from rest to rest.
fn speeds(stretches: &[Stretch]) -> Vec<f64> {
    let mut speeds = vec![0.0; stretches.len() + 1];
    let caps = stretches.windows(2).map(|pair| pair.iter().map(|s| s.bounds.velocity).fold(f64::INFINITY, f64::min));
    for (slot, cap) in speeds.iter_mut().skip(1).zip(caps) {
        *slot = cap;
    }
    for (i, stretch) in stretches.iter().enumerate() {
        let reach = reachable(speeds[i], stretch.length, &stretch.bounds);
        speeds[i + 1] = speeds[i + 1].min(reach);
    }
    for (i, stretch) in stretches.iter().enumerate().rev() {
        let reach = reachable(speeds[i + 1], stretch.length, &stretch.bounds);
        speeds[i] = speeds[i].min(reach);
    }
    speeds
}

fn total_s(stretches: &[Stretch]) -> f64 {
    let speeds = speeds(stretches);
    let ends = speeds.iter().zip(speeds.iter().skip(1));
    stretches.iter().zip(ends).map(|(s, (from, to))| seconds(*from, *to, s.length, &s.bounds)).sum()
}

/// The fastest profile over these pieces that this method finds, from rest to rest.
pub(super) fn profile(pieces: &[Piece]) -> Pieces {
    let mut stretches = vec![Stretch::of(pieces, 0, pieces.len())];
    let mut best_s = total_s(&stretches);
    let mut at = 0;
    while let Some(stretch) = stretches.get(at).cloned() {
        let cut = cuts(pieces, &stretch).into_iter().filter_map(|parts| {
            let mut tried = stretches.clone();
            tried.splice(at..=at, parts);
            let seconds = total_s(&tried);
            (seconds < best_s - WORTH_S).then_some((seconds, tried))
        });
        match cut.min_by(|a, b| a.0.total_cmp(&b.0)) {
            Some((seconds, tried)) => (best_s, stretches) = (seconds, tried),
            None => at += 1,
        }
    }
    let speeds = speeds(&stretches);
    let ends = speeds.iter().zip(speeds.iter().skip(1));
    stretches.iter().zip(ends).flat_map(|(s, (from, to))| between(*from, *to, s.length, &s.bounds)).collect()
}

/// The stretch with one of its slowest pieces cut out: that of the least speed, of the least acceleration, of the least jerk.
fn cuts(pieces: &[Piece], stretch: &Stretch) -> Vec<Vec<Stretch>> {
    let Stretch { from, to, .. } = *stretch;
    if to - from < 2 {
        return Vec::new();
    }
    let own: Vec<Bounds> = (from..to).map(|i| bounds_of(pieces.get(i..=i).unwrap_or_default())).collect();
    let least = |of: &dyn Fn(&Bounds) -> f64| {
        (from..to).zip(&own).min_by(|a, b| of(a.1).total_cmp(&of(b.1))).map_or(from, |(i, _)| i)
    };
    let mut worst = vec![least(&|b| b.velocity), least(&|b| b.acceleration), least(&|b| b.jerk)];
    worst.sort_unstable();
    worst.dedup();
    let parts = |piece: usize| {
        let ranges = [(from, piece), (piece, piece + 1), (piece + 1, to)];
        let ranges = ranges.into_iter().filter(|(from, to)| from < to);
        ranges.map(|(from, to)| Stretch::of(pieces, from, to)).collect()
    };
    worst.into_iter().map(parts).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(length: f64, first: f64) -> Piece {
        let bounds = Bounds::new(1.0, 1.0, 1.0);
        Piece { length, channels: vec![Channel { first, second: 0.0, third: 0.0, bounds }] }
    }

    fn seconds_of(pieces: &[Piece]) -> f64 {
        profile(pieces).iter().map(|[seconds, _]| seconds).sum()
    }

    #[test]
    fn one_line_is_a_double_s() {
        assert!((seconds_of(&[line(4.0, 1.0)]) - 6.0).abs() < 1e-9);
        // Cut into pieces it is the same line.
        assert!((seconds_of(&[line(1.0, 1.0), line(2.5, 1.0), line(0.5, 1.0)]) - 6.0).abs() < 1e-9);
    }

    #[test]
    fn a_slow_piece_slows_only_itself() {
        let slow = [line(10.0, 1.0), line(0.1, 4.0), line(10.0, 1.0)];
        let all = seconds_of(&slow);
        let stops = 2.0 * seconds_of(&slow[..1]) + seconds_of(&slow[1..2]);
        let evenly = seconds_of(&[line(20.1, 4.0)]);
        assert!(all < stops && all < evenly, "{all}: with stops {stops}, evenly {evenly}");
    }

    #[test]
    fn corners_leave_their_share_of_the_bounds() {
        let bounds = Bounds::new(1.0, 2.0, 6.0);
        let corner = Piece { length: 1.0, channels: vec![Channel { first: 1.0, second: 3.0, third: 5.0, bounds }] };
        let Bounds { velocity: v, acceleration: a, jerk: j } = bounds_of(&[corner]);
        assert!(3.0 * v * v + a <= 2.0 + 1e-12 && 5.0 * v.powi(3) + 9.0 * v * a + j <= 6.0 + 1e-12, "{v} {a} {j}");
        assert!(v > 0.1 && a > 0.1 && j > 0.1);
    }
}
