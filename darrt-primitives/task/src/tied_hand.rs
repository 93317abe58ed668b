//! What a hand cannot do that its joints do not lift or tilt, in words.

use darrt_primitives::contact::{Fingertips, HandStance};
use darrt_primitives::hand_ties::HandTies;
use darrt_primitives::manipulator::Manipulator;

use crate::problem_file::{Object, ProblemFile};

/// Why nothing is lifted by a hand with these ties; `None` if it may be.
pub(crate) fn why_not_lifted(ties: &HandTies) -> Option<String> {
    ties.height_m.map(|at_m| format!("the arm does not lift: its hand stays {at_m:.3} m above the floor"))
}

/// Why the hand cannot push `object` where it stands at the start; `None` if it may, as far as tilt and height say.
pub(crate) fn why_not_pushed(problem: &ProblemFile, object: &Object, robot: &impl Manipulator) -> Option<String> {
    let ties = robot.hand_ties();
    let Some(stance) = ties.pushing(false)? else {
        return Some("the hand is always tilted so that its two fingers do not stand behind an object".to_owned());
    };
    let at_m = ties.height_m?;
    let geometry = problem.geometry().ok()?;
    let index = problem.objects.iter().position(|other| std::ptr::eq(other, object))?;
    let solid = geometry.objects.get(index)?;
    let surface_m = geometry.scene.surface(&object.on)?.height();
    let tips_m = at_m - surface_m - below_tool_m(robot, problem.push.gap_m, &stance);
    let [low_m, high_m] = [problem.push.fingertip_clearance_m, 2.0 * solid.depth_below_origin];
    if tips_m >= low_m && tips_m < high_m {
        return None;
    }
    Some(format!(
        "the fingertips stay {:.1} mm above `{}`, to push it they must be between {:.1} and {:.1} mm above it",
        1e3 * tips_m,
        object.on,
        1e3 * low_m,
        1e3 * high_m
    ))
}

/// How far the fingertips reach below the origin of the tool frame, metres.
pub(crate) fn below_tool_m(robot: &impl Manipulator, gap_m: f64, stance: &HandStance) -> f64 {
    let hand = robot.hand();
    let beyond_tool = hand.tip_beyond_tool_m(gap_m.min(hand.max_gap_m()));
    Fingertips { beyond_tool, half_width: hand.tip_half_width_m() }.tool_height(0.0, stance)
}
