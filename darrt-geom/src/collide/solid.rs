//! One convex solid (or mesh) of a body as the checker sees it: a kind, a box, a ball.

use crate::batch::PlacedBox;
use crate::body::Part;
use crate::body_set::BodyIndex;
use crate::convert::{self, ParryShape};
use crate::shape::Shape;
use nalgebra::{Isometry3, Matrix3, Point3, Unit, Vector3};

/// What a solid is, as far as closed forms exist.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Kind {
    /// The box itself.
    Cuboid,
    /// The ball itself.
    Sphere,
    /// A cylinder along the box's z: radius and half height.
    Cylinder(f64, f64),
    /// A capsule along the box's z: radius and half height of the segment.
    Capsule(f64, f64),
    /// Something inside the box.
    Wrapped,
}

/// A bounded part of a registered body.
#[derive(Debug, Clone)]
pub(super) struct Solid {
    pub(super) body: BodyIndex,
    pub(super) kind: Kind,
    /// Half edge lengths of the shape's own box.
    pub(super) half: Vector3<f64>,
    /// Radius of a ball around the shape with the box's centre.
    pub(super) radius: f64,
    /// Centre of the box in the body's frame.
    pub(super) centre: Point3<f64>,
    /// Axes of the box in the body's frame, as columns; `None` when they are the body's.
    axes: Option<Matrix3<f64>>,
    pub(super) shape: Shape,
    pub(super) parry: ParryShape,
    pub(super) body_from_shape: Isometry3<f64>,
}

impl Solid {
    /// A bounded part.
    pub(super) fn new(body: BodyIndex, part: &Part) -> Self {
        let (low, high) = part.shape.local_aabb();
        let (centre, radius) = part.shape.bounding_sphere();
        let kind = match &part.shape {
            Shape::Cuboid { .. } => Kind::Cuboid,
            Shape::Sphere { .. } => Kind::Sphere,
            Shape::Cylinder { radius, half_height } => Kind::Cylinder(*radius, *half_height),
            Shape::Capsule { radius, half_height } => Kind::Capsule(*radius, *half_height),
            Shape::ConvexHull(_) | Shape::Mesh(_) | Shape::HalfSpace { .. } => Kind::Wrapped,
        };
        let turned = part.body_from_shape.rotation.angle() > 0.0;
        Self {
            body,
            kind,
            half: (high - low) / 2.0,
            radius,
            centre: part.body_from_shape * centre,
            axes: turned.then(|| part.body_from_shape.rotation.to_rotation_matrix().into_inner()),
            parry: convert::shape(&part.shape),
            shape: part.shape.clone(),
            body_from_shape: part.body_from_shape,
        }
    }

    /// The box in the world, for a body with these axes (columns) and origin.
    #[inline]
    pub(super) fn placed(&self, axes: &Matrix3<f64>, origin: &Vector3<f64>) -> PlacedBox {
        PlacedBox {
            centre: carried(axes, origin, &self.centre),
            axes: self.axes.as_ref().map_or(*axes, |own| turned(axes, own)),
            half: self.half,
        }
    }
}

/// A point of a body with these axes (columns) and origin, in the world.
// OPTIMIZATION: written out, here and below; the general product is a loop over columns that is not inlined everywhere.
#[inline]
pub(super) fn carried(axes: &Matrix3<f64>, origin: &Vector3<f64>, p: &Point3<f64>) -> Vector3<f64> {
    let row = |i: usize| origin[i] + (axes[(i, 0)] * p.x + axes[(i, 1)] * p.y + axes[(i, 2)] * p.z);
    Vector3::new(row(0), row(1), row(2))
}

/// The product of two rotations.
#[inline]
fn turned(axes: &Matrix3<f64>, own: &Matrix3<f64>) -> Matrix3<f64> {
    let entry =
        |i: usize, k: usize| axes[(i, 0)] * own[(0, k)] + axes[(i, 1)] * own[(1, k)] + axes[(i, 2)] * own[(2, k)];
    Matrix3::new(
        entry(0, 0),
        entry(0, 1),
        entry(0, 2),
        entry(1, 0),
        entry(1, 1),
        entry(1, 2),
        entry(2, 0),
        entry(2, 1),
        entry(2, 2),
    )
}

/// A half space of a fixed body, in the world.
#[derive(Debug, Clone)]
pub(super) struct Plane {
    pub(super) body: BodyIndex,
    pub(super) normal: Unit<Vector3<f64>>,
    /// The solid is `normal . p <= offset`.
    pub(super) offset: f64,
    pub(super) shape: Shape,
    pub(super) world_from_shape: Isometry3<f64>,
}

impl Plane {
    /// The half space with own outward `normal`, at a pose.
    pub(super) fn new(
        body: BodyIndex,
        normal: &Unit<Vector3<f64>>,
        world_from_shape: Isometry3<f64>,
        shape: &Shape,
    ) -> Self {
        let normal = world_from_shape * normal;
        let offset = normal.dot(&world_from_shape.translation.vector);
        Self { body, normal, offset, shape: shape.clone(), world_from_shape }
    }

    /// Signed height of a placed solid's lowest point over the plane: exact for the kinds with a closed form, a lower bound for
    /// the rest.
    pub(super) fn height(&self, solid: &Solid, placed: &PlacedBox) -> f64 {
        let n = placed.axes.tr_mul(&self.normal);
        let down = match solid.kind {
            Kind::Cuboid | Kind::Wrapped => solid.half.dot(&n.abs()),
            Kind::Sphere => solid.radius,
            Kind::Cylinder(radius, half_height) => radius * n.x.hypot(n.y) + half_height * n.z.abs(),
            Kind::Capsule(radius, half_height) => radius + half_height * n.z.abs(),
        };
        self.normal.dot(&placed.centre) - self.offset - down
    }
}
