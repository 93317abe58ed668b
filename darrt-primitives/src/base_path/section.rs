//! Horizontal sections: what of a solid can meet something of a certain height, as an outline on the floor.

use darrt_geom::body::Part;
use darrt_geom::shape::Shape;
use nalgebra::{Isometry3, Point3, Vector2, Vector3};

use super::outline::Outline;

/// Corners of the polygon around a circle. What it adds is 2 % of the radius at most.
const CIRCLE_CORNERS: u8 = 16;

/// Axes within this sine of upright count as upright.
const UPRIGHT: f64 = 1e-9;

/// A bounded solid at a pose.
#[derive(Debug, Clone)]
pub(crate) struct Placed<'a> {
    shape: &'a Shape,
    pose: Isometry3<f64>,
    /// Lowest and highest point, metres.
    pub(crate) z_m: [f64; 2],
}

impl<'a> Placed<'a> {
    /// A part of a body at a pose. `None` for a half space.
    pub(crate) fn new(part: &'a Part, frame_from_body: &Isometry3<f64>) -> Option<Self> {
        if !part.shape.is_bounded() {
            return None;
        }
        let pose = frame_from_body * part.body_from_shape;
        let up = pose.inverse_transform_vector(&Vector3::z());
        let z = pose.translation.z;
        let z_m = [z - part.shape.support_extent(&-up), z + part.shape.support_extent(&up)];
        Some(Self { shape: &part.shape, pose, z_m })
    }

    /// Holds, seen from above, everything of the solid between these heights. Exact for boxes, hulls and upright cylinders;
    /// a little more than that for others; of a mesh the hull. `None` if nothing is there.
    pub(crate) fn section(&self, [low, high]: [f64; 2]) -> Option<Outline> {
        if self.z_m[1] < low || self.z_m[0] > high {
            return None;
        }
        let slice = Slice { low, high };
        match self.shape {
            Shape::Cuboid { half_extents, .. } => {
                let corners: [_; 8] = std::array::from_fn(|i| {
                    let sign = |bit: usize| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
                    self.point(&Point3::new(
                        sign(0) * half_extents.x,
                        sign(1) * half_extents.y,
                        sign(2) * half_extents.z,
                    ))
                });
                let edges = (0..8).flat_map(|i| [1, 2, 4].map(|bit| (i, i ^ bit))).filter(|(i, j)| i < j);
                slice.of_edges(&corners, edges)
            }
            Shape::Sphere { radius, .. } => {
                let z = self.pose.translation.z;
                let beyond = z - z.clamp(low, high);
                let radius = (radius * radius - beyond * beyond).max(0.0).sqrt();
                Outline::around(&mut vec![flat(&Point3::from(self.pose.translation.vector))], radius)
            }
            Shape::Capsule { radius, half_height, .. } => {
                let ends = [-1.0, 1.0].map(|side| self.point(&Point3::new(0.0, 0.0, side * half_height)));
                Slice { low: low - radius, high: high + radius }
                    .points(&ends, [(0, 1)])
                    .and_then(|mut points| Outline::around(&mut points, *radius))
            }
            Shape::Cylinder { radius, half_height, .. } => {
                let axis = self.pose.rotation * Vector3::z();
                if axis.x.hypot(axis.y) < UPRIGHT {
                    return Outline::around(&mut vec![flat(&Point3::from(self.pose.translation.vector))], *radius);
                }
                let around = radius / (std::f64::consts::PI / f64::from(CIRCLE_CORNERS)).cos();
                let corners: Vec<_> = (0..CIRCLE_CORNERS)
                    .flat_map(|i| {
                        let (sin, cos) = (f64::from(i) * std::f64::consts::TAU / f64::from(CIRCLE_CORNERS)).sin_cos();
                        [-1.0, 1.0].map(|side| Point3::new(around * cos, around * sin, side * half_height))
                    })
                    .map(|p| self.point(&p))
                    .collect();
                let count = corners.len();
                let edges = (0..count).map(|i| (i, (i + 2) % count)).chain((0..count / 2).map(|i| (2 * i, 2 * i + 1)));
                slice.of_edges(&corners, edges)
            }
            Shape::ConvexHull(hull) => {
                let corners: Vec<_> = hull.vertices().iter().map(|p| self.point(p)).collect();
                let edges = hull.triangles().iter().flat_map(|[a, b, c]| [(*a, *b), (*b, *c), (*c, *a)]);
                slice.of_edges(&corners, edges.map(|(a, b)| (a as usize, b as usize)))
            }
            Shape::Mesh(mesh) => {
                let mut points: Vec<_> = mesh.vertices().iter().map(|p| flat(&self.point(p))).collect();
                Outline::around(&mut points, 0.0)
            }
            _ => None,
        }
    }

    fn point(&self, p: &Point3<f64>) -> Point3<f64> {
        self.pose * p
    }
}

fn flat(p: &Point3<f64>) -> Vector2<f64> {
    Vector2::new(p.x, p.y)
}

/// Everything between two heights.
#[derive(Debug, Clone, Copy)]
struct Slice {
    low: f64,
    high: f64,
}

impl Slice {
    fn of_edges(self, corners: &[Point3<f64>], edges: impl IntoIterator<Item = (usize, usize)>) -> Option<Outline> {
        self.points(corners, edges).and_then(|mut points| Outline::around(&mut points, 0.0))
    }

    /// The ends of what lies in the slice of each edge: of a convex solid they span the section.
    fn points(
        self,
        corners: &[Point3<f64>],
        edges: impl IntoIterator<Item = (usize, usize)>,
    ) -> Option<Vec<Vector2<f64>>> {
        let mut points = Vec::with_capacity(2 * corners.len());
        for (a, b) in edges {
            let (Some(a), Some(b)) = (corners.get(a), corners.get(b)) else { continue };
            let rise = b.z - a.z;
            // Where the edge enters and leaves, as shares of its length.
            let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
            if rise == 0.0 {
                if a.z < self.low || a.z > self.high {
                    continue;
                }
            } else {
                let (first, second) = ((self.low - a.z) / rise, (self.high - a.z) / rise);
                enter = enter.max(first.min(second));
                leave = leave.min(first.max(second));
                if enter > leave {
                    continue;
                }
            }
            points.extend([enter, leave].map(|t| flat(&(a + (b - a) * t))));
        }
        (!points.is_empty()).then_some(points)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::UnitQuaternion;
    use proptest::prelude::*;

    fn shapes() -> Vec<Shape> {
        let corners = [[0.1, 0.0, -0.2], [0.0, 0.3, 0.0], [-0.2, 0.0, 0.2], [0.0, -0.1, 0.1], [0.1, 0.1, 0.3]];
        vec![
            Shape::cuboid(Vector3::new(0.1, 0.2, 0.3)).unwrap(),
            Shape::convex_hull("hull", &corners.map(Point3::from)).unwrap(),
            Shape::sphere(0.2).unwrap(),
            Shape::cylinder(0.1, 0.3).unwrap(),
            Shape::capsule(0.1, 0.3).unwrap(),
        ]
    }

    #[test]
    fn an_upright_solid_has_the_same_section_everywhere_and_none_beside() {
        let part = Part::centred(Shape::cuboid(Vector3::new(0.5, 0.25, 1.0)).unwrap());
        let placed = Placed::new(&part, &Isometry3::translation(1.0, 2.0, 3.0)).unwrap();
        assert_eq!(placed.z_m, [2.0, 4.0]);
        for slab in [[0.0, 9.0], [2.5, 2.5], [4.0, 5.0]] {
            let section = placed.section(slab).unwrap();
            assert!((section.beyond_edges(&Vector2::new(2.0, 2.0)) - 0.5).abs() < 1e-12);
            assert!((section.beyond_edges(&Vector2::new(1.0, 1.5)) - 0.25).abs() < 1e-12);
        }
        assert!(placed.section([4.1, 5.0]).is_none() && placed.section([0.0, 1.9]).is_none());
        let floor = Part::centred(Shape::half_space(Vector3::z_axis()).unwrap());
        assert!(Placed::new(&floor, &Isometry3::identity()).is_none());
    }

    proptest! {
        /// Points of the solid at these heights lie in the section; corners of the section of a box lie under such points.
        #[test]
        fn sections_hold_what_is_there_and_of_boxes_no_more(
            turn in prop::array::uniform3(-3.0_f64..3.0), low in -0.4_f64..0.3, thick in 0.0_f64..0.3,
            looks in prop::collection::vec((prop::array::uniform3(-1.0_f64..1.0), 0.0_f64..1.0), 40),
        ) {
            let pose = Isometry3::from_parts(Vector3::new(0.3, -0.2, 0.0).into(), UnitQuaternion::from_scaled_axis(turn.into()));
            for shape in shapes() {
                let part = Part::centred(shape);
                let placed = Placed::new(&part, &pose).unwrap();
                let section = placed.section([low, low + thick]);
                for pair in looks.windows(2) {
                    // Between two points of the surface.
                    let [a, b] = [0, 1].map(|i| pose * part.shape.support_point(&Vector3::from(pair[i].0)));
                    let p = a + (b - a) * pair[0].1;
                    if p.z >= low && p.z <= low + thick {
                        let section = section.as_ref().expect("there is something");
                        prop_assert!(section.beyond_edges(&flat(&p)) < 1e-9, "{} {}", part.shape.kind(), p);
                    }
                }
            }
        }
    }
}
