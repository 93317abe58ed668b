//! A first problem for a robot: a table where its hand reaches, and a cup to be set down elsewhere on it; for a hand that is not lifted
//! a puck to be pushed there.

use std::collections::BTreeMap;

use darrt_geom::{Body, Shape, clearance};
use darrt_primitives::joints::Joints;
use darrt_primitives::manipulator::{Configuration, Manipulator as _};
use nalgebra::{Isometry3, Vector3};

use super::FileRobot;
use super::abilities::pushes;
use super::inspect::Inspection;

/// Height of the table where the robot's hand, pointing down, reaches nowhere, metres.
const NOWHERE_M: f64 = 0.4;
/// How far the tool stays above the table at least, metres.
const ABOVE_M: f64 = 0.15;
/// So much of the table lies nearer to the robot than the cup, metres.
const NEAR_M: f64 = 0.1;

/// The table: length along x, along y, thickness, metres.
const TABLE_M: [f64; 3] = [0.5, 0.9, 0.04];
/// The cup: radius and height, metres; where it stands to the left of straight ahead.
const CUP_M: [f64; 2] = [0.02, 0.1];
const CUP_LEFT_M: f64 = -0.15;
/// And where it shall stand.
const CUP_TO_M: f64 = 0.2;
/// The puck: radius and height, metres; from where to where it is pushed, to the left of straight ahead.
const PUCK_M: [f64; 2] = [0.06, 0.05];
const PUSHED_M: [f64; 2] = [0.15, -0.1];
/// How far above the table the fingertips push it, metres: more than the robot keeps from other things.
const TIPS_M: f64 = 0.022;
/// How far the robot keeps from both at the start, metres.
const APART_M: f64 = 0.03;
/// Heights that are tried, from the best one, metres.
const HEIGHTS_M: [f64; 9] = [0.0, -0.1, 0.1, -0.2, 0.2, -0.3, 0.3, -0.4, 0.4];

/// How much farther ahead than the hand reaches first the table is tried, metres.
const FARTHER_M: [f64; 3] = [0.0, 0.1, 0.25];

/// Where the table stands, and in which posture the robot waits before it.
#[derive(Debug, Clone, PartialEq)]
pub struct Place {
    /// How far ahead of the robot the cup stands, metres.
    pub ahead_m: f64,
    /// The height of the table, metres.
    pub top_m: f64,
    /// Not its home, which would be in the table.
    pub posture: Option<String>,
    /// Is something pushed there, by a hand that is not lifted?
    pub is_push: bool,
}

/// A table that the robot reaches, by `reach_down`, and that is not in its way at the start, as far as there is one.
pub(super) fn place(
    robot: &FileRobot,
    (home, postures): (&str, &BTreeMap<String, Joints>),
    reach_down: Option<([f64; 2], f64)>,
) -> Place {
    if let Some(place) = push_place(robot, (home, postures)) {
        return place;
    }
    let ([low, high], ahead_m) = reach_down.unwrap_or(([NOWHERE_M; 2], 0.6));
    let [least, most] = [(low - 0.05).max(0.1), (high - ABOVE_M).max(low - 0.05).clamp(0.1, 0.9)];
    let rounded = |top: f64| (top * 100.0).round() / 100.0;
    // Where there is room above it to lift, and the robot's arm is not stretched.
    let best = (f64::midpoint(low, high) - ABOVE_M).clamp(least, most.max(least));
    let first = |name: &&String| *name != home;
    let others = postures.keys().filter(first).map(|name| Some(name.clone()));
    let waiting: Vec<_> = std::iter::once(None).chain(others).collect();
    // Farther ahead only where nothing is free nearer: there the arm may be stretched.
    let tries = FARTHER_M.into_iter().flat_map(|farther_m| waiting.iter().map(move |posture| (farther_m, posture)));
    for (farther_m, posture) in tries {
        let ahead_m = ahead_m + farther_m;
        let Some(arm) = postures.get(posture.as_deref().unwrap_or(home)) else { continue };
        let tops = HEIGHTS_M.into_iter().map(|up| best + up).filter(|top| (least..=most.max(least)).contains(top));
        for top in tops.map(rounded) {
            if is_clear(robot, arm, (ahead_m, top), (CUP_M, CUP_LEFT_M)) {
                return Place { ahead_m, top_m: top, posture: posture.clone(), is_push: false };
            }
        }
    }
    Place { ahead_m, top_m: rounded(best), posture: None, is_push: false }
}

/// A table on which a hand that is not lifted pushes a puck; `None` for one that does not push.
fn push_place(robot: &FileRobot, (home, postures): (&str, &BTreeMap<String, Joints>)) -> Option<Place> {
    let (top_m, reached) = pushes(robot, PUCK_M, TIPS_M, PUSHED_M)?;
    let names = std::iter::once(home).chain(postures.keys().map(String::as_str).filter(|name| *name != home));
    let names: Vec<_> = names.collect();
    let place = |ahead_m: f64, name: &str| {
        let posture = (name != home).then(|| name.to_owned());
        Place { ahead_m, top_m, posture, is_push: true }
    };
    let tries = reached.iter().flat_map(|ahead_m| names.iter().map(|name| (*ahead_m, *name)));
    let clear = tries.into_iter().find(|(ahead_m, name)| {
        postures.get(*name).is_some_and(|arm| is_clear(robot, arm, (*ahead_m, top_m), (PUCK_M, PUSHED_M[0])))
    });
    let (ahead_m, name) = clear.or_else(|| Some((*reached.first()?, home)))?;
    Some(place(ahead_m, name))
}

/// The middle of the table along x, metres.
fn middle_m(ahead_m: f64) -> f64 {
    ahead_m - NEAR_M + 0.5 * TABLE_M[0]
}

/// Is nothing of the robot, its base at the origin, near to the table and to a cup or puck of some radius and height so far to the left
/// on it?
fn is_clear(
    robot: &FileRobot,
    arm: &Joints,
    (ahead_m, top_m): (f64, f64),
    ([radius_m, height_m], left_m): ([f64; 2], f64),
) -> bool {
    let table = Shape::cuboid(0.5 * Vector3::from(TABLE_M)).and_then(|shape| Body::single("table", shape));
    let cup = Shape::cylinder(radius_m, 0.5 * height_m).and_then(|shape| Body::single("cup", shape));
    let (Ok(table), Ok(cup)) = (table, cup) else { return false };
    let things = [
        (table, Isometry3::translation(middle_m(ahead_m), 0.0, top_m - 0.5 * TABLE_M[2])),
        (cup, Isometry3::translation(ahead_m, left_m, top_m + 0.5 * height_m)),
    ];
    let mut poses = vec![Isometry3::identity(); robot.links().len()];
    robot.link_poses(&Configuration { base: [0.0; 3], arm: *arm }, robot.hand().max_gap_m(), &mut poses);
    robot.links().iter().zip(&poses).all(|(link, pose)| {
        things.iter().all(|(thing, at)| {
            clearance::between(&link.body, pose, thing, at).is_ok_and(|found| found.distance > APART_M)
        })
    })
}

/// The text of the problem. `robot` are the lines that name the robot in the table `[robot]`; `drives` says whether its base does.
pub fn problem(inspection: &Inspection, robot: &str, drives: bool) -> String {
    let Place { ahead_m: ahead, top_m: top, posture, is_push } = &inspection.place;
    let posture = posture.as_ref().map_or_else(String::new, |name| format!("\nposture = {name:?}"));
    let (name, postures) = (&inspection.name, &inspection.postures);
    let driving = match (drives, is_push) {
        (false, _) => "",
        (true, true) => "\n  \"Base-Transit\",",
        (true, false) => "\n  \"Base-Transit\",\n  \"Base-Rigid-Transfer\",",
    };
    let (left, right) = (ahead - 2.5, ahead + 2.5);
    let middle = middle_m(*ahead);
    let under = top - 0.5 * TABLE_M[2];
    let [title, carrying, working] = if *is_push {
        ["a puck on a table is pushed elsewhere", "", "\n  \"Push\","]
    } else {
        let carrying = "\n  \"Arm-Rigid-Transfer\",";
        ["a cup on a table is set down elsewhere", carrying, "\n  \"Pick\",\n  \"Place\","]
    };
    let object = object(*ahead, *is_push);
    format!(
        r#"format = "darrt-problem"
version = 1
name = "first-{name}"
title = "First: {title}"

primitives = [
  "Arm-Transit",
  "Straight-Line-Arm-Transit",{carrying}{driving}{working}
]

[robot]
{robot}
base = [0, 0, 0]{posture}

[bounds]
base_x = [-2.5, 2.5]
base_y = [-2.5, 2.5]
object_x = [{left:.3}, {right:.3}]
object_y = [-2.5, 2.5]
object_z = [0.0, 2.0]

[[obstacle]]
name = "table top"
shape = {{ box = {{ size = [0.5, 0.9, 0.04] }} }}
at = [{middle:.3}, 0, {under:.3}]

[[surface]]
name = "table"
top_of = "table top"

{object}

[transit]
postures = {postures:?}

[budget]
time_limit_s = 60
restart_iterations = 2000
"#
    )
}

/// What is set down elsewhere or pushed there.
fn object(ahead: f64, is_push: bool) -> String {
    let [name, how] = if is_push { ["puck", "pushable = true"] } else { ["cup", "grasps = [\"overhead\", \"side\"]"] };
    let ([radius, height], from, to) =
        if is_push { (PUCK_M, PUSHED_M[0], PUSHED_M[1]) } else { (CUP_M, CUP_LEFT_M, CUP_TO_M) };
    format!(
        r#"[[object]]
name = "{name}"
shape = {{ cylinder = {{ radius = {radius}, height = {height} }} }}
mass_kg = 0.1
friction = {{ table = 0.3, fingers = 0.5 }}
symmetry = "z"
on = "table"
at = [{ahead:.3}, {from}]
{how}

[[goal.object]]
object = "{name}"
on = "table"
at = [{ahead:.3}, {to}]
tolerance_m = 0.01
state = "released""#
    )
}
