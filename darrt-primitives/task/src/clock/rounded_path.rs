//! The way of a phase: straight lines between its knots, with rounded corners.
//!
//! On a line of length `l` from `a` to `b` the point is `a + (s / l) (b - a)`. Around a knot `k` at which the direction changes
//! from `d1` to `d2` (change per length), from `s` of the knot less `r` to `s` of the knot and `r`, the direction goes over from
//! one to the other: `d1 + (d2 - d1) (3 u^2 - 2 u^3)` with `u` from 0 to 1, so the point is
//! `k - r d1 + 2 r (d1 u + (d2 - d1) (u^3 - u^4 / 2))`. It passes the knot at `3/16 r |d2 - d1|`. Direction and curvature are
//! continuous, so speed, acceleration and jerk are bounded.

use crate::plan_file::timing::Phase;

/// A point of a way and its derivatives with respect to the length gone.
#[derive(Debug, Clone, Default)]
pub(crate) struct Spot {
    pub(crate) point: Vec<f64>,
    pub(crate) first: Vec<f64>,
    pub(crate) second: Vec<f64>,
}

/// The way of a phase.
#[derive(Debug, Clone)]
pub(crate) struct RoundedPath {
    knots: Vec<Vec<f64>>,
    lengths: Vec<f64>,
    /// Radius at every inner knot.
    blends: Vec<f64>,
    /// The length gone at every knot.
    marks: Vec<f64>,
}

/// A corner: directions before and after it.
#[derive(Debug)]
pub(crate) struct Corner {
    pub(crate) before: Vec<f64>,
    pub(crate) after: Vec<f64>,
}

impl RoundedPath {
    /// The way through these points; `lengths` are those of the lines, `blends` the radii at the inner knots.
    pub(crate) fn new(knots: Vec<Vec<f64>>, lengths: Vec<f64>, blends: Vec<f64>) -> Self {
        let mut gone = 0.0;
        let mut marks = vec![gone];
        for length in &lengths {
            gone += length;
            marks.push(gone);
        }
        Self { knots, lengths, blends, marks }
    }

    /// The way of a phase of a step with these points.
    pub(crate) fn of(phase: &Phase, points: &[Vec<f64>]) -> Self {
        let knots = phase.knots.iter().filter_map(|knot| points.get(*knot).cloned()).collect();
        Self::new(knots, phase.lengths.clone(), phase.blends.clone())
    }

    pub(crate) fn length(&self) -> f64 {
        self.marks.last().copied().unwrap_or(0.0)
    }

    pub(crate) fn lengths(&self) -> &[f64] {
        &self.lengths
    }

    /// The length gone at every knot.
    pub(crate) fn marks(&self) -> &[f64] {
        &self.marks
    }

    /// The radius at a knot; zero at the ends.
    pub(crate) fn radius(&self, knot: usize) -> f64 {
        knot.checked_sub(1).and_then(|inner| self.blends.get(inner)).copied().unwrap_or(0.0)
    }

    /// The change of the point per length along a line.
    pub(crate) fn direction(&self, line: usize) -> Vec<f64> {
        match (self.knots.get(line), self.knots.get(line + 1), self.lengths.get(line)) {
            (Some(a), Some(b), Some(length)) => a.iter().zip(b).map(|(a, b)| (b - a) / length).collect(),
            _ => Vec::new(),
        }
    }

    pub(crate) fn corner(&self, knot: usize) -> Corner {
        Corner { before: self.direction(knot.saturating_sub(1)), after: self.direction(knot) }
    }

    /// The point when `s` has been gone, and its derivatives; within the way.
    pub(crate) fn at(&self, s: f64) -> Spot {
        let last = self.lengths.len().saturating_sub(1);
        let s = s.clamp(0.0, self.length());
        let line = self.marks.partition_point(|mark| *mark <= s).saturating_sub(1).min(last);
        let Some(begin) = self.marks.get(line) else { return Spot::default() };
        let end = self.marks.get(line + 1).copied().unwrap_or(*begin);
        for (knot, mark) in [(line, *begin), (line + 1, end)] {
            let radius = self.radius(knot);
            if radius > 0.0 && (s - mark).abs() < radius {
                return self.rounded(knot, radius, s - mark);
            }
        }
        let first = self.direction(line);
        let from = self.knots.get(line).map(Vec::as_slice).unwrap_or_default();
        let mut point: Vec<f64> = from.iter().zip(&first).map(|(from, way)| from + (s - begin) * way).collect();
        if s >= end
            && let Some(knot) = self.knots.get(line + 1)
        {
            point.clone_from(knot);
        }
        Spot { point, second: vec![0.0; first.len()], first }
    }

    /// The same `ahead` of a knot with this radius, between minus the radius and the radius.
    fn rounded(&self, knot: usize, radius: f64, ahead: f64) -> Spot {
        let Corner { before, after } = self.corner(knot);
        let at = self.knots.get(knot).map(Vec::as_slice).unwrap_or_default();
        let u = (ahead + radius) / (2.0 * radius);
        let (share, gone) = (u * u * (3.0 - 2.0 * u), u * u * u * (1.0 - u / 2.0));
        let bend = 6.0 * u * (1.0 - u) / (2.0 * radius);
        let mut spot = Spot::default();
        for ((at, d1), d2) in at.iter().zip(&before).zip(&after) {
            let change = d2 - d1;
            spot.point.push(at - radius * d1 + 2.0 * radius * (d1 * u + change * gone));
            spot.first.push(d1 + change * share);
            spot.second.push(change * bend);
        }
        spot
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> RoundedPath {
        let knots = [[0.0, 0.0], [2.0, 0.0], [2.0, 3.0], [1.0, 2.0]].map(|p| p.to_vec()).to_vec();
        RoundedPath::new(knots, vec![1.0, 2.0, 1.0], vec![0.5, 0.25])
    }

    #[test]
    fn point_and_direction_go_on_smoothly() {
        let way = square();
        let h = 1e-5;
        let mut s = 2.0 * h;
        while s < way.length() - 2.0 * h {
            let [a, b, c] = [s - h, s, s + h].map(|s| way.at(s));
            for i in 0..2 {
                assert!(((c.point[i] - a.point[i]) / (2.0 * h) - b.first[i]).abs() < 1e-3, "{s}");
                assert!(((c.first[i] - a.first[i]) / (2.0 * h) - b.second[i]).abs() < 1e-2, "{s}");
                // It changes by at most 6 / (2 r)^2 times the change of direction, which is at most (-1, -2.5), in s.
                assert!((c.second[i] - a.second[i]).abs() < 125.0 * h, "{s}: curvature jumps");
            }
            s += 0.0007;
        }
    }

    #[test]
    fn it_begins_and_ends_at_its_knots_and_passes_corners_as_near_as_it_says() {
        let way = square();
        assert_eq!(way.at(0.0).point, [0.0, 0.0]);
        assert_eq!(way.at(way.length()).point, [1.0, 2.0]);
        assert_eq!(way.at(-1.0).point, [0.0, 0.0]);
        // r = 0.5, the change of direction (-2, 1.5).
        let passed = way.at(1.0).point;
        let by = (passed[0] - 2.0).hypot(passed[1]);
        assert!((by - 3.0 / 16.0 * 0.5 * 2.5).abs() < 1e-12, "{by}");
        // Outside the rounding the line is exact.
        assert_eq!(way.at(0.25).point, [0.5, 0.0]);
    }

    #[test]
    fn without_rounding_it_goes_through_the_knots() {
        let knots = [[0.0], [1.0], [0.5]].map(|p| p.to_vec()).to_vec();
        let way = RoundedPath::new(knots, vec![1.0, 1.0], vec![0.0]);
        assert_eq!(way.at(1.0).point, [1.0]);
        assert_eq!(way.at(1.5).point, [0.75]);
    }
}
