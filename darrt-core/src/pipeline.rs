//! From a plan that the search has found to a solution: the stages that it goes through, one after the other.
//!
//! | stage | what it does | file |
//! |---|---|---|
//! | retrace | the same manipulations without what does not lead to the goal | [`shorten`](crate::shorten) |
//! | further trees | other plans to the goal, beside the one that was found | `search/further` |
//! | improve | less time to carry it out, all motions judged | [`mod@improve`](crate::improve) |
//! | mend | motions that were taken as free are judged; from one that is blocked the plan goes on another way | [`shorten`](crate::shorten) |
//! | lazy validation | what was found is judged as it is | [`validate_steps`](crate::lazy_validation::validate_steps) |
//! | prove | the verifier replays it | [`verify`](crate::verify) |
//!
//! The first stage that ends in a plan which the verifier accepts is the last one.

use rand::Rng;

use crate::budget::{Interrupt, Stop};
use crate::domain::Domain;
use crate::extend::Extender;
use crate::improve::{Improvement, improve};
use crate::lazy_validation::{NotValidated, validate_steps};
use crate::plan::Plan;
use crate::random::{Purpose, stream};
use crate::search::{Strategy, further_plans};
use crate::shorten::{mended, retraced};
use crate::verify::{Refusal, Solution};

/// Why a found plan is no solution.
pub(crate) enum Unproved<D: Domain> {
    /// The verifier refuses it.
    Refused(Refusal),
    /// A motion of it is blocked, or it was given up.
    NotValidated(NotValidated<D>),
}

/// The stages, for plans that one iteration finds.
pub(crate) struct Pipeline<'a, D: Domain> {
    pub(crate) extender: Extender<'a, D>,
    pub(crate) strategy: &'a Strategy<D>,
    pub(crate) interrupt: Interrupt<'a>,
    /// Is it a part of a plan only? What comes behind a part is not known, so parts are not improved.
    pub(crate) is_part: bool,
    /// Seed, attempt and iteration: random choices are keyed by them.
    pub(crate) key: (u64, u64, u64),
}

impl<D: Domain> Pipeline<'_, D> {
    /// The best that can be made of `found`.
    pub(crate) fn run(&self, found: &Plan<D>) -> Result<Solution<D>, Unproved<D>> {
        let (seed, attempt, iteration) = self.key;
        let rng = &mut stream(seed, attempt, iteration, Purpose::Shorten);
        let options = self.strategy.shorten;
        let short = retraced(&self.extender, found, options, rng);
        let further = self.further(found, rng);
        let known: Vec<_> = short.iter().chain([found]).chain(&further).collect();
        if let Some(better) = self.improved(&known) {
            return Ok(better);
        }
        let short = if self.extender.options.defer {
            // What is mended is free, and can be improved although what was found could not.
            let mended = mended(&self.extender, found, short.as_ref(), options, rng);
            if let Some(better) = mended.as_ref().and_then(|mended| self.improved(&[mended])) {
                return Ok(better);
            }
            mended
        } else {
            short
        };
        // A shorter plan that the verifier refuses is no reason to give up the longer one.
        if let Some(solution) = short.and_then(|short| self.proved(short).ok()) {
            return Ok(solution);
        }
        let steps = validate_steps(&self.extender, found.start(), found.steps().iter().cloned(), rng);
        let steps = steps.map_err(Unproved::NotValidated)?;
        self.proved(Plan::new(found.start().clone(), steps)).map_err(Unproved::Refused)
    }

    /// Plans of further trees, of which the shortest is made shorter still; none where nothing is improved.
    fn further(&self, found: &Plan<D>, rng: &mut dyn Rng) -> Vec<Plan<D>> {
        let Some(improvement) = self.improvement() else { return Vec::new() };
        let effort = improvement.options.further(self.key.2);
        let Extender { problem, interrupt, .. } = self.extender;
        let mut plans = further_plans(problem, self.strategy, self.key, effort, interrupt);
        plans.sort_by_key(|plan| plan.steps().len());
        // What is longer than the plan that was found would hardly become shorter than what that plan became.
        let short = plans.iter_mut().take_while(|plan| plan.steps().len() < found.steps().len());
        for plan in short.take(improvement.options.further_retraced) {
            if let Some(shorter) = retraced(&self.extender, plan, self.strategy.shorten, rng) {
                *plan = shorter;
            }
        }
        plans
    }

    /// How plans are improved, if that is wanted and there is time.
    fn improvement(&self) -> Option<&Improvement<D>> {
        self.strategy.improve.as_ref().filter(|_| !self.is_part && self.interrupt.stop().is_none())
    }

    /// A plan better than those that are known that the verifier accepts, if that is wanted and there is time.
    fn improved(&self, known: &[&Plan<D>]) -> Option<Solution<D>> {
        let improvement = self.improvement()?;
        let (seed, attempt, iteration) = self.key;
        let rng = &mut stream(seed, attempt, iteration, Purpose::Improve);
        let better = improve(&self.extender, improvement, known, iteration, rng)?;
        let first = (*known.first()?).clone();
        self.proved(better).ok().map(|solution| solution.improved_from(first))
    }

    /// The plan, if the verifier accepts it.
    pub(crate) fn proved(&self, plan: Plan<D>) -> Result<Solution<D>, Refusal> {
        if self.interrupt.stop() == Some(Stop::Cancelled) {
            return Err(Refusal { step: None, at: 0.0, reason: "cancelled".to_owned() });
        }
        let p = self.extender.problem;
        Solution::prove(p.domain(), p.start(), p.goal(), p.verifier(), plan)
    }
}
