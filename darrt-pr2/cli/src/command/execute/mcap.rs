//! One run as a recording: joint states, frames and events as they truly were, and where the plan has the objects.

use darrt_execute::recording::Recording;
use darrt_primitives::kinematics::KinematicTree;
use darrt_primitives::manipulator::world_from_base;
use darrt_task::plan_file::PlanFile;
use darrt_task::robot::RobotFacts;
use darrt_task::trajectory::WORLD;
use nalgebra::Isometry3;
use serde_json::json;

use crate::command::tape::Tape;

/// A frame nearer to where it was told to be is there still, metres and radians.
const STILL: f64 = 1e-7;

/// The bytes of the recording, or why there are none.
pub(super) fn file(plan: &PlanFile, facts: &RobotFacts, recording: &Recording) -> Result<Vec<u8>, String> {
    let tree = KinematicTree::new(&facts.description).map_err(|error| error.to_string())?;
    write(plan, &tree, recording).map_err(|error| error.to_string())
}

fn write(plan: &PlanFile, tree: &KinematicTree, recording: &Recording) -> mcap::McapResult<Vec<u8>> {
    let mut tape = Tape::new(is_still)?;
    let names: Vec<String> = tree.variables().iter().map(|variable| variable.name.to_string()).collect();
    let as_planned: Vec<String> =
        plan.problem.objects.iter().map(|object| format!("{} as planned", object.name)).collect();
    let mut links = vec![Isometry3::identity(); tree.link_count()];
    let (mut steps, mut looks) = (recording.steps.iter().peekable(), recording.looks_s.iter().peekable());
    for (sequence, frame) in (0..).zip(&recording.frames) {
        tape.begin(sequence, frame.time_s);
        tape.joints(&names, &frame.joints, &[])?;
        // The lengths are the tree's own.
        let _ = tree.forward(&frame.joints, &world_from_base(&frame.base), &mut links);
        let mut frames = Vec::new();
        for (link, name) in tree.link_names().iter().enumerate() {
            let at = links.get(link).copied().unwrap_or_default();
            match tree.parent(link).filter(|parent| *parent != link) {
                Some(parent) => {
                    let above = links.get(parent).copied().unwrap_or_default();
                    frames.push((
                        tree.link_names().get(parent).map_or(WORLD, |name| name),
                        &**name,
                        above.inverse() * at,
                    ));
                }
                None => frames.push((WORLD, &**name, at)),
            }
        }
        let names = plan.problem.objects.iter().zip(&as_planned);
        for ((object, as_planned), (now, planned)) in names.zip(frame.objects.iter().zip(&frame.planned)) {
            frames.extend([(WORLD, object.name.as_str(), *now), (WORLD, as_planned.as_str(), *planned)]);
        }
        tape.frames(&frames)?;
        while let Some(step) = steps.next_if(|step| step.begin_s <= frame.time_s) {
            tape.event(&json!({ "kind": "step", "plan": step.plan, "step": step.step, "primitive": step.primitive }))?;
        }
        while looks.next_if(|look_s| **look_s <= frame.time_s).is_some() {
            tape.event(&json!({ "kind": "sense" }))?;
        }
    }
    tape.finish()
}

fn is_still(told: &Isometry3<f64>, pose: &Isometry3<f64>) -> bool {
    let away = (told.translation.vector - pose.translation.vector).norm();
    away <= STILL && told.rotation.angle_to(&pose.rotation) <= STILL
}
