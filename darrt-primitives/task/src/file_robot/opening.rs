//! How far the fingers are open at which value of their joint, found from where the pads are.

use std::f64::consts::PI;

/// How far a law of the opening may be off, metres.
const SAME_M: f64 = 1e-7;

/// A length as a function of the joint's value q.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Law {
    /// `at + rate q`: the fingers slide.
    Line {
        /// Metres at 0.
        at: f64,
        /// Metres per unit of the joint.
        rate: f64,
    },
    /// `at + size sin(turns q + phase)`: the fingers swing, their pads stay parallel.
    Wave {
        /// Metres.
        at: f64,
        /// Metres.
        size: f64,
        /// Radians.
        phase: f64,
        /// Radians per unit of the joint.
        turns: f64,
    },
}

impl Law {
    /// The law of a length that is `length(q)` for q in `range`; `None` if it is neither.
    pub(super) fn of(length: impl Fn(f64) -> f64, [low, high]: [f64; 2], turns: &[f64]) -> Option<Self> {
        let line = {
            let rate = (length(high) - length(low)) / (high - low);
            Self::Line { at: length(low) - rate * low, rate }
        };
        let waves = turns.iter().filter_map(|turns| wave(&length, [low, high], *turns));
        std::iter::once(line).chain(waves).find(|law| {
            let samples = (0..=32).map(|i| low + (high - low) * f64::from(i) / 32.0);
            let worst = samples.map(|q| (law.at(q) - length(q)).abs()).fold(0.0, f64::max);
            worst <= SAME_M
        })
    }

    /// The length at this value of the joint.
    pub(super) fn at(&self, q: f64) -> f64 {
        match *self {
            Self::Line { at, rate } => at + rate * q,
            Self::Wave { at, size, phase, turns } => at + size * (turns * q + phase).sin(),
        }
    }
}

/// `a + b cos(turns q) + c sin(turns q)` through three points.
fn wave(length: impl Fn(f64) -> f64, [low, high]: [f64; 2], turns: f64) -> Option<Law> {
    let at = [low, f64::midpoint(low, high), high];
    let [l0, l1, l2] = at.map(&length);
    let [(s0, c0), (s1, c1), (s2, c2)] = at.map(|q| (turns * q).sin_cos());
    let rows = nalgebra::Matrix2::new(c1 - c0, s1 - s0, c2 - c0, s2 - s0);
    let found = rows.try_inverse()? * nalgebra::Vector2::new(l1 - l0, l2 - l0);
    let (b, c) = (found.x, found.y);
    Some(Law::Wave { at: l0 - b * c0 - c * s0, size: b.hypot(c), phase: b.atan2(c), turns })
}

/// The opening of a hand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Opening {
    gap: Law,
    /// The end of the tips along the tool's x axis.
    end: Law,
    /// Of the joint.
    range: [f64; 2],
    /// The widest gap that is used, metres.
    pub(super) max_gap_m: f64,
}

impl Opening {
    /// `None` if the gap does not grow, or shrink, all along the joint's range.
    pub(super) fn new(gap: Law, end: Law, range: [f64; 2], most_m: Option<f64>) -> Option<Self> {
        let [low, high] = range;
        let samples: Vec<f64> = (0..=64).map(|i| gap.at(low + (high - low) * f64::from(i) / 64.0)).collect();
        let is_monotone = samples.is_sorted_by(|a, b| a < b) || samples.is_sorted_by(|a, b| a > b);
        let widest = gap.at(low).max(gap.at(high));
        let max_gap_m = most_m.unwrap_or(f64::INFINITY).min(widest);
        (is_monotone && max_gap_m > 0.0).then_some(Self { gap, end, range, max_gap_m })
    }

    /// The value of the joint for a gap, metres; for one out of reach the nearest.
    pub(super) fn joint(&self, gap_m: f64) -> f64 {
        let [low, high] = self.range;
        let value = match self.gap {
            Law::Line { at, rate } => (gap_m - at) / rate,
            Law::Wave { at, size, phase, turns } => {
                let angle = ((gap_m - at) / size).clamp(-1.0, 1.0).asin();
                // Of the two angles with this sine the one that is met in the range.
                let middle = turns * f64::midpoint(low, high) + phase;
                let near = |angle: f64| angle + 2.0 * PI * ((middle - angle) / (2.0 * PI)).round();
                let [a, b] = [near(angle), near(PI - angle)];
                let nearest = if (a - middle).abs() <= (b - middle).abs() { a } else { b };
                (nearest - phase) / turns
            }
        };
        if value.is_nan() { low } else { value.clamp(low, high) }
    }

    /// How far the tips reach beyond the tool frame, metres.
    pub(super) fn end_m(&self, gap_m: f64) -> f64 {
        self.end.at(self.joint(gap_m))
    }

    /// Where the joint is in the open hand.
    pub(super) fn open(&self) -> f64 {
        self.joint(self.max_gap_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sliding_and_swinging_fingers_are_opened_to_their_gap() {
        let slides = |q: f64| 2.0 * q + 1e-3;
        let swings = |q: f64| 0.02 + 0.18 * (q + 0.05).sin();
        let closes = |q: f64| 0.085 - 0.1 * (0.9 * q).sin();
        let opened = |law: Law, range| Opening::new(law, Law::Line { at: 0.02, rate: 0.0 }, range, None).unwrap();
        for (law, range) in [
            (Law::of(slides, [0.0, 0.04], &[1.0]).unwrap(), [0.0, 0.04]),
            (Law::of(swings, [0.0, 0.548], &[1.0]).unwrap(), [0.0, 0.548]),
            (Law::of(closes, [0.0, 0.8], &[1.0, 0.9]).unwrap(), [0.0, 0.8]),
        ] {
            let opening = opened(law, range);
            for i in 0..=20 {
                let gap_m = law.at(range[0]).min(law.at(range[1])) * f64::from(20 - i) / 20.0
                    + opening.max_gap_m * f64::from(i) / 20.0;
                assert!((law.at(opening.joint(gap_m)) - gap_m).abs() < 1e-9, "{law:?} {gap_m}");
            }
            assert_eq!(opening.joint(f64::NAN), range[0]);
            assert!((law.at(opening.joint(9.0)) - opening.max_gap_m).abs() < 1e-9);
        }
        assert_eq!(Law::of(|q| q * q, [0.0, 1.0], &[1.0]), None);
        let bump = Law::of(|q: f64| 0.1 * q.sin(), [0.0, 3.0], &[1.0]).unwrap();
        assert_eq!(Opening::new(bump, bump, [0.0, 3.0], None), None);
    }
}
