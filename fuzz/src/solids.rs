//! Posed bodies from bytes, axis-aligned and touching ones among them: problems are full of those, and iterative methods
//! do not like them.

use arbitrary::Arbitrary;
use darrt_geom::{Body, Part, Shape, TriangleMesh};
use nalgebra::{Isometry3, Point3, Translation3, Unit, UnitQuaternion, Vector3};

/// A length between 5 mm and 0.5 m; multiples of 1/8 m are common.
#[derive(Debug, Clone, Copy, Arbitrary)]
enum Length {
    Round(u8),
    Fine(u16),
}

impl Length {
    fn metres(self) -> f64 {
        match self {
            Self::Round(eighths) => f64::from(eighths % 4 + 1) / 8.0,
            Self::Fine(share) => 0.005 + 0.495 * f64::from(share) / f64::from(u16::MAX),
        }
    }
}

/// A pose within one metre of the origin.
#[derive(Debug, Clone, Copy, Arbitrary)]
enum PoseSketch {
    /// Eighths of metres and quarter turns.
    Grid { at: [i8; 3], turns: [u8; 2] },
    /// Anywhere.
    Free { at: [i16; 3], turn: [i16; 3] },
}

impl PoseSketch {
    fn pose(self) -> Isometry3<f64> {
        let (at, turn) = match self {
            Self::Grid { at, turns } => {
                let quarters = turns.map(|turn| f64::from(turn % 4) * std::f64::consts::FRAC_PI_2);
                let first = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), quarters[0]);
                let second = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), quarters[1]);
                (at.map(|x| f64::from(x % 9) / 8.0), second * first)
            }
            Self::Free { at, turn } => {
                let share = |x: i16| f64::from(x) / f64::from(i16::MAX);
                (at.map(share), UnitQuaternion::from_scaled_axis(Vector3::from(turn.map(|x| 3.0 * share(x)))))
            }
        };
        Isometry3::from_parts(Translation3::from(at), turn)
    }
}

/// A shape.
#[derive(Debug, Clone, Arbitrary)]
enum ShapeSketch {
    Cuboid([Length; 3]),
    Sphere(Length),
    Cylinder(Length, Length),
    Capsule(Length, Length),
    Hull(Vec<[i8; 3]>),
    Mesh(Vec<[i8; 3]>),
    HalfSpace([i8; 3]),
}

impl ShapeSketch {
    /// `None` where there is no such shape.
    fn shape(&self) -> Option<Shape> {
        let points = |all: &[[i8; 3]]| -> Vec<Point3<f64>> {
            all.iter().take(20).map(|p| Point3::from(p.map(|x| f64::from(x) / 400.0))).collect()
        };
        match self {
            Self::Cuboid(half) => Shape::cuboid(Vector3::from(half.map(Length::metres))).ok(),
            Self::Sphere(radius) => Shape::sphere(radius.metres()).ok(),
            Self::Cylinder(radius, half) => Shape::cylinder(radius.metres(), half.metres()).ok(),
            Self::Capsule(radius, half) => Shape::capsule(radius.metres(), half.metres()).ok(),
            Self::Hull(all) => Shape::convex_hull("hull", &points(all)).ok(),
            Self::Mesh(all) => {
                let corners = points(all);
                let last = u32::try_from(corners.len()).ok()?.checked_sub(2)?;
                let strip: Vec<_> = (0..last).map(|i| [i, i + 1, i + 2]).collect();
                Some(Shape::Mesh(TriangleMesh::new("mesh", &corners, &strip).ok()?.into()))
            }
            Self::HalfSpace(normal) => {
                let normal = Vector3::from(normal.map(f64::from));
                Shape::half_space(Unit::try_new(normal, 0.5)?).ok()
            }
        }
    }
}

/// A body of one or two parts at a pose.
#[derive(Debug, Clone, Arbitrary)]
pub struct BodySketch {
    first: ShapeSketch,
    second: Option<(ShapeSketch, PoseSketch)>,
    pose: PoseSketch,
}

impl BodySketch {
    /// The body and its pose; `None` where there is no such body.
    #[must_use]
    pub fn body(&self, name: &str) -> Option<(Body, Isometry3<f64>)> {
        let mut parts = vec![Part::centred(self.first.shape()?)];
        if let Some((shape, pose)) = &self.second {
            parts.push(Part { shape: shape.shape()?, body_from_shape: pose.pose() });
        }
        Some((Body::new(name, parts).ok()?, self.pose.pose()))
    }
}
