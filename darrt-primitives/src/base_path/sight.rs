//! Straight drives among the obstacles: are they clear, and what do they cost?

use darrt_core::space::ComponentSpace;
use darrt_core::space::so2::{turn, wrap};

use super::footprint::Footprint;
use super::nudge::{Nudge, Room};
use crate::heading_drive;

/// Distances beyond this count as this, metres: from a pose that is so clear nobody looks at those around it.
pub(super) const FAR_M: f64 = 0.3;

/// A passage that is too narrow by no more than this to both sides may only seem so, metres.
const NARROW_M: f64 = 0.01;

/// How much of a drive is nearer than wanted is known to this length of travel, metres.
const TIGHT_M: f64 = 0.05;

/// Margins and costs of a drive.
#[derive(Debug, Clone, Copy)]
pub(super) struct Terms {
    /// Nothing comes nearer than this, metres.
    pub(super) least_m: f64,
    /// Where something comes nearer than this, a metre counts more: the nearer, the more.
    pub(super) wanted_m: f64,
    /// Between poses that are not farther apart than this nobody looks, metres.
    pub(super) resolution_m: f64,
    /// What a radian counts, metres.
    pub(super) turn_m: f64,
    /// How many times as much a metre counts where nothing may be nearer, at least 1.
    pub(super) tight: f64,
    /// Does the base drive along its heading only?
    pub(super) is_along_heading: bool,
}

/// A pose, and a lower bound of its distance from the obstacles in metres.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stop {
    pub(super) at: [f64; 3],
    pub(super) clear_m: f64,
}

/// A judge of straight drives who knows more than the footprint: from one pose to the other.
pub(super) type Judge<'a> = dyn FnMut(&[f64; 3], &[f64; 3]) -> bool + 'a;

/// Looks along straight drives.
pub(super) struct Sight<'a> {
    pub(super) footprint: &'a mut Footprint,
    pub(super) terms: Terms,
    /// What the footprint calls clear is asked about again, if there is somebody to ask.
    pub(super) judge: Option<&'a mut Judge<'a>>,
    nudge: Nudge,
    /// How many passages have been found that are too narrow by little.
    narrow: usize,
    /// Parts of a drive that have still to be looked at.
    parts: Vec<(Stop, Stop)>,
}

impl<'a> Sight<'a> {
    pub(super) fn new(footprint: &'a mut Footprint, terms: Terms, judge: Option<&'a mut Judge<'a>>) -> Self {
        Self { footprint, terms, judge, nudge: Nudge::default(), narrow: 0, parts: Vec::new() }
    }

    /// The pose with its distance from the obstacles; `None` if that is too little.
    pub(super) fn stop(&mut self, at: &[f64; 3]) -> Option<Stop> {
        self.stop_within(at, FAR_M)
    }

    /// [`Sight::stop`] that does not tell distances beyond `cap_m` apart.
    fn stop_within(&mut self, at: &[f64; 3], cap_m: f64) -> Option<Stop> {
        let clear_m = self.footprint.distance_m(at, cap_m, self.terms.least_m);
        (clear_m >= self.terms.least_m).then_some(Stop { at: *at, clear_m })
    }

    /// A pose in the middle of the narrow passage in which `at` lies, not farther away than `room`.
    pub(super) fn stop_beside(&mut self, at: &[f64; 3], room: Room) -> Option<Stop> {
        let Terms { least_m, wanted_m, .. } = self.terms;
        let (at, clear_m) = self.nudge.between(self.footprint, at, room, (least_m, wanted_m))?;
        if clear_m < least_m {
            self.narrow += usize::from(clear_m > least_m - NARROW_M);
            return None;
        }
        Some(Stop { at, clear_m })
    }

    /// How many passages have been found that are too narrow by little: a finer lattice may pass them.
    pub(super) fn narrow(&self) -> usize {
        self.narrow
    }

    /// A pose this far from `stop` along the passage in which it lies, to the side on which `towards` is. `None` if it lies
    /// in none.
    pub(super) fn stop_along(&mut self, stop: &Stop, towards: &[f64; 3], way_m: f64) -> Option<Stop> {
        let along = self.nudge.along(self.footprint, &stop.at, self.terms.wanted_m)?;
        let [x, y, yaw] = stop.at;
        let side_m = way_m.copysign((towards[0] - x) * along.x + (towards[1] - y) * along.y);
        self.stop(&[x + side_m * along.x, y + side_m * along.y, wrap(yaw + side_m * along.z)])
    }

    /// A pose beside a stop that is nearer than wanted, not farther away than it lacks, where there is more room.
    pub(super) fn stop_aside(&mut self, stop: &Stop) -> Option<Stop> {
        let lack_m = self.terms.wanted_m - stop.clear_m;
        if lack_m <= 0.0 {
            return None;
        }
        let room = Room { shift_m: lack_m, turn_rad: lack_m };
        let at = self.nudge.pushed(self.footprint, &stop.at, room, self.terms.wanted_m)?;
        self.stop(&at).filter(|aside| aside.clear_m > stop.clear_m)
    }

    /// Bound on the travel of any point of the robot between two poses, metres.
    pub(super) fn travel_m(&self, a: &[f64; 3], b: &[f64; 3]) -> f64 {
        (b[0] - a[0]).hypot(b[1] - a[1]) + self.footprint.reach_m() * turn(a[2], b[2]).abs()
    }

    /// What a straight drive costs where there is room, metres.
    pub(super) fn open_cost_m(&self, a: &[f64; 3], b: &[f64; 3]) -> f64 {
        (b[0] - a[0]).hypot(b[1] - a[1]) + self.terms.turn_m * turn(a[2], b[2]).abs()
    }

    /// The pose at `share` of a straight drive.
    pub(super) fn between(&self, a: &[f64; 3], b: &[f64; 3], share: f64) -> [f64; 3] {
        self.footprint.bounds().interpolate(a, b, share)
    }

    /// What the drive from `a` to `b` costs, metres: a straight one, or by the corners of a base that drives along its heading
    /// only; `None` if something is in the way.
    pub(super) fn cost_m(&mut self, a: &Stop, b: &Stop) -> Option<f64> {
        if !self.terms.is_along_heading {
            return self.straight_cost_m(a, b);
        }
        let (mut here, mut cost_m) = (*a, 0.0);
        for corner in heading_drive::corners(&a.at, &b.at) {
            let next = self.stop(&corner)?;
            cost_m += self.straight_cost_m(&here, &next)?;
            here = next;
        }
        Some(cost_m + self.straight_cost_m(&here, b)?)
    }

    /// What the straight drive from `a` to `b` costs, metres; `None` if something is in the way.
    ///
    /// No point travels farther than the bound on the travel says, so between two poses that are farther from everything
    /// than they are from each other there is nothing.
    fn straight_cost_m(&mut self, a: &Stop, b: &Stop) -> Option<f64> {
        let Terms { least_m, wanted_m, resolution_m, tight, .. } = self.terms;
        let whole_m = self.travel_m(&a.at, &b.at);
        let mut tight_m = 0.0;
        let mut parts = std::mem::take(&mut self.parts);
        parts.clear();
        parts.push((*a, *b));
        let (mut is_clear, mut next) = (true, 0);
        // The longest parts first: what is in the way of one is mostly found in a few looks.
        while let Some((a, b)) = parts.get(next).copied() {
            next += 1;
            let length_m = self.travel_m(&a.at, &b.at);
            // The least distance there can be on the way.
            let dip_m = 0.5 * (a.clear_m + b.clear_m - length_m);
            if dip_m >= wanted_m {
                continue;
            }
            if length_m <= resolution_m || dip_m >= least_m && length_m <= TIGHT_M {
                let lack_m = (wanted_m - a.clear_m.min(b.clear_m)).max(0.0);
                tight_m += length_m * (lack_m / (wanted_m - least_m).max(f64::MIN_POSITIVE)).min(1.0);
                continue;
            }
            // More than that says nothing more of this part.
            let cap_m = wanted_m + 0.5 * length_m;
            let Some(middle) = self.stop_within(&self.between(&a.at, &b.at, 0.5), cap_m) else {
                is_clear = false;
                break;
            };
            parts.push((a, middle));
            parts.push((middle, b));
        }
        self.parts = parts;
        if !is_clear || self.judge.as_mut().is_some_and(|judge| !judge(&a.at, &b.at)) {
            return None;
        }
        let share = if whole_m > 0.0 { tight_m / whole_m } else { 0.0 };
        Some(self.open_cost_m(&a.at, &b.at) * (1.0 + share * (tight - 1.0)))
    }
}
