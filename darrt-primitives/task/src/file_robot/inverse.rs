//! Configurations of the arm for a pose of the tool.

use darrt_primitives::kinematics::{ChainInverse, InverseOptions, JointLimit, KinematicsError};
use nalgebra::Isometry3;
use rand::Rng;

use super::chain::{Fingers, Layout, Values};
use crate::problem_file::Limits;
use crate::robot_file::amend::ANY_POSE;

/// The inverse of an arm, from the frame of its base to its tool.
#[derive(Debug, Clone)]
pub(super) struct Inverse {
    solver: ChainInverse,
    /// From what the arm is mounted on.
    mount_from_base: Isometry3<f64>,
}

impl Inverse {
    /// # Errors
    /// As [`ChainInverse::new`].
    pub(super) fn new(layout: &Layout<'_>, tool_link: &str, kind: Limits) -> Result<Self, KinematicsError> {
        let tree = layout.tree;
        let lost = || KinematicsError::UnknownLink { name: tool_link.to_owned() };
        let first = layout.arm_links.first().ok_or_else(lost)?;
        let mount = tree.parent(*first).ok_or_else(lost)?;
        let base_from_mount = layout.place(mount).ok_or_else(lost)?.in_anchor(&[], Fingers::default());
        let name = tree.link_names().get(mount).ok_or_else(lost)?;
        let exact = layout.arm_links.len() < ANY_POSE;
        let options = InverseOptions { soft_limits: kind == Limits::Soft, exact, ..InverseOptions::default() };
        let solver = ChainInverse::new(tree, name, tool_link, &Isometry3::identity(), options)?;
        Ok(Self { solver, mount_from_base: base_from_mount.inverse() })
    }

    /// The limits that it keeps to.
    pub(super) fn limits(&self) -> &[JointLimit] {
        self.solver.limits()
    }

    /// Some configuration of the arm.
    pub(super) fn any(&self, base_from_tool: &Isometry3<f64>, rng: &mut dyn Rng) -> Option<Values> {
        self.solver.inverse(&(self.mount_from_base * base_from_tool), rng)
    }

    /// The configuration near this one, no joint of it farther away than `step`.
    pub(super) fn near(&self, base_from_tool: &Isometry3<f64>, near: &[f64], step: f64) -> Option<Values> {
        self.solver.inverse_near(&(self.mount_from_base * base_from_tool), near, step)
    }
}
