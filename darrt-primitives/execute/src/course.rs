//! A plan under way: its clock, and where it begins.

use darrt_task::plan_file::PlanFile;
use darrt_task::robot::RobotFacts;
use nalgebra::Isometry3;

use crate::error::ExecuteError;
use crate::robot::Robot;
use crate::run::Execution;
use crate::timeline::{TimedStep, Timeline};

/// A plan as it is executed: the first, or one that was made on the way.
#[derive(Debug)]
pub(crate) struct Course {
    pub(crate) timeline: Timeline,
    primitives: Vec<String>,
    /// Where the objects are before the first step.
    starts: Vec<Isometry3<f64>>,
}

impl Course {
    pub(crate) fn new(plan: &PlanFile, facts: &RobotFacts, robot: &Robot) -> Result<Self, ExecuteError> {
        let start = |name: &String| {
            let missing = || ExecuteError::Missing { place: "start".to_owned(), what: "object", name: name.clone() };
            plan.start.objects.get(name.as_str()).copied().map(Isometry3::from).ok_or_else(missing)
        };
        Ok(Self {
            timeline: Timeline::new(plan, facts, robot)?,
            primitives: plan.steps.iter().map(|step| step.primitive.to_string()).collect(),
            starts: plan.problem.objects.iter().map(|object| start(&object.name)).collect::<Result<_, _>>()?,
        })
    }

    pub(crate) fn primitive(&self, step: usize) -> String {
        self.primitives.get(step).cloned().unwrap_or_default()
    }

    pub(crate) fn step(&self, index: usize) -> Option<&TimedStep> {
        self.timeline.steps.get(index)
    }

    /// Where the plan has the objects before a step.
    pub(crate) fn before(&self, step: usize) -> &[Isometry3<f64>] {
        step.checked_sub(1).and_then(|before| self.step(before)).map_or(&self.starts, |step| &step.ends)
    }

    /// The next step from this one that takes, pushes or sets down an object, and which.
    pub(crate) fn next_contact(&self, index: usize) -> Option<(usize, usize)> {
        self.next(index, |step| step.contract.manipulates())
    }

    /// The next step from this one that takes or pushes an object.
    pub(crate) fn next_grip(&self, index: usize) -> Option<(usize, usize)> {
        let is_held = self.step(index).is_some_and(|step| step.contract.begins_holding());
        self.next(index, |step| step.contract.manipulates()).filter(|_| !is_held)
    }

    fn next(&self, index: usize, is_it: impl Fn(&TimedStep) -> bool) -> Option<(usize, usize)> {
        let (at, step) = self.timeline.steps.iter().enumerate().skip(index).find(|(_, step)| is_it(step))?;
        Some((at, step.pushes.or(step.holds.map(|(object, _)| object))?))
    }

    /// How much of the way of a pushed object is behind it, 0 to 1.
    pub(crate) fn part_pushed(&self, of: &Execution<'_>, step: &TimedStep, object: usize, time_s: f64) -> f64 {
        let name = of.problem.objects.get(object).map_or("", |object| &object.name);
        let at =
            |time_s: f64| self.timeline.objects(step, time_s).get(name).copied().unwrap_or_default().translation.vector;
        let (from, now, to) = (at(step.begin_s), at(time_s), at(step.end_s));
        let whole = (to - from).norm();
        if whole > 0.0 { ((now - from).norm() / whole).min(1.0) } else { 0.0 }
    }
}
