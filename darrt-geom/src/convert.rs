//! The only file where nalgebra (our surface) meets glam (inside parry).
//!
//! Two conventions differ and are translated here: a parry cylinder lies along local y, ours along local z; and a parry
//! pose is built from parts because its fields are not all public on every scalar type.

use crate::shape::Shape;
use nalgebra::{Isometry3, Point3, Vector3};
use parry3d_f64::math::{Pose, Rotation, Vector};
use parry3d_f64::shape::SharedShape;
use std::f64::consts::FRAC_1_SQRT_2;

/// A vector or point for parry.
pub(crate) fn vector(v: &Vector3<f64>) -> Vector {
    Vector::new(v.x, v.y, v.z)
}

/// A point from parry.
pub(crate) fn point_from(v: Vector) -> Point3<f64> {
    Point3::new(v.x, v.y, v.z)
}

/// A pose for parry.
pub(crate) fn pose(iso: &Isometry3<f64>) -> Pose {
    let q = &iso.rotation;
    Pose::from_parts(vector(&iso.translation.vector), Rotation::from_xyzw(q.i, q.j, q.k, q.w))
}

/// A shape as parry sees it, with the pose of parry's frame in ours.
#[derive(Clone)]
pub(crate) struct ParryShape {
    pub(crate) shape: SharedShape,
    pub(crate) shape_from_parry: Pose,
}

impl std::fmt::Debug for ParryShape {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ParryShape").field("type", &self.shape.shape_type()).finish_non_exhaustive()
    }
}

/// `shape` for parry; hulls and meshes share their data.
pub(crate) fn shape(shape: &Shape) -> ParryShape {
    let mut shape_from_parry = Pose::IDENTITY;
    let shape = match shape {
        Shape::Cuboid { half_extents } => SharedShape::cuboid(half_extents.x, half_extents.y, half_extents.z),
        Shape::Sphere { radius } => SharedShape::ball(*radius),
        Shape::Cylinder { radius, half_height } => {
            // A quarter turn about x carries parry's axis (y) to ours (z).
            shape_from_parry = Pose::from_rotation(Rotation::from_xyzw(FRAC_1_SQRT_2, 0.0, 0.0, FRAC_1_SQRT_2));
            SharedShape::cylinder(*half_height, *radius)
        }
        Shape::Capsule { radius, half_height } => SharedShape::capsule_z(*half_height, *radius),
        Shape::ConvexHull(hull) => hull.parry().clone(),
        Shape::Mesh(mesh) => mesh.parry().clone(),
        Shape::HalfSpace { normal } => SharedShape::halfspace(vector(normal)),
    };
    ParryShape { shape, shape_from_parry }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::UnitQuaternion;

    #[test]
    fn poses_act_alike_on_both_sides() {
        let iso = Isometry3::from_parts(
            nalgebra::Translation3::new(0.3, -1.2, 2.0),
            UnitQuaternion::from_euler_angles(0.4, -0.7, 1.9),
        );
        let p = Point3::new(0.5, 0.25, -3.0);
        let there = point_from(pose(&iso) * vector(&p.coords));
        assert!((there - iso * p).norm() < 1e-14);
    }

    #[test]
    fn cylinders_and_capsules_stand_along_z() {
        for shape_ in [Shape::cylinder(0.1, 0.5), Shape::capsule(0.1, 0.4)] {
            let parry = shape(&shape_.unwrap());
            let aabb = parry.shape.compute_aabb(&parry.shape_from_parry);
            assert!((aabb.maxs.z - 0.5).abs() < 1e-9 && (aabb.maxs.x - 0.1).abs() < 1e-9);
            assert!((aabb.mins.z + 0.5).abs() < 1e-9 && (aabb.mins.y + 0.1).abs() < 1e-9);
        }
    }
}
