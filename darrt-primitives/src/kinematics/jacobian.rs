//! The geometric Jacobian: how fast a point of a link moves, and the link turns, per unit speed of each joint.

use nalgebra::{Isometry3, Point3, Vector3, Vector6};

use super::tree::{Drive, KinematicTree, KinematicsError, LinkMotion, expect_length};

/// The joints between a link and one of its descendants.
#[derive(Debug, Clone)]
pub struct KinematicChain {
    base: usize,
    tip: usize,
    /// Moved links on the way, base side first, each with the column of its variable.
    steps: Vec<(usize, usize)>,
    variables: Vec<usize>,
}

impl KinematicChain {
    /// The chain from `base` (exclusive) to `tip` (inclusive), by link names.
    ///
    /// # Errors
    /// [`KinematicsError::UnknownLink`] for a name that does not exist, [`KinematicsError::NotAbove`] when `base` is
    /// not an ancestor of `tip` (or `tip` itself).
    pub fn new(tree: &KinematicTree, base: &str, tip: &str) -> Result<Self, KinematicsError> {
        let index =
            |name: &str| tree.link_index(name).ok_or_else(|| KinematicsError::UnknownLink { name: name.to_owned() });
        let (base_link, tip_link) = (index(base)?, index(tip)?);
        let mut moved = Vec::new();
        let mut link = tip_link;
        while link != base_link {
            if let Some((_, drive)) = axis_and_drive(tree, link) {
                moved.push((link, drive.variable));
            }
            link = tree
                .parent(link)
                .ok_or_else(|| KinematicsError::NotAbove { base: base.to_owned(), tip: tip.to_owned() })?;
        }
        moved.reverse();
        let mut variables: Vec<usize> = Vec::new();
        let mut steps = Vec::with_capacity(moved.len());
        for (link, variable) in moved {
            let known = variables.iter().position(|v| *v == variable);
            let column = known.unwrap_or(variables.len());
            if known.is_none() {
                variables.push(variable);
            }
            steps.push((link, column));
        }
        Ok(Self { base: base_link, tip: tip_link, steps, variables })
    }

    /// Index of the link the chain starts from.
    pub fn base(&self) -> usize {
        self.base
    }

    /// Index of the link the chain ends at.
    pub fn tip(&self) -> usize {
        self.tip
    }

    /// The variables that move the tip against the base, base side first: the columns of the Jacobian.
    pub fn variables(&self) -> &[usize] {
        &self.variables
    }

    /// Writes the Jacobian of a point fixed in the tip link.
    ///
    /// `world_from_link`: pose of every link, from [`KinematicTree::forward`]. `tip_point`: the point in the tip
    /// frame, m. `out`: one column per variable of the chain; rows are the velocity of the point (x, y, z, m per unit
    /// of the variable) and the angular velocity (x, y, z, rad per unit), in the world frame. Does not allocate.
    ///
    /// # Errors
    /// [`KinematicsError::Length`] when a slice has the wrong length.
    ///
    /// # Source
    /// Siciliano, Sciavicco, Villani, Oriolo, *Robotics: Modelling, Planning and Control* (2009), eq. 3.30.
    pub fn jacobian(
        &self,
        tree: &KinematicTree,
        world_from_link: &[Isometry3<f64>],
        tip_point: &Point3<f64>,
        out: &mut [Vector6<f64>],
    ) -> Result<(), KinematicsError> {
        expect_length("world_from_link", world_from_link.len(), tree.link_count())?;
        expect_length("out", out.len(), self.variables.len())?;
        out.fill(Vector6::zeros());
        let Some(world_from_tip) = world_from_link.get(self.tip) else {
            return expect_length("world_from_link", world_from_link.len(), self.tip + 1);
        };
        let point = world_from_tip * tip_point;
        for (link, column) in &self.steps {
            let (Some(pose), Some((motion, drive))) = (world_from_link.get(*link), axis_and_drive(tree, *link)) else {
                continue;
            };
            let (linear, angular) = match motion {
                LinkMotion::Sliding { axis, .. } => (pose * axis.into_inner(), Vector3::zeros()),
                LinkMotion::Turning { axis, .. } => {
                    let axis = pose * axis.into_inner();
                    (axis.cross(&(point.coords - pose.translation.vector)), axis)
                }
                LinkMotion::Fixed => continue,
            };
            let mut head = out[*column].fixed_rows_mut::<3>(0);
            head += linear * drive.multiplier;
            let mut tail = out[*column].fixed_rows_mut::<3>(3);
            tail += angular * drive.multiplier;
        }
        Ok(())
    }
}

fn axis_and_drive(tree: &KinematicTree, link: usize) -> Option<(&LinkMotion, Drive)> {
    let motion = tree.motion(link)?;
    match motion {
        LinkMotion::Fixed => None,
        LinkMotion::Turning { drive, .. } | LinkMotion::Sliding { drive, .. } => Some((motion, *drive)),
    }
}

#[cfg(test)]
mod tests {
    use super::super::urdf::RobotDescription;
    use super::*;
    use rand::{RngExt, SeedableRng};

    const MIXED: &str = include_str!("../../tests/data/generic_arm.urdf");

    #[test]
    fn equals_finite_differences() {
        let tree = KinematicTree::new(&RobotDescription::from_text(MIXED).unwrap()).unwrap();
        let chain = KinematicChain::new(&tree, "mount", "probe").unwrap();
        let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(3);
        let point = Point3::new(0.1, -0.2, 0.05);
        let root = Isometry3::new(Vector3::new(1.0, 2.0, 3.0), Vector3::new(0.3, -0.4, 0.5));
        let n = tree.variables().len();
        let mut poses = vec![Isometry3::identity(); tree.link_count()];
        let mut columns = vec![Vector6::zeros(); chain.variables().len()];
        let h = 1e-6;
        for _ in 0..50 {
            let q: Vec<f64> = (0..n).map(|_| rng.random_range(-1.0..1.0)).collect();
            tree.forward(&q, &root, &mut poses).unwrap();
            chain.jacobian(&tree, &poses, &point, &mut columns).unwrap();
            let mut tip_at = |variable: usize, step: f64| {
                let mut moved = q.clone();
                moved[variable] += step;
                tree.forward(&moved, &root, &mut poses).unwrap();
                poses[chain.tip()]
            };
            for (column, variable) in columns.iter().zip(chain.variables()) {
                let (plus, minus) = (tip_at(*variable, h), tip_at(*variable, -h));
                let linear = (plus * point - minus * point) / (2.0 * h);
                let angular = (plus.rotation * minus.rotation.inverse()).scaled_axis() / (2.0 * h);
                assert!((column.fixed_rows::<3>(0) - linear).norm() < 1e-8, "variable {variable}");
                assert!((column.fixed_rows::<3>(3) - angular).norm() < 1e-8, "variable {variable}");
            }
        }
    }

    #[test]
    fn a_chain_needs_an_ancestor() {
        let tree = KinematicTree::new(&RobotDescription::from_text(MIXED).unwrap()).unwrap();
        assert!(matches!(KinematicChain::new(&tree, "probe", "mount"), Err(KinematicsError::NotAbove { .. })));
        assert!(matches!(KinematicChain::new(&tree, "mount", "nothing"), Err(KinematicsError::UnknownLink { .. })));
        assert!(KinematicChain::new(&tree, "probe", "probe").unwrap().variables().is_empty());
    }
}
