//! Inverse kinematics of any serial chain, for robots without a closed form.
//!
//! A pose is answered in attempts. Each starts at that configuration of a window, drawn at random, of a table (`seeds`) whose pose is
//! nearest to the one asked for, and descends from there by damped least squares: `dq = J^T (J J^T + lambda I)^-1 e` over the
//! joints that no limit holds, `e` being the pose error and `lambda` growing with it. An attempt that comes no nearer is given
//! up and the next one starts from the window after it. So the answers of a redundant chain differ from draw to draw, and the same
//! draws give the same answer on any machine of the same arithmetic: nothing reads a clock. A call does not allocate.

mod constants;
mod seeds;
mod step;

use arrayvec::ArrayVec;
use nalgebra::Isometry3;
use rand::Rng;

use super::jacobian::KinematicChain;
use super::limit::{JointLimit, wrap_to_pi};
use super::tree::{KinematicTree, KinematicsError, expect_length};
use constants::{Column, Constants, PoseError, Target};
use seeds::Seeds;
use step::Step;

use crate::joints::MAX_JOINTS;

/// One value per joint of a chain, base side first: rad (turning) or m (sliding).
pub type JointValues = ArrayVec<f64, MAX_JOINTS>;

/// Settings of [`ChainInverse`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InverseOptions {
    /// Largest accepted distance between the tool and its target, m; above 0.
    pub position_tolerance: f64,
    /// Largest accepted angle between the tool and its target, rad; above 0.
    pub rotation_tolerance: f64,
    /// Attempts before a pose is called out of reach; at least 1.
    pub attempts: usize,
    /// Most iterations of one attempt; at least 1.
    pub iterations: usize,
    /// Keep to the soft limits instead of the hard ones.
    pub soft_limits: bool,
    /// Bring the tool as near to its target as rounding lets it, not only within the tolerances: a chain of fewer joints than six
    /// reaches a pose that is computed from such an answer only if that is where it says.
    pub exact: bool,
}

impl Default for InverseOptions {
    fn default() -> Self {
        // Half of what the laws of a manipulator ask, so that what a caller computes from the joints stays within them.
        Self {
            position_tolerance: 5e-10,
            rotation_tolerance: 5e-10,
            attempts: 16,
            iterations: 40,
            soft_limits: true,
            exact: false,
        }
    }
}

/// The inverse of one chain of one robot.
///
/// # Laws
/// What [`inverse`](Self::inverse) and [`inverse_near`](Self::inverse_near) return lies within [`limits`](Self::limits), and
/// [`base_from_tool`](Self::base_from_tool) of it is the pose asked for, within the tolerances.
#[derive(Debug, Clone)]
pub struct ChainInverse {
    constants: Constants,
    variables: ArrayVec<usize, MAX_JOINTS>,
    limits: ArrayVec<JointLimit, MAX_JOINTS>,
    options: InverseOptions,
    seeds: Seeds,
}

/// An attempt that has not come this much nearer (in squared error) is given up ...
const STUCK_RATIO: f64 = 0.7;
/// ... after so many iterations.
const STUCK_AFTER: usize = 4;
/// Most steps that make an answer exact: each squares what is missing.
const EXACT_STEPS: usize = 2;
/// Largest change of one joint in one iteration, rad or m.
const LONGEST_STEP: f64 = 1.0;

/// What an attempt came to.
enum End {
    /// The tool stands where it should.
    Reached,
    /// It does not.
    Stuck,
}

impl ChainInverse {
    /// Prepares the inverse of the chain from link `base` (exclusive) to link `tip`, for a tool fixed to the tip.
    ///
    /// Takes some milliseconds: the table of configurations is made here.
    ///
    /// # Errors
    /// As [`KinematicChain::new`]; [`KinematicsError::NoJoint`] when nothing between them moves, [`KinematicsError::TooManyJoints`]
    /// for more than [`MAX_JOINTS`] joints.
    pub fn new(
        tree: &KinematicTree,
        base: &str,
        tip: &str,
        tip_from_tool: &Isometry3<f64>,
        options: InverseOptions,
    ) -> Result<Self, KinematicsError> {
        let chain = KinematicChain::new(tree, base, tip)?;
        let count = chain.variables().len();
        if count == 0 {
            return Err(KinematicsError::NoJoint { base: base.to_owned(), tip: tip.to_owned() });
        }
        if count > MAX_JOINTS {
            let names = (base.to_owned(), tip.to_owned());
            return Err(KinematicsError::TooManyJoints { base: names.0, tip: names.1, count, bound: MAX_JOINTS });
        }
        let limit = |variable: &usize| {
            let v = tree.variables().get(*variable);
            v.map_or(JointLimit::UNLIMITED, |v| if options.soft_limits { v.soft_limit } else { v.limit })
        };
        let limits: ArrayVec<_, MAX_JOINTS> = chain.variables().iter().map(limit).collect();
        let constants = Constants::new(tree, &chain, tip_from_tool);
        let seeds = Seeds::new(&constants, &limits);
        Ok(Self { constants, variables: chain.variables().iter().copied().collect(), limits, options, seeds })
    }

    /// Index of the tree's variable for each joint of the chain.
    pub fn variables(&self) -> &[usize] {
        &self.variables
    }

    /// Limits of the joints: those that the answers keep to.
    pub fn limits(&self) -> &[JointLimit] {
        &self.limits
    }

    /// Pose of the tool in the base link.
    ///
    /// # Errors
    /// [`KinematicsError::Length`] when `joints` has the wrong length.
    pub fn base_from_tool(&self, joints: &[f64]) -> Result<Isometry3<f64>, KinematicsError> {
        expect_length("joints", joints.len(), self.limits.len())?;
        Ok(self.constants.pose(joints))
    }

    /// Can the tool stand there as far as the lengths of the links say? A cheap necessary condition.
    pub fn may_reach(&self, base_from_tool: &Isometry3<f64>) -> bool {
        self.constants.may_reach(&base_from_tool.translation.vector, &self.limits)
    }

    /// Joint values that bring the tool to `base_from_tool`; which ones of all that do is drawn from `rng`.
    ///
    /// Turning joints without limits are returned in `(-pi, pi]`. `None` when no attempt ended within the tolerances.
    ///
    /// # Source
    /// Damped least squares: Wampler 1986; damping by the error: Sugihara 2011, *Solvability-Unconcerned Inverse Kinematics by
    /// the Levenberg-Marquardt Method*, eq. 18.
    pub fn inverse(&self, base_from_tool: &Isometry3<f64>, rng: &mut dyn Rng) -> Option<JointValues> {
        if !self.may_reach(base_from_tool) {
            return None;
        }
        let target = Target::new(base_from_tool);
        let mut joints = JointValues::new();
        let first = Seeds::draw(rng);
        for attempt in 0..self.options.attempts {
            self.seeds.nearest(base_from_tool, first, attempt, &mut joints);
            if let End::Reached = self.descend(&target, &mut joints, &self.limits, Turns::Free) {
                self.wrap(&mut joints);
                return Some(joints);
            }
        }
        None
    }

    /// Joint values near `near` that bring the tool to `base_from_tool`, no joint farther away than `max_joint_step` (rad, m;
    /// joints without limits the short way round); for following a line in small steps.
    ///
    /// One descent from `near`, each step of which is the shortest that mends the error: nothing is drawn. `None` when it
    /// ends elsewhere or too far away, or when `near` has the wrong length.
    pub fn inverse_near(
        &self,
        base_from_tool: &Isometry3<f64>,
        near: &[f64],
        max_joint_step: f64,
    ) -> Option<JointValues> {
        if near.len() != self.limits.len() {
            return None;
        }
        let mut joints: JointValues = near.iter().zip(&self.limits).map(|(value, limit)| limit.clamp(*value)).collect();
        let End::Reached = self.descend(&Target::new(base_from_tool), &mut joints, &self.limits, Turns::Kept) else {
            return None;
        };
        let is_near = joints.iter().zip(near).all(|(value, near)| (value - near).abs() <= max_joint_step);
        self.wrap(&mut joints);
        is_near.then_some(joints)
    }

    /// Joint values that bring the tool to `base_from_tool` and lie within `limits`, which are no wider than those of the chain: a joint
    /// whose limits are one value stays there. One descent from `start`; `None` when it ends elsewhere, or when a length is wrong.
    pub fn inverse_from(
        &self,
        base_from_tool: &Isometry3<f64>,
        start: &[f64],
        limits: &[JointLimit],
    ) -> Option<JointValues> {
        if start.len() != self.limits.len() || limits.len() != self.limits.len() {
            return None;
        }
        let mut joints: JointValues = start.iter().zip(limits).map(|(value, limit)| limit.clamp(*value)).collect();
        let End::Reached = self.descend(&Target::new(base_from_tool), &mut joints, limits, Turns::Free) else {
            return None;
        };
        self.wrap(&mut joints);
        Some(joints)
    }

    /// One descent from `joints`, which lie within `limits` and stay there.
    fn descend(&self, target: &Target, joints: &mut JointValues, limits: &[JointLimit], turns: Turns) -> End {
        let mut columns = [Column::default(); MAX_JOINTS];
        let Some(columns) = columns.get_mut(..joints.len()) else {
            return End::Stuck;
        };
        let mut best = f64::INFINITY;
        let mut before = [f64::INFINITY; STUCK_AFTER];
        for iteration in 0..self.options.iterations {
            let error = self.constants.error(joints, target, columns);
            let (position, rotation) = error.norms();
            let square = error.square();
            if position <= self.options.position_tolerance && rotation <= self.options.rotation_tolerance {
                if self.options.exact {
                    self.make_exact(target, joints, (columns, error), limits);
                }
                return End::Reached;
            }
            best = square.min(best);
            let then = &mut before[iteration % STUCK_AFTER];
            // An error that is no number is never the best one, so that it ends here too.
            if best >= STUCK_RATIO * *then {
                return End::Stuck;
            }
            *then = best;
            let step = Step { columns, error: &error, limits };
            if !step.take(joints, turns) {
                return End::Stuck;
            }
        }
        End::Stuck
    }

    /// Goes on from where the tool is within the tolerances, as long as it comes nearer.
    fn make_exact(
        &self,
        target: &Target,
        joints: &mut JointValues,
        (columns, mut error): (&mut [Column], PoseError),
        limits: &[JointLimit],
    ) {
        for _ in 0..EXACT_STEPS {
            let before = joints.clone();
            let moves = Step { columns, error: &error, limits }.take(joints, Turns::Kept);
            let next = self.constants.error(joints, target, columns);
            if !moves || next.square().partial_cmp(&error.square()) != Some(std::cmp::Ordering::Less) {
                *joints = before;
                return;
            }
            error = next;
        }
    }

    fn wrap(&self, joints: &mut JointValues) {
        for ((limit, value), is_turning) in self.limits.iter().zip(joints).zip(self.constants.turning()) {
            if *is_turning && limit.is_unlimited() {
                *value = wrap_to_pi(*value);
            }
        }
    }
}

/// May a turning joint that runs into its limit go on a whole turn away?
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Turns {
    /// It may, where its range is that wide.
    Free,
    /// It stays.
    Kept,
}

#[cfg(test)]
mod tests;
