//! How fast a robot may move: its own limits, and those that come from what it is doing.
//!
//! The limits of the joints' speeds are the description's, unless the robot says that it is driven more slowly. A URDF knows no
//! accelerations and no jerks: those are [`MotionLimits`], per robot, with defaults that suit an arm of a service robot.

/// Bounds of a speed and of its first two derivatives; all > 0, infinite where there is none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// Largest speed: rad/s, or m/s for what slides or drives.
    pub velocity: f64,
    /// Largest change of it per second.
    pub acceleration: f64,
    /// Largest change of that per second.
    pub jerk: f64,
}

impl Bounds {
    /// No bounds.
    pub const NONE: Self = Self { velocity: f64::INFINITY, acceleration: f64::INFINITY, jerk: f64::INFINITY };

    /// These three.
    pub const fn new(velocity: f64, acceleration: f64, jerk: f64) -> Self {
        Self { velocity, acceleration, jerk }
    }

    /// All three, times `share`.
    #[must_use]
    pub fn scaled(self, share: f64) -> Self {
        Self::new(self.velocity * share, self.acceleration * share, self.jerk * share)
    }
}

/// How fast a robot is driven. The defaults are choices of a careful operator, not measurements of a robot.
#[derive(Debug, Clone, PartialEq)]
pub struct MotionLimits {
    /// Largest speeds of single joints by name, where the robot is driven more slowly than its description allows: rad/s or m/s.
    pub joint_velocities: Vec<(String, f64)>,
    /// For joints that turn. The speed counts where the description says none.
    pub turning_joint: Bounds,
    /// For joints that slide.
    pub sliding_joint: Bounds,
    /// Driving of the base, m. What the wheels spend on turning they lack for driving: the shares of both speeds add up to at
    /// most one.
    pub drive: Bounds,
    /// Turning of the base, rad.
    pub turn: Bounds,
    /// What part of speed, acceleration and jerk of the base is left with something in the hand.
    pub loaded_base_share: f64,
    /// How long hand and arm stand after the fingers have closed on an object, seconds.
    pub grasp_s: f64,
    /// How long they stand before the fingers let go of an object and after, seconds.
    pub release_s: f64,
    /// How long they stand before a push, with the fingers at the object, and after it, seconds.
    pub contact_s: f64,
    /// Speed of the hand in straight lines at an object: approaching, lifting, setting down, retreating, and in pushes at most;
    /// m/s.
    pub at_object_m_per_s: f64,
}

impl Default for MotionLimits {
    fn default() -> Self {
        Self {
            joint_velocities: Vec::new(),
            turning_joint: Bounds::new(1.0, 2.0, 20.0),
            sliding_joint: Bounds::new(0.1, 0.5, 5.0),
            drive: Bounds::new(0.5, 0.5, 2.0),
            turn: Bounds::new(1.0, 1.0, 4.0),
            loaded_base_share: 0.6,
            grasp_s: 1.0,
            release_s: 0.5,
            contact_s: 0.5,
            at_object_m_per_s: 0.1,
        }
    }
}

impl MotionLimits {
    /// The first of its numbers that is out of range, with its name.
    pub fn flaw(&self) -> Option<(String, f64)> {
        let triple = |name: &str, b: Bounds| {
            [("velocity", b.velocity), ("acceleration", b.acceleration), ("jerk", b.jerk)]
                .map(|(key, value)| (format!("{name}.{key}"), value))
        };
        let bounds = [
            ("turning_joint", self.turning_joint),
            ("sliding_joint", self.sliding_joint),
            ("drive", self.drive),
            ("turn", self.turn),
        ];
        let joints = self.joint_velocities.iter().map(|(name, value)| (format!("joint_velocities.{name}"), *value));
        let positive = bounds.into_iter().flat_map(|(name, b)| triple(name, b)).chain(joints).chain([
            ("loaded_base_share".to_owned(), self.loaded_base_share),
            ("at_object_m_per_s".to_owned(), self.at_object_m_per_s),
        ]);
        let waits = [("grasp_s", self.grasp_s), ("release_s", self.release_s), ("contact_s", self.contact_s)];
        let is_range = |value: f64| (1e-6..=1e6).contains(&value);
        let is_wait = |value: f64| (0.0..=1e6).contains(&value);
        let wrong = positive.into_iter().find(|(_, value)| !is_range(*value));
        wrong.or_else(|| {
            let found = waits.into_iter().find(|(_, value)| !is_wait(*value));
            found.map(|(name, value)| (name.to_owned(), value))
        })
    }
}

/// Standard gravity, m/s^2.
pub const GRAVITY_M_S2: f64 = 9.81;

/// How far a pushed object may coast when the push ends, metres: what the mechanics of pushing take for nothing.
pub const COASTING_M: f64 = 0.002;

/// What part of the friction under a pushed object its inertia may be, so that the push is quasi-static.
pub const INERTIA_SHARE: f64 = 0.1;

/// What part of its largest lean an upright object may feel as a push sideways while it is carried.
pub const LEAN_SHARE: f64 = 0.5;

/// The largest acceleration of anything in the hand as part of gravity: the fingers hold with half as much again as the weight
/// asks, and this leaves half of that.
pub const HELD_SHARE: f64 = 0.25;

/// The speed at which an object that slides on friction `mu` coasts [`COASTING_M`] when it is left: `v = sqrt(2 mu g d)`, m/s.
pub fn coasting_speed(mu: f64) -> f64 {
    (2.0 * mu * GRAVITY_M_S2 * COASTING_M).sqrt()
}

/// The acceleration at which the inertia of an object that slides on friction `mu` is [`INERTIA_SHARE`] of its friction, m/s^2.
pub fn quasi_static_acceleration(mu: f64) -> f64 {
    INERTIA_SHARE * mu * GRAVITY_M_S2
}

/// The largest acceleration of a held object that may lean `max_tilt_deg`, m/s^2: pushed sideways by `a` it feels as if it leant
/// by `atan(a / g)`.
pub fn carrying_acceleration(max_tilt_deg: f64) -> f64 {
    let lean = (LEAN_SHARE * max_tilt_deg).to_radians();
    let upright = if lean < std::f64::consts::FRAC_PI_2 { GRAVITY_M_S2 * lean.tan() } else { f64::INFINITY };
    upright.min(HELD_SHARE * GRAVITY_M_S2)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The figures of the mechanics: 1.7 mm at 0.1 m/s on friction 0.3.
    #[test]
    fn coasting_is_as_the_formula_says() {
        let speed = coasting_speed(0.3);
        assert!((speed * speed / (2.0 * 0.3 * GRAVITY_M_S2) - COASTING_M).abs() < 1e-12);
        assert!(speed > 0.1 && coasting_speed(0.1) < 0.1, "{speed}");
    }

    #[test]
    fn what_may_lean_less_is_carried_more_gently() {
        let [full, bowl, plate] = [5.0, 45.0, 180.0].map(carrying_acceleration);
        assert!(full < bowl && bowl <= plate, "{full} {bowl} {plate}");
        assert!((plate - 2.4525).abs() < 1e-12);
    }

    #[test]
    fn limits_out_of_range_are_named() {
        assert_eq!(MotionLimits::default().flaw(), None);
        let mut limits = MotionLimits { contact_s: -1.0, ..MotionLimits::default() };
        assert_eq!(limits.flaw(), Some(("contact_s".to_owned(), -1.0)));
        limits.drive.jerk = 0.0;
        assert_eq!(limits.flaw(), Some(("drive.jerk".to_owned(), 0.0)));
        limits.joint_velocities.push(("elbow".to_owned(), f64::NAN));
        limits.drive.jerk = 1.0;
        assert_eq!(limits.flaw().map(|(name, _)| name), Some("joint_velocities.elbow".to_owned()));
    }
}
