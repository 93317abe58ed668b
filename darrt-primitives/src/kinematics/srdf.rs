//! The semantic description of a robot (SRDF): what its URDF cannot say about groups, postures, hands, its place in the world
//! and pairs of links that need no collision check.
//!
//! Names are resolved against the URDF that it belongs to. What is read and not understood is neither lost nor an error: it
//! stands in [`SemanticDescription::remarks`], with its line.

mod error;
mod read;

use std::path::Path;

use darrt_geom::bounded_file::read_text;

use super::guard;
use super::urdf::RobotDescription;
pub use error::SrdfError;

/// A checked semantic description; links and joints are indices into those of its [`RobotDescription`].
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SemanticDescription {
    /// The robot's name; the URDF's may differ, which is a remark.
    pub robot: String,
    /// Groups, in file order, names unique.
    pub groups: Vec<Group>,
    /// Named postures, in file order; names are unique within a group.
    pub states: Vec<GroupState>,
    /// Hands, in file order, names unique.
    pub end_effectors: Vec<EndEffector>,
    /// How the robot may move in the world, in file order; names are unique, also among the robot's joints.
    pub virtual_joints: Vec<VirtualJoint>,
    /// Joints without a motor.
    pub passive_joints: Vec<usize>,
    /// Pairs of links that need no collision check, in file order.
    pub disabled: Vec<DisabledPair>,
    /// Links that are checked against no other but those of [`enabled`](Self::enabled).
    pub disabled_by_default: Vec<usize>,
    /// Pairs that are checked all the same.
    pub enabled: Vec<(usize, usize)>,
    /// What was read and not understood, or names what is not there, in file order.
    pub remarks: Vec<Remark>,
}

/// A set of joints and links with a name.
#[derive(Debug, Clone, PartialEq)]
pub struct Group {
    /// Its name.
    pub name: String,
    /// The chains that it names itself, each from a link to one below it.
    pub chains: Vec<(usize, usize)>,
    /// Joints of the robot: those named, those above the links named, those of its chains and of its subgroups. In the order of
    /// the description, each once.
    pub joints: Vec<usize>,
    /// Virtual joints that it names, also through subgroups; each once.
    pub virtual_joints: Vec<usize>,
    /// Links: those named, those below the joints named, those of its chains and of its subgroups. In the order of the
    /// description, each once.
    pub links: Vec<usize>,
    /// The groups that it names, as indices.
    pub subgroups: Vec<usize>,
}

/// A joint that a posture names.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AnyJoint {
    /// One of the URDF.
    Robot(usize),
    /// One of the SRDF.
    Virtual(usize),
}

/// A named posture.
#[derive(Debug, Clone, PartialEq)]
pub struct GroupState {
    /// Its name.
    pub name: String,
    /// The group that it belongs to.
    pub group: usize,
    /// The joints that it says something of, with their values (rad, m): one for a joint of the robot, as many as
    /// [`VirtualKind::values`] for a virtual one.
    pub joints: Vec<(AnyJoint, Vec<f64>)>,
}

/// A hand.
#[derive(Debug, Clone, PartialEq)]
pub struct EndEffector {
    /// Its name.
    pub name: String,
    /// The link that it is fixed to.
    pub parent_link: usize,
    /// The group that it consists of.
    pub group: usize,
    /// The group of the arm that carries it, where the file says so.
    pub parent_group: Option<usize>,
}

/// How a virtual joint moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum VirtualKind {
    /// Not at all.
    Fixed,
    /// Over the plane: x, y, yaw.
    Planar,
    /// Freely: x, y, z and a quaternion.
    Floating,
}

impl VirtualKind {
    /// How many numbers say where it stands.
    pub fn values(self) -> usize {
        match self {
            Self::Fixed => 0,
            Self::Planar => 3,
            Self::Floating => 7,
        }
    }
}

/// A joint between the world and the robot.
#[derive(Debug, Clone, PartialEq)]
pub struct VirtualJoint {
    /// Its name.
    pub name: String,
    /// How it moves.
    pub kind: VirtualKind,
    /// The frame of the world that it starts from.
    pub parent_frame: String,
    /// The link that it moves.
    pub child_link: usize,
}

/// A pair of links that needs no collision check.
#[derive(Debug, Clone, PartialEq)]
pub struct DisabledPair {
    /// One link.
    pub first: usize,
    /// The other.
    pub second: usize,
    /// Why, as the file says (`Adjacent`, `Never`, ...); may be empty.
    pub reason: String,
}

/// Something in the file that has no effect here.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Remark {
    /// Line of the text, from 1.
    pub line: u32,
    /// What it is.
    pub text: String,
}

impl SemanticDescription {
    /// Reads and checks SRDF text against the robot that it describes.
    ///
    /// # Errors
    /// Every [`SrdfError`] but that of a file: each names the element and its line.
    pub fn from_text(text: &str, robot: &RobotDescription) -> Result<Self, SrdfError> {
        guard::check(text)?;
        read::read(text, robot)
    }

    /// Reads and checks an SRDF file.
    ///
    /// # Errors
    /// [`SrdfError::File`] when it is not a regular file, is larger than [`guard::MAX_BYTES`] or cannot be read as UTF-8 text;
    /// [`SrdfError::InFile`] with everything that [`from_text`](Self::from_text) reports.
    pub fn from_file(path: &Path, robot: &RobotDescription) -> Result<Self, SrdfError> {
        let text = read_text(path, guard::MAX_BYTES as u64).map_err(SrdfError::File)?;
        let within = |source| SrdfError::InFile { path: path.to_path_buf(), source: Box::new(source) };
        Self::from_text(&text, robot).map_err(within)
    }

    /// The group of this name.
    pub fn group(&self, name: &str) -> Option<&Group> {
        self.groups.iter().find(|group| group.name == name)
    }

    /// Need these two links no collision check?
    pub fn is_disabled(&self, a: usize, b: usize) -> bool {
        let is_pair = |first: usize, second: usize| (first, second) == (a, b) || (first, second) == (b, a);
        let by_default = self.disabled_by_default.iter().any(|link| *link == a || *link == b);
        let is_named = self.disabled.iter().any(|pair| is_pair(pair.first, pair.second));
        (is_named || by_default) && !self.enabled.iter().any(|(first, second)| is_pair(*first, *second))
    }
}

#[cfg(test)]
mod tests;
