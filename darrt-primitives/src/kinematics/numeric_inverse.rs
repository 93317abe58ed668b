//! Inverse kinematics by damped least squares, for chains without a closed form.
//!
//! Each iteration solves `(J^T J + lambda^2 I) dq = J^T e` over the joints that are not held by a limit, where `e` is
//! the pose error; `lambda` falls while the error falls and grows otherwise. Local minima are left by restarting from
//! random values drawn from the caller's generator.

use faer::linalg::solvers::Solve;
use faer::{Mat, Side};
use nalgebra::{Isometry3, Point3, Vector6};
use rand::{Rng, RngExt};
use std::f64::consts::PI;

use super::jacobian::Chain;
use super::limit::{JointLimit, wrap_to_pi};
use super::tree::{KinematicTree, KinematicsError, expect_length};

/// Settings of the numeric inverse.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InverseOptions {
    /// Largest accepted distance between the tip and its target, m; above 0.
    pub position_tolerance: f64,
    /// Largest accepted angle between the tip and its target, rad; above 0.
    pub rotation_tolerance: f64,
    /// Iterations of one descent; at least 1.
    pub max_iterations: usize,
    /// Random starts after the first descent from the seed.
    pub restarts: usize,
    /// Largest change of one joint in one iteration, rad or m; above 0.
    pub max_step: f64,
    /// First damping `lambda`; above 0.
    pub damping: f64,
    /// Run every restart and return the solution nearest to the seed, instead of the first found.
    pub nearest: bool,
    /// Keep to the soft limits instead of the hard ones.
    pub soft_limits: bool,
}

impl Default for InverseOptions {
    fn default() -> Self {
        Self {
            position_tolerance: 1e-9,
            rotation_tolerance: 1e-9,
            max_iterations: 200,
            restarts: 20,
            max_step: 0.3,
            damping: 0.1,
            nearest: false,
            soft_limits: true,
        }
    }
}

/// Damping is kept between these.
const DAMPING_RANGE: (f64, f64) = (1e-9, 1e3);

/// A numeric inverse for one chain of one robot.
#[derive(Debug, Clone)]
pub struct NumericInverse<'a> {
    tree: &'a KinematicTree,
    chain: Chain,
    options: InverseOptions,
    limits: Vec<JointLimit>,
}

/// Buffers of one call.
struct Work {
    poses: Vec<Isometry3<f64>>,
    columns: Vec<Vector6<f64>>,
    values: Vec<f64>,
    trial: Vec<f64>,
}

impl<'a> NumericInverse<'a> {
    /// Prepares the inverse of `chain` in `tree`.
    pub fn new(tree: &'a KinematicTree, chain: Chain, options: InverseOptions) -> Self {
        let limit = |variable: &usize| {
            let v = tree.variables().get(*variable);
            v.map_or(JointLimit::UNLIMITED, |v| if options.soft_limits { v.soft_limit } else { v.limit })
        };
        Self { limits: chain.variables().iter().map(limit).collect(), tree, chain, options }
    }

    /// Finds joint values that bring the tip of the chain to `root_from_tip`.
    ///
    /// `seed`: one value per variable of the whole tree; variables outside the chain keep these values. Returns a
    /// full configuration inside the limits (turning joints without limits in `(-pi, pi]`), or `None` when no descent
    /// reached the tolerances.
    ///
    /// # Errors
    /// [`KinematicsError::Length`] when `seed` has the wrong length.
    ///
    /// # Source
    /// Wampler 1986 (damped least squares); damping schedule after Marquardt 1963.
    pub fn solve(
        &self,
        root_from_tip: &Isometry3<f64>,
        seed: &[f64],
        rng: &mut dyn Rng,
    ) -> Result<Option<Vec<f64>>, KinematicsError> {
        expect_length("seed", seed.len(), self.tree.variables().len())?;
        let mut work = Work {
            poses: vec![Isometry3::identity(); self.tree.link_count()],
            columns: vec![Vector6::zeros(); self.limits.len()],
            values: seed.to_vec(),
            trial: seed.to_vec(),
        };
        let mut best: Option<(f64, Vec<f64>)> = None;
        for restart in 0..=self.options.restarts {
            self.start(&mut work, seed, restart, rng);
            if !self.descend(&mut work, root_from_tip)? {
                continue;
            }
            let distance = self.distance(&work.values, seed);
            if best.as_ref().is_none_or(|(d, _)| distance.total_cmp(d).is_lt()) {
                best = Some((distance, work.values.clone()));
            }
            if !self.options.nearest {
                break;
            }
        }
        Ok(best.map(|(_, values)| values))
    }

    /// The seed moved into the limits, or random values.
    fn start(&self, work: &mut Work, seed: &[f64], restart: usize, rng: &mut dyn Rng) {
        work.values.copy_from_slice(seed);
        for (limit, variable) in self.limits.iter().zip(self.chain.variables()) {
            let value = &mut work.values[*variable];
            *value = if restart == 0 { limit.clamp(*value) } else { random_in(limit, rng) };
        }
    }

    /// Euclidean distance over the chain's variables, unlimited ones the short way round.
    fn distance(&self, values: &[f64], seed: &[f64]) -> f64 {
        let square = |(limit, variable): (&JointLimit, &usize)| {
            let difference = values[*variable] - seed[*variable];
            let difference = if limit.is_unlimited() { wrap_to_pi(difference) } else { difference };
            difference * difference
        };
        self.limits.iter().zip(self.chain.variables()).map(square).sum::<f64>().sqrt()
    }

    /// One descent from `work.values`; whether it ended within the tolerances.
    fn descend(&self, work: &mut Work, target: &Isometry3<f64>) -> Result<bool, KinematicsError> {
        let mut damping = self.options.damping;
        let mut error = self.pose_error(&work.values, target, &mut work.poses)?;
        for _ in 0..self.options.max_iterations {
            if self.reached(&error) {
                self.wrap(&mut work.values);
                return Ok(true);
            }
            self.chain.jacobian(self.tree, &work.poses, &Point3::origin(), &mut work.columns)?;
            let Some(step) = self.step(work, &error, damping) else {
                return Ok(false);
            };
            work.trial.copy_from_slice(&work.values);
            for ((change, limit), variable) in step.iter().zip(&self.limits).zip(self.chain.variables()) {
                work.trial[*variable] = limit.clamp(work.values[*variable] + change);
            }
            let trial_error = self.pose_error(&work.trial, target, &mut work.poses)?;
            if trial_error.norm_squared() < error.norm_squared() {
                std::mem::swap(&mut work.values, &mut work.trial);
                error = trial_error;
                damping = (damping * 0.3).max(DAMPING_RANGE.0);
            } else {
                damping *= 4.0;
                if damping > DAMPING_RANGE.1 {
                    return Ok(false);
                }
                // The Jacobian of the next round belongs to the values that were kept.
                self.pose_error(&work.values, target, &mut work.poses)?;
            }
        }
        Ok(false)
    }

    /// Position error (m) above rotation error (rad), in the root frame; fills `poses`.
    fn pose_error(
        &self,
        values: &[f64],
        target: &Isometry3<f64>,
        poses: &mut [Isometry3<f64>],
    ) -> Result<Vector6<f64>, KinematicsError> {
        self.tree.forward(values, &Isometry3::identity(), poses)?;
        let tip = poses.get(self.chain.tip()).copied().unwrap_or_default();
        let mut error = Vector6::zeros();
        error.fixed_rows_mut::<3>(0).copy_from(&(target.translation.vector - tip.translation.vector));
        error.fixed_rows_mut::<3>(3).copy_from(&(target.rotation * tip.rotation.inverse()).scaled_axis());
        Ok(error)
    }

    fn reached(&self, error: &Vector6<f64>) -> bool {
        error.fixed_rows::<3>(0).norm() <= self.options.position_tolerance
            && error.fixed_rows::<3>(3).norm() <= self.options.rotation_tolerance
    }

    /// The damped step, scaled down to `max_step`; `None` when the system cannot be solved.
    fn step(&self, work: &Work, error: &Vector6<f64>, damping: f64) -> Option<Vec<f64>> {
        let n = self.limits.len();
        let gradient: Vec<f64> = work.columns.iter().map(|c| c.dot(error)).collect();
        // A joint at its limit that would move further out is held: its row and column become those of the identity.
        let held = |i: usize| {
            let value = work.values[self.chain.variables()[i]];
            let limit = &self.limits[i];
            (gradient[i] < 0.0 && value <= limit.lower) || (gradient[i] > 0.0 && value >= limit.upper)
        };
        let free: Vec<bool> = (0..n).map(|i| !held(i)).collect();
        let normal = Mat::from_fn(n, n, |i, j| {
            let product = if free[i] && free[j] { work.columns[i].dot(&work.columns[j]) } else { 0.0 };
            if i == j { product + damping * damping } else { product }
        });
        let mut step = Mat::from_fn(n, 1, |i, _| if free[i] { gradient[i] } else { 0.0 });
        normal.llt(Side::Lower).ok()?.solve_in_place(&mut step);
        let step: Vec<f64> = (0..n).map(|i| step[(i, 0)]).collect();
        let largest = step.iter().fold(0.0_f64, |m, s| m.max(s.abs()));
        if !largest.is_finite() {
            return None;
        }
        let scale = (self.options.max_step / largest).min(1.0);
        Some(step.into_iter().map(|s| s * scale).collect())
    }

    fn wrap(&self, values: &mut [f64]) {
        for (limit, variable) in self.limits.iter().zip(self.chain.variables()) {
            if limit.is_unlimited() {
                values[*variable] = wrap_to_pi(values[*variable]);
            }
        }
    }
}

/// Uniform within the limits; an infinite end stands for half a turn.
fn random_in(limit: &JointLimit, rng: &mut dyn Rng) -> f64 {
    let lower = if limit.lower.is_finite() { limit.lower } else { limit.upper.min(PI) - 2.0 * PI };
    let upper = if limit.upper.is_finite() { limit.upper } else { lower + 2.0 * PI };
    rng.random_range(lower..=upper)
}

#[cfg(test)]
mod tests {
    use super::super::urdf::RobotDescription;
    use super::*;
    use rand::SeedableRng;

    fn generic() -> KinematicTree {
        let text = include_str!("../../tests/data/generic_arm.urdf");
        KinematicTree::new(&RobotDescription::from_text(text).unwrap()).unwrap()
    }

    fn random(tree: &KinematicTree, rng: &mut dyn Rng) -> Vec<f64> {
        tree.variables().iter().map(|v| random_in(&v.soft_limit, rng)).collect()
    }

    fn tip(tree: &KinematicTree, chain: &Chain, q: &[f64]) -> Isometry3<f64> {
        let mut poses = vec![Isometry3::identity(); tree.link_count()];
        tree.forward(q, &Isometry3::identity(), &mut poses).unwrap();
        poses[chain.tip()]
    }

    #[test]
    fn reaches_poses_of_an_arm_without_closed_form() {
        let tree = generic();
        let chain = Chain::new(&tree, "mount", "probe").unwrap();
        let inverse = NumericInverse::new(&tree, chain.clone(), InverseOptions::default());
        let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(11);
        let mut found = 0;
        for _ in 0..60 {
            let target = tip(&tree, &chain, &random(&tree, &mut rng));
            let seed = random(&tree, &mut rng);
            let Some(q) = inverse.solve(&target, &seed, &mut rng).unwrap() else {
                continue;
            };
            found += 1;
            let reached = tip(&tree, &chain, &q);
            assert!((reached.translation.vector - target.translation.vector).norm() < 1e-9);
            assert!(reached.rotation.angle_to(&target.rotation) < 1e-7);
            for (value, variable) in q.iter().zip(tree.variables()) {
                assert!(variable.soft_limit.contains(*value));
            }
        }
        assert!(found >= 57, "{found} of 60");
    }

    #[test]
    fn nearest_is_no_farther_than_first() {
        let tree = generic();
        let chain = Chain::new(&tree, "mount", "probe").unwrap();
        let first = NumericInverse::new(&tree, chain.clone(), InverseOptions::default());
        let nearest = InverseOptions { nearest: true, ..InverseOptions::default() };
        let nearest = NumericInverse::new(&tree, chain.clone(), nearest);
        let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(5);
        for _ in 0..5 {
            let seed = random(&tree, &mut rng);
            let target = tip(&tree, &chain, &random(&tree, &mut rng));
            let mut same = rng.clone();
            let a = first.solve(&target, &seed, &mut rng).unwrap();
            let b = nearest.solve(&target, &seed, &mut same).unwrap();
            if let (Some(a), Some(b)) = (a, b) {
                assert!(nearest.distance(&b, &seed) <= nearest.distance(&a, &seed));
            }
        }
    }

    #[test]
    fn an_unreachable_pose_is_none() {
        let tree = generic();
        let chain = Chain::new(&tree, "mount", "probe").unwrap();
        let options = InverseOptions { restarts: 3, ..InverseOptions::default() };
        let inverse = NumericInverse::new(&tree, chain, options);
        let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(1);
        let far = Isometry3::translation(3.0, 0.0, 0.0);
        assert_eq!(inverse.solve(&far, &tree.neutral(), &mut rng).unwrap(), None);
        assert!(inverse.solve(&far, &[0.0], &mut rng).is_err());
        let nan = Isometry3::translation(f64::NAN, 0.0, 0.0);
        assert_eq!(inverse.solve(&nan, &tree.neutral(), &mut rng).unwrap(), None);
    }
}
