//! Where the meshes of a robot description lie: `package://name/rest` and relative paths.
//!
//! No program is asked. Variables of the environment are read by [`MeshPlaces::around`] and nowhere else.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use darrt_geom::bounded_file::read_text;
use roxmltree::Document;

use super::guard;

/// Largest `package.xml` read, bytes.
const LARGEST_MANIFEST: u64 = 1 << 20;

/// Packages and folders in which meshes are looked for.
///
/// `package://name/rest` is `rest` in the package of that name: first one that was [named](Self::add_package), then one in or at
/// a folder of the [package path](Self::add_package_path), then one in or at a folder above the description. A folder is the
/// package `name` if it is called so or its `package.xml` says so. `model://` means the same; `file://` and absolute paths are
/// taken as they are; a relative path is looked up from the folder of the description upwards.
#[derive(Debug, Clone, Default)]
pub struct MeshPlaces {
    packages: Vec<(String, PathBuf)>,
    folders: Vec<Folder>,
    above: Vec<Folder>,
}

/// A folder and the name that its `package.xml` gives it.
#[derive(Debug, Clone)]
struct Folder {
    path: PathBuf,
    package: Option<String>,
}

impl Folder {
    fn new(path: PathBuf) -> Self {
        let package = manifest_name(&path.join("package.xml"));
        Self { path, package }
    }

    /// `rest` in the package `name`, which is this folder or lies in it.
    fn find(&self, name: &str, rest: &str) -> Option<PathBuf> {
        let is_it = self.package.as_deref() == Some(name) || self.path.file_name().is_some_and(|last| last == name);
        let here = is_it.then(|| self.path.join(rest)).filter(|path| path.is_file());
        here.or_else(|| Some(self.path.join(name).join(rest)).filter(|path| path.is_file()))
    }
}

impl MeshPlaces {
    /// The folder of a description and those above it. Reads the `package.xml` of each that has one.
    pub fn of(description: &Path) -> Self {
        let absolute = std::path::absolute(description).unwrap_or_else(|_| description.to_path_buf());
        let above = absolute.ancestors().skip(1).map(Path::to_path_buf);
        Self { above: above.map(Folder::new).collect(), ..Self::default() }
    }

    /// As [`MeshPlaces::of`], and the packages that the environment knows: `ROS_PACKAGE_PATH`, and `share` in each folder of
    /// `AMENT_PREFIX_PATH`.
    pub fn around(description: &Path) -> Self {
        let mut places = Self::of(description);
        if let Some(list) = std::env::var_os("ROS_PACKAGE_PATH") {
            places.add_package_path(&list);
        }
        if let Some(list) = std::env::var_os("AMENT_PREFIX_PATH") {
            let shares = std::env::split_paths(&list).filter(|path| !path.as_os_str().is_empty());
            places.folders.extend(shares.map(|prefix| Folder::new(prefix.join("share"))));
        }
        places
    }

    /// Adds a package by its name; of two with one name the first counts.
    pub fn add_package(&mut self, name: impl Into<String>, path: impl Into<PathBuf>) {
        self.packages.push((name.into(), path.into()));
    }

    /// Adds folders that hold packages or are packages, separated as in `PATH`: what `ROS_PACKAGE_PATH` says. Reads the
    /// `package.xml` of each that has one.
    pub fn add_package_path(&mut self, list: &OsStr) {
        let folders = std::env::split_paths(list).filter(|path| !path.as_os_str().is_empty());
        self.folders.extend(folders.map(Folder::new));
    }

    /// [`find`](Self::find) as [`link_bodies`](super::link_bodies) asks it.
    pub fn paths(&self) -> impl Fn(&str) -> Option<PathBuf> + '_ {
        |filename| self.find(filename)
    }

    /// The file of a mesh, as the description writes it; `None` if there is none.
    pub fn find(&self, filename: &str) -> Option<PathBuf> {
        let in_package = ["package://", "model://"].iter().find_map(|scheme| filename.strip_prefix(scheme));
        if let Some(inside) = in_package {
            let (name, rest) = inside.trim_start_matches('/').split_once('/')?;
            if let Some((_, package)) = self.packages.iter().find(|(known, _)| known == name) {
                // A package that was named is meant: no other one of its name is taken instead.
                return Some(package.join(rest)).filter(|path| path.is_file());
            }
            return self.folders.iter().chain(&self.above).find_map(|folder| folder.find(name, rest));
        }
        let path = Path::new(filename.strip_prefix("file://").unwrap_or(filename));
        if path.is_absolute() {
            return Some(path.to_path_buf());
        }
        self.above.iter().map(|folder| folder.path.join(path)).find(|path| path.is_file())
    }
}

/// The name in a `package.xml`; `None` if there is no such file, or it is none.
fn manifest_name(path: &Path) -> Option<String> {
    let text = read_text(path, LARGEST_MANIFEST).ok()?;
    guard::check(&text).ok()?;
    let document = Document::parse(&text).ok()?;
    let name = document.root_element().children().find(|node| node.has_tag_name("name"))?;
    Some(name.text()?.trim().to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn write(path: &Path, text: &str) {
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }

    #[test]
    fn packages_are_found_by_name_by_path_and_upwards() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path();
        // A package whose folder has another name, with the description in it.
        write(&root.join("checkout/package.xml"), "<package><name> arm_description </name></package>");
        write(&root.join("checkout/urdf/arm.urdf"), "");
        write(&root.join("checkout/meshes/a.stl"), "");
        write(&root.join("hand_description/meshes/h.stl"), "");
        write(&root.join("elsewhere/base_description/meshes/b.stl"), "");
        write(&root.join("third/meshes/c.stl"), "");
        let mut places = MeshPlaces::of(&root.join("checkout/urdf/arm.urdf"));
        let found = |places: &MeshPlaces, name: &str| {
            places.find(name).map(|path| path.strip_prefix(root).unwrap_or(&path).display().to_string())
        };
        assert_eq!(found(&places, "package://arm_description/meshes/a.stl").unwrap(), "checkout/meshes/a.stl");
        assert_eq!(found(&places, "package://checkout/meshes/a.stl").unwrap(), "checkout/meshes/a.stl");
        assert_eq!(found(&places, "../meshes/a.stl").unwrap(), "checkout/urdf/../meshes/a.stl");
        assert_eq!(found(&places, "package://hand_description/meshes/h.stl").unwrap(), "hand_description/meshes/h.stl");
        assert_eq!(found(&places, "file:///a/b.stl").unwrap(), "/a/b.stl");
        let base = "package://base_description/meshes/b.stl";
        assert_eq!(found(&places, base), None);
        places.add_package_path(&std::env::join_paths([root.join("nowhere"), root.join("elsewhere")]).unwrap());
        assert_eq!(found(&places, base).unwrap(), "elsewhere/base_description/meshes/b.stl");
        places.add_package("base_description", root.join("third"));
        assert_eq!(found(&places, base), None, "the package that was named has no such file");
        assert_eq!(found(&places, "package://base_description/meshes/c.stl").unwrap(), "third/meshes/c.stl");
        assert_eq!(found(&places, "package://name"), None);
        assert_eq!(found(&places, ""), None);
    }
}
