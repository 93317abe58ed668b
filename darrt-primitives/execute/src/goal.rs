//! Is everything where it should be at the end? The paper's rule: the object at its goal, nothing else moved or knocked over.

use darrt_geom::Scene;
use darrt_primitives::kinematics::limit::wrap_to_pi;
use darrt_task::problem_file::{GoalState, GoalTarget, ObjectGoal, ProblemFile, Symmetry};
use nalgebra::{Isometry3, Vector2, Vector3};
use serde::Serialize;

/// An object within this of its goal, upright, counts as near it, metres: how the paper's runs can be judged by eye.
pub const NEAR_M: f64 = 0.05;
/// How far an object that should stand may lean, degrees.
pub(crate) const UPRIGHT_DEG: f64 = 3.0;
/// How far its bottom may be above or below its surface, metres.
const HEIGHT_M: f64 = 0.005;
/// How far an object without a goal may be from where the plan leaves it, metres.
pub const MOVED_M: f64 = 0.02;

/// How an object ends.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ObjectEnd {
    /// The object.
    pub object: String,
    /// How far it is from its nearest goal, or, without one, from where the plan leaves it; metres.
    pub off_m: f64,
    /// How far its axis leans from where it should point, degrees.
    pub lean_deg: f64,
    /// Is it where it should be, within the tolerance of the problem?
    pub is_there: bool,
    /// Is it within [`NEAR_M`] of there, upright?
    pub is_near: bool,
}

/// What an object is doing.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Now {
    pub(crate) pose: Isometry3<f64>,
    pub(crate) is_in_hand: bool,
    /// Where the plan leaves it.
    pub(crate) planned: Isometry3<f64>,
    /// How far it reaches below its origin, metres.
    pub(crate) depth_m: f64,
}

/// Judges the end of one object.
pub(crate) fn end(problem: &ProblemFile, scene: &Scene, name: &str, now: &Now) -> ObjectEnd {
    let object = problem.objects.iter().find(|object| object.name == name);
    let is_round = object.is_some_and(|object| object.symmetry() == Symmetry::Z);
    let goals: Vec<_> = problem.goal.objects.iter().filter(|goal| goal.object == name).collect();
    let mut ends = goals.iter().map(|goal| of_goal(goal, scene, name, now, is_round));
    let first = ends.next();
    let nearest = first.map(|first| {
        ends.fold(first, |best, end| {
            let key = |end: &ObjectEnd| (!end.is_there, !end.is_near, end.off_m);
            if key(&end).partial_cmp(&key(&best)).is_some_and(std::cmp::Ordering::is_lt) { end } else { best }
        })
    });
    nearest.unwrap_or_else(|| of_plan(name, now))
}

fn of_plan(name: &str, now: &Now) -> ObjectEnd {
    let off_m = (now.pose.translation.vector - now.planned.translation.vector).norm();
    let lean_deg = lean_deg(&now.pose, &now.planned);
    let is_there = off_m <= MOVED_M && lean_deg <= UPRIGHT_DEG;
    ObjectEnd { object: name.to_owned(), off_m, lean_deg, is_there, is_near: is_there }
}

/// The angle between the axes of an object in two poses, degrees.
pub(crate) fn lean_deg(a: &Isometry3<f64>, b: &Isometry3<f64>) -> f64 {
    (a.rotation * Vector3::z()).angle(&(b.rotation * Vector3::z())).to_degrees()
}

fn of_goal(goal: &ObjectGoal, scene: &Scene, name: &str, now: &Now, is_round: bool) -> ObjectEnd {
    let at = now.pose.translation.vector;
    let state = goal.state();
    let is_held_rightly = match state {
        GoalState::Released => !now.is_in_hand,
        GoalState::Held => now.is_in_hand,
        GoalState::Any => true,
    };
    let over = |surface: &str, beside: Vector2<f64>| {
        let plane = scene.surface(surface);
        let height = plane.map_or(f64::INFINITY, |plane| at.z - now.depth_m - plane.height());
        let is_over = plane.is_some_and(|plane| plane.depth(&at.xy().into()) >= 0.0);
        (beside.norm(), is_over && height.abs() <= HEIGHT_M)
    };
    let (off_m, is_on) = match goal.target() {
        Some(GoalTarget::On { surface, at: centre }) => over(surface, at.xy() - Vector2::from(centre)),
        Some(GoalTarget::Within { surface, region }) => {
            let nearest = at.xy().sup(&Vector2::from(region.min)).inf(&Vector2::from(region.max));
            over(surface, at.xy() - nearest)
        }
        Some(GoalTarget::At { position }) => ((at - Vector3::from(position)).norm(), true),
        None => (f64::INFINITY, false),
    };
    // What is in the hand may lean as the plan has it lean.
    let upright = if now.is_in_hand { now.planned } else { Isometry3::identity() };
    let lean_deg = lean_deg(&now.pose, &upright);
    let yaw = now.pose.rotation.euler_angles().2;
    let is_turned = |most: f64| is_round || goal.yaw.is_none_or(|wanted| wrap_to_pi(yaw - wanted).abs() <= most);
    let is_right = is_held_rightly && is_on;
    ObjectEnd {
        object: name.to_owned(),
        off_m,
        lean_deg,
        is_there: is_right
            && off_m <= goal.tolerance_m
            && lean_deg.to_radians() <= goal.yaw_tolerance
            && is_turned(goal.yaw_tolerance),
        is_near: is_right
            && off_m <= goal.tolerance_m.max(NEAR_M)
            && lean_deg <= goal.yaw_tolerance.to_degrees().max(UPRIGHT_DEG)
            && is_turned(goal.yaw_tolerance.max(0.35)),
    }
}
