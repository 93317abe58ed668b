//! What the links of a robot occupy: URDF collision geometry as bodies of the geometry crate.

use std::path::PathBuf;
use std::sync::Arc;

use darrt_geom::{Body, GeomError, Part, Shape, TriangleMesh};
use nalgebra::Vector3;

use super::tree::KinematicTree;
use super::urdf::{Geometry, LinkDescription, RobotDescription, UrdfError};

/// A mesh gets a solid with about so many corners at most: what a distance costs grows with them, how far the solid stands off
/// shrinks ever more slowly.
pub const MOST_CORNERS: usize = 64;

/// The body of every link, in the order of the tree, in link frames; `None` for a link without collision geometry.
///
/// A mesh becomes its convex hull, or where that has many corners a solid around it with [`MOST_CORNERS`] or a few more: solid, and
/// never smaller than the mesh. `mesh_path` says where the file of a mesh
/// is; see [`no_meshes`] and [`MeshPlaces`](super::MeshPlaces).
///
/// # Errors
/// [`UrdfError::Mesh`] for a mesh that `mesh_path` does not know or that cannot be read, [`UrdfError::Shape`] for
/// geometry the geometry crate refuses; both name the link.
pub fn link_bodies(
    robot: &RobotDescription,
    tree: &KinematicTree,
    mesh_path: &dyn Fn(&str) -> Option<PathBuf>,
) -> Result<Vec<Option<Body>>, UrdfError> {
    (0..tree.link_count())
        .map(|link| {
            let source = tree.source_link(link).and_then(|l| robot.links.get(l));
            source.map_or(Ok(None), |l| link_body(l, mesh_path))
        })
        .collect()
}

/// Knows no mesh: for descriptions made of boxes, balls, cylinders and capsules.
pub fn no_meshes(_filename: &str) -> Option<PathBuf> {
    None
}

fn link_body(link: &LinkDescription, mesh_path: &dyn Fn(&str) -> Option<PathBuf>) -> Result<Option<Body>, UrdfError> {
    if link.collision.is_empty() {
        return Ok(None);
    }
    let refused = |index: usize| {
        move |error: GeomError| UrdfError::Shape { link: link.name.to_string(), index, reason: error.to_string() }
    };
    let mut parts = Vec::with_capacity(link.collision.len());
    for (index, placed) in link.collision.iter().enumerate() {
        let shape = match &placed.geometry {
            Geometry::Cuboid { size } => Shape::cuboid(size / 2.0),
            Geometry::Sphere { radius } => Shape::sphere(*radius),
            Geometry::Cylinder { radius, length } => Shape::cylinder(*radius, length / 2.0),
            Geometry::Capsule { radius, length } => Shape::capsule(*radius, length / 2.0),
            Geometry::Mesh { filename, scale } => Ok(mesh(&link.name, filename, scale, mesh_path)?),
        };
        parts.push(Part { shape: shape.map_err(refused(index))?, body_from_shape: placed.link_from_geometry });
    }
    Body::new(Arc::clone(&link.name), parts).map(Some).map_err(refused(0))
}

/// Where meshes are looked for, for people.
const NOT_FOUND: &str = "there is no such file: what follows `package://` is looked for in the packages that are named (`packages` \
                         in a robot file), in those of ROS_PACKAGE_PATH and AMENT_PREFIX_PATH, and in the folder of the robot \
                         description and the folders above it; a relative path in these folders";

fn mesh(
    link: &str,
    filename: &str,
    scale: &Vector3<f64>,
    mesh_path: &dyn Fn(&str) -> Option<PathBuf>,
) -> Result<Shape, UrdfError> {
    let refused = |reason: String| UrdfError::Mesh { link: link.to_owned(), filename: filename.to_owned(), reason };
    let path = mesh_path(filename).ok_or_else(|| refused(NOT_FOUND.to_owned()))?;
    let mesh = TriangleMesh::from_file(&path, scale).map_err(|e| refused(e.to_string()))?;
    Shape::convex_cover(filename, mesh.vertices(), MOST_CORNERS).map_err(|e| refused(e.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kinematics::MeshPlaces;

    fn read(text: &str, mesh_path: &dyn Fn(&str) -> Option<PathBuf>) -> Result<Vec<Option<Body>>, UrdfError> {
        let robot = RobotDescription::from_text(text)?;
        link_bodies(&robot, &KinematicTree::new(&robot)?, mesh_path)
    }

    #[test]
    fn shapes_keep_their_size_and_place() {
        let bodies = read(include_str!("../../tests/data/generic_arm.urdf"), &no_meshes).unwrap();
        assert_eq!(bodies.len(), 9);
        let rail = bodies[1].as_ref().unwrap();
        assert_eq!(&*rail.name, "rail");
        assert_eq!(rail.parts[0].shape, Shape::cuboid(Vector3::repeat(0.1)).unwrap());
        assert_eq!(rail.parts[0].body_from_shape.translation.z, 0.1);
        let lower = bodies[5].as_ref().unwrap();
        assert_eq!(lower.parts[0].shape, Shape::cylinder(0.05, 0.125).unwrap());
        assert!(bodies[0].is_none() && bodies[8].is_none());
    }

    #[test]
    fn meshes_are_found_or_named() {
        let text = "<robot name='r'><link name='a'><collision><geometry>\
                    <mesh filename='package://shapes/corner.obj' scale='2 2 2'/></geometry></collision></link></robot>";
        let message = read(text, &no_meshes).unwrap_err().to_string();
        assert!(message.contains("link \"a\"") && message.contains("package://shapes/corner.obj"), "{message}");
        let data = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data");
        let bodies = read(text, &MeshPlaces::of(&data.join("any.urdf")).paths()).unwrap();
        let (low, high) = bodies[0].as_ref().unwrap().parts[0].shape.local_aabb();
        assert_eq!((low.x, high.x, high.z), (0.0, 2.0, 2.0));
    }
}
