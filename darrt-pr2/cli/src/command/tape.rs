//! A recording: joint states, frames and events as JSON messages in an MCAP file, for what is planned and for what was executed.

use std::collections::BTreeMap;
use std::io::Cursor;

use darrt_task::trajectory::WORLD;
use darrt_task::trajectory::messages::{Seconds, Transform};
use mcap::records::MessageHeader;
use nalgebra::Isometry3;
use serde_json::{Value, json};

/// The topics, each with the name of its schema.
const JOINT_STATES: (&str, &str) = ("/joint_states", "sensor_msgs/JointState");
const TF: (&str, &str) = ("/tf", "foxglove.FrameTransforms");
const EVENTS: (&str, &str) = ("/events", "darrt.Event");

/// A recording that is being written. What is told goes to the moment that was [begun](Tape::begin) last.
pub(super) struct Tape {
    writer: mcap::Writer<Cursor<Vec<u8>>>,
    joint_states: u16,
    tf: u16,
    events: u16,
    sequence: u32,
    t_s: f64,
    /// Where the frames were told to be: a frame counts until it is told anew.
    told: BTreeMap<String, Isometry3<f64>>,
    /// Is a frame that was told to be at the first still there at the second?
    is_still: fn(&Isometry3<f64>, &Isometry3<f64>) -> bool,
}

impl Tape {
    /// An empty recording.
    pub(super) fn new(is_still: fn(&Isometry3<f64>, &Isometry3<f64>) -> bool) -> mcap::McapResult<Self> {
        let options = mcap::WriteOptions::new().compression(None).library("darrt");
        let mut writer = options.create(Cursor::new(Vec::new()))?;
        let mut channel = |(topic, name): (&str, &str)| {
            let schema = writer.add_schema(name, "jsonschema", schema(name).to_string().as_bytes())?;
            writer.add_channel(schema, topic, "json", &BTreeMap::new())
        };
        let (joint_states, tf, events) = (channel(JOINT_STATES)?, channel(TF)?, channel(EVENTS)?);
        Ok(Self { writer, joint_states, tf, events, sequence: 0, t_s: 0.0, told: BTreeMap::new(), is_still })
    }

    /// Goes on to a moment.
    pub(super) fn begin(&mut self, sequence: u32, t_s: f64) {
        (self.sequence, self.t_s) = (sequence, t_s);
    }

    /// The values of the joints; without velocities, if they are not known.
    pub(super) fn joints(&mut self, names: &[String], position: &[f64], velocity: &[f64]) -> mcap::McapResult<()> {
        let value = json!({ "header": { "stamp": stamp(self.t_s), "frame_id": WORLD }, "name": names,
            "position": position, "velocity": velocity, "effort": [] });
        self.put(self.joint_states, &value)
    }

    /// Frames: that of the parent, the name, the pose in the parent. Those that are where they were told to be are left out.
    pub(super) fn frames(&mut self, frames: &[(&str, &str, Isometry3<f64>)]) -> mcap::McapResult<()> {
        let mut new = Vec::new();
        for (parent, child, pose) in frames {
            if self.told.get(*child).is_some_and(|told| (self.is_still)(told, pose)) {
                continue;
            }
            self.told.insert((*child).to_owned(), *pose);
            let Transform { translation, rotation } = Transform::from(pose);
            new.push(json!({ "timestamp": stamp(self.t_s), "parent_frame_id": parent, "child_frame_id": child,
                "translation": translation, "rotation": rotation }));
        }
        self.put(self.tf, &json!({ "transforms": new }))
    }

    /// Something that happens.
    pub(super) fn event(&mut self, value: &Value) -> mcap::McapResult<()> {
        self.put(self.events, value)
    }

    /// The bytes of the file.
    pub(super) fn finish(mut self) -> mcap::McapResult<Vec<u8>> {
        self.writer.finish()?;
        Ok(self.writer.into_inner().into_inner())
    }

    fn put(&mut self, channel_id: u16, value: &Value) -> mcap::McapResult<()> {
        let time = Seconds::from_s(self.t_s);
        let log_time = u64::from(time.sec) * 1_000_000_000 + u64::from(time.nanosec);
        let header = MessageHeader { channel_id, sequence: self.sequence, log_time, publish_time: log_time };
        self.writer.write_to_known_channel(&header, value.to_string().as_bytes())
    }
}

/// The stamp of a message, as the schemas of Foxglove have it.
fn stamp(t_s: f64) -> Value {
    let time = Seconds::from_s(t_s);
    json!({ "sec": time.sec, "nsec": time.nanosec })
}

/// The JSON schemas of the messages.
fn schema(name: &str) -> Value {
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
