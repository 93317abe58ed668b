//! When which pair of solids must be looked at again.
//!
//! Pairs stand in classes: those of one class approach each other no faster than the same joints allow, so of each it is enough
//! to know how far its class may move before it could be near.

use super::approach::Movers;

/// How far measured distances and travels may be off, metres.
pub(super) const ROUNDING_M: f64 = 1e-6;

/// A pair is looked at again when it would have to be within this many parts of a segment, and as closely as need be to tell
/// that it is not: so that many parts at once need no look at anything.
pub(super) const AHEAD_PARTS: f64 = 10.0;

/// Pairs that are due within this much travel are asked about at every look, metres; of the others only when the first is due
/// is known.
const HORIZON_M: f64 = 0.02;

/// In how many ways pairs are treated that are looked at.
pub(super) const RULES: usize = 6;

/// What is known of a pair.
#[derive(Debug, Clone, Copy)]
pub(super) struct Due {
    /// Distance of the pair when last measured, plus what [`Going::travelled_m`] was then.
    pub(super) reserve_m: f64,
    pub(super) pair: usize,
}

/// Pairs of solids that the same joints move towards each other.
#[derive(Debug, Default)]
pub(super) struct Class {
    pub(super) between: Movers,
    /// By rule: those that keep a margin, by its kind, then those of which one stands on the other.
    pub(super) pairs: [Pairs; RULES],
    pub(super) going: Going,
    /// No pair need be looked at before they have moved so far, metres.
    pub(super) due_m: f64,
}

/// How the two of a pair of a class move towards each other.
#[expect(clippy::struct_field_names, reason = "all are metres")]
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Going {
    /// Bound on how far they have moved since the rules were set, metres.
    pub(super) travelled_m: f64,
    /// The same in one part of this segment.
    pub(super) part_m: f64,
    /// How far before it must be a pair is looked at, metres.
    pub(super) ahead_m: f64,
}

/// Pairs of one class that are treated alike.
#[derive(Debug, Default)]
pub(super) struct Pairs {
    /// The near ones first.
    pub(super) dues: Vec<Due>,
    /// How many are near.
    pub(super) near: usize,
    /// The least reserve of the near ones and of the others, metres.
    pub(super) least_m: [f64; 2],
    /// When the class has moved so far, near and far are told apart anew, metres.
    pub(super) sorted_until_m: f64,
}

impl Pairs {
    pub(super) fn new(dues: Vec<Due>) -> Self {
        let least_m = if dues.is_empty() { f64::INFINITY } else { f64::NEG_INFINITY };
        Self { near: dues.len(), least_m: [least_m; 2], sorted_until_m: f64::NEG_INFINITY, dues }
    }

    /// Tells near from far: those are far whose reserve exceeds `due_m` by more than the horizon.
    pub(super) fn sort(&mut self, travelled_m: f64, due_m: f64) {
        let horizon_m = due_m + HORIZON_M;
        self.near = 0;
        self.least_m = [f64::INFINITY; 2];
        for i in 0..self.dues.len() {
            if self.dues[i].reserve_m <= horizon_m {
                self.dues.swap(i, self.near);
                self.near += 1;
            } else {
                self.least_m[1] = smaller(self.least_m[1], self.dues[i].reserve_m);
            }
        }
        // As long as nothing limits what is of interest, all are near.
        self.sorted_until_m = if horizon_m < f64::INFINITY { travelled_m + HORIZON_M } else { travelled_m };
    }

    /// The least reserve, metres.
    pub(super) fn least_m(&self) -> f64 {
        let [near, far] = self.least_m;
        near.min(far)
    }
}

/// The smaller of two numbers, neither of them a NaN.
// OPTIMIZATION: the general one minds NaNs, and this is asked for every pair.
#[inline]
pub(super) fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}
