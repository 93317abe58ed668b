//! Configurations of the arm for a pose of the tool.

use darrt_primitives::joints::Joints;
use darrt_primitives::kinematics::{ChainInverse, InverseOptions, JointLimit, KinematicTree, KinematicsError};
use darrt_primitives::manipulator::JointVector as _;
use nalgebra::Isometry3;
use rand::Rng;

use super::chain::{Driver, Layout};
use crate::problem_file::Limits;
use crate::robot_file::Amended;
use crate::robot_file::amend::ANY_POSE;

/// The inverse of an arm, from the frame of its base to its tool.
#[derive(Debug, Clone)]
pub(super) struct Inverse {
    solver: ChainInverse,
    /// From what the arm is mounted on.
    mount_from_base: Isometry3<f64>,
    /// Variables of the arm in the tree, in the order of its joints.
    variables: Vec<usize>,
    /// Values of all variables; those of the arm are replaced.
    rest: Vec<f64>,
    /// The variable that opens the hand.
    finger: Option<usize>,
}

impl Inverse {
    /// # Errors
    /// As [`ChainInverse::new`].
    pub(super) fn new(
        tree: &KinematicTree,
        amended: &Amended,
        layout: &Layout<'_>,
        kind: Limits,
    ) -> Result<Self, KinematicsError> {
        let lost = || KinematicsError::UnknownLink { name: amended.tool_link.clone() };
        let first = layout.arm_links.first().ok_or_else(lost)?;
        let mount = tree.parent(*first).ok_or_else(lost)?;
        let base_from_mount = layout.place(mount).ok_or_else(lost)?.in_anchor(&[], 0.0);
        let name = tree.link_names().get(mount).ok_or_else(lost)?;
        let exact = layout.arm_links.len() < ANY_POSE;
        let options = InverseOptions { soft_limits: kind == Limits::Soft, exact, ..InverseOptions::default() };
        let solver = ChainInverse::new(tree, name, &amended.tool_link, &Isometry3::identity(), options)?;
        let value = |driver: &Driver| if let Driver::Rests(value) = driver { *value } else { 0.0 };
        Ok(Self {
            variables: solver.variables().to_vec(),
            solver,
            mount_from_base: base_from_mount.inverse(),
            rest: layout.drivers.iter().map(value).collect(),
            finger: layout.drivers.iter().position(|driver| *driver == Driver::Finger),
        })
    }

    /// The limits that it keeps to.
    pub(super) fn limits(&self) -> &[JointLimit] {
        self.solver.limits()
    }

    /// The values of all variables of the tree.
    pub(super) fn values(&self, arm: &Joints, finger: f64) -> Vec<f64> {
        let mut values = self.rest.clone();
        let arm = self.variables.iter().copied().zip(arm.as_ref().iter().copied());
        for (variable, value) in arm.chain(self.finger.map(|variable| (variable, finger))) {
            if let Some(slot) = values.get_mut(variable) {
                *slot = value;
            }
        }
        values
    }

    /// Some configuration of the arm.
    pub(super) fn any(&self, base_from_tool: &Isometry3<f64>, rng: &mut dyn Rng) -> Option<Joints> {
        Joints::from_values(&self.solver.inverse(&(self.mount_from_base * base_from_tool), rng)?)
    }

    /// The configuration near this one, no joint of it farther away than `step`.
    pub(super) fn near(&self, base_from_tool: &Isometry3<f64>, near: &Joints, step: f64) -> Option<Joints> {
        Joints::from_values(&self.solver.inverse_near(&(self.mount_from_base * base_from_tool), near.as_ref(), step)?)
    }
}
