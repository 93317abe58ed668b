//! What would make a plan: changed problems, one change at a time and then small sets, each planned and verified as any other.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering::SeqCst};
use std::time::{Duration, Instant};

use darrt_core::budget::Cancel;
use darrt_core::observe::Silent;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::cause::Cause;
use super::relax::Relaxation;
use super::{Diagnosis, causes, looked_for};
use crate::planning::{PlanRequest, plan_without_clock};
use crate::planning_error::PlanningError;
use crate::problem_file::ProblemFile;
use crate::registry::Registry;
use crate::robot::TaskRobot;

/// Part of the iterations for a changed problem in which something still keeps a plan away, as far as a few tries tell.
const DOUBTED: u64 = 4;
/// How many times the iterations are tried as a change of its own.
const MORE: u64 = 4;
/// Pairs of changes that are tried at most.
const PAIRS: usize = 32;
/// No clock ends a search of a fixed number of iterations.
const FOREVER: Duration = Duration::from_secs(1 << 30);

/// What to explain.
#[derive(Debug, Clone)]
pub struct ExplainRequest {
    /// The problem, and how it is planned; its limits do not count.
    pub plan: PlanRequest,
    /// Iterations for each changed problem.
    pub iterations: u64,
    /// Changed problems that are planned at the same time.
    pub threads: usize,
}

/// A set of changes with which the problem has a plan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Solved {
    /// The changes; without any of them no plan was found.
    pub changes: Vec<Relaxation>,
    /// Iterations of the search.
    pub iterations: u64,
    /// Steps of the verified plan.
    pub steps: u64,
    /// Seconds of the search; not the same in every run.
    #[serde(skip)]
    pub seconds: f64,
}

/// What would make a plan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Explanation {
    /// The problem.
    pub problem: String,
    /// Iterations for each changed problem.
    pub iterations: u64,
    /// Why it is refused as it is, before any search, in words.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub refused: Option<String>,
    /// What keeps a plan away as it is.
    pub causes: Vec<Cause>,
    /// The problem has a plan as it is: the iterations that it took.
    pub solved_as_it_is: Option<u64>,
    /// Sets of changes that make a plan, the smallest first.
    pub solved: Vec<Solved>,
    /// How many changed problems were planned.
    pub tried: u64,
    /// It was stopped before it had tried all.
    pub is_interrupted: bool,
}

/// Plans changed problems and says which of them have a plan. The same on any number of threads.
///
/// # Errors
/// The problem itself cannot be read as one; that it cannot be planned as it is is no error.
pub fn explain<M: TaskRobot>(
    registry: &Registry<M>,
    request: &ExplainRequest,
    cancel: &Cancel,
) -> Result<Explanation, PlanningError> {
    let problem = &request.plan.problem;
    registry.check(problem, &problem.name)?;
    let solver = Solver { registry, request, cancel, tried: AtomicUsize::new(0) };
    // What is proven comes before what a few tries find.
    let (as_it_is, refused) = match solver.solve(problem, Vec::new()) {
        Ok(solved) => (solved, None),
        Err(error) => (None, Some(error)),
    };
    let proven = refused.as_ref().and_then(|error| Diagnosis::of_error(&problem.name, error));
    let found = match proven {
        Some(proven) => proven.causes,
        None => causes(registry, &request.plan, cancel).unwrap_or_default(),
    };
    let mut explanation = Explanation {
        problem: problem.name.clone(),
        iterations: request.iterations,
        refused: refused.map(|error| error.to_string()),
        causes: found,
        solved_as_it_is: None,
        solved: Vec::new(),
        tried: 0,
        is_interrupted: false,
    };
    if let Some(solved) = as_it_is {
        explanation.solved_as_it_is = Some(solved.iterations);
    } else {
        let mut singles: Vec<_> = Relaxation::all(registry, problem);
        singles.extend(explanation.causes.iter().flat_map(|cause| Relaxation::lowered(problem, cause)));
        singles.push(Relaxation::MoreTime { iterations: request.iterations.saturating_mul(MORE) });
        explanation.solved = solver.solve_all(&singles.iter().map(|one| vec![one.clone()]).collect::<Vec<_>>());
        if explanation.solved.is_empty() {
            let groups: Vec<_> = Relaxation::groups(problem).into_iter().map(|group| vec![group]).collect();
            let solved = solver.solve_all(&groups);
            explanation.solved = solved.first().and_then(|first| solver.least(first)).into_iter().collect();
        }
        if explanation.solved.is_empty() {
            let near = Relaxation::against(registry, problem, &explanation.causes);
            let pairs = pairs(if near.len() > 1 { &near } else { &singles });
            explanation.solved = solver.solve_all(&pairs);
        }
    }
    explanation.tried = solver.tried.into_inner() as u64;
    explanation.is_interrupted = cancel.is_cancelled();
    Ok(explanation)
}

/// Pairs of changes, those of the smallest first.
fn pairs(changes: &[Relaxation]) -> Vec<Vec<Relaxation>> {
    let mut pairs = Vec::new();
    for (later, second) in changes.iter().enumerate() {
        pairs.extend(changes.iter().take(later).map(|first| vec![first.clone(), second.clone()]));
    }
    pairs.truncate(PAIRS);
    pairs
}

/// Plans changed problems.
struct Solver<'a, M: TaskRobot> {
    registry: &'a Registry<M>,
    request: &'a ExplainRequest,
    cancel: &'a Cancel,
    tried: AtomicUsize,
}

impl<M: TaskRobot> Solver<'_, M> {
    /// The sets with which there is a plan, in the order in which they are given.
    fn solve_all(&self, sets: &[Vec<Relaxation>]) -> Vec<Solved> {
        let next = AtomicUsize::new(0);
        let done = Mutex::new(Vec::new());
        let work = || {
            loop {
                let index = next.fetch_add(1, SeqCst);
                let Some(set) = sets.get(index).filter(|_| !self.cancel.is_cancelled()) else { return };
                let Some(changed) = applied(&self.request.plan.problem, set) else { continue };
                if let (Ok(Some(solved)), Ok(mut done)) = (self.solve(&changed, set.clone()), done.lock()) {
                    done.push((index, solved));
                }
            }
        };
        std::thread::scope(|scope| {
            for _ in 0..self.request.threads.max(1) {
                scope.spawn(work);
            }
        });
        let mut done = done.into_inner().unwrap_or_default();
        done.sort_by_key(|(index, _)| *index);
        done.into_iter().map(|(_, solved)| solved).collect()
    }

    /// Plans one problem.
    ///
    /// # Errors
    /// It is refused before the search.
    fn solve(&self, changed: &ProblemFile, changes: Vec<Relaxation>) -> Result<Option<Solved>, PlanningError> {
        let more = changes.iter().find_map(|change| match change {
            Relaxation::MoreTime { iterations } => Some(*iterations),
            _ => None,
        });
        let mut request = PlanRequest { problem: changed.clone(), ..self.request.plan.clone() };
        let is_doubted = looked_for(self.registry, &request, true, self.cancel)?.iter().any(Cause::is_decisive);
        let iterations = more.unwrap_or(self.request.iterations);
        // A problem as it is gets all of them: that nothing was found in a few tries is no proof.
        let share = if is_doubted && !changes.is_empty() { DOUBTED } else { 1 };
        request.iterations = Some((iterations / share).max(1));
        request.time_limit = Some(FOREVER);
        request.threads = 1;
        request.as_found = true;
        self.tried.fetch_add(1, SeqCst);
        let begun = Instant::now();
        let (result, _) = plan_without_clock(self.registry, &request, self.cancel, &mut Silent)?;
        Ok(result.plan.map(|plan| {
            let (steps, seconds) = (plan.steps.len() as u64, begun.elapsed().as_secs_f64());
            Solved { changes, iterations: result.iterations, steps, seconds }
        }))
    }

    /// As few as possible of the obstacles whose absence makes a plan: one after the other is put back if there is a plan with it.
    fn least(&self, solved: &Solved) -> Option<Solved> {
        let [Relaxation::Without { obstacles }] = solved.changes.as_slice() else { return Some(solved.clone()) };
        let (mut gone, mut best) = (obstacles.clone(), solved.clone());
        for name in obstacles {
            let fewer: Vec<_> = gone.iter().filter(|other| *other != name).cloned().collect();
            let set = vec![Relaxation::Without { obstacles: fewer.clone() }];
            let changed = applied(&self.request.plan.problem, &set)?;
            if let Ok(Some(solved)) = self.solve(&changed, set) {
                (gone, best) = (fewer, solved);
            }
        }
        Some(best)
    }
}

/// The problem with all of these changes.
fn applied(problem: &ProblemFile, changes: &[Relaxation]) -> Option<ProblemFile> {
    changes.iter().try_fold(problem.clone(), |problem, change| change.applied(&problem))
}
