//! One execution: the plan as it is, open loop, in a world that may be off from what it knows.

use darrt_core::budget::Cancel;
use darrt_geom::Scene;
use darrt_primitives::contract::HandUse;
use darrt_task::plan_file::PlanFile;
use darrt_task::problem_file::ProblemFile;
use darrt_task::robot::RobotFacts;
use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use serde::Serialize;

use crate::error::ExecuteError;
use crate::goal::{self, Now, ObjectEnd};
use crate::noise::{Draws, NoiseModel, PlanarError};
use crate::robot::Robot;
use crate::stage::{Owner, STEP_S, Scenery, Stage, TrueObject};
use crate::timeline::{TimedStep, Timeline};
use crate::watch::{Cause, Departure, Event, Watch};

/// Time that things are given to come to rest before the plan begins and when it is over, s.
const SETTLE_S: f64 = 0.5;
/// Time steps between two looks at where the objects are: a tenth of a second.
const LOOK_EVERY: u64 = 24;

/// A plan ready to be executed any number of times.
#[derive(Debug)]
pub struct Execution<'a> {
    problem: &'a ProblemFile,
    primitives: Vec<String>,
    robot: Robot,
    scenery: Scenery,
    scene: Scene,
    timeline: Timeline,
    starts: Vec<Isometry3<f64>>,
    depths: Vec<f64>,
}

/// How one execution went.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RunReport {
    /// Its number, from 0.
    pub run: u64,
    /// Is every object where it should be within the tolerance of the problem, and nothing else moved?
    pub is_success: bool,
    /// The same with 5 cm instead of the tolerance.
    pub is_near: bool,
    /// The first departure from the plan; in a run that succeeds all the same, a small one.
    pub departure: Option<Departure>,
    /// What ended the run before its plan did.
    pub stopped: Option<Departure>,
    /// Where the objects end.
    pub objects: Vec<ObjectEnd>,
    /// Where they were after every step.
    pub trail: Vec<StepEnd>,
    /// Seconds on the clock of the plan.
    pub seconds: f64,
}

/// Where the objects are after a step.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StepEnd {
    /// The step, from 1.
    pub step: usize,
    /// Its primitive.
    pub primitive: String,
    /// By object, in the order of the problem: how far it is from where the plan has it, metres.
    pub off_m: Vec<f64>,
    /// By object: the angle between its axis and that of the plan, degrees.
    pub lean_deg: Vec<f64>,
}

impl<'a> Execution<'a> {
    /// Builds robot, room and clock of a plan.
    ///
    /// # Errors
    /// [`ExecuteError`] for a plan, a problem or a robot of which that cannot be done.
    pub fn new(plan: &'a PlanFile, facts: &RobotFacts) -> Result<Self, ExecuteError> {
        let problem = &plan.problem;
        let robot = Robot::new(facts)?;
        let geometry = problem.geometry()?;
        Ok(Self {
            problem,
            primitives: plan.steps.iter().map(|step| step.primitive.to_string()).collect(),
            timeline: Timeline::new(plan, facts, &robot)?,
            scenery: Scenery::new(problem)?,
            robot,
            starts: geometry.objects.iter().map(|object| object.world_from_object).collect(),
            depths: geometry.objects.iter().map(|object| object.depth_below_origin).collect(),
            scene: geometry.scene,
        })
    }

    /// Seconds that the plan takes on its clock.
    pub fn duration_s(&self) -> f64 {
        self.timeline.duration_s()
    }

    /// Executes the plan once; `None` if it was cancelled meanwhile.
    ///
    /// # Laws
    /// The report depends on the plan, the noise, `seed` and `run` alone.
    pub fn run(&self, noise: &NoiseModel, seed: u64, run: u64, cancel: &Cancel) -> Option<RunReport> {
        let mut draws = Draws::new(*noise, seed, run);
        let objects = self.starts.iter().zip(&self.problem.objects).map(|(pose, spec)| {
            let draw = draws.object();
            let [x, y, yaw] = draw.at;
            let mut pose = *pose;
            pose.translation.vector += Vector3::new(x, y, 0.0);
            pose.rotation = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw) * pose.rotation;
            TrueObject {
                world_from_object: pose,
                mass_kg: spec.mass_kg * draw.mass,
                table_friction: spec.friction.table * draw.table_friction,
                finger_friction: spec.friction.fingers * draw.finger_friction,
            }
        });
        let objects: Vec<_> = objects.collect();
        let mut biases = vec![0.0; self.robot.tree.variables().len()];
        for (variable, bias) in self.robot.arm.iter().zip(draws.joint_biases(self.robot.arm.len())) {
            if let Some(slot) = biases.get_mut(*variable) {
                *slot = bias;
            }
        }
        let mut now = Performance::begin(self, &objects, biases);
        let mut trail = Vec::new();
        for (index, step) in self.timeline.steps.iter().enumerate() {
            if step.contract.drives() {
                now.next_error = draws.drive(now.error);
            }
            if cancel.is_cancelled() {
                return None;
            }
            let is_over = now.step(index, step);
            trail.push(now.end_of(index, step));
            if is_over {
                break;
            }
        }
        Some(now.report(run, trail))
    }

    fn name(&self, owner: Owner) -> String {
        let name = match owner {
            Owner::Room(index) => self.scenery.names.get(index).cloned(),
            Owner::Object(index) => self.problem.objects.get(index).map(|object| object.name.clone()),
            Owner::Link(index) => self.robot.tree.link_names().get(index).map(ToString::to_string),
        };
        name.unwrap_or_else(|| "?".to_owned())
    }

    fn primitive(&self, step: usize) -> String {
        self.primitives.get(step).cloned().unwrap_or_default()
    }

    fn departure(&self, step: usize, time: f64, event: &Event) -> Departure {
        Departure {
            step: step + 1,
            primitive: self.primitive(step),
            time,
            cause: event.cause,
            body: self.name(event.body),
            other: event.other.map(|other| self.name(other)),
            off_m: event.off_m,
            lean_deg: event.lean_deg,
            force_n: event.force_n,
        }
    }
}

/// An execution under way.
struct Performance<'a> {
    of: &'a Execution<'a>,
    stage: Stage<'a>,
    watch: Watch,
    biases: Vec<f64>,
    /// Of the base, before and after the drive under way.
    error: PlanarError,
    next_error: PlanarError,
    departure: Option<Departure>,
    stopped: Option<Departure>,
    ticks: u64,
    /// By object.
    planned: Vec<Isometry3<f64>>,
}

impl<'a> Performance<'a> {
    fn begin(of: &'a Execution<'a>, objects: &[TrueObject], biases: Vec<f64>) -> Self {
        let (base, mut joints) = of.timeline.start();
        add(&mut joints, &biases);
        let mut stage = Stage::new(&of.robot, &of.scenery, objects, base, &joints);
        let finger = joints.get(of.robot.finger).copied().unwrap_or_default();
        for _ in 0..ticks(SETTLE_S) {
            stage.step(base, &mut joints, finger);
        }
        let watch = Watch::new(&stage, objects.len(), of.scenery.floor);
        let error = [0.0; 3];
        let planned = of.starts.clone();
        Self { of, stage, watch, biases, error, next_error: error, departure: None, stopped: None, ticks: 0, planned }
    }

    /// Executes one step; true if that was the last.
    fn step(&mut self, index: usize, step: &TimedStep) -> bool {
        self.watch.begin(&self.stage, &self.planned);
        let (length_s, mut elapsed) = (step.end_s - step.begin_s, 0);
        let count = ticks(length_s);
        while elapsed < count {
            elapsed += 1;
            let time_s = step.begin_s + elapsed as f64 * STEP_S;
            let mut command = self.of.timeline.at(step, time_s, &self.of.robot);
            let error = [0, 1, 2].map(|i| self.error[i] + command.done * (self.next_error[i] - self.error[i]));
            let base = [0, 1, 2].map(|i| command.base[i] + error[i]);
            add(&mut command.joints, &self.biases);
            self.stage.step(base, &mut command.joints, command.finger);
            self.ticks += 1;
            let is_held = step.is_holding(time_s);
            let mut event = self.watch.touch(&self.stage, step, is_held);
            if event.is_none() && (elapsed % LOOK_EVERY == 0 || elapsed == count) {
                event = self.watch.look(&self.stage, step, is_held);
            }
            if let Some(event) = event {
                self.note(index, elapsed as f64 / count as f64, &event);
                if self.stopped.is_some() {
                    return true;
                }
            }
        }
        self.error = self.next_error;
        self.planned.clone_from(&step.ends);
        if let Some(event) = self.watch.end(&self.stage, step) {
            self.note(index, 1.0, &event);
        }
        false
    }

    /// The first event is the departure; what follows is its consequence.
    fn note(&mut self, step: usize, time: f64, event: &Event) {
        if self.departure.is_none() {
            self.departure = Some(self.of.departure(step, time, event));
        }
        if event.is_final() {
            self.stopped = Some(self.of.departure(step, time, event));
        }
    }

    fn end_of(&self, index: usize, step: &TimedStep) -> StepEnd {
        let pairs = || step.ends.iter().enumerate().map(|(object, end)| (self.stage.object(object), end));
        StepEnd {
            step: index + 1,
            primitive: self.of.primitive(index),
            off_m: pairs().map(|(now, end)| (now.translation.vector - end.translation.vector).norm()).collect(),
            lean_deg: pairs().map(|(now, end)| goal::lean_deg(&now, end)).collect(),
        }
    }

    fn report(mut self, run: u64, trail: Vec<StepEnd>) -> RunReport {
        let last = self.of.timeline.steps.last();
        if let (Some(step), false) = (last, self.stopped.is_some()) {
            let mut command = self.of.timeline.at(step, step.end_s, &self.of.robot);
            add(&mut command.joints, &self.biases);
            let base = [0, 1, 2].map(|i| command.base[i] + self.error[i]);
            for _ in 0..ticks(SETTLE_S) {
                self.stage.step(base, &mut command.joints, command.finger);
            }
        }
        let held = last.filter(|step| step.contract.hand != HandUse::LetsGo).and_then(|step| step.holds);
        let objects = self.of.problem.objects.iter().enumerate().map(|(index, object)| {
            let is_planned_in_hand = held.is_some_and(|(held, _)| held == index);
            let now = Now {
                pose: self.stage.object(index),
                is_in_hand: is_planned_in_hand && !self.stage.is_closed(),
                planned: self.planned.get(index).copied().unwrap_or_else(Isometry3::identity),
                depth_m: self.of.depths.get(index).copied().unwrap_or_default(),
            };
            goal::end(self.of.problem, &self.of.scene, &object.name, &now)
        });
        let objects: Vec<ObjectEnd> = objects.collect();
        let is_success = self.stopped.is_none() && objects.iter().all(|object| object.is_there);
        let is_near = self.stopped.is_none() && objects.iter().all(|object| object.is_near);
        if !is_success && self.departure.is_none() {
            self.departure = self.added_up(&objects);
        }
        let seconds = self.ticks as f64 * STEP_S;
        RunReport {
            run,
            is_success,
            is_near,
            departure: self.departure,
            stopped: self.stopped,
            objects,
            trail,
            seconds,
        }
    }

    /// What is off at the end though nothing was far off on the way.
    fn added_up(&self, objects: &[ObjectEnd]) -> Option<Departure> {
        let index = objects.iter().position(|object| !object.is_there)?;
        let object = objects.get(index)?;
        let event = Event {
            cause: Cause::Added,
            body: Owner::Object(index),
            other: None,
            off_m: object.off_m,
            lean_deg: object.lean_deg,
            force_n: 0.0,
        };
        Some(self.of.departure(self.of.timeline.steps.len().saturating_sub(1), 1.0, &event))
    }
}

fn add(joints: &mut [f64], biases: &[f64]) {
    joints.iter_mut().zip(biases).for_each(|(joint, bias)| *joint += bias);
}

/// Time steps in so many seconds.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "seconds of a plan, not negative")]
fn ticks(seconds: f64) -> u64 {
    (seconds / STEP_S).ceil().clamp(0.0, 1e9) as u64
}
