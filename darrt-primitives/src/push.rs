//! Planar pushing: what an object on a table does when a finger moves against it.
//!
//! Everything here is quasi-static and planar. The object frame sits at the centre of friction
//! (the centroid of the support pressure, which on a level table is the projection of the centre of
//! mass), x and y in the table plane, angles counter-clockwise, SI units. Contact and support
//! friction obey Coulomb's law with one coefficient for sticking and sliding.
//!
//! | question | file |
//! |---|---|
//! | which twist does a wrench cause? | [`limit_surface`] |
//! | does the contact stick or slide? which way does the object turn? | [`motion_cone`] |
//! | what does one finger do to a disc? | [`one_point`] |
//! | when do two fingers keep a disc fixed to the hand? | [`stable_two_point`] |
//! | how does a misplaced disc settle between two fingers? | [`settling`] |
//! | does a push hold: captured, stable, not too heavy, long enough? | [`steady`] |
//! | which way does a pushed object go? | [`slide`] |
//! | where does a push end when the target lies off the table? | [`edge_stop`] |

use nalgebra::Vector2;

use crate::error::{PrimitiveError, positive, within};

pub mod edge_stop;
pub mod limit_surface;
pub mod motion_cone;
pub mod one_point;
pub mod settling;
pub mod slide;
pub mod stable_two_point;
pub mod steady;

/// Standard gravity in m/s^2.
pub const GRAVITY: f64 = 9.81;

/// Largest accepted coefficient of friction; beyond it a friction cone is a half-plane in all but name.
pub const MAX_FRICTION: f64 = 100.0;

/// A planar velocity of the object: of its centre of friction, and about the vertical.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Twist {
    /// Velocity of the centre of friction, m/s (or metres per metre of push).
    pub linear: Vector2<f64>,
    /// Angular velocity, rad/s, counter-clockwise (or radians per metre of push).
    pub angular: f64,
}

impl Twist {
    /// Velocity of the material point at `point` (object frame, metres).
    pub fn velocity_at(&self, point: &Vector2<f64>) -> Vector2<f64> {
        self.linear + self.angular * turned_left(point)
    }

    /// Centre of rotation in the object frame, `None` for a pure translation or no motion.
    ///
    /// The distance grows without bound as `angular` goes to zero.
    pub fn center_of_rotation(&self) -> Option<Vector2<f64>> {
        (self.angular != 0.0).then(|| turned_left(&self.linear) / self.angular)
    }
}

/// A planar force at the centre of friction with its moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wrench {
    /// Force, N.
    pub force: Vector2<f64>,
    /// Moment about the centre of friction, N m, counter-clockwise.
    pub moment: f64,
}

impl Wrench {
    /// The wrench of a force applied at `point` (object frame, metres).
    pub fn of_force_at(point: &Vector2<f64>, force: Vector2<f64>) -> Self {
        Self { force, moment: cross(point, &force) }
    }
}

/// A coefficient of Coulomb friction in `[0, MAX_FRICTION]`.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub struct Friction(f64);

impl Friction {
    /// No friction at all.
    pub const NONE: Self = Self(0.0);

    /// Wraps a coefficient.
    ///
    /// # Errors
    /// [`PrimitiveError::NotFinite`] or [`PrimitiveError::OutOfRange`] outside `[0, MAX_FRICTION]`.
    pub fn new(coefficient: f64) -> Result<Self, PrimitiveError> {
        within("friction coefficient", coefficient, 0.0, MAX_FRICTION).map(Self)
    }

    /// The coefficient mu.
    pub fn coefficient(self) -> f64 {
        self.0
    }

    /// The friction angle atan(mu): half the opening of the friction cone, radians.
    pub fn angle(self) -> f64 {
        self.0.atan()
    }
}

/// How far an object slides on after the finger stops, metres: v^2 / (2 mu g).
///
/// The quasi-static assumption of this module holds while this is small against the tolerances of
/// the task; at 0.1 m/s on mu = 0.3 it is under 2 mm.
///
/// # Errors
/// When `speed` (m/s) is not positive, or `support_friction` is zero.
pub fn coasting_distance(speed: f64, support_friction: Friction) -> Result<f64, PrimitiveError> {
    let speed = positive("push speed", speed)?;
    let mu = positive("support friction", support_friction.coefficient())?;
    Ok(speed * speed / (2.0 * mu * GRAVITY))
}

/// z component of the cross product of two plane vectors.
pub(crate) fn cross(a: &Vector2<f64>, b: &Vector2<f64>) -> f64 {
    a.perp(b)
}

/// `v` turned by +90 degrees.
pub(crate) fn turned_left(v: &Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-v.y, v.x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coasting_is_millimetres_at_pushing_speed() {
        let slow = coasting_distance(0.1, Friction::new(0.3).unwrap()).unwrap();
        assert!((slow - 0.0017).abs() < 5e-5, "{slow}");
        let fast = coasting_distance(0.2, Friction::new(0.2).unwrap()).unwrap();
        assert!((fast - 0.010).abs() < 5e-4, "{fast}");
        assert!(coasting_distance(0.1, Friction::NONE).is_err());
    }

    #[test]
    fn friction_outside_its_range_is_refused() {
        assert!(Friction::new(-0.1).is_err());
        assert!(Friction::new(f64::NAN).is_err());
        assert!((Friction::new(1.0).unwrap().angle().to_degrees() - 45.0).abs() < 1e-12);
    }

    #[test]
    fn the_centre_of_rotation_stands_still() {
        let twist = Twist { linear: Vector2::new(0.3, -0.7), angular: -2.0 };
        let cor = twist.center_of_rotation().unwrap();
        assert!(twist.velocity_at(&cor).norm() < 1e-15);
        let slide = Twist { linear: Vector2::x(), angular: 0.0 };
        assert_eq!(slide.center_of_rotation(), None);
    }
}
