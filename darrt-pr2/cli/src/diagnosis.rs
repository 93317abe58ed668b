//! Says in words why no plan was found.

use std::time::Duration;

use darrt_core::budget::Stop;
use darrt_core::observe::accounts::{Accounts, Bucket};
use darrt_primitives::collision_scene::NearPair;

use darrt_task::diagnosis::cause::Cause;
use darrt_task::diagnosis::{Diagnosis, Outcome};
use darrt_task::planning::PlanResult;
use darrt_task::text::counted;

pub(crate) mod text;

/// Pairs of bodies that are named.
const PAIRS: usize = 3;
/// Lines in all, the first one and the advice among them; one more says where to see it.
const LINES: usize = 9;

/// Buckets of extensions in which a primitive was not even tried.
const UNTRIED: [Bucket; 3] = [Bucket::NotUseful, Bucket::NotChosen, Bucket::Budget];

/// What ended the search, and when.
pub(crate) fn headline(result: &PlanResult) -> String {
    format!("{} after {}, {}", result.stop, seconds(result.elapsed), counted(result.iterations, "iteration"))
}

/// At most nine lines: what ended the search, what keeps a plan away, and what may help.
pub(crate) fn explain(result: &PlanResult, diagnosis: &Diagnosis) -> String {
    let first = headline(result);
    let mut lines: Vec<_> = diagnosis.causes.iter().flat_map(text::of_cause).collect();
    lines.extend(nearer(result));
    let last = advice(result, diagnosis);
    let room = LINES - 1 - last.len() - usize::from(result.partial.is_some());
    if lines.len() > room {
        let more = lines.len() - (room - 1);
        lines.truncate(room - 1);
        lines.push(format!("and {more} more, with --stats or --why"));
    }
    std::iter::once(first).chain(lines).chain(last).collect::<Vec<_>>().join("\n  ")
}

/// All causes, however many, and what the search itself met: what is printed for `--stats`.
pub(crate) fn details(result: &PlanResult, diagnosis: &Diagnosis) -> String {
    let mut lines = vec!["what keeps a plan away, and what the search met:".to_owned()];
    lines.extend(diagnosis.causes.iter().flat_map(text::of_cause));
    lines.extend(result.doubts.iter().map(|doubt| format!("before the search: {doubt}")));
    lines.extend(what_was_met(result));
    lines.join("\n  ")
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
    lines.extend(nearer(result));
    lines.extend(never_worked(&result.accounts));
    lines
}

/// What the problem itself puts nearer to each other than the margin.
fn nearer(result: &PlanResult) -> impl Iterator<Item = String> + '_ {
    result.near.iter().map(|NearPair { bodies: [first, second], distance_m, is_at_goal }| {
        let place = if *is_at_goal { "at the goal" } else { "at the start" };
        let apart_mm = distance_m * 1000.0;
        format!("nearer than the least margin {place}: {first} and {second}, {apart_mm:.2} mm apart")
    })
}

/// With as many digits as a short time needs.
pub(crate) fn seconds(time: Duration) -> String {
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

/// What may help: more time only where nothing was found that keeps a plan away.
pub(crate) fn advice(result: &PlanResult, diagnosis: &Diagnosis) -> Vec<String> {
    let limit = match result.stop {
        Stop::TimeLimit => "a longer --time-limit",
        Stop::IterationLimit => "more --iterations",
        Stop::NodeLimit => "a higher `budget.nodes` in the problem",
        _ => return Vec::new(),
    };
    let progress = diagnosis.nearest_to_goal_m.map_or_else(String::new, |metres| {
        format!(" (nearest so far: {metres:.2} m to move, in {})", counted(result.nodes as u64, "state"))
    });
    let remedies: Vec<_> = diagnosis.remedies.iter().map(text::of_relaxation).collect();
    let is_steered = diagnosis.causes.iter().any(|cause| matches!(cause, Cause::Steered { .. }));
    let is_doubted = diagnosis.causes.iter().any(|cause| matches!(cause, Cause::Doubted { .. }));
    let nothing = match (is_steered, is_doubted) {
        (true, _) => "beside the rules of `steer` nothing",
        (false, true) => "beside what is doubted nothing",
        (false, false) => "nothing",
    };
    if diagnosis.is_cut_short {
        let why =
            "what keeps a plan away was not found out in as long as the search took; `darrt explain` takes its time";
        return vec![format!("{why}, and {limit} may help{progress}")];
    }
    let by_itself = if is_doubted { "" } else { ": each object can be taken and brought to its goal by itself" };
    let or_allow = if is_steered { ", or to allow more in `steer`," } else { "" };
    let would_help = format!("it would help, as far as a few tries tell: {}", remedies.join("; or "));
    let mut lines: Vec<_> = (!remedies.is_empty()).then_some(would_help).into_iter().collect();
    lines.push(match diagnosis.outcome {
        Outcome::Hopeless => {
            "more time or another seed will hardly help; `darrt explain` looks for changes that make a plan".to_owned()
        }
        Outcome::TooShort => format!(
            "{nothing} was found that keeps a plan away, and {} say nothing{progress}: {limit} will help",
            counted(result.iterations, "iteration")
        ),
        Outcome::MayBeFound => format!(
            "{nothing} was found that keeps a plan away{by_itself}{progress}. Another --seed, {limit} or a --restart{or_allow} may help"
        ),
    });
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    fn result(iterations: u64) -> PlanResult {
        let mut accounts = Accounts::new(vec!["Pick", "Push", "Place"]);
        for _ in 0..3 {
            accounts.count(&[Bucket::Unreachable, Bucket::Accepted, Bucket::NotUseful], 1, false, None);
        }
        accounts.count(&[Bucket::NoGrasp, Bucket::Accepted, Bucket::NotUseful], 1, false, None);
        PlanResult {
            proof: None,
            no_clock: None,
            execution_s: None,
            found: None,
            plan: None,
            plans: 0,
            near: Vec::new(),
            doubts: vec![darrt_task::planning::Doubt { words: "no way".to_owned(), refuted: None }],
            stop: Stop::TimeLimit,
            accounts,
            iterations,
            nodes: 9,
            restarts: 0,
            nearest_to_goal: 1.25,
            elapsed: Duration::from_millis(1500),
            times: darrt_task::profile::Times::default(),
            last_refusal: None,
            partial: None,
            nearest: None,
            recording: None,
        }
    }

    fn diagnosis(causes: Vec<Cause>, outcome: Outcome) -> Diagnosis {
        Diagnosis {
            problem: "p".to_owned(),
            ended: darrt_task::diagnosis::Ended::TimeLimit,
            iterations: 40,
            causes,
            remedies: Vec::new(),
            outcome,
            is_cut_short: false,
            nearest_to_goal_m: Some(1.25),
        }
    }

    fn refused(n: usize) -> Vec<Cause> {
        (0..n).map(|i| Cause::Refused { reason: format!("reason {i}") }).collect()
    }

    #[test]
    fn more_time_is_advised_only_where_nothing_was_found() {
        let result = result(40);
        let text = explain(&result, &diagnosis(Vec::new(), Outcome::MayBeFound));
        assert!(text.starts_with("time limit reached after 1.5 s, 40 iterations"), "{text}");
        assert!(text.contains("a longer --time-limit"), "{text}");
        let text = explain(&result, &diagnosis(refused(1), Outcome::Hopeless));
        assert!(text.contains("reason 0") && !text.contains("--time-limit"), "{text}");
    }

    #[test]
    fn there_are_never_more_than_nine_lines_and_one_for_the_page() {
        for n in [1, 7, 8, 40] {
            let text = explain(&result(40), &diagnosis(refused(n), Outcome::MayBeFound));
            assert!(text.lines().count() <= 9, "{text}");
            assert_eq!(text.contains("more, with --stats"), n > 7, "{text}");
        }
    }

    #[test]
    fn the_details_name_distance_and_the_primitive_that_failed() {
        let text = details(&result(40), &diagnosis(refused(12), Outcome::MayBeFound));
        for words in [
            "reason 11",
            "before the search: no way",
            "nearest to the goal: 1.250 m",
            "Pick never succeeded in 4 tries, mostly: unreachable (3)",
            "Place was never tried",
        ] {
            assert!(text.contains(words), "{words}: {text}");
        }
        assert!(!text.contains("Push"));
    }
}
