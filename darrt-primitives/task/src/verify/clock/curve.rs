//! The curve of a phase as `docs/timed-plan.md` defines it: where the robot is after so many seconds, and how fast.

use darrt_primitives::kinematics::limit::wrap_to_pi;

use crate::plan_file::Step;
use crate::plan_file::timing::Phase;
use crate::verify::robot::Robot;

/// The waypoints of a step as coordinates: x, y, yaw, then the variables of the tree. Yaw and endless joints are unwound within
/// the step, so that all that lies between two waypoints is the straight line.
pub(super) fn points(step: &Step, robot: &Robot) -> Result<Vec<Vec<f64>>, String> {
    let mut points: Vec<Vec<f64>> = Vec::with_capacity(step.waypoints.len());
    for waypoint in &step.waypoints {
        let joints = robot.table.variables(&waypoint.joints).map_err(|flaw| flaw.to_string())?;
        let mut point: Vec<f64> = waypoint.base.iter().copied().chain(joints).collect();
        if let Some(before) = points.last() {
            let endless = |i: usize| i == 2 || (i > 2 && robot.is_continuous(i - 3));
            for (i, (now, before)) in point.iter_mut().zip(before).enumerate() {
                if endless(i) {
                    *now = before + wrap_to_pi(*now - before);
                }
            }
        }
        points.push(point);
    }
    Ok(points)
}

/// So near to its ends, as a part of the whole way, a corner is taken for straight: the curve there differs from the line by the
/// cube of that, and rounding must not decide whether the jerk before or that in the corner counts.
const EDGE: f64 = 1e-9;

/// Corners with a smaller radius, as a part of the whole way, are none.
const SHARP: f64 = 100.0 * EDGE;

/// Velocity, acceleration and jerk of all coordinates.
#[derive(Debug)]
pub(super) struct Rates {
    pub(super) velocity: Vec<f64>,
    pub(super) acceleration: Vec<f64>,
    pub(super) jerk: Vec<f64>,
}

/// The way of a phase.
#[derive(Debug)]
pub(super) struct Curve<'a> {
    knots: Vec<&'a [f64]>,
    phase: &'a Phase,
    /// Length gone at each knot.
    at_knot: Vec<f64>,
    /// The coordinates that change at all.
    moving: Vec<usize>,
}

/// Where on the way a length gone is.
#[derive(Debug, Clone, Copy)]
enum Part {
    /// On this line, so much of it gone.
    Line(usize, f64),
    /// In the corner at this knot, so much of it gone, from 0 to 1.
    Corner(usize, f64),
}

impl<'a> Curve<'a> {
    pub(super) fn new(phase: &'a Phase, points: &'a [Vec<f64>]) -> Self {
        let knots: Vec<&[f64]> = phase.knots.iter().filter_map(|knot| points.get(*knot).map(Vec::as_slice)).collect();
        let first = knots.first().copied().unwrap_or_default();
        let changes = |i: &usize| knots.iter().any(|knot| knot.get(*i) != first.get(*i));
        let moving = (0..first.len()).filter(changes).collect();
        let mut at_knot = vec![0.0];
        for length in &phase.lengths {
            at_knot.push(at_knot.last().copied().unwrap_or(0.0) + length);
        }
        Self { knots, phase, at_knot, moving }
    }

    /// The coordinates that change at all.
    pub(super) fn moving(&self) -> &[usize] {
        &self.moving
    }

    pub(super) fn radius(&self, knot: usize) -> f64 {
        if knot == 0 { 0.0 } else { self.phase.blends.get(knot - 1).copied().unwrap_or(0.0) }
    }

    pub(super) fn at_knot(&self, knot: usize) -> f64 {
        self.at_knot.get(knot).copied().unwrap_or(0.0)
    }

    fn part(&self, gone: f64) -> Part {
        // The knot before, and that after.
        let line = self.at_knot.partition_point(|at| *at <= gone).saturating_sub(1);
        for knot in line.max(1)..(line + 2).min(self.knots.len().saturating_sub(1)) {
            let (radius, at) = (self.radius(knot), self.at_knot(knot));
            if radius > 0.0 && (gone - at).abs() < radius - EDGE * self.length() {
                return Part::Corner(knot, (gone - at + radius) / (2.0 * radius));
            }
            if gone < at {
                return Part::Line(knot - 1, self.share(knot - 1, gone));
            }
        }
        let last = self.phase.lengths.len().saturating_sub(1);
        Part::Line(last, self.share(last, gone))
    }

    fn length(&self) -> f64 {
        self.at_knot.last().copied().unwrap_or(0.0)
    }

    fn share(&self, line: usize, gone: f64) -> f64 {
        (gone - self.at_knot(line)) / self.phase.lengths.get(line).copied().unwrap_or(1.0)
    }

    /// On which line and how far along it, for what slides in pace with it: corners belong to their lines.
    pub(super) fn pace(&self, gone: f64) -> (usize, f64) {
        let line = (1..self.knots.len()).find(|knot| gone <= self.at_knot(*knot)).unwrap_or(self.knots.len() - 1) - 1;
        (line, self.share(line, gone).clamp(0.0, 1.0))
    }

    /// Ways from each coordinate of a knot to that of the next, for each unit of length.
    fn slope(&self, line: usize, coordinate: usize) -> f64 {
        let value = |knot: usize| self.knots.get(knot).and_then(|knot| knot.get(coordinate)).copied().unwrap_or(0.0);
        (value(line + 1) - value(line)) / self.phase.lengths.get(line).copied().unwrap_or(1.0)
    }

    /// Value and first three derivatives of a coordinate with respect to the length gone.
    fn derivatives(&self, part: Part, coordinate: usize) -> [f64; 4] {
        let value = |knot: usize| self.knots.get(knot).and_then(|knot| knot.get(coordinate)).copied().unwrap_or(0.0);
        match part {
            Part::Line(line, share) => {
                let (a, b) = (value(line), value(line + 1));
                [a + share * (b - a), self.slope(line, coordinate), 0.0, 0.0]
            }
            Part::Corner(knot, u) => {
                let (r, d1, d2) = (self.radius(knot), self.slope(knot - 1, coordinate), self.slope(knot, coordinate));
                let w = 2.0 * r;
                // The integral of (1 - s) d1 + s d2 with s = 3 u^2 - 2 u^3, from the beginning of the corner.
                let s = u * u * (3.0 - 2.0 * u);
                let integral = u * u * u - u * u * u * u / 2.0;
                let from = value(knot) - r * d1;
                let at = from + w * ((u - integral) * d1 + integral * d2);
                let (first, second) = ((1.0 - s) * d1 + s * d2, (6.0 * u - 6.0 * u * u) * (d2 - d1) / w);
                [at, first, second, (6.0 - 12.0 * u) * (d2 - d1) / (w * w)]
            }
        }
    }

    /// The coordinates where this length has been gone.
    pub(super) fn at(&self, gone: f64) -> Vec<f64> {
        let part = self.part(gone);
        let mut point = self.knots.first().map(|knot| knot.to_vec()).unwrap_or_default();
        for &coordinate in &self.moving {
            point[coordinate] = self.derivatives(part, coordinate)[0];
        }
        point
    }

    /// Where the robot is after `t_s` seconds of motion.
    pub(super) fn when(&self, t_s: f64) -> Vec<f64> {
        self.at(gone(self.phase, t_s).0)
    }

    /// Velocity, acceleration and jerk after `t_s` seconds of motion, in a piece of the profile with this jerk.
    pub(super) fn rates(&self, phase: &Phase, t_s: f64, jerk: f64) -> Rates {
        let (length, speed, push) = gone(phase, t_s);
        let part = self.part(length);
        let count = self.knots.first().map_or(0, |knot| knot.len());
        let mut rates = Rates { velocity: vec![0.0; count], acceleration: vec![0.0; count], jerk: vec![0.0; count] };
        for &coordinate in &self.moving {
            let [_, first, second, third] = self.derivatives(part, coordinate);
            rates.velocity[coordinate] = first * speed;
            rates.acceleration[coordinate] = second * speed * speed + first * push;
            rates.jerk[coordinate] = third * speed.powi(3) + 3.0 * second * speed * push + first * jerk;
        }
        rates
    }

    /// The inner knots whose corners are not rounded, or so little that it is as good as nothing: when each is passed, seconds, and
    /// by how much the velocity of any coordinate jumps there.
    pub(super) fn jumps(&self, phase: &Phase) -> Vec<(usize, f64, f64)> {
        let end_s = phase.moving_s();
        let sharp = (1..self.knots.len().saturating_sub(1)).filter(|knot| self.radius(*knot) < SHARP * self.length());
        let jump = |knot: usize| {
            let t_s = time_of(phase, self.at_knot(knot), 0.0, end_s);
            let change = |i: &usize| (self.slope(knot, *i) - self.slope(knot - 1, *i)).abs();
            (knot, t_s, self.moving.iter().map(change).fold(0.0, f64::max) * gone(phase, t_s).1)
        };
        sharp.map(jump).collect()
    }

    /// Times at which to look at the motion, each with the jerk of the profile there: `count` between any two at which something
    /// changes, and a hair inside of those.
    pub(super) fn looks(&self, phase: &Phase, count: u32) -> Vec<(f64, f64)> {
        let edges = (0..self.knots.len()).flat_map(|knot| {
            let (at, radius) = (self.at_knot(knot), self.radius(knot));
            [at - radius, at, at + radius]
        });
        let mut edges: Vec<f64> = edges.collect();
        edges.sort_by(f64::total_cmp);
        edges.dedup();
        let mut looks = Vec::new();
        let mut begin = 0.0;
        for &[seconds, jerk] in &phase.profile {
            let end = begin + seconds;
            let [low, high] = [begin, end].map(|t_s| gone(phase, t_s).0);
            let inside = edges.iter().filter(|edge| low < **edge && **edge < high);
            let mut times = vec![begin];
            times.extend(inside.map(|edge| time_of(phase, *edge, begin, end)));
            times.push(end);
            for pair in times.windows(2) {
                let [from, to] = pair else { continue };
                let hair = 1e-9 * (to - from);
                let (from, to) = (from + hair, to - hair);
                let parts = f64::from(count);
                looks.extend((0..=count).map(|i| (from + (to - from) * f64::from(i) / parts, jerk)));
            }
            begin = end;
        }
        looks
    }
}

/// When this length has been gone, between two times.
fn time_of(phase: &Phase, length: f64, mut low: f64, mut high: f64) -> f64 {
    for _ in 0..60 {
        let middle = low + (high - low) / 2.0;
        if gone(phase, middle).0 < length { low = middle } else { high = middle }
    }
    low
}

/// Length gone, its speed and its acceleration after `t_s` seconds of motion.
pub(super) fn gone(phase: &Phase, t_s: f64) -> (f64, f64, f64) {
    let (mut length, mut speed, mut push, mut left) = (0.0, 0.0, 0.0, t_s);
    for &[seconds, jerk] in &phase.profile {
        let t = seconds.min(left.max(0.0));
        length += speed * t + push * t * t / 2.0 + jerk * t * t * t / 6.0;
        speed += push * t + jerk * t * t / 2.0;
        push += jerk * t;
        left -= seconds;
    }
    (length, speed, push)
}
