//! Values of options that are chosen from a list.

use clap::ValueEnum;
use darrt_core::search::Algorithm;
use darrt_core::solve::Cost;

/// The searches, as the command line spells them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum SearchChoice {
    /// One tree from the start (the paper)
    Darrt,
    /// A second tree from the goal
    Connect,
    /// The objects first, then the whole from subgoal to subgoal
    Hierarchical,
    /// The same, with a second tree from every subgoal
    HierarchicalConnect,
    /// All of them
    Portfolio,
}

impl SearchChoice {
    /// The searches that the attempts take in turn.
    pub fn algorithms(self) -> Vec<Algorithm> {
        match self {
            Self::Darrt => vec![Algorithm::Darrt],
            Self::Connect => vec![Algorithm::Connect],
            Self::Hierarchical => vec![Algorithm::Hierarchical],
            Self::HierarchicalConnect => vec![Algorithm::HierarchicalConnect],
            Self::Portfolio => Algorithm::ALL.to_vec(),
        }
    }
}

/// What makes one plan better than another.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ImproveChoice {
    /// Fewer steps
    Steps,
    /// Less travel of the robot
    Travel,
    /// More distance between bodies that may not touch
    Clearance,
}

impl From<ImproveChoice> for Cost {
    fn from(choice: ImproveChoice) -> Self {
        match choice {
            ImproveChoice::Steps => Self::Steps,
            ImproveChoice::Travel => Self::Travel,
            ImproveChoice::Clearance => Self::Clearance,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn choices_are_spelled_as_in_problem_files() {}

    #[test]
    fn searches_are_spelled_by_their_names() {
        for choice in SearchChoice::value_variants() {
            let algorithms = choice.algorithms();
            match Algorithm::from_name(choice.to_possible_value().unwrap().get_name()) {
                Some(algorithm) => assert_eq!(algorithms, [algorithm]),
                None => assert_eq!((*choice, algorithms), (SearchChoice::Portfolio, Algorithm::ALL.to_vec())),
            }
        }
    }
}
