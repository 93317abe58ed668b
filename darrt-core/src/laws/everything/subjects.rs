//! What is checked, what it claims, and how hard it is looked at.

use std::path::PathBuf;
use std::sync::Arc;

use crate::distance::Distance;
use crate::domain::Domain;
use crate::goal::Goal;
use crate::laws::SpaceClaims;
use crate::laws::validity::ValidityClaims;
use crate::partial::PartialState;
use crate::primitive::Primitive;
use crate::problem::Problem;
use crate::sample::Sampler;
use crate::search::Strategy;
use crate::state::State;
use crate::validity::Validity;
use crate::verify::Verifier;

/// The user's own slow oracle: is a state free, if nothing may touch?
pub type Oracle<D> = Arc<dyn Fn(&D, &State<D>) -> bool + Send + Sync>;
/// Is the way from the first state to the second, for the sake of the target, progress of another kind?
pub type Excuse<D> = Arc<dyn Fn(&D, &State<D>, &PartialState<D>, &State<D>) -> bool + Send + Sync>;
/// Metres that the farthest point of any body travels between two states.
pub type Travel<D> = Arc<dyn Fn(&D, &State<D>, &State<D>) -> f64 + Send + Sync>;

/// How hard is looked.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Effort {
    /// Cases for each subject.
    pub cases: u64,
    /// Calls of each primitive that only look whether it comes back: for panics that are rare.
    pub calls: u64,
    /// Iterations of the planner; 0: it is not run.
    pub iterations: u64,
    /// So many milliseconds lie at least between the first and the last time that the same is asked.
    pub apart_ms: u64,
    /// What the inputs are drawn with.
    pub seed: u64,
    /// Only this subject, and of it only this case, if one is given.
    pub only: Option<(String, Option<u64>)>,
    /// A file with the cases that once failed, which come first; new ones are added to it.
    pub regressions: Option<PathBuf>,
}

impl Default for Effort {
    fn default() -> Self {
        Self { cases: 384, calls: 16384, iterations: 60, apart_ms: 1100, seed: 0, only: None, regressions: None }
    }
}

/// All that somebody brought. Everything but the start is optional: what is not there is not checked.
pub struct Subjects<D: Domain> {
    pub(super) start: State<D>,
    pub(super) goal: Option<Arc<dyn Goal<D>>>,
    /// A state that satisfies the goal.
    pub(super) in_goal: Option<State<D>>,
    pub(super) primitives: Arc<[Box<dyn Primitive<D>>]>,
    pub(super) validity: Option<Arc<dyn Validity<D>>>,
    pub(super) oracle: Option<Oracle<D>>,
    pub(super) verifier: Option<Arc<dyn Verifier<D>>>,
    pub(super) distances: Vec<Arc<dyn Distance<D>>>,
    pub(super) samplers: Vec<Arc<dyn Sampler<D>>>,
    pub(super) strategy: Option<Arc<Strategy<D>>>,
    pub(super) excuse: Option<Excuse<D>>,
    pub(super) travel: Option<Travel<D>>,
    /// What the spaces claim.
    pub(super) spaces: SpaceClaims,
    /// Do the spaces sample all of what they contain?
    pub(super) fills: bool,
    pub(super) validity_claims: ValidityClaims,
    pub(super) max_instances: usize,
    pub(super) effort: Effort,
}

impl<D: Domain> std::fmt::Debug for Subjects<D> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let names: Vec<_> = self.primitives.iter().map(|p| p.name()).collect();
        let subjects = &mut f.debug_struct("Subjects");
        subjects.field("start", &self.start).field("primitives", &names).field("effort", &self.effort);
        subjects.finish_non_exhaustive()
    }
}

impl<D: Domain> Subjects<D> {
    /// The domain alone, seen from a state of it: one that the validity accepts.
    pub fn new(start: State<D>) -> Self {
        Self {
            start,
            goal: None,
            in_goal: None,
            primitives: Arc::from(Vec::new()),
            validity: None,
            oracle: None,
            verifier: None,
            distances: Vec::new(),
            samplers: Vec::new(),
            strategy: None,
            excuse: None,
            travel: None,
            spaces: SpaceClaims::default(),
            fills: true,
            validity_claims: ValidityClaims::default(),
            max_instances: 64,
            effort: Effort::default(),
        }
    }

    /// All parts of a problem; its domain is [`Problem::shared_domain`].
    pub fn of(problem: &Problem<D>) -> Self {
        let (goal, primitives, validity, verifier) = problem.shared_parts();
        let (goal, validity, verifier) = (Some(goal), Some(validity), Some(verifier));
        Self { goal, primitives, validity, verifier, ..Self::new(problem.start().clone()) }
    }

    /// With this goal.
    #[must_use]
    pub fn goal(self, goal: impl Goal<D> + 'static) -> Self {
        Self { goal: Some(Arc::new(goal)), ..self }
    }

    /// With a state that satisfies the goal, for a goal in a mode that is hard to come to.
    #[must_use]
    pub fn in_goal(self, state: State<D>) -> Self {
        Self { in_goal: Some(state), ..self }
    }

    /// With these primitives.
    #[must_use]
    pub fn primitives(self, primitives: Vec<Box<dyn Primitive<D>>>) -> Self {
        Self { primitives: primitives.into(), ..self }
    }

    /// With this validity.
    #[must_use]
    pub fn validity(self, validity: impl Validity<D> + 'static) -> Self {
        Self { validity: Some(Arc::new(validity)), ..self }
    }

    /// With an oracle that the validity is held to: a function that says of a state whether it is free, however slowly.
    #[must_use]
    pub fn oracle(self, free: impl Fn(&D, &State<D>) -> bool + Send + Sync + 'static) -> Self {
        Self { oracle: Some(Arc::new(free)), ..self }
    }

    /// With this verifier.
    #[must_use]
    pub fn verifier(self, verifier: impl Verifier<D> + 'static) -> Self {
        Self { verifier: Some(Arc::new(verifier)), ..self }
    }

    /// With one more distance.
    #[must_use]
    pub fn distance(mut self, distance: impl Distance<D> + 'static) -> Self {
        self.distances.push(Arc::new(distance));
        self
    }

    /// With one more sampler.
    #[must_use]
    pub fn sampler(mut self, sampler: impl Sampler<D> + 'static) -> Self {
        self.samplers.push(Arc::new(sampler));
        self
    }

    /// With this strategy: its sampler and its distance are checked as well, and the planner is run with it.
    #[must_use]
    pub fn strategy(self, strategy: Strategy<D>) -> Self {
        Self { strategy: Some(Arc::new(strategy)), ..self }
    }

    /// What the spaces of the domain claim.
    #[must_use]
    pub fn spaces(self, claims: SpaceClaims) -> Self {
        Self { spaces: claims, ..self }
    }

    /// The spaces sample only some of what they contain, on purpose: places on tables, say.
    #[must_use]
    pub fn samples_in_part(self) -> Self {
        Self { fills: false, ..self }
    }

    /// How exactly the validity answers.
    #[must_use]
    pub fn validity_claims(self, claims: ValidityClaims) -> Self {
        Self { validity_claims: claims, ..self }
    }

    /// Ends of propagations that are progress though nothing is nearer to its target.
    #[must_use]
    pub fn excuse(
        self,
        excuse: impl Fn(&D, &State<D>, &PartialState<D>, &State<D>) -> bool + Send + Sync + 'static,
    ) -> Self {
        Self { excuse: Some(Arc::new(excuse)), ..self }
    }

    /// How travel is measured, for a domain that knows its bodies.
    #[must_use]
    pub fn travel(self, travel: impl Fn(&D, &State<D>, &State<D>) -> f64 + Send + Sync + 'static) -> Self {
        Self { travel: Some(Arc::new(travel)), ..self }
    }

    /// So many cases for each subject.
    #[must_use]
    pub fn cases(mut self, cases: u64) -> Self {
        self.effort.cases = cases;
        self
    }

    /// How hard is looked, in all detail.
    #[must_use]
    pub fn effort(self, effort: Effort) -> Self {
        Self { effort, ..self }
    }

    /// Inputs are drawn with this seed.
    #[must_use]
    pub fn seed(mut self, seed: u64) -> Self {
        self.effort.seed = seed;
        self
    }

    /// Only this row of the table, and of it only this case: what a report says to see a broken law again.
    #[must_use]
    pub fn only(mut self, row: &str, case: impl Into<Option<u64>>) -> Self {
        self.effort.only = Some((row.to_owned(), case.into()));
        self
    }

    /// Cases that fail are kept in this file (relative to the crate under test), and come first from then on.
    #[must_use]
    pub fn regressions(mut self, file: impl Into<PathBuf>) -> Self {
        self.effort.regressions = Some(file.into());
        self
    }
}
