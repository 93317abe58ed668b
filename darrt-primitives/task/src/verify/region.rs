//! Where a plan takes place: fixed bodies far from all of it need not be looked at, however many there are.

use nalgebra::{Isometry3, Point2, Vector2};

use super::hands::Hands;
use super::solid::Solid;
use super::world::World;
use crate::plan_file::{PlanFile, Waypoint};

/// What is farther than this from all that a plan moves is not looked at, metres: more than any margin.
const FAR_M: f64 = 1.0;

/// A rectangle on the floor in which the base and all objects stay, and how far what moves reaches out of it.
#[derive(Debug)]
pub(super) struct Region {
    low: Point2<f64>,
    high: Point2<f64>,
    reach_m: f64,
}

impl Region {
    /// Everywhere.
    pub(super) fn everywhere() -> Self {
        Self { low: Point2::origin(), high: Point2::origin(), reach_m: f64::INFINITY }
    }

    /// Where the base and the objects of a plan are at its waypoints. Between two of them the base goes straight, and a pushed object
    /// on a line or an arc, which leaves the line by less than its length; what is held is as near to the base as the hand is.
    pub(super) fn of(plan: &PlanFile, hands: &Hands, world: &World<'_>) -> Self {
        let objects_m = world.movables.iter().map(|movable| movable.solid.reach()).fold(0.0, f64::max);
        let holds = plan.steps.iter().filter_map(|step| step.holds.as_ref());
        let offsets = holds.map(|hold| Isometry3::from(hold.tool_from_object).translation.vector.norm());
        let held_m = objects_m + offsets.fold(0.0, f64::max);
        let robots_m = hands.all().map(|robot| robot.extents(held_m).first().copied().unwrap_or(f64::INFINITY));
        let robot_m = robots_m.fold(0.0, f64::max);
        let waypoints = || std::iter::once(&plan.start).chain(plan.steps.iter().flat_map(|step| &step.waypoints));
        let objects = |waypoint: &Waypoint| -> Vec<Point2<f64>> {
            waypoint.objects.values().map(|pose| Point2::new(pose.position[0], pose.position[1])).collect()
        };
        let (mut low, mut high) = (Point2::from([f64::INFINITY; 2]), Point2::from([f64::NEG_INFINITY; 2]));
        let (mut longest_m, mut before): (f64, Vec<_>) = (0.0, objects(&plan.start));
        let mut is_finite = true;
        for waypoint in waypoints() {
            let now = objects(waypoint);
            for (a, b) in before.iter().zip(&now) {
                longest_m = longest_m.max((b - a).norm());
            }
            for at in now.iter().copied().chain([Point2::new(waypoint.base[0], waypoint.base[1])]) {
                is_finite &= at.x.is_finite() && at.y.is_finite();
                (low, high) = (low.inf(&at), high.sup(&at));
            }
            before = now;
        }
        let reach_m = robot_m.max(objects_m + longest_m);
        if is_finite { Self { low, high, reach_m } } else { Self::everywhere() }
    }

    /// Is all of a fixed solid farther than any margin from all that the plan moves?
    pub(super) fn is_far(&self, solid: &Solid, world_from_solid: &Isometry3<f64>) -> bool {
        let centre = solid.world_centre(world_from_solid).xy();
        let nearest = centre.coords.sup(&self.low.coords).inf(&self.high.coords);
        let beside: Vector2<f64> = centre.coords - nearest;
        // Also where one of them is infinite, or no number.
        beside.norm() - solid.radius > self.reach_m + FAR_M
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Isometry3, Vector3};

    use super::*;
    use crate::planning::PlanRequest;
    use crate::problem_file::{Obstacle, ShapeSpec};
    use crate::testing::{builtin, facts, planned};
    use crate::verify::verify;

    fn block(name: String, at: [f64; 3]) -> Obstacle {
        Obstacle {
            name,
            shape: ShapeSpec::Box { size: [0.2, 0.2, 0.2] },
            at: at.to_vec(),
            standing_on: None,
            yaw: None,
            rpy: None,
            quaternion: None,
        }
    }

    #[test]
    fn what_is_far_costs_no_look_and_what_is_near_is_seen() {
        let plan = planned(&PlanRequest::new(builtin("bowl").unwrap(), 0)).plan.unwrap();
        let facts = facts(&plan.problem);
        let usual = verify(&plan, &facts).unwrap();
        let mut crowded = plan.clone();
        let ring = (0..300).map(|i| (f64::from(i), (f64::from(i) * 0.1).sin_cos()));
        let far = ring.map(|(i, (sin, cos))| block(format!("far {i}"), [(8.0 + i) * cos, (8.0 + i) * sin, 1.0]));
        crowded.problem.obstacles.extend(far);
        assert_eq!(verify(&crowded, &facts).unwrap(), usual);
        // Wherever the bowl or the base comes, nothing that is there counts as far.
        let (hands, world) = (Hands::new(&facts).unwrap(), World::new(&crowded.problem).unwrap());
        let region = Region::of(&crowded, &hands, &world);
        let (far, _) = world.fixed.iter().partition::<Vec<_>, _>(|(solid, pose)| region.is_far(solid, pose));
        assert_eq!(far.len(), 300);
        let (solid, _) = world.fixed.last().unwrap();
        for waypoint in plan.steps.iter().flat_map(|step| &step.waypoints) {
            let [x, y, _] = waypoint.base;
            for direction in 0..8 {
                let (sin, cos) = (f64::from(direction) * std::f64::consts::FRAC_PI_4).sin_cos();
                let beside = Isometry3::from_parts(
                    Vector3::new(x + 1.5 * cos, y + 1.5 * sin, 1.0).into(),
                    Isometry3::identity().rotation,
                );
                assert!(!region.is_far(solid, &beside));
            }
            let [x, y, z] = waypoint.objects["bowl"].position;
            assert!(!region.is_far(solid, &Isometry3::translation(x, y, z)));
        }
    }
}
