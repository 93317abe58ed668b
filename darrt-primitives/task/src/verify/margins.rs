//! How far pairs of solids keep from each other, by what they are.

use super::solid::Solid;
use crate::problem_file::{ProblemFile, Safety};

/// What decides how far a pair keeps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum MarginKind {
    /// The robot against anything but itself.
    Robot,
    /// The held object against anything but the robot.
    Held,
    /// An object that is not held against fixed bodies and others.
    Object,
    /// The robot against itself.
    Itself,
    /// Hand or handled object, against the object and what carries it; the hand against what it holds.
    Near,
}

impl MarginKind {
    /// All of them.
    pub(super) const ALL: [Self; 5] = [Self::Robot, Self::Held, Self::Object, Self::Itself, Self::Near];

    pub(super) const fn index(self) -> usize {
        self as usize
    }
}

/// Metres, by kind.
#[derive(Debug, Clone, Copy)]
pub(super) struct Margins {
    /// What every plan keeps.
    pub(super) least_m: [f64; 5],
    /// What a plan should keep.
    pub(super) wanted_m: [f64; 5],
}

impl Margins {
    pub(super) fn of(problem: &ProblemFile) -> Self {
        let Safety { robot_margin_m, held_margin_m, object_margin_m, least_margin_m, contact_margin_m, .. } =
            problem.safety;
        // Who may be near need not be farther away than all others.
        let near_m = contact_margin_m.min(least_margin_m);
        let wanted = [robot_margin_m, held_margin_m, object_margin_m].map(|wanted| wanted.max(least_margin_m));
        let [robot, held, object] = wanted;
        Self {
            least_m: [least_margin_m, least_margin_m, least_margin_m, least_margin_m, near_m],
            wanted_m: [robot, held, object, least_margin_m, near_m],
        }
    }
}

/// How far measured distances may be off where a margin is judged, metres: what the oracle may be off on what is curved.
pub(super) const ROUNDING_M: f64 = 1e-5;

/// Pairs that begin nearer to each other than their margin and this may come as near as that, metres.
pub(super) const NEARLY_M: f64 = 1e-4;

/// And this much nearer, metres: a hand may stray from a straight line.
pub(super) const STRAY_M: f64 = 5e-4;

/// Two bodies that the problem itself puts nearer to each other than the least margin, apart.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Placed {
    pub(super) bodies: (String, String),
    pub(super) distance_m: f64,
    pub(super) is_at_goal: bool,
}

impl Placed {
    pub(super) fn new(a: &Solid, b: &Solid, distance_m: f64, is_at_goal: bool) -> Self {
        Self { bodies: (a.name().to_owned(), b.name().to_owned()), distance_m, is_at_goal }
    }
}
