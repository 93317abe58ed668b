//! `EXTENDTOWARDS(c1, c2, M, B, A)`: PATH, discretised and checked; the valid prefix is kept with every
//! intermediate state.

use std::sync::Arc;

use rand::Rng;
use smallvec::SmallVec;

use crate::domain::Domain;
use crate::error::{Error, in_range};
use crate::motion::Instance;
use crate::observe::accounts::Bucket;
use crate::partial::PartialState;
use crate::path::{Path, PathEnd, Trial, path};
use crate::problem::Problem;
use crate::reroute::Reroute;
use crate::state::State;
use crate::validity::{Blame, BlockKind};

/// How an extension is discretised and bounded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExtendOptions {
    /// Metres of travel between two neighbouring nodes of the tree; positive. Collisions are judged by
    /// [`Validity`](crate::validity::Validity) at its own, finer resolution.
    pub spacing_m: f64,
    /// At most this many primitives in one PATH (the authors' software used 100).
    pub max_depth: usize,
    /// Metres of travel by which a blocked motion is cut shorter than it is free; at least 0. States that almost touch
    /// what blocked them are the nearest to every target behind it, and nothing can be reached from them.
    pub back_off_m: f64,
    /// How many paths are drawn for one extension, at least 1: the first whose bound states are all valid is taken, else
    /// the last. PATH sees no obstacles; this only chooses among its draws.
    pub draws: usize,
}

impl Default for ExtendOptions {
    fn default() -> Self {
        Self { spacing_m: 0.1, max_depth: 20, back_off_m: 0.0, draws: 1 }
    }
}

/// No instance adds more nodes than this, however long it is.
const MAX_STEPS: f64 = 10_000.0;

impl ExtendOptions {
    /// Checks the ranges.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a spacing that is not finite and positive, or a depth of zero.
    pub fn check(&self) -> Result<(), Error> {
        in_range("spacing_m", self.spacing_m, f64::MIN_POSITIVE, f64::MAX, "finite and positive")?;
        in_range("draws", self.draws as f64, 1.0, f64::MAX, "at least 1")?;
        in_range("back_off_m", self.back_off_m, 0.0, f64::MAX, "finite and not negative")?;
        in_range("max_depth", self.max_depth as f64, 1.0, f64::MAX, "at least 1")?;
        Ok(())
    }
}

/// One reached state on the way: where on which instance.
#[derive(Debug)]
pub struct Reached<D: Domain> {
    /// The state.
    pub state: State<D>,
    /// The instance it lies on.
    pub instance: Arc<Instance<D>>,
    /// Its parameter there, in `(0, 1]`.
    pub t: f64,
    /// Index of the primitive that propagated the instance.
    pub primitive: u16,
}

/// What one extension achieved, and why it ended.
#[derive(Debug)]
pub struct Extension<D: Domain> {
    /// The valid prefix, in order; empty if the first step is blocked.
    pub reached: Vec<Reached<D>>,
    /// Did it meet the target?
    pub is_met: bool,
    /// What blocked it, if anything did.
    pub blame: Option<Blame>,
    /// One bucket per primitive, in the order of the problem.
    pub buckets: SmallVec<[Bucket; 8]>,
}

/// Extends `from` towards `to`. Pure but for `rng`.
pub fn extend_towards<D: Domain>(
    problem: &Problem<D>,
    options: &ExtendOptions,
    from: &State<D>,
    to: &PartialState<D>,
    rng: &mut dyn Rng,
) -> Extension<D> {
    extend_around(problem, options, None, from, to, rng)
}

/// [`extend_towards`], looking for a way around where a motion is blocked.
pub fn extend_around<D: Domain>(
    problem: &Problem<D>,
    options: &ExtendOptions,
    reroute: Option<&dyn Reroute<D>>,
    from: &State<D>,
    to: &PartialState<D>,
    rng: &mut dyn Rng,
) -> Extension<D> {
    let m = problem.domain();
    let mut e = path(m, problem.primitives(), from, to, options.max_depth, rng);
    let mut is_worth_it = None;
    for _ in 1..options.draws {
        let Some(r) = reroute else { break };
        let is_valid = !e.instances.is_empty() && rest_is_valid(problem, r, &e, 0);
        is_worth_it = Some(is_valid);
        if is_valid || is_bound_to_repeat(&e) {
            break;
        }
        e = path(m, problem.primitives(), from, to, options.max_depth, rng);
        is_worth_it = None;
    }
    let mut reached = Vec::new();
    let mut blocked: Option<(usize, Blame)> = None;
    for index in 0..e.instances.len() {
        let (Some((primitive, instance)), Some(start)) = (e.instances.get(index), e.states.get(index)) else { break };
        let (primitive, mut instance) = (*primitive, Arc::clone(instance));
        let mut free = problem.validity().free_prefix(m, &instance, start);
        if free.blame.is_some()
            && let Some(r) = reroute.filter(|r| r.is_free_to_turn(&instance))
            && *is_worth_it.get_or_insert_with(|| rest_is_valid(problem, r, &e, index))
            && let Some(around) = r.reroute(m, problem.validity(), &instance, start, rng)
        {
            instance = Arc::new(around);
            free = problem.validity().free_prefix(m, &instance, start);
        }
        let kept = if free.blame.is_some() && options.back_off_m > 0.0 {
            free.fraction - options.back_off_m / instance.motion.length()
        } else {
            free.fraction
        };
        discretise(m, &instance, primitive, kept, options.spacing_m, start, &mut reached);
        let is_short = free.fraction.is_nan() || free.fraction < 1.0;
        if let Some(blame) = free.blame.or_else(|| is_short.then(unexplained)) {
            blocked = Some((index, blame));
            break;
        }
    }
    let buckets = buckets(&e, blocked.as_ref().map(|(index, blame)| (*index, blame.kind)));
    Extension { reached, is_met: blocked.is_none() && e.end == PathEnd::Met, blame: blocked.map(|(_, b)| b), buckets }
}

/// Does the path go straight to a target for the robot alone? Another draw would give the same.
fn is_bound_to_repeat<D: Domain>(e: &Path<D>) -> bool {
    e.instances.iter().all(|(_, instance)| instance.object.is_none())
        && e.trials.iter().all(|(_, trial)| matches!(trial, Trial::Propagated { .. }))
}

/// How much of a motion that cannot turn aside must be free for the way to it to be worth looking for.
const WORTH_REACHING: f64 = 0.25;

/// Is what the chain is bound to pass valid: the end of every instance from `index` on, and the beginning of every later
/// one that cannot turn aside? If not, a way around leads nowhere, and it is dear to find.
fn rest_is_valid<D: Domain>(problem: &Problem<D>, reroute: &dyn Reroute<D>, e: &Path<D>, index: usize) -> bool {
    let m = problem.domain();
    let rest = || e.instances.iter().zip(&e.states).zip(e.states.iter().skip(1)).skip(index);
    let is_bound = |instance: &Instance<D>| !reroute.is_free_to_turn(instance);
    rest()
        .filter(|(((_, i), _), _)| !is_bound(i))
        .all(|(((_, instance), _), end)| problem.validity().check(m, end, &instance.contacts).is_ok())
        && rest().filter(|(((_, i), _), _)| is_bound(i)).all(|(((_, instance), start), _)| {
            problem.validity().free_prefix(m, instance, start).fraction >= WORTH_REACHING
        })
}

/// What a validity check that stops short without saying why is taken to mean.
fn unexplained() -> Blame {
    Blame { kind: BlockKind::Other, first: "motion".into(), second: "unexplained block".into(), place: [0.0; 3] }
}

/// Appends the states of one instance at equal spacing up to `fraction`, the last one exactly there.
fn discretise<D: Domain>(
    m: &D,
    instance: &Arc<Instance<D>>,
    primitive: u16,
    fraction: f64,
    spacing_m: f64,
    start: &State<D>,
    reached: &mut Vec<Reached<D>>,
) {
    if fraction.is_nan() || fraction <= 0.0 {
        return;
    }
    // Also one step for a length or spacing that is not a number.
    let wanted = (instance.motion.length() * fraction / spacing_m).ceil();
    let steps = if wanted > 1.0 { wanted.min(MAX_STEPS) } else { 1.0 };
    let mut i = 1.0;
    while i <= steps {
        let t = if i >= steps { fraction } else { fraction * i / steps };
        reached.push(Reached { state: instance.at(m, t, start), instance: Arc::clone(instance), t, primitive });
        i += 1.0;
    }
}

/// The one bucket of every primitive: the furthest it got in this extension.
fn buckets<D: Domain>(e: &Path<D>, blocked: Option<(usize, BlockKind)>) -> SmallVec<[Bucket; 8]> {
    let mut buckets: SmallVec<[Bucket; 8]> =
        e.useful.iter().map(|useful| if *useful { Bucket::NotChosen } else { Bucket::NotUseful }).collect();
    for (primitive, trial) in &e.trials {
        let bucket = match *trial {
            Trial::Infeasible(why) => Bucket::from(why),
            Trial::NoProgress => Bucket::NoProgress,
            Trial::Propagated { first, last } => match blocked {
                Some((at, _)) if at < first => Bucket::Behind,
                Some((at, kind)) if at < last => Bucket::from(kind),
                _ => Bucket::Accepted,
            },
        };
        if let Some(slot) = buckets.get_mut(usize::from(*primitive)) {
            *slot = (*slot).max(bucket);
        }
    }
    if e.end == PathEnd::Depth
        && blocked.is_none()
        && let Some((primitive, _)) = e.trials.last()
        && let Some(slot) = buckets.get_mut(usize::from(*primitive))
    {
        *slot = Bucket::Depth;
    }
    buckets
}
