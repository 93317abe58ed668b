//! How sure a median is: the bootstrap interval of a quantile of censored values.

use darrt_core::random::Stream;
use rand::{RngExt, SeedableRng as _};

use super::survival::{Observation, Quantile, Survival, sorted};

/// Samples that are drawn.
const DRAWS: usize = 2000;

/// The interval in which the quantile lies with this confidence, from `2000` samples drawn with replacement.
///
/// Censored runs are drawn with the others, so an end may be censored too. The same values and seed give the same interval.
/// `None` for fewer than two values: they say nothing about their spread.
///
/// # Source
/// Efron, Censored data and the bootstrap, 1981 (pairs of value and censoring, percentile interval).
pub fn interval(observations: &[Observation], q: f64, confidence: f64, seed: u64) -> Option<[Quantile; 2]> {
    let all = sorted(observations);
    if all.len() < 2 {
        return None;
    }
    let last = all.last()?.value;
    let mut rng = Stream::seed_from_u64(seed);
    let mut counts = vec![0; all.len()];
    let mut quantiles: Vec<f64> = (0..DRAWS)
        .map(|_| {
            counts.fill(0);
            for _ in 0..all.len() {
                if let Some(count) = counts.get_mut(rng.random_range(0..all.len())) {
                    *count += 1;
                }
            }
            Survival::weighted(&all, &counts).quantile(q).value().unwrap_or(f64::INFINITY)
        })
        .collect();
    quantiles.sort_by(f64::total_cmp);
    let tail = (1.0 - confidence) / 2.0;
    let end = |share: f64| {
        let rank = (share * DRAWS as f64).ceil().clamp(1.0, DRAWS as f64);
        // In range: between 1 and the number of draws.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped above")]
        let value = quantiles.get(rank as usize - 1).copied().unwrap_or(f64::INFINITY);
        if value.is_finite() { Quantile::At(value) } else { Quantile::Beyond(last) }
    };
    Some([end(tail), end(1.0 - tail)])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Exponential times with mean 1, censored at `limit`.
    fn times(count: usize, limit: f64, seed: u64) -> Vec<Observation> {
        let mut rng = Stream::seed_from_u64(seed);
        let draw = |_| -(1.0 - rng.random::<f64>()).ln();
        let draws: Vec<f64> = (0..count).map(draw).collect();
        draws.into_iter().map(|t| Observation { value: t.min(limit), is_event: t <= limit }).collect()
    }

    #[test]
    fn the_same_seed_gives_the_same_interval_about_the_median() {
        let all = times(40, 3.0, 1);
        let [low, high] = interval(&all, 0.5, 0.95, 7).unwrap();
        assert_eq!(interval(&all, 0.5, 0.95, 7).unwrap(), [low, high]);
        let median = Survival::of(&all).quantile(0.5).at_least();
        assert!(low.at_least() <= median && median <= high.at_least());
        let mut shuffled = all.clone();
        shuffled.reverse();
        assert_eq!(interval(&shuffled, 0.5, 0.95, 7).unwrap(), [low, high]);
    }

    /// 200 samples: the true median must lie in about 95 of 100 intervals; 6 standard deviations are 9 of 100.
    #[test]
    fn intervals_cover_the_true_median_as_often_as_they_say() {
        let truth = 2.0_f64.ln();
        let covers = |limit: f64| {
            let hits = (0..200_u64).filter(|seed| {
                let [low, high] = interval(&times(30, limit, 1000 + seed), 0.5, 0.95, *seed).unwrap();
                low.at_least() <= truth && high.value().is_none_or(|high| truth <= high)
            });
            hits.count()
        };
        for (limit, least) in [(f64::MAX, 172), (1.0, 172)] {
            let hits = covers(limit);
            assert!((least..200).contains(&hits), "{hits} of 200 with the limit {limit}");
        }
    }

    #[test]
    fn many_time_outs_leave_the_upper_end_open() {
        let all = times(20, 0.6, 3);
        let [low, high] = interval(&all, 0.5, 0.95, 0).unwrap();
        assert!(low.value().is_some());
        assert_eq!(high, Quantile::Beyond(0.6));
        assert!(interval(&all[..1], 0.5, 0.95, 0).is_none());
    }
}
