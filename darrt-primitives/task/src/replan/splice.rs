//! An old plan is taken up again behind what is wrong with it: only the gap is planned anew.
//!
//! Behind the gap everything must stand as the old plan had it there, the robot too, so that its last steps can follow as they are.

use darrt_core::observe::Observer;
use nalgebra::Isometry3;

use super::{Old, ReplanRequest, Standing, hands, near};
use crate::plan_file::{PlanFile, Pose, Step, Waypoint};
use crate::planning::variants::StrategyChange;
use crate::planning::{PlanRequest, PlanResult, plan_without_clock};
use crate::planning_error::PlanningError;
use crate::problem_file::{Goal, GoalState, ObjectGoal, ProblemFile, RobotGoal, Symmetry};
use crate::registry::Registry;
use crate::robot::TaskRobot;
use crate::verify::{VerifyOptions, verify_unless};

/// How near objects and robot must come to where the old plan goes on, metres and radians: what a search ends at exactly.
const EXACTLY: f64 = 1e-6;
/// Iterations after which the gap is given up: what is near a plan takes few.
const ITERATIONS: u64 = 150;
/// Share of the samples for the gap that are its goal, at least.
const GOAL_BIAS: f64 = 0.5;

/// A plan with a new piece in its middle.
pub(super) struct Spliced {
    pub(super) result: PlanResult,
    /// Steps kept at its end.
    pub(super) tail: usize,
}

impl Old<'_> {
    /// The first `kept` steps, a plan for the gap, and the last steps of the old plan from behind step `bad`, the first that is
    /// wrong. `None` if the old plan cannot be taken up again, or no plan for the gap is found soon.
    ///
    /// # Errors
    /// As planning.
    pub(super) fn spliced<M: TaskRobot>(
        &self,
        registry: &Registry<M>,
        request: &ReplanRequest,
        (kept, bad): (usize, usize),
        observer: &mut dyn Observer,
    ) -> Result<Option<Spliced>, PlanningError> {
        let Some(join) = self.taken_up_behind(bad) else { return Ok(None) };
        let Some(problem) = self.gap(kept, join) else { return Ok(None) };
        let most = request.plan.iterations.or(problem.budget.iterations).unwrap_or(ITERATIONS).min(ITERATIONS);
        let mut rest = PlanRequest { problem, iterations: Some(most), ..request.plan.clone() };
        // The goal is near, and what the old plan did later leads away from it.
        rest.problem.sampling.goal_bias = rest.problem.sampling.goal_bias.max(GOAL_BIAS);
        rest.changes.push(StrategyChange::OneTree);
        let (mut result, _) = plan_without_clock(registry, &rest, self.cancel, observer)?;
        let Some(found) = result.plan.take() else { return Ok(None) };
        let Some(whole) = self.with_tail(self.joined(kept, &found), join) else { return Ok(None) };
        let Ok(proof) = verify_unless(&whole, self.facts, &VerifyOptions::default(), self.cancel) else {
            return Ok(None);
        };
        (result.plan, result.proof) = (Some(whole), Some(proof));
        (result.found, result.execution_s, result.partial) = (None, None, None);
        Ok(Some(Spliced { result: result.clocked(self.facts), tail: self.file.steps.len() - join }))
    }

    /// The first place behind step `bad` from which the old plan is right to its end: there the hand is free, and the robot is
    /// about to do something with an object.
    fn taken_up_behind(&self, mut bad: usize) -> Option<usize> {
        let of = self.file.steps.len();
        loop {
            let first = (bad + 1..of).find(|count| self.is_free_after(*count))?;
            let objects = &self.end(first).objects;
            let still = (first..of).take_while(|count| self.end(*count).objects == *objects);
            let join = still.filter(|count| self.is_free_after(*count)).last()?;
            let (start, steps) = (self.end(join).clone(), self.file.steps.get(join..)?.to_vec());
            let mut facts = self.facts.clone();
            for (name, value) in &mut facts.start {
                *value = *start.joints.get(name.as_str())?;
            }
            let mut problem = self.rest(join)?;
            // What is required may come before.
            problem.steers.retain(|rule| !rule.require);
            let tail = PlanFile { problem, start, steps, ..self.file.clone() };
            match verify_unless(&tail, &facts, &VerifyOptions::default(), self.cancel) {
                Ok(_) => return Some(join),
                // At the goal, or at one of its steps.
                Err(refusal) => bad = join + (refusal.step?.checked_sub(1)? as usize),
            }
        }
    }

    /// From behind the first `kept` steps to where the old plan is taken up again.
    fn gap(&self, kept: usize, join: usize) -> Option<ProblemFile> {
        let mut problem = if kept == 0 { self.file.problem.clone() } else { self.rest(kept)? };
        let (here, there) = (self.end(kept), self.end(join));
        let mut objects = Vec::new();
        for (object, solid) in self.file.problem.objects.iter().zip(&self.geometry.objects) {
            let name = object.name.as_str();
            let pose = there.objects.get(name)?;
            if here.objects.get(name) == Some(pose) {
                continue;
            }
            let Standing { on, at, yaw } = self.standing((object, solid), pose)?;
            objects.push(ObjectGoal {
                object: object.name.clone(),
                on: Some(on),
                at: Some(at),
                region: None,
                position: None,
                tolerance_m: EXACTLY,
                yaw: Some(yaw),
                yaw_tolerance: EXACTLY,
                state: Some(GoalState::Released),
            });
        }
        let robot = RobotGoal {
            base: Some(there.base),
            joints: Some(self.arm(there)?),
            tool: None,
            tolerance_m: EXACTLY,
            tolerance_rad: EXACTLY,
        };
        problem.goal = Goal { objects, robot: Some(robot) };
        self.without_rules_met(&mut problem, |step| step < kept || step >= join)?;
        problem.validate(&problem.name).ok()?;
        Some(problem)
    }

    /// `begun`, which ends where the old plan is taken up again but for rounding, with the last steps of that behind it.
    fn with_tail(&self, mut begun: PlanFile, join: usize) -> Option<PlanFile> {
        let there = self.end(join);
        let mut end = begun.steps.last()?.waypoints.last()?.clone();
        let is_round: Vec<_> =
            self.file.problem.objects.iter().map(|o| (&*o.name, o.symmetry() == Symmetry::Z)).collect();
        // How far the hand is open is no part of a goal: it opens or closes where it stands.
        let arms = self.arm(&end)?.into_iter().zip(self.arm(there)?);
        let is_robot_there = arms.chain(end.base.into_iter().zip(there.base)).all(|(a, b)| near(a, b));
        if !is_robot_there || !are_objects_there(&end, there, &is_round) {
            return None;
        }
        if self.facts.hands() > 1 {
            begun.steps.extend(hands::readied(self.facts, &mut end, there, None));
        }
        if end.joints != there.joints {
            end.joints.clone_from(&there.joints);
            begun.steps.last_mut()?.waypoints.push(end.clone());
        }
        let mut tail: Vec<Step> = self.file.steps.get(join..)?.to_vec();
        for (name, is_round) in is_round {
            let [now, then] = [&end, there].map(|waypoint| waypoint.objects.get(name).copied());
            let (now, then) = (now?, then?);
            // A round object may be turned otherwise; all that follows goes on from there.
            let turn = Isometry3::from(then).rotation.inverse() * Isometry3::from(now).rotation;
            let turned = |pose: Pose| Pose::from(Isometry3::from(pose) * turn);
            for step in &mut tail {
                for pose in step.waypoints.iter_mut().filter_map(|waypoint| waypoint.objects.get_mut(name)) {
                    // What has not moved yet stands where the new piece has left it, to the last bit.
                    *pose = if *pose == then {
                        now
                    } else if is_round {
                        turned(*pose)
                    } else {
                        *pose
                    };
                }
                if let Some(hold) = step.holds.as_mut().filter(|hold| is_round && hold.object == name) {
                    hold.tool_from_object = turned(hold.tool_from_object);
                }
            }
        }
        *tail.first_mut()?.waypoints.first_mut()? = end;
        begun.steps.extend(tail);
        begun.contracts.extend(self.file.contracts.iter().map(|(name, contract)| (name.clone(), *contract)));
        hands::add_contract(&mut begun.contracts, &begun.steps);
        begun.contracts.retain(|name, _| begun.steps.iter().any(|step| step.primitive == *name));
        Some(begun)
    }
}

/// Do the objects stand alike but for rounding? How a round one is turned is nothing that anybody could see.
fn are_objects_there(a: &Waypoint, b: &Waypoint, objects: &[(&str, bool)]) -> bool {
    objects.iter().all(|(name, is_round)| {
        let [Some(a), Some(b)] = [a, b].map(|waypoint| waypoint.objects.get(*name)) else { return false };
        let places = a.position.iter().zip(&b.position).all(|(a, b)| near(*a, *b));
        let [a, b] = [a, b].map(|pose| Isometry3::from(*pose).rotation);
        places && (*is_round || a.angle_to(&b) <= EXACTLY)
    })
}
