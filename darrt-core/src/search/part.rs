//! What is left of attempts that found no plan: the way to the best states that they reached.

use std::cmp::Ordering;
use std::sync::Arc;

use rand::Rng;

use super::{Darrt, Strategy};
use crate::budget::Interrupt;
use crate::domain::Domain;
use crate::extend::Extender;
use crate::goal::Goal;
use crate::lazy_validation::validate_step;
use crate::partial::PartialState;
use crate::pipeline::Pipeline;
use crate::plan::Plan;
use crate::problem::Problem;
use crate::random::{Purpose, stream};
use crate::state::{ObjectId, State};
use crate::tree::NodeId;

/// States of one attempt that are kept, and of all attempts that are tried.
const KEPT: usize = 4;

/// The way to a state, its motions not judged yet, and how good the state is.
#[derive(Debug)]
pub struct Part<D: Domain> {
    plan: Plan<D>,
    rank: Rank,
}

/// How near a state is to the goal.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Rank {
    /// See [`Goal::parts_met`](crate::goal::Goal::parts_met).
    parts_met: usize,
    /// By the planner's distance, metres.
    distance_m: f64,
}

impl Rank {
    /// The better one first.
    fn compare(&self, other: &Self) -> Ordering {
        other.parts_met.cmp(&self.parts_met).then(self.distance_m.total_cmp(&other.distance_m))
    }
}

/// Every state in which the objects stand as in a known one, and that meets as many parts of the goal.
struct AsGood<D: Domain> {
    target: PartialState<D>,
    goal: Arc<dyn Goal<D>>,
    parts_met: usize,
}

impl<D: Domain> Goal<D> for AsGood<D> {
    fn is_satisfied(&self, m: &D, state: &State<D>) -> bool {
        self.target.is_met(m, state) && self.goal.parts_met(m, state) >= self.parts_met
    }

    fn sample(&self, _: &D, _: &mut dyn Rng) -> Option<PartialState<D>> {
        Some(self.target.clone())
    }
}

impl<D: Domain> Darrt<'_, D> {
    /// The ways to the best states in which objects stand elsewhere than at the start, the best first; of states in which
    /// the objects stand alike the best one.
    pub(super) fn parts(&self) -> Vec<Part<D>> {
        let (m, start) = (self.problem.domain(), self.problem.start());
        let Some(goal_sample) = &self.goal_sample else { return Vec::new() };
        let mut best: Vec<(Rank, NodeId)> = Vec::new();
        for (id, node) in self.tree().iter().filter(|(_, node)| node.state.objects != start.objects) {
            let parts_met = self.problem.goal().parts_met(m, &node.state);
            let distance_m = self.strategy.distance.distance(m, &node.state, goal_sample);
            let rank = Rank { parts_met, distance_m };
            if best.len() == KEPT && best.last().is_some_and(|(last, _)| rank.compare(last).is_ge()) {
                continue;
            }
            let stands_alike = |other: &NodeId| {
                self.tree().node(*other).is_some_and(|other| other.state.objects == node.state.objects)
            };
            match best.iter_mut().find(|(_, other)| stands_alike(other)) {
                Some(known) if rank.compare(&known.0).is_lt() => *known = (rank, id),
                Some(_) => {}
                None => best.push((rank, id)),
            }
            // Of equals the first stays the first.
            best.sort_by(|a, b| a.0.compare(&b.0));
            best.truncate(KEPT);
        }
        let way = |(rank, id)| Some(Part { plan: Plan::to_node(self.tree(), id)?, rank });
        best.into_iter().filter_map(way).collect()
    }
}

/// The best of `parts`, those of lower attempts first, that can be carried out: made shorter, and all its motions judged. If none
/// of them can, the longest beginning of the best one that can. `None` if there is none.
pub(crate) fn best_of<D: Domain>(
    problem: &Problem<D>,
    strategy: &Strategy<D>,
    seed: u64,
    mut parts: Vec<Part<D>>,
) -> Option<Plan<D>> {
    parts.sort_by(|a, b| a.rank.compare(&b.rank));
    parts.truncate(KEPT);
    let whole = |part: &Part<D>| {
        let (target, goal, parts_met) = (reached(problem, &part.plan), problem.shared_goal(), part.rank.parts_met);
        let problem = problem.part(problem.start().clone(), Arc::new(AsGood { target, goal, parts_met }));
        let extender = extender(&problem, strategy);
        let pipeline = Pipeline { extender, strategy, interrupt: Interrupt::NEVER, is_part: true, key: (seed, 0, 0) };
        pipeline.run(&part.plan).ok().map(|solution| solution.into_parts().0)
    };
    parts.iter().find_map(whole).or_else(|| beginning(problem, strategy, seed, &parts.first()?.plan))
}

fn extender<'a, D: Domain>(problem: &'a Problem<D>, strategy: &'a Strategy<D>) -> Extender<'a, D> {
    let (options, local_repair) = (&strategy.extend, strategy.local_repair.as_deref());
    Extender { problem, options, local_repair, interrupt: Interrupt::NEVER }
}

/// Where a plan leaves the objects that it moves.
fn reached<D: Domain>(problem: &Problem<D>, plan: &Plan<D>) -> PartialState<D> {
    let m = problem.domain();
    let end = plan.end(m);
    let ids = (0..end.objects.len()).map(ObjectId::new);
    let moved = ids.filter(|id| end.object(*id) != plan.start().object(*id));
    let named = moved.filter_map(|id| Some((id, end.object(id)?.clone())));
    named.fold(PartialState::anywhere(m), |target, (id, at)| target.with_object(id, at))
}

/// The steps of a plan up to the first motion that is blocked.
fn beginning<D: Domain>(problem: &Problem<D>, strategy: &Strategy<D>, seed: u64, plan: &Plan<D>) -> Option<Plan<D>> {
    let (m, extender) = (problem.domain(), extender(problem, strategy));
    let rng = &mut stream(seed, 0, 0, Purpose::Shorten);
    let (mut here, mut steps) = (plan.start().clone(), Vec::new());
    for step in plan.steps() {
        let Ok((step, _)) = validate_step(&extender, &here, step.clone(), rng) else { break };
        here = step.instance.at(m, step.until, &here);
        steps.push(step);
    }
    (!steps.is_empty()).then(|| Plan::new(plan.start().clone(), steps))
}

#[cfg(test)]
mod tests {
    use crate::budget::{Budget, Stop};
    use crate::observe::Silent;
    use crate::solve::{SolveOptions, solve};
    use crate::testing::puck::problems::four_pucks;
    use crate::testing::puck::setup::paper_strategy;

    #[test]
    fn what_is_left_of_a_search_without_a_plan_is_free_and_moves_something() {
        let (problem, strategy) = (four_pucks().unwrap(), paper_strategy().unwrap());
        let m = problem.domain();
        let mut count = 0;
        for seed in 0..6 {
            let budget = Budget { iterations: Some(40), ..Budget::default() };
            let options = SolveOptions { seed, budget, ..SolveOptions::default() };
            let outcome = solve(&problem, &strategy, &options, &mut Silent);
            assert_eq!(outcome.solution.is_some(), outcome.stop == Stop::Solved);
            let Some(part) = outcome.part else { continue };
            assert!(outcome.solution.is_none());
            count += 1;
            let mut here = problem.start().clone();
            for step in part.steps() {
                let free = problem.validity().free_prefix(m, &step.instance, &here);
                assert!(free.fraction >= step.until, "{:?}", free.blame);
                here = step.instance.at(m, step.until, &here);
            }
            assert_ne!(here.objects, problem.start().objects);
            let again = solve(&problem, &strategy, &options, &mut Silent).part.unwrap();
            assert_eq!(again.end(m), here);
        }
        assert!(count > 0);
    }
}
