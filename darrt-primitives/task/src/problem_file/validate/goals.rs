//! Rules of the goals.

use std::f64::consts::PI;

use super::names::{object, surface};
use super::numbers::{angle, length, ordered, within};
use super::world::in_bounds;
use crate::problem_file::error::{Flaw, Located};
use crate::problem_file::{GoalState, GoalTarget, ObjectGoal, ProblemFile, RobotGoal};

/// Most goals.
const MOST_GOALS: usize = 1000;

/// Tightest and loosest tolerance of a position (m).
const TOLERANCE_RANGE: [f64; 2] = [1e-6, 1.0];

/// Checks all goals.
pub(super) fn check(problem: &ProblemFile) -> Result<(), Located> {
    let least = usize::from(problem.goal.robot.is_none());
    length("goal.object", problem.goal.objects.len(), least, MOST_GOALS)?;
    if let Some(robot) = &problem.goal.robot {
        check_robot(problem, robot)?;
    }
    for (index, goal) in problem.goal.objects.iter().enumerate() {
        check_goal(problem, goal, &format!("goal.object[{index}]"))?;
    }
    Ok(())
}

fn check_robot(problem: &ProblemFile, goal: &RobotGoal) -> Result<(), Located> {
    if goal.base.is_none() && goal.joints.is_none() && goal.tool.is_none() {
        let text = "must have at least one of `base`, `joints`, `tool`";
        return Err(Flaw::Inconsistent(text.to_owned()).at("goal.robot"));
    }
    let [least, most] = TOLERANCE_RANGE;
    within("goal.robot.tolerance_m", goal.tolerance_m, least, most)?;
    within("goal.robot.tolerance_rad", goal.tolerance_rad, least, PI)?;
    if let Some([x, y, yaw]) = goal.base {
        in_bounds("goal.robot.base[0]", x, "base_x", problem.bounds.base_x)?;
        in_bounds("goal.robot.base[1]", y, "base_y", problem.bounds.base_y)?;
        angle("goal.robot.base[2]", yaw)?;
        within("goal.robot.base[2]", yaw, -PI, PI)?;
    }
    for (index, turn) in goal.tool.iter().flat_map(|tool| tool.rpy).enumerate() {
        angle(&format!("goal.robot.tool.rpy[{index}]"), turn)?;
    }
    Ok(())
}

fn check_goal(problem: &ProblemFile, goal: &ObjectGoal, key: &str) -> Result<(), Located> {
    object(problem, &format!("{key}.object"), &goal.object)?;
    let [least, most] = TOLERANCE_RANGE;
    within(&format!("{key}.tolerance_m"), goal.tolerance_m, least, most)?;
    goal.yaw.map_or(Ok(()), |yaw| angle(&format!("{key}.yaw"), yaw))?;
    within(&format!("{key}.yaw_tolerance"), goal.yaw_tolerance, least, PI)?;
    if let Some(name) = &goal.on {
        surface(problem, &format!("{key}.on"), name)?;
        check_allowed(problem, goal, name, key)?;
    }
    let Some(target) = goal.target() else {
        let text = "must have either `on`, alone or with one of `at` and `region`, or `position` alone";
        return Err(Flaw::Inconsistent(text.to_owned()).at(key));
    };
    if goal.on.is_some() && goal.state() == GoalState::Held {
        let text = "is `held`, but what is in the hand is on no surface; give a `position` above it instead of `on`";
        return Err(Flaw::Inconsistent(text.to_owned()).at(format!("{key}.state")));
    }
    match target {
        GoalTarget::On { .. } => Ok(()),
        GoalTarget::Within { .. } if goal.region.is_none() => Ok(()),
        GoalTarget::Within { region, .. } => {
            for (axis, letter) in ["x", "y"].into_iter().enumerate() {
                let range = [region.min[axis], region.max[axis]];
                ordered(&format!("{key}.region, {letter} from min to max,"), range)?;
            }
            Ok(())
        }
        GoalTarget::At { position } => {
            let ranges = problem.bounds.ranges();
            for (axis, (value, (name, range))) in position.into_iter().zip(ranges.into_iter().skip(2)).enumerate() {
                in_bounds(&format!("{key}.position[{axis}]"), value, name, range)?;
            }
            if goal.state() == GoalState::Released {
                let text = "is `released`, but a goal with `position` is off every surface";
                return Err(Flaw::Inconsistent(text.to_owned()).at(format!("{key}.state")));
            }
            Ok(())
        }
    }
}

/// The goal's surface is one on which its object may stand.
fn check_allowed(problem: &ProblemFile, goal: &ObjectGoal, name: &str, key: &str) -> Result<(), Located> {
    let Some(object) = problem.object(&goal.object) else {
        return Ok(());
    };
    let allowed = problem.allowed_surfaces(object);
    if allowed.contains(&name) {
        return Ok(());
    }
    let text = format!("is `{name}`, but `{}` may only stand on: {}", object.name, allowed.join(", "));
    Err(Flaw::Inconsistent(text).at(format!("{key}.on")))
}
