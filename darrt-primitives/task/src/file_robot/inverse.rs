//! Configurations of the arm for a pose of the tool.

use std::f64::consts::PI;
use std::sync::Arc;

use darrt_primitives::joints::Joints;
use darrt_primitives::kinematics::{Chain, InverseOptions, JointLimit, KinematicTree, NumericInverse};
use darrt_primitives::manipulator::JointVector as _;
use nalgebra::Isometry3;
use rand::{Rng, RngExt, SeedableRng as _};

use super::chain::{Driver, Layout};
use crate::robot_file::Amended;

/// The numeric inverse of an arm, from the frame of its base to its tool.
#[derive(Debug, Clone)]
pub(super) struct Inverse {
    tree: Arc<KinematicTree>,
    chain: Chain,
    /// Variables of the arm, in the order of its joints.
    variables: Vec<usize>,
    /// Values of all variables; those of the arm are replaced.
    rest: Vec<f64>,
    /// The variable that opens the hand.
    finger: Option<usize>,
    limits: Vec<JointLimit>,
}

/// How near the tool must come, metres and radians.
const TOLERANCE: f64 = 1e-10;

impl Inverse {
    pub(super) fn new(tree: KinematicTree, amended: &Amended, layout: &Layout<'_>, limits: &[JointLimit]) -> Option<Self> {
        let mount = tree.parent(*layout.arm_links.first()?)?;
        let chain = Chain::new(&tree, tree.link_names().get(mount)?, &amended.tool_link).ok()?;
        let variables = amended.arm_joints.iter().map(|name| tree.variable_index(name)).collect::<Option<_>>()?;
        let value = |driver: &Driver| if let Driver::Rests(value) = driver { *value } else { 0.0 };
        let rest = layout.drivers.iter().map(value).collect();
        let finger = layout.drivers.iter().position(|driver| *driver == Driver::Finger);
        Some(Self { tree: Arc::new(tree), chain, variables, rest, finger, limits: limits.to_vec() })
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
        let mut start = Joints::zeros(self.limits.len())?;
        for (slot, limit) in start.as_mut().iter_mut().zip(&self.limits) {
            let [low, high] =
                if limit.is_unlimited() { [-PI, PI] } else { [limit.lower, limit.upper] };
            *slot = rng.random_range(low..=high);
        }
        self.solve(base_from_tool, &start, 8, rng)
    }

    /// The configuration that a descent from `near` finds.
    pub(super) fn near(&self, base_from_tool: &Isometry3<f64>, near: &Joints) -> Option<Joints> {
        self.solve(base_from_tool, near, 0, &mut rand_xoshiro::SplitMix64::seed_from_u64(0))
    }

    fn solve(
        &self,
        base_from_tool: &Isometry3<f64>,
        start: &Joints,
        restarts: usize,
        rng: &mut dyn Rng,
    ) -> Option<Joints> {
        let options = InverseOptions {
            position_tolerance: TOLERANCE,
            rotation_tolerance: TOLERANCE,
            max_iterations: 40,
            restarts,
            soft_limits: false,
            ..InverseOptions::default()
        };
        let mut seed = self.rest.clone();
        for (variable, value) in self.variables.iter().zip(start.as_ref()) {
            *seed.get_mut(*variable)? = *value;
        }
        let inverse = NumericInverse::new(&self.tree, self.chain.clone(), options);
        let found = inverse.solve(base_from_tool, &seed, rng).ok()??;
        let mut joints = *start;
        for (slot, variable) in joints.as_mut().iter_mut().zip(&self.variables) {
            *slot = *found.get(*variable)?;
        }
        joints.as_ref().iter().zip(&self.limits).all(|(q, limit)| limit.contains(*q)).then_some(joints)
    }
}
