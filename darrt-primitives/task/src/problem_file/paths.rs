//! The files that a problem names, meshes and a robot description: where their relative paths start.
//!
//! In a file they start at the folder of that file, whether it is a problem or a plan; in memory, where there is no such
//! folder, at the working folder. Reading and writing turn one into the other.

use std::path::{Component, Path, PathBuf};

use darrt_primitives::kinematics::RobotDescription;

use super::error::Flaw;
use super::{ProblemFile, ProblemFileError, ShapeSpec};
use crate::robot_file::Source;

impl ProblemFile {
    /// Makes relative paths that start at `folder` start at the working folder.
    pub(crate) fn resolve_paths(&mut self, folder: &Path) {
        for file in self.files_mut() {
            *file = folder.join(&*file);
        }
    }

    /// Makes paths that start at the working folder start at `folder`; what shares no folder with it becomes absolute.
    pub(crate) fn make_paths_start_at(&mut self, folder: &Path) {
        for file in self.files_mut() {
            *file = seen_from(folder, file);
        }
    }

    /// Whether the problem is complete only together with other files.
    pub(crate) fn names_files(&self) -> bool {
        self.robot.urdf.is_some()
            || self.robot.file.is_some()
            || self.shapes().any(|(_, _, shape)| matches!(shape, ShapeSpec::Mesh { .. }))
    }

    /// Reads every file that the problem names, and forgets it again: what cannot be read can then be told from what is
    /// wrong with the problem.
    ///
    /// # Errors
    /// [`ProblemFileError::Invalid`] with the key, the file and the reason.
    pub fn check_files(&self) -> Result<(), ProblemFileError> {
        for (list, index, shape) in self.shapes() {
            if matches!(shape, ShapeSpec::Mesh { .. }) {
                let read = shape.body("mesh");
                read.map_err(|error| self.located(Flaw::from(error).at(format!("{list}[{index}]"))))?;
            }
        }
        if let Some(path) = &self.robot.urdf {
            let flaw = |error| Flaw::Inconsistent(format!("cannot be used: {error}")).at("robot.urdf");
            RobotDescription::from_file(path).map_err(|error| self.located(flaw(error)))?;
        }
        if let Some(path) = &self.robot.file {
            let flaw = |error| Flaw::Inconsistent(format!("cannot be used: {error}")).at("robot.file");
            let source = Source::read(path).map_err(|error| self.located(flaw(error.to_string())))?;
            RobotDescription::from_file(&source.urdf()).map_err(|error| self.located(flaw(error.to_string())))?;
        }
        Ok(())
    }

    /// The shapes of obstacles and objects, each with the key of its list and its index there.
    fn shapes(&self) -> impl Iterator<Item = (&'static str, usize, &ShapeSpec)> {
        let obstacles = self.obstacles.iter().enumerate().map(|(index, o)| ("obstacle", index, &o.shape));
        obstacles.chain(self.objects.iter().enumerate().map(|(index, o)| ("object", index, &o.shape)))
    }

    fn files_mut(&mut self) -> impl Iterator<Item = &mut PathBuf> {
        self.obstacles
            .iter_mut()
            .map(|obstacle| &mut obstacle.shape)
            .chain(self.objects.iter_mut().map(|object| &mut object.shape))
            .filter_map(|shape| match shape {
                ShapeSpec::Mesh { file, .. } => Some(file),
                _ => None,
            })
            .chain(self.robot.urdf.as_mut())
            .chain(self.robot.file.as_mut())
    }
}

/// The folder in which a file lies; `.` for a bare name.
pub(crate) fn folder_of(file: &Path) -> &Path {
    file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// The path from `folder` to `file`, both given from the working folder; absolute when there is no such path that would
/// survive being moved, and unchanged when the folder is not there.
fn seen_from(folder: &Path, file: &Path) -> PathBuf {
    // Links of folders are followed, because `..` leaves a folder by where it really is; the file itself may be one.
    let place = folder_of(file).canonicalize().ok().zip(file.file_name()).map(|(folder, name)| folder.join(name));
    let (Ok(folder), Some(place)) = (folder.canonicalize(), place) else {
        return std::path::absolute(file).unwrap_or_else(|_| file.to_path_buf());
    };
    let is_named = |component: &Component<'_>| matches!(component, Component::Normal(_));
    let shared = folder.components().zip(place.components()).take_while(|(a, b)| a == b).count();
    if !folder.components().take(shared).any(|component| is_named(&component)) {
        return place;
    }
    let up = folder.components().skip(shared).map(|_| Component::ParentDir);
    up.chain(place.components().skip(shared)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_lead_from_one_folder_to_another() {
        let top = tempfile::tempdir().unwrap();
        let path = |name: &str| top.path().join(name);
        std::fs::create_dir_all(path("a/b")).unwrap();
        std::fs::create_dir_all(path("meshes")).unwrap();
        assert_eq!(seen_from(&path("a/b"), &path("a/b/x.stl")), Path::new("x.stl"));
        assert_eq!(seen_from(&path("a"), &path("a/b/x.stl")), Path::new("b/x.stl"));
        assert_eq!(seen_from(&path("a/b"), &path("a/b/../../meshes/x.stl")), Path::new("../../meshes/x.stl"));
        assert_eq!(
            seen_from(Path::new("/"), &path("meshes/x.stl")),
            path("meshes").canonicalize().unwrap().join("x.stl")
        );
        assert!(seen_from(&path("missing"), Path::new("x.stl")).is_absolute());
        assert_eq!((folder_of(Path::new("a")), folder_of(Path::new("b/a"))), (Path::new("."), Path::new("b")));
    }
}
