//! How a tree grows, iteration by iteration, for whoever wants to keep it.

use crate::domain::Domain;
use crate::tree::Tree;
use crate::validity::Blame;

/// What one iteration did to a tree.
///
/// Nodes are told apart by their [births](Tree::births): a number that a node keeps, also when others are taken back. What is new
/// has a number that was not there before, and what is gone is no longer among them.
#[derive(Debug)]
pub struct Growth<'a, D: Domain> {
    /// The tree behind the iteration.
    pub tree: &'a Tree<D>,
    /// The number of the node that was extended; `None` before the first iteration, and if it was a node of another tree.
    pub extended: Option<u32>,
}

/// Is told how trees grow.
///
/// # Example
/// ```
/// use darrt_core::domain::Domain;
/// use darrt_core::record::{Growth, Recorder};
/// use darrt_core::validity::Blame;
///
/// /// How often each node was extended without anything in the way.
/// #[derive(Default)]
/// struct Extended(std::collections::BTreeMap<u32, usize>);
///
/// impl<D: Domain> Recorder<D> for Extended {
///     fn on_growth(&mut self, _attempt: u64, _iteration: u64, growth: &Growth<'_, D>, blame: Option<&Blame>) {
///         if let (Some(node), None) = (growth.extended, blame) {
///             *self.0.entry(node).or_default() += 1;
///         }
///     }
/// }
/// ```
/// [`solve_recorded`](crate::solve::solve_recorded) takes it.
pub trait Recorder<D: Domain>: Send {
    /// Called for each attempt before its first iteration, and after each. From the thread on which it happens, one call at a
    /// time; calls for concurrent attempts interleave. `blame` is what blocked the extension.
    fn on_growth(&mut self, attempt: u64, iteration: u64, growth: &Growth<'_, D>, blame: Option<&Blame>);
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::budget::Budget;
    use crate::observe::Silent;
    use crate::search::Algorithm;
    use crate::solve::{Member, SolveOptions, Until, solve_recorded, solve_with};
    use crate::testing::puck::problems::four_pucks;
    use crate::testing::puck::setup::paper_strategy;

    /// By attempt: the numbers that are there, and how many there ever were.
    #[derive(Default)]
    struct Living(BTreeMap<u64, (Vec<u32>, u32, usize)>);

    impl<D: Domain> Recorder<D> for Living {
        fn on_growth(&mut self, attempt: u64, iteration: u64, growth: &Growth<'_, D>, _: Option<&Blame>) {
            let (alive, next, gone) = self.0.entry(attempt).or_default();
            let now = growth.tree.births();
            assert_eq!(now.len(), growth.tree.len());
            assert!(now.windows(2).all(|pair| pair[0] < pair[1]), "{now:?}");
            *gone += alive.iter().filter(|birth| !now.contains(birth)).count();
            assert!(now.iter().all(|birth| birth >= next || alive.contains(birth)), "nothing comes back");
            if iteration > 0 {
                assert!(growth.extended.is_some_and(|birth| alive.contains(&birth)));
            }
            (*alive, *next) = (now.to_vec(), now.last().map_or(0, |last| last + 1).max(*next));
        }
    }

    #[test]
    fn nodes_keep_their_numbers_and_the_outcome_is_that_of_a_search_that_is_not_recorded() {
        let problem = four_pucks().unwrap();
        let mut strategy = paper_strategy().unwrap();
        strategy.extend.defer = true;
        let members = [Member { algorithm: Algorithm::Darrt, strategy: &strategy }];
        let (mut recorded, mut gone) = (0, 0);
        for seed in 0..6 {
            let budget = Budget { iterations: Some(900), ..Budget::default() };
            let options = SolveOptions { seed, budget, restart_iterations: Some(300), threads: 2 };
            let mut living = Living::default();
            let told = solve_recorded(&problem, &members, Until::Solved, &options, &mut Silent, Some(&mut living));
            let plain = solve_with(&problem, &members, Until::Solved, &options, &mut Silent);
            assert_eq!((told.stop, told.iterations, told.nodes), (plain.stop, plain.iterations, plain.nodes));
            assert_eq!(told.nearest, plain.nearest);
            recorded += living.0.values().map(|(alive, ..)| alive.len()).sum::<usize>();
            gone += living.0.values().map(|(.., gone)| gone).sum::<usize>();
        }
        assert!(recorded > 100 && gone > 0, "{recorded} nodes, {gone} taken back");
    }
}
