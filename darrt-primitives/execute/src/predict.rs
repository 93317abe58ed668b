//! What to expect of an execution before it is tried: how far robot and objects may be off after every step, and how likely it is
//! that the step succeeds all the same.
//!
//! The errors are those of `belief`: linear maps of normal errors. Of each step they are held against what
//! it bears:
//!
//! - A push needs the object between its fingers, P(|e| < gap / 2) sideways, and the hand must come down behind it, lengthwise
//!   (`push-mechanics`: capture and settling; [`Funnel`](darrt_primitives::push::settling::Funnel)).
//! - A hand that closes needs the object between its open fingers, and within their length.
//! - What is pushed or set down stays if its centre stays over the surface.
//! - At the end every object must be within the tolerance of its goal: the normal distribution in the plane over a disc.
//!
//! Steps are taken as independent. Collisions of an arm that has drifted are not in it: what a way keeps clear of is not known here.

use darrt_primitives::contract::HandUse;
use nalgebra::{Matrix2, Matrix3, SymmetricEigen, Vector2, Vector3};
use serde::Serialize;

use crate::arm::Arm;
use crate::course::Course;
use crate::feedback::Feedback;
use crate::goal::{self, NEAR_M, Now};
use crate::noise::NoiseModel;
use crate::progress::{Contact, Posture, advance};
use crate::run::Execution;
use crate::timeline::TimedStep;

/// Intervals of a numeric integral over six standard deviations: good to 1e-6.
const INTERVALS: u32 = 400;

/// What is expected of a plan.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Prediction {
    /// Step by step.
    pub steps: Vec<StepPrediction>,
    /// The probability that every object ends within the tolerance of its goal.
    pub success: f64,
    /// The same with 5 cm instead of the tolerance.
    pub within_5_cm: f64,
}

/// What is expected of a step.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StepPrediction {
    /// The step, from 1.
    pub step: usize,
    /// Its primitive.
    pub primitive: String,
    /// Does a robot that looks do so before it?
    pub looks: bool,
    /// The base after it.
    pub base: Spread,
    /// The hand after it, in the world.
    pub hand: Spread,
    /// By object, in the order of the problem: after it, in the world.
    pub objects: Vec<Spread>,
    /// Of the object that it takes or pushes, against the hand, before it.
    pub against_hand: Option<Spread>,
    /// The probability that it does not fail.
    pub success: f64,
}

/// How far something may be off, as standard deviations.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Spread {
    /// Along x of the world, metres.
    pub x_m: f64,
    /// Along y, metres.
    pub y_m: f64,
    /// Correlation of the two, -1 to 1.
    pub correlation: f64,
    /// Yaw, degrees.
    pub yaw_deg: f64,
}

impl Spread {
    fn of(covariance: &Matrix3<f64>) -> Self {
        let sigma = |index: usize| covariance[(index, index)].max(0.0).sqrt();
        let (x_m, y_m) = (sigma(0), sigma(1));
        let correlation = if x_m * y_m > 0.0 { covariance[(0, 1)] / (x_m * y_m) } else { 0.0 };
        Self { x_m, y_m, correlation, yaw_deg: sigma(2).to_degrees() }
    }

    /// The larger half axis of the ellipse of one standard deviation, metres.
    pub fn largest_m(&self) -> f64 {
        let mixed = self.correlation * self.x_m * self.y_m;
        let plane = Matrix2::new(self.x_m * self.x_m, mixed, mixed, self.y_m * self.y_m);
        SymmetricEigen::new(plane).eigenvalues.max().max(0.0).sqrt()
    }
}

impl Execution<'_> {
    /// What is to be expected with this noise; `looks`: does the robot look where everything is, as in a closed loop?
    pub fn predict(&self, noise: &NoiseModel, looks: bool) -> Prediction {
        let course = &*self.course;
        let mut know = Feedback::new(self, course, noise);
        let mut steps = Vec::new();
        for (index, step) in course.timeline.steps.iter().enumerate() {
            let does_look = looks && step.senses;
            if does_look {
                expect_look(self, course, &mut know, index);
            }
            let begin = know.posture(self, course, step, step.begin_s);
            let contact = advance(self, course, &mut know.belief, (index, step), &begin, &know.offset);
            let after = know.posture(self, course, step, step.end_s);
            let tool = after.believed.translation.vector.into();
            let hand = self.arm.error_of_hand(&self.robot, after.base, &after.joints, &tool);
            let is_gripped = step.pushes.is_some() || step.contract.hand == HandUse::Takes;
            let against_hand = contact.as_ref().filter(|_| is_gripped).map(|contact| Spread::of(&contact.off));
            steps.push(StepPrediction {
                step: index + 1,
                primitive: course.primitive(index),
                looks: does_look,
                base: Spread::of(&know.belief.of_base()),
                hand: Spread::of(&know.belief.of_hand(&hand)),
                objects: (0..self.problem.objects.len()).map(|o| Spread::of(&know.belief.of_object(o))).collect(),
                against_hand,
                success: contact.map_or(1.0, |contact| self.bears(course, &know, step, &begin, &contact)),
            });
        }
        let last = course.timeline.steps.last();
        if looks && last.is_some_and(|last| last.contract.hand == HandUse::Carries) {
            expect_look(self, course, &mut know, steps.len());
        }
        let done: f64 = steps.iter().map(|step| step.success).product();
        let [success, within_5_cm] = self.at_goals(course, &know);
        Prediction { steps, success: done * success, within_5_cm: done * within_5_cm }
    }

    /// The probability that a contact does what it should.
    fn bears(&self, course: &Course, know: &Feedback, step: &TimedStep, begin: &Posture, contact: &Contact) -> f64 {
        let along = |axis: &Vector2<f64>| {
            let plane = contact.off.fixed_view::<2, 2>(0, 0);
            (axis.transpose() * plane * axis)[(0, 0)].max(0.0).sqrt()
        };
        let mut chance = 1.0;
        if let Some(direction) = contact.direction {
            let across = Vector2::new(-direction.y, direction.x);
            chance *= within(contact.gap_m / 2.0, along(&across));
            chance *= below(self.standoff_m(course, step, contact.object), along(&direction));
        } else if step.contract.hand == HandUse::Takes {
            let fingers = (begin.believed.rotation * Vector3::y()).xy();
            let ahead = (begin.believed.rotation * Vector3::x()).xy();
            if let Some((open, closed)) = self.openings(course, step)
                && fingers.norm() > 0.0
            {
                chance *= within((open - closed) / 2.0 / fingers.norm(), along(&fingers.normalize()));
            }
            if let Some(held) = self.held_m(step).filter(|_| ahead.norm() > 0.0) {
                chance *= below(held / ahead.norm(), along(&ahead.normalize()));
            }
        }
        let sets_down = step.contract.hand == HandUse::LetsGo;
        if (contact.direction.is_some() || sets_down)
            && let Some(end) = step.ends.get(contact.object)
        {
            let at = end.translation.vector;
            let depth_m = self.depths.get(contact.object).copied().unwrap_or_default();
            let under = self.scene.surfaces().iter().filter(|surface| {
                surface.contains(&at.xy().into()) && (at.z - depth_m - surface.height()).abs() < depth_m
            });
            if let Some(surface) = under.max_by(|a, b| a.height().total_cmp(&b.height())) {
                let edge = surface.nearest_edge_point(&at.xy().into());
                let plane = know.belief.of_object(contact.object).fixed_view::<2, 2>(0, 0).into_owned();
                let outward = edge.outward.into_inner();
                let sigma = (outward.transpose() * plane * outward)[(0, 0)].max(0.0).sqrt();
                chance *= below(surface.depth(&at.xy().into()), sigma);
            }
        }
        chance
    }

    /// How far behind the object a hand comes down before it pushes, metres.
    fn standoff_m(&self, course: &Course, step: &TimedStep, object: usize) -> f64 {
        let tool = |time_s: f64| {
            let command = course.timeline.at(step, time_s, &self.robot);
            Arm::world_from_tool(&self.robot, command.base, &command.joints).translation.vector
        };
        let (mut before, mut after) = (step.begin_s, step.end_s);
        while after - before > 1e-3 {
            let middle = f64::midpoint(before, after);
            if course.part_pushed(self, step, object, middle) > 1e-6 { after = middle } else { before = middle }
        }
        (tool(before) - tool(step.begin_s)).norm()
    }

    /// How far the fingers are open before and after they close on something, metres.
    fn openings(&self, course: &Course, step: &TimedStep) -> Option<(f64, f64)> {
        let width = |time_s: f64| {
            let command = course.timeline.at(step, time_s, &self.robot);
            Some(2.0 * self.robot.hand.at_joint(*command.joints.get(self.robot.finger)?).half_width())
        };
        Some((width(step.begin_s)?, width(step.end_s)?))
    }

    /// How far the fingertips reach over the rim of a round object that the hand takes, metres.
    fn held_m(&self, step: &TimedStep) -> Option<f64> {
        let (object, tool_from_object) = step.holds?;
        let radius = self.problem.objects.get(object)?.shape.round_radius()?;
        let at = tool_from_object.translation.vector;
        // Level grasps: the rim is nearest on the line from the hand to the middle.
        Some(self.robot.reach_beyond_tool_m - (at.x - radius)).filter(|held| *held > 0.0)
    }

    /// The probabilities that all objects end within their tolerances, and within 5 cm.
    fn at_goals(&self, course: &Course, know: &Feedback) -> [f64; 2] {
        let Some(last) = course.timeline.steps.last() else { return [1.0; 2] };
        let held = Some(last).filter(|step| step.contract.hand != HandUse::LetsGo).and_then(|step| step.holds);
        let mut chances = [1.0; 2];
        for (index, object) in self.problem.objects.iter().enumerate() {
            let Some(goal) = self.problem.goal.objects.iter().find(|goal| goal.object == object.name) else { continue };
            let Some(pose) = last.ends.get(index) else { continue };
            let now = Now {
                pose: *pose,
                is_in_hand: held.is_some_and(|(held, _)| held == index),
                planned: *pose,
                depth_m: self.depths.get(index).copied().unwrap_or_default(),
            };
            let off_m = goal::end(self.problem, &self.scene, &object.name, &now).off_m;
            let plane = know.belief.of_object(index).fixed_view::<2, 2>(0, 0).into_owned();
            for (chance, most_m) in chances.iter_mut().zip([goal.tolerance_m, goal.tolerance_m.max(NEAR_M)]) {
                *chance *= in_disc(&plane, off_m, most_m);
            }
        }
        chances
    }
}

/// A look that shows everything where it is believed to be.
fn expect_look(of: &Execution<'_>, course: &Course, know: &mut Feedback, index: usize) {
    let (base, objects) = (know.belief.base, know.belief.objects.clone());
    know.look(of, course, index, (base, &objects), &mut || [0.0; 3]);
}

/// P(|e| < bound) of a centred normal error.
fn within(bound: f64, sigma: f64) -> f64 {
    (2.0 * below(bound, sigma) - 1.0).max(0.0)
}

/// P(e < bound) of a centred normal error.
fn below(bound: f64, sigma: f64) -> f64 {
    if sigma <= 0.0 {
        return if bound >= 0.0 { 1.0 } else { 0.0 };
    }
    let z = (bound / sigma).clamp(-8.0, 8.0);
    let step = z / f64::from(INTERVALS);
    let density = |z: f64| (-0.5 * z * z).exp() / std::f64::consts::TAU.sqrt();
    let sum: f64 = (0..INTERVALS).map(|i| density((f64::from(i) + 0.5) * step)).sum();
    (0.5 + sum * step).clamp(0.0, 1.0)
}

/// The probability that a normal error in the plane, added to what is `off_m` from the middle already (in the worst direction, the
/// one of the largest error), is in a disc of radius `most_m`.
fn in_disc(covariance: &Matrix2<f64>, off_m: f64, most_m: f64) -> f64 {
    let axes = SymmetricEigen::new(*covariance);
    let (a, b) = (axes.eigenvalues[0].max(0.0).sqrt(), axes.eigenvalues[1].max(0.0).sqrt());
    let (long, short) = (a.max(b), a.min(b));
    if long <= 0.0 {
        return if off_m <= most_m { 1.0 } else { 0.0 };
    }
    // Only where there is something to add up: a small error is a narrow peak.
    let (from, to) = ((off_m - 8.0 * long).max(-most_m), (off_m + 8.0 * long).min(most_m));
    if from >= to {
        return 0.0;
    }
    let step = (to - from) / f64::from(INTERVALS);
    let chord = |u: f64| (most_m * most_m - u * u).max(0.0).sqrt();
    let density = |u: f64| (-0.5 * (u / long).powi(2)).exp() / (long * std::f64::consts::TAU.sqrt());
    let slice = |u: f64| density(u - off_m) * within(chord(u), short);
    let sum: f64 = (0..INTERVALS).map(|i| slice(from + (f64::from(i) + 0.5) * step)).sum();
    (sum * step).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normal_probabilities() {
        // Tables of the normal distribution; a round error of one standard deviation: 1 - exp(-r^2 / 2).
        for (z, p) in [(0.0, 0.5), (1.0, 0.841_345), (-1.0, 0.158_655), (2.0, 0.977_250), (8.0, 1.0)] {
            assert!((below(z, 1.0) - p).abs() < 1e-5, "{z}");
        }
        assert!((within(0.04, 0.025) - 0.890_401).abs() < 1e-5);
        for radius in [0.5_f64, 1.0, 2.0, 3.0] {
            let exact = 1.0 - (-0.5 * radius * radius).exp();
            assert!((in_disc(&Matrix2::identity(), 0.0, radius) - exact).abs() < 1e-3, "{radius}");
        }
        // Nothing is off but by what it already is.
        assert_eq!(in_disc(&Matrix2::zeros(), 0.01, 0.02), 1.0);
        assert_eq!(in_disc(&Matrix2::zeros(), 0.03, 0.02), 0.0);
        // Nor by much.
        let tiny = Matrix2::identity() * 1e-14;
        assert!((in_disc(&tiny, 0.01, 0.02) - 1.0).abs() < 1e-4 && in_disc(&tiny, 0.03, 0.02) < 1e-9);
    }
}
