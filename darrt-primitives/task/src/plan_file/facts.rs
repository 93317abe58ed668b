//! How a plan was found, as its file says.

use darrt_core::search::Algorithm;
use darrt_core::solve::Cost;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::problem_file::{DistanceName, SamplerName};

/// How a plan was found: what is the same every time, and no times.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlannerFacts {
    /// Which components a sample specified.
    pub sampler: SamplerName,
    /// Which distance picked the tree node.
    pub distance: DistanceName,
    /// The searches that the attempts took in turn. Missing in files of older programs, which do not say.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub searches: Vec<SearchName>,
    /// In what the plan is the best of all that were found; missing if it is the first one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub improve: Option<GradeName>,
    /// Was it left as it was found? Missing if it was improved, and in files of older programs.
    #[serde(default, skip_serializing_if = "is_false")]
    pub as_found: bool,
    /// Iterations in all, those before a restart included.
    pub iterations: u64,
    /// How often the planner started over.
    pub restarts: u64,
    /// Nodes of the last tree.
    pub nodes: u64,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde hands over a reference")]
fn is_false(flag: &bool) -> bool {
    !*flag
}

/// A search.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SearchName {
    /// One tree from the start (the paper).
    Darrt,
    /// A second tree from the goal.
    Connect,
    /// The objects first, then the whole from subgoal to subgoal.
    Hierarchical,
    /// The same, with a second tree from every subgoal.
    HierarchicalConnect,
}

impl SearchName {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Darrt, Self::Connect, Self::Hierarchical, Self::HierarchicalConnect];

    /// The search of this name.
    pub fn algorithm(self) -> Algorithm {
        match self {
            Self::Darrt => Algorithm::Darrt,
            Self::Connect => Algorithm::Connect,
            Self::Hierarchical => Algorithm::Hierarchical,
            Self::HierarchicalConnect => Algorithm::HierarchicalConnect,
        }
    }

    /// The name of a search; `None` for one that this format does not know.
    pub fn of(algorithm: Algorithm) -> Option<Self> {
        Self::ALL.into_iter().find(|name| name.algorithm() == algorithm)
    }
}

/// In what a plan is the best of all that were found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum GradeName {
    /// Fewer steps.
    Steps,
    /// Less travel.
    Travel,
    /// More distance between bodies that may not touch.
    Clearance,
}

impl From<Cost> for GradeName {
    fn from(cost: Cost) -> Self {
        match cost {
            Cost::Steps => Self::Steps,
            Cost::Travel => Self::Travel,
            Cost::Clearance => Self::Clearance,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_search_has_the_name_that_it_has_everywhere() {
        for algorithm in Algorithm::ALL {
            let name = serde_json::to_value(SearchName::of(algorithm).unwrap()).unwrap();
            assert_eq!(name, algorithm.name());
        }
    }

    /// Files without the keys are as they were, bit for bit, when they are written again.
    #[test]
    fn what_older_programs_did_not_say_is_neither_asked_for_nor_made_up() {
        let old = r#"{"sampler":"full","distance":"greedy","iterations":10,"restarts":1,"nodes":5}"#;
        let facts: PlannerFacts = serde_json::from_str(old).unwrap();
        assert!(facts.searches.is_empty() && facts.improve.is_none() && !facts.as_found);
        assert_eq!(serde_json::to_string(&facts).unwrap(), old);
    }

    #[test]
    fn all_that_is_said_is_read_again() {
        let all = PlannerFacts {
            searches: SearchName::ALL.to_vec(),
            improve: Some(GradeName::Clearance),
            as_found: true,
            ..PlannerFacts::default()
        };
        let text = serde_json::to_string(&all).unwrap();
        for words in [r#""searches":["darrt","connect","#, r#""improve":"clearance""#, r#""as_found":true"#] {
            assert!(text.contains(words), "{text}");
        }
        assert_eq!(serde_json::from_str::<PlannerFacts>(&text).unwrap(), all);
        for wrong in
            [text.replace("connect", "conect"), text.replace("clearance", "room"), text.replace("as_found", "as_fund")]
        {
            assert!(serde_json::from_str::<PlannerFacts>(&wrong).is_err(), "{wrong}");
        }
    }
}
