//! A plan as a binary glTF 2.0 file (`.glb`): one node a link, named, and an animation.
//!
//! glTF has y up and knows no joints: a root node turns the world, and of each node that moves the pose is given at every
//! waypoint. What is held is no child of the hand, because a node never changes its parent; it is given more often instead.

mod motion;

use std::collections::BTreeMap;

use nalgebra::Isometry3;
use serde_json::{Value, json};

use super::ViewerError;
use super::data::{PartData, ViewerData, pose_of};
use super::solids::Surface;
use motion::{Path, Tracks};

/// What glTF calls 32-bit floats, and a buffer of corners.
const FLOAT: u32 = 5126;
const ARRAY_BUFFER: u32 = 34962;

/// Colours, linear, of robot, tables, other fixed bodies and objects.
const ROBOT: [f64; 3] = [0.6, 0.63, 0.67];
const TABLE: [f64; 3] = [0.72, 0.54, 0.3];
const FIXED: [f64; 3] = [0.35, 0.47, 0.66];
const OBJECT: [f64; 3] = [0.89, 0.37, 0.03];

/// The bytes of the file.
///
/// # Errors
/// [`ViewerError::Json`] when the file cannot be put together, [`ViewerError::TooLarge`] when it would exceed what the format
/// can hold.
pub fn file(data: &ViewerData) -> Result<Vec<u8>, ViewerError> {
    let mut file = File::default();
    let start = motion::State::new(data);
    let poses = start.link_poses(data);
    let mut links: Vec<usize> = Vec::new();
    for (link, pose) in data.robot.links.iter().zip(&poses) {
        // The pose in the parent, as nodes have it.
        let parent = link.parent.and_then(|parent| Some((*links.get(parent)?, poses.get(parent)?)));
        let local = parent.map_or(*pose, |(_, above)| above.inverse() * pose);
        let node = file.solid(&link.name, &local, &link.parts, ROBOT);
        file.children.entry(parent.map(|(node, _)| node)).or_default().push(node);
        links.push(node);
    }
    for body in &data.bodies {
        let node = file.solid(&body.name, &pose_of(&body.pose), &body.parts, if body.carries { TABLE } else { FIXED });
        file.children.entry(None).or_default().push(node);
    }
    let mut objects = Vec::new();
    for (object, pose) in data.objects.iter().zip(&data.start.objects) {
        let node = file.solid(&object.name, &pose_of(pose), &object.parts, OBJECT);
        file.children.entry(None).or_default().push(node);
        objects.push(node);
    }
    let animation = file.animation(data, &Tracks::of(data, &links, &objects));
    file.bytes(&data.title, animation)
}

/// What is there so far.
#[derive(Default)]
struct File {
    nodes: Vec<Value>,
    /// By node; of none: by the root.
    children: BTreeMap<Option<usize>, Vec<usize>>,
    meshes: Vec<Value>,
    materials: Vec<Value>,
    accessors: Vec<Value>,
    views: Vec<Value>,
    binary: Vec<u8>,
}

impl File {
    /// A node with what it looks like.
    fn solid(&mut self, name: &str, pose: &Isometry3<f64>, parts: &[PartData], colour: [f64; 3]) -> usize {
        let q = pose.rotation.quaternion();
        // Rounding may make a number a little more than one, which the format forbids.
        let rotation = [q.i, q.j, q.k, q.w].map(|value| value.clamp(-1.0, 1.0));
        let mut node = json!({
            "name": name,
            "translation": [pose.translation.x, pose.translation.y, pose.translation.z],
            "rotation": rotation,
        });
        let surface = Surface::of(parts);
        if !surface.corners.is_empty() {
            let corners: Vec<[f64; 3]> = surface.corners.iter().map(|p| [p.x, p.y, p.z]).collect();
            let normals: Vec<[f64; 3]> = surface.normals.iter().map(|n| [n.x, n.y, n.z]).collect();
            let position = self.accessor(corners.as_flattened(), 3, Some(ARRAY_BUFFER), true);
            let normal = self.accessor(normals.as_flattened(), 3, Some(ARRAY_BUFFER), false);
            let material = self.material(colour);
            node["mesh"] = json!(self.meshes.len());
            let primitive = json!({ "attributes": { "POSITION": position, "NORMAL": normal }, "material": material });
            self.meshes.push(json!({ "name": name, "primitives": [primitive] }));
        }
        self.nodes.push(node);
        self.nodes.len() - 1
    }

    fn material(&mut self, [r, g, b]: [f64; 3]) -> usize {
        let look = json!({ "baseColorFactor": [r, g, b, 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.8 });
        let material = json!({ "pbrMetallicRoughness": look });
        self.materials.iter().position(|known| *known == material).unwrap_or_else(|| {
            self.materials.push(material);
            self.materials.len() - 1
        })
    }

    /// Numbers in groups of `width`, written to the binary part; `bounds`: with the least and the greatest of each column.
    fn accessor(&mut self, numbers: &[f64], width: usize, target: Option<u32>, bounds: bool) -> usize {
        let singles: Vec<f32> = numbers.iter().map(|number| single(*number)).collect();
        let mut view = json!({ "buffer": 0, "byteOffset": self.binary.len(), "byteLength": 4 * singles.len() });
        if let Some(target) = target {
            view["target"] = json!(target);
        }
        self.binary.extend(singles.iter().flat_map(|number| number.to_le_bytes()));
        self.views.push(view);
        let kind = ["SCALAR", "VEC2", "VEC3", "VEC4"].get(width.saturating_sub(1)).copied().unwrap_or("SCALAR");
        let mut accessor = json!({
            "bufferView": self.views.len() - 1, "componentType": FLOAT, "count": singles.len() / width, "type": kind,
        });
        if bounds {
            let column = |i: usize| singles.iter().skip(i).step_by(width).copied();
            accessor["min"] = (0..width).map(|i| column(i).fold(f32::INFINITY, f32::min)).collect();
            accessor["max"] = (0..width).map(|i| column(i).fold(f32::NEG_INFINITY, f32::max)).collect();
        }
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    /// `None` when nothing moves.
    fn animation(&mut self, data: &ViewerData, tracks: &Tracks) -> Option<Value> {
        let (mut channels, mut samplers) = (Vec::new(), Vec::new());
        // Many tracks have the same times.
        let mut inputs: Vec<(&[f64], usize)> = Vec::new();
        for ((node, path), track) in tracks.iter() {
            let known = inputs.iter().find(|(times, _)| *times == track.times).map(|(_, input)| *input);
            let input = known.unwrap_or_else(|| {
                let input = self.accessor(&track.times, 1, None, true);
                inputs.push((&track.times, input));
                input
            });
            let (name, width) = match path {
                Path::Translation => ("translation", 3),
                Path::Rotation => ("rotation", 4),
            };
            let output = self.accessor(&track.values, width, None, false);
            channels.push(json!({ "sampler": samplers.len(), "target": { "node": node, "path": name } }));
            samplers.push(json!({ "input": input, "output": output, "interpolation": "LINEAR" }));
        }
        let mut clock = 0.0;
        let steps = data.steps.iter().map(|step| {
            let begin = clock;
            clock += step.times.last().copied().unwrap_or_default();
            json!({ "name": step.name, "begin_s": begin, "end_s": clock })
        });
        let steps: Vec<Value> = steps.collect();
        let animation =
            json!({ "name": "plan", "channels": channels, "samplers": samplers, "extras": { "steps": steps } });
        (!channels.is_empty()).then_some(animation)
    }

    fn bytes(mut self, title: &str, animation: Option<Value>) -> Result<Vec<u8>, ViewerError> {
        for (node, children) in &self.children {
            if let Some(slot) = node.and_then(|node| self.nodes.get_mut(node)) {
                slot["children"] = json!(children);
            }
        }
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let top = self.children.get(&None).cloned().unwrap_or_default();
        self.nodes.push(json!({ "name": "world", "rotation": [-half, 0.0, 0.0, half], "children": top }));
        let mut document = json!({
            "asset": { "version": "2.0", "generator": "darrt" },
            "scene": 0,
            "scenes": [{ "name": title, "nodes": [self.nodes.len() - 1] }],
            "nodes": self.nodes,
        });
        let animations: Vec<Value> = animation.into_iter().collect();
        let lists = [
            ("meshes", self.meshes),
            ("materials", self.materials),
            ("accessors", self.accessors),
            ("bufferViews", self.views),
            ("animations", animations),
        ];
        // The format has no empty lists.
        for (key, list) in lists.into_iter().filter(|(_, list)| !list.is_empty()) {
            document[key] = Value::from(list);
        }
        if !self.binary.is_empty() {
            document["buffers"] = json!([{ "byteLength": self.binary.len() }]);
        }
        let mut text = serde_json::to_vec(&document)?;
        text.resize(text.len().next_multiple_of(4), b' ');
        let size = |length: usize| u32::try_from(length).map_err(|_| ViewerError::TooLarge { bytes: length });
        let total = 12 + 8 + text.len() + 8 + self.binary.len();
        let mut bytes = Vec::with_capacity(total);
        bytes.extend(b"glTF");
        bytes.extend(2_u32.to_le_bytes());
        bytes.extend(size(total)?.to_le_bytes());
        for (kind, chunk) in [(b"JSON", &text), (b"BIN\0", &self.binary)] {
            bytes.extend(size(chunk.len())?.to_le_bytes());
            bytes.extend(kind);
            bytes.extend(chunk);
        }
        Ok(bytes)
    }
}

#[expect(clippy::cast_possible_truncation, reason = "the format has single precision")]
fn single(number: f64) -> f32 {
    number as f32
}
