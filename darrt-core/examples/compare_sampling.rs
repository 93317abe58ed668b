//! How many iterations each way of sampling needs, on several seeds (paper section 4.2 and figure 3).
//!
//! `cargo run -p darrt-core --example compare_sampling --features testing [seeds]`

#![allow(clippy::print_stdout, reason = "an example shows its result")]

use darrt_core::budget::Budget;
use darrt_core::distance::GreedyVisit;
use darrt_core::error::Error;
use darrt_core::observe::Silent;
use darrt_core::problem::Problem;
use darrt_core::sample::{Full, GoalBiased, RandomSubset, RobotOrObjects, Sampler};
use darrt_core::search::Strategy;
use darrt_core::solve::{SolveOptions, solve};
use darrt_core::testing::puck::{PuckWorld, problems};

const ITERATIONS: u64 = 2000;

fn main() -> Result<(), Error> {
    let seeds = std::env::args().nth(1).and_then(|word| word.parse().ok()).unwrap_or(20);
    println!("{:14} {:18} {:>7} {:>8} {:>8}", "problem", "sampling", "solved", "median", "worst");
    for (name, make) in problems::ALL {
        let problem = make()?;
        for sampling in ["full", "random subset", "robot or objects"] {
            let strategy = Strategy::new(GoalBiased::new(sampler(sampling)?, 0.2)?, GreedyVisit);
            let mut needed: Vec<u64> = (0..seeds).filter_map(|seed| iterations(&problem, &strategy, seed)).collect();
            needed.sort_unstable();
            let number = |n: Option<&u64>| n.map_or("-".to_owned(), u64::to_string);
            let (median, worst) = (number(needed.get(needed.len() / 2)), number(needed.last()));
            println!("{name:14} {sampling:18} {:3}/{seeds:3} {median:>8} {worst:>8}", needed.len());
        }
    }
    println!("median and worst are over the solved runs; each may use {ITERATIONS} iterations, restarting every 200");
    Ok(())
}

fn sampler(name: &str) -> Result<Box<dyn Sampler<PuckWorld>>, Error> {
    Ok(match name {
        "full" => Box::new(Full),
        "random subset" => Box::new(RandomSubset),
        _ => Box::new(RobotOrObjects::new(0.5, 0.0)?),
    })
}

/// Iterations until solved; `None` if the budget was not enough.
fn iterations(problem: &Problem<PuckWorld>, strategy: &Strategy<PuckWorld>, seed: u64) -> Option<u64> {
    let options = SolveOptions {
        seed,
        budget: Budget { iterations: Some(ITERATIONS), ..Budget::default() },
        restart_iterations: Some(200),
        ..SolveOptions::default()
    };
    let outcome = solve(problem, strategy, &options, &mut Silent);
    outcome.solution.is_some().then_some(outcome.iterations)
}
