//! Solids as triangles, for programs that know nothing else.

use std::f64::consts::TAU;

use nalgebra::{Isometry3, Point3, Vector3};

use super::data::{PartData, ShapeData, pose_of};

/// Corners of what stands for a circle.
const CORNERS: u32 = 32;
/// Rows of a ball, or of both ends of a capsule.
const ROWS: u32 = 12;

/// Triangles, three corners each, with the normal at each corner.
#[derive(Debug, Default)]
pub(super) struct Surface {
    pub(super) corners: Vec<Point3<f64>>,
    pub(super) normals: Vec<Vector3<f64>>,
}

impl Surface {
    /// Parts of one thing, in the frame of the thing.
    pub(super) fn of(parts: &[PartData]) -> Self {
        let mut all = Self::default();
        for part in parts {
            all.add(&part.shape, &pose_of(&part.pose));
        }
        all
    }

    fn add(&mut self, shape: &ShapeData, pose: &Isometry3<f64>) {
        match shape {
            ShapeData::Box { size } => self.cuboid(pose, &(Vector3::from(*size) / 2.0)),
            ShapeData::Sphere { radius } => self.turned(pose, &round(*radius, 0.0)),
            ShapeData::Capsule { radius, length } => self.turned(pose, &round(*radius, length / 2.0)),
            ShapeData::Cylinder { radius, length } => {
                let (r, top) = (*radius, length / 2.0);
                self.turned(pose, &creased(&[[0.0, top], [r, top], [r, -top], [0.0, -top]]));
            }
            ShapeData::Lathe { profile } => self.turned(pose, &creased(profile)),
            ShapeData::Mesh { vertices, triangles } => {
                let corner = |index: &u32| {
                    let at = 3 * *index as usize;
                    let xyz: [f64; 3] = vertices.get(at..at + 3)?.try_into().ok()?;
                    Some(Point3::from(xyz))
                };
                for three in triangles.chunks_exact(3) {
                    if let [Some(a), Some(b), Some(c)] = [0, 1, 2].map(|i| three.get(i).and_then(corner)) {
                        self.flat(pose, [a, b, c]);
                    }
                }
            }
        }
    }

    /// A triangle; one without area is left out.
    fn flat(&mut self, pose: &Isometry3<f64>, corners: [Point3<f64>; 3]) {
        let [a, b, c] = corners;
        if let Some(normal) = (b - a).cross(&(c - a)).try_normalize(1e-15) {
            self.push(pose, corners, [normal; 3]);
        }
    }

    fn push(&mut self, pose: &Isometry3<f64>, corners: [Point3<f64>; 3], normals: [Vector3<f64>; 3]) {
        self.corners.extend(corners.map(|corner| pose * corner));
        self.normals.extend(normals.map(|normal| pose * normal));
    }

    fn cuboid(&mut self, pose: &Isometry3<f64>, half: &Vector3<f64>) {
        for axis in 0..3 {
            for side in [-1.0, 1.0] {
                let [n, u, v] = [0, 1, 2].map(|turn| Vector3::ith((axis + turn) % 3, 1.0));
                let corner = |a: f64, b: f64| Point3::from((n * side + u * (a * side) + v * b).component_mul(half));
                let [a, b, c, d] = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
                self.flat(pose, [a, b, c]);
                self.flat(pose, [a, c, d]);
            }
        }
    }

    /// Strips of a profile, each given by its two ends with their normals, turned about z.
    fn turned(&mut self, pose: &Isometry3<f64>, strips: &[[Ring; 2]]) {
        for [upper, lower] in strips {
            for corner in 0..CORNERS {
                let [this, next] = [corner, corner + 1].map(|i| TAU * f64::from(i) / f64::from(CORNERS));
                let [a, b, c, d] = [lower.at(this), lower.at(next), upper.at(next), upper.at(this)];
                for three in [[a, b, c], [a, c, d]] {
                    let [p, q, r] = three.map(|(corner, _)| corner);
                    if (q - p).cross(&(r - p)).norm() > 1e-15 {
                        self.push(pose, [p, q, r], three.map(|(_, normal)| normal));
                    }
                }
            }
        }
    }
}

/// A circle about z: its radius and height, and the normal of the surface there, outward and up.
#[derive(Debug, Clone, Copy)]
struct Ring {
    at: [f64; 2],
    normal: [f64; 2],
}

impl Ring {
    fn at(self, angle: f64) -> (Point3<f64>, Vector3<f64>) {
        let (sin, cos) = angle.sin_cos();
        let ([r, z], [out, up]) = (self.at, self.normal);
        (Point3::new(r * cos, r * sin, z), Vector3::new(out * cos, out * sin, up))
    }
}

/// A profile with a crease at each of its points.
fn creased(profile: &[[f64; 2]]) -> Vec<[Ring; 2]> {
    let strip = |ends: &[[f64; 2]]| {
        let [a, b] = *ends else { return None };
        let length = (b[0] - a[0]).hypot(b[1] - a[1]);
        let normal = [-(b[1] - a[1]) / length, (b[0] - a[0]) / length];
        (length > 0.0).then_some([a, b].map(|at| Ring { at, normal }))
    };
    profile.windows(2).filter_map(strip).collect()
}

/// A ball whose halves are apart by twice `half`.
fn round(radius: f64, half: f64) -> Vec<[Ring; 2]> {
    let ring = |row: u32, shift: f64| {
        let (sin, cos) = (TAU / 2.0 * f64::from(row) / f64::from(ROWS)).sin_cos();
        Ring { at: [radius * sin, radius * cos + shift], normal: [sin, cos] }
    };
    let mut rings: Vec<Ring> = (0..=ROWS / 2).map(|row| ring(row, half)).collect();
    rings.extend((ROWS / 2..=ROWS).map(|row| ring(row, -half)));
    rings.windows(2).filter_map(|two| two.try_into().ok()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of a closed surface whose triangles all look outward.
    fn volume(shape: ShapeData) -> f64 {
        let surface = Surface::of(&[PartData { shape, pose: [0.3, -0.2, 0.1, 0.6, 0.0, 0.0, 0.8] }]);
        let three = surface.corners.chunks_exact(3).zip(surface.normals.chunks_exact(3));
        let part = |(p, n): (&[Point3<f64>], &[Vector3<f64>])| {
            let across = (p[1] - p[0]).cross(&(p[2] - p[0]));
            assert!(n.iter().all(|n| (n.norm() - 1.0).abs() < 1e-9 && n.dot(&across) > 0.0));
            p[0].coords.dot(&p[1].coords.cross(&p[2].coords)) / 6.0
        };
        three.map(part).sum()
    }

    #[test]
    fn surfaces_are_closed_and_look_outward() {
        let near = |found: f64, wanted: f64| assert!((found / wanted - 1.0).abs() < 0.03, "{found}, not {wanted}");
        let pi = TAU / 2.0;
        near(volume(ShapeData::Box { size: [0.1, 0.2, 0.3] }), 0.006);
        near(volume(ShapeData::Sphere { radius: 0.5 }), pi / 6.0);
        near(volume(ShapeData::Cylinder { radius: 0.5, length: 2.0 }), pi / 2.0);
        near(volume(ShapeData::Capsule { radius: 0.5, length: 2.0 }), pi * (0.5 + 1.0 / 6.0));
        near(volume(ShapeData::Lathe { profile: vec![[0.0, 1.0], [1.0, 0.0], [0.0, 0.0]] }), pi / 3.0);
        let vertices = vec![0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
        let triangles = vec![0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3];
        near(volume(ShapeData::Mesh { vertices, triangles }), 1.0 / 6.0);
    }
}
