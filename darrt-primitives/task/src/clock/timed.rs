//! A plan on its clock: where the robot is at any time.

use std::collections::BTreeMap;
use std::sync::Arc;

use darrt_primitives::contract::HandUse;
use darrt_primitives::kinematics::KinematicTree;
use darrt_primitives::manipulator::world_from_base;
use nalgebra::Isometry3;

use super::profile::{self, Progress, progress};
use super::rounded_path::RoundedPath;
use super::track::{BASE, Body, Track};
use super::{ClockError, check};
use crate::plan_file::timing::{StepTiming, Timing};
use crate::plan_file::{JointTable, PlanFile};
use crate::robot::RobotFacts;

/// A plan with its clock, ready to be asked where the robot is.
#[derive(Debug)]
pub struct TimedPlan {
    body: Body,
    track: Track,
    phases: Vec<Placed>,
    /// When each step begins, and when the last one ends; seconds.
    step_starts: Vec<f64>,
    timing: Timing,
}

/// A phase with the times of its beginning, of its motion and of its end.
#[derive(Debug)]
struct Placed {
    /// From 0.
    step: usize,
    begin_s: f64,
    moves_s: f64,
    stops_s: f64,
    end_s: f64,
    way: RoundedPath,
    profile: Vec<[f64; 2]>,
    opens: bool,
    knots: Vec<usize>,
}

/// The robot at one time.
#[derive(Debug, Clone, PartialEq)]
pub struct Moment {
    /// The step, from 0.
    pub step: usize,
    /// x, y (m) and yaw (rad) of the robot's root; the yaw goes on beyond a turn.
    pub base: [f64; 3],
    /// Their speeds, m/s and rad/s.
    pub base_velocity: [f64; 3],
    /// Their accelerations, m/s^2 and rad/s^2.
    pub base_acceleration: [f64; 3],
    /// The variables of the robot's tree, rad or m; continuous joints go on beyond a turn.
    pub joints: Vec<f64>,
    /// Their speeds.
    pub joint_velocity: Vec<f64>,
    /// Their accelerations.
    pub joint_acceleration: Vec<f64>,
    /// Where it is between the waypoints of the step: 2.5 is half way from the third to the fourth. At a rounded corner it is
    /// the waypoint that is passed.
    pub waypoint: f64,
}

/// What happens at a time besides motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum EventKind {
    /// A good time to look where everything is: the robot stands, and something is touched next, or the base has just moved.
    Sense,
    /// The fingers of the hand at work in the step begin to move to where their joint is `to` (rad or m), closing with `force_n` on what they take; no force is
    /// given where they meet nothing.
    Fingers {
        /// The finger joint before.
        from: f64,
        /// And after.
        to: f64,
        /// Force of each finger, newton.
        force_n: Option<f64>,
    },
}

/// Something that happens at a time besides motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Event {
    /// When, seconds.
    pub time_s: f64,
    /// In which step, from 0.
    pub step: usize,
    /// What.
    pub kind: EventKind,
}

impl TimedPlan {
    /// The plan on its own clock, or, if it has none, on the one that [`super::time`] makes for it.
    ///
    /// # Errors
    /// [`ClockError`] when plan and robot do not fit together, or the clock is none.
    pub fn new(plan: &PlanFile, facts: &RobotFacts) -> Result<Self, ClockError> {
        match &plan.timing {
            Some(timing) => Self::with(plan, facts, timing),
            None => Self::with(plan, facts, &super::time(plan, facts)?),
        }
    }

    /// The plan on this clock.
    ///
    /// # Errors
    /// As [`TimedPlan::new`].
    pub fn with(plan: &PlanFile, facts: &RobotFacts, timing: &Timing) -> Result<Self, ClockError> {
        check::check(plan, timing)?;
        let body = Body::new(facts)?;
        let track = Track::new(plan, &body, facts)?;
        let (mut phases, mut step_starts, mut now) = (Vec::new(), Vec::new(), 0.0);
        for (step, (step_track, timing)) in track.steps.iter().zip(&timing.steps).enumerate() {
            step_starts.push(now);
            for phase in &timing.phases {
                let way = RoundedPath::of(phase, &step_track.points);
                let finger = BASE + body.hand(step_track.hand).finger;
                let ends = [0.0, way.length()].map(|s| way.at(s).point.get(finger).copied());
                let moves_s = now + phase.wait_s;
                let stops_s = moves_s + phase.moving_s();
                let end_s = stops_s + phase.rest_s;
                let (profile, knots) = (phase.profile.clone(), phase.knots.clone());
                let opens = ends[0] != ends[1];
                phases.push(Placed { step, begin_s: now, moves_s, stops_s, end_s, way, profile, opens, knots });
                now = end_s;
            }
        }
        step_starts.push(now);
        Ok(Self { body, track, phases, step_starts, timing: timing.clone() })
    }

    /// Seconds of the whole plan.
    pub fn duration_s(&self) -> f64 {
        self.step_starts.last().copied().unwrap_or(0.0)
    }

    /// When the step with this index begins, seconds; that after the last step is where the plan ends.
    pub fn step_start_s(&self, step: usize) -> Option<f64> {
        self.step_starts.get(step).copied()
    }

    /// The tree whose variables [`Moment::joints`] are.
    pub fn tree(&self) -> &KinematicTree {
        &self.body.tree
    }

    /// All movable joints by name, for values of the tree's variables.
    pub fn joints(&self) -> &JointTable {
        &self.body.table
    }

    /// The variables of the arms, from the base outwards: those of the first, then those of others that it has not.
    pub fn arm(&self) -> &[usize] {
        &self.body.arm
    }

    /// By hand: the variable that opens it.
    pub fn fingers(&self) -> Vec<usize> {
        self.body.hands().map(|hand| hand.finger).collect()
    }

    /// By hand: the link whose frame is the tool frame.
    pub fn tools(&self) -> Vec<usize> {
        self.body.hands().map(|hand| hand.tool).collect()
    }

    /// Which hand is at work in a step, both counted from 0; the first where there is no such step.
    pub fn hand(&self, step: usize) -> usize {
        self.track.steps.get(step).map_or(0, |step_track| step_track.hand)
    }

    /// Where the robot is after `t_s` seconds; before the beginning where it starts, after the end where it stops.
    pub fn at(&self, t_s: f64) -> Moment {
        let index = self.phases.partition_point(|phase| phase.end_s <= t_s).min(self.phases.len().saturating_sub(1));
        let Some(phase) = self.phases.get(index) else { return self.standing() };
        let gone = progress(&phase.profile, t_s - phase.moves_s);
        Self::moment(phase, gone)
    }

    fn moment(phase: &Placed, gone: Progress) -> Moment {
        let spot = phase.way.at(gone.length);
        let velocity: Vec<f64> = spot.first.iter().map(|d| d * gone.speed).collect();
        let acceleration = spot.first.iter().zip(&spot.second);
        let acceleration: Vec<f64> =
            acceleration.map(|(d, bend)| d * gone.acceleration + bend * gone.speed * gone.speed).collect();
        let marks = phase.way.marks();
        let line = marks.partition_point(|mark| *mark <= gone.length).saturating_sub(1);
        let [from, to] =
            [line, line + 1].map(|knot| phase.knots.get(knot).or(phase.knots.last()).map_or(0.0, |k| *k as f64));
        let length = phase.way.lengths().get(line).copied().unwrap_or(f64::INFINITY);
        let part = ((gone.length - marks.get(line).copied().unwrap_or(0.0)) / length).clamp(0.0, 1.0);
        Moment {
            step: phase.step,
            base: base(&spot.point),
            base_velocity: base(&velocity),
            base_acceleration: base(&acceleration),
            joints: joints(&spot.point),
            joint_velocity: joints(&velocity),
            joint_acceleration: joints(&acceleration),
            waypoint: from + part * (to - from),
        }
    }

    /// Where the robot stands in a plan in which it does not move.
    fn standing(&self) -> Moment {
        let point = self.track.start.as_slice();
        let none = vec![0.0; joints(point).len()];
        Moment {
            step: 0,
            base: base(point),
            base_velocity: [0.0; 3],
            base_acceleration: [0.0; 3],
            joints: joints(point),
            joint_velocity: none.clone(),
            joint_acceleration: none,
            waypoint: 0.0,
        }
    }

    /// Where the links of the robot are in the world at a moment, by link of [`TimedPlan::tree`].
    pub fn links(&self, moment: &Moment) -> Vec<Isometry3<f64>> {
        let mut links = vec![Isometry3::identity(); self.body.tree.link_count()];
        let [x, y, yaw] = moment.base;
        let written = self.body.tree.forward(&moment.joints, &world_from_base(&[x, y, yaw]), &mut links);
        // The lengths are the tree's own.
        debug_assert!(written.is_ok(), "{written:?}");
        links
    }

    /// Where a link is in the frame of its parent at a moment; the same bits while the joint between them stands. The root, and what
    /// is no link, is in its own frame.
    pub fn parent_from_link(&self, moment: &Moment, link: usize) -> Isometry3<f64> {
        let mut links = vec![Isometry3::identity(); self.body.tree.link_count()];
        let written = self.body.tree.forward_only(&moment.joints, &[link], &mut links);
        // The lengths are the tree's own.
        debug_assert!(written.is_ok(), "{written:?}");
        links.get(link).copied().unwrap_or_default()
    }

    /// Where the plan has the objects at a moment: in the hand, pushed along, or at rest.
    pub fn objects(&self, moment: &Moment) -> BTreeMap<Arc<str>, Isometry3<f64>> {
        let Some(step_track) = self.track.steps.get(moment.step) else { return BTreeMap::new() };
        let below = moment.waypoint.floor().max(0.0);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "an index, as it was made")]
        let index = below as usize;
        let Some(from) = step_track.objects.get(index) else { return BTreeMap::new() };
        let to = step_track.objects.get(index + 1).unwrap_or(from);
        let share = moment.waypoint - below;
        let poses = from.iter().zip(to.values()).map(|((name, from), to)| {
            let from: Isometry3<f64> = (*from).into();
            (Arc::clone(name), from.lerp_slerp(&(*to).into(), share))
        });
        let mut poses: BTreeMap<_, _> = poses.collect();
        if let Some((object, tool_from_object)) = &step_track.holds
            && let Some(pose) = poses.get_mut(object.name.as_str())
        {
            let tool = self.body.hand(step_track.hand).tool;
            *pose = self.links(moment).get(tool).copied().unwrap_or_default() * tool_from_object;
        }
        poses
    }

    /// When the robot passes each waypoint of a step, seconds from the beginning of the step; it stands at the first at 0. `None`
    /// if there is no such step.
    pub fn waypoint_times_s(&self, step: usize) -> Option<Vec<f64>> {
        let points = &self.track.steps.get(step)?.points;
        let on_line = |from: usize, to: usize, at: usize| match (points.get(from), points.get(to), points.get(at)) {
            (Some(a), Some(b), Some(point)) => share(point, a, b),
            _ => 0.0,
        };
        Some(waypoint_times_s(self.timing.steps.get(step)?, points.len(), on_line))
    }

    /// Times between which nothing but time passes and speed changes evenly: where phases begin, move, stop and end, and where
    /// the pieces of their profiles meet. In order, each once.
    pub fn marks_s(&self) -> Vec<f64> {
        let mut marks = vec![0.0];
        for phase in &self.phases {
            marks.extend([phase.begin_s, phase.moves_s]);
            let mut now = phase.moves_s;
            for [seconds, _] in &phase.profile {
                now += seconds;
                marks.push(now);
            }
            marks.extend([phase.stops_s, phase.end_s]);
        }
        marks.sort_by(f64::total_cmp);
        marks.dedup_by(|b, a| *b - *a <= 1e-9);
        marks
    }

    /// All that happens besides motion, in order of time.
    pub fn events(&self) -> Vec<Event> {
        let mut events = Vec::new();
        for (step, step_track) in self.track.steps.iter().enumerate() {
            let Some(begin_s) = self.step_start_s(step) else { continue };
            let before = step.checked_sub(1).and_then(|before| self.track.steps.get(before));
            let has_driven = before.is_some_and(|step_track| step_track.contract.drives());
            let sets_down = step_track.contract.hand == HandUse::LetsGo;
            let touches = sets_down || (step_track.contract.fingers_touch && !step_track.contract.begins_holding());
            let touched = !sets_down && before.is_some_and(|step_track| step_track.contract.fingers_touch);
            if has_driven || (touches && !touched) {
                events.push(Event { time_s: begin_s, step, kind: EventKind::Sense });
            }
            let hand = self.body.hand(step_track.hand);
            for phase in self.phases.iter().filter(|phase| phase.step == step && phase.opens) {
                let finger = |s: f64| phase.way.at(s).point.get(BASE + hand.finger).copied().unwrap_or(0.0);
                let (from, to) = (finger(0.0), finger(phase.way.length()));
                let takes = step_track.contract.hand == HandUse::Takes;
                let force_n = takes.then_some(hand.grip_force_n);
                events.push(Event { time_s: phase.moves_s, step, kind: EventKind::Fingers { from, to, force_n } });
            }
        }
        events
    }
}

/// When each of `count` waypoints of a step is passed, seconds from its beginning; `share` says what part of the line between two
/// of them is gone at a third.
pub(crate) fn waypoint_times_s(
    timing: &StepTiming,
    count: usize,
    share: impl Fn(usize, usize, usize) -> f64,
) -> Vec<f64> {
    let mut times = vec![0.0; count];
    let mut begin_s = 0.0;
    for phase in &timing.phases {
        let mut mark = 0.0;
        for (pair, length) in phase.knots.windows(2).zip(&phase.lengths) {
            let &[from, to] = pair else { continue };
            for at in from + 1..=to {
                let share = if at == to { 1.0 } else { share(from, to, at) };
                let seconds = profile::time_of(&phase.profile, mark + share * length);
                if let Some(slot) = times.get_mut(at) {
                    *slot = begin_s + phase.wait_s + seconds;
                }
            }
            mark += length;
        }
        begin_s += phase.duration_s();
    }
    if let Some(slot) = times.last_mut() {
        *slot = begin_s;
    }
    let mut last = 0.0_f64;
    for time in &mut times {
        // Rounding apart they grow anyway; waypoints of a robot that stands are passed at once.
        last = last.max(*time);
        *time = last;
    }
    times
}

/// What part of the line from `a` to `b` is gone at a point on it.
fn share(point: &[f64], a: &[f64], b: &[f64]) -> f64 {
    let farthest =
        a.iter().zip(b).zip(point).max_by(|((a, b), _), ((c, d), _)| (*b - *a).abs().total_cmp(&(*d - *c).abs()));
    farthest.map_or(0.0, |((a, b), point)| if a == b { 0.0 } else { ((point - a) / (b - a)).clamp(0.0, 1.0) })
}

fn base(point: &[f64]) -> [f64; 3] {
    [0, 1, 2].map(|i| point.get(i).copied().unwrap_or(0.0))
}

fn joints(point: &[f64]) -> Vec<f64> {
    point.get(BASE..).unwrap_or_default().to_vec()
}
