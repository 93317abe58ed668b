//! Can the base stand where the robot's own goal wants it?

use darrt_geom::Body;
use darrt_geom::clearance::between;
use darrt_geom::scene::Scene;
use darrt_primitives::goal::TabletopGoal;
use darrt_primitives::manipulator::{Configuration, LinkGroup, Manipulator};
use darrt_primitives::tabletop::{Tabletop, TabletopState};
use nalgebra::{Isometry3, Point3, Vector3};

use crate::planning_error::PlanningError;

/// Checks that no link which the base carries is deeper in a fixed body than the tolerance of the goal lets it out of it again.
///
/// How deep something is in a mesh is not known, so meshes are left to the search.
///
/// # Errors
/// [`PlanningError::BaseGoalBlocked`] with link and body; [`PlanningError::Geometry`] when that cannot be said.
pub(super) fn check<M: Manipulator>(
    m: &Tabletop<M>,
    goal: &TabletopGoal<M::Joints>,
    scene: &Scene,
    start: &TabletopState<M>,
) -> Result<(), PlanningError> {
    let Some((robot_goal, base)) = goal.robot().and_then(|robot| Some((robot, robot.base?))) else { return Ok(()) };
    let robot = m.manipulator();
    let mut poses = vec![Isometry3::identity(); robot.links().len()];
    robot.link_poses(&Configuration { base, ..start.robot }, robot.hand().max_gap_m(), &mut poses);
    let axis = Vector3::new(base[0], base[1], 0.0);
    for (link, pose) in robot.links().iter().zip(&poses).filter(|(link, _)| link.group == LinkGroup::Base) {
        let slack_m = robot_goal.tolerance_m + robot_goal.tolerance_rad * reach_m(&link.body, pose, &axis);
        for fixed in scene.bodies() {
            let deep_m = -between(&link.body, pose, &fixed.body, &fixed.world_from_body)?.distance;
            if deep_m > slack_m {
                let (link, by) = (link.body.name.to_string(), fixed.body.name.to_string());
                return Err(PlanningError::BaseGoalBlocked { link, by, base, deep_m });
            }
        }
    }
    Ok(())
}

/// No point of the body is farther from the vertical through `axis`, metres.
fn reach_m(body: &Body, pose: &Isometry3<f64>, axis: &Vector3<f64>) -> f64 {
    let (low, high) = body.local_aabb();
    let half = 0.5 * (high - low);
    let centre = pose * Point3::from(low.coords + half);
    (centre.coords.xy() - axis.xy()).norm() + half.norm()
}
