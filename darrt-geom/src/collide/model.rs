//! Building a collision model.

use super::solid::{Plane, Solid};
use super::{CollisionModel, Poses, Registered};
use crate::batch::{self, BallBatch, BoxBatch, PlacedBox};
use crate::body::Body;
use crate::body_set::{BodyIndex, BodySet, FIRST_OF_CROWD, MAXIMUM_BODIES};
use crate::check;
use crate::error::GeomError;
use crate::shape::Shape;
use nalgebra::{Isometry3, Matrix3, Point3, Vector3};
use std::collections::BTreeSet;
use std::sync::Arc;

/// Collects the bodies and the disabled pairs of a [`CollisionModel`].
///
/// Bodies get their [`BodyIndex`] in order of registration, fixed and moving ones alike.
#[derive(Debug, Clone, Default)]
pub struct CollisionModelBuilder {
    bodies: Vec<Registered>,
    solids: Vec<Solid>,
    planes: Vec<Plane>,
    disabled: BTreeSet<(BodyIndex, BodyIndex)>,
    names: BTreeSet<Arc<str>>,
}

impl CollisionModelBuilder {
    /// Adds a body that never moves.
    ///
    /// # Errors
    /// When the body or the pose is unfit (see [`Body::check`]), the name is taken, or there are already
    /// [`MAXIMUM_BODIES`] bodies.
    pub fn add_fixed(&mut self, body: &Body, world_from_body: &Isometry3<f64>) -> Result<BodyIndex, GeomError> {
        check::pose(format_args!("pose of `{}`", body.name), world_from_body)?;
        self.add(body, Some(*world_from_body))
    }

    /// Adds a body that gets its pose before each query.
    ///
    /// # Errors
    /// As [`Self::add_fixed`], and when the body is not bounded, or [`FIRST_OF_CROWD`] bodies are there already.
    pub fn add_moving(&mut self, body: &Body) -> Result<BodyIndex, GeomError> {
        if !body.is_bounded() {
            return Err(GeomError::UnboundedMoving { name: body.name.to_string() });
        }
        check::count("bodies up to the last one that moves", self.bodies.len() + 1, 0, FIRST_OF_CROWD)?;
        self.add(body, None)
    }

    /// Never tests this pair (order does not matter); for contacts that last only a while use
    /// [`crate::AllowedContacts`].
    ///
    /// # Errors
    /// When one of them is not registered, or one of the crowd, see [`FIRST_OF_CROWD`].
    pub fn disable(&mut self, a: BodyIndex, b: BodyIndex) -> Result<(), GeomError> {
        for body in [a, b] {
            if body.get() >= self.bodies.len() {
                return Err(GeomError::UnknownIndex {
                    name: "body of a disabled pair".to_owned(),
                    index: body.get(),
                    count: self.bodies.len(),
                });
            }
            check::count("bodies up to one of a disabled pair", body.get() + 1, 0, FIRST_OF_CROWD)?;
        }
        self.disabled.insert((a.min(b), a.max(b)));
        Ok(())
    }

    /// The finished model.
    pub fn build(self) -> CollisionModel {
        let Self { mut bodies, solids, planes, disabled, .. } = self;
        let indices: Vec<BodyIndex> = (0_u16..).map(BodyIndex::new).take(bodies.len()).collect();
        let moves = |index: &BodyIndex| bodies.get(index.get()).is_some_and(|body| body.fixed.is_none());
        let moving: BodySet = indices.iter().copied().filter(moves).collect();
        for a in moving.iter() {
            // A pair of two that move comes once.
            for &b in indices.iter().filter(|b| **b > a || !moving.contains(**b)) {
                if disabled.contains(&(a.min(b), a.max(b))) {
                    continue;
                }
                for (body, partner) in [(a, b), (b, a)] {
                    if let Some(registered) = bodies.get_mut(body.get()) {
                        registered.partners.insert(partner);
                    }
                }
            }
        }
        let nowhere = PlacedBox { centre: Vector3::zeros(), axes: Matrix3::identity(), half: Vector3::zeros() };
        let initial = Poses {
            world_from_body: vec![Isometry3::identity(); bodies.len()],
            // Only those that move are asked for.
            balls: BallBatch::new(&bodies.iter().take(FIRST_OF_CROWD).map(|body| body.radius).collect::<Vec<_>>()),
            placed: vec![nowhere; solids.len()],
            // What is fixed is placed at once.
            unsound: moving,
        };
        let mut model = CollisionModel {
            bodies,
            solids,
            planes,
            moving,
            fixed_boxes: BoxBatch::default(),
            fixed_solids: Vec::new(),
            initial,
        };
        model.place_fixed(&indices);
        model
    }

    /// Registers a body whose pose, when it has one, is checked.
    fn add(&mut self, body: &Body, fixed: Option<Isometry3<f64>>) -> Result<BodyIndex, GeomError> {
        body.check()?;
        check::count("bodies of a collision model", self.bodies.len() + 1, 0, MAXIMUM_BODIES)?;
        if !self.names.insert(Arc::clone(&body.name)) {
            return Err(GeomError::DuplicateName { what: "bodies", name: body.name.to_string() });
        }
        // Below MAXIMUM_BODIES, so it fits.
        let index = BodyIndex::new(u16::try_from(self.bodies.len()).unwrap_or(u16::MAX));
        let start = self.solids.len();
        for part in &body.parts {
            match (&part.shape, fixed) {
                (Shape::HalfSpace { normal }, Some(world_from_body)) => {
                    let world_from_shape = world_from_body * part.body_from_shape;
                    self.planes.push(Plane::new(index, normal, world_from_shape, &part.shape));
                }
                _ => self.solids.push(Solid::new(index, part)),
            }
        }
        let solids = start..self.solids.len();
        let (centre, radius) = ball_around(self.solids.get(solids.clone()).unwrap_or_default());
        self.bodies.push(Registered {
            name: Arc::clone(&body.name),
            fixed,
            solids,
            centre,
            radius,
            partners: BodySet::EMPTY,
        });
        Ok(index)
    }
}

impl CollisionModel {
    /// The same bodies, but no pair is tested that has one of these.
    #[must_use]
    pub fn without_pairs_of(&self, bodies: &BodySet) -> Self {
        let mut model = self.clone();
        for (index, registered) in self.indices().zip(&mut model.bodies) {
            let is_left_out = bodies.contains(index);
            let kept = if is_left_out { BodySet::EMPTY } else { registered.partners.difference(bodies) };
            registered.partners = kept;
        }
        model
    }

    /// Places the fixed bodies and fills the batch.
    fn place_fixed(&mut self, indices: &[BodyIndex]) {
        let mut poses = self.initial.clone();
        for &body in indices {
            let Some(registered) = self.bodies.get(body.get()) else { continue };
            if let Some(world_from_body) = registered.fixed {
                self.put(&mut poses, body, registered, &world_from_body);
                self.fixed_solids.extend(registered.solids.clone());
            }
        }
        let boxes: Vec<PlacedBox> = self.fixed_solids.iter().filter_map(|&i| poses.placed.get(i).copied()).collect();
        let order = batch::by_place(&boxes);
        self.fixed_solids = order.iter().filter_map(|&i| self.fixed_solids.get(i).copied()).collect();
        self.fixed_boxes = BoxBatch::new(&order.iter().filter_map(|&i| boxes.get(i).copied()).collect::<Vec<_>>());
        self.initial = poses;
    }
}

/// A ball around the balls of some solids, body frame.
fn ball_around(solids: &[Solid]) -> (Point3<f64>, f64) {
    let mut low = Vector3::repeat(f64::INFINITY);
    let mut high = -low;
    for solid in solids {
        let half = Vector3::repeat(solid.radius);
        low = low.inf(&(solid.centre.coords - half));
        high = high.sup(&(solid.centre.coords + half));
    }
    if solids.is_empty() {
        return (Point3::origin(), 0.0);
    }
    let centre = Point3::from((low + high) / 2.0);
    let reach = |solid: &Solid| (solid.centre - centre).norm() + solid.radius;
    (centre, solids.iter().map(reach).fold(0.0, f64::max))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::allowed::AllowedContacts;
    use crate::collide::Query;

    #[test]
    fn a_fixed_body_at_the_origin_is_in_the_way() {
        let cube = |name: &str| Body::single(Arc::from(name), Shape::cuboid(Vector3::repeat(0.5)).unwrap()).unwrap();
        let mut builder = CollisionModelBuilder::default();
        builder.add_fixed(&cube("fixed"), &Isometry3::identity()).unwrap();
        builder.add_moving(&cube("moving")).unwrap();
        let model = builder.build();
        let mut scratch = model.scratch();
        let allowed = AllowedContacts::none();
        let query = Query {
            moved: &BodySet::ALL,
            against: &BodySet::ALL,
            allowed: &allowed,
            clearance: 0.01,
            closer: &[],
            cap: 0.0,
        };
        for (x, is_clear) in [(0.9, false), (1.1, true), (0.0, false)] {
            model.set_poses(&mut scratch, &[Isometry3::translation(x, 0.0, 0.0)]);
            assert_eq!(model.is_clear(&mut scratch, &query), is_clear, "{x}");
            assert_eq!(model.lower_bound(&mut scratch, &query).is_ok(), is_clear, "{x}");
        }
    }
}
