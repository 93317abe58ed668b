//! Rigid bodies: named groups of shapes.

use crate::check;
use crate::error::GeomError;
use crate::shape::Shape;
use nalgebra::Isometry3;
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
