//! The goal holds at the end.

use darrt_primitives::kinematics::limit::wrap_to_pi;
use nalgebra::{Isometry3, Vector2, Vector3};

use super::hands::Hands;
use super::mode::Mode;
use super::motion::State;
use super::refusal::{Refusal, RefusalKind};
use super::robot::{Robot, world_from_robot};
use super::world::{Movable, World};
use crate::plan_file::Partial;
use crate::problem_file::{GoalState, GoalTarget, ObjectGoal, ProblemFile, RobotGoal, Symmetry};
use crate::robot::RobotFacts;

/// Checks the goals of every object: one of its alternatives must hold, but for what a partial plan leaves to do.
pub(super) fn check(
    problem: &ProblemFile,
    partial: Option<&Partial>,
    world: &World<'_>,
    (hands, facts): (&Hands, &RobotFacts),
    end: &State,
    modes: &[Mode],
) -> Result<(), Refusal> {
    if let Some(partial) = partial {
        check_parts(problem, partial)?;
    }
    let robot_goal = problem.goal.robot.as_ref().filter(|_| partial.is_none_or(|partial| !partial.robot_remains));
    if let Some(flaw) = robot_goal.and_then(|goal| robot_flaw(goal, hands, facts, end)) {
        return Err(Refusal::whole(RefusalKind::Goal, format!("the goal does not hold: {flaw}")));
    }
    let remains = |name: &str| partial.is_some_and(|partial| partial.remains.iter().any(|other| other == name));
    for (name, alternatives) in problem.goal.by_object().into_iter().filter(|(name, _)| !remains(name)) {
        let refuse = |message: String| Refusal::whole(RefusalKind::Goal, format!("the goal does not hold: {message}"));
        let object = world.object(name).ok_or_else(|| refuse(format!("there is no object `{name}`")))?;
        let (Some(pose), Some(mode), Some(movable)) =
            (end.objects.get(object), modes.get(object), world.movables.get(object))
        else {
            return Err(refuse(format!("`{name}` is nowhere")));
        };
        let mut flaws = Vec::new();
        for goal in alternatives {
            match flaw(goal, movable, world, pose, mode) {
                None => {
                    flaws.clear();
                    break;
                }
                Some(flaw) => flaws.push(flaw),
            }
        }
        if !flaws.is_empty() {
            return Err(refuse(format!("`{name}` {}", flaws.join("; or "))));
        }
    }
    Ok(())
}

/// A partial plan says of every part of the goal whether it is met, and leaves something to do.
fn check_parts(problem: &ProblemFile, partial: &Partial) -> Result<(), Refusal> {
    let refuse = |message: String| Err(Refusal::whole(RefusalKind::Malformed, format!("`partial`: {message}")));
    let goals = problem.goal.by_object();
    let is_goal = |name: &str| goals.iter().any(|(other, _)| *other == name);
    let mut named = Vec::new();
    for name in partial.met.iter().chain(&partial.remains) {
        if !is_goal(name) {
            return refuse(format!("`{name}` has no goal"));
        }
        if named.contains(&name.as_str()) {
            return refuse(format!("`{name}` is named twice"));
        }
        named.push(name.as_str());
    }
    if let Some((name, _)) = goals.iter().find(|(name, _)| !named.contains(name)) {
        return refuse(format!("it says nothing of `{name}`"));
    }
    if partial.robot_remains && problem.goal.robot.is_none() {
        return refuse("the robot has no goal".to_owned());
    }
    if partial.remains.is_empty() && !partial.robot_remains {
        return refuse("nothing remains, so it is no partial plan".to_owned());
    }
    Ok(())
}

/// What the goal of the robot lacks. Any of its hands may have the tool where it is wanted.
fn robot_flaw(goal: &RobotGoal, hands: &Hands, facts: &RobotFacts, end: &State) -> Option<String> {
    let (most_m, most_rad) = (goal.tolerance_m, goal.tolerance_rad);
    let is_off = |metres: f64, radians: f64| metres > most_m || radians > most_rad;
    if let Some([x, y, yaw]) = goal.base {
        let (metres, radians) = ((end.base[0] - x).hypot(end.base[1] - y), wrap_to_pi(end.base[2] - yaw).abs());
        if is_off(metres, radians) {
            return Some(format!("the base is {metres:.4} m and {radians:.4} rad from its goal"));
        }
    }
    let robot = &hands.first;
    for (name, wanted) in facts.all_arm_joints().into_iter().zip(goal.joints.iter().flatten()) {
        let Some(variable) = robot.tree.variable_index(name) else {
            return Some(format!("the robot has no joint `{name}`"));
        };
        let found = end.joints.get(variable).copied().unwrap_or(f64::NAN);
        let off = if robot.is_continuous(variable) { wrap_to_pi(found - wanted) } else { found - wanted }.abs();
        if off.is_nan() || off > most_rad {
            return Some(format!("`{name}` is {found}, its goal is {wanted} within {most_rad}"));
        }
    }
    let wanted = goal.tool?.world_from_tool();
    let mut links = Vec::new();
    robot.link_poses(&end.joints, &mut links);
    let off = |robot: &Robot| {
        let tool = world_from_robot(&end.base) * links.get(robot.tool)?;
        let metres = (tool.translation.vector - wanted.translation.vector).norm();
        Some((metres, tool.rotation.angle_to(&wanted.rotation)))
    };
    let (metres, radians) = hands.all().filter_map(off).min_by(|a, b| {
        let is_off = |(metres, radians): &(f64, f64)| is_off(*metres, *radians);
        is_off(a).cmp(&is_off(b)).then(a.0.total_cmp(&b.0))
    })?;
    is_off(metres, radians).then(|| format!("the tool is {metres:.4} m and {radians:.4} rad from its goal"))
}

/// What one goal lacks.
fn flaw(
    goal: &ObjectGoal,
    movable: &Movable<'_>,
    world: &World<'_>,
    pose: &Isometry3<f64>,
    mode: &Mode,
) -> Option<String> {
    match (goal.state(), mode) {
        (GoalState::Released, Mode::Held { .. }) => return Some("is still in the hand".to_owned()),
        (GoalState::Held, Mode::Resting { .. }) => return Some("is not in the hand".to_owned()),
        _ => {}
    }
    place_flaw(goal, movable, world, pose, mode).or_else(|| turn_flaw(goal, movable, pose))
}

fn place_flaw(
    goal: &ObjectGoal,
    movable: &Movable<'_>,
    world: &World<'_>,
    pose: &Isometry3<f64>,
    mode: &Mode,
) -> Option<String> {
    let at = pose.translation.vector;
    let (surface, beside) = match goal.target()? {
        GoalTarget::At { position } => {
            let off = (at - Vector3::from(position)).norm();
            let text =
                format!("is {off:.4} m from the goal {position:?}, at most {} m is near enough", goal.tolerance_m);
            return (off > goal.tolerance_m).then_some(text);
        }
        GoalTarget::On { surface, at: centre } => (surface, at.xy() - Vector2::from(centre)),
        GoalTarget::Within { surface, region } => {
            let nearest = at.xy().sup(&Vector2::from(region.min)).inf(&Vector2::from(region.max));
            (surface, at.xy() - nearest)
        }
    };
    let plane =
        movable.surfaces.iter().find_map(|&i| Some((i, world.surface(i)?)).filter(|(_, s)| s.name() == surface));
    let Some((index, plane)) = plane else { return Some(format!("may not stand on `{surface}`")) };
    // Within a tolerance of the seam to a flush surface it may stand on that.
    let object = world.object(&movable.spec.name).unwrap_or(usize::MAX);
    if let Mode::Resting { surface: on } = mode
        && (!world.across(object, *on).contains(&index) || plane.depth(&at.xy().into()) < -goal.tolerance_m)
    {
        return Some(format!("does not stand on `{surface}`"));
    }
    let above = at.z - movable.depth_below_origin - plane.height();
    if above.abs() > goal.tolerance_m {
        return Some(format!("is {above:.4} m above `{surface}`"));
    }
    let off = beside.norm();
    let text = format!("is {off:.4} m from the goal on `{surface}`, at most {} m is near enough", goal.tolerance_m);
    (off > goal.tolerance_m).then_some(text)
}

/// Upright, and turned as wanted.
fn turn_flaw(goal: &ObjectGoal, movable: &Movable<'_>, pose: &Isometry3<f64>) -> Option<String> {
    let lean = (pose.rotation * Vector3::z()).angle(&Vector3::z());
    if lean > goal.yaw_tolerance {
        return Some(format!("leans {lean:.4} rad, at most {} is upright", goal.yaw_tolerance));
    }
    let wanted = goal.yaw.filter(|_| movable.spec.symmetry() != Symmetry::Z)?;
    let yaw = pose.rotation.euler_angles().2;
    let off = wrap_to_pi(yaw - wanted).abs();
    let text = format!("is turned by {yaw:.4} rad, the goal is {wanted} within {}", goal.yaw_tolerance);
    (off > goal.yaw_tolerance).then_some(text)
}
