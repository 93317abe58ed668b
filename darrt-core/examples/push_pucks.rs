//! Pushes a puck through a gap in a wall and prints what the robot does.
//!
//! `cargo run -p darrt-core --example push_pucks --features testing [seed]`

#![allow(clippy::print_stdout, reason = "an example shows its result")]

use darrt_core::budget::Budget;
use darrt_core::error::Error;
use darrt_core::observe::Silent;
use darrt_core::solve::{Outcome, SolveOptions, solve};
use darrt_core::testing::puck::{PuckWorld, paper_strategy, problems};

fn main() -> Result<(), Error> {
    let seed = std::env::args().nth(1).and_then(|word| word.parse().ok()).unwrap_or(0);
    let problem = problems::wall_with_gap()?;
    let options = SolveOptions {
        seed,
        budget: Budget { iterations: Some(10_000), ..Budget::default() },
        restart_iterations: Some(200),
        ..SolveOptions::default()
    };
    let outcome = solve(&problem, &paper_strategy()?, &options, &mut Silent);
    print_plan(problem.domain(), &outcome);
    print_accounts(&outcome);
    Ok(())
}

fn print_plan(m: &PuckWorld, outcome: &Outcome<PuckWorld>) {
    let Outcome { stop, iterations, nodes, restarts, .. } = outcome;
    println!("{stop} after {iterations} iterations, {restarts} restarts; {nodes} nodes in the largest tree");
    let Some(solution) = &outcome.solution else { return };
    let plan = solution.plan();
    println!("{} steps, {:.2} m of travel:", plan.steps().len(), plan.length());
    for (i, step) in plan.steps().iter().enumerate() {
        let (Some(from), Some(to)) = (plan.at(m, i, 0.0), plan.at(m, i, 1.0)) else { continue };
        let primitive = step.instance.primitive;
        let puck = step.instance.object.and_then(|id| m.puck(id)).map_or("", |p| &p.name);
        let ([x, y], [u, v]) = (from.robot, to.robot);
        println!("{:3}. {primitive:8} {puck:6} robot ({x:.2}, {y:.2}) -> ({u:.2}, {v:.2})", i + 1);
    }
}

fn print_accounts(outcome: &Outcome<PuckWorld>) {
    let accounts = &outcome.accounts;
    println!("{} extensions, {} of them met their target", accounts.extensions, accounts.met);
    for ((first, second), n) in accounts.worst_blocks(3) {
        println!("  {n} were stopped by {first} against {second}");
    }
}
