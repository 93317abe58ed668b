//! A support surface lies on its body: otherwise what stands on the surface floats, or is inside the body.
//!
//! A convex body is asked for its height and for the distance of each corner. A mesh is asked at points of the polygon,
//! along vertical lines, because it may have several boards one above the other.

use darrt_geom::clearance::between;
use darrt_geom::{Body, FixedBody, GeomError, Shape, SupportSurface, TriangleMesh};
use nalgebra::{Isometry3, Point2, Point3, Vector3};
use rand::SeedableRng as _;
use rand_xoshiro::Xoshiro256PlusPlus;

use super::error::{Flaw, Located};

/// How far a surface may be above, below or beside its body's upper face (m); the verifier lets objects press in as far.
pub const TOLERANCE: f64 = 1e-3;

/// Points of a polygon at which a mesh is asked: on its boundary at most, and inside it.
const ASKED: [usize; 2] = [256, 64];

/// Radius of the ball that stands for a point (m).
const POINT: f64 = 1e-6;

/// Heights nearer than this belong to one crossing, seen by two triangles that share an edge (m).
const ONE_CROSSING: f64 = 1e-9;

/// Checks that `surface`, whose corners the file gives as `polygon`, lies on an upper face of `carrier`. `key` is the
/// path of the surface.
///
/// # Errors
/// [`Flaw::NotOnTop`], [`Flaw::BesideBody`] or [`Flaw::NoFace`] with the surface, the body, the value and the bound.
pub(super) fn check(
    surface: &SupportSurface,
    polygon: &[[f64; 2]],
    carrier: &FixedBody,
    key: &str,
) -> Result<(), Located> {
    for part in &carrier.body.parts {
        let world_from_shape = carrier.world_from_body * part.body_from_shape;
        match &part.shape {
            Shape::Mesh(mesh) => {
                check_mesh(surface, &Sheet::new(mesh, &world_from_shape, surface), &carrier.body, key)?;
            }
            shape => {
                let top = check_height(surface, shape, &world_from_shape, &carrier.body, key)?;
                check_corners(surface, polygon, carrier, top, key)?;
            }
        }
    }
    Ok(())
}

/// The height of the body's top, if it is that of the surface.
fn check_height(
    surface: &SupportSurface,
    shape: &Shape,
    world_from_shape: &Isometry3<f64>,
    body: &Body,
    key: &str,
) -> Result<f64, Located> {
    let up = world_from_shape.inverse_transform_vector(&Vector3::z());
    let (height, top) = (surface.height(), world_from_shape.translation.z + shape.support_extent(&up));
    if (height - top).abs() <= TOLERANCE {
        return Ok(top);
    }
    let (surface, body) = (surface.name().to_owned(), body.name.to_string());
    Err(Flaw::NotOnTop { surface, height, body, top, tolerance: TOLERANCE }.at(format!("{key}.z")))
}

/// Every corner is on the body, and so is all between them, for a convex body.
fn check_corners(
    surface: &SupportSurface,
    polygon: &[[f64; 2]],
    carrier: &FixedBody,
    top: f64,
    key: &str,
) -> Result<(), Located> {
    let unfit = |error: GeomError| Flaw::from(error).at(key);
    let probe = Shape::sphere(POINT).and_then(|shape| Body::single("corner", shape)).map_err(unfit)?;
    for (index, &[x, y]) in polygon.iter().enumerate() {
        let corner = Isometry3::translation(x, y, surface.height().min(top));
        let outside =
            between(&probe, &corner, &carrier.body, &carrier.world_from_body).map_err(unfit)?.distance + POINT;
        if outside > TOLERANCE {
            let (surface, body) = (surface.name().to_owned(), carrier.body.name.to_string());
            let flaw = Flaw::BesideBody { surface, corner: [x, y], outside, body, tolerance: TOLERANCE };
            return Err(flaw.at(format!("{key}.polygon[{index}]")));
        }
    }
    Ok(())
}

fn check_mesh(surface: &SupportSurface, sheet: &Sheet, body: &Body, key: &str) -> Result<(), Located> {
    for at in points_of(surface) {
        let crossings = sheet.crossings(&at);
        if crossings.has_floor(surface.height()) {
            continue;
        }
        let (surface, height, body) = (surface.name().to_owned(), surface.height(), body.name.to_string());
        let nearest = crossings.nearest(height);
        let flaw = Flaw::NoFace { surface, height, body, at: at.into(), nearest, tolerance: TOLERANCE };
        return Err(flaw.at(key));
    }
    Ok(())
}

/// Corners and middles of the edges, moved inside by the tolerance, and points inside; the same ones every time.
fn points_of(surface: &SupportSurface) -> Vec<Point2<f64>> {
    let edges = surface.edges();
    let mut edge = Vec::with_capacity(2 * edges.len());
    for (side, before) in edges.iter().zip(edges.iter().cycle().skip(edges.len().saturating_sub(1))) {
        let ahead = side.outward.into_inner();
        let bisector = (before.outward.into_inner() + ahead).try_normalize(1e-9).unwrap_or(ahead);
        edge.push(side.start - bisector * TOLERANCE);
        edge.push(nalgebra::center(&side.start, &side.end) - ahead * TOLERANCE);
    }
    let stride = edge.len().div_ceil(ASKED[0]).max(1);
    // A sharp corner moved inside may have left the polygon on its other side.
    let mut points: Vec<_> = edge.into_iter().step_by(stride).filter(|p| surface.contains(p)).collect();
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(0);
    points.extend((0..ASKED[1]).filter_map(|_| surface.sample(&mut rng, TOLERANCE)));
    points
}

/// The triangles of a mesh that lie over or under a surface, in the world.
struct Sheet {
    triangles: Vec<[Point3<f64>; 3]>,
}

impl Sheet {
    fn new(mesh: &TriangleMesh, world_from_mesh: &Isometry3<f64>, surface: &SupportSurface) -> Self {
        let (low, high) = surface.bounds();
        let vertices: Vec<_> = mesh.vertices().iter().map(|p| world_from_mesh * p).collect();
        let corner = |index: u32| vertices.get(index as usize).copied();
        let triangles = mesh.triangles().iter().filter_map(|&[a, b, c]| Some([corner(a)?, corner(b)?, corner(c)?]));
        let is_near = |triangle: &[Point3<f64>; 3]| {
            let beyond = |test: &dyn Fn(&Point3<f64>) -> bool| triangle.iter().all(test);
            !(beyond(&|p| p.x < low.x)
                || beyond(&|p| p.x > high.x)
                || beyond(&|p| p.y < low.y)
                || beyond(&|p| p.y > high.y))
        };
        Self { triangles: triangles.filter(is_near).collect() }
    }

    /// Where the vertical line through `at` meets the triangles, from below.
    fn crossings(&self, at: &Point2<f64>) -> Crossings {
        let mut found: Vec<_> = self.triangles.iter().filter_map(|triangle| crossing(triangle, at)).collect();
        found.sort_by(|a, b| a.height.total_cmp(&b.height));
        found.dedup_by(|b, a| b.height - a.height <= ONE_CROSSING);
        Crossings(found)
    }
}

/// Where a vertical line meets a triangle.
#[derive(Clone, Copy, Debug)]
struct Crossing {
    height: f64,
    /// The triangle's normal, by the order of its corners, points up.
    faces_up: bool,
}

struct Crossings(Vec<Crossing>);

impl Crossings {
    /// Whether something can stand at `height`: there is a face, and it is not the underside of something.
    // An underside looks down, and an odd number of faces are above it. Meshes that are not closed, or whose triangles are
    // turned at random, break one of the two signs; only both together count.
    fn has_floor(&self, height: f64) -> bool {
        let above = self.0.iter().filter(|c| c.height > height + TOLERANCE).count();
        self.0.iter().any(|c| (c.height - height).abs() <= TOLERANCE && (c.faces_up || above % 2 == 0))
    }

    fn nearest(&self, height: f64) -> Option<f64> {
        let heights = self.0.iter().map(|c| c.height);
        heights.min_by(|a, b| (a - height).abs().total_cmp(&(b - height).abs()))
    }
}

fn crossing([a, b, c]: &[Point3<f64>; 3], at: &Point2<f64>) -> Option<Crossing> {
    /// Slack of the barycentric coordinates, so that no line slips between two triangles.
    const SLACK: f64 = 1e-9;
    let area = (b.xy() - a.xy()).perp(&(c.xy() - a.xy()));
    if area == 0.0 {
        return None;
    }
    let share = |p: &Point3<f64>, q: &Point3<f64>| (p.xy() - at).perp(&(q.xy() - at)) / area;
    let [u, v, w] = [share(b, c), share(c, a), share(a, b)];
    // Numbers that are none fail the test.
    if !(u >= -SLACK && v >= -SLACK && w >= -SLACK) {
        return None;
    }
    Some(Crossing { height: u * a.z + v * b.z + w * c.z, faces_up: area > 0.0 })
}

#[cfg(test)]
mod tests;
