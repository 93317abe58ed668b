//! The facts of a chain that never change, and the one pass over them that gives pose, error and Jacobian.

use arrayvec::ArrayVec;
use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion, Vector3};

use super::MAX_JOINTS;
use crate::kinematics::jacobian::KinematicChain;
use crate::kinematics::limit::JointLimit;
use crate::kinematics::tree::{Drive, KinematicTree, LinkMotion};

/// Speed of the tool (x, y, z; m per unit of the joint) and its turning (x, y, z; rad per unit, times the chain's
/// [length](Constants::length_m)), in the base frame.
pub(super) type Column = [f64; 6];

/// A joint and the way to it.
#[derive(Debug, Clone)]
struct Joint {
    /// From the frame after the joint before to this joint's frame, whose z axis is the joint's.
    rotation: Matrix3<f64>,
    translation: Vector3<f64>,
    is_turning: bool,
    /// Where its value comes from; `variable` is a column of the chain.
    drive: Drive,
}

/// A chain, folded to what differs from joint to joint: links that do not move against each other are one.
#[derive(Debug, Clone)]
pub(super) struct Constants {
    joints: Vec<Joint>,
    tool_rotation: Matrix3<f64>,
    tool_translation: Vector3<f64>,
    length_m: f64,
    turning: ArrayVec<bool, MAX_JOINTS>,
}

/// A pose to be reached.
#[derive(Debug)]
pub(super) struct Target {
    rotation: Matrix3<f64>,
    translation: Vector3<f64>,
}

impl Target {
    pub(super) fn new(base_from_tool: &Isometry3<f64>) -> Self {
        Self {
            rotation: base_from_tool.rotation.to_rotation_matrix().into_inner(),
            translation: base_from_tool.translation.vector,
        }
    }
}

/// What is missing to the target, in the base frame.
#[derive(Debug)]
pub(super) struct PoseError {
    position_m: Vector3<f64>,
    rotation_rad: Vector3<f64>,
    length_m: f64,
}

impl PoseError {
    /// Distance (m) and angle (rad).
    pub(super) fn norms(&self) -> (f64, f64) {
        (self.position_m.norm(), self.rotation_rad.norm())
    }

    /// In the units of a [`Column`].
    pub(super) fn row(&self) -> Column {
        let (p, r) = (self.position_m, self.rotation_rad * self.length_m);
        [p.x, p.y, p.z, r.x, r.y, r.z]
    }

    /// Squared norm of [`row`](Self::row), m^2.
    pub(super) fn square(&self) -> f64 {
        self.position_m.norm_squared() + self.length_m * self.length_m * self.rotation_rad.norm_squared()
    }
}

impl Constants {
    pub(super) fn new(tree: &KinematicTree, chain: &KinematicChain, tip_from_tool: &Isometry3<f64>) -> Self {
        let mut links = Vec::new();
        let mut link = chain.tip();
        while link != chain.base() {
            links.push(link);
            let Some(parent) = tree.parent(link) else { break };
            link = parent;
        }
        let mut joints = Vec::with_capacity(chain.variables().len());
        let mut turning: ArrayVec<bool, MAX_JOINTS> = chain.variables().iter().map(|_| false).collect();
        let mut way = Isometry3::identity();
        for link in links.into_iter().rev() {
            let (Some(parent_from_link), Some(motion)) = (tree.parent_from_link(link), tree.motion(link)) else {
                continue;
            };
            way *= parent_from_link;
            let (axis, drive, is_turning) = match motion {
                LinkMotion::Fixed => continue,
                LinkMotion::Turning { axis, drive } => (axis, drive, true),
                LinkMotion::Sliding { axis, drive } => (axis, drive, false),
            };
            let Some(column) = chain.variables().iter().position(|variable| *variable == drive.variable) else {
                continue;
            };
            let axis_frame = z_onto(axis);
            let here = way * axis_frame;
            way = Isometry3::from_parts(Translation3::identity(), axis_frame.inverse());
            if let Some(slot) = turning.get_mut(column) {
                *slot |= is_turning;
            }
            joints.push(Joint {
                rotation: here.rotation.to_rotation_matrix().into_inner(),
                translation: here.translation.vector,
                is_turning,
                drive: Drive { variable: column, ..*drive },
            });
        }
        way *= tip_from_tool;
        let mut new = Self {
            joints,
            tool_rotation: way.rotation.to_rotation_matrix().into_inner(),
            tool_translation: way.translation.vector,
            length_m: 1.0,
            turning,
        };
        // A turn of the whole chain and a turn of the tool in place should weigh alike.
        let reach = new.link_lengths_m();
        new.length_m = if reach > 0.0 { LENGTH_SHARE * reach } else { 1.0 };
        new
    }

    /// Is the joint of each column a turning one?
    pub(super) fn turning(&self) -> &[bool] {
        &self.turning
    }

    /// Metres that one radian of the tool's turning counts as.
    pub(super) fn length_m(&self) -> f64 {
        self.length_m
    }

    /// From the first joint to the tool, all links stretched out, sliding joints at zero.
    fn link_lengths_m(&self) -> f64 {
        self.joints.iter().skip(1).map(|joint| joint.translation.norm()).sum::<f64>() + self.tool_translation.norm()
    }

    pub(super) fn may_reach(&self, base_from_tool: &Vector3<f64>, limits: &[JointLimit]) -> bool {
        let slide = |joint: &Joint| {
            let limit = limits.get(joint.drive.variable).copied().unwrap_or(JointLimit::UNLIMITED);
            let at = |value: f64| (joint.drive.multiplier * value + joint.drive.offset).abs();
            at(limit.lower).max(at(limit.upper))
        };
        let slides: f64 = self.joints.iter().filter(|joint| !joint.is_turning).map(slide).sum();
        let first = self.joints.first().map_or_else(Vector3::zeros, |joint| joint.translation);
        (base_from_tool - first).norm() <= self.link_lengths_m() + slides + 1e-9
    }

    pub(super) fn pose(&self, values: &[f64]) -> Isometry3<f64> {
        let (rotation, position) = self.pass(values, |_, _, _| {});
        let rotation = Rotation3::from_matrix_unchecked(rotation);
        Isometry3::from_parts(Translation3::from(position), UnitQuaternion::from_rotation_matrix(&rotation))
    }

    /// Rotation and position of the tool; `seen` is told joint, axis and a point of the axis on the way.
    #[inline]
    fn pass(
        &self,
        values: &[f64],
        mut seen: impl FnMut(usize, Vector3<f64>, Vector3<f64>),
    ) -> (Matrix3<f64>, Vector3<f64>) {
        let mut rotation = Matrix3::identity();
        let mut position = Vector3::zeros();
        for (index, joint) in self.joints.iter().enumerate() {
            position += rotation * joint.translation;
            rotation *= joint.rotation;
            let axis: Vector3<f64> = rotation.column(2).into();
            seen(index, axis, position);
            let variable = values.get(joint.drive.variable).copied().unwrap_or_default();
            let value = joint.drive.multiplier * variable + joint.drive.offset;
            if joint.is_turning {
                let (sin, cos) = value.sin_cos();
                let (x, y): (Vector3<f64>, Vector3<f64>) = (rotation.column(0).into(), rotation.column(1).into());
                rotation.set_column(0, &(x * cos + y * sin));
                rotation.set_column(1, &(y * cos - x * sin));
            } else {
                position += axis * value;
            }
        }
        position += rotation * self.tool_translation;
        (rotation * self.tool_rotation, position)
    }

    /// What is missing to `target` with the joints at `values`; fills the Jacobian, one column per joint of the chain.
    ///
    /// # Source
    /// The geometric Jacobian as in [`KinematicChain::jacobian`].
    pub(super) fn error(&self, values: &[f64], target: &Target, columns: &mut [Column]) -> PoseError {
        // More joints than columns: some follow others.
        let mut axes: ArrayVec<(Vector3<f64>, Vector3<f64>), { 2 * MAX_JOINTS }> = ArrayVec::new();
        let (rotation, position) = self.pass(values, |_, axis, point| {
            let _full = axes.try_push((axis, point));
        });
        columns.fill([0.0; 6]);
        for (joint, (axis, point)) in self.joints.iter().zip(&axes) {
            let Some(column) = columns.get_mut(joint.drive.variable) else { continue };
            let (linear, angular) = if joint.is_turning {
                (axis.cross(&(position - point)), axis * self.length_m)
            } else {
                (*axis, Vector3::zeros())
            };
            let factor = joint.drive.multiplier;
            for (entry, speed) in column.iter_mut().zip(linear.iter().chain(angular.iter())) {
                *entry += factor * speed;
            }
        }
        PoseError {
            position_m: target.translation - position,
            rotation_rad: rotation_vector(&(target.rotation * rotation.transpose())),
            length_m: self.length_m,
        }
    }
}

/// One radian of the tool's turning counts as this share of the chain's length.
const LENGTH_SHARE: f64 = 0.3;

/// The shortest rotation that brings the z axis onto `axis`.
fn z_onto(axis: &Vector3<f64>) -> UnitQuaternion<f64> {
    let half_turn = || UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
    UnitQuaternion::rotation_between(&Vector3::z(), axis).unwrap_or_else(half_turn)
}

/// Axis times angle (rad, at most pi) of a rotation matrix.
fn rotation_vector(rotation: &Matrix3<f64>) -> Vector3<f64> {
    let r = rotation;
    // Twice the sine times the axis, and twice the cosine.
    let twice_sine = Vector3::new(r[(2, 1)] - r[(1, 2)], r[(0, 2)] - r[(2, 0)], r[(1, 0)] - r[(0, 1)]);
    let (sine, cosine) = (twice_sine.norm(), r.trace() - 1.0);
    if cosine > 0.0 && sine < 1e-4 {
        // angle / sin(angle), to the fourth order.
        return twice_sine * (0.5 * (1.0 + sine * sine / 24.0));
    }
    if sine > 1e-6 {
        return twice_sine * (sine.atan2(cosine) / sine);
    }
    // Nearly half a turn, where the sine says nothing: (R + I) / 2 is axis times axis.
    let longest = (0..3).max_by(|a, b| r[(*a, *a)].total_cmp(&r[(*b, *b)])).unwrap_or_default();
    let mut axis: Vector3<f64> = r.column(longest).into();
    axis[longest] += 1.0;
    axis.try_normalize(0.0).map_or_else(Vector3::zeros, |axis| axis * std::f64::consts::PI)
}
