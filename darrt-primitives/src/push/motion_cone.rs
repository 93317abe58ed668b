//! The motion cone of a point contact, and the sense of rotation by three votes.
//!
//! The motion cone holds the velocities the contact point can have while the contact force stays in
//! the friction cone. A pusher moving inside it sticks to the object; outside it slides along it
//! (Mason 1986).

use nalgebra::{Unit, Vector2};

use super::limit_surface::PressureConstant;
use super::{Friction, Wrench, cross, turned_left};
use crate::error::{PrimitiveError, finite, positive};

/// A frictional point contact on the object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointContact {
    point: Vector2<f64>,
    normal: Unit<Vector2<f64>>,
    friction: Friction,
}

/// The sense in which a pushed object turns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rotation {
    /// To the left, positive angular velocity.
    CounterClockwise,
    /// To the right, negative angular velocity.
    Clockwise,
    /// Pure translation.
    None,
}

impl PointContact {
    /// A contact at `point` (metres from the centre of friction) whose `normal` points into the object.
    ///
    /// # Errors
    /// When a coordinate of `point` is not finite.
    pub fn new(point: Vector2<f64>, normal: Unit<Vector2<f64>>, friction: Friction) -> Result<Self, PrimitiveError> {
        finite("contact point x", point.x)?;
        finite("contact point y", point.y)?;
        Ok(Self { point, normal, friction })
    }

    /// A contact on the rim of a disc whose inward normal has the given `azimuth` (radians).
    ///
    /// # Errors
    /// When `radius` is not positive or `azimuth` not finite.
    pub fn on_disc(radius: f64, azimuth: f64, friction: Friction) -> Result<Self, PrimitiveError> {
        let radius = positive("disc radius", radius)?;
        let azimuth = finite("contact azimuth", azimuth)?;
        let normal = Vector2::new(azimuth.cos(), azimuth.sin());
        Self::new(-radius * normal, Unit::new_normalize(normal), friction)
    }

    /// Where it touches, metres from the centre of friction.
    pub fn point(&self) -> Vector2<f64> {
        self.point
    }

    /// The unit normal into the object.
    pub fn normal(&self) -> Unit<Vector2<f64>> {
        self.normal
    }

    /// The tangent: the normal turned by +90 degrees.
    pub fn tangent(&self) -> Vector2<f64> {
        turned_left(&self.normal)
    }

    /// Friction between pusher and object.
    pub fn friction(&self) -> Friction {
        self.friction
    }

    /// The wrench of unit normal force with `share` (-1 to 1) of the available friction toward the
    /// tangent.
    pub fn wrench(&self, share: f64) -> Wrench {
        let force = self.normal.into_inner() + share * self.friction.coefficient() * self.tangent();
        Wrench::of_force_at(&self.point, force)
    }

    /// The force the object needs for its contact point to move with `velocity`.
    ///
    /// # Source
    /// Lynch, Maekawa, Tanie 1992.
    pub fn sticking_force(&self, pressure: PressureConstant, velocity: &Vector2<f64>) -> Vector2<f64> {
        let (c2, r) = (pressure.squared(), &self.point);
        let scale = 1.0 / (c2 + r.norm_squared());
        (c2 * velocity + r * r.dot(velocity)) * scale
    }

    /// Does a pusher moving with `velocity` stick to the object without slipping?
    ///
    /// False also when the pusher moves away or does not move.
    pub fn sticks(&self, pressure: PressureConstant, velocity: &Vector2<f64>) -> bool {
        let force = self.sticking_force(pressure, velocity);
        let along = force.dot(&self.normal);
        velocity.dot(&self.normal) > 0.0 && force.dot(&self.tangent()).abs() <= self.friction.coefficient() * along
    }

    /// The motion cone of this contact.
    pub fn motion_cone(&self, pressure: PressureConstant) -> MotionCone {
        let edge = |share: f64| {
            let wrench = self.wrench(share);
            pressure.twist_of(&wrench).velocity_at(&self.point)
        };
        MotionCone { left: edge(1.0), right: edge(-1.0) }
    }

    /// Which way the object turns when pushed along `direction`.
    ///
    /// Left edge and right edge of the friction cone and the direction of pushing vote, each by the
    /// side on which its line passes the centre of friction; the majority wins. It needs no
    /// knowledge of the support pressure.
    ///
    /// # Source
    /// Mason 1986, voting theorem.
    pub fn rotation(&self, direction: &Vector2<f64>) -> Rotation {
        let rays = [self.wrench(1.0).force, self.wrench(-1.0).force, *direction];
        let votes = rays.map(|ray| cross(&self.point, &ray));
        let positive = votes.iter().filter(|vote| **vote > 0.0).count();
        let negative = votes.iter().filter(|vote| **vote < 0.0).count();
        if positive >= 2 {
            Rotation::CounterClockwise
        } else if negative >= 2 {
            Rotation::Clockwise
        } else {
            Rotation::None
        }
    }
}

/// The cone of contact-point velocities that keep the pusher sticking.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionCone {
    /// Edge on the left, as seen along the inward normal (not normalised).
    pub left: Vector2<f64>,
    /// Edge on the right.
    pub right: Vector2<f64>,
}

impl MotionCone {
    /// Is `velocity` inside the cone or on its border?
    pub fn contains(&self, velocity: &Vector2<f64>) -> bool {
        let middle = self.left.normalize() + self.right.normalize();
        cross(&self.right, velocity) >= 0.0 && cross(velocity, &self.left) >= 0.0 && velocity.dot(&middle) > 0.0
    }

    /// Half of the angle between the edges, radians.
    pub fn half_angle(&self) -> f64 {
        0.5 * cross(&self.right, &self.left).atan2(self.right.dot(&self.left))
    }
}

/// Half-angle of the motion cone of a contact on the rim of a disc: atan(mu (1 + R^2/c^2)), radians.
///
/// # Errors
/// When `radius` is not finite and positive.
pub fn disc_half_angle(radius: f64, pressure: PressureConstant, friction: Friction) -> Result<f64, PrimitiveError> {
    let radius = positive("disc radius", radius)?;
    let gain = 1.0 + radius * radius / pressure.squared();
    Ok((friction.coefficient() * gain).atan())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn mu(value: f64) -> Friction {
        Friction::new(value).unwrap()
    }

    #[test]
    fn half_angles_of_a_disc() {
        let uniform = PressureConstant::uniform_disc(0.13).unwrap();
        let rim = PressureConstant::rim(0.13).unwrap();
        for (friction, on_disc, on_rim) in [(0.1, 18.004, 11.310), (0.3, 44.275, 30.964), (0.5, 58.393, 45.000)] {
            for (pressure, expected) in [(uniform, on_disc), (rim, on_rim)] {
                let closed = disc_half_angle(0.13, pressure, mu(friction)).unwrap();
                assert!((closed.to_degrees() - expected).abs() < 5.1e-4, "{closed}");
                let contact = PointContact::on_disc(0.13, 0.4, mu(friction)).unwrap();
                let general = contact.motion_cone(pressure).half_angle();
                assert!((general - closed).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn votes_of_a_disc() {
        let contact = PointContact::on_disc(0.13, 0.0, mu(0.3)).unwrap();
        let toward = |angle: f64| contact.rotation(&Vector2::new(angle.cos(), angle.sin()));
        assert_eq!(toward(0.0), Rotation::None);
        // The contact is at -x: pushing toward +y passes the centre on the left, clockwise.
        assert_eq!(toward(0.2), Rotation::Clockwise);
        assert_eq!(toward(-0.2), Rotation::CounterClockwise);
        let slippery = PointContact::on_disc(0.13, 0.0, Friction::NONE).unwrap();
        assert_eq!(slippery.rotation(&Vector2::new(1.0, 0.5)), Rotation::None);
    }

    #[test]
    fn a_pusher_that_leaves_does_not_stick() {
        let contact = PointContact::on_disc(0.13, 0.0, mu(0.3)).unwrap();
        let c = PressureConstant::uniform_disc(0.13).unwrap();
        assert!(contact.sticks(c, &Vector2::x()));
        assert!(!contact.sticks(c, &-Vector2::x()));
        assert!(!contact.sticks(c, &Vector2::zeros()));
        for point in [Vector2::new(f64::NAN, 0.0), Vector2::new(0.0, f64::NAN)] {
            assert!(PointContact::new(point, contact.normal(), mu(0.3)).is_err());
        }
    }

    #[test]
    fn the_border_of_the_motion_cone_belongs_to_it() {
        let c = PressureConstant::uniform_disc(0.13).unwrap();
        let cone = PointContact::on_disc(0.13, 0.0, mu(0.3)).unwrap().motion_cone(c);
        assert!(cone.contains(&cone.left) && cone.contains(&cone.right));
        assert!(!cone.contains(&-cone.left) && !cone.contains(&-cone.right) && !cone.contains(&Vector2::zeros()));
        // Without friction the cone is one ray, and border only.
        let smooth = PointContact::on_disc(0.13, 0.0, Friction::NONE).unwrap();
        assert!(smooth.sticks(c, &Vector2::x()) && smooth.motion_cone(c).contains(&Vector2::x()));
    }

    proptest! {
        #[test]
        fn sticking_is_being_inside_the_motion_cone(
            x in -0.2..0.2_f64, y in -0.2..0.2_f64, azimuth in -3.0..3.0_f64,
            heading in -1.5..1.5_f64, friction in 0.01..1.0_f64, c in 0.03..0.2_f64,
        ) {
            let normal = Unit::new_normalize(Vector2::new(azimuth.cos(), azimuth.sin()));
            let contact = PointContact::new(Vector2::new(x, y), normal, mu(friction)).unwrap();
            let pressure = PressureConstant::new(c).unwrap();
            let angle = azimuth + heading;
            let velocity = Vector2::new(angle.cos(), angle.sin());
            let cone = contact.motion_cone(pressure);
            let margin = cross(&cone.right, &velocity).abs().min(cross(&velocity, &cone.left).abs());
            prop_assume!(margin > 1e-9);
            prop_assert_eq!(contact.sticks(pressure, &velocity), cone.contains(&velocity));
        }

        #[test]
        fn votes_agree_with_the_sticking_twist(
            x in -0.2..0.2_f64, y in -0.2..0.2_f64, azimuth in -3.0..3.0_f64,
            heading in -1.5..1.5_f64, friction in 0.01..1.0_f64,
        ) {
            let normal = Unit::new_normalize(Vector2::new(azimuth.cos(), azimuth.sin()));
            let contact = PointContact::new(Vector2::new(x, y), normal, mu(friction)).unwrap();
            let pressure = PressureConstant::new(0.09).unwrap();
            let angle = azimuth + heading;
            let velocity = Vector2::new(angle.cos(), angle.sin());
            let pushed = super::super::one_point::push(&contact, pressure, &velocity);
            prop_assert!(pushed.is_some());
            let angular = pushed.unwrap().twist.angular;
            prop_assume!(angular.abs() > 1e-9);
            let expected = if angular > 0.0 { Rotation::CounterClockwise } else { Rotation::Clockwise };
            prop_assert_eq!(contact.rotation(&velocity), expected);
        }
    }
}
