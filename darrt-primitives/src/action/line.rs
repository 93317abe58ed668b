//! Straight lines of the hand, followed by inverse kinematics in small steps.

use darrt_core::domain::Domain;
use darrt_core::space::ComponentSpace;
use nalgebra::{Isometry3, Translation3, Vector3};

use crate::manipulator::{Configuration, Manipulator};
use crate::tabletop::Tabletop;

/// The way of the arm along a line of the hand, as far as the arm reaches.
#[derive(Debug, Clone)]
pub struct Line<J> {
    /// Arm configurations on the way, the start not among them.
    pub arms: Vec<J>,
    /// How much of the line is done at each of them, in `(0, 1]`, ascending.
    pub shares: Vec<f64>,
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
}

/// Follows the hand from `from` (where the arm is at `arm`) by `displacement` (metres, world) without turning it.
///
/// Between the steps the arm moves straight in joint space and the hand strays from the line; where it strays too far, or
/// the arm does not reach, steps are halved, and if that does not help the line ends there. Where it strays little they
/// are doubled again.
pub fn follow<M: Manipulator>(
    m: &Tabletop<M>,
    base: &[f64; 3],
    arm: &M::Joints,
    from: &Isometry3<f64>,
    displacement: &Vector3<f64>,
) -> Line<M::Joints> {
    let length_m = displacement.norm();
    let mut longest_m = m.settings().line_step_m;
    let shortest_m = longest_m * SHORTEST;
    let mut step_m = longest_m;
    let mut line = Line { arms: Vec::new(), shares: Vec::new() };
    let (mut here, mut done) = (*arm, 0.0);
    while done < 1.0 && step_m >= shortest_m {
        let left = 1.0 - done;
        // What is left, in equal steps.
        let steps = (left * length_m / step_m - ROUNDING).ceil();
        let share = if steps > 1.0 { done + left / steps } else { 1.0 };
        let on_line = |share: f64| {
            Isometry3::from_parts(Translation3::from(from.translation.vector + displacement * share), from.rotation)
        };
        let Some(next) = m.manipulator().inverse_near(base, &on_line(share), &here) else {
            step_m /= 2.0;
            longest_m = step_m;
            continue;
        };
        let at = |arm: M::Joints| Configuration { base: *base, arm };
        let between = m.robot().interpolate(&at(here), &at(next), 0.5);
        let strayed = on_line(done.midpoint(share)).inverse() * m.manipulator().world_from_tool(&between);
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
