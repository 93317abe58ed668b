//! When the robot is where, and what its fingers are told: the clock of the plan with the object of every step.

use std::collections::BTreeMap;
use std::sync::Arc;

use darrt_core::budget::Cancel;
use darrt_primitives::contract::{Contract, HandUse};
use darrt_task::clock::{EventKind, Moment, TimedPlan, give_clock};
use darrt_task::plan_file::{PlanFile, Step};
use darrt_task::robot::RobotFacts;
use darrt_task::verify::VerifyOptions;
use nalgebra::Isometry3;

use crate::error::ExecuteError;
use crate::robot::Robot;

/// How fast each fingertip closes beyond where the plan has it, on what it has found or missed, m/s.
const SQUEEZE_M_PER_S: f64 = 0.05;
/// Times are found to this, s: far less than a time step.
const TIME_ROUNDING_S: f64 = 1e-5;

/// A plan on its clock.
#[derive(Debug)]
pub(crate) struct Timeline {
    plan: TimedPlan,
    pub(crate) steps: Vec<TimedStep>,
}

/// Where the robot shall be at one moment.
#[derive(Debug, Clone)]
pub(crate) struct Command {
    pub(crate) base: [f64; 3],
    /// By variable.
    pub(crate) joints: Vec<f64>,
    /// The joint of the fingers, which close and open with the force of the gripper at most.
    pub(crate) finger: f64,
    /// Part of the step that is done, 0 to 1.
    pub(crate) done: f64,
}

/// A step with its times, in seconds of the plan's clock.
#[derive(Debug)]
pub(crate) struct TimedStep {
    pub(crate) contract: Contract,
    /// Index of the object in the hand, and its pose in the tool frame.
    pub(crate) holds: Option<(usize, Isometry3<f64>)>,
    pub(crate) pushes: Option<usize>,
    /// The object that it is about.
    pub(crate) object: Option<usize>,
    /// Is it a good time to look where everything is before it begins?
    pub(crate) senses: bool,
    /// Where the objects shall be at the end.
    pub(crate) ends: Vec<Isometry3<f64>>,
    pub(crate) begin_s: f64,
    pub(crate) end_s: f64,
    segments: f64,
    /// When the fingers are where the plan closes them, and when the hand moves on with what it has taken.
    closes: Option<[f64; 2]>,
    /// When the fingers begin to open from what they let go.
    lets_go_s: Option<f64>,
}

impl TimedStep {
    /// Should the step's object be in the hand?
    pub(crate) fn is_holding(&self, time_s: f64) -> bool {
        let has_taken = self.closes.is_none_or(|[_, moves_on]| time_s >= moves_on);
        self.holds.is_some() && has_taken && self.lets_go_s.is_none_or(|lets_go| time_s < lets_go)
    }
}

impl Timeline {
    /// A plan on its own clock, or, if it has none, on the one that is made for it.
    ///
    /// # Errors
    /// A clock that is none, or a step that names an object or a primitive that is not there.
    pub(crate) fn new(plan: &PlanFile, facts: &RobotFacts, robot: &Robot) -> Result<Self, ExecuteError> {
        check_first_arm(plan, facts)?;
        // One that the verifier accepts: where corners are rounded too much something is in the way.
        let mut own = None;
        if plan.timing.is_none() {
            let plan = own.insert(plan.clone());
            give_clock(plan, facts, &VerifyOptions::default(), &Cancel::new())?;
        }
        let plan = own.as_ref().unwrap_or(plan);
        let timed = TimedPlan::new(plan, facts)?;
        let senses = timed.events().into_iter().filter(|event| event.kind == EventKind::Sense).map(|event| event.step);
        let senses: Vec<_> = senses.collect();
        let steps = plan.steps.iter().enumerate();
        let steps = steps.map(|(index, step)| timed_step(&timed, plan, robot, &senses, (index, step)));
        let steps = steps.collect::<Result<_, _>>()?;
        Ok(Self { plan: timed, steps })
    }

    /// Seconds of the whole plan.
    pub(crate) fn duration_s(&self) -> f64 {
        self.plan.duration_s()
    }

    /// Where the robot is before the first step, and its joints.
    pub(crate) fn start(&self) -> ([f64; 3], Vec<f64>) {
        let moment = self.plan.at(0.0);
        (moment.base, moment.joints)
    }

    /// Where the plan has the objects at a time of its clock that lies in this step, by their names.
    pub(crate) fn objects(&self, step: &TimedStep, time_s: f64) -> BTreeMap<Arc<str>, Isometry3<f64>> {
        self.plan.objects(&self.moment(step, time_s))
    }

    /// The plan at a time that lies in this step: at its very end a step is still that step.
    fn moment(&self, step: &TimedStep, time_s: f64) -> Moment {
        self.plan.at(time_s.min(step.end_s - TIME_ROUNDING_S).max(step.begin_s))
    }

    /// What the robot is told at a time of the plan's clock that lies in this step.
    pub(crate) fn at(&self, step: &TimedStep, time_s: f64, robot: &Robot) -> Command {
        let moment = self.moment(step, time_s);
        let planned = moment.joints.get(robot.finger).copied().unwrap_or_else(|| robot.hand.closed());
        let finger = match step.closes {
            Some([there, _]) => squeezed(robot, planned, time_s - there),
            None if step.is_holding(time_s) => robot.hand.closed(),
            None => planned,
        };
        let done = if time_s >= step.end_s { 1.0 } else { (moment.waypoint / step.segments).clamp(0.0, 1.0) };
        Command { base: moment.base, joints: moment.joints, finger, done }
    }
}

/// Only the first arm and hand of a robot can be told what to do here.
fn check_first_arm(plan: &PlanFile, facts: &RobotFacts) -> Result<(), ExecuteError> {
    let Some(second) = &facts.second else { return Ok(()) };
    let others: Vec<_> = second.arm_joints.iter().filter(|name| !facts.arm_joints.contains(name)).collect();
    for (step, action) in (1..).zip(&plan.steps) {
        if let Some(tool) = action.tool.as_ref().filter(|tool| **tool != facts.tool_link) {
            return Err(ExecuteError::SecondArm { step, what: format!("is one of the hand of `{tool}`") });
        }
        let moves = |name: &&&String| {
            let mut values = action.waypoints.iter().map(|waypoint| waypoint.joints.get(name.as_str()));
            let first = values.next();
            values.any(|value| Some(value) != first)
        };
        if let Some(joint) = others.iter().find(moves) {
            return Err(ExecuteError::SecondArm { step, what: format!("moves `{joint}`") });
        }
    }
    Ok(())
}

/// The joint of fingers that have gone on closing from where the plan has them for so long.
fn squeezed(robot: &Robot, planned: f64, seconds: f64) -> f64 {
    if seconds <= 0.0 {
        return planned;
    }
    let width = robot.hand.at_joint(planned).half_width();
    robot.hand.at_half_width(width - SQUEEZE_M_PER_S * seconds).joint
}

fn timed_step(
    timed: &TimedPlan,
    plan: &PlanFile,
    robot: &Robot,
    senses: &[usize],
    (index, step): (usize, &Step),
) -> Result<TimedStep, ExecuteError> {
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
    let last = step.waypoints.last().ok_or_else(|| missing("waypoint", "first"))?;
    let end = |name: &String| last.objects.get(name.as_str()).copied().ok_or_else(|| missing("object", name));
    let ends = plan.problem.objects.iter().map(|object| end(&object.name).map(Isometry3::from));
    let finger = robot.tree.variables().get(robot.finger).map_or("", |variable| &variable.name);
    let is_of_fingers = |pair: &[darrt_task::plan_file::Waypoint]| match pair {
        [a, b] => a.joints.get(finger) != b.joints.get(finger),
        _ => false,
    };
    let mut pairs = step.waypoints.windows(2);
    let closing = (contract.hand == HandUse::Takes).then(|| pairs.position(is_of_fingers)).flatten();
    let mut pairs = step.waypoints.windows(2);
    let opening = (contract.hand == HandUse::LetsGo).then(|| pairs.rposition(is_of_fingers)).flatten();
    let begin_s = timed.step_start_s(index).unwrap_or(0.0);
    let end_s = timed.step_start_s(index + 1).unwrap_or(begin_s);
    let when = |is_past: &dyn Fn(f64) -> bool| first_time(timed, begin_s, end_s, is_past);
    let passed = |waypoint: usize, by: f64| when(&|at| at > waypoint as f64 + by);
    Ok(TimedStep {
        contract,
        holds: holds.transpose()?,
        pushes: step.pushes.as_ref().map(object).transpose()?,
        object: step.object.as_ref().map(object).transpose()?,
        senses: senses.contains(&index),
        ends: ends.collect::<Result<_, _>>()?,
        begin_s,
        end_s,
        segments: (step.waypoints.len() - 1).max(1) as f64,
        closes: closing.map(|at| [passed(at + 1, -1e-6), passed(at + 1, 1e-6)]),
        lets_go_s: opening.map(|at| passed(at, 1e-6)),
    })
}

/// When the plan has gone past something on the way of a step: a bisection, because a plan never goes back.
fn first_time(timed: &TimedPlan, begin_s: f64, end_s: f64, is_past: &dyn Fn(f64) -> bool) -> f64 {
    let (mut before, mut after) = (begin_s, end_s);
    while after - before > TIME_ROUNDING_S {
        let middle = f64::midpoint(before, after);
        if is_past(timed.at(middle).waypoint) {
            after = middle;
        } else {
            before = middle;
        }
    }
    after
}
