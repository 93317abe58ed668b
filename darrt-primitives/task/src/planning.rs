//! Planning a problem file from end to end: build, search, verify, export.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use darrt_core::budget::{Budget, Cancel, Stop};
use darrt_core::cost::{ExecutionCost, plan_seconds};
use darrt_core::domain::Domain as _;
use darrt_core::extend::ExtendOptions;
use darrt_core::goal::Goal;
use darrt_core::improve::{ImproveOptions, Improvement};
use darrt_core::observe::accounts::Accounts;
use darrt_core::observe::{Event, Observer};
use darrt_core::partial::PartialState;
use darrt_core::plan::Plan;
use darrt_core::problem::{Parts, Problem};
use darrt_core::record::Recorder;
use darrt_core::sample::{GoalBiased, Guided, Placed};
use darrt_core::search::{Algorithm, Strategy};
use darrt_core::shorten::ShortenOptions;
use darrt_core::solve::{Cost, Member, Outcome, SolveOptions, Until, solve_recorded};
use darrt_core::space::{ComponentSpace as _, Place};
use darrt_core::state::ObjectId;
use darrt_core::verify::{Refusal, Solution, Verified, Verifier};
use darrt_primitives::collision_scene::NearPair;
use darrt_primitives::goal::TabletopGoal;
use darrt_primitives::local_repair::TransitRepair;
use darrt_primitives::tabletop::{Tabletop, TabletopState};
use darrt_primitives::validity::SceneValidity;
use nalgebra::Isometry3;

use crate::clock::{NoClock, give_clock};
pub use crate::doubts::Doubt;
use crate::doubts::{Outlook, of_meshes};
use crate::export::{Exporter, Written};
use crate::plan_file::{PlanFile, PlannerFacts, Pose, SearchName, Waypoint};
use crate::planning_error::PlanningError;
use crate::problem_file::{CostName, DistanceName, ProblemFile, SamplerName};
use crate::profile::{Profile, Timed, Times, Watched};
use crate::recording::{Recording, Tape};
use crate::registry::Registry;
use crate::robot::{RobotFacts, TaskRobot};
use crate::verify::{Proof, VerifyOptions, verify_unless};
use crate::world::{self, Built};

mod course;
mod partial;
mod steered;
pub mod variants;

pub(crate) use steered::STEER;
use steered::{Required, Steered};
use variants::StrategyChange;

/// Bound on the travel of any point of the robot between two nodes of the tree, metres; the hand moves about a third.
const NODE_SPACING: f64 = 1.0;
/// Extensions that are spent on a shorter plan.
const SHORTENING: usize = 200;
/// See [`Strategy::try_penalty_m`].
const TRY_PENALTY: f64 = 0.1;
/// Share of the samples that are places of an earlier plan, where there is one.
const HINTS: f64 = 0.5;
/// Share of the samples from a goal for several objects that name only some of them.
const GOAL_PARTS: f64 = 0.5;
/// Iterations of an attempt where several are needed and nobody says how long one is; as in the built-in problems.
const RESTART_ITERATIONS: u64 = 2000;

/// What to plan and how; `None` keeps what the problem file says.
#[derive(Debug, Clone)]
pub struct PlanRequest {
    /// The problem.
    pub problem: ProblemFile,
    /// Seed of every random choice.
    pub seed: u64,
    /// Attempts that run at the same time.
    pub threads: usize,
    /// Wall-clock limit.
    pub time_limit: Option<Duration>,
    /// Most iterations over all attempts.
    pub iterations: Option<u64>,
    /// Iterations after which an attempt is given up for a new one.
    pub restart: Option<u64>,
    /// Which components a sample names.
    pub sampler: Option<SamplerName>,
    /// Which distance picks the node.
    pub distance: Option<DistanceName>,
    /// Which searches; the attempts take them in turn. With several, the attempts are restarted after 2000 iterations if
    /// nothing says when.
    pub algorithms: Vec<Algorithm>,
    /// Go on until the budget ends, and keep the plan that is the cheapest in this; `None`: end with the first plan.
    /// Attempts are restarted after 2000 iterations if nothing says when.
    pub improve: Option<Cost>,
    /// Leave plans as they are found, and do not look for ones that take less time to carry out. So it is too when they are
    /// improved in clearance.
    pub as_found: bool,
    /// Draw where the robot stands from its inverse reachability model, not from a ring around the hand's pose; see
    /// [`TaskRobot::with_bases_from_reachability`].
    pub bases_from_reachability: bool,
    /// What the default improvement of a plan saves; seconds of execution unless a user's own cost is named.
    pub cost: CostName,
    /// Changes of the search strategy, after all else.
    pub changes: Vec<StrategyChange>,
    /// Places of objects by name that are proposed to the search, as an earlier plan had them.
    pub hints: Vec<BTreeMap<String, Pose>>,
    /// Keep how the trees grew.
    pub record: bool,
}

impl PlanRequest {
    /// The problem as its file says, on one thread.
    pub fn new(problem: ProblemFile, seed: u64) -> Self {
        Self {
            problem,
            seed,
            threads: 1,
            time_limit: None,
            iterations: None,
            restart: None,
            sampler: None,
            distance: None,
            algorithms: vec![Algorithm::default()],
            improve: None,
            as_found: false,
            bases_from_reachability: false,
            cost: CostName::default(),
            changes: Vec::new(),
            hints: Vec::new(),
            record: false,
        }
    }
}

/// How planning ended.
#[derive(Debug)]
pub struct PlanResult {
    /// The verified plan, if one was found.
    pub plan: Option<PlanFile>,
    /// What the verifier saw of that plan.
    pub proof: Option<Proof>,
    /// Why the plan has no clock, if it has none.
    pub no_clock: Option<NoClock>,
    /// Seconds that carrying it out takes, see [`CostName`]: the cost by which plans are compared, an estimate of what its clock
    /// says.
    pub execution_s: Option<f64>,
    /// The plan that was found before it was improved, with the seconds of its straight ways: where one is blocked, the way
    /// around takes longer. `None` if the plan is as it was found.
    pub found: Option<(PlanFile, f64)>,
    /// How many plans were found, of which it is the cheapest; at most 1 unless plans were to be improved.
    pub plans: u64,
    /// What the problem itself puts nearer to each other than the least margin.
    pub near: Vec<NearPair>,
    /// What made a plan unlikely before the search.
    pub doubts: Vec<Doubt>,
    /// Why it stopped.
    pub stop: Stop,
    /// Counts per primitive.
    pub accounts: Accounts,
    /// Iterations over all attempts.
    pub iterations: u64,
    /// Nodes of the largest tree.
    pub nodes: usize,
    /// Attempts begun anew.
    pub restarts: u64,
    /// Metres from the goal to the nearest state found.
    pub nearest_to_goal: f64,
    /// Time used.
    pub elapsed: Duration,
    /// Where the time went.
    pub times: Times,
    /// The last refusal of the verifier.
    pub last_refusal: Option<String>,
    /// Without a plan, the beginning of one, verified: as far towards the goal as the search came with the objects. `None` if
    /// it moved none, or was cancelled.
    pub partial: Option<(PlanFile, Proof)>,
    /// The state nearest to the goal, by the planner's distance; no way to it need be free.
    pub nearest: Option<Waypoint>,
    /// How the trees grew, if that was asked for.
    pub recording: Option<Recording>,
}

/// The judge: a plan is exported and the plan file is verified, so that what is accepted is what the user gets. What a file
/// cannot show is looked at before.
#[derive(Debug)]
struct FileVerifier {
    exporter: Arc<Exporter>,
    facts: Arc<RobotFacts>,
    cancel: Cancel,
    watch: Arc<Profile>,
}

/// What goes with a plan that was accepted: its steps as they are in the file, and what the verifier saw.
#[derive(Debug, Clone)]
struct Judged {
    written: Written,
    proof: Proof,
}

impl<M: TaskRobot> Verifier<Tabletop<M>> for FileVerifier {
    fn verify(
        &self,
        m: &Tabletop<M>,
        start: &TabletopState<M>,
        goal: &dyn Goal<Tabletop<M>>,
        plan: &Plan<Tabletop<M>>,
    ) -> Result<Verified, Refusal> {
        course::check(m, start, goal, plan)?;
        let whole = |reason: String| Refusal { step: None, at: 0.0, reason };
        let file =
            self.exporter.export(m, plan, 0, PlannerFacts::default()).map_err(|error| whole(error.to_string()))?;
        let judge = || verify_unless(&file, &self.facts, &VerifyOptions::default(), &self.cancel);
        let proof = self.watch.verification(judge).map_err(|refusal| whole(refusal.to_string()))?;
        let clearance_m = proof.smallest_clearance.as_ref().map(|smallest| smallest.distance_m);
        Ok(Verified { clearance_m, evidence: Some(Arc::new(Judged { written: (file.steps, file.contracts), proof })) })
    }
}

impl PlanResult {
    /// The same with a clock for the whole plan, if there is one that the verifier accepts.
    pub(crate) fn clocked(mut self, facts: &RobotFacts) -> Self {
        if let (Some(plan), Some(proof)) = (&mut self.plan, &mut self.proof) {
            self.no_clock = give_clock(plan, facts, &VerifyOptions::default(), &Cancel::new()).err();
            proof.duration_s = plan.timing.as_ref().map(|timing| timing.duration_s);
        }
        self
    }
}

/// A problem ready to be solved.
#[derive(Debug)]
pub struct Prepared<M: TaskRobot> {
    /// The planner's problem.
    pub problem: Problem<Tabletop<M>>,
    /// What the problem itself puts nearer to each other than the least margin.
    pub near: Vec<NearPair>,
    /// What makes a plan unlikely; empty for most problems.
    pub doubts: Vec<Doubt>,
    exporter: Arc<Exporter>,
    facts: Arc<RobotFacts>,
    /// G, of which a partial plan meets some parts.
    goal: TabletopGoal<M::Joints>,
}

/// Builds and checks everything about a problem before the search.
///
/// # Errors
/// [`PlanningError`] with what cannot be used: a start outside limits or in collision, a blocked goal, a missing
/// primitive, a robot or shape that cannot be built.
pub fn prepare<M: TaskRobot>(registry: &Registry<M>, file: &ProblemFile) -> Result<Prepared<M>, PlanningError> {
    prepare_unless(registry, file, &Cancel::new())
}

/// [`prepare`]; the verifier gives up as soon as `cancel` is called.
///
/// # Errors
/// As [`prepare`].
pub fn prepare_unless<M: TaskRobot>(
    registry: &Registry<M>,
    file: &ProblemFile,
    cancel: &Cancel,
) -> Result<Prepared<M>, PlanningError> {
    prepare_watched(registry, &PlanRequest::new(file.clone(), 0), cancel, &Profile::start())
}

fn prepare_watched<M: TaskRobot>(
    registry: &Registry<M>,
    request: &PlanRequest,
    cancel: &Cancel,
    watch: &Arc<Profile>,
) -> Result<Prepared<M>, PlanningError> {
    let file = &request.problem;
    registry.check(file, &file.name)?;
    registry.check_companions(file)?;
    let (robot, arm) = M::build(&file.robot)?;
    let allowed: Vec<_> = registry.allowed(file).collect();
    crate::goal_feasibility::check_feasibility(file, allowed.iter().copied(), &robot)?;
    crate::steer_feasibility::check_rules(file, &allowed, &robot)?;
    let robot = if request.bases_from_reachability { robot.with_bases_from_reachability() } else { robot };
    let Built { world, start, goal, scene, near } = world::build_with(registry, file, robot, arm)?;
    let mut doubts = of_meshes(file, &scene, world.movables());
    // What is wrong with the start may be so because of what is doubted.
    let so_far: Vec<_> = doubts.iter().map(|doubt| doubt.words.clone()).collect();
    let with_doubts = |error: PlanningError| match error {
        error if so_far.is_empty() => error,
        error => PlanningError::Doubtful { error: Box::new(error), doubts: so_far.join("; ") },
    };
    let validity = SceneValidity::new(&world);
    let outlook = Outlook { problem: file, allowed: &allowed, m: &world, start: &start, goal: &goal, cancel };
    let immovable = outlook.immovable();
    let blocked = crate::goal_check::check_goal(&world, &goal, &scene, &start, &immovable).map_err(&with_doubts)?;
    outlook.check_rims()?;
    doubts.extend(blocked.map(|words| {
        let refuted = Some("the goal is not blocked, which was doubted".to_owned());
        Doubt { words, refuted }
    }));
    doubts.extend(outlook.doubts(&immovable));
    let facts = Arc::new(M::facts(&file.robot)?);
    let exporter = Arc::new(Exporter::new(file, &facts)?);
    let (whole_goal, robot_facts) = (goal.clone(), Arc::clone(&facts));
    let verifier =
        FileVerifier { exporter: Arc::clone(&exporter), facts, cancel: cancel.clone(), watch: Arc::clone(watch) };
    let ids: Vec<_> = allowed.iter().map(|(id, _)| *id).collect();
    let rules = steered::rules(&file.steers, &ids, &scene);
    let (goal, marks) = (Arc::new(goal), steered::required(&rules));
    let steered = |part| {
        let (rules, goal) = (Arc::clone(&rules), Arc::clone(&goal));
        if rules.is_empty() { part } else { Box::new(Steered { part, rules, goal }) as _ }
    };
    let primitives = registry.build_primitives(file)?.into_iter().map(steered);
    let problem = Problem::new(Parts {
        domain: world,
        start,
        goal: Box::new(Timed { part: Required { part: Arc::clone(&goal), marks }, watch: Arc::clone(watch) }),
        primitives: primitives.map(|part| Box::new(Timed { part, watch: Arc::clone(watch) }) as _).collect(),
        validity: Box::new(Timed { part: validity, watch: Arc::clone(watch) }),
        verifier: Box::new(verifier),
    })
    .map_err(|error| with_doubts(error.into()))?;
    Ok(Prepared { problem, near, doubts, exporter, facts: robot_facts, goal: whole_goal })
}

/// Plans. Stopping without a plan is a result, not an error.
///
/// # Errors
/// [`PlanningError`] when the problem cannot be planned at all; see [`prepare`].
pub fn plan<M: TaskRobot>(
    registry: &Registry<M>,
    request: &PlanRequest,
    cancel: &Cancel,
    observer: &mut dyn Observer,
) -> Result<PlanResult, PlanningError> {
    let (result, facts) = plan_without_clock(registry, request, cancel, observer)?;
    Ok(result.clocked(&facts))
}

/// [`plan`] for those who do not need to know when the robot is where; also the facts about the robot.
///
/// # Errors
/// As [`plan`].
pub(crate) fn plan_without_clock<M: TaskRobot>(
    registry: &Registry<M>,
    request: &PlanRequest,
    cancel: &Cancel,
    observer: &mut dyn Observer,
) -> Result<(PlanResult, Arc<RobotFacts>), PlanningError> {
    let watch = Profile::start();
    let prepared = prepare_watched(registry, request, cancel, &watch)?;
    let cost = &*registry.cost(&request.cost)?;
    let mut strategy = strategy(registry, request)?;
    if request.as_found || request.improve == Some(Cost::Clearance) {
        strategy.improve = None;
    }
    request.changes.iter().for_each(|change| change.apply(&mut strategy));
    if !request.hints.is_empty() {
        let targets = hinted(prepared.problem.domain(), &request.hints);
        strategy.sampler = Box::new(Guided::new(strategy.sampler, targets, HINTS)?);
    }
    strategy.local_repair = strategy.local_repair.map(|part| Box::new(Timed { part, watch: Arc::clone(&watch) }) as _);
    let budget = &request.problem.budget;
    let needs_restarts = request.improve.is_some() || request.algorithms.len() > 1;
    let restart_iterations =
        request.restart.or(budget.restart_iterations).or(needs_restarts.then_some(RESTART_ITERATIONS));
    let seconds = Duration::try_from_secs_f64(budget.time_limit_s).ok();
    let options = SolveOptions {
        seed: request.seed,
        budget: Budget {
            time: request.time_limit.or(seconds),
            iterations: request.iterations.or(budget.iterations),
            nodes: budget.nodes.and_then(|n| usize::try_from(n).ok()),
            cancel: cancel.clone(),
        },
        restart_iterations,
        threads: request.threads,
    };
    if request.improve.is_some() && options.budget.time.is_none() && options.budget.iterations.is_none() {
        return Err(PlanningError::NoLimit);
    }
    let begun = watch.elapsed();
    for doubt in &prepared.doubts {
        if observer.on_event(&Event::Doubt { reason: &doubt.words }).is_break() {
            cancel.cancel();
        }
    }
    let observer = &mut Watched { observer, watch: Arc::clone(&watch), plans: 0 };
    let strategy = &strategy;
    let members: Vec<_> =
        request.algorithms.iter().map(|algorithm| Member { algorithm: *algorithm, strategy }).collect();
    let until = request.improve.map_or(Until::Solved, Until::BudgetEnds);
    let mut tape = request.record.then(Tape::default);
    let recorder = tape.as_mut().map(|tape| tape as &mut dyn Recorder<Tabletop<M>>);
    let outcome = solve_recorded(&prepared.problem, &members, until, &options, observer, recorder);
    let is_solved = outcome.solution.is_some();
    let plans = if request.improve.is_some() { observer.plans } else { u64::from(is_solved) };
    let times = watch.times(begun, outcome.elapsed, is_solved);
    let recording = tape.map(|tape| {
        let names = prepared.problem.primitives().iter().map(|part| part.name().to_owned()).collect();
        let solved = outcome.solution.as_ref().map(|_| outcome.restarts).filter(|_| request.improve.is_none());
        tape.wound_up(&request.problem, request.seed, names, (outcome.restarts, solved))
    });
    let result = PlanResult { plans, times, recording, ..result(&prepared, request, cost, outcome)? };
    Ok((result, prepared.facts))
}

/// The places that are proposed, as targets: those of objects that there are, and that may be there.
fn hinted<M: TaskRobot>(m: &Tabletop<M>, hints: &[BTreeMap<String, Pose>]) -> Vec<PartialState<Tabletop<M>>> {
    let target = |hint: &BTreeMap<String, Pose>| {
        let named = m.movables().iter().enumerate().filter_map(|(index, movable)| {
            let pose = Isometry3::from(*hint.get(&*movable.body.name)?);
            Some((ObjectId::new(index), pose))
                .filter(|_| m.objects().get(index).is_some_and(|space| space.contains(&pose)))
        });
        named.fold(PartialState::anywhere(m), |target, (id, pose)| target.with_object(id, pose))
    };
    hints.iter().map(target).filter(|target| target.objects().next().is_some()).collect()
}

fn result<M: TaskRobot>(
    prepared: &Prepared<M>,
    request: &PlanRequest,
    cost: &dyn ExecutionCost<Tabletop<M>>,
    outcome: Outcome<Tabletop<M>>,
) -> Result<PlanResult, PlanningError> {
    let (sampler, distance) = chosen(request);
    let facts = PlannerFacts {
        sampler,
        distance,
        searches: request.algorithms.iter().filter_map(|algorithm| SearchName::of(*algorithm)).collect(),
        improve: request.improve.map(Into::into),
        as_found: request.as_found,
        iterations: outcome.iterations,
        restarts: outcome.restarts,
        nodes: outcome.nodes as u64,
    };
    let m = prepared.problem.domain();
    let execution_s = outcome.solution.as_ref().map(|solution| plan_seconds(cost, m, solution.plan()));
    let found = outcome.solution.as_ref().and_then(Solution::found).map(|plan| {
        let file = prepared.exporter.export(m, plan, request.seed, facts.clone())?;
        Ok::<_, PlanningError>((file, plan_seconds(cost, m, plan)))
    });
    let found = found.transpose()?;
    let whole = || (request.seed, facts.clone());
    let partial = outcome.part.as_ref().and_then(|plan| partial::verified(prepared, plan, whole()));
    let nearest = outcome.nearest.as_ref().map(|state| prepared.exporter.waypoint(m, state, state.mode.gap_m()));
    let judged = outcome.solution.map(Solution::into_parts).and_then(|(plan, verified)| {
        let judged = verified.evidence?.downcast().ok()?;
        Some((plan, Arc::<Judged>::unwrap_or_clone(judged)))
    });
    let (plan, proof) = judged
        .map(|(plan, Judged { written, proof })| {
            (prepared.exporter.with_steps(m, &plan, written, request.seed, facts), proof)
        })
        .unzip();
    Ok(PlanResult {
        plan,
        proof,
        no_clock: None,
        execution_s,
        found,
        plans: 0,
        near: prepared.near.clone(),
        doubts: prepared.doubts.clone(),
        stop: outcome.stop,
        accounts: outcome.accounts,
        iterations: outcome.iterations,
        nodes: outcome.nodes,
        restarts: outcome.restarts,
        nearest_to_goal: outcome.nearest_to_goal,
        elapsed: outcome.elapsed,
        times: Times::default(),
        last_refusal: outcome.last_refusal,
        partial,
        nearest,
        recording: None,
    })
}

fn chosen(request: &PlanRequest) -> (SamplerName, DistanceName) {
    let sampling = &request.problem.sampling;
    (
        request.sampler.clone().unwrap_or_else(|| sampling.sampler.clone()),
        request.distance.clone().unwrap_or_else(|| sampling.distance.clone()),
    )
}

/// SAMPLE, DISTANCE and the cost of improvement as named, the rest as it is best.
///
/// # Errors
/// [`PlanningError`] for an unknown name, or a share outside its range.
pub fn strategy<M: TaskRobot>(
    registry: &Registry<M>,
    request: &PlanRequest,
) -> Result<Strategy<Tabletop<M>>, PlanningError> {
    let sampling = &request.problem.sampling;
    let (sampler, distance) = chosen(request);
    let sampler = registry.sampler(&sampler, sampling)?;
    let distance = registry.distance(&distance)?;
    let cost = registry.cost(&request.cost)?;
    let sampler = GoalBiased::new(sampler, sampling.goal_bias)?.in_part(GOAL_PARTS)?;
    // Around the goal's samples: one of several objects is then taken out of their way first.
    let sampler = Box::new(Placed::new(sampler, Place::SupportEdge, sampling.edge_share)?);
    Ok(Strategy {
        sampler,
        distance,
        extend: ExtendOptions { spacing_m: NODE_SPACING, defer: true, ..ExtendOptions::default() },
        local_repair: Some(Box::new(TransitRepair::default())),
        try_penalty_m: TRY_PENALTY,
        shorten: ShortenOptions { extensions: SHORTENING },
        improve: Some(Improvement { cost, options: ImproveOptions::default() }),
    })
}

#[cfg(test)]
mod tests;
