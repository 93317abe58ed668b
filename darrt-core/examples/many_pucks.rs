//! How the effort grows with the number of objects.
//!
//! `cargo run --release -p darrt-core --example many_pucks --features testing [seeds]`

#![allow(clippy::print_stdout, reason = "an example shows its result")]

use darrt_core::budget::Budget;
use darrt_core::error::Error;
use darrt_core::observe::Silent;
use darrt_core::problem::Problem;
use darrt_core::search::Strategy;
use darrt_core::solve::{SolveOptions, solve};
use darrt_core::testing::puck::{PuckWorld, paper_strategy, problems};

/// Iterations of one run, and of one attempt.
const ITERATIONS: u64 = 10_000;
const RESTART: u64 = 200;

fn main() -> Result<(), Error> {
    let seeds = std::env::args().nth(1).and_then(|word| word.parse().ok()).unwrap_or(31);
    let strategy = paper_strategy()?;
    println!("medians over seeds 0 to {}, of the solved runs; a run may use {ITERATIONS} iterations,", seeds - 1);
    println!("an attempt {RESTART}\n");
    println!("| pucks | to be moved | solved | iterations | worst | nodes | steps | travel (m) | time (ms) |");
    println!("|---|---|---|---|---|---|---|---|---|");
    for (count, moved) in (1..=8).map(|n| (n, n)).chain((2..=8).map(|n| (n, 2))) {
        let problem = problems::many_pucks(count, moved)?;
        let runs: Vec<Run> = (0..seeds).filter_map(|seed| run(&problem, &strategy, seed)).collect();
        let median = |number: fn(&Run) -> f64| {
            let mut numbers: Vec<f64> = runs.iter().map(number).collect();
            numbers.sort_by(f64::total_cmp);
            numbers.get(numbers.len() / 2).copied().unwrap_or(f64::NAN)
        };
        let worst = runs.iter().map(|run| run.iterations).fold(0.0, f64::max);
        println!(
            "| {count} | {moved} | {}/{seeds} | {} | {worst} | {} | {} | {:.1} | {:.2} |",
            runs.len(),
            median(|run| run.iterations),
            median(|run| run.nodes),
            median(|run| run.steps),
            median(|run| run.travel_m),
            median(|run| run.time_s) * 1e3,
        );
    }
    Ok(())
}

struct Run {
    iterations: f64,
    nodes: f64,
    steps: f64,
    travel_m: f64,
    time_s: f64,
}

/// `None` if the budget was not enough.
#[allow(clippy::cast_precision_loss, reason = "counts far below 2^52")]
fn run(problem: &Problem<PuckWorld>, strategy: &Strategy<PuckWorld>, seed: u64) -> Option<Run> {
    let budget = Budget { iterations: Some(ITERATIONS), ..Budget::default() };
    let options = SolveOptions { seed, budget, restart_iterations: Some(RESTART), ..SolveOptions::default() };
    let outcome = solve(problem, strategy, &options, &mut Silent);
    let plan = outcome.solution.as_ref()?.plan();
    Some(Run {
        iterations: outcome.iterations as f64,
        nodes: outcome.nodes as f64,
        steps: plan.steps().len() as f64,
        travel_m: plan.length(),
        time_s: outcome.elapsed.as_secs_f64(),
    })
}
