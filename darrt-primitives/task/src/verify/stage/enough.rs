//! How many states of a segment must be looked at so that nothing passes between two of them, however thin it is.

use super::super::approach::Speeds;
use super::super::margins::MarginKind;
use super::Stage;

/// Pairs that may come nearer than this count as if they kept it, metres: what is thicker than twice as much is seen all the same.
const FINEST_M: f64 = 5e-6;

impl Stage {
    /// At least `parts` parts of the segment: so many that the two of no pair approach by more than twice the distance that they
    /// keep at the states looked at. A pair that touched between two states would be nearer than that at one of them, because to
    /// touch it must come there from the one and get away to the other.
    pub(in crate::verify) fn least_parts(&self, speeds: &Speeds, parts: usize) -> usize {
        let needs = self.classes.iter().map(|class| {
            let way_m = speeds.of(class.between);
            let kept = MarginKind::ALL.iter().zip(&class.pairs).filter(|(_, pairs)| !pairs.dues.is_empty());
            let kept_m = kept.map(|(kind, pairs)| {
                let least_m = self.margins.least_m[kind.index()];
                if !self.has_exceptions {
                    return least_m;
                }
                let may_m = pairs.dues.iter().map(|due| self.pairs[due.pair].may_m);
                may_m.fold(least_m, f64::min)
            });
            way_m / (2.0 * kept_m.fold(f64::INFINITY, f64::min).max(FINEST_M))
        });
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "clamped to a range that fits any usize"
        )]
        let least = needs.fold(0.0, f64::max).ceil().clamp(0.0, 1e9) as usize;
        parts.max(least)
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};

    use crate::plan_file::{PlanFile, Pose};
    use crate::planning::PlanRequest;
    use crate::problem_file::{Obstacle, ProblemFile, ShapeSpec};
    use crate::testing::{facts, planned};
    use crate::verify::verify;

    /// A card of 0.2 mm that is carried across a desk; nothing keeps more than 0.1 mm from anything.
    const CARD: &str = r#"
format = "darrt-problem"
version = 1
name = "card"
primitives = ["Arm-Transit", "Straight-Line-Arm-Transit", "Arm-Rigid-Transfer", "Base-Transit", "Base-Rigid-Transfer", "Pick", "Place"]
[robot]
base = [-1.05, 0.0, 0.0]
[[obstacle]]
name = "desk"
shape = { box = { size = [0.9, 1.1, 0.7] } }
at = [0.0, 0.0, 0.35]
[[surface]]
name = "desk"
top_of = "desk"
[[object]]
name = "card"
shape = { box = { size = [0.0002, 0.08, 0.1] } }
mass_kg = 0.02
on = "desk"
at = [-0.25, 0.15]
yaw = 0.3
grasps = ["overhead"]
overhead = { opening_m = 0.03 }
[[goal.object]]
object = "card"
on = "desk"
at = [-0.25, -0.25]
[safety]
least_margin_m = 0.0001
contact_margin_m = 0.0001
"#;

    fn isometry(pose: &Pose) -> Isometry3<f64> {
        let [x, y, z] = pose.position;
        let [i, j, k, w] = pose.quaternion;
        Isometry3::from_parts(Translation3::new(x, y, z), UnitQuaternion::from_quaternion(Quaternion::new(w, i, j, k)))
    }

    /// Places between two waypoints at which a sheet in the plane of the card is in its way, below the fingers.
    fn places(plan: &PlanFile) -> Vec<Isometry3<f64>> {
        let mut places = Vec::new();
        for step in &plan.steps {
            for two in step.waypoints.windows(2) {
                let [from, to] = [&two[0], &two[1]].map(|waypoint| isometry(&waypoint.objects["card"]));
                let way = to.translation.vector - from.translation.vector;
                let across = from.rotation * nalgebra::Vector3::x();
                if way.norm() > 1e-4 && across.dot(&way).abs() > 0.6 * way.norm() {
                    let below = Translation3::new(0.0, 0.02, -0.035);
                    places.extend([0.31, 0.5, 0.77].map(|share| from.lerp_slerp(&to, share) * below));
                }
            }
        }
        places
    }

    #[test]
    fn no_sheet_is_too_thin_to_be_seen() {
        let problem = ProblemFile::from_toml(CARD, "card").unwrap();
        // One in which the card moves across itself.
        let plans = (0..12).filter_map(|seed| planned(&PlanRequest::new(problem.clone(), seed)).plan);
        let found = plans.map(|plan| (places(&plan), plan)).find(|(places, _)| places.len() >= 8);
        let (places, plan) = found.expect("a plan in which the card moves across itself");
        let facts = facts(&plan.problem);
        verify(&plan, &facts).unwrap();
        let step = places.len().div_ceil(8);
        for thickness_m in [2e-4, 5e-5, 1e-5] {
            for place in places.iter().step_by(step) {
                let mut plan = plan.clone();
                let turn = place.rotation;
                plan.problem.obstacles.push(Obstacle {
                    name: "sheet".to_owned(),
                    shape: ShapeSpec::Box { size: [thickness_m, 0.02, 0.02] },
                    at: vec![place.translation.x, place.translation.y, place.translation.z],
                    standing_on: None,
                    yaw: None,
                    rpy: None,
                    quaternion: Some([turn.i, turn.j, turn.k, turn.w]),
                });
                let refusal = verify(&plan, &facts).unwrap_err();
                assert!(refusal.to_string().contains("sheet"), "{refusal}");
            }
        }
    }
}
