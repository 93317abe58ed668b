//! What is said about the runs of one problem with one variant.

use super::bootstrap;
use super::collection::{Collection, family_name};
use super::digest::digest_bits;
use super::record::{PlanQuality, Record};
use super::survival::{Observation, Quantile, Survival};
use super::variant::VARIANTS;

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
    /// How good the plans are that were found.
    pub quality: Quality,
    /// Mean time that the paper reports, seconds.
    pub paper_s: Option<f64>,
}

/// Medians over the plans that were found; `None` without any, or where older results do not hold the figure.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Quality {
    /// Way of the base, metres.
    pub base_m: Option<f64>,
    /// Its 95th percentile, metres.
    pub base_95_m: Option<f64>,
    /// Turns of the base, degrees.
    pub turn_deg: Option<f64>,
    /// Turns of all joints of the arm together, radians.
    pub arm_rad: Option<f64>,
    /// Way of the hand as seen from the base, metres.
    pub hand_m: Option<f64>,
    /// Seconds of execution.
    pub execution_s: Option<f64>,
    /// Where two bodies that may not touch are nearest, metres.
    pub clearance_m: Option<f64>,
}

impl Quality {
    fn of(runs: &[&Record]) -> Self {
        let quantile = |q: f64, figure: fn(&PlanQuality) -> Option<f64>| {
            let plans = runs.iter().filter_map(|run| run.plan.as_ref());
            let seen: Vec<_> = plans.filter_map(figure).map(|value| Observation { value, is_event: true }).collect();
            Survival::of(&seen).quantile(q).value()
        };
        Self {
            base_m: quantile(0.5, |plan| Some(plan.base_m)),
            base_95_m: quantile(0.95, |plan| Some(plan.base_m)),
            turn_deg: quantile(0.5, |plan| plan.turn_deg),
            arm_rad: quantile(0.5, |plan| plan.arm_rad),
            hand_m: quantile(0.5, |plan| Some(plan.hand_m)),
            execution_s: quantile(0.5, |plan| plan.execution_s),
            clearance_m: quantile(0.5, |plan| plan.clearance_m),
        }
    }
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
            quality: Quality::of(runs),
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
pub fn summaries(all: &Collection, known: &[&str]) -> Vec<Summary> {
    let variants = all.variants(&VARIANTS.map(|variant| variant.name));
    let families: Vec<_> = known.iter().map(|name| family_name(name)).collect();
    let known: Vec<&str> = known.iter().copied().chain(families.iter().map(String::as_str)).collect();
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
        let both = summaries(&all, &darrt_pr2::problems::builtin_names());
        assert_eq!(both.len(), 2);
        assert_eq!((both[0].problem.as_str(), both[0].median_interval), ("simple-plate", None));
        let bowl = &both[1];
        assert_eq!((bowl.runs, bowl.solved), (9, 4));
        assert_eq!(bowl.time.quantile(0.5), Quantile::Beyond(60.0));
        assert_eq!(bowl.time.quantile(0.25), Quantile::At(3.0));
        assert_eq!((bowl.iterations, bowl.steps), (None, Some(5.0)));
        assert_eq!((bowl.quality.turn_deg, bowl.quality.execution_s), (Some(90.0), Some(30.0)));
    }

    /// Results of a program that did not know the figure say nothing, not zero.
    #[test]
    fn what_older_results_do_not_hold_is_absent() {
        let mut old = sample("bowl", "full", 0, 1.0, true);
        if let Some(plan) = &mut old.plan {
            (plan.turn_deg, plan.base_m) = (None, 3.0);
        }
        let text = serde_json::to_string(&old).unwrap().replace(r#""turn_deg":null,"#, "");
        let (old, new): (Record, _) = (serde_json::from_str(&text).unwrap(), sample("bowl", "full", 1, 1.0, true));
        assert_eq!(Quality::of(&[&old]).turn_deg, None);
        let both = Quality::of(&[&old, &new]);
        assert_eq!((both.turn_deg, both.base_m, both.base_95_m), (Some(90.0), Some(1.0), Some(3.0)));
    }
}
