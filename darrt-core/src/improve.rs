//! A plan that takes less time to carry out than the one that was found.
//!
//! | stage | file |
//! |---|---|
//! | the plan becomes a graph of manipulations and of ways between them | `pieces`, `roadmap` |
//! | manipulations are drawn anew, nearer to those before and behind them, or leading farther | `draw` |
//! | one becomes two, where the cost says that the second makes up for what the first leaves uncertain | `stopover` |
//! | the cheapest chain is judged until every motion of it is free | `judge` |
//! | what has been seen so far, for what has not been judged | `experience` |
//! | shortcuts between any two of its states | [`smooth`](crate::smooth) |
//!
//! The effort is counted in extensions, and no clock is read: the same plan and the same random numbers give the same result.

mod draw;
mod experience;
mod judge;
pub(crate) mod pieces;
mod roadmap;
mod stopover;

use std::fmt;

use rand::Rng;

use crate::cost::ExecutionCost;
use crate::domain::Domain;
use crate::extend::{ExtendOptions, Extender};
use crate::plan::Plan;
use crate::search::Effort;
use crate::smooth::smooth;
use draw::Hope;
use roadmap::{Roadmap, START};

/// How many draws are made between two looks at what the cheapest chain costs.
const DRAWS_BETWEEN: usize = 32;

/// How much effort goes into a better plan: it goes with the work that finding it took.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ImproveOptions {
    /// How many further trees grow from the start, whose plans are put beside the one that was found.
    pub further_trees: usize,
    /// How many iterations they have in all, for every iteration of the search; at least 0,
    pub further_per_iteration: f64,
    /// and how many at least.
    pub least_further_iterations: u64,
    /// How many of their plans are made shorter like the one that was found: those with the fewest steps, if fewer than that has.
    pub further_retraced: usize,
    /// Extensions that draw manipulations anew, for every step of the plan that was found.
    pub draws_per_step: usize,
    /// More of them, for every iteration of the search; at least 0.
    pub draws_per_iteration: f64,
    /// How often what gives up [care](crate::validity::Validity::most_care) is drawn anew once the cheapest plan has been judged,
    pub care_rounds: usize,
    /// and with how many extensions each time.
    pub draws_per_round: usize,
    /// Extensions that look for shortcuts, for every step of the better plan.
    pub shortcuts_per_step: usize,
}

impl Default for ImproveOptions {
    fn default() -> Self {
        Self {
            further_trees: 6,
            further_per_iteration: 2.0,
            least_further_iterations: 128,
            further_retraced: 2,
            draws_per_step: 4,
            draws_per_iteration: 0.5,
            care_rounds: 3,
            draws_per_round: 24,
            shortcuts_per_step: 1,
        }
    }
}

/// So many for each of so many, rounded down.
fn share(each: f64, of: u64) -> u64 {
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "not negative, and saturates")]
    let share = (each * of as f64).max(0.0) as u64;
    share
}

impl ImproveOptions {
    fn draws(&self, steps: usize, iterations: u64) -> usize {
        let more = usize::try_from(share(self.draws_per_iteration, iterations)).unwrap_or(usize::MAX);
        self.draws_per_step.saturating_mul(steps).saturating_add(more)
    }

    /// What is done for further plans after a search of so many iterations.
    pub(crate) fn further(&self, iterations: u64) -> Effort {
        let shared = share(self.further_per_iteration, iterations);
        Effort { trees: self.further_trees, iterations: shared.max(self.least_further_iterations) }
    }
}

/// How plans are improved: in what cost, and with how much effort.
pub struct Improvement<D: Domain> {
    /// What carrying out costs.
    pub cost: Box<dyn ExecutionCost<D>>,
    /// The effort.
    pub options: ImproveOptions,
}

impl<D: Domain> fmt::Debug for Improvement<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Improvement").field("options", &self.options).finish_non_exhaustive()
    }
}

/// The cheapest plan to the goal that is found from `plans`, which begin at one state, end in the goal, and took so many
/// `iterations`; every motion of it is judged, also if those of `plans` are not. Not verified. `None` if no plan is found whose motions are all free, or if
/// nobody waits for one any more.
///
/// # Laws
/// Pure but for `rng` and the interrupt. If the motions of the first plan are free, the result costs at most as much.
pub fn improve<D: Domain>(
    extender: &Extender<'_, D>,
    improvement: &Improvement<D>,
    plans: &[&Plan<D>],
    iterations: u64,
    rng: &mut dyn Rng,
) -> Option<Plan<D>> {
    let start = plans.first()?.start();
    let Improvement { cost, options } = improvement;
    // Stops are drawn by whole extensions; what they lead to is judged once it is wanted.
    let whole = ExtendOptions { step_m: None, defer: true, ..*extender.options };
    let extender = Extender { options: &whole, ..*extender };
    let mut roadmap = Roadmap::new(extender, &**cost, start);
    for plan in plans {
        roadmap.add_chain(Some(START), start, plan.steps());
    }
    let steps = plans.iter().map(|plan| plan.steps().len()).min()?;
    for draw in 0..options.draws(steps, iterations) {
        if extender.interrupt.stop().is_some() {
            break;
        }
        if draw % DRAWS_BETWEEN == 0 {
            roadmap.suppose_cheapest(rng)?;
        }
        if !roadmap.draw(Hope::LessTime, rng) {
            break;
        }
    }
    let mut chain = roadmap.free_cheapest(rng)?;
    // How much care a chain keeps is known once it has been judged.
    for _ in 0..options.care_rounds {
        if extender.interrupt.stop().is_some() || roadmap.careless_s(&chain) <= 0.0 {
            break;
        }
        roadmap.tries.clear();
        for _ in 0..options.draws_per_round {
            if !roadmap.draw(Hope::MoreCare, rng) {
                break;
            }
        }
        chain = roadmap.free_cheapest(rng)?;
    }
    let plan = Plan::new(start.clone(), roadmap.steps(&chain)?);
    let shortcuts = options.shortcuts_per_step * plan.steps().len();
    Some(smooth(&extender, &**cost, &plan, shortcuts, rng).unwrap_or(plan))
}
