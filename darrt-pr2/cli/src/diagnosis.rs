//! Says in words why no plan was found.

use std::fmt::Write as _;
use std::time::Duration;

use darrt_core::budget::Stop;
use darrt_core::observe::accounts::{Accounts, Bucket};
use darrt_primitives::surroundings::NearPair;

use darrt_task::planning::PlanResult;
use darrt_task::text::counted;

/// Pairs of bodies that are named.
const PAIRS: usize = 3;

/// With fewer iterations nothing is said of what was in the way.
const FEW: u64 = 10;

/// Buckets of extensions in which a primitive was not even tried.
const UNTRIED: [Bucket; 3] = [Bucket::NotUseful, Bucket::NotChosen, Bucket::Budget];

/// Several lines: why it stopped, how near it came, what was in the way, which primitive never worked, what may help.
pub(crate) fn explain(result: &PlanResult) -> String {
    let mut text = format!(
        "{} after {}, {}, {}, largest tree {}",
        result.stop,
        seconds(result.elapsed),
        counted(result.iterations, "iteration"),
        counted(result.restarts, "restart"),
        counted(result.nodes as u64, "node")
    );
    let mut line = |words: String| {
        // Writing to a string cannot fail.
        let _ = write!(text, "\n  {words}");
    };
    for doubt in &result.doubts {
        line(format!("likely the reason: {doubt}"));
    }
    if result.iterations < FEW {
        line("so few iterations say nothing about the problem".to_owned());
    } else {
        what_was_met(result).into_iter().for_each(&mut line);
    }
    if let Some(refusal) = &result.last_refusal {
        line(format!("a plan was found, but the verifier refused it: {refusal}"));
    }
    if let Some(advice) = advice(result.stop) {
        line(advice.to_owned());
    }
    text
}

/// How near it came, what was in the way, which primitive never worked.
fn what_was_met(result: &PlanResult) -> Vec<String> {
    let mut lines = Vec::new();
    // Of a state that is where the goal wants it, but whose plan was refused, the distance would say the opposite.
    if result.nearest_to_goal.is_finite() && result.nearest_to_goal >= 5e-4 {
        lines.push(format!(
            "nearest to the goal: {:.3} m, by the planner's distance: how far objects and robot still had to move",
            result.nearest_to_goal
        ));
    }
    for ((first, second), count) in result.accounts.worst_blocks(PAIRS) {
        lines.push(format!("in the way {}: {first} and {second}", counted(count, "time")));
    }
    for NearPair { bodies: [first, second], distance_m, is_at_goal } in &result.near {
        let place = if *is_at_goal { "at the goal" } else { "at the start" };
        let apart_mm = distance_m * 1000.0;
        lines.push(format!("nearer than the least margin {place}: {first} and {second}, {apart_mm:.2} mm apart"));
    }
    lines.extend(never_worked(&result.accounts));
    lines
}

/// With as many digits as a short time needs.
fn seconds(time: Duration) -> String {
    let s = time.as_secs_f64();
    if s < 0.1 { format!("{s:.3} s") } else { format!("{s:.1} s") }
}

/// A line for each primitive that was tried or useful, but never free from end to end.
fn never_worked(accounts: &Accounts) -> Vec<String> {
    let describe = |(name, counts): (&'static str, &[u64; Bucket::ALL.len()])| {
        let of = |bucket: Bucket| counts.get(bucket as usize).copied().unwrap_or(0);
        if accounts.extensions == 0 || of(Bucket::Accepted) > 0 {
            return None;
        }
        let tried: u64 = Bucket::ALL.into_iter().filter(|bucket| !UNTRIED.contains(bucket)).map(of).sum();
        if tried == 0 {
            return Some(format!("{name} was never tried: no state came up in which it could be of use"));
        }
        let ends = Bucket::ALL.into_iter().filter(|bucket| !UNTRIED.contains(bucket));
        // The first of equals, so that the words do not depend on anything else.
        let most = ends.rev().max_by_key(|bucket| of(*bucket))?;
        let tries = if tried == 1 { "its only try".to_owned() } else { format!("{tried} tries, mostly") };
        Some(format!("{name} never succeeded in {tries}: {} ({})", most.heading(), of(most)))
    };
    accounts.rows().filter_map(describe).collect()
}

const fn advice(stop: Stop) -> Option<&'static str> {
    match stop {
        Stop::TimeLimit => Some("another --seed, a longer --time-limit or a --restart may help; --stats tells more"),
        Stop::IterationLimit => Some("another --seed or more --iterations may help; --stats tells more"),
        Stop::NodeLimit => Some("a --restart or a higher `budget.nodes` in the problem may help; --stats tells more"),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_words_name_reason_distance_and_the_primitive_that_failed() {
        let mut accounts = Accounts::new(vec!["Pick", "Push", "Place"]);
        for _ in 0..3 {
            accounts.count(&[Bucket::Unreachable, Bucket::Accepted, Bucket::NotUseful], 1, false, None);
        }
        accounts.count(&[Bucket::NoGrasp, Bucket::Accepted, Bucket::NotUseful], 1, false, None);
        let result = PlanResult {
            proof: None,
            no_clock: None,
            execution_s: None,
            found: None,
            plan: None,
            plans: 0,
            near: Vec::new(),
            doubts: vec!["no way".to_owned()],
            stop: Stop::TimeLimit,
            accounts,
            iterations: 40,
            nodes: 9,
            restarts: 0,
            nearest_to_goal: 1.25,
            elapsed: Duration::from_millis(1500),
            times: darrt_task::profile::Times::default(),
            last_refusal: Some("too bad".to_owned()),
        };
        let text = explain(&result);
        for words in [
            "time limit reached after 1.5 s, 40 iterations",
            "likely the reason: no way",
            "nearest to the goal: 1.250 m",
            "Pick never succeeded in 4 tries, mostly: unreachable (3)",
            "Place was never tried",
            "refused it: too bad",
            "--time-limit",
        ] {
            assert!(text.contains(words), "{words}: {text}");
        }
        assert!(!text.contains("Push"));
        let early = PlanResult { iterations: 4, elapsed: Duration::from_millis(1), ..result };
        let text = explain(&early);
        assert!(text.contains("after 0.001 s, 4 iterations") && !text.contains("Pick"), "{text}");
    }
}
