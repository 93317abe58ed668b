//! `EXTENDTOWARDS(c1, c2, M, B, A)`: PATH, discretised and checked; the valid prefix is kept with every
//! intermediate state.

use std::sync::Arc;

use rand::Rng;
use smallvec::SmallVec;

use crate::budget::Interrupt;
use crate::domain::Domain;
use crate::error::{Error, in_range};
use crate::local_repair::LocalRepair;
use crate::motion::Instance;
use crate::observe::accounts::Bucket;
use crate::partial::PartialState;
use crate::path::{Path, PathEnd, Trial, path};
use crate::primitive::Infeasible;
use crate::problem::Problem;
use crate::state::{ComponentSet, State};
use crate::validity::{Blame, BlockKind, FreePrefix};

/// How an extension is discretised and bounded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExtendOptions {
    /// Metres of travel between two neighbouring nodes of the tree; positive. Collisions are judged by
    /// [`Validity`](crate::validity::Validity) at its own, finer resolution.
    pub spacing_m: f64,
    /// At most this many primitives in one PATH (the authors' software used 100).
    pub max_depth: usize,
    /// Motions are taken as free if their ends are, and judged as a whole when a plan needs them
    /// ([`validate_steps`](crate::lazy_validation::validate_steps)); only their ends become nodes. Plans are then repaired while they are made
    /// shorter, so [`Strategy::shorten`](crate::search::Strategy::shorten) should allow some extensions.
    pub defer: bool,
    /// Metres of travel after which an extension ends, as in a classic RRT; positive. `None`: it goes as far as PATH leads.
    /// Counts only where motions are judged at once: what is deferred goes to its end.
    pub step_m: Option<f64>,
}

impl Default for ExtendOptions {
    fn default() -> Self {
        Self { spacing_m: 0.1, max_depth: 20, defer: false, step_m: None }
    }
}

/// No instance adds more nodes than this, however long it is.
const MAX_STEPS: f64 = 10_000.0;

impl ExtendOptions {
    /// Checks the ranges.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a spacing or step that is not finite and positive, or a depth of zero.
    pub fn check(&self) -> Result<(), Error> {
        in_range("spacing_m", self.spacing_m, f64::MIN_POSITIVE, f64::MAX, "finite and positive")?;
        if let Some(step_m) = self.step_m {
            in_range("step_m", step_m, f64::MIN_POSITIVE, f64::MAX, "finite and positive")?;
        }
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
    let extender = Extender { problem, options, local_repair: None, interrupt: Interrupt::NEVER };
    extender.extend(from, to, rng)
}

/// What all extensions of one search have in common.
pub struct Extender<'a, D: Domain> {
    /// What is planned.
    pub problem: &'a Problem<D>,
    /// How extensions are discretised.
    pub options: &'a ExtendOptions,
    /// How a way around is looked for where a motion is blocked; `None`: it is not.
    pub local_repair: Option<&'a dyn LocalRepair<D>>,
    /// Asked before every instance of an extension.
    pub interrupt: Interrupt<'a>,
}

impl<D: Domain> Clone for Extender<'_, D> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<D: Domain> Copy for Extender<'_, D> {}

impl<D: Domain> std::fmt::Debug for Extender<'_, D> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Extender").field("options", self.options).finish_non_exhaustive()
    }
}

impl<D: Domain> Extender<'_, D> {
    /// Extends `from` towards `to`. Pure but for `rng` and the interrupt.
    pub fn extend(&self, from: &State<D>, to: &PartialState<D>, rng: &mut dyn Rng) -> Extension<D> {
        let Self { problem, options, local_repair, interrupt } = *self;
        let m = problem.domain();
        let e = path(m, problem.primitives(), from, to, options.max_depth, rng);
        let mut prefixes = Prefixes { problem, e: &e, known: e.instances.iter().map(|_| None).collect() };
        let mut reached = Vec::new();
        let mut blocked: Option<(usize, Blame)> = None;
        let mut cut = None;
        let mut left_m = options.step_m.unwrap_or(f64::INFINITY);
        for index in 0..e.instances.len() {
            if interrupt.stop().is_some() {
                cut = Some(index);
                break;
            }
            let (Some((primitive, instance)), Some(start)) = (e.instances.get(index), e.states.get(index)) else {
                break;
            };
            let (primitive, mut instance) = (*primitive, Arc::clone(instance));
            if options.defer
                && let Some(end) = e.states.get(index + 1)
            {
                if let Err(blame) = problem.validity().check(m, end, &instance.contacts) {
                    blocked = Some((index, blame));
                    break;
                }
                reached.push(Reached { state: end.clone(), instance, t: 1.0, primitive });
                continue;
            }
            let mut free = prefixes.of(index);
            if free.blame.is_some()
                && let Some(r) = local_repair.filter(|r| r.is_free_to_turn(problem.domain(), &instance))
                && prefixes.is_worth_a_repair(r, index)
                && let Ok(around) = r.repair(m, problem.validity(), 0, &instance, start, rng)
            {
                instance = Arc::new(around);
                free = problem.validity().free_prefix(m, &instance, start);
            }
            let length_m = instance.motion.length();
            if free.fraction * length_m > left_m {
                // What blocks it farther on is out of the reach of this extension.
                discretise(m, &instance, primitive, left_m / length_m, options.spacing_m, start, &mut reached);
                cut = Some(index + 1);
                break;
            }
            left_m -= length_m;
            discretise(m, &instance, primitive, free.fraction, options.spacing_m, start, &mut reached);
            let is_short = free.fraction.is_nan() || free.fraction < 1.0;
            if let Some(blame) = free.blame.or_else(|| is_short.then(unexplained)) {
                blocked = Some((index, blame));
                break;
            }
        }
        let end = match (&blocked, cut) {
            (Some((index, blame)), _) => Some((*index, Bucket::from(blame.kind), Bucket::Behind)),
            (None, Some(index)) => Some((index, Bucket::Budget, Bucket::Budget)),
            (None, None) => None,
        };
        let buckets = buckets(&e, end);
        let is_met = end.is_none() && e.end == PathEnd::Met;
        let blame = blocked.map(|(_, blame)| blame).or_else(|| last_block(&e));
        Extension { reached, is_met, blame, buckets }
    }
}

/// What the primitives last found in the way, if the path ended for want of one that could go on.
fn last_block<D: Domain>(e: &Path<D>) -> Option<Blame> {
    e.trials.iter().rev().find_map(|(_, trial)| match trial {
        Trial::Infeasible(Infeasible::Blocked(blame)) => Some(blame.clone()),
        _ => None,
    })
}

/// How much of a motion that cannot turn aside must be free for the way to it to be worth looking for.
const WORTH_REACHING: f64 = 0.25;

/// How far each instance of a path is free; asked once.
struct Prefixes<'a, D: Domain> {
    problem: &'a Problem<D>,
    e: &'a Path<D>,
    known: Vec<Option<FreePrefix>>,
}

impl<D: Domain> Prefixes<'_, D> {
    fn of(&mut self, index: usize) -> FreePrefix {
        let (Some((_, instance)), Some(start)) = (self.e.instances.get(index), self.e.states.get(index)) else {
            return FreePrefix::FREE;
        };
        if let Some(Some(known)) = self.known.get(index) {
            return known.clone();
        }
        let free = self.problem.validity().free_prefix(self.problem.domain(), instance, start);
        if let Some(slot) = self.known.get_mut(index) {
            *slot = Some(free.clone());
        }
        free
    }

    /// Does the chain from `index` on move an object, and is what it is bound to pass valid: the end of every instance
    /// that may turn aside, and the beginning of every one that may not? If not, a way around leads nowhere that matters,
    /// and it is expensive to find.
    fn is_worth_a_repair(&mut self, local_repair: &dyn LocalRepair<D>, index: usize) -> bool {
        let m = self.problem.domain();
        let rest = self.e.instances.iter().zip(self.e.states.iter().skip(1)).enumerate().skip(index);
        let moves_object = |instance: &Instance<D>| !instance.moves.is_subset_of(ComponentSet::ROBOT);
        let is_bound = |instance: &Instance<D>| !local_repair.is_free_to_turn(m, instance);
        rest.clone().any(|(_, ((_, instance), _))| moves_object(instance))
            && rest
                .clone()
                .filter(|(_, ((_, instance), _))| !is_bound(instance))
                .all(|(_, ((_, instance), end))| self.problem.validity().check(m, end, &instance.contacts).is_ok())
            && rest
                .filter(|(_, ((_, instance), _))| is_bound(instance))
                .all(|(i, _)| self.of(i).fraction >= WORTH_REACHING)
    }
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
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "in [1, MAX_STEPS]")]
    reached.reserve(steps as usize);
    let mut i = 1.0;
    while i <= steps {
        let t = if i >= steps { fraction } else { fraction * i / steps };
        reached.push(Reached { state: instance.at(m, t, start), instance: Arc::clone(instance), t, primitive });
        i += 1.0;
    }
}

/// The one bucket of every primitive: the furthest it got in this extension. `end` is the instance at which the extension
/// ended before its path did, the bucket of the primitive that it is from, and that of the primitives behind it.
fn buckets<D: Domain>(e: &Path<D>, end: Option<(usize, Bucket, Bucket)>) -> SmallVec<[Bucket; 8]> {
    let mut buckets: SmallVec<[Bucket; 8]> =
        e.useful.iter().map(|useful| if *useful { Bucket::NotChosen } else { Bucket::NotUseful }).collect();
    for (primitive, trial) in &e.trials {
        let bucket = match trial {
            Trial::Infeasible(why) => Bucket::from(why),
            Trial::NoProgress => Bucket::NoProgress,
            Trial::Propagated { first, last } => match end {
                Some((at, _, behind)) if at < *first => behind,
                Some((at, bucket, _)) if at < *last => bucket,
                _ => Bucket::Accepted,
            },
        };
        if let Some(slot) = buckets.get_mut(usize::from(*primitive)) {
            *slot = (*slot).max(bucket);
        }
    }
    if e.end == PathEnd::Depth
        && end.is_none()
        && let Some((primitive, _)) = e.trials.last()
        && let Some(slot) = buckets.get_mut(usize::from(*primitive))
    {
        *slot = Bucket::Depth;
    }
    buckets
}
