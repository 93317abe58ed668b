//! The goal holds at the end.

use darrt_primitives::kinematics::limit::wrap_to_pi;
use nalgebra::{Isometry3, Vector2, Vector3};

use super::mode::Mode;
use super::motion::State;
use super::refusal::{Refusal, RefusalKind};
use super::world::{Movable, World};
use crate::problem_file::{GoalState, GoalTarget, ObjectGoal, ProblemFile, Symmetry};

/// Checks the goals of every object: one of its alternatives must hold.
pub(super) fn check(problem: &ProblemFile, world: &World<'_>, end: &State, modes: &[Mode]) -> Result<(), Refusal> {
    for (name, alternatives) in problem.goal.by_object() {
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
