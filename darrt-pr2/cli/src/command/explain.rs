//! `darrt explain`: what would make a plan.

use std::time::Duration;

use darrt_core::budget::Cancel;

use super::plan::listen;
use crate::args::ExplainOptions;
use crate::diagnosis;
use crate::exit::{Exit, Failure};
use crate::output::{self, Output};
use darrt_task::diagnosis::explain::{ExplainRequest, Explanation};
use darrt_task::planning::PlanRequest;
use darrt_task::program::Program;
use darrt_task::text::{counted, on_one_line};

/// Plans changed problems, and tells which of them have a plan.
///
/// # Errors
/// A problem that cannot be read, or an output that cannot be written.
pub(crate) fn run(program: &dyn Program, options: &ExplainOptions, output: &mut Output) -> Result<Exit, Failure> {
    let problem = program.open(&options.problem)?;
    let request = ExplainRequest {
        plan: PlanRequest::new(problem, options.seed),
        iterations: options.iterations,
        threads: options.threads.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from)),
    };
    let cancel = Cancel::new();
    listen(&cancel);
    let explanation = program
        .explain(&request, &cancel)
        .map_err(|error| Failure::new(Exit::from(&error), on_one_line(&format!("{}: {error}", options.problem))))?;
    if options.json {
        output.print(&output::json(&explanation, "the explanation")?)?;
    } else {
        output.tell(&words(&explanation))?;
    }
    Ok(match () {
        () if explanation.is_interrupted => Exit::Interrupted,
        () if explanation.solved.is_empty() && explanation.solved_as_it_is.is_none() => Exit::NotSolved,
        () => Exit::Solved,
    })
}

fn words(explanation: &Explanation) -> String {
    let Explanation { problem, iterations, solved_as_it_is, solved, tried, is_interrupted, .. } = explanation;
    let mut lines = Vec::new();
    if let Some(count) = solved_as_it_is {
        lines.push(format!("{problem}: has a plan as it is, found in {}", counted(*count, "iteration")));
    } else {
        match &explanation.refused {
            Some(why) => lines.push(format!("{problem}: refused as it is: {why}")),
            None => lines.push(format!("{problem}: no plan in {}", counted(*iterations, "iteration"))),
        }
        lines.extend(explanation.causes.iter().flat_map(diagnosis::text::of_cause));
        let found = if solved.is_empty() { "none of them has a plan" } else { "with a plan:" };
        lines.push(format!("{} planned, {found}", counted(*tried, "problem")));
    }
    for found in solved {
        let changes: Vec<_> = found.changes.iter().map(diagnosis::text::of_relaxation).collect();
        let time = Duration::from_secs_f64(found.seconds.max(0.0)).as_secs_f64();
        let (iterations, steps) = (counted(found.iterations, "iteration"), counted(found.steps, "step"));
        lines.push(format!("{}: solved and verified in {time:.2} s, {iterations}, {steps}", changes.join(" and ")));
    }
    if *is_interrupted {
        lines.push("interrupted: not all were tried".to_owned());
    }
    lines.join("\n  ")
}
