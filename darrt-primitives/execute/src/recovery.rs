//! When correcting the arm is not enough: another plan from where everything is seen to be, with what of the old one still fits.

use std::sync::Arc;

use darrt_primitives::contract::HandUse;
use darrt_task::plan_file::PlanFile;
use darrt_task::problem_file::ProblemFile;
use nalgebra::Isometry3;

use crate::course::Course;
use crate::feedback::MOST_CORRECTED_M;
use crate::goal::{self, Now};
use crate::performance::{Performance, ticks};
use crate::run::Loop;
use crate::stage::STEP_S;
use crate::timeline::TimedStep;
use crate::watch::Watch;

/// Plans that are asked for in one run at most.
const MOST_REPLANS: usize = 3;
/// Times in one run that a robot goes back from what it has run into.
const MOST_BACK: usize = 3;
/// What stands on a surface may be this far from its height, metres: things rock, and are seen so.
const ON_TOP_M: f64 = 0.01;

/// One that leans more than it did has fallen, degrees.
const FALLEN_DEG: f64 = 30.0;

impl Performance<'_> {
    /// Is the object of the next contact too far from the plan for the arm to be corrected, and may another plan begin here?
    pub(crate) fn is_too_far(&self, index: usize, step: &TimedStep) -> bool {
        let Some(feedback) = &self.feedback else { return false };
        let is_free = step.contract.is_free() && step.contract.hand == HandUse::Empty;
        let off_m = feedback.off_m(&self.course, index).map_or(0.0, |(_, off_m)| off_m);
        is_free && (off_m > MOST_CORRECTED_M || feedback.is_out_of_reach)
    }

    /// The plan is over. A robot that looks brings what it still holds to where it should be; else, is something not at its goal?
    pub(crate) fn missed_goal(&mut self) -> bool {
        let course = Arc::clone(&self.course);
        let last = course.timeline.steps.len().saturating_sub(1);
        let Some(step) = course.step(last).filter(|_| self.stopped.is_none() && self.feedback.is_some()) else {
            return false;
        };
        self.look(last + 1);
        if step.contract.hand == HandUse::Carries {
            let wanted = self.feedback.as_mut().and_then(|feedback| feedback.wanted_after(self.of, &course, last));
            if let Some(wanted) = wanted {
                self.move_to(last, step, step.end_s, &wanted);
            }
            return false;
        }
        let Some(feedback) = &self.feedback else { return false };
        self.of.problem.objects.iter().enumerate().any(|(index, object)| {
            let mut pose = self.stage.object(index);
            if let Some(believed) = feedback.belief.objects.get(index) {
                (pose.translation.x, pose.translation.y) = (believed.translation.x, believed.translation.y);
            }
            let planned = self.planned.get(index).copied().unwrap_or_else(Isometry3::identity);
            let depth_m = self.of.depths.get(index).copied().unwrap_or_default();
            let now = Now { pose, is_in_hand: false, planned, depth_m };
            let is_named = self.of.problem.goal.objects.iter().any(|goal| goal.object == object.name);
            is_named && !goal::end(self.of.problem, &self.of.scene, &object.name, &now).is_there
        })
    }

    /// Has another plan made from here; true if there is one, which is then under way.
    pub(crate) fn replan(&mut self, index: usize) -> bool {
        let Loop::Closed(planner) = self.control else { return false };
        if self.replans + self.failed_replans >= MOST_REPLANS || self.stopped.is_some() {
            return false;
        }
        let found = self.problem_now(index).and_then(|problem| {
            let steps = self.file.steps.get(index..).unwrap_or_default().to_vec();
            let rest = PlanFile { steps, timing: None, ..self.file.clone() };
            let plan = planner.replan(&problem, &rest)?;
            let course = Course::new(&plan, self.of.facts, &self.of.robot).ok()?;
            Some((plan, course))
        });
        let Some((plan, course)) = found else {
            self.failed_replans += 1;
            return false;
        };
        self.replans += 1;
        self.begin_anew(index, plan, course);
        true
    }

    /// A robot that looks has run into something or is held up: it goes back the way it came, looks, and goes on with another plan
    /// or tries again. The step that is next; `None` if it gives up. `done` time steps of the step are behind it.
    pub(crate) fn recover(&mut self, index: usize, done: u64) -> Option<usize> {
        if self.feedback.is_none() || self.backed_off >= MOST_BACK || !self.is_upright() {
            return None;
        }
        let course = Arc::clone(&self.course);
        let (stopped, mut at) = (self.stopped.take(), index);
        self.backed_off += 1;
        self.go_back(course.step(index)?, done);
        let holds = course.step(index)?.contract.begins_holding();
        // To where another plan may begin.
        while !holds && at > 0 && !course.step(at - 1).is_some_and(|before| before.contract.is_free()) {
            at -= 1;
            self.go_back(course.step(at)?, u64::MAX);
        }
        self.planned = course.before(at).to_vec();
        self.look(at);
        if !holds && self.replan(at) {
            return Some(0);
        }
        if course.step(at).is_some_and(|step| self.is_too_far(at, step)) {
            self.stopped = stopped;
            return None;
        }
        // The base may stand where nothing can be done: it drives there once more.
        let since = course.timeline.steps.get(..at).unwrap_or_default().iter().rev();
        let since = since.take_while(|step| !step.contract.manipulates()).position(|step| step.contract.drives());
        if let Some(back) = since.filter(|_| !course.step(index).is_some_and(|step| step.contract.drives())) {
            for _ in 0..=back {
                at -= 1;
                self.go_back(course.step(at)?, u64::MAX);
            }
            self.planned = course.before(at).to_vec();
        }
        Some(at)
    }

    /// Back to the beginning of a step of which so many time steps are behind the robot.
    fn go_back(&mut self, step: &TimedStep, done: u64) {
        let Some(feedback) = &self.feedback else { return };
        let offset = feedback.offset.clone();
        let whole = ticks(step.end_s - step.begin_s);
        let course = Arc::clone(&self.course);
        let at = |ticks: u64| step.begin_s + ticks as f64 * STEP_S;
        let from = done.min(whole);
        if from == 0 {
            self.next_error = self.error;
            return;
        }
        // Going back is a drive too: the shorter, the smaller the error of its own with which it ends.
        let part = course.timeline.at(step, at(from), &self.of.robot).done;
        let now = [0, 1, 2].map(|i| self.error[i] + part * (self.next_error[i] - self.error[i]));
        let drives = step.contract.drives();
        let end = if drives {
            let drawn = self.draws.drive(now);
            [0, 1, 2].map(|i| now[i] + part * (drawn[i] - now[i]))
        } else {
            self.error
        };
        for elapsed in (0..from).rev() {
            let command = course.timeline.at(step, at(elapsed), &self.of.robot);
            let left = if part > 0.0 { (command.done / part).clamp(0.0, 1.0) } else { 0.0 };
            let error = if drives { [0, 1, 2].map(|i| end[i] + left * (now[i] - end[i])) } else { self.error };
            self.tick(command, error, &offset);
        }
        (self.error, self.next_error) = (end, end);
        let begin = course.timeline.at(step, step.begin_s, &self.of.robot);
        if let Some(feedback) = &mut self.feedback {
            if drives {
                feedback.belief.drive(begin.base);
            }
            feedback.now = feedback.posture(self.of, &course, step, step.begin_s);
        }
    }

    /// Does everything stand that is not in the hand?
    fn is_upright(&self) -> bool {
        (0..self.of.problem.objects.len()).all(|object| {
            let held = self.planned.get(object).copied().unwrap_or_default();
            goal::lean_deg(&self.stage.object(object), &held) <= FALLEN_DEG
        })
    }

    fn begin_anew(&mut self, index: usize, plan: PlanFile, course: Course) {
        let truth = self.true_base(index);
        let (base, joints) = course.timeline.start();
        self.error = [0, 1, 2].map(|i| truth[i] - base[i]);
        self.next_error = self.error;
        self.planned = course.before(0).to_vec();
        self.watch = Watch::new(&self.stage, self.of.problem.objects.len(), self.of.scenery.floor);
        if let Some(feedback) = &mut self.feedback {
            feedback.begin_anew(self.of, (&base, &joints));
        }
        self.course = Arc::new(course);
        self.file = plan;
        self.plan += 1;
    }

    /// The problem as the robot sees it: itself where it believes to be, the objects where they were seen. `None` if one of them has
    /// fallen, or stands where it may not.
    fn problem_now(&self, index: usize) -> Option<ProblemFile> {
        let feedback = self.feedback.as_ref()?;
        let mut problem = self.of.problem.clone();
        problem.robot.base = feedback.belief.base;
        problem.robot.posture = None;
        let joints = self.told_joints(index)?;
        let tree = &self.of.robot.tree;
        let joint = |name: &str| {
            let variable = tree.variable_index(name)?;
            Some(tree.variables().get(variable)?.limit.clamp(*joints.get(variable)?))
        };
        problem.robot.joints = Some(self.of.facts.all_arm_joints().into_iter().map(joint).collect::<Option<_>>()?);
        for (number, object) in problem.objects.iter_mut().enumerate() {
            let (seen, truth) = (feedback.belief.objects.get(number)?, self.stage.object(number));
            // What has been knocked over is no start.
            if goal::lean_deg(&truth, &Isometry3::identity()) > goal::UPRIGHT_DEG {
                return None;
            }
            let bottom = truth.translation.z - self.of.depths.get(number)?;
            let at = seen.translation.vector.xy();
            object.on = self.of.problem.surface_under(object, &self.of.scene, (&at.into(), bottom), ON_TOP_M)?;
            object.at = at.into();
            object.yaw = crate::belief::yaw_of(seen);
        }
        problem.validate(&problem.name).ok()?;
        Some(problem)
    }
}
