//! Straight lines of the hand, followed by inverse kinematics in small steps.

use nalgebra::{Isometry3, Translation3, Vector3};

use crate::manipulator::Manipulator;
use crate::tabletop::Tabletop;

/// The way of the arm along a line of the hand, as far as the arm reaches.
#[derive(Debug, Clone)]
pub struct Line<J> {
    /// Arm configurations at equal steps, the start not among them.
    pub arms: Vec<J>,
    /// How much of the line was reached, in `[0, 1]`.
    pub share: f64,
}

/// Follows the hand from `from` (where the arm is at `arm`) by `displacement` (metres, world) without turning it.
pub fn follow<M: Manipulator>(
    m: &Tabletop<M>,
    base: &[f64; 3],
    arm: &M::Joints,
    from: &Isometry3<f64>,
    displacement: &Vector3<f64>,
) -> Line<M::Joints> {
    let steps = (displacement.norm() / m.settings().line_step_m).ceil().clamp(1.0, 1000.0);
    let mut line = Line { arms: Vec::new(), share: 0.0 };
    let mut here = *arm;
    let mut i = 1.0;
    while i <= steps {
        let share = i / steps;
        let pose =
            Isometry3::from_parts(Translation3::from(from.translation.vector + displacement * share), from.rotation);
        let Some(next) = m.manipulator().inverse_near(base, &pose, &here) else { return line };
        line.arms.push(next);
        line.share = share;
        here = next;
        i += 1.0;
    }
    line
}
