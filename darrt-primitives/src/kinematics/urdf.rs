//! A robot description read from URDF text and checked: the only way to obtain a [`RobotDescription`] from outside.
//!
//! Reading happens in steps: [`guard`] refuses texts no reader should see, what planning does not use is blanked out and what it
//! needs is asked for, `urdf-rs` parses, and
//! this module checks everything `urdf-rs` lets through (not-a-number, doubled names, loops, zero axes ...). What
//! comes out is a tree with one root, finite numbers and names that resolve.

mod check;
mod error;
mod needed;
mod vocabulary;

use std::path::Path;
use std::sync::Arc;

use darrt_geom::bounded_file::read_text;
use nalgebra::{Isometry3, Unit, Vector3};

use super::guard;
use super::limit::JointLimit;
pub use error::UrdfError;

/// A checked robot description: a tree of links.
///
/// # Laws
/// One root; every other link is the child of exactly one joint; every number is finite (limits may be infinite).
#[derive(Debug, Clone)]
pub struct RobotDescription {
    /// The robot's name; may be empty.
    pub name: String,
    /// All links, in file order, names unique.
    pub links: Vec<LinkDescription>,
    /// All joints, in file order, names unique.
    pub joints: Vec<JointDescription>,
    /// Index of the root in `links`.
    pub root: usize,
}

/// One link and its collision geometry.
#[derive(Debug, Clone)]
pub struct LinkDescription {
    /// Unique name.
    pub name: Arc<str>,
    /// Collision geometry, in file order.
    pub collision: Vec<PlacedGeometry>,
    /// Does it have a visual, which planning does not look at?
    pub has_visual: bool,
}

/// A piece of geometry at its place in the link frame.
#[derive(Debug, Clone)]
pub struct PlacedGeometry {
    /// Pose of the geometry in the link frame, m.
    pub link_from_geometry: Isometry3<f64>,
    /// What it is.
    pub geometry: Geometry,
}

/// Collision geometry of a URDF; lengths in m, all positive.
#[derive(Debug, Clone, PartialEq)]
pub enum Geometry {
    /// A box by its full edge lengths.
    Cuboid {
        /// Full edge lengths.
        size: Vector3<f64>,
    },
    /// A ball.
    Sphere {
        /// Radius.
        radius: f64,
    },
    /// A cylinder along z.
    Cylinder {
        /// Radius.
        radius: f64,
        /// Full length.
        length: f64,
    },
    /// A capsule along z.
    Capsule {
        /// Radius.
        radius: f64,
        /// Length of the inner segment.
        length: f64,
    },
    /// A mesh in a file.
    Mesh {
        /// The name as written, often `package://...`.
        filename: String,
        /// Scale per axis, never zero.
        scale: Vector3<f64>,
    },
}

/// How a joint moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JointKind {
    /// Not at all.
    Fixed,
    /// Turns about its axis.
    Turning,
    /// Slides along its axis.
    Sliding,
}

/// One joint.
#[derive(Debug, Clone)]
pub struct JointDescription {
    /// Unique name.
    pub name: Arc<str>,
    /// How it moves; a continuous joint is a turning one without limits.
    pub kind: JointKind,
    /// Index of the parent link.
    pub parent: usize,
    /// Index of the child link.
    pub child: usize,
    /// Pose of the child link in the parent link at joint value zero.
    pub parent_from_child: Isometry3<f64>,
    /// Axis in the child frame (and at value zero in the parent's joint frame).
    pub axis: Unit<Vector3<f64>>,
    /// Hard limits, rad or m.
    pub limit: JointLimit,
    /// Limits of the `<safety_controller>`, inside the hard ones; the hard ones when there is none.
    pub soft_limit: JointLimit,
    /// Largest speed, rad/s or m/s; zero when the file does not say.
    pub max_velocity: f64,
    /// Largest effort, N m or N; zero when the file does not say.
    pub max_effort: f64,
    /// When set, the joint follows another.
    pub mimic: Option<Mimic>,
}

/// `value = multiplier * value of the other joint + offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mimic {
    /// Index of the joint that is followed; movable, and never in a loop.
    pub joint: usize,
    /// Factor.
    pub multiplier: f64,
    /// Offset, rad or m.
    pub offset: f64,
}

impl RobotDescription {
    /// Reads and checks URDF text.
    ///
    /// # Errors
    /// Every [`UrdfError`] but those of files: each names the element, the value found and the bound it broke.
    pub fn from_text(text: &str) -> Result<Self, UrdfError> {
        guard::check(text)?;
        let text = &*needed::with_namespaces(text);
        vocabulary::check(text)?;
        let needed = needed::only(text)?;
        let parsed =
            urdf_rs::read_from_string(&needed.text).map_err(|e| UrdfError::Syntax { message: e.to_string() })?;
        check::checked(&parsed, &needed.seen)
    }

    /// Checks that every link with a visual has a collision shape too, but for those in `shapeless`: planning would drive
    /// through it.
    ///
    /// # Errors
    /// [`UrdfError::VisualOnly`] with the first such link; [`UrdfError::NoSuchLink`] for a name in `shapeless` that no link has.
    pub fn check_shapes(&self, shapeless: &[String]) -> Result<(), UrdfError> {
        let is_there = |name: &&String| self.links.iter().any(|link| *link.name == **name);
        if let Some(name) = shapeless.iter().find(|name| !is_there(name)) {
            return Err(UrdfError::NoSuchLink { name: name.clone() });
        }
        let is_bare = |link: &&LinkDescription| link.has_visual && link.collision.is_empty();
        match self.links.iter().filter(is_bare).find(|link| !shapeless.iter().any(|name| **name == *link.name)) {
            Some(link) => Err(UrdfError::VisualOnly { link: link.name.to_string() }),
            None => Ok(()),
        }
    }

    /// Reads and checks a URDF file.
    ///
    /// # Errors
    /// [`UrdfError::File`] when the file is not a regular one, is larger than [`guard::MAX_BYTES`] or cannot be read as
    /// UTF-8 text; [`UrdfError::InFile`] with everything that [`from_text`](Self::from_text) reports.
    pub fn from_file(path: &Path) -> Result<Self, UrdfError> {
        let text = read_text(path, guard::MAX_BYTES as u64).map_err(UrdfError::File)?;
        let within = |source| UrdfError::InFile { path: path.to_path_buf(), source: Box::new(source) };
        Self::from_text(&text).map_err(within)
    }
}

#[cfg(test)]
mod tests;
