//! A plan as a recording: joint states, frames and events on its clock, as JSON messages in an MCAP file.

use std::collections::BTreeMap;
use std::io::Cursor;

use darrt_task::clock::{EventKind, Moment};
use darrt_task::plan_file::PlanFile;
use darrt_task::trajectory::messages::{Seconds, Transform};
use darrt_task::trajectory::{Sampled, WORLD};
use mcap::records::MessageHeader;
use nalgebra::Isometry3;
use serde_json::{Value, json};

/// What is written on which topic, with the name of its schema.
pub(in crate::command) const TOPICS: [(&str, &str); 3] =
    [("/joint_states", "sensor_msgs/JointState"), ("/tf", "foxglove.FrameTransforms"), ("/events", "darrt.Event")];

pub(in crate::command) type Writer = mcap::Writer<Cursor<Vec<u8>>>;

/// The bytes of the recording, or why there are none.
pub(super) fn file(plan: &PlanFile, sampled: &Sampled) -> Result<Vec<u8>, String> {
    write(plan, sampled).map_err(|error| error.to_string())
}

fn write(plan: &PlanFile, sampled: &Sampled) -> mcap::McapResult<Vec<u8>> {
    let options = mcap::WriteOptions::new().compression(None).library("darrt");
    let mut writer = options.create(Cursor::new(Vec::new()))?;
    let mut channels = Vec::new();
    for (topic, name) in TOPICS {
        let schema = writer.add_schema(name, "jsonschema", schema(name).to_string().as_bytes())?;
        channels.push(writer.add_channel(schema, topic, "json", &BTreeMap::new())?);
    }
    let [joint_states, tf, events] = channels[..] else { return Ok(Vec::new()) };
    let happening = sampled.events();
    let mut happening = happening.iter().peekable();
    let (mut told, mut last_step) = (Told::new(), None);
    for (sequence, (t_s, moment)) in (0..).zip(sampled.samples()) {
        put(&mut writer, joint_states, sequence, *t_s, &joint_state(sampled, *t_s, moment))?;
        put(&mut writer, tf, sequence, *t_s, &frames(sampled, *t_s, moment, &mut told))?;
        if last_step != Some(moment.step)
            && let Some(step) = plan.steps.get(moment.step)
        {
            last_step = Some(moment.step);
            let value = json!({ "kind": "step", "step": moment.step + 1, "primitive": step.primitive.as_str(),
                "object": step.object });
            put(&mut writer, events, sequence, *t_s, &value)?;
        }
        while let Some(event) = happening.next_if(|event| event.time_s <= *t_s + 1e-6) {
            let value = match (event.kind, sampled.command(event)) {
                (EventKind::Fingers { force_n, .. }, Some(command)) => {
                    json!({ "kind": "fingers", "step": event.step + 1, "width_m": command.position, "force_n": force_n })
                }
                _ => json!({ "kind": "sense", "step": event.step + 1 }),
            };
            put(&mut writer, events, sequence, *t_s, &value)?;
        }
    }
    writer.finish()?;
    Ok(writer.into_inner().into_inner())
}

pub(in crate::command) fn put(
    writer: &mut Writer,
    channel_id: u16,
    sequence: u32,
    t_s: f64,
    value: &Value,
) -> mcap::McapResult<()> {
    let time = Seconds::from_s(t_s);
    let log_time = u64::from(time.sec) * 1_000_000_000 + u64::from(time.nanosec);
    let header = MessageHeader { channel_id, sequence, log_time, publish_time: log_time };
    writer.write_to_known_channel(&header, value.to_string().as_bytes())
}

/// The stamp of a message, as the schemas of Foxglove have it.
pub(in crate::command) fn stamp(t_s: f64) -> Value {
    let time = Seconds::from_s(t_s);
    json!({ "sec": time.sec, "nsec": time.nanosec })
}

fn joint_state(sampled: &Sampled, t_s: f64, moment: &Moment) -> Value {
    let names: Vec<String> = (0..moment.joints.len()).map(|variable| sampled.name(variable)).collect();
    json!({ "header": { "stamp": stamp(t_s), "frame_id": WORLD }, "name": names, "position": moment.joints,
        "velocity": moment.joint_velocity, "effort": [] })
}

/// The frames that have been told, and where they were.
type Told = BTreeMap<String, Isometry3<f64>>;

/// The frames of the links in those of their parents, of the root and of the objects in the world: those that are not where they
/// were told to be. A frame counts until it is told anew.
fn frames(sampled: &Sampled, t_s: f64, moment: &Moment, told: &mut Told) -> Value {
    let tree = sampled.timed().tree();
    let links = sampled.timed().links(moment);
    let mut frames = Vec::new();
    let mut tell = |parent: &str, child: &str, pose: Isometry3<f64>| {
        if told.get(child) == Some(&pose) {
            return;
        }
        told.insert(child.to_owned(), pose);
        let Transform { translation, rotation } = Transform::from(&pose);
        frames.push(json!({ "timestamp": stamp(t_s), "parent_frame_id": parent, "child_frame_id": child,
            "translation": translation, "rotation": rotation }));
    };
    for (link, (name, world_from_link)) in tree.link_names().iter().zip(&links).enumerate() {
        let parent = tree.parent(link).filter(|parent| *parent != link);
        match parent.and_then(|parent| Some((parent, tree.link_names().get(parent)?))) {
            None => tell(WORLD, name, *world_from_link),
            Some((_, parent)) => tell(parent, name, sampled.timed().parent_from_link(moment, link)),
        }
    }
    for (name, pose) in sampled.timed().objects(moment) {
        tell(WORLD, &name, pose);
    }
    json!({ "transforms": frames })
}

/// The JSON schemas of the messages.
pub(in crate::command) fn schema(name: &str) -> Value {
    let number = json!({ "type": "number" });
    let numbers = json!({ "type": "array", "items": { "type": "number" } });
    let time = json!({ "type": "object", "title": "time",
        "properties": { "sec": { "type": "integer", "minimum": 0 }, "nsec": { "type": "integer", "minimum": 0 } } });
    let vector = json!({ "type": "object", "title": "foxglove.Vector3",
        "properties": { "x": number, "y": number, "z": number } });
    let turn = json!({ "type": "object", "title": "foxglove.Quaternion",
        "properties": { "x": number, "y": number, "z": number, "w": number } });
    let text = json!({ "type": "string" });
    let properties = match name {
        "sensor_msgs/JointState" => json!({
            "header": { "type": "object", "properties": { "stamp": time, "frame_id": text } },
            "name": { "type": "array", "items": text }, "position": numbers, "velocity": numbers, "effort": numbers }),
        "foxglove.FrameTransforms" => json!({ "transforms": { "type": "array", "items": {
            "type": "object", "title": "foxglove.FrameTransform", "properties": {
                "timestamp": time, "parent_frame_id": text, "child_frame_id": text,
                "translation": vector, "rotation": turn } } } }),
        _ => json!({ "kind": text, "step": { "type": "integer" }, "primitive": text,
            "object": { "type": ["string", "null"] }, "width_m": number, "force_n": { "type": ["number", "null"] } }),
    };
    json!({ "$schema": "https://json-schema.org/draft/2020-12/schema", "title": name, "type": "object",
        "properties": properties })
}
