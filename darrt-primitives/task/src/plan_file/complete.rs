//! Every waypoint of a plan lists the joints and objects that its start lists.

use super::{PlanFile, Waypoint};
use crate::problem_file::PrimitiveName;

/// A joint or an object that a waypoint leaves out.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("step {step} ({primitive}): waypoint {waypoint} lacks the {what} `{name}`, which the start lists")]
pub struct Gap {
    /// Number of the step, from 1.
    pub step: usize,
    /// Its primitive.
    pub primitive: PrimitiveName,
    /// Index of the waypoint in the step, from 0.
    pub waypoint: usize,
    /// `joint` or `object`.
    pub what: &'static str,
    /// Its name.
    pub name: String,
}

impl PlanFile {
    /// Whether every waypoint lists all that [`PlanFile::start`] lists. A plan with a gap is refused by the verifier too,
    /// but as one whose steps do not chain.
    ///
    /// # Errors
    /// The first [`Gap`] with step, waypoint and name.
    pub fn check_complete(&self) -> Result<(), Gap> {
        for (step, action) in (1..).zip(&self.steps) {
            for (waypoint, at) in action.waypoints.iter().enumerate() {
                if let Some((what, name)) = first_missing(&self.start, at) {
                    return Err(Gap {
                        step,
                        primitive: action.primitive.clone(),
                        waypoint,
                        what,
                        name: name.to_owned(),
                    });
                }
            }
        }
        Ok(())
    }
}

fn first_missing<'a>(start: &'a Waypoint, at: &Waypoint) -> Option<(&'static str, &'a str)> {
    let joint = start.joints.keys().find(|name| !at.joints.contains_key(*name)).map(|name| ("joint", &**name));
    let object = || start.objects.keys().find(|name| !at.objects.contains_key(*name));
    joint.or_else(|| object().map(|name| ("object", &**name)))
}

#[cfg(test)]
mod tests {
    use crate::plan_file::read::tests::sample;

    #[test]
    fn what_is_missing_is_named_with_step_and_waypoint() {
        let mut plan = sample();
        assert_eq!(plan.check_complete(), Ok(()));
        plan.steps[0].waypoints[1].objects.clear();
        let flaw = plan.check_complete().unwrap_err().to_string();
        assert_eq!(flaw, "step 1 (Pick): waypoint 1 lacks the object `plate`, which the start lists");
        plan.steps[0].waypoints[0].joints.remove("c_joint");
        let flaw = plan.check_complete().unwrap_err().to_string();
        assert_eq!(flaw, "step 1 (Pick): waypoint 0 lacks the joint `c_joint`, which the start lists");
    }
}
