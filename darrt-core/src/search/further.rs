//! Further plans for a problem that has been solved: of trees that know nothing of each other, each as far as the goal.
//!
//! One tree wanders, and its plan can be made shorter only near to where it went. To reach the goal once more takes a small
//! part of the time that a plan is improved for, so other trees are asked too, and the improvement begins with the plans of
//! all of them.

use rand::Rng;

use crate::budget::Interrupt;
use crate::domain::Domain;
use crate::plan::Plan;
use crate::problem::Problem;
use crate::random::{Purpose, stream};
use crate::tree::{Edge, Tree};

use super::{Darrt, Strategy};

/// How much is done for further plans.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Effort {
    /// How many trees grow at most.
    pub(crate) trees: usize,
    /// How many iterations they have in all.
    pub(crate) iterations: u64,
}

/// The plans of further trees, as they are found: neither shortened nor verified, and what the search takes as free is not
/// judged. Random choices are keyed by `(seed, attempt, iteration)`.
pub(crate) fn further_plans<D: Domain>(
    problem: &Problem<D>,
    strategy: &Strategy<D>,
    (seed, attempt, iteration): (u64, u64, u64),
    effort: Effort,
    interrupt: Interrupt<'_>,
) -> Vec<Plan<D>> {
    let seeds = &mut stream(seed, attempt, iteration, Purpose::Further);
    let mut left = effort.iterations;
    let mut plans = Vec::new();
    for _ in 0..effort.trees {
        if left == 0 || interrupt.stop().is_some() {
            break;
        }
        let tree = Darrt::new(problem, strategy, seeds.next_u64(), attempt, Tree::<D>::MAX_NODES);
        plans.extend(tree.interrupted_by(interrupt).first_plan(&mut left));
    }
    plans
}

impl<D: Domain> Darrt<'_, D> {
    /// Iterates until a state meets the goal, and takes the iterations off those that are left.
    fn first_plan(mut self, left: &mut u64) -> Option<Plan<D>> {
        while *left > 0 && self.interrupt.stop().is_none() {
            *left -= 1;
            let s = self.draw();
            let t = self.nearest(&s);
            let mut parent = t;
            for reached in self.extend(t, &s).reached {
                let is_goal = self.problem.goal().is_satisfied(self.problem.domain(), &reached.state);
                let edge = Edge { parent, instance: reached.instance, t: reached.t, primitive: reached.primitive };
                parent = self.tree.add(self.problem.domain(), reached.state, edge)?;
                if is_goal {
                    return Plan::to_node(&self.tree, parent);
                }
            }
        }
        None
    }
}
