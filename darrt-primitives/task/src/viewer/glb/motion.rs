//! What nodes do over time.

use darrt_primitives::manipulator::world_from_base;
use std::collections::BTreeMap;

use darrt_primitives::kinematics::limit::wrap_to_pi;
use nalgebra::{Isometry3, Translation3, Unit, UnitQuaternion, Vector3};

use crate::viewer::data::{JointKindData, LinkData, StepData, ViewerData, pose_of};

/// A held object is given this often between two waypoints.
const HELD_PARTS: u32 = 4;
/// Keys are at least this far apart, seconds: times have single precision.
const APART_S: f64 = 1e-3;

/// Where everything stands.
#[derive(Debug, Clone)]
pub(super) struct State {
    base: [f64; 3],
    joints: Vec<f64>,
}

impl State {
    /// At the beginning.
    pub(super) fn new(data: &ViewerData) -> Self {
        Self { base: data.start.base, joints: data.start.joints.clone() }
    }

    /// At a waypoint of a step before which it was `self`.
    fn go_to(&mut self, step: &StepData, waypoint: usize) {
        if let Some(base) = step.base.get(waypoint) {
            self.base = *base;
        }
        for track in &step.joints {
            if let (Some(slot), Some(value)) = (self.joints.get_mut(track.variable), track.values.get(waypoint)) {
                *slot = *value;
            }
        }
    }

    /// Part of the way to another state.
    fn between(&self, to: &Self, part: f64, data: &ViewerData) -> Self {
        let mut state = self.clone();
        for (slot, to) in state.base.iter_mut().zip(to.base).take(2) {
            *slot += part * (to - *slot);
        }
        state.base[2] += part * wrap_to_pi(to.base[2] - self.base[2]);
        for ((slot, to), variable) in state.joints.iter_mut().zip(&to.joints).zip(&data.robot.variables) {
            let turns = variable.kind == JointKindData::Turning && variable.limits.is_none();
            *slot += part * if turns { wrap_to_pi(to - *slot) } else { to - *slot };
        }
        state
    }

    /// Pose of a link in its parent, of the root in the world.
    fn local(&self, link: &LinkData) -> Isometry3<f64> {
        if link.parent.is_none() {
            return world_from_base(&self.base);
        }
        let pose = pose_of(&link.pose);
        let Some(joint) = &link.joint else { return pose };
        let value = joint.multiplier * self.joints.get(joint.variable).copied().unwrap_or_default() + joint.offset;
        let axis = Vector3::from(joint.axis);
        pose * match joint.kind {
            JointKindData::Turning => Isometry3::from_parts(
                Translation3::identity(),
                UnitQuaternion::from_axis_angle(&Unit::new_normalize(axis), value),
            ),
            JointKindData::Sliding => Isometry3::from_parts((axis * value).into(), UnitQuaternion::identity()),
        }
    }

    /// World poses of all links.
    pub(super) fn link_poses(&self, data: &ViewerData) -> Vec<Isometry3<f64>> {
        let mut poses: Vec<Isometry3<f64>> = Vec::with_capacity(data.robot.links.len());
        for link in &data.robot.links {
            let above = link.parent.and_then(|parent| poses.get(parent)).copied().unwrap_or_default();
            poses.push(above * self.local(link));
        }
        poses
    }
}

/// What of a node changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Path {
    /// Three numbers.
    Translation,
    /// A quaternion.
    Rotation,
}

/// Keys.
#[derive(Debug, Default)]
pub(super) struct Track {
    /// Seconds, ascending.
    pub(super) times: Vec<f64>,
    /// As many numbers at each as the path has.
    pub(super) values: Vec<f64>,
}

/// By node and path.
#[derive(Debug, Default)]
pub(super) struct Tracks(BTreeMap<(usize, Path), Track>);

impl Tracks {
    /// What the nodes of links and objects do.
    pub(super) fn of(data: &ViewerData, links: &[usize], objects: &[usize]) -> Self {
        let mut tracks = Self::default();
        let mut state = State::new(data);
        let mut begin = 0.0;
        for step in &data.steps {
            for (waypoint, time) in step.times.iter().enumerate() {
                let before = state.clone();
                state.go_to(step, waypoint);
                let now = begin + time;
                tracks.note_links(data, step, links, &state, now);
                for track in &step.objects {
                    if let (Some(node), Some(pose)) = (objects.get(track.object), track.poses.get(waypoint)) {
                        tracks.note_pose(*node, now, &pose_of(pose));
                    }
                }
                let last = waypoint.checked_sub(1).and_then(|before| step.times.get(before));
                tracks.note_held(data, step, objects, (&before, begin + last.unwrap_or(time)), (&state, now));
            }
            begin += step.times.last().copied().unwrap_or_default();
        }
        tracks
    }

    /// All of them, in the order of the nodes.
    pub(super) fn iter(&self) -> impl Iterator<Item = (&(usize, Path), &Track)> {
        self.0.iter()
    }

    fn note_links(&mut self, data: &ViewerData, step: &StepData, links: &[usize], state: &State, now: f64) {
        for (link, node) in data.robot.links.iter().zip(links) {
            let Some(joint) = &link.joint else {
                if link.parent.is_none() && !step.base.is_empty() {
                    self.note_pose(*node, now, &state.local(link));
                }
                continue;
            };
            if step.joints.iter().any(|track| track.variable == joint.variable) {
                let pose = state.local(link);
                match joint.kind {
                    JointKindData::Turning => self.note_rotation(*node, now, &pose.rotation),
                    JointKindData::Sliding => {
                        self.note(*node, Path::Translation, now, pose.translation.vector.as_slice());
                    }
                }
            }
        }
    }

    fn note_held(
        &mut self,
        data: &ViewerData,
        step: &StepData,
        objects: &[usize],
        (from, begin): (&State, f64),
        (to, end): (&State, f64),
    ) {
        let Some(hold) = &step.holds else { return };
        let Some(node) = objects.get(hold.object) else { return };
        for part in 1..=HELD_PARTS {
            let part = f64::from(part) / f64::from(HELD_PARTS);
            let poses = from.between(to, part, data).link_poses(data);
            if let Some(tool) = poses.get(step.tool.unwrap_or(data.robot.tool)) {
                self.note_pose(*node, begin + part * (end - begin), &(tool * pose_of(&hold.tool_from_object)));
            }
        }
    }

    fn note_pose(&mut self, node: usize, now: f64, pose: &Isometry3<f64>) {
        self.note(node, Path::Translation, now, pose.translation.vector.as_slice());
        self.note_rotation(node, now, &pose.rotation);
    }

    /// The one of both quaternions of a rotation that is nearer to the last.
    fn note_rotation(&mut self, node: usize, now: f64, rotation: &UnitQuaternion<f64>) {
        let q = rotation.quaternion();
        let new = [q.i, q.j, q.k, q.w];
        let values = self.0.get(&(node, Path::Rotation)).map_or(&[][..], |track| &track.values);
        let last = values.get(values.len().saturating_sub(4)..).unwrap_or_default();
        let along: f64 = last.iter().zip(new).map(|(a, b)| a * b).sum();
        self.note(node, Path::Rotation, now, &if along < 0.0 { new.map(|value| -value) } else { new });
    }

    fn note(&mut self, node: usize, path: Path, now: f64, value: &[f64]) {
        let track = self.0.entry((node, path)).or_default();
        if track.times.last().is_some_and(|last| now < last + APART_S) {
            // Where a step ends the next begins.
            let kept = track.values.len() - value.len();
            track.values.truncate(kept);
        } else {
            track.times.push(now);
        }
        track.values.extend(value);
    }
}
