//! Single solids at poses: a quick bound that says "certainly apart", and the exact answer of the oracle.

use std::sync::Arc;

use darrt_geom::oracle::{self, PosedBody};
use darrt_geom::{Body, GeomError, Part, Shape};
use nalgebra::{Isometry3, Point3, Vector3};

/// A solid in its own frame with simple shapes around it.
#[derive(Debug, Clone)]
pub(super) struct Solid {
    /// The solid.
    pub(super) body: Body,
    centre: Point3<f64>,
    pub(super) radius: f64,
    low: Point3<f64>,
    high: Point3<f64>,
}

/// What the oracle says about two solids.
#[derive(Debug, Clone, Copy)]
pub(super) struct Answer {
    /// Metres, 0 when they touch or overlap.
    pub(super) distance: f64,
    /// Never more than the true distance.
    pub(super) lower: f64,
    /// The unit direction from the first to the second across which `lower` was measured, world; zero if there is none.
    pub(super) across: Vector3<f64>,
    pub(super) intersects: bool,
    /// A point in both or between them, world.
    pub(super) place: Point3<f64>,
}

impl Solid {
    /// A solid called `name` in messages.
    pub(super) fn new(name: &Arc<str>, shape: Shape) -> Result<Self, GeomError> {
        Ok(Self::of(Body::single(Arc::clone(name), shape)?))
    }

    /// The solid of a body, which may have several parts.
    pub(super) fn of(body: Body) -> Self {
        let (low, high) = body.local_aabb();
        let (centre, radius) = match &body.parts[..] {
            [part] if part.body_from_shape == Isometry3::identity() => part.shape.bounding_sphere(),
            parts => {
                let centre = nalgebra::center(&low, &high);
                let reaches = parts.iter().map(|part| {
                    let (middle, radius) = part.shape.bounding_sphere();
                    (part.body_from_shape * middle - centre).norm() + radius
                });
                (centre, reaches.fold(0.0, f64::max))
            }
        };
        Self { body, centre, radius, low, high }
    }

    /// How far the solid reaches along a direction of its own frame.
    fn extent(&self, direction: &Vector3<f64>) -> f64 {
        let of_part = |part: &Part| {
            let local = part.body_from_shape.inverse_transform_vector(direction);
            direction.dot(&part.body_from_shape.translation.vector) + part.shape.support_extent(&local)
        };
        self.body.parts.iter().map(of_part).reduce(f64::max).unwrap_or(f64::INFINITY)
    }

    pub(super) fn name(&self) -> &str {
        &self.body.name
    }

    /// Its shape, or that of its first part.
    pub(super) fn shape(&self) -> Option<&Shape> {
        self.body.parts.first().map(|part| &part.shape)
    }

    /// World centre of the ball around it.
    pub(super) fn world_centre(&self, world_from_solid: &Isometry3<f64>) -> Point3<f64> {
        world_from_solid * self.centre
    }

    /// How far from its own frame's origin it reaches, metres.
    pub(super) fn reach(&self) -> f64 {
        self.centre.coords.norm() + self.radius
    }

    /// Distance from a point of the own frame to the box around the solid.
    fn beyond_box(&self, p: &Point3<f64>) -> f64 {
        let beside = (self.low - p).sup(&(p - self.high));
        beside.sup(&Vector3::zeros()).norm()
    }
}

/// A solid at a pose, with what is asked for often.
#[derive(Debug, Clone, Copy)]
pub(super) struct Placed<'a> {
    pub(super) solid: &'a Solid,
    pub(super) world_from_solid: &'a Isometry3<f64>,
    /// See [`Solid::world_centre`].
    pub(super) centre: Point3<f64>,
}

impl Placed<'_> {
    /// Distance from a world point to the box around the solid.
    fn beyond_box(&self, p: &Point3<f64>) -> f64 {
        self.solid.beyond_box(&self.world_from_solid.inverse_transform_point(p))
    }
}

/// A lower bound of the distance between two solids: ball to ball, and each ball to the other's box. May be negative.
pub(super) fn lower_bound(a: &Placed<'_>, b: &Placed<'_>) -> f64 {
    let (solid_a, solid_b) = (a.solid, b.solid);
    if let Some(Shape::HalfSpace { normal, .. }) = solid_b.shape() {
        return normal.dot(&b.world_from_solid.inverse_transform_point(&a.centre).coords) - solid_a.radius;
    }
    let balls = (a.centre - b.centre).norm() - solid_a.radius - solid_b.radius;
    if balls > 0.0 {
        return balls;
    }
    let small_to_large = b.beyond_box(&a.centre) - solid_a.radius;
    if small_to_large > 0.0 {
        return small_to_large;
    }
    a.beyond_box(&b.centre) - solid_b.radius
}

/// A lower bound of the distance between two solids: the gap between them along a unit direction from `a` to `b` (world).
/// Whatever the direction, a plane across it lies between them if it is positive.
pub(super) fn gap_across(a: &Placed<'_>, b: &Placed<'_>, across: &Vector3<f64>) -> f64 {
    let extent = |placed: &Placed<'_>, direction: &Vector3<f64>| {
        let local = placed.world_from_solid.inverse_transform_vector(direction);
        direction.dot(&placed.world_from_solid.translation.vector) + placed.solid.extent(&local)
    };
    -extent(b, &-across) - extent(a, across)
}

/// The oracle's answer about two solids.
pub(super) fn exact(
    a: &Solid,
    world_from_a: &Isometry3<f64>,
    b: &Solid,
    world_from_b: &Isometry3<f64>,
) -> Result<Answer, GeomError> {
    let bodies = [
        PosedBody { body: &a.body, world_from_body: *world_from_a },
        PosedBody { body: &b.body, world_from_body: *world_from_b },
    ];
    let found = oracle::nearest(&bodies, &|_, _| false)?;
    // Two bodies are one pair, so there is always an answer.
    let place = world_from_a * a.centre;
    let touching = Answer { distance: 0.0, lower: 0.0, across: Vector3::zeros(), intersects: true, place };
    Ok(found.map_or(touching, |f| Answer {
        distance: f.distance,
        lower: f.lower,
        across: f.across,
        intersects: f.intersects,
        place: f.place,
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::UnitQuaternion;
    use rand::{RngExt as _, SeedableRng as _};

    #[test]
    fn the_bound_never_exceeds_the_distance() {
        let solid = |shape| Solid::new(&Arc::from("solid"), shape).unwrap();
        let solids = [
            solid(Shape::cuboid(Vector3::new(0.4, 0.3, 0.02)).unwrap()),
            solid(Shape::cylinder(0.14, 0.01).unwrap()),
            solid(Shape::sphere(0.1).unwrap()),
            solid(Shape::half_space(Vector3::z_axis()).unwrap()),
        ];
        let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(5);
        let mut pose = || {
            let mut number = |most: f64| rng.random_range(-most..most);
            let at = Vector3::new(number(0.7), number(0.7), number(0.7));
            let turn = UnitQuaternion::from_euler_angles(number(3.0), number(1.5), number(3.0));
            Isometry3::from_parts(at.into(), turn)
        };
        let mut earlier = Vector3::z();
        for _ in 0..300 {
            for a in &solids[..3] {
                for b in &solids {
                    let (at_a, at_b) = (pose(), pose());
                    let placed_a = Placed { solid: a, world_from_solid: &at_a, centre: a.world_centre(&at_a) };
                    let placed_b = Placed { solid: b, world_from_solid: &at_b, centre: b.world_centre(&at_b) };
                    let bound = lower_bound(&placed_a, &placed_b);
                    let found = exact(a, &at_a, b, &at_b).unwrap();
                    assert!(bound <= found.distance + 1e-9, "{bound} {found:?}");
                    // Also across the direction of an earlier answer, which is that of other poses here.
                    for direction in [found.across, earlier] {
                        let gap = gap_across(&placed_a, &placed_b, &direction);
                        assert!(gap <= found.distance + 1e-9, "{gap} {found:?}");
                    }
                    earlier = found.across;
                }
            }
        }
    }
}
