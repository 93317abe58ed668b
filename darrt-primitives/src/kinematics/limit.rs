//! The closed interval a joint may stand in.

use std::f64::consts::{PI, TAU};

/// A closed interval of joint values, in rad (turning joints) or m (sliding joints); both ends may be infinite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointLimit {
    /// Smallest value; `-inf` when there is none.
    pub lower: f64,
    /// Largest value; `+inf` when there is none.
    pub upper: f64,
}

impl JointLimit {
    /// No limit on either side: a continuous joint.
    pub const UNLIMITED: Self = Self { lower: f64::NEG_INFINITY, upper: f64::INFINITY };

    /// The interval `[lower, upper]`.
    pub const fn new(lower: f64, upper: f64) -> Self {
        Self { lower, upper }
    }

    /// Whether neither end is finite.
    pub fn is_unlimited(&self) -> bool {
        self.lower == f64::NEG_INFINITY && self.upper == f64::INFINITY
    }

    /// Whether `value` lies in the interval, both ends included.
    pub fn contains(&self, value: f64) -> bool {
        self.lower <= value && value <= self.upper
    }

    /// The value of the interval nearest to `value`.
    pub fn clamp(&self, value: f64) -> f64 {
        value.max(self.lower).min(self.upper)
    }

    /// `angle` shifted by whole turns into the interval, or `None` when no shift fits.
    ///
    /// An unlimited joint gets the representative in `(-pi, pi]`. A value outside by at most `slack` (rad) counts
    /// as inside and is moved onto the end. When several shifts fit, the one nearest to zero is returned.
    pub fn wrap(&self, angle: f64, slack: f64) -> Option<f64> {
        let centred = wrap_to_pi(angle);
        if self.is_unlimited() {
            return Some(centred);
        }
        let inside = |a: f64| self.lower - slack <= a && a <= self.upper + slack;
        let mirrored = if centred > 0.0 { -TAU } else { TAU };
        [0.0, mirrored, -mirrored].into_iter().map(|turn| centred + turn).find(|a| inside(*a)).map(|a| self.clamp(a))
    }
}

/// The representative of `angle` (rad) in `(-pi, pi]`; not finite stays not finite.
pub fn wrap_to_pi(angle: f64) -> f64 {
    if -PI < angle && angle <= PI {
        return angle;
    }
    let turned = angle - TAU * (angle / TAU).round();
    if turned <= -PI { turned + TAU } else { turned }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrapping_keeps_the_direction() {
        for k in -400..400 {
            let angle = f64::from(k) * 0.05;
            let wrapped = wrap_to_pi(angle);
            assert!(-PI < wrapped && wrapped <= PI, "{angle} -> {wrapped}");
            assert!((wrapped.sin() - angle.sin()).abs() < 1e-12);
            assert!((wrapped.cos() - angle.cos()).abs() < 1e-12);
        }
        assert_eq!(wrap_to_pi(PI), PI);
        assert!(wrap_to_pi(-PI) > 0.0);
    }

    #[test]
    fn wrap_finds_the_turn_that_fits() {
        let roll = JointLimit::new(-3.75, 0.65);
        assert_eq!(roll.wrap(0.5, 0.0), Some(0.5));
        let turned = roll.wrap(3.0, 0.0).unwrap();
        assert!((turned - (3.0 - TAU)).abs() < 1e-15);
        assert_eq!(roll.wrap(1.0, 0.0), None);
        assert_eq!(roll.wrap(0.65 + 1e-13, 1e-12), Some(0.65));
        assert_eq!(roll.wrap(0.65 + 1e-11, 1e-12), None);
        assert_eq!(JointLimit::UNLIMITED.wrap(4.0, 0.0), Some(4.0 - TAU));
    }
}
