//! From a plan for another problem, or for the same: the steps that still verify are kept, the rest is planned anew.
//!
//! Steps can be kept up to a place where the hand is free: from there the rest is a problem of its own, whose plan is put behind
//! them, and the whole is judged as any plan. Where the old plan is right again behind what is wrong with it, only the gap is
//! planned (`splice`); else, where objects stood in the old plan later on is proposed to the new search.

mod hands;
mod splice;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use darrt_core::budget::{Cancel, Stop};
use darrt_core::observe::Observer;
use darrt_core::observe::accounts::Accounts;
use darrt_core::plan::Plan;
use darrt_primitives::contract::HandUse;
use nalgebra::{Isometry3, Point2};

use crate::export::Exporter;
use crate::plan_file::{Partial, PlanFile, PlannerFacts, Pose, Step, Waypoint};
use crate::planning::{PlanRequest, PlanResult, plan_without_clock};
use crate::planning_error::PlanningError;
use crate::problem_file::geometry::{Geometry, StartingObject};
use crate::problem_file::{Object, ProblemFile};
use crate::registry::Registry;
use crate::robot::{RobotFacts, TaskRobot};
use crate::verify::{Proof, Refusal, RefusalKind, VerifyOptions, rules_met, verify_unless};
use crate::world::{self, Built};
use splice::Spliced;

/// What stands on a surface may be this far from its height, metres.
const ON_TOP_M: f64 = 1e-3;
/// Numbers of two waypoints that differ by less are the same but for rounding.
const ROUNDING: f64 = 1e-9;

/// What is planned from what.
#[derive(Debug, Clone)]
pub struct ReplanRequest {
    /// The problem, and how it is planned.
    pub plan: PlanRequest,
    /// A plan for a problem with the same robot, and mostly the same objects.
    pub from: PlanFile,
    /// So many of its first steps are kept; `None`: as many as can be.
    pub keep: Option<usize>,
}

/// A plan and what it has from the old one.
#[derive(Debug)]
pub struct Replanned {
    /// How planning ended. Its counts are those of the search for the rest.
    pub result: PlanResult,
    /// Steps that are kept at its beginning.
    pub kept: usize,
    /// Steps that are kept at its end.
    pub tail: usize,
    /// Steps of the old plan.
    pub of: usize,
    /// Why the step behind the last one that verifies does not; `None` if all of them do.
    pub refused: Option<String>,
}

/// Plans from an old plan.
///
/// # Errors
/// As [`plan`](crate::planning::plan); [`PlanningError::CannotKeep`] if the steps that shall be kept cannot be.
pub fn replan<M: TaskRobot>(
    registry: &Registry<M>,
    request: &ReplanRequest,
    cancel: &Cancel,
    observer: &mut dyn Observer,
) -> Result<Replanned, PlanningError> {
    let problem = &request.plan.problem;
    let facts = M::facts(&problem.robot)?;
    let Built { world, start, .. } = world::build(registry, problem)?;
    let blank = Exporter::new(problem, &facts)?.export(
        &world,
        &Plan::new(start, Vec::new()),
        request.plan.seed,
        PlannerFacts::default(),
    )?;
    let old = Old { file: adapted(&request.from, &blank), geometry: problem.geometry()?, facts: &facts, cancel };
    let of = old.file.steps.len();
    let judged = old.judge();
    let (good, refused) = match &judged {
        Ok(_) => (of, None),
        Err(refusal) => (refusal.step.map_or(0, |step| step.saturating_sub(1) as usize), Some(refusal.to_string())),
    };
    let good = old.allowed(good);
    if let (Ok(proof), true) = (&judged, request.keep.is_none_or(|keep| keep == of) && good == of) {
        let result = as_it_is(registry, &old.file, proof.clone()).clocked(&facts);
        return Ok(Replanned { result, kept: of, tail: 0, of, refused: None });
    }
    // What is whole and yet refused fails at the goal, or lacks what is required on the way there.
    let is_lacking = judged.as_ref().is_err_and(|refusal| refusal.kind == RefusalKind::Steer && refusal.step.is_none());
    let good = if good == 0 && refused.is_some() && !is_lacking && old.holds_but_for_the_goal() { of } else { good };
    let free = |count: &usize| old.is_free_after(*count);
    let kept = match request.keep {
        Some(keep) if keep > good => {
            let why = refused.unwrap_or_else(|| format!("the plan has {of} steps"));
            return Err(PlanningError::CannotKeep { keep, why });
        }
        Some(keep) if !free(&keep) => {
            let others: Vec<_> = (0..=good).filter(free).map(|count| count.to_string()).collect();
            let why = format!("the hand is at work behind that step; it is free behind {}", others.join(", "));
            return Err(PlanningError::CannotKeep { keep, why });
        }
        Some(keep) => keep,
        None => {
            let useful = good.min(old.before_what_is_done_again(&request.from.problem));
            (0..=useful).rev().find(free).unwrap_or(0)
        }
    };
    if refused.is_some()
        && good < of
        && request.keep.is_none()
        && let Some(Spliced { result, tail }) = old.spliced(registry, request, (kept, good), observer)?
    {
        return Ok(Replanned { result, kept, tail, of, refused });
    }
    let attempts = if request.keep.is_some() || kept == 0 { vec![kept] } else { vec![kept, 0] };
    let mut last = None;
    for kept in attempts {
        let result = old.completed(registry, request, kept, observer)?;
        let is_done = result.plan.is_some() || result.stop == Stop::Cancelled;
        last = Some(Replanned { result, kept, tail: 0, of, refused: refused.clone() });
        if is_done {
            break;
        }
    }
    last.ok_or(PlanningError::NoLimit)
}

/// Where an object stands.
struct Standing {
    /// The surface.
    on: String,
    /// Its centre, world x, y, metres.
    at: [f64; 2],
    /// Radians.
    yaw: f64,
}

/// The old plan for the new problem.
struct Old<'a> {
    file: PlanFile,
    /// Of the problem.
    geometry: Geometry,
    facts: &'a RobotFacts,
    cancel: &'a Cancel,
}

impl Old<'_> {
    fn judge(&self) -> Result<Proof, Refusal> {
        verify_unless(&self.file, self.facts, &VerifyOptions::default(), self.cancel)
    }

    /// Is it right as the beginning of a plan?
    fn holds_but_for_the_goal(&self) -> bool {
        let goal = &self.file.problem.goal;
        let remains = goal.by_object().into_iter().map(|(name, _)| name.to_owned()).collect();
        let partial = Partial { met: Vec::new(), remains, robot_remains: goal.robot.is_some() };
        let file = PlanFile { partial: Some(partial), ..self.file.clone() };
        verify_unless(&file, self.facts, &VerifyOptions::default(), self.cancel).is_ok()
    }

    /// How many of the first `good` steps are of primitives that the problem allows.
    fn allowed(&self, good: usize) -> usize {
        let is_allowed = |step: &&Step| self.file.problem.allows(&step.primitive);
        self.file.steps.iter().take(good).take_while(is_allowed).count()
    }

    /// How many steps there are before an object whose goal is another one now is taken or pushed for the last time: what is done
    /// with it then leads to the wrong place.
    fn before_what_is_done_again(&self, before: &ProblemFile) -> usize {
        let goal = &self.file.problem.goal;
        let has_other_goal = |name: &str| {
            let of = |problem: &ProblemFile| -> Vec<_> {
                problem.goal.objects.iter().filter(|goal| goal.object == name).cloned().collect()
            };
            of(before) != of(&self.file.problem)
        };
        let names: Vec<_> = goal.by_object().into_iter().map(|(name, _)| name).filter(|n| has_other_goal(n)).collect();
        let begins = |step: &Step| {
            let contract = self.file.contracts.get(&step.primitive);
            contract.is_some_and(|contract| contract.hand == HandUse::Takes || contract.slides())
        };
        let last = |name: &&str| {
            self.file.steps.iter().rposition(|step| step.object.as_deref() == Some(*name) && begins(step))
        };
        names.iter().filter_map(last).min().unwrap_or(self.file.steps.len())
    }

    /// Is the hand free behind so many steps, and may it go anywhere?
    fn is_free_after(&self, count: usize) -> bool {
        let Some(next) = self.file.steps.get(count) else { return count == 0 || self.ends_free() };
        let contract = self.file.contracts.get(&next.primitive);
        count == 0
            || (next.holds.is_none()
                && next.pushes.is_none()
                && next.allowed_contacts.is_empty()
                && contract.is_some_and(|contract| contract.is_free() && contract.hand == HandUse::Empty))
    }

    /// Does the last step leave the hand free?
    fn ends_free(&self) -> bool {
        self.file.steps.last().is_some_and(|last| {
            let contract = self.file.contracts.get(&last.primitive);
            last.holds.is_none()
                && last.pushes.is_none()
                && contract.is_some_and(|contract| ![HandUse::Takes, HandUse::LetsGo].contains(&contract.hand))
        })
    }

    /// Where everything stands behind so many steps.
    fn end(&self, count: usize) -> &Waypoint {
        let last = count.checked_sub(1).and_then(|index| self.file.steps.get(index)?.waypoints.last());
        last.unwrap_or(&self.file.start)
    }

    /// The first steps, and a plan for what is left to do.
    fn completed<M: TaskRobot>(
        &self,
        registry: &Registry<M>,
        request: &ReplanRequest,
        kept: usize,
        observer: &mut dyn Observer,
    ) -> Result<PlanResult, PlanningError> {
        let rest = if kept == 0 { Some(request.plan.problem.clone()) } else { self.rest(kept) };
        let Some(problem) = rest else {
            let why = "where it ends is no start for a problem".to_owned();
            return Err(PlanningError::CannotKeep { keep: kept, why });
        };
        let hints = self.hints(kept);
        let rest = PlanRequest { problem, hints, ..request.plan.clone() };
        let (mut result, _) = plan_without_clock(registry, &rest, self.cancel, observer)?;
        if kept == 0 {
            return Ok(result.clocked(self.facts));
        }
        result.found = None;
        result.execution_s = None;
        let joined = |file: &PlanFile| {
            let whole = self.joined(kept, file);
            verify_unless(&whole, self.facts, &VerifyOptions::default(), self.cancel).map(|proof| (whole, proof))
        };
        if let Some(file) = result.plan.take() {
            match joined(&file) {
                Ok((whole, proof)) => (result.plan, result.proof) = (Some(whole), Some(proof)),
                Err(refusal) => (result.proof, result.last_refusal) = (None, Some(refusal.to_string())),
            }
        }
        result.partial = result.partial.take().and_then(|(file, _)| joined(&file).ok());
        Ok(result.clocked(self.facts))
    }

    /// The problem that is left behind so many steps.
    fn rest(&self, kept: usize) -> Option<ProblemFile> {
        let end = self.end(kept);
        let mut problem = self.file.problem.clone();
        problem.robot.base = end.base;
        problem.robot.posture = None;
        problem.robot.joints = Some(self.arm(end)?);
        for (object, solid) in problem.objects.iter_mut().zip(&self.geometry.objects) {
            let pose = end.objects.get(object.name.as_str())?;
            if self.file.start.objects.get(object.name.as_str()) != Some(pose) {
                let standing = self.standing((object, solid), pose)?;
                (object.on, object.at, object.yaw) = (standing.on, standing.at, standing.yaw);
            }
        }
        self.without_rules_met(&mut problem, |step| step < kept)?;
        problem.validate(&problem.name).ok()?;
        Some(problem)
    }

    /// Takes out of a problem the rules whose `require` one of these steps of the old plan fulfils.
    fn without_rules_met(&self, problem: &mut ProblemFile, steps: impl Fn(usize) -> bool) -> Option<()> {
        if self.file.problem.steers.iter().all(|rule| !rule.require) {
            return Some(());
        }
        let by_step = rules_met(&self.file, self.facts).ok()?;
        let met = by_step.iter().enumerate().filter(|(step, _)| steps(*step)).flat_map(|(_, met)| met);
        let met: BTreeSet<_> = met.collect();
        let all = self.file.problem.steers.iter().enumerate();
        problem.steers = all.filter(|(index, _)| !met.contains(index)).map(|(_, rule)| rule.clone()).collect();
        Some(())
    }

    /// The joints of all arms.
    fn arm(&self, waypoint: &Waypoint) -> Option<Vec<f64>> {
        self.facts.all_arm_joints().into_iter().map(|name| waypoint.joints.get(name).copied()).collect()
    }

    /// Where an object at this pose stands, in the words of a problem.
    fn standing(&self, (object, solid): (&Object, &StartingObject), pose: &Pose) -> Option<Standing> {
        let pose = Isometry3::from(*pose);
        let [x, y, z] = pose.translation.vector.into();
        let under = (&Point2::new(x, y), z - solid.depth_below_origin);
        let on = self.file.problem.surface_under(object, &self.geometry.scene, under, ON_TOP_M)?;
        Some(Standing { on, at: [x, y], yaw: pose.rotation.euler_angles().2 })
    }

    /// Where the old plan leaves the objects that it has moved by then, whenever its hand is free behind so many steps.
    fn hints(&self, kept: usize) -> Vec<BTreeMap<String, Pose>> {
        let places = (kept + 1..=self.file.steps.len()).filter(|count| self.is_free_after(*count));
        let moved = |count: usize| -> BTreeMap<String, Pose> {
            let before = &self.end(kept).objects;
            let objects = self.end(count).objects.iter().filter(|(name, pose)| before.get(*name) != Some(pose));
            objects.map(|(name, pose)| (name.to_string(), *pose)).collect()
        };
        let mut hints: Vec<_> = places.map(moved).filter(|hint| !hint.is_empty()).collect();
        hints.dedup();
        hints
    }

    /// The first steps with those of `rest` behind them.
    fn joined(&self, kept: usize, rest: &PlanFile) -> PlanFile {
        let mut end = self.end(kept).clone();
        let mut steps: Vec<Step> = self.file.steps.iter().take(kept).cloned().collect();
        let mut new = rest.steps.clone();
        // What has not moved yet stands where it stood, bit for bit.
        for waypoint in new.iter_mut().flat_map(|step| &mut step.waypoints) {
            for (name, pose) in &mut waypoint.objects {
                if rest.start.objects.get(name) == Some(pose)
                    && let Some(there) = end.objects.get(name)
                {
                    *pose = *there;
                }
            }
        }
        if let Some(first) = new.first_mut() {
            let hand = first.hand(self.facts).unwrap_or(0);
            if let Some(wanted) = first.waypoints.first() {
                steps.extend(hands::readied(self.facts, &mut end, wanted, Some(hand)));
            }
            let opens = matches!(first.waypoints.as_slice(), [a, b, ..] if differ_in_hand_alone(a, b, self.facts));
            let is_same = first.waypoints.first().is_some_and(|first| is_near(first, &end));
            match first.waypoints.first_mut() {
                Some(start) if opens || is_same => *start = end,
                // The hand opens or closes to begin with.
                _ => first.waypoints.insert(0, end),
            }
        }
        steps.extend(new);
        let mut contracts = self.file.contracts.clone();
        contracts.extend(rest.contracts.clone());
        hands::add_contract(&mut contracts, &steps);
        contracts.retain(|name, _| steps.iter().any(|step| step.primitive == *name));
        PlanFile {
            problem: self.file.problem.clone(),
            start: self.file.start.clone(),
            contracts,
            steps,
            ..rest.clone()
        }
    }
}

/// Do all but the joints of the hand stand alike?
fn differ_in_hand_alone(a: &Waypoint, b: &Waypoint, facts: &RobotFacts) -> bool {
    let arm = |waypoint: &Waypoint| -> Vec<Option<f64>> {
        facts.all_arm_joints().into_iter().map(|name| waypoint.joints.get(name).copied()).collect()
    };
    a.base == b.base && a.objects == b.objects && arm(a) == arm(b) && a.joints != b.joints
}

/// Are two numbers the same but for rounding?
fn near(a: f64, b: f64) -> bool {
    (a - b).abs() <= ROUNDING
}

/// Does the robot stand alike in two waypoints, but for rounding?
fn is_near(a: &Waypoint, b: &Waypoint) -> bool {
    let joints = a.joints.iter().all(|(name, value)| b.joints.get(name).is_some_and(|other| near(*value, *other)));
    joints && a.base.iter().zip(&b.base).all(|(a, b)| near(*a, *b))
}

/// The old plan with the problem and the start of `blank`: an object stands where the new problem puts it until a step is about
/// it, objects that are new stay where they are, and those that are gone are gone.
fn adapted(old: &PlanFile, blank: &PlanFile) -> PlanFile {
    let mut touched: Vec<&str> = Vec::new();
    let mut steps = old.steps.clone();
    for (step, old) in steps.iter_mut().zip(&old.steps) {
        let held = old.holds.as_ref().map(|hold| hold.object.as_str());
        touched.extend(old.object.as_deref().into_iter().chain(held).chain(old.pushes.as_deref()));
        for waypoint in &mut step.waypoints {
            let place = |(name, start): (&Arc<str>, &Pose)| {
                let there = waypoint.objects.get(name).filter(|_| touched.contains(&&**name));
                (Arc::clone(name), there.copied().unwrap_or(*start))
            };
            waypoint.objects = blank.start.objects.iter().map(place).collect();
        }
    }
    PlanFile { steps, contracts: old.contracts.clone(), planner: old.planner.clone(), seed: old.seed, ..blank.clone() }
}

/// A plan that needs nothing new.
fn as_it_is<M: TaskRobot>(registry: &Registry<M>, file: &PlanFile, proof: Proof) -> PlanResult {
    let names = registry.allowed(&file.problem).map(|(id, _)| id.name()).collect();
    PlanResult {
        plan: Some(file.clone()),
        no_clock: None,
        proof: Some(proof),
        execution_s: None,
        found: None,
        plans: 1,
        near: Vec::new(),
        doubts: Vec::new(),
        stop: Stop::Solved,
        accounts: Accounts::new(names),
        iterations: 0,
        nodes: 0,
        restarts: 0,
        nearest_to_goal: 0.0,
        elapsed: std::time::Duration::ZERO,
        times: crate::profile::Times::default(),
        last_refusal: None,
        partial: None,
        nearest: None,
        recording: None,
    }
}
