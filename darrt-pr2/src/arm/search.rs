//! Choosing the free joint: any solution of a pose, or the one nearest to a configuration.

use arrayvec::ArrayVec;
use darrt_primitives::kinematics::lanes::{LANES, Row};
use nalgebra::Isometry3;
use rand::{Rng, RngExt};

use super::many_rolls::RollSolutions;
use super::{Arm, ArmConfiguration, Solutions, joint_differences};

/// Most values of the upper arm roll tried by [`Arm::inverse_any`].
const MOST_SAMPLES: usize = 64;
/// Distance between them, rad, when the range allows.
const SAMPLE_STEP: f64 = 0.1;
/// Values of the upper arm roll tried on either side by [`Arm::inverse_near`].
const STEPS_EACH_WAY: usize = 8;

impl Arm {
    /// A configuration inside the limits that puts the tool at `base_from_tool`, or `None` when none was found.
    ///
    /// Tries values of the upper arm roll 0.1 rad apart, with a random phase and in random order, and returns a random
    /// solution of the first that has one. A pose whose solutions all lie in a gap narrower than 0.1 rad can be missed.
    pub fn inverse_any(&self, base_from_tool: &Isometry3<f64>, rng: &mut dyn Rng) -> Option<ArmConfiguration> {
        self.inverse_where(base_from_tool, rng, |_| true)
    }

    /// The first configuration that `accept` takes of those inside the limits that put the tool at `base_from_tool`:
    /// without collision, say. `None` when it takes none, or when there is none.
    ///
    /// Values of the upper arm roll as in [`inverse_any`](Self::inverse_any), the solutions of one roll in random order.
    pub fn inverse_where(
        &self,
        base_from_tool: &Isometry3<f64>,
        rng: &mut dyn Rng,
        mut accept: impl FnMut(&ArmConfiguration) -> bool,
    ) -> Option<ArmConfiguration> {
        let mut rolls = self.rolls(rng);
        let mut many = RollSolutions::default();
        let mut solutions = Solutions::new();
        while !rolls.is_empty() {
            let mut row = Row::splat(f64::NAN);
            for slot in row.0.iter_mut().take(rolls.len()) {
                *slot = rolls.swap_remove(rng.random_range(0..rolls.len()));
            }
            self.inverse_for_rolls(base_from_tool, &row, &mut many);
            if many.is_empty() {
                continue;
            }
            for lane in 0..LANES {
                many.of_lane(lane, &mut solutions);
                while !solutions.is_empty() {
                    let q = solutions.swap_remove(rng.random_range(0..solutions.len()));
                    if accept(&q) {
                        return Some(q);
                    }
                }
            }
        }
        None
    }

    /// Values of the upper arm roll, equally far apart, with a random phase.
    pub(super) fn rolls(&self, rng: &mut dyn Rng) -> ArrayVec<f64, MOST_SAMPLES> {
        let roll = self.limits[2];
        let (lower, width) = if roll.is_unlimited() {
            (-std::f64::consts::PI, std::f64::consts::TAU)
        } else {
            (roll.lower, roll.upper - roll.lower)
        };
        // At most MOST_SAMPLES, at least one: the ratio is not negative.
        let wanted = (width / SAMPLE_STEP).ceil().clamp(1.0, MOST_SAMPLES as f64);
        let phase = rng.random_range(0.0..1.0);
        (0..MOST_SAMPLES)
            .map(|i| i as f64)
            .take_while(|i| *i < wanted)
            .map(|i| lower + width * (i + phase) / wanted)
            .collect()
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
        let mut many = RollSolutions::default();
        let mut solutions = Solutions::new();
        // Nothing, then a step either way, then two, ...
        let offset = |nth: usize| max_joint_step * nth.div_ceil(2) as f64 / STEPS_EACH_WAY as f64;
        let signed = |nth: usize| if nth.is_multiple_of(2) { -offset(nth) } else { offset(nth) };
        for nth in 0..=2 * STEPS_EACH_WAY {
            // A solution at this offset is at least so far away.
            if best.is_some_and(|(distance, _)| distance <= offset(nth)) {
                break;
            }
            let lane = nth % LANES;
            if lane == 0 {
                let rolls = Row(std::array::from_fn(|lane| near[2] + signed(nth + lane)));
                self.inverse_for_rolls(base_from_tool, &rolls, &mut many);
            }
            many.of_lane(lane, &mut solutions);
            for q in &solutions {
                let differences = joint_differences(&self.limits, near, q);
                let distance = differences.iter().map(|d| d * d).sum::<f64>().sqrt();
                let close = differences.iter().all(|d| d.abs() <= max_joint_step + 1e-12);
                if close && best.is_none_or(|(least, _)| distance < least) {
                    best = Some((distance, *q));
                }
            }
        }
        best.map(|(_, q)| q)
    }
}
