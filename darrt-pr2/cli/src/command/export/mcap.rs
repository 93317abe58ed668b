//! A plan as a recording: joint states, frames and events on its clock.

use darrt_task::clock::{EventKind, Moment};
use darrt_task::plan_file::PlanFile;
use darrt_task::trajectory::{Sampled, WORLD};
use serde_json::json;

use crate::command::tape::Tape;

/// The bytes of the recording, or why there are none.
pub(super) fn file(plan: &PlanFile, sampled: &Sampled) -> Result<Vec<u8>, String> {
    write(plan, sampled).map_err(|error| error.to_string())
}

fn write(plan: &PlanFile, sampled: &Sampled) -> mcap::McapResult<Vec<u8>> {
    let mut tape = Tape::new(PartialEq::eq)?;
    let happening = sampled.events();
    let mut happening = happening.iter().peekable();
    let mut last_step = None;
    for (sequence, (t_s, moment)) in (0..).zip(sampled.samples()) {
        tape.begin(sequence, *t_s);
        let names: Vec<String> = (0..moment.joints.len()).map(|variable| sampled.name(variable)).collect();
        tape.joints(&names, &moment.joints, &moment.joint_velocity)?;
        frames(&mut tape, sampled, moment)?;
        if last_step != Some(moment.step)
            && let Some(step) = plan.steps.get(moment.step)
        {
            last_step = Some(moment.step);
            let mut event = json!({ "kind": "step", "step": moment.step + 1, "primitive": step.primitive.as_str(),
                "object": step.object });
            add_tool(&mut event, plan, moment.step);
            tape.event(&event)?;
        }
        while let Some(event) = happening.next_if(|event| event.time_s <= *t_s + 1e-6) {
            let mut value = match (event.kind, sampled.command(event)) {
                (EventKind::Fingers { force_n, .. }, Some(command)) => {
                    json!({ "kind": "fingers", "step": event.step + 1, "width_m": command.position, "force_n": force_n })
                }
                _ => json!({ "kind": "sense", "step": event.step + 1 }),
            };
            if matches!(event.kind, EventKind::Fingers { .. }) {
                add_tool(&mut value, plan, event.step);
            }
            tape.event(&value)?;
        }
    }
    tape.finish()
}

/// Says which hand is at work in a step, from 0, where it is not the robot's first.
fn add_tool(event: &mut serde_json::Value, plan: &PlanFile, step: usize) {
    let tool = plan.steps.get(step).and_then(|step| step.tool.as_ref());
    if let (Some(tool), Some(event)) = (tool, event.as_object_mut()) {
        event.insert("tool".to_owned(), json!(tool));
    }
}

/// The frames of the links in those of their parents, of the root and of the objects in the world.
fn frames(tape: &mut Tape, sampled: &Sampled, moment: &Moment) -> mcap::McapResult<()> {
    let tree = sampled.timed().tree();
    let links = sampled.timed().links(moment);
    let objects = sampled.timed().objects(moment);
    let of_links = tree.link_names().iter().zip(&links).enumerate().map(|(link, (name, world_from_link))| {
        let parent = tree.parent(link).filter(|parent| *parent != link);
        match parent.and_then(|parent| tree.link_names().get(parent)) {
            None => (WORLD, &**name, *world_from_link),
            Some(parent) => (&**parent, &**name, sampled.timed().parent_from_link(moment, link)),
        }
    });
    let of_objects = objects.iter().map(|(name, pose)| (WORLD, &**name, *pose));
    tape.frames(&of_links.chain(of_objects).collect::<Vec<_>>())
}
