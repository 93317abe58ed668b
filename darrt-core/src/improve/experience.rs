//! What has been seen while a plan was improved, for guesses at what has not been looked at.

use std::collections::BTreeMap;

/// How many times as long as they seem ways are taken to be before any has been looked at.
const PRIOR_RATIO: f64 = 2.0;
/// How many times as long a way around takes as the straight one that is blocked.
const PRIOR_AROUND: f64 = 2.5;
/// As if so many seconds had been seen to take so many times as long.
const PRIOR_S: f64 = 20.0;

/// How much more something takes than it seems, as far as has been seen.
#[derive(Debug, Clone, Copy)]
pub(super) struct Experience {
    seems_s: f64,
    takes_s: f64,
}

impl Experience {
    fn prior(ratio: f64) -> Self {
        Self { seems_s: PRIOR_S, takes_s: ratio * PRIOR_S }
    }

    /// Before any way has been looked at.
    pub(super) fn of_ways() -> Self {
        Self::prior(PRIOR_RATIO)
    }

    /// Before any way around what is blocked has been looked for.
    pub(super) fn of_ways_around() -> Self {
        Self::prior(PRIOR_AROUND)
    }

    pub(super) fn learn(&mut self, seems_s: f64, takes_s: f64) {
        self.seems_s += seems_s;
        self.takes_s += takes_s;
    }

    pub(super) fn ratio(&self) -> f64 {
        self.takes_s / self.seems_s
    }
}

/// How often a way around was looked for, and found.
#[derive(Debug, Clone, Copy, Default)]
struct Luck {
    looked_for: u32,
    found: u32,
}

impl Luck {
    fn count(&mut self, is_found: bool) {
        self.looked_for += 1;
        self.found += u32::from(is_found);
    }

    /// The chance of the next one, which is `prior` before any has been looked for: the mean of a beta distribution, to which
    /// the prior counts as much as one look.
    fn chance(self, prior: f64) -> f64 {
        (f64::from(self.found) + prior) / (f64::from(self.looked_for) + 1.0)
    }
}

/// What is known of the chance that there is a way around: on all leaves, and on each. A hand that holds something so that
/// the robot does not fit through a door fits through it nowhere.
#[derive(Debug, Default)]
pub(super) struct WaysAround {
    all: Luck,
    on_leaf: BTreeMap<usize, Luck>,
}

impl WaysAround {
    /// Looked for on this leaf, and found or not.
    pub(super) fn count(&mut self, leaf: usize, is_found: bool) {
        self.all.count(is_found);
        self.on_leaf.entry(leaf).or_default().count(is_found);
    }

    /// The chance of the next one on this leaf.
    pub(super) fn chance(&self, leaf: usize) -> f64 {
        self.on_leaf.get(&leaf).copied().unwrap_or_default().chance(self.all.chance(1.0))
    }
}
