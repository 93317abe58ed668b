//! One execution under way: the world steps on, the plan goes on, and, in a closed loop, the robot looks and corrects.

use std::sync::Arc;

use darrt_core::budget::Cancel;
use darrt_primitives::contract::HandUse;
use darrt_task::plan_file::PlanFile;
use nalgebra::Isometry3;

use crate::course::Course;
use crate::feedback::{Feedback, Offsets};
use crate::goal::{self, Now, ObjectEnd};
use crate::noise::{Draws, NoiseModel, PlanarError};
use crate::progress::advance;
use crate::recording::{FRAME_S, Frame, RecordedStep, Recording};
use crate::run::{Execution, FeedbackCount, Loop, RunReport, StepEnd};
use crate::stage::{Owner, STEP_S, Stage, TrueObject};
use crate::timeline::{Command, TimedStep};
use crate::watch::{Cause, Departure, Event, Watch};

/// Time that things are given to come to rest before the plan begins and when it is over, s.
const SETTLE_S: f64 = 0.5;
/// Time steps between two looks at where the objects are: a tenth of a second.
const LOOK_EVERY: u64 = 24;
/// How fast joints go when the arm is corrected while all else stands, rad/s or m/s: a hand at 0.8 m goes 0.1 m/s.
const CORRECTING_PER_S: f64 = 0.12;
/// Offsets of joints that differ by less are the same.
const SAME_OFFSET: f64 = 1e-6;

/// An execution under way.
pub(crate) struct Performance<'a> {
    pub(crate) of: &'a Execution<'a>,
    pub(crate) course: Arc<Course>,
    /// The plan under way, and how many there were before it.
    pub(crate) file: PlanFile,
    pub(crate) plan: usize,
    pub(crate) stage: Stage<'a>,
    pub(crate) watch: Watch,
    biases: Vec<f64>,
    pub(crate) draws: Draws,
    /// Of the base, before and after the drive under way.
    pub(crate) error: PlanarError,
    pub(crate) next_error: PlanarError,
    pub(crate) feedback: Option<Feedback>,
    pub(crate) control: Loop<'a>,
    pub(crate) replans: usize,
    pub(crate) failed_replans: usize,
    pub(crate) backed_off: usize,
    departure: Option<Departure>,
    pub(crate) stopped: Option<Departure>,
    pub(crate) ticks: u64,
    pub(crate) recording: Option<Recording>,
    /// By object: where the plan has it at the end of the last step,
    pub(crate) planned: Vec<Isometry3<f64>>,
    /// and where it has it now; kept up for recordings alone.
    now_planned: Vec<Isometry3<f64>>,
}

impl<'a> Performance<'a> {
    pub(crate) fn begin(
        of: &'a Execution<'a>,
        objects: &[TrueObject],
        biases: Vec<f64>,
        (noise, draws): (&NoiseModel, Draws),
        control: Loop<'a>,
    ) -> Self {
        let course = Arc::clone(&of.course);
        let (base, mut joints) = course.timeline.start();
        add(&mut joints, &biases);
        let mut stage = Stage::new(&of.robot, &of.scenery, objects, base, &joints);
        let finger = joints.get(of.robot.finger).copied().unwrap_or_default();
        for _ in 0..ticks(SETTLE_S) {
            stage.step(base, &mut joints, finger);
        }
        let watch = Watch::new(&stage, objects.len(), of.scenery.floor);
        let error = [0.0; 3];
        let planned = course.before(0).to_vec();
        let feedback = match control {
            Loop::Open => None,
            Loop::Closed(_) => Some(Feedback::new(of, &course, noise)),
        };
        Self {
            of,
            course,
            file: of.plan.clone(),
            plan: 0,
            stage,
            watch,
            biases,
            draws,
            error,
            next_error: error,
            feedback,
            control,
            replans: 0,
            failed_replans: 0,
            backed_off: 0,
            departure: None,
            stopped: None,
            ticks: 0,
            recording: None,
            now_planned: planned.clone(),
            planned,
        }
    }

    /// The same with every moment written down.
    pub(crate) fn recorded(self) -> Self {
        Self { recording: Some(Recording::default()), ..self }
    }

    /// To the end of the plan; `None` if it was cancelled meanwhile.
    pub(crate) fn perform(mut self, run: u64, cancel: &Cancel) -> Option<(RunReport, Option<Recording>)> {
        let mut trail = Vec::new();
        let mut index = 0;
        loop {
            if cancel.is_cancelled() {
                return None;
            }
            let course = Arc::clone(&self.course);
            let Some(step) = course.step(index) else {
                if self.missed_goal() && self.replan(index) {
                    index = 0;
                    continue;
                }
                break;
            };
            let is_lost = self.feedback.is_some() && step.contract.begins_holding() && self.stage.is_closed();
            if step.senses || is_lost {
                self.look(index);
            }
            let offsets = self.feedback.as_mut().map(|feedback| feedback.offsets(self.of, &course, index));
            if (is_lost || self.is_too_far(index, step)) && self.replan(index) {
                index = 0;
                continue;
            }
            self.write_step(index);
            if let Some(offsets) = &offsets {
                self.move_to(index, step, step.begin_s, &offsets.first());
            }
            if step.contract.drives() {
                self.next_error = self.draws.drive(self.unknown_error(step));
            }
            let done = if self.stopped.is_some() { Some(0) } else { self.step(index, step, offsets.as_ref()) };
            trail.push(self.end_of(index, step));
            let Some(done) = done else {
                index += 1;
                continue;
            };
            match self.recover(index, done) {
                Some(next) => index = next,
                None => break,
            }
        }
        self.finish();
        let recording = self.recording.take();
        Some((self.report(run, trail), recording))
    }

    /// What of the error of the base the robot does not know: it drives from where it believes to be.
    pub(crate) fn unknown_error(&self, step: &TimedStep) -> PlanarError {
        let Some(feedback) = &self.feedback else { return self.error };
        let planned = self.course.timeline.at(step, step.begin_s, &self.of.robot).base;
        [0, 1, 2].map(|i| self.error[i] + planned[i] - feedback.belief.base[i])
    }

    /// The beginning of a step, or the end of the plan.
    fn time_at(&self, index: usize) -> Option<(&TimedStep, f64)> {
        let steps = &self.course.timeline.steps;
        steps.get(index).map(|step| (step, step.begin_s)).or(steps.last().map(|step| (step, step.end_s)))
    }

    /// Where the base truly is at the beginning of a step.
    pub(crate) fn true_base(&self, index: usize) -> PlanarError {
        let Some((step, time_s)) = self.time_at(index) else { return self.error };
        let planned = self.course.timeline.at(step, time_s, &self.of.robot).base;
        [0, 1, 2].map(|i| planned[i] + self.error[i])
    }

    /// What the joints have been told at the beginning of a step, by variable.
    pub(crate) fn told_joints(&self, index: usize) -> Option<Vec<f64>> {
        let (step, time_s) = self.time_at(index)?;
        let mut joints = self.course.timeline.at(step, time_s, &self.of.robot).joints;
        for (variable, by) in self.of.robot.arm.iter().zip(&self.feedback.as_ref()?.offset) {
            *joints.get_mut(*variable)? += by;
        }
        Some(joints)
    }

    /// A robot that looks does so.
    pub(crate) fn look(&mut self, index: usize) {
        let base = self.true_base(index);
        let looked_s = self.ticks as f64 * STEP_S;
        if let (Some(recording), Some(_)) = (&mut self.recording, &self.feedback) {
            recording.looks_s.push(looked_s);
        }
        let course = Arc::clone(&self.course);
        let steps = &course.timeline.steps;
        let at = steps.get(index).map(|step| (step, step.begin_s)).or(steps.last().map(|step| (step, step.end_s)));
        let (Some(feedback), Some((step, time_s))) = (&mut self.feedback, at) else { return };
        let objects: Vec<_> = (0..self.of.problem.objects.len()).map(|object| self.stage.object(object)).collect();
        let draws = &mut self.draws;
        feedback.look(self.of, &self.course, index, (base, &objects), &mut || draws.sight());
        feedback.now = feedback.posture(self.of, &self.course, step, time_s);
    }

    /// Moves the arm until this is added to its joints, while the plan stands still.
    pub(crate) fn move_to(&mut self, index: usize, step: &TimedStep, time_s: f64, to: &[f64]) {
        let Some(feedback) = &mut self.feedback else { return };
        let from = std::mem::replace(&mut feedback.offset, to.to_vec());
        let way = from.iter().zip(to).map(|(from, to)| (to - from).abs()).fold(0.0, f64::max);
        if way < SAME_OFFSET {
            return;
        }
        let count = ticks(way / CORRECTING_PER_S).max(1);
        for tick in 1..=count {
            let part = tick as f64 / count as f64;
            let offset: Vec<_> = from.iter().zip(to).map(|(from, to)| from + part * (to - from)).collect();
            let command = self.course.timeline.at(step, time_s, &self.of.robot);
            self.tick(command, self.error, &offset);
            if let Some(event) = self.watch.touch(&self.stage, step, step.is_holding(time_s)) {
                self.note(index, 0.0, &event);
                if self.stopped.is_some() {
                    return;
                }
            }
        }
    }

    /// One time step in which the robot does as it is told, with the errors that it has.
    pub(crate) fn tick(&mut self, mut command: Command, error: PlanarError, offset: &[f64]) {
        let base = [0, 1, 2].map(|i| command.base[i] + error[i]);
        for (variable, by) in self.of.robot.arm.iter().zip(offset) {
            if let Some(joint) = command.joints.get_mut(*variable) {
                *joint += by;
            }
        }
        add(&mut command.joints, &self.biases);
        self.stage.step(base, &mut command.joints, command.finger);
        self.ticks += 1;
        self.write_frame(base, &command.joints);
    }

    /// Is everything written down at this time step?
    fn is_frame_due(&self, ticks: u64) -> bool {
        let last = |recording: &Recording| recording.frames.last().map(|last| last.time_s);
        let is_long_ago = |last_s: f64| ticks as f64 * STEP_S - last_s >= FRAME_S - 0.5 * STEP_S;
        self.recording.as_ref().is_some_and(|recording| last(recording).is_none_or(is_long_ago))
    }

    /// Writes down where everything is, now and then.
    fn write_frame(&mut self, base: [f64; 3], joints: &[f64]) {
        if !self.is_frame_due(self.ticks) {
            return;
        }
        let Some(recording) = &mut self.recording else { return };
        let time_s = self.ticks as f64 * STEP_S;
        let objects = (0..self.of.problem.objects.len()).map(|object| self.stage.object(object)).collect();
        let planned = self.now_planned.clone();
        recording.frames.push(Frame { time_s, base, joints: joints.to_vec(), objects, planned });
    }

    /// Writes down that a step begins.
    pub(crate) fn write_step(&mut self, index: usize) {
        let (plan, primitive, begin_s) = (self.plan, self.course.primitive(index), self.ticks as f64 * STEP_S);
        if let Some(recording) = &mut self.recording {
            recording.steps.push(RecordedStep { plan, step: index + 1, primitive, begin_s });
        }
    }

    /// Executes one step; the number of time steps done if it was stopped.
    fn step(&mut self, index: usize, step: &TimedStep, offsets: Option<&Offsets>) -> Option<u64> {
        self.watch.begin(&self.stage, &self.planned);
        let before = self.feedback.as_ref().map(|feedback| feedback.posture(self.of, &self.course, step, step.begin_s));
        let (length_s, mut elapsed) = (step.end_s - step.begin_s, 0);
        let count = ticks(length_s);
        while elapsed < count {
            elapsed += 1;
            let time_s = step.begin_s + elapsed as f64 * STEP_S;
            if self.is_frame_due(self.ticks + 1) || elapsed == count {
                self.plan_at(step, time_s);
            }
            let command = self.course.timeline.at(step, time_s, &self.of.robot);
            let error = [0, 1, 2].map(|i| self.error[i] + command.done * (self.next_error[i] - self.error[i]));
            let offset = offsets.map_or_else(Vec::new, |offsets| offsets.at(time_s - step.begin_s, command.done));
            self.tick(command, error, &offset);
            if let Some(feedback) = &mut self.feedback {
                feedback.offset = offset;
            }
            let is_held = step.is_holding(time_s);
            let mut event = self.watch.touch(&self.stage, step, is_held);
            if event.is_none() && (elapsed % LOOK_EVERY == 0 || elapsed == count) {
                event = self.watch.look(&self.stage, step, is_held);
            }
            if let Some(event) = event {
                self.note(index, elapsed as f64 / count as f64, &event);
                if self.stopped.is_some() {
                    self.plan_at(step, time_s);
                    return Some(elapsed);
                }
            }
        }
        self.error = self.next_error;
        self.planned.clone_from(&step.ends);
        if let (Some(feedback), Some(before)) = (&mut self.feedback, before) {
            advance(self.of, &self.course, &mut feedback.belief, (index, step), &before, &feedback.offset);
            feedback.now = feedback.posture(self.of, &self.course, step, step.end_s);
        }
        if let Some(event) = self.watch.end(&self.stage, step) {
            self.note(index, 1.0, &event);
        }
        None
    }

    /// For recordings: where the plan has the objects at a time.
    fn plan_at(&mut self, step: &TimedStep, time_s: f64) {
        if self.recording.is_some() {
            let moved = self.course.timeline.objects(step, time_s);
            let pairs = self.of.problem.objects.iter().zip(&self.planned);
            let poses = pairs.map(|(object, rest)| moved.get(object.name.as_str()).copied().unwrap_or(*rest));
            self.now_planned = poses.collect();
        }
    }

    /// The first event is the departure; what follows is its consequence.
    fn note(&mut self, step: usize, time: f64, event: &Event) {
        let departure = || self.of.departure(&self.course, (self.plan, step), time, event);
        if self.departure.is_none() {
            self.departure = Some(departure());
        }
        if event.is_final() {
            self.stopped = Some(departure());
        }
    }

    fn end_of(&self, index: usize, step: &TimedStep) -> StepEnd {
        let pairs = || step.ends.iter().enumerate().map(|(object, end)| (self.stage.object(object), end));
        StepEnd {
            plan: self.plan,
            step: index + 1,
            primitive: self.course.primitive(index),
            off_m: pairs().map(|(now, end)| (now.translation.vector - end.translation.vector).norm()).collect(),
            lean_deg: pairs().map(|(now, end)| goal::lean_deg(&now, end)).collect(),
        }
    }

    /// The plan is over: everything comes to rest.
    fn finish(&mut self) {
        let course = Arc::clone(&self.course);
        let Some(step) = course.timeline.steps.last().filter(|_| self.stopped.is_none()) else { return };
        let offset = self.feedback.as_ref().map_or_else(Vec::new, |feedback| feedback.offset.clone());
        for _ in 0..ticks(SETTLE_S) {
            let command = course.timeline.at(step, step.end_s, &self.of.robot);
            self.tick(command, self.error, &offset);
            self.ticks -= 1;
        }
    }

    fn report(mut self, run: u64, trail: Vec<StepEnd>) -> RunReport {
        let last = self.course.timeline.steps.last();
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
        let feedback = self.feedback.as_ref().map(|feedback| FeedbackCount {
            looks: feedback.looks,
            corrections: feedback.corrections,
            out_of_reach: feedback.out_of_reach,
            replans: self.replans,
            failed_replans: self.failed_replans,
            backed_off: self.backed_off,
        });
        RunReport {
            run,
            is_success,
            is_near,
            departure: self.departure,
            stopped: self.stopped,
            objects,
            trail,
            feedback,
            seconds: self.ticks as f64 * STEP_S,
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
        let last = self.course.timeline.steps.len().saturating_sub(1);
        Some(self.of.departure(&self.course, (self.plan, last), 1.0, &event))
    }
}

fn add(joints: &mut [f64], biases: &[f64]) {
    joints.iter_mut().zip(biases).for_each(|(joint, bias)| *joint += bias);
}

/// Time steps in so many seconds.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "seconds of a plan, not negative")]
pub(crate) fn ticks(seconds: f64) -> u64 {
    (seconds / STEP_S).ceil().clamp(0.0, 1e9) as u64
}
