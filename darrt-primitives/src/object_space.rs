//! The configuration space of a movable rigid object: poses in a box, some of them standing on a surface.

use darrt_core::error::Error;
use darrt_core::space::se3::angle_between;
use darrt_core::space::{ComponentSpace, Place, Se3};
use darrt_geom::support::SupportSurface;
use nalgebra::{Isometry3, Point2, Translation3, UnitQuaternion, Vector3};
use rand::{Rng, RngExt};

/// How two poses closer than this count as one: a millimetre (the authors' near test).
pub const OBJECT_TOLERANCE_M: f64 = 1e-3;

/// Samples at an edge lie within this share of the way from there to where they would lie anywhere.
const EDGE_SHARE: f64 = 0.2;

/// Rounding that is forgiven in the distance from an edge, metres.
const ROUNDING_M: f64 = 1e-9;

/// Poses `world_from_object`. The object's frame is the centre of its shape, z up when it stands.
///
/// A sample stands on an allowed surface with probability `surface_share`, else it floats upright in the box: poses
/// on a surface have measure zero in SE(3), yet every place needs one.
#[derive(Debug, Clone)]
pub struct ObjectSpace {
    poses: Se3,
    /// Turns about the object's own z axis do not count.
    is_round: bool,
    metres_per_rad: f64,
    half_height_m: f64,
    surfaces: Vec<SupportSurface>,
    surface_share: f64,
    edge_margin_m: f64,
}

/// The parts of an [`ObjectSpace`].
#[derive(Debug, Clone)]
pub struct ObjectSpaceParts {
    /// Lower corner of the box of positions, metres.
    pub lower: [f64; 3],
    /// Upper corner.
    pub upper: [f64; 3],
    /// Do turns about its own z axis not count?
    pub is_round: bool,
    /// Metres that one radian costs: the radius of the object.
    pub metres_per_rad: f64,
    /// Height of its centre above what it stands on, metres.
    pub half_height_m: f64,
    /// The surfaces on which it may stand.
    pub surfaces: Vec<SupportSurface>,
    /// How often a sample stands on one of them, in `[0, 1]`.
    pub surface_share: f64,
    /// How far inside the edge of a surface its samples are, metres, at least 0.
    pub edge_margin_m: f64,
}

impl ObjectSpace {
    /// Checks the parts.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a number outside its range.
    pub fn new(parts: ObjectSpaceParts) -> Result<Self, Error> {
        let ObjectSpaceParts {
            lower,
            upper,
            is_round,
            metres_per_rad,
            half_height_m,
            surfaces,
            surface_share,
            edge_margin_m,
        } = parts;
        let positive =
            |name, value| darrt_core::error::in_range(name, value, f64::MIN_POSITIVE, f64::MAX, "finite and positive");
        Ok(Self {
            poses: Se3::new(lower, upper, positive("metres_per_rad", metres_per_rad)?)?,
            is_round,
            metres_per_rad,
            half_height_m: positive("half_height_m", half_height_m)?,
            surfaces,
            surface_share: darrt_core::error::in_range("surface_share", surface_share, 0.0, 1.0, "in [0, 1]")?,
            edge_margin_m: darrt_core::error::in_range("edge_margin_m", edge_margin_m, 0.0, f64::MAX, "at least 0")?,
        })
    }

    /// The box of positions.
    pub fn poses(&self) -> &Se3 {
        &self.poses
    }

    /// Do turns about its own z axis not count?
    pub fn is_round(&self) -> bool {
        self.is_round
    }

    /// The pose in which it stands on `surface` with its centre over `at`.
    pub fn standing(&self, surface: &SupportSurface, at: &Point2<f64>, yaw: f64) -> Isometry3<f64> {
        upright(Vector3::new(at.x, at.y, surface.height() + self.half_height_m), yaw)
    }

    fn random_standing(&self, rng: &mut dyn Rng, place: Place) -> Option<Isometry3<f64>> {
        // Surfaces in proportion to their area, so that all places are equally likely.
        let total: f64 = self.surfaces.iter().map(SupportSurface::area).sum();
        if total <= 0.0 {
            return None;
        }
        let mut left = rng.random_range(0.0..total);
        let surface = self.surfaces.iter().find(|s| {
            left -= s.area();
            left < 0.0
        })?;
        let mut at = surface.sample(rng, 0.0)?;
        let edge = surface.nearest_edge_point(&at);
        let spare_m = (edge.distance - self.edge_margin_m).max(0.0);
        let inside_m = match place {
            Place::SupportEdge => self.edge_margin_m + spare_m * rng.random_range(0.0..EDGE_SHARE),
            Place::OnSupport => self.edge_margin_m + spare_m,
        };
        if inside_m != edge.distance {
            at = edge.point - inside_m * edge.outward.into_inner();
            // Not where another edge is too near: in a corner, or on a board that is narrower than two margins.
            if surface.depth(&at) < self.edge_margin_m - ROUNDING_M {
                return None;
            }
        }
        let pose = self.standing(surface, &at, rng.random_range(-std::f64::consts::PI..std::f64::consts::PI));
        self.contains(&pose).then_some(pose)
    }
}

/// An upright pose.
pub fn upright(position: Vector3<f64>, yaw: f64) -> Isometry3<f64> {
    Isometry3::from_parts(Translation3::from(position), UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw))
}

/// The object's own z axis in the world: the third column of its rotation matrix.
pub(crate) fn own_axis(pose: &Isometry3<f64>) -> Vector3<f64> {
    let q = pose.rotation.quaternion();
    Vector3::new(2.0 * (q.i * q.k + q.w * q.j), 2.0 * (q.j * q.k - q.w * q.i), 1.0 - 2.0 * (q.i * q.i + q.j * q.j))
}

/// Angle between two unit vectors, from the chord between their ends: exact zero for equal ones, and cheap.
fn angle_between_axes(a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
    2.0 * (0.5 * (a - b).norm()).min(1.0).asin()
}

/// The rotation at `t` on the way from `a` to `b` of a round object: its own axis takes the shortest way, at even speed,
/// while it spins evenly about it. The shortest rotation would take the axis around a detour.
fn turned_between(a: &Isometry3<f64>, b: &Isometry3<f64>, t: f64) -> UnitQuaternion<f64> {
    let half_turn = || UnitQuaternion::from_axis_angle(&(a.rotation * Vector3::x_axis()), std::f64::consts::PI);
    let swing = UnitQuaternion::rotation_between(&own_axis(a), &own_axis(b)).unwrap_or_else(half_turn);
    let spin = (swing * a.rotation).inverse() * b.rotation;
    swing.powf(t) * a.rotation * spin.powf(t)
}

impl ComponentSpace for ObjectSpace {
    type Config = Isometry3<f64>;

    fn dimension(&self) -> usize {
        6
    }

    fn contains(&self, q: &Isometry3<f64>) -> bool {
        self.poses.contains(q)
    }

    fn distance(&self, a: &Isometry3<f64>, b: &Isometry3<f64>) -> f64 {
        let travel = (a.translation.vector - b.translation.vector).norm();
        let angle = if a.rotation == b.rotation {
            0.0
        } else if self.is_round {
            angle_between_axes(&own_axis(a), &own_axis(b))
        } else {
            angle_between(&a.rotation, &b.rotation)
        };
        travel + self.metres_per_rad * angle
    }

    fn interpolate(&self, a: &Isometry3<f64>, b: &Isometry3<f64>, t: f64) -> Isometry3<f64> {
        let pose = self.poses.interpolate(a, b, t);
        if self.is_round && 0.0 < t && t < 1.0 {
            Isometry3::from_parts(pose.translation, turned_between(a, b, t))
        } else {
            pose
        }
    }

    fn sample(&self, rng: &mut dyn Rng) -> Isometry3<f64> {
        if rng.random_bool(self.surface_share)
            && let Some(pose) = self.random_standing(rng, Place::OnSupport)
        {
            return pose;
        }
        let position = self.poses.position().sample(rng);
        upright(Vector3::from(position), rng.random_range(-std::f64::consts::PI..std::f64::consts::PI))
    }

    fn sample_at(&self, place: Place, rng: &mut dyn Rng) -> Option<Isometry3<f64>> {
        self.random_standing(rng, place)
    }

    fn tolerance(&self) -> f64 {
        OBJECT_TOLERANCE_M
    }
}
