//! What is said about the runs of one problem with one variant.

use super::bootstrap;
use super::collection::{Collection, family_name};
use super::digest::digest_bits;
use super::record::Record;
use super::survival::{Observation, Quantile, Survival};
use super::variant::VARIANTS;
use crate::problem_file::builtin_names;

/// Confidence of the intervals of the median.
pub const CONFIDENCE: f64 = 0.95;

/// The runs of one problem with one variant in numbers. Quantiles are over all runs, those without a plan as censored.
#[derive(Debug, Clone, PartialEq)]
pub struct Summary {
    /// The problem, or the family of generated ones.
    pub problem: String,
    /// The variant.
    pub variant: String,
    /// Runs.
    pub runs: usize,
    /// Runs with an accepted plan within the time limit.
    pub solved: usize,
    /// Seconds to the accepted plan.
    pub time: Survival,
    /// Interval of the median of those seconds, by bootstrap; `None` for a single run.
    pub median_interval: Option<[Quantile; 2]>,
    /// Iterations within which half of all runs were solved; `None` if fewer were solved.
    pub iterations: Option<f64>,
    /// The same of nodes.
    pub nodes: Option<f64>,
    /// Restarts over all runs.
    pub restarts: u64,
    /// Median steps of the plans that were found; `None` without any.
    pub steps: Option<f64>,
    /// Mean time that the paper reports, seconds.
    pub paper_s: Option<f64>,
}

impl Summary {
    /// Of these runs of `problem` (or a family) with one variant; `None` without any.
    pub fn of(problem: &str, runs: &[&Record]) -> Option<Self> {
        let first = runs.first()?;
        let times: Vec<_> = runs.iter().map(|run| run.time()).collect();
        // One group's interval does not depend on which others are there.
        let seed = digest_bits(format!("{problem}/{}", first.variant).as_bytes());
        let steps = runs.iter().filter_map(|run| run.plan.as_ref());
        let steps: Vec<_> = steps.map(|plan| Observation { value: plan.steps as f64, is_event: true }).collect();
        Some(Self {
            problem: problem.to_owned(),
            variant: first.variant.clone(),
            runs: runs.len(),
            solved: runs.iter().filter(|run| run.is_in_time()).count(),
            time: Survival::of(&times),
            median_interval: bootstrap::interval(&times, 0.5, CONFIDENCE, seed),
            iterations: half_solved(runs, |run| run.iterations as f64),
            nodes: half_solved(runs, |run| run.nodes as f64),
            restarts: runs.iter().map(|run| run.restarts).sum(),
            steps: Survival::of(&steps).quantile(0.5).value(),
            paper_s: first.paper_s,
        })
    }
}

/// The least effort with which half of all runs were solved. Runs without a plan count as never: it was the clock that
/// ended them, so that their own effort is no bound that would be the same for all.
fn half_solved(runs: &[&Record], effort: fn(&Record) -> f64) -> Option<f64> {
    let mut efforts: Vec<f64> =
        runs.iter().map(|run| if run.is_in_time() { effort(run) } else { f64::INFINITY }).collect();
    efforts.sort_by(f64::total_cmp);
    efforts.get(runs.len().div_ceil(2).checked_sub(1)?).copied().filter(|effort| effort.is_finite())
}

/// A summary of every problem and variant that has runs: built-in problems first, then families of them, then variants in
/// their order.
pub fn summaries(all: &Collection) -> Vec<Summary> {
    let variants = all.variants(&VARIANTS.map(|variant| variant.name));
    let families = builtin_names().map(family_name);
    let known: Vec<&str> = builtin_names().into_iter().chain(families.iter().map(String::as_str)).collect();
    let problems = all.problems(&known);
    let groups = problems.iter().flat_map(|problem| variants.iter().map(move |variant| (problem, variant)));
    groups.filter_map(|(problem, variant)| Summary::of(problem, &all.group(problem, variant))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::record::tests::sample;

    #[test]
    fn half_of_all_runs_is_half_of_all_runs() {
        let runs = |solved: [bool; 5]| -> Option<f64> {
            let all: Vec<_> =
                (0..5).zip(solved).map(|(seed, solved)| sample("bowl", "full", seed, 1.0, solved)).collect();
            half_solved(&all.iter().collect::<Vec<_>>(), |run| run.iterations as f64)
        };
        assert_eq!(runs([true; 5]), Some(102.0));
        assert_eq!(runs([true, false, true, false, true]), Some(104.0));
        assert_eq!(runs([true, false, true, false, false]), None);
        assert_eq!(half_solved(&[], |_| 1.0), None);
    }

    #[test]
    fn unsolved_runs_count_in_every_quantile() {
        let mut all = Collection::default();
        for seed in 0..4 {
            all.add(sample("bowl", "full", seed, 1.0 + seed as f64, true), "a").unwrap();
        }
        for seed in 4..9 {
            all.add(sample("bowl", "full", seed, 60.0, false), "a").unwrap();
        }
        all.add(sample("simple-plate", "default", 0, 0.2, true), "a").unwrap();
        let both = summaries(&all);
        assert_eq!(both.len(), 2);
        assert_eq!((both[0].problem.as_str(), both[0].median_interval), ("simple-plate", None));
        let bowl = &both[1];
        assert_eq!((bowl.runs, bowl.solved), (9, 4));
        assert_eq!(bowl.time.quantile(0.5), Quantile::Beyond(60.0));
        assert_eq!(bowl.time.quantile(0.25), Quantile::At(3.0));
        assert_eq!((bowl.iterations, bowl.steps), (None, Some(5.0)));
    }
}
