//! Why is there no plan? Asked after a search that found none: the problem's own actions are tried where they will be needed,
//! at the start and at the goals, every try is counted, and what none of them passes is a cause.
//!
//! | question | file |
//! |---|---|
//! | what can be a cause? | [`cause`] |
//! | which poses of the hand take an object, or set it down? | `hands` |
//! | where do pushes lead? | `pushes` |
//! | where can the base drive? | `floor` |
//! | what would make a problem easier? | [`relax`] |
//! | with which changes has it a plan? | [`explain`] |
//! | why not in the way that a person has in mind? | [`why_not`] |
//!
//! All is bounded by counts and drawn from fixed seeds, but for what the search itself has shown: that it came to the goal, what
//! rules stopped, which doubts are left. "None of 24" is what was counted; it is no proof.

use std::collections::BTreeMap;

use darrt_core::budget::{Cancel, Stop};
use darrt_core::goal::Goal as _;
use darrt_core::random::{Purpose, stream};
use darrt_core::state::ObjectId;
use darrt_primitives::contract::{Contract, HandUse};
use darrt_primitives::goal::Grip;
use darrt_primitives::manipulator::Manipulator;
use darrt_primitives::mode::Contacts;
use darrt_primitives::primitive::{PICK, PLACE, PUSH};
use darrt_primitives::tabletop::TabletopState;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::doubts::Outlook;
use crate::planning::{PlanRequest, PlanResult, STEER, prepare_unless};
use crate::planning_error::PlanningError;
use crate::problem_file::Object;
use crate::registry::Registry;
use crate::robot::TaskRobot;
use crate::world::{self, Built};

pub mod cause;
pub mod explain;
mod floor;
mod hands;
mod pushes;
pub mod relax;
pub mod why_not;

use cause::{Blocker, Cause, Occupant, Place, Stage};
use hands::{Case, Look, Survey, culprit, ranked};
use relax::Relaxation;

/// A state so near to the goal, by the planner's distance, is at it, metres.
const AT_GOAL_M: f64 = 5e-4;
/// Iterations that say nothing of a problem.
const FEW: u64 = 10;
/// Changes that are looked at, and of those that help so many are told.
const TRIED_REMEDIES: usize = 16;
const REMEDIES: usize = 3;
/// Draws of the goal of the robot.
const ROBOT_DRAWS: u64 = 32;
/// Draws of the goal in all, for the grasps that take the object at the start; of fewer grasps nothing is said.
const GOAL_DRAWS: u64 = 240;
const LEAST_GRASPS: u64 = 4;

/// What ended the search.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Ended {
    /// It never began.
    Refused,
    /// The time limit.
    TimeLimit,
    /// The limit of iterations.
    IterationLimit,
    /// The limit of nodes.
    NodeLimit,
    /// Somebody stopped it.
    Cancelled,
}

/// Would a longer search help?
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Outcome {
    /// As far as was looked there is no plan: a longer search is no use.
    Hopeless,
    /// Nothing was found that keeps a plan away, and the search was too short to say more.
    TooShort,
    /// Nothing was found that keeps a plan away.
    MayBeFound,
}

/// Why there is no plan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Diagnosis {
    /// The problem.
    pub problem: String,
    /// What ended the search.
    pub ended: Ended,
    /// Iterations of the search.
    pub iterations: u64,
    /// The causes, in the order of what must be done for each object.
    pub causes: Vec<Cause>,
    /// Changes of the problem after which nothing is found that keeps a plan away, each by itself, the smallest first. They are
    /// looked for as the causes are, not planned; `darrt explain` plans them.
    pub remedies: Vec<Relaxation>,
    /// Would a longer search help?
    pub outcome: Outcome,
    /// Was the time over before the causes were found out?
    pub is_cut_short: bool,
    /// Metres from the goal, by the planner's distance, of the nearest state; `null` if there is none.
    pub nearest_to_goal_m: Option<f64>,
}

impl Diagnosis {
    /// Of a problem that was refused before the search; `None` if the problem cannot even be built.
    pub fn of_error(problem: &str, error: &PlanningError) -> Option<Self> {
        let cause = match error {
            PlanningError::GoalBlocked { object, by, occupant, at } => {
                Cause::GoalOccupied { object: object.clone(), by: by.clone(), occupant: *occupant, at: *at }
            }
            PlanningError::GoalEnclosed { object, by, at } => {
                let occupant = Occupant::Enclosure;
                Cause::GoalOccupied { object: object.clone(), by: by.clone(), occupant, at: *at }
            }
            PlanningError::BaseGoalBlocked { by, .. } => {
                Cause::NoRobotGoal { tried: 1, blockers: ranked(BTreeMap::from([(by.clone(), 1)])), beyond_m: None }
            }
            PlanningError::Doubtful { error, .. } => return Self::of_error(problem, error),
            PlanningError::InfeasibleGoal { object, why } => {
                Cause::InfeasibleGoal { object: object.clone(), lack: why.clone() }
            }
            PlanningError::InfeasibleRule { index, why } => {
                Cause::InfeasibleRule { rule: *index as u64, lack: why.clone() }
            }
            PlanningError::MissingPrimitive { primitive, needs } => {
                Cause::MissingPrimitive { primitive: primitive.clone(), needs: needs.clone() }
            }
            _ => return None,
        };
        Some(Self {
            problem: problem.to_owned(),
            ended: Ended::Refused,
            iterations: 0,
            causes: vec![cause],
            remedies: Vec::new(),
            outcome: Outcome::Hopeless,
            is_cut_short: false,
            nearest_to_goal_m: None,
        })
    }
}

/// Finds out why a search found no plan, until `cancel` says that nobody waits any longer: then no causes are given but what the
/// search itself has shown.
///
/// # Errors
/// As [`prepare`](crate::planning::prepare).
pub fn diagnose<M: TaskRobot>(
    registry: &Registry<M>,
    request: &PlanRequest,
    result: &PlanResult,
    cancel: &Cancel,
) -> Result<Diagnosis, PlanningError> {
    let mut causes = match &result.last_refusal {
        Some(reason) => vec![Cause::Refused { reason: reason.clone() }],
        None => causes(registry, request, cancel)?,
    };
    let is_cut_short = result.last_refusal.is_none() && cancel.is_cancelled();
    if is_cut_short {
        // What few tries did not find may be there.
        causes.clear();
    }
    if result.nearest_to_goal < AT_GOAL_M {
        // The search has been there, so a hand comes there.
        causes.retain(|cause| !cause.is_about_arriving());
    }
    let stopped = result.accounts.blocks.iter().filter(|((_, by), _)| by == STEER);
    let steps = ranked(stopped.map(|((step, _), count)| (step.clone(), *count)).collect());
    if !steps.is_empty() {
        causes.push(Cause::Steered { steps });
    }
    let is_hopeless = causes.iter().any(Cause::is_decisive);
    if !is_hopeless {
        // What a plan would refute, and no plan has.
        let open = result.doubts.iter().filter(|doubt| doubt.refuted.is_some());
        causes.extend(open.map(|doubt| Cause::Doubted { what: doubt.words.clone() }));
    }
    let outcome = match () {
        () if is_hopeless => Outcome::Hopeless,
        () if result.iterations < FEW => Outcome::TooShort,
        () => Outcome::MayBeFound,
    };
    let remedies = if is_hopeless { remedies(registry, request, &causes, cancel) } else { Vec::new() };
    let ended = match result.stop {
        Stop::TimeLimit => Ended::TimeLimit,
        Stop::NodeLimit => Ended::NodeLimit,
        Stop::Cancelled => Ended::Cancelled,
        _ => Ended::IterationLimit,
    };
    Ok(Diagnosis {
        problem: request.problem.name.clone(),
        ended,
        iterations: result.iterations,
        causes,
        remedies,
        outcome,
        is_cut_short,
        nearest_to_goal_m: Some(result.nearest_to_goal).filter(|metres| metres.is_finite()),
    })
}

/// Changes after which nothing decisive is found.
fn remedies<M: TaskRobot>(
    registry: &Registry<M>,
    request: &PlanRequest,
    found: &[Cause],
    cancel: &Cancel,
) -> Vec<Relaxation> {
    let helps = |relaxation: &Relaxation| {
        if cancel.is_cancelled() {
            return false;
        }
        let Some(problem) = relaxation.applied(&request.problem) else { return false };
        let request = PlanRequest { problem, ..request.clone() };
        prepare_unless(registry, &request.problem, cancel).is_ok()
            && looked_for(registry, &request, true, cancel).is_ok_and(|causes| !causes.iter().any(Cause::is_decisive))
            && !cancel.is_cancelled()
    };
    let near = Relaxation::against(registry, &request.problem, found);
    near.into_iter().take(TRIED_REMEDIES).filter(helps).take(REMEDIES).collect()
}

/// What keeps a plan of the problem away, as far as a bounded number of tries tells; of few if `cancel` ends them.
///
/// # Errors
/// As [`prepare`](crate::planning::prepare).
pub fn causes<M: TaskRobot>(
    registry: &Registry<M>,
    request: &PlanRequest,
    cancel: &Cancel,
) -> Result<Vec<Cause>, PlanningError> {
    looked_for(registry, request, false, cancel)
}

/// [`causes`], with fewer tries if it is enough to see whether something good is easily found.
fn looked_for<M: TaskRobot>(
    registry: &Registry<M>,
    request: &PlanRequest,
    is_quick: bool,
    cancel: &Cancel,
) -> Result<Vec<Cause>, PlanningError> {
    let file = &request.problem;
    let (robot, arm) = M::build(&file.robot)?;
    let allowed: Vec<_> = registry.allowed(file).collect();
    let Built { world, start, goal, .. } = world::build_with(registry, file, robot, arm)?;
    let outlook = Outlook { problem: file, allowed: &allowed, m: &world, start: &start, goal: &goal, cancel };
    let look = Look { m: &world, start: &start, goal: &goal, is_quick, cancel };
    Ok(Inquest { outlook, look }.causes())
}

/// Looks for causes.
struct Inquest<'a, M: Manipulator> {
    outlook: Outlook<'a, M>,
    look: Look<'a, M>,
}

impl<'a, M: Manipulator> Inquest<'a, M> {
    fn causes(&self) -> Vec<Cause> {
        let immovable = self.outlook.immovable();
        let wanted = self.outlook.objects().filter(|(id, _)| self.outlook.must_move(*id));
        wanted.flat_map(|(id, object)| self.of_object(id, object, &immovable)).chain(self.of_robot()).collect()
    }

    /// What keeps the robot from its own goal: it meets something fixed wherever it would be, or is nowhere.
    fn of_robot(&self) -> Option<Cause> {
        let Look { m, start, goal, .. } = self.look;
        let (robot, mut tried) = (m.manipulator(), 0);
        let mut blockers = BTreeMap::<String, u64>::new();
        let alone = goal.of_robot()?;
        for draw in 0..ROBOT_DRAWS {
            let Some(target) = alone.sample(m, &mut stream(0, 6, draw, Purpose::Attempt)) else { continue };
            tried += 1;
            let q = target.robot_overlay(m, &start.robot);
            let aside = self.outlook.alone(ObjectId::new(usize::MAX), &self.outlook.immovable());
            let state = TabletopState::<M> { robot: q, ..aside };
            let found = m.collision_scene().check_base(robot, &q);
            match found.and_then(|()| m.collision_scene().check(robot, &state, &Contacts::default())) {
                Ok(()) => return None,
                Err(blame) => *blockers.entry(culprit(m, ObjectId::new(usize::MAX), &blame)).or_default() += 1,
            }
        }
        let tool = goal.robot().and_then(|goal| goal.world_from_tool).filter(|_| tried == 0);
        let beyond_m = tool.and_then(|tool| self.look.beyond_m(start, &[tool]));
        Some(Cause::NoRobotGoal { tried, blockers: ranked(blockers), beyond_m })
    }

    /// What keeps one object from its goal.
    fn of_object(&self, id: ObjectId, object: &'a Object, immovable: &[ObjectId]) -> Vec<Cause> {
        let is_known = self.outlook.is_ours(PICK, |contract| contract.hand == HandUse::Takes)
            && self.outlook.is_ours(PLACE, |contract| contract.hand == HandUse::LetsGo)
            && self.outlook.is_ours(PUSH, Contract::slides);
        if !is_known {
            return Vec::new();
        }
        let means = self.outlook.means(object);
        let alone = self.outlook.alone(id, immovable);
        let may_be_pushed_there = self.outlook.may_be_pushed_there(&means);
        let mut causes = Vec::new();
        let pushes = means.push.is_ok().then(|| self.look.pushing(&alone, id));
        let is_pushed_there = may_be_pushed_there && pushes.as_ref().is_some_and(|pushes| pushes.at_goal > 0);
        if means.pick.is_err() {
            // By hand it goes nowhere; that is an error before the search where no push may lead to the goal.
            if let Some(pushes) = pushes.filter(|_| !is_pushed_there) {
                causes.push(Cause::NoPush { pushes, edges: Vec::new() });
            }
            return causes;
        }
        let at_start = self.look.taking(&alone, id, Place::Start);
        let at_goal = self.look.arriving(&alone, id);
        let can_be_taken = !at_start.good.is_empty() || pushes.as_ref().is_some_and(|pushes| pushes.taken > 0);
        if is_pushed_there {
            return causes;
        }
        if !can_be_taken {
            match pushes {
                Some(pushes) if at_start.hands.last_stage() == Some(Stage::Overhang) => {
                    causes.push(Cause::NoPush { pushes, edges: self.look.at_edges(&alone, id) });
                }
                pushes => {
                    causes.push(Cause::NoHand { hands: at_start.hands.clone() });
                    causes.extend(pushes.map(|pushes| Cause::NoPush { pushes, edges: Vec::new() }));
                }
            }
        }
        if at_goal.good.is_empty() {
            causes.push(self.no_arrival(&at_goal));
        }
        if !causes.is_empty() {
            return causes;
        }
        causes.extend(self.cut_off(&at_start));
        causes.extend(self.cut_off(&at_goal));
        if causes.is_empty() && at_start.hands.came_to(Stage::Hand) > 0 && !at_start.good.is_empty() {
            causes.extend(self.no_common_grasp(id, &alone, &at_start));
        }
        if causes.is_empty() {
            causes.extend(self.behind(
                id,
                Place::Start,
                self.look.taking(self.look.start, id, Place::Start),
                &at_start,
            ));
            causes.extend(self.behind(id, Place::Goal, self.look.arriving(self.look.start, id), &at_goal));
        }
        causes
    }

    /// Why no pose of the hand brings an object to its goal.
    fn no_arrival(&self, survey: &Survey<'a>) -> Cause {
        let hands = &survey.hands;
        if hands.last_stage() != Some(Stage::Support) {
            return Cause::NoHand { hands: hands.clone() };
        }
        let inside_m = survey.off_support_m.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let wanted_m = self.look.m.settings().safety.edge_margin_m;
        let inside_m = Some(inside_m).filter(|metres| metres.is_finite());
        Cause::NoRoom { object: hands.object.clone(), tried: hands.tried, inside_m, wanted_m }
    }

    /// Whether the base can drive to any of the places from which the hand does its work.
    fn cut_off(&self, survey: &Survey<'a>) -> Option<Cause> {
        let wanted: Vec<_> = survey.good.iter().map(|(_, base)| *base).collect();
        if wanted.is_empty() {
            return None;
        }
        let floor = floor::drive_to_any(self.look.m, self.look.start, &wanted).err()?;
        Some(Cause::CutOff { object: survey.hands.object.clone(), place: survey.hands.place, floor: *floor })
    }

    /// Whether no grasp that takes the object at the start sets it down at its goal.
    fn no_common_grasp(&self, id: ObjectId, state: &TabletopState<M>, at_start: &Survey<'a>) -> Option<Cause> {
        let needs_hand = self.look.goal.groups().iter().flatten().filter(|goal| goal.object == id);
        if needs_hand.into_iter().any(|goal| goal.grip != Grip::Released) {
            return None;
        }
        let count = at_start.good.len() as u64;
        if count < LEAST_GRASPS {
            return None;
        }
        let tries = GOAL_DRAWS.div_ceil(count);
        let mut blockers = BTreeMap::<String, u64>::new();
        for (index, (case, _)) in at_start.good.iter().enumerate() {
            for draw in 0..tries {
                let seed = index as u64 * tries + draw;
                let Some(pose) = self.look.goal_pose(id, seed) else { continue };
                let case = Case { grasp: case.grasp, family: case.family, pose };
                match self.look.sets_down(state, id, &case, seed) {
                    Ok(()) => return None,
                    Err(Some(body)) => *blockers.entry(body).or_default() += 1,
                    Err(None) => {}
                }
            }
        }
        let object = at_start.hands.object.clone();
        Some(Cause::NoCommonGrasp { object, at_start: count, tries, blockers: ranked(blockers) })
    }

    /// Whether other objects, which may be moved, are in the way of all that would be good without them.
    fn behind(&self, id: ObjectId, place: Place, with: Survey<'a>, without: &Survey<'a>) -> Option<Cause> {
        if without.good.is_empty() || !with.good.is_empty() {
            return None;
        }
        let names: Vec<_> = self.outlook.objects().filter(|(other, _)| *other != id).map(|(_, o)| &o.name).collect();
        let others: Vec<Blocker> = with.hands.blockers.into_iter().filter(|b| names.contains(&&b.body)).collect();
        (!others.is_empty()).then(|| Cause::Behind { object: without.hands.object.clone(), place, others })
    }
}
