//! Choosing the free joint: any solution of a pose, or the one nearest to a configuration.

use arrayvec::ArrayVec;
use nalgebra::Isometry3;
use rand::{Rng, RngExt};

use super::{Arm, ArmConfiguration, Solutions, joint_differences};

/// Most values of the upper arm roll tried by [`Arm::inverse_any`].
const MOST_SAMPLES: usize = 64;
/// Distance between them, rad, when the range allows.
const SAMPLE_STEP: f64 = 0.1;
/// Values of the upper arm roll tried on either side by [`Arm::inverse_near`].
const STEPS_EACH_WAY: u32 = 8;

impl Arm {
    /// A configuration inside the limits that puts the tool at `base_from_tool`, or `None` when none was found.
    ///
    /// Tries values of the upper arm roll 0.1 rad apart, with a random phase and in random order, and returns a random
    /// solution of the first that has one. A pose whose solutions all lie in a gap narrower than 0.1 rad can be missed.
    pub fn inverse_any(&self, base_from_tool: &Isometry3<f64>, rng: &mut dyn Rng) -> Option<ArmConfiguration> {
        let roll = self.limits[2];
        let (lower, width) = if roll.is_unlimited() {
            (-std::f64::consts::PI, std::f64::consts::TAU)
        } else {
            (roll.lower, roll.upper - roll.lower)
        };
        // At most MOST_SAMPLES, at least one: the ratio is not negative.
        let wanted = (width / SAMPLE_STEP).ceil().clamp(1.0, MOST_SAMPLES as f64);
        let phase = rng.random_range(0.0..1.0);
        let mut order: ArrayVec<f64, MOST_SAMPLES> = (0..MOST_SAMPLES)
            .map(|i| i as f64)
            .take_while(|i| *i < wanted)
            .map(|i| lower + width * (i + phase) / wanted)
            .collect();
        let mut solutions = Solutions::new();
        while !order.is_empty() {
            let upper_arm_roll = order.swap_remove(rng.random_range(0..order.len()));
            self.inverse(base_from_tool, upper_arm_roll, &mut solutions);
            if !solutions.is_empty() {
                return Some(solutions.swap_remove(rng.random_range(0..solutions.len())));
            }
        }
        None
    }

    /// The configuration nearest to `near` that puts the tool at `base_from_tool`, no joint farther than
    /// `max_joint_step` (rad, joints without limits the short way round), or `None`.
    ///
    /// Tries the upper arm roll of `near` and eight values on either side up to `max_joint_step`, nearest first; stops
    /// when no farther value can win. For following a line in small steps: the elbow drifts where it must.
    pub fn inverse_near(
        &self,
        base_from_tool: &Isometry3<f64>,
        near: &ArmConfiguration,
        max_joint_step: f64,
    ) -> Option<ArmConfiguration> {
        let mut best: Option<(f64, ArmConfiguration)> = None;
        let mut solutions = Solutions::new();
        for step in 0..=STEPS_EACH_WAY {
            let offset = max_joint_step * f64::from(step) / f64::from(STEPS_EACH_WAY);
            // A solution at this offset is at least `offset` away.
            if best.is_some_and(|(distance, _)| distance <= offset) {
                break;
            }
            for roll in [near[2] + offset, near[2] - offset] {
                self.inverse(base_from_tool, roll, &mut solutions);
                for q in &solutions {
                    let differences = joint_differences(&self.limits, near, q);
                    let distance = differences.iter().map(|d| d * d).sum::<f64>().sqrt();
                    let close = differences.iter().all(|d| d.abs() <= max_joint_step + 1e-12);
                    if close && best.is_none_or(|(least, _)| distance < least) {
                        best = Some((distance, *q));
                    }
                }
                if step == 0 {
                    break;
                }
            }
        }
        best.map(|(_, q)| q)
    }
}
