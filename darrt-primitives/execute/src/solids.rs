//! Bodies as the physics engine sees them: what is hollow is hollow, what is round stands on a cylinder.
//!
//! A disc that stands on a convex hull creeps and sinks into its table: round bottoms are cylinders. The rim of a plate and
//! the wall of a bowl, which are not convex, are rings of [`RING_PIECES`] convex pieces.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use darrt_geom::{Shape, TriangleMesh};
use darrt_task::problem_file::{PlateRim, ShapeSpec};
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use rapier3d_f64::prelude::{MassProperties, Pose, SharedShape, Vector};

use crate::error::ExecuteError;

/// Pieces of a ring: their faces leave a circle of 0.14 m by no more than 0.1 mm, half inside, half outside.
const RING_PIECES: u32 = 64;

/// A convex solid (or, of what does not move, any) in the frame of its body.
#[derive(Clone)]
pub(crate) struct Piece {
    pub(crate) shape: SharedShape,
    pub(crate) body_from_piece: Pose,
}

impl std::fmt::Debug for Piece {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:?} at {:?}", self.shape.shape_type(), self.body_from_piece)
    }
}

impl Piece {
    fn centred(shape: SharedShape) -> Self {
        Self { shape, body_from_piece: Pose::IDENTITY }
    }
}

/// The pieces of a movable object.
pub(crate) fn of_object(name: &str, shape: &ShapeSpec) -> Result<Vec<Piece>, ExecuteError> {
    let flaw = |reason: &str| ExecuteError::Solid { body: name.to_owned(), reason: reason.to_owned() };
    match shape {
        ShapeSpec::Box { size: [x, y, z] } => Ok(vec![Piece::centred(SharedShape::cuboid(x / 2.0, y / 2.0, z / 2.0))]),
        ShapeSpec::Sphere { radius } => Ok(vec![Piece::centred(SharedShape::ball(*radius))]),
        ShapeSpec::Cylinder { radius, height } => Ok(vec![cylinder(*radius, height / 2.0, 0.0)]),
        ShapeSpec::Capsule { radius, height } => {
            Ok(vec![Piece::centred(SharedShape::capsule_z(height / 2.0 - radius, *radius))])
        }
        ShapeSpec::Bowl { radius, height, wall } => {
            let (low, top) = (wall - height / 2.0, height / 2.0);
            let section = [[*radius, low], [radius - wall, low], [radius - wall, top], [*radius, top]];
            let bottom = cylinder(*radius, wall / 2.0, (wall - height) / 2.0);
            let mut pieces = vec![bottom];
            pieces.extend(ring(&section).ok_or_else(|| flaw("its wall is too thin"))?);
            Ok(pieces)
        }
        ShapeSpec::Plate { radius, height, rim } => {
            plate(*radius, *height, *rim).ok_or_else(|| flaw("its rim is too thin"))
        }
        ShapeSpec::Hull { points } => {
            let points: Vec<_> = points.iter().map(|&[x, y, z]| Vector::new(x, y, z)).collect();
            let hull = SharedShape::convex_hull(&points).ok_or_else(|| flaw("its points lie in one plane"))?;
            Ok(vec![Piece::centred(hull)])
        }
        ShapeSpec::Mesh { file, scale } => {
            let mesh = TriangleMesh::from_file(file, &Vector3::repeat(*scale));
            let mesh = mesh.map_err(|error| ExecuteError::solid(name, &error))?;
            let (vertices, triangles) = triangles(&mesh);
            Ok(vec![Piece::centred(SharedShape::convex_decomposition(&vertices, &triangles))])
        }
    }
}

/// A solid of the room or of the robot.
pub(crate) fn of_part(body: &str, shape: &Shape, body_from_shape: &Isometry3<f64>) -> Result<Piece, ExecuteError> {
    let flaw = |reason: &str| ExecuteError::Solid { body: body.to_owned(), reason: reason.to_owned() };
    let body_from_piece = Pose::from(*body_from_shape);
    let shape = match shape {
        Shape::Cuboid { half_extents: h, .. } => SharedShape::cuboid(h.x, h.y, h.z),
        Shape::Sphere { radius, .. } => SharedShape::ball(*radius),
        Shape::Cylinder { radius, half_height, .. } => {
            let Piece { shape, body_from_piece: turned } = cylinder(*radius, *half_height, 0.0);
            return Ok(Piece { shape, body_from_piece: body_from_piece * turned });
        }
        Shape::Capsule { radius, half_height, .. } => SharedShape::capsule_z(*half_height, *radius),
        Shape::HalfSpace { normal, .. } => SharedShape::halfspace(Vector::new(normal.x, normal.y, normal.z)),
        Shape::ConvexHull(hull) => {
            let points: Vec<_> = hull.vertices().iter().map(|p| Vector::new(p.x, p.y, p.z)).collect();
            SharedShape::convex_hull(&points).ok_or_else(|| flaw("its hull is flat"))?
        }
        Shape::Mesh(mesh) => {
            let (vertices, triangles) = triangles(mesh);
            SharedShape::trimesh(vertices, triangles).map_err(|error| flaw(&error.to_string()))?
        }
        _ => return Err(flaw("a shape of this kind cannot be executed")),
    };
    Ok(Piece { shape, body_from_piece })
}

/// Mass, centre and inertia of a body of even density.
pub(crate) fn mass_properties(pieces: &[Piece], mass_kg: f64) -> MassProperties {
    let parts = pieces.iter().map(|piece| piece.shape.mass_properties(1.0).transform_by(&piece.body_from_piece));
    let mut whole = parts.reduce(|a, b| a + b).unwrap_or_default();
    whole.set_mass(mass_kg, true);
    whole
}

/// A cylinder along z at this height: the engine has its own along y.
fn cylinder(radius: f64, half_height: f64, z: f64) -> Piece {
    let turn = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), FRAC_PI_2);
    let body_from_piece = Isometry3::from_parts(Translation3::new(0.0, 0.0, z), turn).into();
    Piece { shape: SharedShape::cylinder(half_height, radius), body_from_piece }
}

/// A plate as it is, not filled above its rim.
fn plate(radius: f64, height: f64, rim: PlateRim) -> Option<Vec<Piece>> {
    let (sin, cos) = rim.slope_deg.to_radians().sin_cos();
    let (top, rise) = (height / 2.0, rim.width_m * sin);
    let lower = [radius, top - rim.thickness_m * cos];
    let inner = [radius - rim.width_m * cos, lower[1] - rise];
    let up = [-rim.thickness_m * sin, rim.thickness_m * cos];
    let raised = |[r, z]: [f64; 2]| [r + up[0], z + up[1]];
    let mut pieces = vec![cylinder(inner[0], (height - rise) / 2.0, -rise / 2.0)];
    pieces.extend(ring(&[lower, inner, raised(inner), raised(lower)])?);
    Some(pieces)
}

/// What a cross-section of four `[radius, z]` sweeps about z; `None` if it is flat.
fn ring(section: &[[f64; 2]; 4]) -> Option<Vec<Piece>> {
    // As much of a face lies outside of the circle as inside.
    let wider = 2.0 / (1.0 + (PI / f64::from(RING_PIECES)).cos());
    let corner = |index: u32, [r, z]: [f64; 2]| {
        let (sin, cos) = (TAU * f64::from(index) / f64::from(RING_PIECES)).sin_cos();
        Vector::new(wider * r * cos, wider * r * sin, z)
    };
    let piece = |index: u32| {
        let corners: Vec<_> = [index, index + 1].iter().flat_map(|&i| section.map(|at| corner(i, at))).collect();
        SharedShape::convex_hull(&corners).map(Piece::centred)
    };
    (0..RING_PIECES).map(piece).collect()
}

fn triangles(mesh: &TriangleMesh) -> (Vec<Vector>, Vec<[u32; 3]>) {
    (mesh.vertices().iter().map(|p| Vector::new(p.x, p.y, p.z)).collect(), mesh.triangles().to_vec())
}
