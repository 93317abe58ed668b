//! Straight lines of the hand, followed by inverse kinematics in small steps.

use darrt_core::domain::Domain;
use darrt_core::space::ComponentSpace;
use nalgebra::{Isometry3, Translation3, Vector3};

use crate::manipulator::{Configuration, Manipulator};
use crate::tabletop::Tabletop;

/// The way of the arm along a line of the hand, as far as the arm reaches.
#[derive(Debug, Clone)]
pub struct Line<J> {
    /// Arm configurations at equal steps, the start not among them.
    pub arms: Vec<J>,
    /// How much of the line was reached, in `[0, 1]`.
    pub share: f64,
}

/// How far the hand may be beside the line between two steps, where the arm goes straight in joint space; metres. A
/// fingertip beside a pushed object has no more room than this.
const BESIDE_M: f64 = 5e-4;
/// What a turned hand counts, metres per radian: the fingertips are as far from the tool's middle.
const TIP_LEVER_M: f64 = 0.05;
/// How often the steps are halved when the hand strays.
const HALVINGS: u32 = 3;

/// Follows the hand from `from` (where the arm is at `arm`) by `displacement` (metres, world) without turning it.
///
/// Between the steps the arm moves straight in joint space and the hand strays from the line; where it strays too far
/// the steps are halved, and if that does not help the line ends there.
pub fn follow<M: Manipulator>(
    m: &Tabletop<M>,
    base: &[f64; 3],
    arm: &M::Joints,
    from: &Isometry3<f64>,
    displacement: &Vector3<f64>,
) -> Line<M::Joints> {
    let mut steps = (displacement.norm() / m.settings().line_step_m).ceil().clamp(1.0, 1000.0);
    for _ in 0..HALVINGS {
        let (line, strays) = follow_in(m, base, arm, from, displacement, steps);
        if !strays {
            return line;
        }
        steps *= 2.0;
    }
    follow_in(m, base, arm, from, displacement, steps).0
}

/// [`follow`] in a number of equal steps; also whether it ended because the hand strayed.
fn follow_in<M: Manipulator>(
    m: &Tabletop<M>,
    base: &[f64; 3],
    arm: &M::Joints,
    from: &Isometry3<f64>,
    displacement: &Vector3<f64>,
    steps: f64,
) -> (Line<M::Joints>, bool) {
    let mut line = Line { arms: Vec::new(), share: 0.0 };
    let mut here = *arm;
    let mut i = 1.0;
    while i <= steps {
        let share = i / steps;
        let on_line = |share: f64| {
            Isometry3::from_parts(Translation3::from(from.translation.vector + displacement * share), from.rotation)
        };
        let Some(next) = m.manipulator().inverse_near(base, &on_line(share), &here) else { return (line, false) };
        let at = |arm: M::Joints| Configuration { base: *base, arm };
        let between = m.robot().interpolate(&at(here), &at(next), 0.5);
        let strayed = on_line((i - 0.5) / steps).inverse() * m.manipulator().world_from_tool(&between);
        if strayed.translation.vector.norm() + TIP_LEVER_M * strayed.rotation.angle() > BESIDE_M {
            return (line, true);
        }
        line.arms.push(next);
        line.share = share;
        here = next;
        i += 1.0;
    }
    (line, false)
}
