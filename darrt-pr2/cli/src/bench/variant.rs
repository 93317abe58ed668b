//! The planner and its ablations by name.

use std::fmt;

use darrt_core::search::Algorithm;
use darrt_task::planning::PlanRequest;
use darrt_task::planning::variants::StrategyChange;
use darrt_task::problem_file::suggest::nearest;
use darrt_task::problem_file::{DistanceName, SamplerName};

use super::error::BenchError;

/// Metres between two nodes of the tree in `fine-steps`.
const FINE_STEP: f64 = 0.1;

/// Metres after which an extension of `bounded-step` ends.
const SHORT_EXTENSION: f64 = 2.0;

/// A named change of a planning request.
#[derive(Clone, Copy)]
pub struct Variant {
    /// Its name, for the command line and the records.
    pub name: &'static str,
    /// What it changes, for people.
    pub about: &'static str,
    change: fn(&mut PlanRequest),
}

/// All variants; the first is the planner as it is. A new variant is one line here.
pub const VARIANTS: [Variant; 31] = [
    variant("default", "as the problem says", |_| {}),
    variant("robot-or-objects", "samples name the robot or the objects", |r| {
        r.sampler = Some(SamplerName::ROBOT_OR_OBJECTS);
    }),
    variant("random-subset", "samples name a random subset of all that moves", |r| {
        r.sampler = Some(SamplerName::RANDOM_SUBSET);
    }),
    variant("full", "samples name all that moves", |r| r.sampler = Some(SamplerName::FULL)),
    variant("no-goal-bias", "no sample is drawn from the goal", |r| r.problem.sampling.goal_bias = 0.0),
    variant("half-objects", "half of the samples name the objects", |r| r.problem.sampling.object_share = 0.5),
    variant("greedy", "distance: the robot visits the objects, nearest first", |r| {
        r.distance = Some(DistanceName::GREEDY);
    }),
    variant("euclidean", "distance: the sum of all ways", |r| r.distance = Some(DistanceName::EUCLIDEAN)),
    variant("exact-tour", "distance: the best order of visits", |r| r.distance = Some(DistanceName::EXACT_TOUR)),
    variant("no-local-repair", "blocked motions are cut short, no way around is looked for", |r| {
        r.changes.push(StrategyChange::NoLocalRepair);
    }),
    variant("eager", "every motion is judged as soon as it is propagated", |r| {
        r.changes.push(StrategyChange::Eager);
    }),
    variant("no-penalty", "plain arg min: nodes do not count as farther once tried", |r| {
        r.changes.push(StrategyChange::NoPenalty);
    }),
    variant("no-shortening", "the first plan is taken as it is", |r| {
        r.changes.push(StrategyChange::NoShortening);
    }),
    variant("fine-steps", "every motion judged at once, and a node every 0.1 m of travel", |r| {
        r.changes.push(StrategyChange::NodeEvery(FINE_STEP));
    }),
    variant("bounded-step", "an extension ends after 2 m of travel", |r| {
        r.changes.push(StrategyChange::StepAtMost(SHORT_EXTENSION));
    }),
    variant("no-edge-samples", "no object is sampled near the edge of a surface on purpose", |r| {
        r.problem.sampling.edge_share = 0.0;
    }),
    variant("support-samples", "seven in ten samples of objects stand on a surface", |r| {
        r.changes.push(StrategyChange::OnSupport);
    }),
    variant("frontier", "three in ten samples lie where extensions were blocked", |r| {
        r.changes.push(StrategyChange::Frontier);
    }),
    variant("reachability", "where the robot stands is drawn from its inverse reachability model", |r| {
        r.bases_from_reachability = true;
    }),
    variant("weighted", "distance: the robot's way counts three tenths", |r| {
        r.changes.push(StrategyChange::RobotWeight(0.3));
    }),
    variant("maximum", "distance: the longest way of all", |r| {
        r.changes.push(StrategyChange::LongestWay);
    }),
    variant("approach", "distance: greedy, but the first way leads to the contact or grasp", |r| {
        r.changes.push(StrategyChange::Approach);
    }),
    variant("connect", "DARRTConnect: a second tree from the goal", |r| {
        r.algorithms = vec![Algorithm::Connect];
    }),
    variant("hierarchical", "DARRTH: the objects first, then the whole from subgoal to subgoal", |r| {
        r.algorithms = vec![Algorithm::Hierarchical];
    }),
    variant("hierarchical-connect", "DARRTHConnect: the same, with a second tree from every subgoal", |r| {
        r.algorithms = vec![Algorithm::HierarchicalConnect];
    }),
    variant("portfolio", "the attempts take all searches in turn, 300 iterations each", |r| {
        r.algorithms = Algorithm::ALL.to_vec();
        r.restart = Some(300);
    }),
    variant("one-tree", "plans are improved without those of further trees beside them", |r| {
        r.changes.push(StrategyChange::OneTree);
    }),
    variant("no-improve", "plans stay as they are found", |r| r.as_found = true),
    variant("no-restarts", "one tree until the end", |r| r.problem.budget.restart_iterations = None),
    variant("restart-300", "a new tree every 300 iterations", |r| r.restart = Some(300)),
    variant("paper", "Algorithm 1 as printed: straight lines, plain arg min, fine steps, no shortening", |r| {
        r.sampler = Some(SamplerName::ROBOT_OR_OBJECTS);
        r.distance = Some(DistanceName::GREEDY);
        r.problem.sampling.edge_share = 0.0;
        r.as_found = true;
        r.changes = vec![
            StrategyChange::NoLocalRepair,
            StrategyChange::NoPenalty,
            StrategyChange::NodeEvery(FINE_STEP),
            StrategyChange::NoShortening,
        ];
    }),
];

const fn variant(name: &'static str, about: &'static str, change: fn(&mut PlanRequest)) -> Variant {
    Variant { name, about, change }
}

impl Variant {
    /// The variant of this name.
    ///
    /// # Errors
    /// [`BenchError::UnknownVariant`] with all names and the nearest one.
    pub fn named(name: &str) -> Result<Self, BenchError> {
        let names = VARIANTS.map(|variant| variant.name);
        VARIANTS.into_iter().find(|variant| variant.name == name).ok_or_else(|| BenchError::UnknownVariant {
            name: name.to_owned(),
            nearest: nearest(name, names).map(str::to_owned),
            available: names.to_vec(),
        })
    }

    /// Makes the change.
    pub fn apply(&self, request: &mut PlanRequest) {
        (self.change)(request);
    }
}

impl fmt::Debug for Variant {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Variant").field(&self.name).finish()
    }
}

impl PartialEq for Variant {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use darrt_pr2::problems::builtin;

    #[test]
    fn names_differ_and_find_their_variant() {
        for (index, variant) in VARIANTS.iter().enumerate() {
            assert!(VARIANTS[..index].iter().all(|other| other.name != variant.name), "{}", variant.name);
            assert_eq!(Variant::named(variant.name).unwrap(), *variant);
        }
        let message = Variant::named("exact-tuor").unwrap_err().to_string();
        assert!(message.contains("did you mean `exact-tour`?") && message.contains("no-local-repair"), "{message}");
    }

    #[test]
    fn changes_reach_the_request() {
        let mut request = PlanRequest::new(builtin("plate3").unwrap(), 0);
        Variant::named("full").unwrap().apply(&mut request);
        Variant::named("no-goal-bias").unwrap().apply(&mut request);
        assert_eq!((&request.sampler, request.problem.sampling.goal_bias), (&Some(SamplerName::FULL), 0.0));
        Variant::named("paper").unwrap().apply(&mut request);
        let mut strategy = darrt_task::planning::strategy(&darrt_pr2::registry(), &request).unwrap();
        assert!(strategy.local_repair.is_some() && strategy.try_penalty_m > 0.0);
        request.changes.iter().for_each(|change| change.apply(&mut strategy));
        assert!(strategy.local_repair.is_none() && strategy.try_penalty_m == 0.0 && strategy.shorten.extensions == 0);
    }
}
