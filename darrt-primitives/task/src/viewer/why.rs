//! What the page says of a search that found no plan.

use darrt_core::observe::accounts::Accounts;
use serde::{Deserialize, Serialize};

use super::data::StartData;

/// Pairs of bodies that are told; those that were in the way less often are counted together.
const PAIRS: usize = 120;

/// Why there is no plan.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WhyData {
    /// One line: what ended the search.
    pub headline: String,
    /// What keeps a plan away.
    pub causes: Vec<ReasonData>,
    /// What may help, line by line.
    pub advice: Vec<String>,
    /// Which pair of bodies was how often in the way of the search, most first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub blocks: Vec<BlockData>,
    /// How often others were.
    #[serde(default)]
    pub other_blocks: u64,
    /// The state nearest to the goal.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub nearest: Option<NearestData>,
}

/// One cause.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ReasonData {
    /// In words.
    pub text: String,
    /// The bodies, objects and links that it names.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub bodies: Vec<String>,
    /// The place that it is about, if there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at: Option<[f64; 3]>,
}

/// Two bodies that met.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BlockData {
    /// What was moved.
    pub first: String,
    /// What was in its way.
    pub second: String,
    /// How often.
    pub count: u64,
}

/// The state nearest to the goal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NearestData {
    /// How far objects and robot still had to move, by the planner's distance, metres.
    pub to_go_m: f64,
    /// Where everything stands.
    pub state: StartData,
}

/// The pairs that were most often in the way, and how often all others were.
pub fn blocks(accounts: &Accounts) -> (Vec<BlockData>, u64) {
    let worst = accounts.worst_blocks(PAIRS);
    let others = accounts.blocks.values().sum::<u64>() - worst.iter().map(|(_, count)| count).sum::<u64>();
    let told = worst.into_iter().map(|((first, second), count)| BlockData {
        first: first.clone(),
        second: second.clone(),
        count,
    });
    (told.collect(), others)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pairs_most_in_the_way_come_first_and_none_is_lost() {
        let mut accounts = Accounts::default();
        accounts.blocks = (0..200).map(|i| ((format!("a{i}"), "b".to_owned()), i)).collect();
        let (told, others) = blocks(&accounts);
        assert_eq!((told.len(), told[0].count, told[0].first.as_str()), (PAIRS, 199, "a199"));
        assert_eq!(told.iter().map(|pair| pair.count).sum::<u64>() + others, (0..200).sum::<u64>());
    }
}
