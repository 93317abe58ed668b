//! Straight lines of the hand, followed by inverse kinematics in small steps.

use darrt_core::domain::Domain;
use darrt_core::space::ComponentSpace;
use nalgebra::{Isometry3, Translation3, Vector3};

use super::stance::Refused;
use crate::length_range::LengthRange;
use crate::manipulator::{Configuration, Manipulator};
use crate::tabletop::Tabletop;

/// The way of the arm along a line of the hand, as far as the arm reaches.
#[derive(Debug, Clone)]
pub struct Line<J> {
    /// Arm configurations on the way, the start not among them.
    pub arms: Vec<J>,
    /// How much of the line is done at each of them, in `(0, 1]`, ascending.
    pub shares: Vec<f64>,
    /// How long the whole line is, metres.
    pub length_m: f64,
}

/// How far the hand may be beside the line between two steps, where the arm goes straight in joint space; metres. A
/// fingertip beside a pushed object has no more room than this.
const BESIDE_M: f64 = 5e-4;
/// What a turned hand counts, metres per radian: the fingertips are as far from the tool's middle.
const TIP_LEVER_M: f64 = 0.05;
/// The shortest step, as a part of the longest.
const SHORTEST: f64 = 1.0 / 8.0;
/// How much farther the hand strays on a step of twice the length: as the square.
const DOUBLED: f64 = 4.0;
/// Steps that are longer by no more than this part of themselves count as equal.
const ROUNDING: f64 = 1e-9;

impl<J> Line<J> {
    /// How much of the line was reached, in `[0, 1]`.
    pub fn share(&self) -> f64 {
        self.shares.last().copied().unwrap_or(0.0)
    }

    /// How far the hand comes, metres.
    pub fn reached_m(&self) -> f64 {
        self.share() * self.length_m
    }
}

/// `from` moved by `length_m` along `direction` (a unit vector of the world), not turned.
pub fn moved(from: &Isometry3<f64>, direction: &Vector3<f64>, length_m: f64) -> Isometry3<f64> {
    Isometry3::from_parts(Translation3::from(from.translation.vector + direction * length_m), from.rotation)
}

/// The range with the longest wish that leaves the hand alone room at the end of a line from `from` along `direction` (a unit
/// vector of the world): with all the room that is wanted around it, else with what it needs. The hand is asked about with
/// `is_clear` and its [care](darrt_core::validity::Validity::most_care), which costs next to nothing, before an arm is looked for.
///
/// # Errors
/// Where the hand is at the end of the shortest line, if it is clear at none.
pub fn room_for_hand<M: Manipulator>(
    m: &Tabletop<M>,
    range: LengthRange,
    from: &Isometry3<f64>,
    direction: &Vector3<f64>,
    mut is_clear: impl FnMut(&Isometry3<f64>, usize) -> bool,
) -> Result<LengthRange, Isometry3<f64>> {
    let mut last = *from;
    for care in cares(m) {
        for length_m in range.tries() {
            last = moved(from, direction, length_m);
            if is_clear(&last, care) {
                return Ok(range.at_most(length_m));
            }
        }
    }
    Err(last)
}

/// All the care there is, and none.
pub(super) fn cares<M: Manipulator>(m: &Tabletop<M>) -> impl Iterator<Item = usize> {
    let most = m.collision_scene().most_care();
    [most, 0].into_iter().take(if most > 0 { 2 } else { 1 })
}

/// [`follow`]s the hand along `direction` (a unit vector of the world) as far as the range wants and the arm reaches; where
/// `check` finds something in the way at the end, less far, down to the least.
///
/// # Errors
/// [`Refused::Unreachable`] where the arm does not reach as far as the least length, else what `check` says of the last try.
pub fn follow_in_room<M: Manipulator>(
    m: &Tabletop<M>,
    start: &Configuration<M::Joints>,
    from: &Isometry3<f64>,
    direction: &Vector3<f64>,
    range: LengthRange,
    mut check: impl FnMut(&Configuration<M::Joints>) -> Result<(), Refused<M>>,
) -> Result<Line<M::Joints>, Refused<M>> {
    let mut last = Refused::Unreachable;
    let mut shortest_m = f64::INFINITY;
    for wanted_m in range.tries() {
        // What the arm did not reach before was no shorter than this.
        if wanted_m >= shortest_m {
            continue;
        }
        let line = follow(m, &start.base, &start.arm, from, &(direction * wanted_m));
        let reached_m = line.reached_m();
        let Some(arm) = line.arms.last().copied().filter(|_| reached_m >= range.least_m()) else {
            return Err(Refused::Unreachable);
        };
        match check(&Configuration { base: start.base, arm }) {
            Ok(()) => return Ok(line),
            Err(why) => (last, shortest_m) = (why, reached_m),
        }
    }
    Err(last)
}

/// Follows the hand from `from` (where the arm is at `arm`) by `displacement` (metres, world) without turning it; see
/// [`follow_path`].
pub fn follow<M: Manipulator>(
    m: &Tabletop<M>,
    base: &[f64; 3],
    arm: &M::Joints,
    from: &Isometry3<f64>,
    displacement: &Vector3<f64>,
) -> Line<M::Joints> {
    follow_path(m, base, arm, displacement.norm(), |share| moved(from, displacement, share))
}

/// Follows the hand along a smooth path of `length_m` metres that is given by how much of it is done, in `[0, 1]`; the arm is
/// at `arm` where it begins.
///
/// Between the steps the arm moves straight in joint space and the hand strays from the path; where it strays too far, or
/// the arm does not reach, steps are halved, and if that does not help the line ends there. Where it strays little they
/// are doubled again.
pub fn follow_path<M: Manipulator>(
    m: &Tabletop<M>,
    base: &[f64; 3],
    arm: &M::Joints,
    length_m: f64,
    on_path: impl Fn(f64) -> Isometry3<f64>,
) -> Line<M::Joints> {
    let mut longest_m = m.settings().line_step_m;
    let shortest_m = longest_m * SHORTEST;
    let mut step_m = longest_m;
    let mut line = Line { arms: Vec::new(), shares: Vec::new(), length_m };
    let (mut here, mut done) = (*arm, 0.0);
    while done < 1.0 && step_m >= shortest_m {
        let left = 1.0 - done;
        // What is left, in equal steps.
        let steps = (left * length_m / step_m - ROUNDING).ceil();
        let share = if steps > 1.0 { done + left / steps } else { 1.0 };
        let Some(next) = m.manipulator().inverse_near(base, &on_path(share), &here) else {
            step_m /= 2.0;
            longest_m = step_m;
            continue;
        };
        let at = |arm: M::Joints| Configuration { base: *base, arm };
        let between = m.robot().interpolate(&at(here), &at(next), 0.5);
        let strayed = on_path(done.midpoint(share)).inverse() * m.manipulator().world_from_tool(&between);
        let beside_m = strayed.translation.vector.norm() + TIP_LEVER_M * strayed.rotation.angle();
        if beside_m.is_nan() || beside_m > BESIDE_M {
            step_m /= 2.0;
            continue;
        }
        line.arms.push(next);
        line.shares.push(share);
        (here, done) = (next, share);
        if DOUBLED * beside_m <= BESIDE_M {
            step_m = longest_m.min(2.0 * step_m);
        }
    }
    line
}
