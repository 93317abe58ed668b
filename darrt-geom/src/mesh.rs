//! Triangle surfaces and the files they come from.

mod dae;
mod glb;
mod inside;
mod read;

use crate::check;
use crate::convert;
use crate::error::GeomError;
use crate::shape::corners;
use nalgebra::{Point3, Vector3};
use parry3d_f64::shape::{SharedShape, TriMesh};
use std::path::Path;
use std::sync::{Arc, OnceLock};

use inside::Inside;

/// Largest mesh file read, in bytes (64 MiB).
pub const MAXIMUM_FILE_BYTES: u64 = 64 << 20;
/// Most triangles a mesh may have.
pub const MAXIMUM_TRIANGLES: usize = 2_000_000;

/// A triangle surface; need not be closed.
///
/// A closed piece of it is solid, whichever way its triangles are turned: what lies wholly inside touches it. A closed piece inside
/// another one is a cavity. A piece that is not closed is a shell: what lies on either side of it does not touch it.
#[derive(Clone)]
pub struct TriangleMesh {
    vertices: Vec<Point3<f64>>,
    triangles: Vec<[u32; 3]>,
    /// Corners of the box around it, own frame.
    bounds: (Point3<f64>, Point3<f64>),
    parry: SharedShape,
    /// Triangles without an area, which may close the gap between others.
    flat: Vec<[Point3<f64>; 3]>,
    /// Found out when it is asked for.
    inside: Arc<OnceLock<Inside>>,
}

impl TriangleMesh {
    /// A mesh of `triangles`, each three indices into `vertices` (metres, own frame); `name` appears in messages.
    ///
    /// Triangles without area are dropped, and so are vertices no triangle names.
    ///
    /// # Errors
    /// When there are more than [`MAXIMUM_TRIANGLES`], none with an area, an index names no vertex, or a coordinate is not
    /// finite or beyond 1e4 m.
    pub fn new(name: &str, vertices: &[Point3<f64>], triangles: &[[u32; 3]]) -> Result<Self, GeomError> {
        check::count(format_args!("triangles of {name}"), triangles.len(), 1, MAXIMUM_TRIANGLES)?;
        for (i, p) in vertices.iter().enumerate() {
            check::point(format_args!("vertex {i} of {name}"), p)?;
        }
        let (vertices, triangles, flat) = compact(name, vertices, triangles)?;
        check::count(format_args!("triangles with an area of {name}"), triangles.len(), 1, MAXIMUM_TRIANGLES)?;
        let points = vertices.iter().map(|p| convert::vector(&p.coords)).collect();
        let mesh = TriMesh::new(points, triangles.clone()).map_err(|error| GeomError::Malformed {
            path: name.to_owned(),
            format: "mesh",
            reason: error.to_string(),
        })?;
        let bounds = corners(&vertices);
        Ok(Self { vertices, triangles, bounds, parry: SharedShape::new(mesh), flat, inside: Arc::default() })
    }

    /// Reads a mesh from an STL (ascii or binary), OBJ, COLLADA (`dae`) or binary glTF (`glb`) file, chosen by the ending; each
    /// axis is multiplied by `scale`.
    ///
    /// Materials, normals and textures are ignored; polygons become fans of triangles; groups are merged. COLLADA and glTF are
    /// scenes: every mesh is taken where its nodes place it, COLLADA in its `<unit>`. The axes are taken as they are, whichever of
    /// them the file calls up: so do the readers that robot descriptions are written for.
    ///
    /// # Errors
    /// When the ending is none of those, the file is not a regular one, cannot be read, exceeds
    /// [`MAXIMUM_FILE_BYTES`], is malformed, or its content is refused by [`Self::new`]; when an entry of `scale` is zero,
    /// not finite, or beyond 1e4.
    pub fn from_file(path: &Path, scale: &Vector3<f64>) -> Result<Self, GeomError> {
        let shown = path.display().to_string();
        for factor in scale.iter() {
            check::in_range(format_args!("size of the scale of {shown}"), factor.abs(), 1e-9, check::MAXIMUM_LENGTH)?;
        }
        let soup = read::soup(path)?;
        let scaled: Vec<_> = soup.vertices.iter().map(|p| Point3::from(p.coords.component_mul(scale))).collect();
        Self::new(&shown, &scaled, &soup.triangles)
    }

    /// Corners of the triangles, own frame.
    pub fn vertices(&self) -> &[Point3<f64>] {
        &self.vertices
    }

    /// Triangles as indices into [`Self::vertices`].
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Is the point in the solid that the closed pieces enclose?
    pub fn contains(&self, p: &Point3<f64>) -> bool {
        self.inside().contains(p)
    }

    /// Is there a closed piece around one of the points and not around the other? Then every way between them crosses the mesh.
    pub fn separates(&self, p: &Point3<f64>, q: &Point3<f64>) -> bool {
        let inside = self.inside();
        inside.around(p) != inside.around(q)
    }

    /// How many edges have a triangle on one side only: none if the whole mesh is closed.
    pub fn open_edges(&self) -> usize {
        self.inside().open_edges()
    }

    /// A point of each piece: a piece that touches nothing is wholly where its point is.
    pub(crate) fn points_of_pieces(&self) -> &[Point3<f64>] {
        self.inside().corners()
    }

    /// The triangles of the closed pieces, each with its piece, and 1 if that is a solid, -1 if it is a cavity.
    pub(crate) fn closed_triangles(&self) -> impl Iterator<Item = ([Point3<f64>; 3], usize, i32)> + '_ {
        self.inside().closed()
    }

    fn inside(&self) -> &Inside {
        self.inside.get_or_init(|| {
            let corner = |index: &u32| self.vertices.get(*index as usize).copied().unwrap_or_else(Point3::origin);
            let with_area = self.triangles.iter().map(|[a, b, c]| [corner(a), corner(b), corner(c)]);
            Inside::new(with_area.chain(self.flat.iter().copied()))
        })
    }

    /// Lowest and highest corner of the box around it, own frame.
    pub(crate) fn bounds(&self) -> (Point3<f64>, Point3<f64>) {
        self.bounds
    }

    pub(crate) fn parry(&self) -> &SharedShape {
        &self.parry
    }
}

impl PartialEq for TriangleMesh {
    fn eq(&self, other: &Self) -> bool {
        self.vertices == other.vertices && self.triangles == other.triangles
    }
}

impl std::fmt::Debug for TriangleMesh {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("TriangleMesh")
            .field("vertices", &self.vertices.len())
            .field("triangles", &self.triangles.len())
            .finish_non_exhaustive()
    }
}

/// Vertices and triangles with the idle ones dropped and the rest renumbered in order of first use; the corners of the triangles
/// that were dropped.
type Compact = (Vec<Point3<f64>>, Vec<[u32; 3]>, Vec<[Point3<f64>; 3]>);

/// Checks the indices and drops triangles without area and vertices without triangle.
fn compact(name: &str, vertices: &[Point3<f64>], triangles: &[[u32; 3]]) -> Result<Compact, GeomError> {
    let mut renamed: Vec<Option<u32>> = vec![None; vertices.len()];
    let mut kept_vertices = Vec::new();
    let mut kept_triangles = Vec::with_capacity(triangles.len());
    let mut flat = Vec::new();
    for (number, triangle) in triangles.iter().enumerate() {
        let mut corners = [Point3::origin(); 3];
        for (corner, &index) in corners.iter_mut().zip(triangle) {
            *corner = *vertices.get(index as usize).ok_or_else(|| GeomError::UnknownVertex {
                name: name.to_owned(),
                triangle: number,
                vertex: index as usize,
                count: vertices.len(),
            })?;
        }
        let [a, b, c] = corners;
        if (b - a).cross(&(c - a)).norm() <= f64::MIN_POSITIVE {
            flat.push(corners);
            continue;
        }
        let mut renumbered = [0; 3];
        for ((new, &old), corner) in renumbered.iter_mut().zip(triangle).zip(corners) {
            let Some(slot) = renamed.get_mut(old as usize) else { continue };
            *new = *slot.get_or_insert_with(|| {
                kept_vertices.push(corner);
                // At most three vertices per triangle, far below 2^32.
                u32::try_from(kept_vertices.len() - 1).unwrap_or(u32::MAX)
            });
        }
        kept_triangles.push(renumbered);
    }
    Ok((kept_vertices, kept_triangles, flat))
}

#[cfg(test)]
mod tests;
