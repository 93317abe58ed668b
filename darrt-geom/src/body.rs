//! Rigid bodies: named groups of shapes.

use crate::check;
use crate::error::GeomError;
use crate::shape::Shape;
use nalgebra::{Isometry3, Point3, Vector3};
use std::sync::Arc;

/// Most parts a body may have.
pub const MAXIMUM_PARTS: usize = 4096;

/// One solid of a [`Body`].
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// The solid, in its own frame.
    pub shape: Shape,
    /// Pose of the solid's frame in the body's frame.
    pub body_from_shape: Isometry3<f64>,
}

impl Part {
    /// A solid whose frame is the body's.
    pub fn centred(shape: Shape) -> Self {
        Self { shape, body_from_shape: Isometry3::identity() }
    }

    /// The axis-aligned box in the body's frame around the box of the solid in its own.
    fn aabb(&self) -> (Point3<f64>, Point3<f64>) {
        let (low, high) = self.shape.local_aabb();
        if self.body_from_shape == Isometry3::identity() || !self.shape.is_bounded() {
            return (low, high);
        }
        let half = (high - low) / 2.0;
        let turn = self.body_from_shape.rotation.to_rotation_matrix();
        let reach = turn.matrix().abs() * half;
        let middle = self.body_from_shape * nalgebra::center(&low, &high);
        (middle - reach, middle + reach)
    }
}

/// A rigid union of solids with a name for people.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// Shown in messages; behaviour never depends on it.
    pub name: Arc<str>,
    /// The solids; at least one.
    pub parts: Vec<Part>,
}

impl Body {
    /// A checked body.
    ///
    /// # Errors
    /// See [`Body::check`].
    pub fn new(name: impl Into<Arc<str>>, parts: Vec<Part>) -> Result<Self, GeomError> {
        let body = Self { name: name.into(), parts };
        body.check()?;
        Ok(body)
    }

    /// A body of one solid whose frame is the body's.
    ///
    /// # Errors
    /// When the name is empty.
    pub fn single(name: impl Into<Arc<str>>, shape: Shape) -> Result<Self, GeomError> {
        Self::new(name, vec![Part::centred(shape)])
    }

    /// Whether every part is bounded (see [`Shape::is_bounded`]).
    pub fn is_bounded(&self) -> bool {
        self.parts.iter().all(|part| part.shape.is_bounded())
    }

    /// Corners `(minimum, maximum)` of an axis-aligned box around the body in its own frame: around the boxes of its parts.
    pub fn local_aabb(&self) -> (Point3<f64>, Point3<f64>) {
        let empty = (Point3::from(Vector3::repeat(f64::INFINITY)), Point3::from(Vector3::repeat(f64::NEG_INFINITY)));
        self.parts.iter().fold(empty, |(low, high), part| {
            let (least, most) = part.aabb();
            (low.inf(&least), high.sup(&most))
        })
    }

    /// Whether the body is fit for use; the constructors call it, and whoever takes a body calls it again because the
    /// fields are public.
    ///
    /// # Errors
    /// When the name is empty, there are no parts or more than [`MAXIMUM_PARTS`], or a part's pose is not finite, is
    /// farther than 1e4 m away, or has a quaternion whose length differs from one by more than 1e-6.
    pub fn check(&self) -> Result<(), GeomError> {
        if self.name.is_empty() {
            return Err(GeomError::EmptyName { what: "body" });
        }
        check::count(format_args!("parts of `{}`", self.name), self.parts.len(), 1, MAXIMUM_PARTS)?;
        for (i, part) in self.parts.iter().enumerate() {
            check::pose(format_args!("part {i} of `{}`", self.name), &part.body_from_shape)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_box_around_a_body_holds_all_its_parts() {
        let turned = Isometry3::rotation(Vector3::z() * std::f64::consts::FRAC_PI_2);
        let parts = vec![
            Part::centred(Shape::cuboid(Vector3::new(0.1, 0.2, 0.3)).unwrap()),
            Part {
                shape: Shape::cylinder(0.1, 0.5).unwrap(),
                body_from_shape: Isometry3::translation(0.0, 0.0, -0.4) * turned,
            },
        ];
        let (low, high) = Body::new("pair", parts).unwrap().local_aabb();
        assert!(
            (low - Point3::new(-0.1, -0.2, -0.9)).norm() < 1e-12 && (high - Point3::new(0.1, 0.2, 0.3)).norm() < 1e-12
        );
        let floor = Body::single("floor", Shape::half_space(Vector3::z_axis()).unwrap()).unwrap();
        assert_eq!(floor.local_aabb().1.x, f64::INFINITY);
    }

    #[test]
    fn bodies_are_checked() {
        let ball = Shape::sphere(0.1).unwrap();
        assert!(Body::single("ball", ball.clone()).is_ok());
        assert_eq!(Body::single("", ball.clone()), Err(GeomError::EmptyName { what: "body" }));
        assert!(Body::new("none", vec![]).is_err());
        let far = Part { shape: ball, body_from_shape: Isometry3::translation(0.0, f64::INFINITY, 0.0) };
        let message = Body::new("far", vec![far]).unwrap_err().to_string();
        assert!(message.contains("part 0 of `far`"), "{message}");
    }
}
