//! What does not move: obstacles and the surfaces things stand on.

use crate::body::Body;
use crate::check;
use crate::error::GeomError;
use crate::support::SupportSurface;
use nalgebra::Isometry3;
use std::collections::BTreeSet;

/// An obstacle: a body at a fixed pose in the world.
#[derive(Debug, Clone, PartialEq)]
pub struct FixedBody {
    /// The body.
    pub body: Body,
    /// Its pose.
    pub world_from_body: Isometry3<f64>,
}

/// The obstacles and support surfaces of a problem, checked once.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Scene {
    bodies: Vec<FixedBody>,
    surfaces: Vec<SupportSurface>,
}

impl Scene {
    /// A scene of fixed bodies and support surfaces.
    ///
    /// # Errors
    /// When a body is unfit (see [`Body::check`]), a pose is not finite or out of range, or two bodies or two surfaces
    /// share a name. A body and a surface may share one: the surface is then the top of that body.
    pub fn new(bodies: Vec<FixedBody>, surfaces: Vec<SupportSurface>) -> Result<Self, GeomError> {
        for fixed in &bodies {
            fixed.body.check()?;
            check::pose(format_args!("pose of `{}`", fixed.body.name), &fixed.world_from_body)?;
        }
        unique("bodies", bodies.iter().map(|fixed| &*fixed.body.name))?;
        unique("support surfaces", surfaces.iter().map(SupportSurface::name))?;
        Ok(Self { bodies, surfaces })
    }

    /// The obstacles, in the order given.
    pub fn bodies(&self) -> &[FixedBody] {
        &self.bodies
    }

    /// The support surfaces, in the order given.
    pub fn surfaces(&self) -> &[SupportSurface] {
        &self.surfaces
    }

    /// The obstacle of that name.
    pub fn body(&self, name: &str) -> Option<&FixedBody> {
        self.bodies.iter().find(|fixed| &*fixed.body.name == name)
    }

    /// The surface of that name.
    pub fn surface(&self, name: &str) -> Option<&SupportSurface> {
        self.surfaces.iter().find(|surface| surface.name() == name)
    }
}

/// Refuses the first name that occurs twice.
fn unique<'a>(what: &'static str, names: impl Iterator<Item = &'a str>) -> Result<(), GeomError> {
    let mut seen = BTreeSet::new();
    for name in names {
        if !seen.insert(name) {
            return Err(GeomError::DuplicateName { what, name: name.to_owned() });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::Shape;
    use nalgebra::{Point2, Vector2};

    fn ball(name: &str, x: f64) -> FixedBody {
        FixedBody {
            body: Body::single(name, Shape::sphere(0.1).unwrap()).unwrap(),
            world_from_body: Isometry3::translation(x, 0.0, 0.0),
        }
    }

    #[test]
    fn names_are_unique_and_poses_finite() {
        let table = SupportSurface::rectangle("a", Point2::origin(), Vector2::new(1.0, 1.0), 0.0, 0.7).unwrap();
        let scene = Scene::new(vec![ball("a", 0.0), ball("b", 1.0)], vec![table.clone()]).unwrap();
        assert!(scene.body("b").is_some() && scene.body("c").is_none());
        assert!(scene.surface("a").is_some() && scene.surfaces().len() == 1 && scene.bodies().len() == 2);
        let twice = Scene::new(vec![ball("a", 0.0), ball("a", 1.0)], vec![]);
        assert_eq!(twice, Err(GeomError::DuplicateName { what: "bodies", name: "a".to_owned() }));
        assert!(Scene::new(vec![], vec![table.clone(), table]).is_err());
        assert!(Scene::new(vec![ball("a", f64::NAN)], vec![]).is_err());
    }
}
