//! Which joints a waypoint lists: every movable joint of the robot description, mimic joints included.
//!
//! A reader without our code then needs no knowledge of mimic joints; the price is that their values are redundant,
//! which the verifier checks.

use std::collections::BTreeMap;
use std::sync::Arc;

use darrt_primitives::kinematics::RobotDescription;
use darrt_primitives::kinematics::tree::KinematicTree;
use darrt_primitives::kinematics::urdf::JointKind;

/// The movable joints of a robot by name, and how those that follow another are computed.
#[derive(Debug, Clone)]
pub struct JointTable {
    entries: BTreeMap<Arc<str>, Entry>,
    /// The same names, every value 0.
    zeros: BTreeMap<Arc<str>, f64>,
    free: usize,
}

/// `value = multiplier * variable + offset`.
#[derive(Debug, Clone, Copy)]
struct Entry {
    variable: usize,
    multiplier: f64,
    offset: f64,
    /// The joint is the variable itself, not one that follows it.
    is_free: bool,
}

impl JointTable {
    /// The joints of `robot`, whose tree is `tree`.
    pub fn new(robot: &RobotDescription, tree: &KinematicTree) -> Self {
        let movable = (0..).zip(&robot.joints).filter(|(_, joint)| joint.kind != JointKind::Fixed);
        let entries = movable.filter_map(|(index, joint)| Some((joint.name.clone(), entry(robot, tree, index)?)));
        let entries: BTreeMap<_, _> = entries.collect();
        let zeros = entries.keys().map(|name| (Arc::clone(name), 0.0)).collect();
        Self { entries, zeros, free: tree.variables().len() }
    }

    /// Every movable joint with its value, for the values of the tree's variables (rad or m, in the tree's order).
    /// A missing variable counts as zero.
    pub fn complete(&self, variables: &[f64]) -> BTreeMap<Arc<str>, f64> {
        // OPTIMIZATION: a map that is copied need not be sorted.
        let mut joints = self.zeros.clone();
        for (value, entry) in joints.values_mut().zip(self.entries.values()) {
            *value = entry.value(variables.get(entry.variable).copied().unwrap_or(0.0));
        }
        joints
    }

    /// The values of the tree's variables from a list of all joints.
    ///
    /// # Errors
    /// [`JointFlaw`] for a joint that is missing, unknown, not finite, or does not follow its driver to 1e-9.
    pub fn variables(&self, joints: &BTreeMap<Arc<str>, f64>) -> Result<Vec<f64>, JointFlaw> {
        let mut variables = vec![0.0; self.free];
        // Both are in the order of their names, so that what is unknown or missing shows where they part.
        let mut listed = joints.iter().peekable();
        for (name, entry) in &self.entries {
            // OPTIMIZATION: mostly the names are those of the same description, and need not be read.
            let (found, value) = match listed.next_if(|(found, _)| Arc::ptr_eq(found, name) || *found <= name) {
                Some((found, value)) => (found, *value),
                None => return Err(JointFlaw::Missing { name: name.to_string() }),
            };
            if !Arc::ptr_eq(found, name) && found != name {
                return Err(JointFlaw::Unknown { name: found.to_string() });
            }
            if !value.is_finite() {
                return Err(JointFlaw::NotFinite { name: name.to_string(), value });
            }
            if entry.is_free
                && let Some(slot) = variables.get_mut(entry.variable)
            {
                *slot = value;
            }
        }
        if let Some((name, _)) = listed.next() {
            return Err(JointFlaw::Unknown { name: name.to_string() });
        }
        for ((name, entry), found) in self.entries.iter().zip(joints.values()).filter(|((_, entry), _)| !entry.is_free)
        {
            let expected = entry.value(variables.get(entry.variable).copied().unwrap_or(0.0));
            let off = (found - expected).abs();
            if off.is_nan() || off > 1e-9 {
                return Err(JointFlaw::NotFollowing { name: name.to_string(), found: *found, expected });
            }
        }
        Ok(variables)
    }
}

impl Entry {
    fn value(&self, variable: f64) -> f64 {
        self.multiplier * variable + self.offset
    }
}

/// Follows the joint with this index to its variable; `None` for a description that is not the tree's.
fn entry(robot: &RobotDescription, tree: &KinematicTree, joint: usize) -> Option<Entry> {
    let (mut at, mut multiplier, mut offset) = (robot.joints.get(joint)?, 1.0, 0.0);
    for _ in 0..=robot.joints.len() {
        let Some(mimic) = at.mimic else {
            let variable = tree.variable_index(&at.name)?;
            let is_free = at.name == robot.joints.get(joint)?.name;
            return Some(Entry { variable, multiplier, offset, is_free });
        };
        offset += multiplier * mimic.offset;
        multiplier *= mimic.multiplier;
        at = robot.joints.get(mimic.joint)?;
    }
    None
}

/// A list of joints that does not fit the robot.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum JointFlaw {
    /// The robot has no such movable joint.
    #[error("there is no movable joint `{name}`")]
    Unknown {
        /// The name.
        name: String,
    },
    /// A joint is not listed.
    #[error("the joint `{name}` is missing")]
    Missing {
        /// The name.
        name: String,
    },
    /// A joint's value is no number.
    #[error("the joint `{name}` is {value}, it must be a finite number")]
    NotFinite {
        /// The name.
        name: String,
        /// The value.
        value: f64,
    },
    /// A mimic joint is not where its driver puts it.
    #[error("the joint `{name}` is {found}, but the joint that it mimics puts it at {expected}")]
    NotFollowing {
        /// The name.
        name: String,
        /// The value found.
        found: f64,
        /// The value that follows from the driver.
        expected: f64,
    },
}

#[cfg(test)]
mod tests {
    use super::*;
    use darrt_pr2::model::URDF;

    fn table() -> (JointTable, KinematicTree) {
        let robot = RobotDescription::from_text(URDF).unwrap();
        let tree = KinematicTree::new(&robot).unwrap();
        (JointTable::new(&robot, &tree), tree)
    }

    #[test]
    fn every_movable_joint_is_listed_and_read_back() {
        let (table, tree) = table();
        let variables: Vec<f64> = (1_u8..).map(f64::from).take(tree.variables().len()).collect();
        let joints = table.complete(&variables);
        // Torso, head pan and tilt, scanner, two arms of seven, two grippers of four.
        assert_eq!(joints.len(), 4 + 14 + 8);
        assert_eq!(joints["r_gripper_l_finger_joint"], joints["r_gripper_r_finger_tip_joint"]);
        assert_eq!(table.variables(&joints).unwrap(), variables);
    }

    type Joints = BTreeMap<Arc<str>, f64>;

    #[test]
    fn wrong_lists_are_refused_by_name() {
        let (table, tree) = table();
        let good = table.complete(&tree.neutral());
        let message = |edit: &dyn Fn(&mut Joints)| {
            let mut joints = good.clone();
            edit(&mut joints);
            table.variables(&joints).unwrap_err().to_string()
        };
        let missing = message(&|joints| {
            joints.remove("torso_lift_joint");
        });
        assert!(missing.contains("`torso_lift_joint` is missing"), "{missing}");
        let unknown = message(&|joints| {
            joints.insert("tail_joint".into(), 0.0);
        });
        assert!(unknown.contains("no movable joint `tail_joint`"), "{unknown}");
        let nan = message(&|joints| {
            joints.insert("l_elbow_flex_joint".into(), f64::NAN);
        });
        assert!(nan.contains("NaN"), "{nan}");
        let apart = message(&|joints| {
            joints.insert("l_gripper_r_finger_joint".into(), 0.1);
        });
        assert!(apart.contains("`l_gripper_r_finger_joint` is 0.1") && apart.contains("at 0"), "{apart}");
    }
}
