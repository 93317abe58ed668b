//! What the semantic description (SRDF) beside a robot's description says, by name.

use std::path::{Path, PathBuf};

use darrt_primitives::kinematics::{RobotDescription, SemanticDescription};

use crate::robot_file::error::Fault;
use crate::robot_file::{RobotFileError, Source};

/// Folders from that of the description in which SRDF files lie as they are mostly laid out.
const FOLDERS: [&str; 5] = [".", "../srdf", "srdf", "../config", "config"];
/// Files of one folder that are looked at.
const MOST_FILES: usize = 32;

/// A pair of links that the SRDF disables.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Disabled {
    /// Their names.
    pub(super) links: [String; 2],
    /// Why, as the file says; empty where it says nothing.
    pub(super) reason: String,
}

/// An SRDF that is read with the robot.
#[derive(Debug, Clone)]
pub(super) struct Semantic {
    /// Its file.
    pub(super) path: PathBuf,
    pub(super) description: SemanticDescription,
    /// Pairs of links with shapes.
    pub(super) disabled: Vec<Disabled>,
}

impl Semantic {
    /// The SRDF that a robot file names.
    ///
    /// # Errors
    /// [`RobotFileError`] at the key `srdf`.
    pub(super) fn of(source: &Source, robot: &RobotDescription) -> Result<Option<Self>, RobotFileError> {
        let Some(srdf) = &source.file.srdf else { return Ok(None) };
        let refuse = |why: String| source.located(Fault::new("srdf", why));
        Self::read(&source.path(srdf), robot).map(Some).map_err(refuse)
    }

    /// Reads a file; the error goes on after the key.
    fn read(path: &Path, robot: &RobotDescription) -> Result<Self, String> {
        let description =
            SemanticDescription::from_file(path, robot).map_err(|error| format!("cannot be used: {error}"))?;
        let disabled = disabled(&description, robot);
        Ok(Self { path: path.to_path_buf(), description, disabled })
    }

    /// The SRDF that lies beside a description and is of its robot, first one that is called as the description or as the robot; and
    /// those that cannot be read, each with the reason.
    pub(super) fn beside(urdf: &Path, robot: &RobotDescription) -> (Option<Self>, Vec<(PathBuf, String)>) {
        let mut unread = Vec::new();
        (Self::search(urdf, robot, &mut unread), unread)
    }

    fn search(urdf: &Path, robot: &RobotDescription, unread: &mut Vec<(PathBuf, String)>) -> Option<Self> {
        let folder = urdf.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let stem = |path: &Path| path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
        let names = [stem(urdf), robot.name.clone()];
        FOLDERS.iter().find_map(|inside| {
            let entries = std::fs::read_dir(folder.join(inside)).ok()?;
            let mut paths: Vec<_> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
            paths.retain(|path| path.extension().is_some_and(|extension| extension == "srdf"));
            // Called as the description, then by name, so that the order of the folder does not count.
            let order = |path: &PathBuf| {
                let called = names.iter().position(|name| *name == stem(path)).unwrap_or(names.len());
                (called, path.clone())
            };
            paths.sort_by_cached_key(order);
            let is_of_it = |found: &Self| found.description.robot == robot.name || stem(&found.path) == stem(urdf);
            paths.into_iter().take(MOST_FILES).find_map(|path| match Self::read(&path, robot) {
                Ok(found) => is_of_it(&found).then_some(found),
                Err(why) => {
                    unread.push((path, why));
                    None
                }
            })
        })
    }

    /// The named states that say something of all these joints, with the values in their order (rad, m).
    pub(super) fn states<'a>(
        &'a self,
        robot: &'a RobotDescription,
        joints: &'a [String],
    ) -> impl Iterator<Item = (&'a str, Vec<f64>)> {
        self.description.states.iter().filter_map(move |state| {
            let value = |name: &String| {
                state.joints.iter().find_map(|(joint, values)| match joint {
                    darrt_primitives::kinematics::srdf::AnyJoint::Robot(index) => {
                        let is_it = robot.joints.get(*index).is_some_and(|joint| *joint.name == **name);
                        is_it.then(|| values.first().copied()).flatten()
                    }
                    darrt_primitives::kinematics::srdf::AnyJoint::Virtual(_) => None,
                })
            };
            let values: Option<Vec<f64>> = joints.iter().map(value).collect();
            Some((state.name.as_str(), values?))
        })
    }
}

/// The pairs of links with shapes that need no check.
fn disabled(description: &SemanticDescription, robot: &RobotDescription) -> Vec<Disabled> {
    let shaped: Vec<usize> =
        robot.links.iter().enumerate().filter(|(_, link)| !link.collision.is_empty()).map(|(index, _)| index).collect();
    let name = |link: usize| robot.links.get(link).map_or_else(String::new, |link| link.name.to_string());
    let pairs = shaped.iter().enumerate().flat_map(|(at, a)| shaped.iter().skip(at + 1).map(move |b| (*a, *b)));
    let disabled = pairs.filter(|(a, b)| description.is_disabled(*a, *b)).map(|(a, b)| {
        let is_it = |first: usize, second: usize| (first, second) == (a, b) || (first, second) == (b, a);
        let named = description.disabled.iter().find(|pair| is_it(pair.first, pair.second));
        Disabled { links: [name(a), name(b)], reason: named.map(|pair| pair.reason.clone()).unwrap_or_default() }
    });
    disabled.collect()
}
