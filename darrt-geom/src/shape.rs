//! Solids, each centred at the origin of its own frame.

use crate::check;
use crate::error::GeomError;
use crate::hull::ConvexHull;
use crate::mesh::TriangleMesh;
use nalgebra::{Point3, Unit, Vector3};
use std::sync::Arc;

/// A solid in its own frame, metres; cylinders and capsules stand along local z.
///
/// Values are made by the constructors, which validate; match with `..` because the variants may grow fields.
/// A [`Shape::Mesh`] is solid where it is closed, and a surface where it is not: see [`TriangleMesh`].
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Shape {
    /// A box.
    #[non_exhaustive]
    Cuboid {
        /// Half the edge lengths along local x, y, z.
        half_extents: Vector3<f64>,
    },
    /// A ball.
    #[non_exhaustive]
    Sphere {
        /// Radius.
        radius: f64,
    },
    /// A cylinder along local z.
    #[non_exhaustive]
    Cylinder {
        /// Radius.
        radius: f64,
        /// Half the height.
        half_height: f64,
    },
    /// All points within `radius` of a segment along local z.
    #[non_exhaustive]
    Capsule {
        /// Radius.
        radius: f64,
        /// Half the length of the segment (without the caps).
        half_height: f64,
    },
    /// The convex hull of a set of points.
    ConvexHull(Arc<ConvexHull>),
    /// A triangle surface.
    Mesh(Arc<TriangleMesh>),
    /// Everything below the plane through the origin: `normal . p <= 0`. Unbounded, so only fixed bodies may have it.
    #[non_exhaustive]
    HalfSpace {
        /// Outward normal.
        normal: Unit<Vector3<f64>>,
    },
}

impl Shape {
    /// A box with the given half edge lengths (metres, each in `[1e-6, 1e4]`).
    ///
    /// # Errors
    /// When a half extent is not finite or out of range.
    pub fn cuboid(half_extents: Vector3<f64>) -> Result<Self, GeomError> {
        for (axis, value) in ["x", "y", "z"].iter().zip(half_extents.iter()) {
            check::length(format_args!("half extent {axis} of a cuboid"), *value)?;
        }
        Ok(Self::Cuboid { half_extents })
    }

    /// A ball (radius in `[1e-6, 1e4]` m).
    ///
    /// # Errors
    /// When the radius is not finite or out of range.
    pub fn sphere(radius: f64) -> Result<Self, GeomError> {
        check::length("radius of a sphere", radius)?;
        Ok(Self::Sphere { radius })
    }

    /// A cylinder along local z (lengths in `[1e-6, 1e4]` m).
    ///
    /// # Errors
    /// When a length is not finite or out of range.
    pub fn cylinder(radius: f64, half_height: f64) -> Result<Self, GeomError> {
        check::length("radius of a cylinder", radius)?;
        check::length("half height of a cylinder", half_height)?;
        Ok(Self::Cylinder { radius, half_height })
    }

    /// A capsule along local z; `half_height` is that of the segment (lengths in `[1e-6, 1e4]` m).
    ///
    /// # Errors
    /// When a length is not finite or out of range.
    pub fn capsule(radius: f64, half_height: f64) -> Result<Self, GeomError> {
        check::length("radius of a capsule", radius)?;
        check::length("half height of a capsule", half_height)?;
        Ok(Self::Capsule { radius, half_height })
    }

    /// The convex hull of `points`; `name` appears in error messages.
    ///
    /// # Errors
    /// See [`ConvexHull::new`].
    pub fn convex_hull(name: &str, points: &[Point3<f64>]) -> Result<Self, GeomError> {
        ConvexHull::new(name, points).map(|hull| Self::ConvexHull(Arc::new(hull)))
    }

    /// A convex solid with at most about `most` corners that holds the hull of `points`; `name` appears in error messages.
    ///
    /// # Errors
    /// See [`ConvexHull::around`].
    pub fn convex_cover(name: &str, points: &[Point3<f64>], most: usize) -> Result<Self, GeomError> {
        ConvexHull::around(name, points, most).map(|(hull, _)| Self::ConvexHull(Arc::new(hull)))
    }

    /// The half space below the plane through the origin with outward unit `normal`.
    ///
    /// # Errors
    /// When the normal is not finite or not of length one (to 1e-6).
    pub fn half_space(normal: Unit<Vector3<f64>>) -> Result<Self, GeomError> {
        check::in_range("length of the normal of a half space", normal.norm(), 1.0 - 1e-6, 1.0 + 1e-6)?;
        Ok(Self::HalfSpace { normal })
    }

    /// What the shape is called in messages.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Cuboid { .. } => "cuboid",
            Self::Sphere { .. } => "sphere",
            Self::Cylinder { .. } => "cylinder",
            Self::Capsule { .. } => "capsule",
            Self::ConvexHull(_) => "convex hull",
            Self::Mesh(_) => "mesh",
            Self::HalfSpace { .. } => "half space",
        }
    }

    /// Whether the shape fits in some ball (all but the half space do).
    pub fn is_bounded(&self) -> bool {
        !matches!(self, Self::HalfSpace { .. })
    }

    /// Corners `(minimum, maximum)` of the axis-aligned box around the shape in its own frame; infinite for a half space.
    pub fn local_aabb(&self) -> (Point3<f64>, Point3<f64>) {
        let half = match self {
            Self::Cuboid { half_extents } => *half_extents,
            Self::Sphere { radius } => Vector3::repeat(*radius),
            Self::Cylinder { radius, half_height } => Vector3::new(*radius, *radius, *half_height),
            Self::Capsule { radius, half_height } => Vector3::new(*radius, *radius, half_height + radius),
            Self::ConvexHull(hull) => return corners(hull.vertices()),
            Self::Mesh(mesh) => return mesh.bounds(),
            Self::HalfSpace { .. } => Vector3::repeat(f64::INFINITY),
        };
        (Point3::from(-half), Point3::from(half))
    }

    /// Centre and radius of a ball around the shape, centred in its [`Self::local_aabb`]; the radius of a half space is
    /// infinite.
    pub fn bounding_sphere(&self) -> (Point3<f64>, f64) {
        match self {
            Self::Cuboid { half_extents } => (Point3::origin(), half_extents.norm()),
            Self::Sphere { radius } => (Point3::origin(), *radius),
            Self::Cylinder { radius, half_height } => (Point3::origin(), radius.hypot(*half_height)),
            Self::Capsule { radius, half_height } => (Point3::origin(), radius + half_height),
            Self::ConvexHull(hull) => ball_around(hull.vertices()),
            Self::Mesh(mesh) => ball_around(mesh.vertices()),
            Self::HalfSpace { .. } => (Point3::origin(), f64::INFINITY),
        }
    }

    /// Greatest value of `direction . p` over the points `p` of the shape (metres for a unit direction, own frame).
    pub fn support_extent(&self, direction: &Vector3<f64>) -> f64 {
        let reach =
            |points: &[Point3<f64>]| points.iter().map(|p| p.coords.dot(direction)).fold(f64::NEG_INFINITY, f64::max);
        match self {
            Self::Cuboid { half_extents } => half_extents.dot(&direction.abs()),
            Self::Sphere { radius } => radius * direction.norm(),
            Self::Cylinder { radius, half_height } => {
                radius * direction.x.hypot(direction.y) + half_height * direction.z.abs()
            }
            Self::Capsule { radius, half_height } => radius * direction.norm() + half_height * direction.z.abs(),
            Self::ConvexHull(hull) => reach(hull.vertices()),
            Self::Mesh(mesh) => reach(mesh.vertices()),
            Self::HalfSpace { normal } => {
                if normal.cross(direction).norm() <= 1e-12 * direction.norm() && normal.dot(direction) >= 0.0 {
                    0.0
                } else {
                    f64::INFINITY
                }
            }
        }
    }

    /// A point of the shape with the greatest `direction . p` (own frame); for a half space the origin.
    pub fn support_point(&self, direction: &Vector3<f64>) -> Point3<f64> {
        let unit = direction.try_normalize(0.0).unwrap_or_else(Vector3::z);
        let farthest = |points: &[Point3<f64>]| {
            let along = |p: &Point3<f64>| p.coords.dot(&unit);
            points.iter().max_by(|p, q| along(p).total_cmp(&along(q))).copied().unwrap_or_else(Point3::origin)
        };
        let tip = |half_height: f64| Vector3::new(0.0, 0.0, half_height.copysign(unit.z));
        match self {
            Self::Cuboid { half_extents } => Point3::from(half_extents.zip_map(&unit, f64::copysign)),
            Self::Sphere { radius } => Point3::from(unit * *radius),
            Self::Cylinder { radius, half_height } => {
                let flat = Vector3::new(unit.x, unit.y, 0.0).try_normalize(0.0).unwrap_or_else(Vector3::zeros);
                Point3::from(flat * *radius + tip(*half_height))
            }
            Self::Capsule { radius, half_height } => Point3::from(unit * *radius + tip(*half_height)),
            Self::ConvexHull(hull) => farthest(hull.vertices()),
            Self::Mesh(mesh) => farthest(mesh.vertices()),
            Self::HalfSpace { .. } => Point3::origin(),
        }
    }
}

/// Corners of the axis-aligned box around `points`.
pub(crate) fn corners(points: &[Point3<f64>]) -> (Point3<f64>, Point3<f64>) {
    let start = (Point3::from(Vector3::repeat(f64::INFINITY)), Point3::from(Vector3::repeat(f64::NEG_INFINITY)));
    points.iter().fold(start, |(low, high), p| (low.inf(p), high.sup(p)))
}

/// A ball around `points`, centred in their box.
fn ball_around(points: &[Point3<f64>]) -> (Point3<f64>, f64) {
    let (low, high) = corners(points);
    let centre = nalgebra::center(&low, &high);
    (centre, points.iter().map(|p| (p - centre).norm()).fold(0.0, f64::max))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn constructors_refuse_bad_lengths() {
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e5] {
            assert!(Shape::cuboid(Vector3::new(1.0, bad, 1.0)).is_err());
            assert!(Shape::sphere(bad).is_err());
            assert!(Shape::cylinder(bad, 1.0).is_err() && Shape::cylinder(1.0, bad).is_err());
            assert!(Shape::capsule(bad, 1.0).is_err() && Shape::capsule(1.0, bad).is_err());
        }
        let message = Shape::sphere(-1.0).unwrap_err().to_string();
        assert!(message.contains("radius of a sphere") && message.contains("-1") && message.contains("10000"));
        assert!(Shape::half_space(Unit::new_unchecked(Vector3::zeros())).is_err());
    }

    #[test]
    fn bounds_hold_the_support_points() {
        let corners: Vec<_> = [[0.1, 0.0, 0.0], [0.0, 0.3, 0.0], [0.0, 0.0, 0.2], [0.0, 0.0, 0.0]]
            .iter()
            .map(|c| Point3::from(*c))
            .collect();
        let shapes = [
            Shape::cuboid(Vector3::new(0.1, 0.2, 0.3)).unwrap(),
            Shape::sphere(0.2).unwrap(),
            Shape::cylinder(0.1, 0.3).unwrap(),
            Shape::capsule(0.1, 0.3).unwrap(),
            Shape::convex_hull("tetrahedron", &corners).unwrap(),
        ];
        for shape in &shapes {
            let (low, high) = shape.local_aabb();
            let (centre, radius) = shape.bounding_sphere();
            for i in 0..3 {
                let axis = Vector3::ith(i, 1.0);
                assert!((shape.support_extent(&axis) - high[i]).abs() < 1e-12, "{}", shape.kind());
                assert!((shape.support_extent(&-axis) + low[i]).abs() < 1e-12);
            }
            let slant = Vector3::new(1.0, -2.0, 0.5).normalize();
            assert!((shape.support_point(&slant).coords.dot(&slant) - shape.support_extent(&slant)).abs() < 1e-12);
            assert!(shape.support_extent(&slant) <= slant.dot(&centre.coords) + radius + 1e-12);
        }
    }

    #[test]
    fn half_space_is_unbounded() {
        let floor = Shape::half_space(Vector3::z_axis()).unwrap();
        assert!(!floor.is_bounded());
        assert_eq!(floor.bounding_sphere().1, f64::INFINITY);
        assert_eq!(floor.support_extent(&Vector3::z()), 0.0);
        assert_eq!(floor.support_extent(&-Vector3::z()), f64::INFINITY);
    }
}
