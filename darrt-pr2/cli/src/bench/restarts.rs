//! After how many iterations it would pay to start over, from the iterations that attempts took.
//!
//! Attempts that were given up are censored: they would have taken longer than they had.

use super::record::Record;
use super::survival::{Observation, Survival};

/// When to start over, and what that brings.
#[derive(Debug, Clone, PartialEq)]
pub struct Advice {
    /// Attempts that were seen.
    pub attempts: usize,
    /// Iterations after which to start over for the least expected work; `None`: never.
    pub restart: Option<f64>,
    /// Expected iterations until solved if one does so.
    pub expected: f64,
    /// Expected iterations without restarts; `None` if some attempts never came to an end.
    pub without: Option<f64>,
}

/// The advice that these runs give; `None` if no attempt was solved.
///
/// With restarts after c iterations the expected work is E(min(T, c)) / P(T <= c). The best c is looked for among the
/// iterations at which attempts were solved, so with few runs it is a rough hint.
///
/// # Source
/// Luby, Sinclair, Zuckerman, Optimal speedup of Las Vegas algorithms, 1993, section 2.
pub fn advice(runs: &[&Record]) -> Option<Advice> {
    let attempts: Vec<_> = runs.iter().flat_map(|run| observations(run)).collect();
    let survival = Survival::of(&attempts);
    let mut expected = survival.steps().iter().map(|(cut, share)| (*cut, survival.area_to(*cut) / share));
    let first = expected.next()?;
    let best = expected.fold(first, |best, next| if next.1 < best.1 { next } else { best });
    let is_last = survival.steps().last().is_some_and(|(cut, _)| *cut == best.0);
    let without = survival.restricted_mean().value();
    let restart = Some(best.0).filter(|_| without.is_none() || !is_last);
    Some(Advice { attempts: attempts.len(), restart, expected: best.1, without })
}

/// The iterations of the attempts of a run.
fn observations(run: &Record) -> impl Iterator<Item = Observation> {
    let last = run.attempts.len().checked_sub(1).filter(|_| run.solved);
    run.attempts
        .iter()
        .enumerate()
        .map(move |(index, iterations)| Observation { value: *iterations as f64, is_event: Some(index) == last })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::record::tests::sample;

    fn run(attempts: &[u64], solved: bool) -> Record {
        Record { attempts: attempts.to_vec(), ..sample("bowl", "default", 0, 1.0, solved) }
    }

    fn of(runs: &[Record]) -> Option<Advice> {
        advice(&runs.iter().collect::<Vec<_>>())
    }

    #[test]
    fn the_best_limit_is_that_of_trying_all() {
        let values = [3_u64, 5, 5, 7, 200, 4, 900, 6, 31, 8];
        let found = of(&values.map(|value| run(&[value], true))).unwrap();
        let work = |cut: u64| {
            let spent: u64 = values.iter().map(|value| *value.min(&cut)).sum();
            spent as f64 / values.iter().filter(|value| **value <= cut).count() as f64
        };
        let best = (3..=900).min_by(|a, b| work(*a).total_cmp(&work(*b))).unwrap();
        assert_eq!(found.restart, Some(best as f64));
        assert!((found.expected - work(best)).abs() < 1e-9 && (found.without.unwrap() - work(900)).abs() < 1e-9);
    }

    #[test]
    fn equal_work_asks_for_no_restart_and_given_up_attempts_are_censored() {
        let even = of(&[90, 100, 110].map(|value| run(&[value], true))).unwrap();
        assert_eq!((even.restart, even.without), (None, Some(100.0)));
        let cut = of(&[run(&[50, 50, 20], true), run(&[50, 30], true), run(&[50, 50], false)]).unwrap();
        assert_eq!((cut.attempts, cut.without), (7, None));
        assert!(cut.restart.is_some());
        assert_eq!(of(&[run(&[50, 50], false)]), None);
    }
}
