//! A machine's share of the runs.

use std::fmt;
use std::str::FromStr;

/// One of several equal shares, written `2/5`: the second of five.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    /// From 0.
    index: u64,
    count: u64,
}

impl Shard {
    /// All runs.
    pub const WHOLE: Self = Self { index: 0, count: 1 };

    /// Does it take the run at `place` of round `round`? Every round is dealt from another share on, so that no share gets
    /// one problem only.
    pub fn takes(self, round: u64, place: u64) -> bool {
        (u128::from(round) + u128::from(place)) % u128::from(self.count) == u128::from(self.index)
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers = text.split_once('/').and_then(|(index, count)| Some((index.parse().ok()?, count.parse().ok()?)));
        match numbers {
            Some((index, count)) if (1..=count).contains(&index) => Ok(Self { index: index - 1, count }),
            _ => Err("must be written i/n, with i from 1 to n: 2/5 is the second of five".to_owned()),
        }
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index + 1, self.count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_read_and_bad_ones_refused() {
        let shard: Shard = "2/5".parse().unwrap();
        assert_eq!((shard, shard.to_string().as_str()), (Shard { index: 1, count: 5 }, "2/5"));
        for bad in ["0/5", "6/5", "1/0", "1", "a/b", "-1/2", "1/2/3", ""] {
            assert!(bad.parse::<Shard>().is_err(), "{bad}");
        }
    }

    #[test]
    fn every_run_is_in_exactly_one_share() {
        for count in 1..7 {
            for (round, place) in (0..9).flat_map(|round| (0..12).map(move |place| (round, place))) {
                let takers = (0..count).filter(|index| Shard { index: *index, count }.takes(round, place)).count();
                assert_eq!(takers, 1);
            }
        }
    }
}
