//! Capture and settling: what two fingers do to a disc that is not where the plan thought.
//!
//! With lateral error e against the mid-line of the fingers and half separation b = gap/2:
//!
//! - |e| < b: one finger touches first; the one-finger drift turns the disc toward the mid-line until
//!   the second finger touches too, and then it is stable. A two-finger push is a funnel: the lateral
//!   error becomes zero.
//! - |e| >= b: the disc escapes sideways, its offset growing as under one finger.
//! - a push shorter than the settling distance leaves part of the error.

use std::f64::consts::{FRAC_PI_2, SQRT_2};

use super::Friction;
use super::limit_surface::PressureConstant;
use super::one_point::DiscDrift;
use crate::error::{PrimitiveError, positive, positive_below, within};

/// A disc in front of two fingers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Funnel {
    radius: f64,
    half_gap: f64,
    drift: DiscDrift,
}

/// What becomes of a laterally misplaced disc in a push of unlimited length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fate {
    /// Both fingers end up touching.
    Settles {
        /// Push length from first contact until the second finger touches, metres.
        distance: f64,
    },
    /// The disc rolls off the outside of one finger.
    Escapes,
    /// The fingers pass beside the disc without touching.
    Misses,
}

/// The disc after a push of a given length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settled {
    /// Lateral error that is left, metres, same sign as the initial one.
    pub lateral_error: f64,
    /// Rotation of the disc, radians, counter-clockwise seen from above.
    pub rotation: f64,
    /// Are both fingers touching?
    pub both_touching: bool,
}

impl Funnel {
    /// A disc of `radius` before two fingers `gap` apart, both in metres.
    ///
    /// # Errors
    /// When `radius` is not positive or `gap` outside (0, 2R).
    pub fn new(radius: f64, gap: f64, pressure: PressureConstant, friction: Friction) -> Result<Self, PrimitiveError> {
        let radius = positive("disc radius", radius)?;
        let gap = positive_below("finger gap", gap, 2.0 * radius)?;
        Ok(Self { radius, half_gap: 0.5 * gap, drift: DiscDrift::new(radius, pressure, friction)? })
    }

    /// The angle beta of each finger when both touch, radians.
    pub fn half_angle(&self) -> f64 {
        (self.half_gap / self.radius).asin()
    }

    /// What becomes of a disc displaced sideways by `error` metres.
    ///
    /// An error of exactly half the gap stays in balance on one finger for ever; it counts as an escape.
    ///
    /// # Errors
    /// When `error` is not finite.
    pub fn fate(&self, error: f64) -> Result<Fate, PrimitiveError> {
        let error = crate::error::finite("lateral error", error)?.abs();
        if error < self.half_gap {
            let distance = self.drift.length_between(self.first_angle(error), self.half_angle())?;
            Ok(Fate::Settles { distance })
        } else if error < self.half_gap + self.radius {
            Ok(Fate::Escapes)
        } else {
            Ok(Fate::Misses)
        }
    }

    /// Push length until both fingers touch, `None` when the disc escapes or is missed.
    ///
    /// Sticking: s = ((c^2 + R^2)/R) ln(tan(beta/2) / tan(psi0/2)); without friction the factor is R;
    /// in between the drift passes from the one to the other at the edge of the motion cone.
    ///
    /// # Errors
    /// When `error` is not finite.
    pub fn settle_distance(&self, error: f64) -> Result<Option<f64>, PrimitiveError> {
        Ok(match self.fate(error)? {
            Fate::Settles { distance } => Some(distance),
            Fate::Escapes | Fate::Misses => None,
        })
    }

    /// The disc after a push of `length` metres, counted from first contact.
    ///
    /// A disc that is missed stays as it was; one that escapes ends with its rim on the finger's line.
    ///
    /// # Errors
    /// When `error` is not finite, or `length` is negative or not finite.
    pub fn push(&self, error: f64, length: f64) -> Result<Settled, PrimitiveError> {
        let length = within("push length", length, 0.0, f64::MAX)?;
        let fate = self.fate(error)?;
        // A disc displaced to the left (e > 0) lies right of the left finger: it drifts right.
        let side = if error < 0.0 { -1.0 } else { 1.0 };
        match fate {
            Fate::Misses => Ok(Settled { lateral_error: error, rotation: 0.0, both_touching: false }),
            Fate::Escapes => {
                let psi = ((error.abs() - self.half_gap) / self.radius).asin();
                let end = self.drift.advance(psi, length)?;
                Ok(Settled {
                    lateral_error: side * (self.half_gap + end.offset),
                    rotation: side * end.rotation,
                    both_touching: false,
                })
            }
            Fate::Settles { distance } => {
                let both_touching = length >= distance;
                let psi = self.first_angle(error.abs());
                let end = self.drift.advance(psi, length.min(distance))?;
                let left = self.half_gap - end.offset;
                Ok(Settled {
                    lateral_error: if both_touching { 0.0 } else { side * left },
                    rotation: -side * end.rotation,
                    both_touching,
                })
            }
        }
    }

    /// Probability that a lateral error with a centred normal distribution of standard deviation
    /// `sigma` metres is captured: P(|e| < gap/2).
    ///
    /// # Errors
    /// When `sigma` is not finite and positive.
    pub fn capture_probability(&self, sigma: f64) -> Result<f64, PrimitiveError> {
        let sigma = positive("standard deviation", sigma)?;
        Ok(error_function(self.half_gap / (sigma * SQRT_2)))
    }

    /// Angle psi at first contact for an error in `[0, b)`.
    fn first_angle(&self, error: f64) -> f64 {
        ((self.half_gap - error) / self.radius).asin().clamp(0.0, FRAC_PI_2)
    }
}

/// erf(x) for x >= 0 by Simpson's rule, absolute error below 1e-10.
fn error_function(x: f64) -> f64 {
    const STEPS: u32 = 400;
    // erf(6) differs from 1 by 2e-17.
    let x = x.min(6.0);
    let step = x / f64::from(STEPS);
    let sum: f64 = (0..=STEPS)
        .map(|i| {
            let weight = match i {
                0 | STEPS => 1.0,
                i if i % 2 == 1 => 4.0,
                _ => 2.0,
            };
            weight * (-(f64::from(i) * step).powi(2)).exp()
        })
        .sum();
    std::f64::consts::FRAC_2_SQRT_PI * step / 3.0 * sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn funnel(mu: f64) -> Funnel {
        let c = PressureConstant::uniform_disc(0.14).unwrap();
        Funnel::new(0.14, 0.08, c, Friction::new(mu).unwrap()).unwrap()
    }

    #[test]
    fn settling_table() {
        // Error (mm), settling distance with mu 0.3, with mu 0, rotation in degrees.
        let table = [
            [5.0, 0.0280, 0.0194, 2.124],
            [10.0, 0.0601, 0.0416, 4.228],
            [20.0, 0.1434, 0.0993, 8.388],
            [30.0, 0.2843, 0.1969, 12.506],
            [38.0, 0.6101, 0.4223, 15.783],
        ];
        let (rough, smooth) = (funnel(0.3), funnel(0.0));
        for [error, sticking, frictionless, degrees] in table {
            let error = error * 1e-3;
            let distance = rough.settle_distance(error).unwrap().unwrap();
            assert!((distance - sticking).abs() < 5.1e-5, "{distance}");
            let slippery = smooth.settle_distance(error).unwrap().unwrap();
            assert!((slippery - frictionless).abs() < 5.1e-5, "{slippery}");
            let end = rough.push(error, distance).unwrap();
            assert!(end.both_touching);
            assert_eq!(end.lateral_error, 0.0);
            assert!((-end.rotation.to_degrees() - degrees).abs() < 5.1e-4);
            assert_eq!(smooth.push(error, distance).unwrap().rotation, 0.0);
        }
    }

    #[test]
    fn capture_probabilities() {
        for (sigma, expected) in [(0.015, 0.992), (0.020, 0.954), (0.025, 0.890), (0.030, 0.818)] {
            let found = funnel(0.3).capture_probability(sigma).unwrap();
            assert!((found - expected).abs() < 5.1e-4, "{found}");
        }
        assert!((error_function(0.5) - 0.520_499_877_813_046_5).abs() < 1e-10);
        assert!((error_function(60.0) - 1.0).abs() < 1e-10);
    }

    #[test]
    fn short_pushes_leave_an_error() {
        let end = funnel(0.3).push(0.02, 0.05).unwrap();
        assert!(!end.both_touching);
        // e' = b - R sin psi(s).
        let psi0: f64 = (0.02_f64 / 0.14).asin();
        let growth = (0.05 / ((0.093_333_333_f64.powi(2) + 0.0196) / 0.14)).exp();
        let psi = 2.0 * ((0.5 * psi0).tan() * growth).atan();
        assert!((end.lateral_error - (0.04 - 0.14 * psi.sin())).abs() < 1e-8);
        assert!(end.lateral_error < 0.02);
    }

    #[test]
    fn a_far_displaced_disc_escapes_and_a_farther_one_is_missed() {
        let hand = funnel(0.3);
        assert_eq!(hand.fate(0.05), Ok(Fate::Escapes));
        assert_eq!(hand.fate(-0.2), Ok(Fate::Misses));
        let end = hand.push(-0.05, 0.2).unwrap();
        assert!(end.lateral_error < -0.05 && !end.both_touching);
        // It escapes as under one finger, which runs past the disc 0.01 m beside its centre.
        let drift = DiscDrift::new(0.14, PressureConstant::uniform_disc(0.14).unwrap(), Friction::new(0.3).unwrap());
        let alone = drift.unwrap().advance(-(0.01_f64 / 0.14).asin(), 0.2).unwrap();
        assert!((end.lateral_error - (alone.offset - 0.04)).abs() < 1e-12);
        assert!((end.rotation - alone.rotation).abs() < 1e-12);
        let missed = Settled { lateral_error: -0.2, rotation: 0.0, both_touching: false };
        assert_eq!(hand.push(-0.2, 0.2), Ok(missed));
        assert!(hand.fate(f64::NAN).is_err());
        assert!(hand.push(0.01, -1.0).is_err());
    }

    #[test]
    fn on_the_line_of_a_finger_it_escapes_and_at_its_rim_it_is_missed() {
        let hand = funnel(0.3);
        assert_eq!(hand.fate(0.04), Ok(Fate::Escapes));
        assert_eq!(hand.fate(0.04 + 0.14), Ok(Fate::Misses));
        let c = PressureConstant::uniform_disc(0.14).unwrap();
        let of_gap = |gap| Funnel::new(0.14, gap, c, Friction::NONE);
        assert!(of_gap(0.279).is_ok() && of_gap(0.28).is_err());
    }

    #[test]
    fn a_centred_disc_is_settled_at_once() {
        assert_eq!(funnel(0.3).fate(0.0), Ok(Fate::Settles { distance: 0.0 }));
        assert!(funnel(0.3).push(0.0, 0.0).unwrap().both_touching);
    }

    proptest! {
        #[test]
        fn pushing_never_makes_a_captured_error_larger(
            error in -0.0399..0.0399_f64, first in 0.0..0.4_f64, more in 0.0..0.4_f64,
            mu in 0.0..0.8_f64,
        ) {
            let hand = funnel(mu);
            let early = hand.push(error, first).unwrap();
            let late = hand.push(error, first + more).unwrap();
            prop_assert!(early.lateral_error.abs() <= error.abs() + 1e-12);
            prop_assert!(late.lateral_error.abs() <= early.lateral_error.abs() + 1e-12);
            let mirrored = hand.push(-error, first).unwrap();
            prop_assert_eq!(mirrored.lateral_error.abs(), early.lateral_error.abs());
        }
    }
}
