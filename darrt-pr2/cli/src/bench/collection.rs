//! Runs from one or several files: each counted once, comparable ones only.

use std::collections::BTreeMap;

use super::error::BenchError;
use super::record::{Conditions, Key, Record};
use crate::generate;

/// What to do about runs that do not go together.
const REMEDY: &str = "merge them apart";

/// Runs, each with the file that it is from, in the order of problem, variant and seed.
#[derive(Debug, Clone, Default)]
pub struct Collection {
    runs: BTreeMap<Key, (Record, String)>,
    conditions: BTreeMap<String, Conditions>,
    /// Problems and variants in the order in which they came.
    order: Order,
}

#[derive(Debug, Clone, Default)]
struct Order {
    problems: BTreeMap<String, usize>,
    variants: BTreeMap<String, usize>,
}

impl Collection {
    /// Adds a run of `file`. The same run with the same outcome counts once.
    ///
    /// # Errors
    /// [`BenchError::Twice`] for the same run with another outcome; [`BenchError::Conditions`] when the other runs of its
    /// problem were done by another version, with other limits, or of another text of the problem.
    pub fn add(&mut self, record: Record, file: &str) -> Result<(), BenchError> {
        let key = record.key();
        if let Some((there, first)) = self.runs.get(&key) {
            if *there == record {
                return Ok(());
            }
            let (run, first, second) = (key.to_string(), first.clone(), file.to_owned());
            return Err(BenchError::Twice { run, first, second });
        }
        match self.conditions.get(&key.problem) {
            Some(expected) => record.conditions.check(expected, &key, file, REMEDY)?,
            None => {
                self.conditions.insert(key.problem.clone(), record.conditions.clone());
            }
        }
        let (problems, variants) = (self.order.problems.len(), self.order.variants.len());
        self.order.problems.entry(group_name(&key.problem)).or_insert(problems);
        self.order.variants.entry(key.variant.clone()).or_insert(variants);
        self.runs.insert(key, (record, file.to_owned()));
        Ok(())
    }

    /// Is this run there?
    pub fn contains(&self, key: &Key) -> bool {
        self.runs.contains_key(key)
    }

    /// How many runs.
    pub fn len(&self) -> usize {
        self.runs.len()
    }

    /// None at all?
    pub fn is_empty(&self) -> bool {
        self.runs.is_empty()
    }

    /// All runs, by name.
    pub fn records(&self) -> impl Iterator<Item = &Record> {
        self.runs.values().map(|(record, _)| record)
    }

    /// The problems, in the order of `known` and then of their first run; all generated for one family are one.
    pub fn problems(&self, known: &[&str]) -> Vec<String> {
        sorted(&self.order.problems, known)
    }

    /// The variants, in the order of `known` and then of their first run.
    pub fn variants(&self, known: &[&str]) -> Vec<String> {
        sorted(&self.order.variants, known)
    }

    /// The runs of one problem, or one family, with one variant, by problem and seed.
    pub fn group<'a>(&'a self, problem: &str, variant: &str) -> Vec<&'a Record> {
        let all = self.records();
        all.filter(|record| record.variant == variant && group_name(&record.problem) == problem).collect()
    }
}

/// The name under which the runs of a problem are told: its own, or that of the family that it was generated for.
fn group_name(problem: &str) -> String {
    generate::family(problem).map_or_else(|| problem.to_owned(), family_name)
}

/// The name under which the runs of all problems of a family are told.
pub(crate) fn family_name(family: &str) -> String {
    format!("{family}-g*")
}

fn sorted(order: &BTreeMap<String, usize>, known: &[&str]) -> Vec<String> {
    let place = |name: &str| known.iter().position(|other| *other == name).unwrap_or(known.len());
    let mut names: Vec<(usize, usize, &String)> = order.iter().map(|(name, came)| (place(name), *came, name)).collect();
    names.sort_unstable();
    names.into_iter().map(|(_, _, name)| name.clone()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::record::tests::sample;

    #[test]
    fn the_same_run_counts_once_and_another_outcome_is_refused() {
        let mut all = Collection::default();
        let run = sample("bowl", "default", 7, 0.5, true);
        all.add(run.clone(), "a").unwrap();
        all.add(run, "b").unwrap();
        assert_eq!(all.len(), 1);
        let error = all.add(sample("bowl", "default", 7, 0.6, true), "c").unwrap_err().to_string();
        assert!(error.contains("c: bowl/default/7 is also in a, with another outcome"), "{error}");
    }

    #[test]
    fn runs_under_other_conditions_are_refused_with_what_differs() {
        let mut all = Collection::default();
        all.add(sample("bowl", "default", 0, 0.5, true), "a").unwrap();
        let mut other = sample("bowl", "full", 1, 0.5, true);
        other.conditions.time_limit_s = 30.0;
        let error = all.add(other.clone(), "b").unwrap_err().to_string();
        assert!(error.contains("b: bowl/full/1 was run with the time limit 30 s, not 60 s"), "{error}");
        other.problem = "plate1".to_owned();
        all.add(other.clone(), "b").unwrap();
        other.seed = 2;
        other.conditions.darrt = "0.2.0".to_owned();
        let error = all.add(other, "b").unwrap_err().to_string();
        assert!(error.contains("darrt version 0.2.0, not 0.1.0"), "{error}");
    }

    #[test]
    fn groups_are_in_a_fixed_order() {
        let mut all = Collection::default();
        for (problem, variant, seed) in [("mine", "full", 1), ("bowl", "default", 2), ("mine", "default", 0)] {
            all.add(sample(problem, variant, seed, 0.5, true), "a").unwrap();
        }
        assert_eq!(all.problems(&["plate1", "bowl"]), ["bowl", "mine"]);
        assert_eq!(all.variants(&[]), ["full", "default"]);
        assert_eq!(all.group("mine", "default").len(), 1);
        for seed in 0..3 {
            all.add(sample(&format!("bowl-g{seed}"), "full", 0, 0.5, true), "a").unwrap();
        }
        assert_eq!(all.problems(&["bowl"]), ["bowl", "mine", "bowl-g*"]);
        assert_eq!((all.group("bowl-g*", "full").len(), all.group("bowl", "full").len()), (3, 0));
    }
}
