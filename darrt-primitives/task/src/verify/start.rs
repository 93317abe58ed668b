//! The plan starts where the problem does.

use darrt_primitives::kinematics::limit::wrap_to_pi;

use super::motion::State;
use super::options::VerifyOptions;
use super::refusal::{Refusal, RefusalKind};
use super::robot::Robot;
use super::world::World;
use crate::problem_file::ProblemFile;
use crate::robot::RobotFacts;

/// How far an object may be from where the problem puts it, metres and radians.
const SAME_PLACE: f64 = 1e-6;

/// Compares the first state with the problem.
pub(super) fn check(
    state: &State,
    problem: &ProblemFile,
    (robot, facts): (&Robot, &RobotFacts),
    world: &World<'_>,
    options: &VerifyOptions,
) -> Result<(), Refusal> {
    let refuse = |message: String| Refusal::whole(RefusalKind::Start, format!("the plan starts elsewhere: {message}"));
    let [x, y, yaw] = problem.robot.base;
    let off = [state.base[0] - x, state.base[1] - y, wrap_to_pi(state.base[2] - yaw)];
    if off.iter().any(|d| d.abs() > options.rounding) {
        return Err(refuse(format!(
            "the base is at {:?}, the problem puts it at {:?}",
            state.base, problem.robot.base
        )));
    }
    for (name, expected) in &facts.start {
        let expected = *expected;
        let Some(variable) = robot.tree.variable_index(name) else {
            return Err(refuse(format!("the robot has no joint `{name}`")));
        };
        let found = state.joints.get(variable).copied().unwrap_or(f64::NAN);
        let off = if robot.is_continuous(variable) { wrap_to_pi(found - expected) } else { found - expected };
        if off.is_nan() || off.abs() > options.rounding {
            return Err(refuse(format!("`{name}` is {found}, the problem puts it at {expected}")));
        }
    }
    for (movable, pose) in world.movables.iter().zip(&state.objects) {
        let distance = (pose.translation.vector - movable.world_from_start.translation.vector).norm();
        let angle = pose.rotation.angle_to(&movable.world_from_start.rotation);
        if distance > SAME_PLACE || angle > SAME_PLACE {
            let name = &movable.spec.name;
            return Err(refuse(format!(
                "`{name}` is {distance:.6} m and {angle:.6} rad from where the problem puts it"
            )));
        }
    }
    Ok(())
}
