//! What an arm can do whose joints do not lift or tilt its hand, and where.

use std::f64::consts::{FRAC_PI_2, PI};

use darrt_core::random::{Purpose, stream};
use darrt_primitives::contact::{Fingertips, HandStance, PushHeights, RimContact};
use darrt_primitives::manipulator::{Configuration, Manipulator as _};
use nalgebra::{Isometry3, Point2, Unit, UnitQuaternion, Vector2, Vector3};
use rand::RngExt as _;

use super::FileRobot;
use super::apart::drawn_arm;
use crate::tied_hand::{below_tool_m, why_not_lifted};

/// Poses of the hand that are turned to another heading.
const HEADINGS: u32 = 200;
/// Distances that are tried, metres ahead of the base: from 0 in steps, so many.
const AHEAD_M: (f64, u32) = (0.05, 24);

/// What a person should know of an arm that does not take its hand to any pose, a line each; none for one that does.
pub(super) fn lines(robot: &FileRobot) -> Vec<String> {
    let mut lines = Vec::new();
    if let Some(shares) = other_headings(robot) {
        let [any, down] = shares.map(|share| share.map(|share| format!("{:.0} %", 100.0 * share)));
        let joints = robot.limits().len();
        let base = if robot.first.ring.is_fixed() { "" } else { "; from other places of the base from any side" };
        let down = down.map_or_else(String::new, |share| format!(", to {share} of those in which it points down"));
        lines.push(format!(
            "heading:  {joints} joints take the hand to {} of its poses turned to another heading{down}{base}",
            any.unwrap_or_default()
        ));
    }
    for hand in 0..robot.hands() {
        let tied = tied(robot, hand);
        // Of two hands each line says which.
        lines.extend(tied.into_iter().map(|line| match robot.hands() {
            1 => line,
            _ => format!("{line} (hand {})", hand + 1),
        }));
    }
    lines
}

/// What the joints do not change of one of the hands, a line each.
fn tied(robot: &FileRobot, hand: usize) -> Vec<String> {
    let ties = robot.hand_ties_of(hand);
    let mut lines = Vec::new();
    match ties.pushing(false) {
        None => {}
        Some(None) => {
            lines
                .push("tilt:     the hand is always tilted alike, its fingers not side by side: no pushing".to_owned());
        }
        Some(Some(HandStance { lean, .. })) => {
            let how = if lean < 1e-6 {
                "points down".to_owned()
            } else if (lean - FRAC_PI_2).abs() < 1e-6 {
                "is level".to_owned()
            } else {
                format!("leans by {:.0} degrees", lean.to_degrees())
            };
            lines.push(format!(
                "tilt:     the hand {how}, whatever the joints: objects are pushed and held with it as it is"
            ));
        }
    }
    if let Some(why) = why_not_lifted(&ties) {
        lines.push(format!("cannot:   {why}; Pick, Place and all that carries are left out of a problem for it"));
    }
    if let (Some(at_m), Some(Some(stance))) = (ties.height_m, ties.pushing(false)) {
        let tips_m = at_m - below_tool_m(robot, robot.hand().max_gap_m(), &stance);
        lines.push(format!(
            "can:      push what stands lower and reaches higher than its fingertips, {tips_m:.3} m above the floor"
        ));
    }
    lines
}

/// In which share of its poses, each turned about its own vertical by chance, the hand is reached with the base where it is; and of
/// those in which it points down, where there are such. `None` for an arm that takes its hand to any pose.
fn other_headings(robot: &FileRobot) -> Option<[Option<f64>; 2]> {
    robot.first.few.as_ref()?;
    let mut rng = stream(0, 8, 0, Purpose::Extend);
    let down = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), FRAC_PI_2);
    let mut counts = [[0_u32; 2]; 2];
    for _ in 0..HEADINGS {
        let arm = drawn_arm(robot, &mut rng)?;
        let pose = robot.world_from_tool(&Configuration { base: [0.0; 3], arm });
        let is_down = robot.arm_at(0, &Isometry3::from_parts(pose.translation, down), &mut rng).is_some();
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), rng.random_range(-PI..PI));
        for ([asked, reached], rotation) in counts.iter_mut().zip([Some(pose.rotation), is_down.then_some(down)]) {
            let Some(rotation) = rotation else { continue };
            let tool = Isometry3::from_parts(pose.translation, turn * rotation);
            *asked += 1;
            *reached += u32::from(robot.inverse(&[0.0; 3], &tool, &mut rng).is_some());
        }
    }
    Some(counts.map(|[asked, reached]| (asked > 0).then(|| f64::from(reached) / f64::from(asked))))
}

/// Where a hand that is not lifted pushes a disc: the height of a table on which it does so with its fingertips `tips_m` above it, and
/// how far ahead of the base it reaches the disc, pushed across from one place to the other on either side of straight ahead; metres, in
/// the middle first. `None` for a hand that does not push, or is lifted.
pub(super) fn pushes(
    robot: &FileRobot,
    [radius_m, height_m]: [f64; 2],
    tips_m: f64,
    from_to_m: [f64; 2],
) -> Option<(f64, Vec<f64>)> {
    let (at_m, stance) = (robot.hand_ties().height_m?, robot.hand_ties().pushing(false)??);
    let hand = robot.hand();
    let gap_m = hand.max_gap_m().min(radius_m);
    let top_m = at_m - below_tool_m(robot, gap_m, &stance) - tips_m;
    let tips = Fingertips { beyond_tool: hand.tip_beyond_tool_m(gap_m), half_width: hand.tip_half_width_m() };
    let contact = RimContact::new(radius_m, gap_m, tips).ok()?;
    let heights = PushHeights { tips: tips_m, top: height_m };
    let direction = Unit::new_normalize(Vector2::new(0.0, from_to_m[1] - from_to_m[0]));
    let mut rng = stream(0, 6, 0, Purpose::Extend);
    let mut is_reached = |ahead_m: f64| {
        from_to_m.iter().all(|aside_m| {
            let puck = Point2::new(ahead_m, *aside_m);
            let tool = contact.world_from_tool(&puck, &direction, top_m, &heights, &stance);
            tool.is_ok_and(|tool| {
                robot.may_reach(&[0.0; 3], &tool) && robot.inverse(&[0.0; 3], &tool, &mut rng).is_some()
            })
        })
    };
    let distances = (0..AHEAD_M.1).map(|step| f64::from(step) * AHEAD_M.0);
    let mut reached: Vec<f64> = distances.filter(|ahead_m| is_reached(*ahead_m)).collect();
    // There the arm is neither stretched nor folded.
    let middle_m = f64::midpoint(*reached.first()?, *reached.last()?);
    reached.sort_by(|a, b| (a - middle_m).abs().total_cmp(&(b - middle_m).abs()));
    (top_m > 0.0).then_some((top_m, reached))
}
