//! Forward kinematics of a whole robot, without allocation.
//!
//! Links stand in topological order (a parent before its children), each with the joint above it; data of one kind
//! lies in one array. A configuration is one number per [`Variable`]: a joint that can move and mimics no other.

use std::collections::BTreeMap;
use std::sync::Arc;

use nalgebra::{Isometry3, Translation3, Unit, UnitQuaternion, Vector3};

use super::limit::JointLimit;
use super::urdf::{JointDescription, JointKind, RobotDescription, UrdfError};

/// Why a kinematic question has no answer.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum KinematicsError {
    /// A slice has the wrong length.
    #[error("{what} has length {got}; it must be {expected}")]
    Length {
        /// Which slice.
        what: &'static str,
        /// Its length.
        got: usize,
        /// What it must be.
        expected: usize,
    },
    /// No link has this name.
    #[error("no link is named {name:?}")]
    UnknownLink {
        /// The name.
        name: String,
    },
    /// A chain runs from a link to one of its descendants; these two are not such a pair.
    #[error("link {base:?} is not above link {tip:?}")]
    NotAbove {
        /// Start of the chain.
        base: String,
        /// End of the chain.
        tip: String,
    },
    /// Nothing moves between two links.
    #[error("no joint moves between link {base:?} and link {tip:?}")]
    NoJoint {
        /// Start of the chain.
        base: String,
        /// End of the chain.
        tip: String,
    },
    /// A chain has too many joints.
    #[error("{count} joints move between link {base:?} and link {tip:?}; at most {bound} are accepted")]
    TooManyJoints {
        /// Start of the chain.
        base: String,
        /// End of the chain.
        tip: String,
        /// How many.
        count: usize,
        /// The bound.
        bound: usize,
    },
}

/// The joint above a link, as a function of the variables.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LinkMotion {
    /// Fixed to the parent (or the root).
    Fixed,
    /// Turns about `axis` (link frame) by the drive's angle.
    Turning {
        /// Unit axis in the link frame.
        axis: Unit<Vector3<f64>>,
        /// Where the angle comes from.
        drive: Drive,
    },
    /// Slides along `axis` (link frame) by the drive's length.
    Sliding {
        /// Unit axis in the link frame.
        axis: Unit<Vector3<f64>>,
        /// Where the length comes from.
        drive: Drive,
    },
}

/// `value = multiplier * variable + offset`; `(1, 0)` unless the joint mimics another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drive {
    /// Index of the variable.
    pub variable: usize,
    /// Factor.
    pub multiplier: f64,
    /// Offset, rad or m.
    pub offset: f64,
}

/// One free joint.
#[derive(Debug, Clone)]
pub struct Variable {
    /// Name of the joint.
    pub name: Arc<str>,
    /// Index of the link the joint moves.
    pub link: usize,
    /// Hard limits, rad or m.
    pub limit: JointLimit,
    /// Soft limits, inside the hard ones.
    pub soft_limit: JointLimit,
    /// Largest speed, rad/s or m/s; zero when unknown.
    pub max_velocity: f64,
    /// Largest effort, N m or N; zero when unknown.
    pub max_effort: f64,
}

/// A tree of links.
///
/// # Laws
/// `parent(i) < i` for every link but the root (link 0). [`forward`](Self::forward) is a pure function.
#[derive(Debug, Clone)]
pub struct KinematicTree {
    names: Vec<Arc<str>>,
    parent: Vec<usize>,
    parent_from_link: Vec<Isometry3<f64>>,
    motion: Vec<LinkMotion>,
    source: Vec<usize>,
    variables: Vec<Variable>,
    link_by_name: BTreeMap<Arc<str>, usize>,
    variable_by_name: BTreeMap<Arc<str>, usize>,
}

impl KinematicTree {
    /// Orders the links of a description, depth first, children in file order.
    ///
    /// # Errors
    /// [`UrdfError::Cycle`] or [`UrdfError::MimicCycle`] for a description that was altered after reading so that it
    /// is no longer a tree; a description as read is never refused.
    pub fn new(robot: &RobotDescription) -> Result<Self, UrdfError> {
        let order = depth_first(robot)?;
        let mut place = vec![0; robot.links.len()];
        let mut variable_of_joint = vec![None; robot.joints.len()];
        let mut variables = Vec::new();
        for (at, (link, joint)) in order.iter().enumerate() {
            place[*link] = at;
            let Some(joint) = *joint else { continue };
            let j = &robot.joints[joint];
            if j.kind != JointKind::Fixed && j.mimic.is_none() {
                variable_of_joint[joint] = Some(variables.len());
                variables.push(variable(j, at));
            }
        }
        let mut tree = Self {
            names: order.iter().map(|(link, _)| robot.links[*link].name.clone()).collect(),
            parent: Vec::with_capacity(order.len()),
            parent_from_link: Vec::with_capacity(order.len()),
            motion: Vec::with_capacity(order.len()),
            source: order.iter().map(|(link, _)| *link).collect(),
            link_by_name: BTreeMap::new(),
            variable_by_name: variables.iter().enumerate().map(|(i, v)| (v.name.clone(), i)).collect(),
            variables,
        };
        tree.link_by_name = tree.names.iter().enumerate().map(|(i, n)| (n.clone(), i)).collect();
        for (_, joint) in &order {
            let Some(joint) = *joint else {
                tree.push(0, Isometry3::identity(), LinkMotion::Fixed);
                continue;
            };
            let j = &robot.joints[joint];
            let motion = motion(robot, joint, &variable_of_joint)?;
            tree.push(place[j.parent], j.parent_from_child, motion);
        }
        Ok(tree)
    }

    fn push(&mut self, parent: usize, parent_from_link: Isometry3<f64>, motion: LinkMotion) {
        self.parent.push(parent);
        self.parent_from_link.push(parent_from_link);
        self.motion.push(motion);
    }

    /// Number of links.
    pub fn link_count(&self) -> usize {
        self.names.len()
    }

    /// Names of the links, root first.
    pub fn link_names(&self) -> &[Arc<str>] {
        &self.names
    }

    /// Index of the link named `name`.
    pub fn link_index(&self, name: &str) -> Option<usize> {
        self.link_by_name.get(name).copied()
    }

    /// The link above `link`; `None` for the root and for an index that does not exist.
    pub fn parent(&self, link: usize) -> Option<usize> {
        if link == 0 { None } else { self.parent.get(link).copied() }
    }

    /// Pose of `link` in its parent at joint value zero; `None` for an index that does not exist.
    pub fn parent_from_link(&self, link: usize) -> Option<&Isometry3<f64>> {
        self.parent_from_link.get(link)
    }

    /// The joint above `link`; `None` for an index that does not exist.
    pub fn motion(&self, link: usize) -> Option<&LinkMotion> {
        self.motion.get(link)
    }

    /// Index of `link` in the description's list of links; `None` for an index that does not exist.
    pub fn source_link(&self, link: usize) -> Option<usize> {
        self.source.get(link).copied()
    }

    /// The free joints: a configuration has one number for each, in this order.
    pub fn variables(&self) -> &[Variable] {
        &self.variables
    }

    /// Index of the free joint named `name`.
    pub fn variable_index(&self, name: &str) -> Option<usize> {
        self.variable_by_name.get(name).copied()
    }

    /// Zero, moved into the soft limits, for every variable.
    pub fn neutral(&self) -> Vec<f64> {
        self.variables.iter().map(|v| v.soft_limit.clamp(0.0)).collect()
    }

    /// Writes the world pose of every link.
    ///
    /// `joint_values`: one per variable (rad or m). `world_from_root`: pose of the root. `out`: one pose per link,
    /// overwritten. Does not allocate.
    ///
    /// # Errors
    /// [`KinematicsError::Length`] when a slice has the wrong length; nothing is written then.
    pub fn forward(
        &self,
        joint_values: &[f64],
        world_from_root: &Isometry3<f64>,
        out: &mut [Isometry3<f64>],
    ) -> Result<(), KinematicsError> {
        expect_length("joint_values", joint_values.len(), self.variables.len())?;
        expect_length("out", out.len(), self.names.len())?;
        let mut links = self.parent.iter().zip(&self.parent_from_link).zip(&self.motion).enumerate();
        // The root has no joint above it.
        links.next();
        if let Some(first) = out.first_mut() {
            *first = *world_from_root;
        }
        for (link, ((parent, parent_from_link), motion)) in links {
            out[link] = out[*parent] * parent_from_link * moved(motion, joint_values);
        }
        Ok(())
    }

    /// Writes the world poses of `links` only, for when all others stand as `out` has them from [`KinematicTree::forward`].
    ///
    /// `links`: in ascending order; with a link all links below it. What is no link and the root are passed over.
    ///
    /// # Errors
    /// As [`KinematicTree::forward`].
    ///
    /// # Laws
    /// If only variables have changed that drive joints above `links`, `out` is what `forward` writes, bit for bit.
    pub fn forward_only(
        &self,
        joint_values: &[f64],
        links: &[usize],
        out: &mut [Isometry3<f64>],
    ) -> Result<(), KinematicsError> {
        expect_length("joint_values", joint_values.len(), self.variables.len())?;
        expect_length("out", out.len(), self.names.len())?;
        for &link in links.iter().filter(|link| **link > 0) {
            let (Some(parent), Some(parent_from_link), Some(motion)) =
                (self.parent.get(link), self.parent_from_link.get(link), self.motion.get(link))
            else {
                continue;
            };
            out[link] = out[*parent] * parent_from_link * moved(motion, joint_values);
        }
        Ok(())
    }
}

/// # Errors
/// [`KinematicsError::Length`] when they differ.
pub(super) fn expect_length(what: &'static str, got: usize, expected: usize) -> Result<(), KinematicsError> {
    if got == expected { Ok(()) } else { Err(KinematicsError::Length { what, got, expected }) }
}

fn moved(motion: &LinkMotion, joint_values: &[f64]) -> Isometry3<f64> {
    match motion {
        LinkMotion::Fixed => Isometry3::identity(),
        LinkMotion::Turning { axis, drive } => Isometry3::from_parts(
            Translation3::identity(),
            UnitQuaternion::from_axis_angle(axis, drive.value(joint_values)),
        ),
        LinkMotion::Sliding { axis, drive } => Isometry3::from_parts(
            Translation3::from(axis.into_inner() * drive.value(joint_values)),
            UnitQuaternion::identity(),
        ),
    }
}

impl Drive {
    /// The joint's value; `joint_values` must have an entry for the variable.
    fn value(&self, joint_values: &[f64]) -> f64 {
        self.multiplier * joint_values[self.variable] + self.offset
    }
}

/// Links with the joint above each, parents before children.
fn depth_first(robot: &RobotDescription) -> Result<Vec<(usize, Option<usize>)>, UrdfError> {
    let cycle =
        |link: usize| UrdfError::Cycle { link: robot.links.get(link).map_or_else(String::new, |l| l.name.to_string()) };
    let mut below: Vec<Vec<usize>> = vec![Vec::new(); robot.links.len()];
    for (i, joint) in robot.joints.iter().enumerate() {
        below.get_mut(joint.parent).ok_or_else(|| cycle(joint.parent))?.push(i);
    }
    let mut order = Vec::with_capacity(robot.links.len());
    let mut stack = vec![(robot.root, None)];
    while let Some((link, joint)) = stack.pop() {
        if order.len() == robot.links.len() {
            return Err(cycle(link));
        }
        order.push((link, joint));
        let children = below.get(link).ok_or_else(|| cycle(link))?;
        stack.extend(children.iter().rev().map(|&j| (robot.joints[j].child, Some(j))));
    }
    if order.len() == robot.links.len() { Ok(order) } else { Err(cycle(robot.root)) }
}

fn variable(joint: &JointDescription, link: usize) -> Variable {
    Variable {
        name: joint.name.clone(),
        link,
        limit: joint.limit,
        soft_limit: joint.soft_limit,
        max_velocity: joint.max_velocity,
        max_effort: joint.max_effort,
    }
}

/// The motion of a joint, mimic chains followed to their variable.
fn motion(
    robot: &RobotDescription,
    joint: usize,
    variable_of_joint: &[Option<usize>],
) -> Result<LinkMotion, UrdfError> {
    let this = &robot.joints[joint];
    if this.kind == JointKind::Fixed {
        return Ok(LinkMotion::Fixed);
    }
    let circle = || UrdfError::MimicCycle { joint: this.name.to_string() };
    let (mut at, mut multiplier, mut offset) = (joint, 1.0, 0.0);
    for _ in 0..=robot.joints.len() {
        if let Some(variable) = variable_of_joint.get(at).copied().flatten() {
            let axis = this.axis;
            let drive = Drive { variable, multiplier, offset };
            return Ok(match this.kind {
                JointKind::Sliding => LinkMotion::Sliding { axis, drive },
                _ => LinkMotion::Turning { axis, drive },
            });
        }
        let mimic = robot.joints.get(at).and_then(|j| j.mimic).ok_or_else(circle)?;
        offset += multiplier * mimic.offset;
        multiplier *= mimic.multiplier;
        at = mimic.joint;
    }
    Err(circle())
}

#[cfg(test)]
mod tests;
