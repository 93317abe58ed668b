//! When the robot is where: the waypoints of a plan on a slow clock.
//!
//! Each straight run of a step begins and ends at rest and is ramped up and down; at corners the robot stops. Speeds are far
//! below those of the robot, so that pushes are quasi-static and nothing is thrown.

use darrt_primitives::contract::{Contract, HandUse, HandWay};
use darrt_primitives::kinematics::limit::wrap_to_pi;
use darrt_task::plan_file::{PlanFile, Step};
use nalgebra::{Isometry3, Vector3};

use crate::error::ExecuteError;
use crate::robot::{Robot, world_from_base};

/// What part of its greatest speed a joint has at most.
const JOINT_PACE: f64 = 0.3;
/// The same for a joint whose greatest speed is not known, rad/s or m/s.
const UNKNOWN_PACE: f64 = 0.3;
/// How fast the base drives, m/s, and turns, rad/s.
const BASE_PACE: [f64; 2] = [0.3, 0.5];
/// How fast the hand goes: on a free way, with something in it, near contact, in a push; m/s.
const HAND_PACE: [f64; 4] = [0.4, 0.2, 0.1, 0.05];
/// How fast each fingertip goes, m/s.
const FINGER_PACE: f64 = 0.03;
/// Time from rest to full speed, s.
const RAMP_S: f64 = 0.4;
/// Pause when the hand has closed or opened, s.
const PAUSE_S: f64 = 0.5;
/// Runs whose directions differ by more than this, as a cosine, are parted by a stop.
const CORNER_COS: f64 = 0.95;

/// What the fingers do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Grip {
    /// They stand at a value of their joint.
    At(f64),
    /// They close on what is between them, with the force of the gripper; their joint is commanded to this value.
    Closing(f64),
}

/// Where the robot shall be at one moment.
#[derive(Debug, Clone)]
pub(crate) struct Command {
    pub(crate) base: [f64; 3],
    /// By variable.
    pub(crate) joints: Vec<f64>,
    pub(crate) grip: Grip,
    /// Part of the drive of this step that is done, 0 to 1.
    pub(crate) driven: f64,
}

/// A step with its clock.
#[derive(Debug)]
pub(crate) struct TimedStep {
    pub(crate) contract: Contract,
    /// By waypoint.
    bases: Vec<[f64; 3]>,
    joints: Vec<Vec<f64>>,
    /// By waypoint: the pace at which it would be reached without ramps, s.
    nominal: Vec<f64>,
    runs: Vec<Run>,
    finger: usize,
    /// By variable.
    turns: Vec<bool>,
    closed: f64,
    /// The segment in which the hand closes on something, or opens from it.
    closing: Option<usize>,
    opening: Option<usize>,
    /// Index of the object in the hand.
    pub(crate) holds: Option<(usize, Isometry3<f64>)>,
    pub(crate) pushes: Option<usize>,
    /// Where the objects shall be at the end.
    pub(crate) ends: Vec<Isometry3<f64>>,
}

/// A part of a step that is done at one go.
#[derive(Debug, Clone, Copy)]
struct Run {
    /// In nominal time, s.
    from: f64,
    to: f64,
    /// On the clock, s.
    start: f64,
    /// When it is done, the pause after it not counted.
    end: f64,
    /// With the pause.
    rest: f64,
}

impl TimedStep {
    /// When the step is over, s after its beginning.
    pub(crate) fn duration_s(&self) -> f64 {
        self.runs.last().map_or(0.0, |run| run.rest)
    }

    /// When the hand has closed on something in this step, s after its beginning.
    pub(crate) fn closed_s(&self) -> Option<f64> {
        self.closing?;
        self.runs.first().map(|run| run.rest)
    }

    /// When the hand begins to let go, s after its beginning.
    pub(crate) fn lets_go_s(&self) -> Option<f64> {
        self.opening?;
        self.runs.last().map(|run| run.start)
    }

    /// Where the robot shall be at time `t`, s after the beginning of the step.
    pub(crate) fn at(&self, t: f64) -> Command {
        let nominal = self.nominal_at(t);
        let last = self.nominal.len().saturating_sub(1);
        let segment = self.nominal.partition_point(|&at| at <= nominal).clamp(1, last.max(1)) - 1;
        let (from, to) = (self.nominal[segment], self.nominal[segment + 1]);
        let part = if to > from { ((nominal - from) / (to - from)).clamp(0.0, 1.0) } else { 1.0 };
        let (a, b) = (&self.bases[segment], &self.bases[segment + 1]);
        let base = [a[0] + part * (b[0] - a[0]), a[1] + part * (b[1] - a[1]), a[2] + part * wrap_to_pi(b[2] - a[2])];
        let ends = self.joints[segment].iter().zip(&self.joints[segment + 1]).zip(&self.turns);
        let joints: Vec<f64> = ends
            .map(|((a, b), turns)| a + part * if *turns { wrap_to_pi(b - a) } else { b - a })
            .collect();
        let whole = self.nominal.last().copied().unwrap_or(0.0);
        let driven = if whole > 0.0 { (nominal / whole).clamp(0.0, 1.0) } else { 1.0 };
        Command { grip: self.grip(segment, part, nominal, &joints), base, joints, driven }
    }

    fn grip(&self, segment: usize, part: f64, nominal: f64, joints: &[f64]) -> Grip {
        let planned = joints.get(self.finger).copied().unwrap_or(self.closed);
        if let Some(closing) = self.closing {
            // What is missed is closed upon all the same.
            let open = self.joints[closing].get(self.finger).copied().unwrap_or(planned);
            let part = if segment > closing || nominal >= self.nominal[closing + 1] { 1.0 } else { part };
            return Grip::Closing(open + part * (self.closed - open));
        }
        let is_open = self.opening.is_some_and(|opening| segment >= opening && nominal > self.nominal[opening]);
        if self.holds.is_some() && !is_open { Grip::Closing(self.closed) } else { Grip::At(planned) }
    }

    fn nominal_at(&self, t: f64) -> f64 {
        let index = self.runs.partition_point(|run| run.rest <= t).min(self.runs.len().saturating_sub(1));
        let Some(run) = self.runs.get(index) else { return 0.0 };
        let (way, duration, now) = (run.to - run.from, run.end - run.start, (t - run.start).max(0.0));
        if now >= duration {
            return run.to;
        }
        let ramp = RAMP_S.min(duration / 2.0);
        // Ramped up, even, ramped down: the mean speed is that of the whole less one ramp.
        let peak = way / (duration - ramp);
        let left = duration - now;
        if now < ramp {
            run.from + peak * now * now / (2.0 * ramp)
        } else if left < ramp {
            run.to - peak * left * left / (2.0 * ramp)
        } else {
            run.from + peak * (now - ramp / 2.0)
        }
    }
}

/// The steps of a plan with their clocks.
///
/// # Errors
/// A step names an object or a primitive that is not there, has fewer than two waypoints, or one of them lacks something.
pub(crate) fn steps(plan: &PlanFile, robot: &Robot) -> Result<Vec<TimedStep>, ExecuteError> {
    plan.steps.iter().enumerate().map(|(index, step)| timed(plan, robot, index, step)).collect()
}

fn timed(plan: &PlanFile, robot: &Robot, index: usize, step: &Step) -> Result<TimedStep, ExecuteError> {
    let place = format!("steps[{index}]");
    let missing = |what, name: &str| ExecuteError::Missing { place: place.clone(), what, name: name.to_owned() };
    let contract = plan.contracts.get(&step.primitive);
    let contract = *contract.ok_or_else(|| missing("contract of the primitive", step.primitive.as_str()))?;
    let object = |name: &String| {
        let found = plan.problem.objects.iter().position(|object| object.name == *name);
        found.ok_or_else(|| missing("object", name))
    };
    let holds = step.holds.as_ref();
    let holds = holds.map(|hold| Ok::<_, ExecuteError>((object(&hold.object)?, hold.tool_from_object.into())));
    let holds = holds.transpose()?;
    let mut joints = Vec::with_capacity(step.waypoints.len());
    for (at, waypoint) in step.waypoints.iter().enumerate() {
        let values = robot.table.variables(&waypoint.joints);
        joints.push(values.map_err(|flaw| ExecuteError::Joints { place: format!("{place}.waypoints[{at}]"), flaw })?);
    }
    let last = step.waypoints.last().filter(|_| joints.len() > 1).ok_or_else(|| missing("waypoint", "second"))?;
    let end = |name: &String| last.objects.get(name.as_str()).copied().ok_or_else(|| missing("object", name));
    let ends = plan.problem.objects.iter().map(|object| end(&object.name).map(Isometry3::from));
    let bases: Vec<_> = step.waypoints.iter().map(|waypoint| waypoint.base).collect();
    let segments = joints.len() - 1;
    let is_of_fingers =
        |segment: usize| joints[segment].get(robot.finger) != joints[segment + 1].get(robot.finger);
    let closing = (contract.hand == HandUse::Takes).then(|| (0..segments).find(|&at| is_of_fingers(at))).flatten();
    let opening = (contract.hand == HandUse::LetsGo).then(|| (0..segments).rfind(|&at| is_of_fingers(at))).flatten();
    let turns = robot.tree.variables().iter().map(|variable| variable.limit.is_unlimited()).collect();
    let mut timed = TimedStep {
        contract,
        bases,
        joints,
        nominal: vec![0.0],
        runs: Vec::new(),
        finger: robot.finger,
        turns,
        closed: robot.hand.closed(),
        closing,
        opening,
        holds,
        pushes: step.pushes.as_ref().map(object).transpose()?,
        ends: ends.collect::<Result<_, _>>()?,
    };
    timed.pace(robot);
    Ok(timed)
}

/// How a segment goes, for telling corners: what moves, in units of its pace.
type Direction = Vec<f64>;

impl TimedStep {
    /// Fills in `nominal` and `runs`.
    fn pace(&mut self, robot: &Robot) {
        let hand_pace = match (self.pushes, self.contract.hand, self.contract.way) {
            (Some(_), ..) => HAND_PACE[3],
            (None, _, HandWay::Straight | HandWay::Own) => HAND_PACE[2],
            (None, HandUse::Empty, _) => HAND_PACE[0],
            _ => HAND_PACE[1],
        };
        let mut links = Vec::new();
        let mut hand = |at: usize| {
            robot.link_poses(&world_from_base(self.bases[at]), &self.joints[at], &mut links);
            links.get(robot.tool).map_or_else(Vector3::zeros, |pose| pose.translation.vector)
        };
        let (mut now, mut begin, mut before): (f64, f64, Option<Direction>) = (0.0, 0.0, None);
        let mut runs = Vec::new();
        let mut from = hand(0);
        for at in 0..self.joints.len() - 1 {
            let to = hand(at + 1);
            let direction = self.direction(robot, at);
            let widest = direction.iter().fold(0.0_f64, |most, part| most.max(part.abs()));
            let seconds = widest.max((to - from).norm() / hand_pace);
            let is_grip = self.closing == Some(at) || self.opening == Some(at);
            let is_corner = before.as_ref().is_some_and(|before| is_corner(before, &direction));
            if (is_grip || is_corner) && now > begin {
                runs.push((begin, now, false));
                begin = now;
            }
            let seconds = if self.closing == Some(at) { seconds.max(self.closing_s(robot, at)) } else { seconds };
            now += seconds;
            self.nominal.push(now);
            if is_grip {
                runs.push((begin, now, true));
                begin = now;
            }
            before = if is_grip || seconds == 0.0 { None } else { Some(direction) };
            from = to;
        }
        if now > begin {
            runs.push((begin, now, false));
        }
        let mut clock = 0.0;
        for (from, to, is_grip) in runs {
            let way: f64 = to - from;
            // Short ways are not driven at full speed.
            let duration = way + RAMP_S.min((way * RAMP_S).sqrt());
            let rest = clock + duration + if is_grip { PAUSE_S } else { 0.0 };
            self.runs.push(Run { from, to, start: clock, end: clock + duration, rest });
            clock = rest;
        }
    }

    /// Time in which the hand closes altogether.
    fn closing_s(&self, robot: &Robot, segment: usize) -> f64 {
        let width = |joint: f64| robot.hand.at_joint(joint).half_width();
        let open = self.joints[segment].get(self.finger).copied().unwrap_or(self.closed);
        (width(open) - width(self.closed)) / FINGER_PACE
    }

    /// Seconds that each coordinate takes in a segment, with its sign.
    fn direction(&self, robot: &Robot, segment: usize) -> Direction {
        let (a, b) = (&self.bases[segment], &self.bases[segment + 1]);
        let base = [(b[0] - a[0]) / BASE_PACE[0], (b[1] - a[1]) / BASE_PACE[0], wrap_to_pi(b[2] - a[2]) / BASE_PACE[1]];
        let ends = self.joints[segment].iter().zip(&self.joints[segment + 1]).zip(robot.tree.variables());
        let joints = ends.enumerate().map(|(index, ((a, b), variable))| {
            if index == self.finger {
                let width = |joint: f64| robot.hand.at_joint(joint).half_width();
                return (width(*b) - width(*a)) / FINGER_PACE;
            }
            let way = if variable.limit.is_unlimited() { wrap_to_pi(b - a) } else { b - a };
            let pace = if variable.max_velocity > 0.0 { JOINT_PACE * variable.max_velocity } else { UNKNOWN_PACE };
            way / pace
        });
        base.into_iter().chain(joints).collect()
    }
}

fn is_corner(before: &Direction, after: &Direction) -> bool {
    let dot: f64 = before.iter().zip(after).map(|(a, b)| a * b).sum();
    let norm = |v: &Direction| v.iter().map(|part| part * part).sum::<f64>().sqrt();
    let norms = norm(before) * norm(after);
    norms > 0.0 && dot < CORNER_COS * norms
}
