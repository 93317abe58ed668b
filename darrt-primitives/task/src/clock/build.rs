//! From the waypoints of a plan to its clock: phases, knots, lengths, corners, paces.

use darrt_primitives::contract::{Contract, HandUse, HandWay};
use darrt_primitives::manipulator::world_from_base;
use nalgebra::{Isometry3, Vector3};

use super::ClockError;
use super::limits::{Bounds, MotionLimits, carrying_acceleration, coasting_speed, quasi_static_acceleration};
use super::pace::{self, Channel, Piece};
use super::rounded_path::RoundedPath;
use super::track::{BASE, Body, BodyHand, StepTrack, Track};
use crate::plan_file::PlanFile;
use crate::plan_file::timing::{Phase, StepTiming, Timing};
use crate::robot::RobotFacts;

/// Waypoints that are no farther beside the line of their neighbours lie on it: rad or m of every coordinate.
const ON_LINE: f64 = 1e-6;
/// In how many parts a piece is looked at for the speed and the acceleration of the hand.
const LOOKS: u32 = 4;
/// What part of the bounds of the hand is used, because it is looked at only here and there.
const HAND_SHARE: f64 = 0.95;
/// Shorter pieces are not looked at: what they do to the hand is done by their neighbours.
const SHORTEST: f64 = 1e-6;
/// Corners that would be rounded by less are stopped at, seconds at full speed.
const SMALLEST_ROUNDING: f64 = 1e-4;

/// The limits of one step.
struct Pace<'a> {
    body: &'a Body,
    /// The hand at work.
    hand: &'a BodyHand,
    limits: &'a MotionLimits,
    step_track: &'a StepTrack,
    /// By variable.
    joints: &'a [Bounds],
    drive: Bounds,
    turn: Bounds,
    /// Of the tool, or of what it holds: m/s, m/s^2.
    hand_m_per_s: f64,
    hand_m_per_s2: f64,
    /// How far anything may pass a knot where a corner is rounded, metres; 0: the robot stops there.
    tube_m: f64,
}

/// The clock of a plan; how far anything may pass a corner of the steps, from 0, says `tube_m`.
pub(super) fn time(
    plan: &PlanFile,
    facts: &RobotFacts,
    tube_m: impl Fn(usize, &Contract) -> f64,
) -> Result<Timing, ClockError> {
    let limits = &facts.motion;
    if let Some((name, value)) = limits.flaw() {
        return Err(ClockError::Limits { name, value });
    }
    let body = Body::new(facts)?;
    let track = Track::new(plan, &body, facts)?;
    let joints = joint_bounds(&body, limits);
    let steps = track.steps.iter().enumerate().map(|(index, step_track)| {
        let tube_m = tube_m(index, &step_track.contract);
        Pace { tube_m, ..Pace::new(&body, limits, step_track, &joints) }.step()
    });
    let steps: Vec<StepTiming> = steps.collect();
    let duration_s = steps.iter().flat_map(|step| &step.phases).map(Phase::duration_s).sum();
    Ok(Timing { duration_s, steps })
}

/// The bounds of the variables of the tree.
pub(super) fn joint_bounds(body: &Body, limits: &MotionLimits) -> Vec<Bounds> {
    let variables = body.tree.variables().iter().zip(&body.slides);
    let bounds = variables.map(|(variable, slides)| {
        let kind = if *slides { limits.sliding_joint } else { limits.turning_joint };
        let said = limits.joint_velocities.iter().find(|(name, _)| **name == *variable.name).map(|(_, speed)| *speed);
        let described = (variable.max_velocity > 0.0).then_some(variable.max_velocity);
        let velocity = match (said, described) {
            (Some(said), Some(described)) => said.min(described),
            (said, described) => said.or(described).unwrap_or(kind.velocity),
        };
        Bounds { velocity, ..kind }
    });
    bounds.collect()
}

/// What moves between two waypoints.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Motion {
    Robot,
    Fingers,
}

impl<'a> Pace<'a> {
    fn new(body: &'a Body, limits: &'a MotionLimits, step_track: &'a StepTrack, joints: &'a [Bounds]) -> Self {
        let share = if step_track.contract.begins_holding() { limits.loaded_base_share } else { 1.0 };
        let mut hand = [f64::INFINITY; 2];
        if step_track.contract.way != HandWay::Free {
            hand[0] = limits.at_object_m_per_s;
        }
        if let Some(object) = &step_track.pushes {
            let mu = object.friction.table;
            hand = [hand[0].min(coasting_speed(mu)), quasi_static_acceleration(mu)];
        }
        if let Some((object, _)) = &step_track.holds {
            hand[1] = hand[1].min(carrying_acceleration(object.max_tilt_deg()));
        }
        let (drive, turn) = (limits.drive.scaled(share), limits.turn.scaled(share));
        let [speed, acceleration] = hand.map(|bound| bound * HAND_SHARE);
        Self {
            body,
            hand: body.hand(step_track.hand),
            limits,
            step_track,
            joints,
            drive,
            turn,
            hand_m_per_s: speed,
            hand_m_per_s2: acceleration,
            tube_m: 0.0,
        }
    }

    fn step(&self) -> StepTiming {
        let mut phases = Vec::new();
        let mut moves = [None; 2];
        for (from, to, motion) in self.runs() {
            let mut own = match motion {
                Motion::Fingers => self.phases(&[from, to]),
                Motion::Robot => self.phases(&self.knots(from, to)),
            };
            let (wait_s, rest_s) = match (motion, self.step_track.contract.hand) {
                (Motion::Fingers, HandUse::Takes) => (0.0, self.limits.grasp_s),
                (Motion::Fingers, HandUse::LetsGo) => (self.limits.release_s, self.limits.release_s),
                _ => (0.0, 0.0),
            };
            if let Some(phase) = own.first_mut() {
                phase.wait_s = wait_s;
            }
            if let Some(phase) = own.last_mut() {
                phase.rest_s = rest_s;
            }
            if motion == Motion::Robot && !own.is_empty() {
                moves = [moves[0].or(Some(phases.len())), Some(phases.len() + own.len() - 1)];
            }
            phases.append(&mut own);
        }
        if let ([Some(first), Some(last)], true) = (moves, self.step_track.contract.slides()) {
            if let Some(phase) = phases.get_mut(first) {
                phase.wait_s = self.limits.contact_s;
            }
            if let Some(phase) = phases.get_mut(last) {
                phase.rest_s = self.limits.contact_s;
            }
        }
        StepTiming { phases }
    }

    /// The step as ranges of waypoints between which either the fingers move or the rest does; none if nothing moves.
    fn runs(&self) -> Vec<(usize, usize, Motion)> {
        let finger = BASE + self.hand.finger;
        let kinds = self.step_track.points.windows(2).map(|pair| match pair {
            [a, b] if a == b => None,
            [a, b] if a.get(finger) != b.get(finger) => Some(Motion::Fingers),
            _ => Some(Motion::Robot),
        });
        let mut runs: Vec<(usize, usize, Motion)> = Vec::new();
        let mut from = 0;
        for (at, kind) in kinds.enumerate() {
            match (runs.last_mut(), kind) {
                (Some(run), None) => run.1 = at + 1,
                (Some(run), Some(kind)) if run.2 == kind => run.1 = at + 1,
                (_, Some(kind)) => runs.push((from, at + 1, kind)),
                // What stands at first goes with what moves first.
                (None, None) => continue,
            }
            from = at + 1;
        }
        runs
    }

    /// The waypoints from `from` to `to` between which the robot moves in straight lines.
    fn knots(&self, from: usize, to: usize) -> Vec<usize> {
        let points = &self.step_track.points;
        let mut knots = vec![from];
        let mut anchor = from;
        while anchor < to {
            let mut end = anchor + 1;
            while end < to
                && (is_same(points, end, anchor)
                    || (!self.step_track.contract.slides() && is_line(points, anchor, end + 1)))
            {
                end += 1;
            }
            knots.push(end);
            anchor = end;
        }
        // A doubled waypoint at the end.
        while let [.., before, last] = knots[..]
            && knots.len() > 2
            && is_same(points, before, last)
        {
            knots.truncate(knots.len() - 2);
            knots.push(last);
        }
        knots
    }

    /// The phases that go by these waypoints: one, or more where the robot must stop at a corner.
    fn phases(&self, knots: &[usize]) -> Vec<Phase> {
        let points: Vec<_> = knots.iter().filter_map(|knot| self.step_track.points.get(*knot).cloned()).collect();
        let lengths: Vec<f64> = points.windows(2).map(|pair| self.length(pair)).collect();
        let way = RoundedPath::new(points, lengths, vec![0.0; knots.len().saturating_sub(2)]);
        let radii: Vec<f64> = (0..knots.len()).map(|knot| self.radius(&way, knot)).collect();
        let mut phases = Vec::new();
        let mut from = 0;
        for to in 1..knots.len() {
            if to + 1 < knots.len() && radii.get(to).is_some_and(|radius| *radius > 0.0) {
                continue;
            }
            let knots = knots.get(from..=to).unwrap_or_default().to_vec();
            let lengths = way.lengths().get(from..to).unwrap_or_default().to_vec();
            let blends = radii.get(from + 1..to).unwrap_or_default().to_vec();
            let mut phase = Phase { knots, lengths, blends, profile: Vec::new(), wait_s: 0.0, rest_s: 0.0 };
            phase.profile = pace::profile(&self.pieces(&RoundedPath::of(&phase, &self.step_track.points)));
            phases.push(phase);
            from = to;
        }
        phases
    }

    /// How far from a knot its corner is rounded: half of the shorter line, less if anything would pass the knot farther than it
    /// may; 0 where the robot stops.
    fn radius(&self, way: &RoundedPath, knot: usize) -> f64 {
        let lines = way.lengths();
        let (Some(before), Some(after)) = (knot.checked_sub(1).and_then(|line| lines.get(line)), lines.get(knot))
        else {
            return 0.0;
        };
        let most = 0.5 * before.min(*after);
        let shift_m = self.shift_m(way, knot, most);
        // How far it passes grows no faster than the radius, but for curves that are small beside it.
        let radius = if shift_m > self.tube_m { most * self.tube_m / shift_m } else { most };
        if radius >= SMALLEST_ROUNDING { radius } else { 0.0 }
    }

    /// How far any link, the tool or what it holds passes a knot that is rounded so far, metres.
    fn shift_m(&self, way: &RoundedPath, knot: usize, radius: f64) -> f64 {
        let corner = way.corner(knot);
        let (Some(mark), rounded) = (way.marks().get(knot), 3.0 / 16.0 * radius) else { return f64::INFINITY };
        let at = way.at(*mark).point;
        let change = corner.before.iter().zip(&corner.after).map(|(before, after)| after - before);
        let passed: Vec<f64> = at.iter().zip(change).map(|(at, change)| at + rounded * change).collect();
        let [here, there] = [at, passed].map(|point| self.places(&point));
        here.iter().zip(&there).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
    }

    /// Seconds that a straight line takes at full speed.
    fn length(&self, line: &[Vec<f64>]) -> f64 {
        let [from, to] = line else { return 0.0 };
        let ways: Vec<f64> = from.iter().zip(to).map(|(a, b)| b - a).collect();
        let [x, y, yaw] = [0, 1, 2].map(|i| ways.get(i).copied().unwrap_or(0.0));
        let base_s = x.hypot(y) / self.drive.velocity + yaw.abs() / self.turn.velocity;
        let joints = ways.iter().skip(BASE).zip(self.joints);
        let arm_s = joints.map(|(way, bounds)| way.abs() / bounds.velocity).fold(0.0, f64::max);
        let own_s = base_s.max(arm_s);
        if self.hand_m_per_s == f64::INFINITY {
            return own_s;
        }
        let way = RoundedPath::new(line.to_vec(), vec![1.0], Vec::new());
        let [first, _] = self.hand(&way, 0.0, 1.0);
        own_s.max(first / self.hand_m_per_s)
    }

    /// The straight lines and corners of a way, in order.
    fn pieces(&self, way: &RoundedPath) -> Vec<Piece> {
        let mut pieces = Vec::new();
        for (line, (from, to)) in way.marks().iter().zip(way.marks().iter().skip(1)).enumerate() {
            let (from, to) = (from + way.radius(line), to - way.radius(line + 1));
            if to - from > SHORTEST {
                pieces.push(self.line(way, line, from, to));
            }
            let radius = way.radius(line + 1);
            if radius > 0.0 {
                pieces.push(self.corner(way, line + 1, radius));
            }
        }
        pieces
    }

    fn line(&self, way: &RoundedPath, line: usize, from: f64, to: f64) -> Piece {
        let direction = way.direction(line);
        let mut channels = self.channels(|i| [direction.get(i).map_or(0.0, |d| d.abs()), 0.0], 1.0);
        self.add_hand(way, from, to, &mut channels);
        Piece { length: to - from, channels }
    }

    fn corner(&self, way: &RoundedPath, knot: usize, radius: f64) -> Piece {
        let corner = way.corner(knot);
        let sizes = |i: usize| {
            let [a, b] = [&corner.before, &corner.after].map(|d| d.get(i).copied().unwrap_or(0.0));
            [a.abs().max(b.abs()), (b - a).abs()]
        };
        let mut channels = self.channels(sizes, radius);
        let mark = way.marks().get(knot).copied().unwrap_or(0.0);
        self.add_hand(way, mark - radius, mark + radius, &mut channels);
        Piece { length: 2.0 * radius, channels }
    }

    /// What base and joints do where the largest first derivative of a coordinate and its change in the corner are so large.
    fn channels(&self, sizes: impl Fn(usize) -> [f64; 2], radius: f64) -> Vec<Channel> {
        let channel = |[first, change]: [f64; 2], bounds: Bounds| Channel {
            first,
            second: 0.75 * change / radius,
            third: 1.5 * change / (radius * radius),
            bounds,
        };
        let [x, y, yaw] = [0, 1, 2].map(&sizes);
        let drive = [0, 1].map(|i: usize| x.get(i).copied().unwrap_or(0.0).hypot(y.get(i).copied().unwrap_or(0.0)));
        // What the wheels spend on turning they lack for driving.
        let wheels = drive[0] / self.drive.velocity + yaw[0] / self.turn.velocity;
        let wheels = channel([wheels, 0.0], Bounds { velocity: 1.0, ..Bounds::NONE });
        let base = [channel(drive, self.drive), channel(yaw, self.turn), wheels];
        let joints = self.joints.iter().enumerate().map(|(i, bounds)| channel(sizes(BASE + i), *bounds));
        base.into_iter().chain(joints).filter(|c| c.first > 0.0 || c.second > 0.0).collect()
    }

    fn add_hand(&self, way: &RoundedPath, from: f64, to: f64, channels: &mut Vec<Channel>) {
        let bounds = Bounds { velocity: self.hand_m_per_s, acceleration: self.hand_m_per_s2, ..Bounds::NONE };
        if (bounds.velocity == f64::INFINITY && bounds.acceleration == f64::INFINITY) || to - from <= SHORTEST {
            return;
        }
        let [first, second] = self.hand(way, from, to);
        channels.push(Channel { first, second, third: 0.0, bounds });
    }

    /// The largest first and second derivative of where the hand is, or what it holds, seen between two places of a way: metres
    /// per length and per length squared.
    fn hand(&self, way: &RoundedPath, from: f64, to: f64) -> [f64; 2] {
        let step = (to - from) / f64::from(LOOKS);
        let places: Vec<Vector3<f64>> =
            (0..=LOOKS).map(|i| self.hand_at(&way.at(from + f64::from(i) * step).point)).collect();
        let first = places.windows(2).map(|pair| match pair {
            [a, b] => (b - a).norm() / step,
            _ => 0.0,
        });
        let second = places.windows(3).map(|three| match three {
            [a, b, c] => (c - b * 2.0 + a).norm() / (step * step),
            _ => 0.0,
        });
        [first.fold(0.0, f64::max), second.fold(0.0, f64::max)]
    }

    /// Where the tool is in the world, or what it holds.
    fn hand_at(&self, point: &[f64]) -> Vector3<f64> {
        let mut poses = vec![Isometry3::identity(); self.body.tree.link_count()];
        let joints = point.get(BASE..).unwrap_or_default();
        // OPTIMIZATION: only the links between root and tool; the lengths are the tree's own.
        let written = self.body.tree.forward_only(joints, &self.hand.to_tool, &mut poses);
        debug_assert!(written.is_ok(), "{written:?}");
        let tool = world_from_root(point) * poses.get(self.hand.tool).copied().unwrap_or_default();
        self.held(tool).translation.vector
    }

    /// What the hand holds, or the hand itself.
    fn held(&self, tool: Isometry3<f64>) -> Isometry3<f64> {
        self.step_track.holds.as_ref().map_or(tool, |(_, tool_from_object)| tool * tool_from_object)
    }

    /// Where all links are in the world, and last the tool or what it holds.
    fn places(&self, point: &[f64]) -> Vec<Vector3<f64>> {
        let mut poses = vec![Isometry3::identity(); self.body.tree.link_count()];
        let joints = point.get(BASE..).unwrap_or_default();
        // The lengths are the tree's own.
        let written = self.body.tree.forward(joints, &world_from_root(point), &mut poses);
        debug_assert!(written.is_ok(), "{written:?}");
        let tool = poses.get(self.hand.tool).copied().unwrap_or_default();
        let hand = self.held(tool);
        poses.iter().chain([&hand]).map(|pose| pose.translation.vector).collect()
    }
}

/// Where the robot's root is.
fn world_from_root(point: &[f64]) -> Isometry3<f64> {
    world_from_base(&[0, 1, 2].map(|i| point.get(i).copied().unwrap_or(0.0)))
}

fn is_same(points: &[Vec<f64>], a: usize, b: usize) -> bool {
    points.get(a) == points.get(b)
}

/// Do all points between two lie on the line from one to the other, in order?
fn is_line(points: &[Vec<f64>], from: usize, to: usize) -> bool {
    let (Some(a), Some(b)) = (points.get(from), points.get(to)) else { return false };
    let way: Vec<f64> = a.iter().zip(b).map(|(a, b)| b - a).collect();
    let square: f64 = way.iter().map(|w| w * w).sum();
    let mut gone = 0.0;
    points.get(from + 1..to).unwrap_or_default().iter().all(|point| {
        let along: f64 = point.iter().zip(a).zip(&way).map(|((p, a), w)| (p - a) * w).sum::<f64>() / square;
        let is_ahead = along >= gone && along <= 1.0;
        gone = along;
        is_ahead && point.iter().zip(a).zip(&way).all(|((p, a), w)| (p - a - along * w).abs() <= ON_LINE)
    })
}
