//! Values of which some are only known to be larger than what was seen: the product-limit estimate and its quantiles.
//!
//! A run that ended without a plan was not solved in infinite time, nor does it count for nothing: its time to the solution
//! is larger than the time it had. Leaving such runs out, or counting them with the limit, makes a planner look better
//! than it is.

use std::fmt;

/// A value, or a bound below it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Observation {
    /// What was seen; finite.
    pub value: f64,
    /// Did the event happen there? If not the value is censored: the event would come later.
    pub is_event: bool,
}

/// A quantile of censored values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Quantile {
    /// Its value.
    At(f64),
    /// Larger than this, the largest value seen; how much larger the data do not say.
    Beyond(f64),
}

impl Quantile {
    /// The value, if it is known.
    pub fn value(self) -> Option<f64> {
        match self {
            Self::At(value) => Some(value),
            Self::Beyond(_) => None,
        }
    }

    /// The value or the bound below it.
    pub fn at_least(self) -> f64 {
        match self {
            Self::At(value) | Self::Beyond(value) => value,
        }
    }
}

/// Three significant digits, `> 60` where censored.
impl fmt::Display for Quantile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::At(value) => f.pad(&rounded(*value)),
            Self::Beyond(value) => f.pad(&format!("> {}", rounded(*value))),
        }
    }
}

/// Three significant digits; all digits before the point.
pub fn rounded(value: f64) -> String {
    let size = value.abs();
    let decimals = match size {
        _ if size >= 99.95 || size == 0.0 => 0,
        _ if size >= 9.995 => 1,
        _ if size >= 0.9995 => 2,
        _ => 3,
    };
    format!("{value:.decimals$}")
}

/// Sums of ratios reach a share only up to rounding.
const SLACK: f64 = 1e-9;

/// The share of runs that are solved by a time, estimated from all runs.
///
/// # Source
/// Kaplan and Meier, Nonparametric estimation from incomplete observations, 1958. Events at the time of a censoring count
/// as before it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Survival {
    /// Times of events, ascending, and the share of events up to and with each.
    steps: Vec<(f64, f64)>,
    /// Times of censorings, ascending.
    censored: Vec<f64>,
    /// The largest value seen.
    last: f64,
}

impl Survival {
    /// The estimate; values that are not numbers are left out.
    pub fn of(observations: &[Observation]) -> Self {
        let sorted = sorted(observations);
        let ones = vec![1; sorted.len()];
        Self::weighted(&sorted, &ones)
    }

    /// The same when value `i` of the sorted observations was seen `counts[i]` times.
    pub(super) fn weighted(sorted: &[Observation], counts: &[u32]) -> Self {
        let mut at_risk: f64 = counts.iter().map(|count| f64::from(*count)).sum();
        let mut left = 1.0;
        let mut survival = Self::default();
        for (observation, count) in sorted.iter().zip(counts).filter(|(_, count)| **count > 0) {
            let count = f64::from(*count);
            survival.last = observation.value;
            if observation.is_event {
                left *= 1.0 - count / at_risk;
                match survival.steps.last_mut() {
                    Some(step) if step.0 == observation.value => step.1 = 1.0 - left,
                    _ => survival.steps.push((observation.value, 1.0 - left)),
                }
            } else {
                survival.censored.push(observation.value);
            }
            at_risk -= count;
        }
        survival
    }

    /// Times of events, ascending, and the share of events up to and with each.
    pub fn steps(&self) -> &[(f64, f64)] {
        &self.steps
    }

    /// Times of censorings, ascending.
    pub fn censored(&self) -> &[f64] {
        &self.censored
    }

    /// The largest value seen; 0 without any.
    pub fn last(&self) -> f64 {
        self.last
    }

    /// Share of events up to and with `value`.
    pub fn share_by(&self, value: f64) -> f64 {
        let before = self.steps.partition_point(|(at, _)| *at <= value);
        before.checked_sub(1).and_then(|last| self.steps.get(last)).map_or(0.0, |(_, share)| *share)
    }

    /// The smallest value by which at least the share `q` of the events has come.
    pub fn quantile(&self, q: f64) -> Quantile {
        let found = self.steps.iter().find(|(_, share)| *share >= q - SLACK);
        found.map_or(Quantile::Beyond(self.last), |(at, _)| Quantile::At(*at))
    }

    /// The mean up to the largest value seen: the mean itself if nothing is censored, else a bound below it.
    pub fn restricted_mean(&self) -> Quantile {
        let area = self.area_to(self.last);
        if self.censored.is_empty() { Quantile::At(area) } else { Quantile::Beyond(area) }
    }

    /// The mean of the values, each at most `limit`.
    pub fn area_to(&self, limit: f64) -> f64 {
        let (mut area, mut at, mut left) = (0.0, 0.0, 1.0);
        for (value, share) in self.steps.iter().take_while(|(value, _)| *value <= limit) {
            area += (value - at) * left;
            (at, left) = (*value, 1.0 - share);
        }
        area + (limit - at).max(0.0) * left
    }
}

/// Ascending; events before censorings at the same value.
pub(super) fn sorted(observations: &[Observation]) -> Vec<Observation> {
    let mut sorted: Vec<_> = observations.iter().copied().filter(|o| o.value.is_finite()).collect();
    sorted.sort_by(|a, b| a.value.total_cmp(&b.value).then(b.is_event.cmp(&a.is_event)));
    sorted
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The share of events up to `value` by another way: every value has one share, and a censored one hands what it has to
    /// all that come after it (Efron, The two sample problem with censored data, 1967). Also what is left at the end.
    fn redistributed(observations: &[Observation], value: f64) -> f64 {
        let sorted = sorted(observations);
        let mut shares = vec![1.0 / sorted.len() as f64; sorted.len()];
        for i in 0..sorted.len() {
            if !sorted[i].is_event {
                let after = sorted.len() - i - 1;
                let each = if after > 0 { shares[i] / after as f64 } else { 0.0 };
                shares[i + 1..].iter_mut().for_each(|share| *share += each);
                shares[i] = 0.0;
            }
        }
        sorted.iter().zip(&shares).filter(|(o, _)| o.is_event && o.value <= value).map(|(_, share)| share).sum()
    }

    fn observations() -> impl Strategy<Value = Vec<Observation>> {
        // Few values, so that ties are common.
        prop::collection::vec((1..12_u8, any::<bool>()), 1..30).prop_map(|all| {
            all.into_iter().map(|(value, is_event)| Observation { value: f64::from(value), is_event }).collect()
        })
    }

    proptest! {
        #[test]
        fn shares_and_quantiles_equal_the_redistribution(all in observations(), q in 0.01..0.99_f64) {
            let survival = Survival::of(&all);
            for value in 0..13 {
                let value = f64::from(value);
                prop_assert!((survival.share_by(value) - redistributed(&all, value)).abs() < 1e-9);
            }
            let brute = (1..12).map(f64::from).find(|value| redistributed(&all, *value) >= q - SLACK);
            let last = all.iter().map(|o| o.value).fold(0.0, f64::max);
            prop_assert_eq!(survival.quantile(q), brute.map_or(Quantile::Beyond(last), Quantile::At));
        }

        #[test]
        fn without_censoring_it_is_the_order_statistic_and_the_mean(values in prop::collection::vec(0.1..9.0_f64, 1..40)) {
            let all: Vec<_> = values.iter().map(|value| Observation { value: *value, is_event: true }).collect();
            let survival = Survival::of(&all);
            let mut sorted = values.clone();
            sorted.sort_by(f64::total_cmp);
            for percent in [25_usize, 50, 75, 95] {
                let rank = (percent * sorted.len()).div_ceil(100);
                prop_assert_eq!(survival.quantile(percent as f64 / 100.0), Quantile::At(sorted[rank - 1]));
            }
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            prop_assert!((survival.restricted_mean().value().unwrap() - mean).abs() < 1e-9);
        }
    }

    #[test]
    fn time_outs_push_the_quantiles_up() {
        let run = |value, is_event| Observation { value, is_event };
        let mut all = vec![run(1.0, true), run(2.0, true), run(3.0, true), run(60.0, false)];
        assert_eq!(Survival::of(&all).quantile(0.5), Quantile::At(2.0));
        assert_eq!(Survival::of(&all).quantile(0.95), Quantile::Beyond(60.0));
        assert_eq!(Survival::of(&all).restricted_mean(), Quantile::Beyond(16.5));
        all.extend([run(60.0, false); 3]);
        assert_eq!(Survival::of(&all).quantile(0.5).to_string(), "> 60.0");
        assert_eq!(Survival::of(&[]).quantile(0.5), Quantile::Beyond(0.0));
    }

    #[test]
    fn numbers_have_three_digits() {
        let shown = [0.0, 0.0321, 0.5, 0.99949, 0.9996, 2.345, 9.996, 12.34, 99.96, 1234.5].map(rounded);
        assert_eq!(shown, ["0", "0.032", "0.500", "0.999", "1.00", "2.35", "10.0", "12.3", "100", "1234"]);
    }
}
