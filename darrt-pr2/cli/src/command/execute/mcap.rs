//! One run as a recording: joint states, frames and events as they truly were, and where the plan has the objects; JSON messages in
//! an MCAP file, as `darrt export` writes them.

use std::collections::BTreeMap;
use std::io::Cursor;

use darrt_execute::recording::Recording;
use darrt_primitives::kinematics::KinematicTree;
use darrt_primitives::manipulator::world_from_base;
use darrt_task::plan_file::PlanFile;
use darrt_task::robot::RobotFacts;
use darrt_task::trajectory::WORLD;
use darrt_task::trajectory::messages::Transform;
use nalgebra::Isometry3;
use serde_json::{Value, json};

use crate::command::export::mcap::{TOPICS, put, schema, stamp};

/// A frame nearer to where it was told to be is there still, metres and radians.
const STILL: f64 = 1e-7;

/// The bytes of the recording, or why there are none.
pub(super) fn file(plan: &PlanFile, facts: &RobotFacts, recording: &Recording) -> Result<Vec<u8>, String> {
    let tree = KinematicTree::new(&facts.description).map_err(|error| error.to_string())?;
    write(plan, &tree, recording).map_err(|error| error.to_string())
}

fn write(plan: &PlanFile, tree: &KinematicTree, recording: &Recording) -> mcap::McapResult<Vec<u8>> {
    let options = mcap::WriteOptions::new().compression(None).library("darrt");
    let mut writer = options.create(Cursor::new(Vec::new()))?;
    let mut channels = Vec::new();
    for (topic, name) in TOPICS {
        let schema = writer.add_schema(name, "jsonschema", schema(name).to_string().as_bytes())?;
        channels.push(writer.add_channel(schema, topic, "json", &BTreeMap::new())?);
    }
    let [joint_states, tf, events] = channels[..] else { return Ok(Vec::new()) };
    let names: Vec<String> = tree.variables().iter().map(|variable| variable.name.to_string()).collect();
    let mut links = vec![Isometry3::identity(); tree.link_count()];
    let mut told = Told::new();
    let (mut steps, mut looks) = (recording.steps.iter().peekable(), recording.looks_s.iter().peekable());
    for (sequence, frame) in (0..).zip(&recording.frames) {
        let state = json!({ "header": { "stamp": stamp(frame.time_s), "frame_id": WORLD }, "name": names,
            "position": frame.joints, "velocity": [], "effort": [] });
        put(&mut writer, joint_states, sequence, frame.time_s, &state)?;
        // The lengths are the tree's own.
        let _ = tree.forward(&frame.joints, &world_from_base(&frame.base), &mut links);
        let mut frames = Frames { t_s: frame.time_s, told: &mut told, new: Vec::new() };
        for (link, name) in tree.link_names().iter().enumerate() {
            let at = links.get(link).copied().unwrap_or_default();
            match tree.parent(link).filter(|parent| *parent != link) {
                Some(parent) => {
                    let above = links.get(parent).copied().unwrap_or_default();
                    frames.tell(tree.link_names().get(parent).map_or(WORLD, |name| name), name, above.inverse() * at);
                }
                None => frames.tell(WORLD, name, at),
            }
        }
        for (object, (now, planned)) in plan.problem.objects.iter().zip(frame.objects.iter().zip(&frame.planned)) {
            frames.tell(WORLD, &object.name, *now);
            frames.tell(WORLD, &format!("{} as planned", object.name), *planned);
        }
        let new = json!({ "transforms": frames.new });
        put(&mut writer, tf, sequence, frame.time_s, &new)?;
        while let Some(step) = steps.next_if(|step| step.begin_s <= frame.time_s) {
            let value = json!({ "kind": "step", "plan": step.plan, "step": step.step, "primitive": step.primitive });
            put(&mut writer, events, sequence, frame.time_s, &value)?;
        }
        while looks.next_if(|look_s| **look_s <= frame.time_s).is_some() {
            put(&mut writer, events, sequence, frame.time_s, &json!({ "kind": "sense" }))?;
        }
    }
    writer.finish()?;
    Ok(writer.into_inner().into_inner())
}

/// The frames that have been told, and where they were.
type Told = BTreeMap<String, Isometry3<f64>>;

/// The frames that are not where they were told to be.
struct Frames<'a> {
    t_s: f64,
    told: &'a mut Told,
    new: Vec<Value>,
}

impl Frames<'_> {
    fn tell(&mut self, parent: &str, child: &str, pose: Isometry3<f64>) {
        let is_still = |told: &Isometry3<f64>| {
            let away = (told.translation.vector - pose.translation.vector).norm();
            away <= STILL && told.rotation.angle_to(&pose.rotation) <= STILL
        };
        if self.told.get(child).is_some_and(is_still) {
            return;
        }
        self.told.insert(child.to_owned(), pose);
        let Transform { translation, rotation } = Transform::from(&pose);
        self.new.push(json!({ "timestamp": stamp(self.t_s), "parent_frame_id": parent, "child_frame_id": child,
            "translation": translation, "rotation": rotation }));
    }
}
