//! Planning a problem file from end to end: build, search, verify, export.

use std::sync::Arc;
use std::time::Duration;

use darrt_core::budget::{Budget, Cancel, Stop};
use darrt_core::cost::plan_seconds;
use darrt_core::distance::{Distance, Euclidean, ExactTour, GreedyVisit};
use darrt_core::extend::ExtendOptions;
use darrt_core::goal::Goal;
use darrt_core::improve::{ImproveOptions, Improvement};
use darrt_core::observe::Observer;
use darrt_core::observe::accounts::Accounts;
use darrt_core::plan::Plan;
use darrt_core::problem::{Parts, Problem};
use darrt_core::sample::{Full, GoalBiased, Placed, RandomSubset, RobotOrObjects, Sampler};
use darrt_core::search::{Algorithm, Strategy};
use darrt_core::shorten::ShortenOptions;
use darrt_core::solve::{Cost, Member, Outcome, SolveOptions, Until, solve_with};
use darrt_core::space::Place;
use darrt_core::verify::{Refusal, Solution, Verified, Verifier};
use darrt_primitives::detour::Detour;
use darrt_primitives::execution_time::ExecutionTime;
use darrt_primitives::surroundings::NearPair;
use darrt_primitives::validity::SceneValidity;

use crate::export::Exporter;
use crate::plan_file::{PlanFile, PlannerFacts, SearchName, Step};
use crate::planning_error::PlanningError;
use crate::problem_file::{DistanceName, PrimitiveName, ProblemFile, SamplerName, Sampling};
use crate::stopwatch::{Stopwatch, Timed, Times, Watched};
use crate::verify::{Proof, VerifyOptions, verify_unless};
use crate::world::{self, Built, World, WorldState};

mod course;

/// Bound on the travel of any point of the robot between two nodes of the tree, metres; the hand moves about a third.
const NODE_SPACING: f64 = 1.0;
/// Extensions that are spent on a shorter plan.
const SHORTENING: usize = 200;
/// See [`Strategy::try_penalty_m`].
const TRY_PENALTY: f64 = 0.1;
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
    /// [`with_bases_from_reachability`](crate::robot::Pr2::with_bases_from_reachability).
    pub bases_from_reachability: bool,
    /// Changes the search strategy after all else; `None`: as it is.
    pub adjust: Option<fn(&mut Strategy<World>)>,
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
            adjust: None,
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
    /// Seconds that carrying it out takes, see [`ExecutionTime`].
    pub execution_s: Option<f64>,
    /// The plan that was found before it was improved, with the seconds of its straight ways: where one is blocked, the way
    /// around takes longer. `None` if the plan is as it was found.
    pub found: Option<(PlanFile, f64)>,
    /// How many plans were found, of which it is the cheapest; at most 1 unless plans were to be improved.
    pub plans: u64,
    /// What the problem itself puts nearer to each other than the least margin.
    pub near: Vec<NearPair>,
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
}

/// The judge: a plan is exported and the plan file is verified, so that what is accepted is what the user gets. What a file
/// cannot show is looked at before.
#[derive(Debug)]
struct FileVerifier {
    exporter: Arc<Exporter>,
    cancel: Cancel,
    watch: Arc<Stopwatch>,
}

/// What goes with a plan that was accepted: its steps as they are in the file, and what the verifier saw.
#[derive(Debug, Clone)]
struct Judged {
    steps: Vec<Step>,
    proof: Proof,
}

impl Verifier<World> for FileVerifier {
    fn verify(
        &self,
        m: &World,
        start: &WorldState,
        goal: &dyn Goal<World>,
        plan: &Plan<World>,
    ) -> Result<Verified, Refusal> {
        course::check(m, start, goal, plan)?;
        let file = self.exporter.export(m, plan, 0, PlannerFacts::default());
        let verdict = self.watch.verification(|| verify_unless(&file, &VerifyOptions::default(), &self.cancel));
        let proof = verdict.map_err(|refusal| Refusal { step: None, at: 0.0, reason: refusal.to_string() })?;
        let clearance_m = proof.smallest_clearance.as_ref().map(|smallest| smallest.distance_m);
        Ok(Verified { clearance_m, evidence: Some(Arc::new(Judged { steps: file.steps, proof })) })
    }
}

/// A problem ready to be solved.
#[derive(Debug)]
pub struct Prepared {
    /// The planner's problem.
    pub problem: Problem<World>,
    /// What the problem itself puts nearer to each other than the least margin.
    pub near: Vec<NearPair>,
    exporter: Arc<Exporter>,
}

/// Builds and checks everything about a problem before the search.
///
/// # Errors
/// [`PlanningError`] with what cannot be used: a start outside limits or in collision, a blocked goal, a missing
/// primitive, a robot or shape that cannot be built.
pub fn prepare(file: &ProblemFile) -> Result<Prepared, PlanningError> {
    prepare_unless(file, &Cancel::new())
}

/// [`prepare`]; the verifier gives up as soon as `cancel` is called.
///
/// # Errors
/// As [`prepare`].
pub fn prepare_unless(file: &ProblemFile, cancel: &Cancel) -> Result<Prepared, PlanningError> {
    prepare_watched(&PlanRequest::new(file.clone(), 0), cancel, &Stopwatch::start())
}

fn prepare_watched(request: &PlanRequest, cancel: &Cancel, watch: &Arc<Stopwatch>) -> Result<Prepared, PlanningError> {
    let file = &request.problem;
    check_companions(file)?;
    crate::goal_means::check_means(file)?;
    let Built { world, start, goal, scene, near } = world::build_with(file, |robot| {
        if request.bases_from_reachability { robot.with_bases_from_reachability() } else { robot }
    })?;
    let validity = SceneValidity::new(&world);
    crate::goal_check::check_goal(&world, &goal, &scene)?;
    let exporter = Arc::new(Exporter::new(file, &world)?);
    let verifier = FileVerifier { exporter: Arc::clone(&exporter), cancel: cancel.clone(), watch: Arc::clone(watch) };
    let primitives = world::primitives(file).into_iter();
    let problem = Problem::new(Parts {
        domain: world,
        start,
        goal: Box::new(Timed { part: goal, watch: Arc::clone(watch) }),
        primitives: primitives.map(|part| Box::new(Timed { part, watch: Arc::clone(watch) }) as _).collect(),
        validity: Box::new(Timed { part: validity, watch: Arc::clone(watch) }),
        verifier: Box::new(verifier),
    })?;
    Ok(Prepared { problem, near, exporter })
}

/// Plans. Stopping without a plan is a result, not an error.
///
/// # Errors
/// [`PlanningError`] when the problem cannot be planned at all; see [`prepare`].
pub fn plan(request: &PlanRequest, cancel: &Cancel, observer: &mut dyn Observer) -> Result<PlanResult, PlanningError> {
    let watch = Stopwatch::start();
    let prepared = prepare_watched(request, cancel, &watch)?;
    let (sampler, distance) = chosen(request);
    let mut strategy = strategy(&request.problem.sampling, sampler, distance)?;
    if request.as_found || request.improve == Some(Cost::Clearance) {
        strategy.improve = None;
    }
    if let Some(adjust) = request.adjust {
        adjust(&mut strategy);
    }
    strategy.reroute = strategy.reroute.map(|part| Box::new(Timed { part, watch: Arc::clone(&watch) }) as _);
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
    let observer = &mut Watched { observer, watch: Arc::clone(&watch), plans: 0 };
    let strategy = &strategy;
    let members: Vec<_> =
        request.algorithms.iter().map(|algorithm| Member { algorithm: *algorithm, strategy }).collect();
    let until = request.improve.map_or(Until::Solved, Until::BudgetEnds);
    let outcome = solve_with(&prepared.problem, &members, until, &options, observer);
    let is_solved = outcome.solution.is_some();
    let plans = if request.improve.is_some() { observer.plans } else { u64::from(is_solved) };
    let times = watch.times(begun, outcome.elapsed, is_solved);
    Ok(PlanResult { plans, times, ..result(&prepared, request, (sampler, distance), outcome) })
}

fn result(
    prepared: &Prepared,
    request: &PlanRequest,
    (sampler, distance): (SamplerName, DistanceName),
    outcome: Outcome<World>,
) -> PlanResult {
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
    let execution_s = outcome.solution.as_ref().map(|solution| plan_seconds(&ExecutionTime, m, solution.plan()));
    let found = outcome.solution.as_ref().and_then(Solution::found).map(|plan| {
        let file = prepared.exporter.export(m, plan, request.seed, facts.clone());
        (file, plan_seconds(&ExecutionTime, m, plan))
    });
    let judged = outcome.solution.map(Solution::into_parts).and_then(|(plan, verified)| {
        let judged = verified.evidence?.downcast().ok()?;
        Some((plan, Arc::<Judged>::unwrap_or_clone(judged)))
    });
    let (plan, proof) = judged
        .map(|(plan, Judged { steps, proof })| {
            (prepared.exporter.with_steps(m, &plan, steps, request.seed, facts), proof)
        })
        .unzip();
    PlanResult {
        plan,
        proof,
        execution_s,
        found,
        plans: 0,
        near: prepared.near.clone(),
        stop: outcome.stop,
        accounts: outcome.accounts,
        iterations: outcome.iterations,
        nodes: outcome.nodes,
        restarts: outcome.restarts,
        nearest_to_goal: outcome.nearest_to_goal,
        elapsed: outcome.elapsed,
        times: Times::default(),
        last_refusal: outcome.last_refusal,
    }
}

fn chosen(request: &PlanRequest) -> (SamplerName, DistanceName) {
    let sampling = &request.problem.sampling;
    (request.sampler.unwrap_or(sampling.sampler), request.distance.unwrap_or(sampling.distance))
}

/// SAMPLE and DISTANCE as named.
///
/// # Errors
/// [`PlanningError`] for a share outside its range.
pub fn strategy(
    sampling: &Sampling,
    sampler: SamplerName,
    distance: DistanceName,
) -> Result<Strategy<World>, PlanningError> {
    let sampler: Box<dyn Sampler<World>> = match sampler {
        SamplerName::RobotOrObjects => Box::new(RobotOrObjects::new(sampling.object_share, sampling.base_only_share)?),
        SamplerName::RandomSubset => Box::new(RandomSubset),
        SamplerName::Full => Box::new(Full),
    };
    let distance: Box<dyn Distance<World>> = match distance {
        DistanceName::Greedy => Box::new(GreedyVisit),
        DistanceName::Euclidean => Box::new(Euclidean),
        DistanceName::ExactTour => Box::new(ExactTour),
    };
    let sampler = GoalBiased::new(sampler, sampling.goal_bias)?.in_part(GOAL_PARTS)?;
    // Around the goal's samples: one of several objects is then taken out of their way first.
    let sampler = Box::new(Placed::new(sampler, Place::SupportEdge, sampling.edge_share)?);
    Ok(Strategy {
        sampler,
        distance,
        extend: ExtendOptions { spacing_m: NODE_SPACING, defer: true, ..ExtendOptions::default() },
        reroute: Some(Box::new(Detour::default())),
        try_penalty_m: TRY_PENALTY,
        shorten: ShortenOptions { extensions: SHORTENING },
        improve: Some(Improvement { cost: Box::new(ExecutionTime), options: ImproveOptions::default() }),
    })
}

/// Every manipulation is made of simpler primitives, which must be allowed too.
fn check_companions(file: &ProblemFile) -> Result<(), PlanningError> {
    use PrimitiveName::{ArmRigidTransfer, ArmTransit, Pick, Place, Push, StraightLineArmTransit};
    let needs = [
        (Push, ArmTransit),
        (Push, StraightLineArmTransit),
        (Pick, ArmTransit),
        (Pick, StraightLineArmTransit),
        (Place, ArmRigidTransfer),
        (Place, StraightLineArmTransit),
    ];
    for (primitive, companion) in needs {
        if file.allows(primitive) && !file.allows(companion) {
            return Err(PlanningError::MissingPrimitive {
                primitive: primitive.as_str().to_owned(),
                needs: companion.as_str().to_owned(),
            });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests;
