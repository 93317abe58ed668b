//! A table-top world in code: tables, what stands in the room, objects, and where everything is at the start.

use std::sync::Arc;

use darrt_core::domain::Domain as _;
use darrt_core::error::Error;
use darrt_core::state::State;
use darrt_geom::body::Body;
use darrt_geom::error::GeomError;
use darrt_geom::scene::FixedBody;
use darrt_geom::shape::Shape;
use darrt_geom::support::SupportSurface;
use nalgebra::{Isometry3, Point2, Vector2, Vector3};

use super::{ActionSettings, Movable, ObjectFriction, Support, Tabletop, TabletopState};
use crate::error::PrimitiveError;
use crate::manipulator::{Configuration, Manipulator};
use crate::mobile_arm_space::MobileArmSpace;
use crate::mode::{Mode, SurfaceId};
use crate::object_space::{ObjectSpace, ObjectSpaceParts};
use crate::push::edge_stop::RimReach;

/// How far the base may go beyond the surfaces unless something else is said, metres.
const AROUND_M: f64 = 2.0;
/// How far objects may be carried beyond and above the surfaces unless something else is said, metres.
const BESIDE_M: f64 = 1.0;
/// Thickness of the top of a table, metres.
const TOP_M: f64 = 0.04;
/// Share of object samples that stand on a surface.
const SURFACE_SHARE: f64 = 0.7;

/// What is wrong with a world.
#[derive(Debug, thiserror::Error)]
pub enum BuildError {
    /// A shape, a surface, or two bodies of one name.
    #[error(transparent)]
    Geometry(#[from] GeomError),
    /// A number of a space.
    #[error(transparent)]
    Parameter(#[from] Error),
    /// A number of an action, or a name that nothing answers to.
    #[error(transparent)]
    Primitive(#[from] PrimitiveError),
}

/// Puts a [`Tabletop`] and its initial state together.
///
/// Metres and radians in the frame of the world, z up. The first error is kept, and said by [`build`](Self::build).
///
/// # Example
/// ```
/// # #[cfg(feature = "testing")] {
/// use darrt_geom::shape::Shape;
/// use darrt_primitives::grasp::footprint::Footprint;
/// use darrt_primitives::grasp::{Grip, overhead::OverheadGrasps};
/// use darrt_primitives::manipulator::Configuration;
/// use darrt_primitives::tabletop::Movable;
/// use darrt_primitives::tabletop::builder::TabletopBuilder;
/// use darrt_primitives::testing::gantry::{Gantry, motion};
///
/// let (radius, half_height) = (0.04, 0.05);
/// let grip = Grip { open_gap: 0.095, tip_ahead: 0.03, ..Grip::default() };
/// let grasps = OverheadGrasps::new(Footprint::Disc { radius }, 2.0 * half_height, 0.03, grip)?;
/// let tin = Movable::new("tin", Shape::cylinder(radius, half_height)?)?.grasped_by(grasps);
///
/// let start = Configuration { base: [-1.0, 0.0, 0.0], arm: motion::pointing_down(0.0, 0.0, 1.4, 0.0) };
/// let (world, state) = TabletopBuilder::new(Gantry::new()?, start)
///     .table("left table", [-0.5, 0.0], [0.8, 1.2], 0.7)
///     .table("right table", [0.5, 0.0], [0.8, 1.2], 0.7)
///     .object(tin, "left table", [-0.6, 0.2], 0.0)
///     .build()?;
/// assert_eq!((world.movables().len(), world.supports().len()), (1, 2));
/// assert!((state.objects[0].translation.z - 0.75).abs() < 1e-12);
/// # }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct TabletopBuilder<M: Manipulator> {
    robot: M,
    start: Configuration<M::Joints>,
    base: Option<[[f64; 2]; 2]>,
    positions: Option<[[f64; 3]; 2]>,
    supports: Vec<Support>,
    fixed: Vec<FixedBody>,
    objects: Vec<Placed>,
    settings: ActionSettings<M::Joints>,
    error: Option<BuildError>,
}

/// An object, and where it stands at the start.
#[derive(Debug)]
struct Placed {
    movable: Movable,
    surface: SurfaceId,
    at: Point2<f64>,
    yaw_rad: f64,
}

impl<M: Manipulator> TabletopBuilder<M> {
    /// An empty room with `robot` at `start`.
    pub fn new(robot: M, start: Configuration<M::Joints>) -> Self {
        let settings = ActionSettings::for_robot(&robot);
        let (supports, fixed, objects) = (Vec::new(), Vec::new(), Vec::new());
        Self { robot, start, base: None, positions: None, supports, fixed, objects, settings, error: None }
    }

    /// Where the base may be. Left out: within 2 m of the surfaces.
    #[must_use]
    pub fn base_within(mut self, lower: [f64; 2], upper: [f64; 2]) -> Self {
        self.base = Some([lower, upper]);
        self
    }

    /// Where the centres of objects may be. Left out: from the floor to 1 m above the highest surface, within 1 m of them all.
    #[must_use]
    pub fn objects_within(mut self, lower: [f64; 3], upper: [f64; 3]) -> Self {
        self.positions = Some([lower, upper]);
        self
    }

    /// A table: a top 4 cm thick whose upper side is a surface at `height_m`, with nothing under it.
    #[must_use]
    pub fn table(mut self, name: &str, centre: [f64; 2], size: [f64; 2], height_m: f64) -> Self {
        let added = (|| {
            let [x, y] = size;
            let surface = SupportSurface::rectangle(name, Point2::from(centre), Vector2::new(x, y), 0.0, height_m)?;
            let top = Body::single(name, Shape::cuboid(Vector3::new(x, y, TOP_M) / 2.0)?)?;
            let world_from_body = Isometry3::translation(centre[0], centre[1], height_m - TOP_M / 2.0);
            Ok::<_, GeomError>((surface, FixedBody { body: top, world_from_body }))
        })();
        match added {
            Ok((surface, top)) => {
                self.fixed.push(top);
                self.support(surface, &[name])
            }
            Err(error) => self.failed(error),
        }
    }

    /// A surface of any outline, and the names of the obstacles whose tops it is, which what stands on it touches.
    #[must_use]
    pub fn support(mut self, surface: SupportSurface, bodies: &[&str]) -> Self {
        self.supports.push(Support { surface, bodies: bodies.iter().map(|name| Arc::from(*name)).collect() });
        self
    }

    /// Something of one shape that does not move.
    #[must_use]
    pub fn obstacle(self, name: &str, shape: Shape, world_from_body: Isometry3<f64>) -> Self {
        match Body::single(name, shape) {
            Ok(body) => self.fixed(FixedBody { body, world_from_body }),
            Err(error) => self.failed(error),
        }
    }

    /// Something of any number of shapes that does not move.
    #[must_use]
    pub fn fixed(mut self, body: FixedBody) -> Self {
        self.fixed.push(body);
        self
    }

    /// An object that stands on a surface at the start; `at` is the place of its centre. It may stand on every surface that
    /// the world has in the end, unless [`Movable::surfaces`] names some.
    #[must_use]
    pub fn object(mut self, movable: Movable, surface: &str, at: [f64; 2], yaw_rad: f64) -> Self {
        match self.supports.iter().position(|support| support.surface.name() == surface) {
            Some(index) => {
                let surface = SurfaceId::new(index);
                self.objects.push(Placed { movable, surface, at: Point2::from(at), yaw_rad });
                self
            }
            None => self.failed(PrimitiveError::Unknown { what: "surface", name: surface.to_owned() }),
        }
    }

    /// Changes the parameters of the actions; at first they are those of [`ActionSettings::for_robot`].
    #[must_use]
    pub fn with_settings(mut self, change: impl FnOnce(&mut ActionSettings<M::Joints>)) -> Self {
        change(&mut self.settings);
        self
    }

    fn failed(mut self, error: impl Into<BuildError>) -> Self {
        self.error.get_or_insert(error.into());
        self
    }

    /// The domain and its initial state: the hand empty, every object upright where it was put.
    ///
    /// # Errors
    /// [`BuildError`] with the first thing that is wrong: a shape, a number, a name used twice or by nothing.
    pub fn build(self) -> Result<(Tabletop<M>, TabletopState<M>), BuildError> {
        if let Some(error) = self.error {
            return Err(error);
        }
        let surfaces: Vec<SupportSurface> = self.supports.iter().map(|support| support.surface.clone()).collect();
        let [low, high] = extent(&surfaces);
        let [lower, upper] = self.base.unwrap_or_else(|| [low.map(|x| x - AROUND_M), high.map(|x| x + AROUND_M)]);
        let space = MobileArmSpace::new(lower, upper, self.robot.limits(), self.robot.joint_weights_m())?;
        let top_m = surfaces.iter().map(SupportSurface::height).fold(0.0, f64::max);
        let positions = self.positions.unwrap_or_else(|| {
            let ([x0, y0], [x1, y1]) = (low.map(|x| x - BESIDE_M), high.map(|x| x + BESIDE_M));
            [[x0, y0, 0.0], [x1, y1, top_m + BESIDE_M]]
        });
        let mode = Mode::resting(self.objects.iter().map(|object| object.surface), self.settings.travel_gap_m);
        let mut places = Vec::with_capacity(self.objects.len());
        let mut objects = Vec::with_capacity(self.objects.len());
        for Placed { mut movable, surface, at, yaw_rad } in self.objects {
            if movable.surfaces.is_empty() {
                movable.surfaces = (0..surfaces.len()).map(SurfaceId::new).collect();
            }
            let standing = movable.surfaces.iter().filter_map(|id| surfaces.get(id.index()).cloned());
            let space = ObjectSpace::new(ObjectSpaceParts {
                lower: positions[0],
                upper: positions[1],
                is_round: movable.round_radius_m.is_some(),
                metres_per_rad: movable.round_radius_m.unwrap_or(movable.reach_m),
                half_height_m: movable.half_height_m,
                surfaces: standing.collect(),
                surface_share: SURFACE_SHARE,
                edge_margin_m: self.settings.safety.edge_margin_m,
            })?;
            objects.push((space, movable));
            places.push((surface, at, yaw_rad));
        }
        let world = Tabletop::new(Arc::new(self.robot), space, objects, self.supports, &self.fixed, self.settings)?;
        let standing = places.iter().zip(world.objects()).filter_map(|((surface, at, yaw_rad), space)| {
            world.surface(*surface).map(|surface| space.standing(surface, at, *yaw_rad))
        });
        let state = State { robot: self.start, objects: standing.collect(), mode };
        Ok((world, state))
    }
}

/// The corners of the box around all surfaces; the origin if there are none.
fn extent(surfaces: &[SupportSurface]) -> [[f64; 2]; 2] {
    let bounds = surfaces.iter().map(SupportSurface::bounds);
    bounds
        .map(|(low, high)| [[low.x, low.y], [high.x, high.y]])
        .reduce(|[a, b], [c, d]| [[a[0].min(c[0]), a[1].min(c[1])], [b[0].max(d[0]), b[1].max(d[1])]])
        .unwrap_or([[0.0; 2]; 2])
}

impl Movable {
    /// An object of one shape, whose frame is the shape's, z up when it stands: 0.5 kg, friction 0.3 with the table and 0.4
    /// with the fingers, pushable if it is round, allowed on every surface, lifted by 0.05 to 0.1 m, free to lean, and
    /// without a grasp.
    ///
    /// # Errors
    /// [`GeomError`] for a shape that cannot be moved.
    pub fn new(name: &str, shape: Shape) -> Result<Self, GeomError> {
        let round_radius_m = match shape {
            Shape::Cylinder { radius, .. } | Shape::Capsule { radius, .. } | Shape::Sphere { radius, .. } => {
                Some(radius)
            }
            _ => None,
        };
        let mut movable = Self::of_body(Body::single(name, shape)?);
        movable.round_radius_m = round_radius_m;
        movable.is_pushable = round_radius_m.is_some();
        Ok(movable)
    }

    /// [`new`](Self::new) for a body of several shapes: not round, not pushable.
    pub fn of_body(body: Body) -> Self {
        let reach_m = body.parts.iter().fold(0.0_f64, |most, part| {
            let (centre, radius) = part.shape.bounding_sphere();
            most.max((part.body_from_shape * centre).coords.norm() + radius)
        });
        Self {
            half_height_m: -body.local_aabb().0.z,
            body,
            round_radius_m: None,
            reach_m,
            is_pushable: false,
            surfaces: smallvec::SmallVec::new(),
            grasps: Vec::new(),
            rim: RimReach::default(),
            lift_m: [0.05, 0.1],
            mass_kg: 0.5,
            friction: ObjectFriction { table: 0.3, fingers: 0.4 },
            max_tilt_rad: std::f64::consts::PI,
            brinks: Vec::new(),
        }
    }

    /// The same with one more family of grasps.
    #[must_use]
    pub fn grasped_by(mut self, family: impl crate::grasp::GraspFamily + 'static) -> Self {
        self.grasps.push(Box::new(family));
        self
    }
}

#[cfg(all(test, feature = "testing"))]
mod tests;
