//! `darrt execute`: a plan in physics.

mod mcap;
mod page;

use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use darrt_core::budget::Cancel;
use darrt_core::observe::Silent;
use darrt_execute::noise::REAL_NOISE;
use darrt_execute::{Departure, Execution, Loop, NoiseModel, Prediction, Replan, Runs, Spread, execute};

use super::{check, plan as planning};
use crate::args::ExecuteOptions;
use crate::bench::machine::cores;
use crate::exit::{Exit, Failure};
use crate::output::{self, Output};
use crate::progress::Bar;
use crate::table;
use darrt_task::plan_file::PlanFile;
use darrt_task::planning::PlanRequest;
use darrt_task::problem_file::ProblemFile;
use darrt_task::program::Program;
use darrt_task::replan::ReplanRequest;
use darrt_task::text::{counted, on_one_line};
use darrt_task::text_file;
use darrt_task::verify::{self, VerifyOptions};

/// Iterations in which another plan is looked for on the way: a clock would make runs depend on the machine.
const REPLAN_ITERATIONS: u64 = 6000;
/// How often a plan is executed when its runs differ.
const NOISY_RUNS: u64 = 100;
/// Largest accepted noise file, bytes.
const MOST_NOISE_BYTES: u64 = 64 * 1024;

/// Executes a plan and tells how often it succeeded, and what went wrong first.
///
/// # Errors
/// [`Exit::NotSolved`] if a run fails; [`Exit::BadInput`] for a plan or noise that cannot be executed.
pub(crate) fn run(program: &dyn Program, options: &ExecuteOptions, output: &mut Output) -> Result<Exit, Failure> {
    let Some(path) = options.plan.as_deref() else {
        output.print(REAL_NOISE)?;
        return Ok(Exit::Solved);
    };
    let noise = noise(&options.noise)?;
    let plan = check::read(program, path)?;
    let name = path.display();
    let refuse = |error: &dyn std::fmt::Display| Failure::input(format!("{name}: {error}"));
    plan.problem.check_files().map_err(|error| refuse(&error))?;
    plan.check_complete()
        .map_err(|flaw| Failure::new(Exit::Refused, on_one_line(&format!("{name}: refused: {flaw}"))))?;
    let robot = program.facts(&plan.problem).map_err(|error| refuse(&error))?;
    // What is tried in physics has been judged, as what goes to a robot.
    verify::verify_with(&plan, &robot, &VerifyOptions::default())
        .map_err(|refusal| Failure::new(Exit::Refused, on_one_line(&format!("{name}: refused: {refusal}"))))?;
    let execution = Execution::new(&plan, &robot).map_err(|error| refuse(&error))?;
    let page_place = options.page.as_deref().map(output::writable_page).transpose()?;
    let mcap_place = options.mcap.as_deref().map(output::writable).transpose()?;
    let read = [("plan", path), ("noise file", Path::new(&options.noise))];
    let written = [("page", &page_place), ("recording", &mcap_place)];
    let written: Vec<_> = written.iter().filter_map(|(what, place)| Some((*what, place.as_deref()?))).collect();
    output::keep_apart(&read, &written)?;
    let prediction = || execution.predict(&noise, options.replan);
    if options.predict {
        let prediction = prediction();
        let objects: Vec<_> = plan.problem.objects.iter().map(|object| object.name.as_str()).collect();
        if options.json {
            output.print(&output::json(&prediction, "the prediction")?)?;
        } else if !options.quiet {
            output.tell(&expected(&prediction, &objects))?;
        }
        return Ok(Exit::Solved);
    }
    let count = options.runs.unwrap_or(if noise.is_none() { 1 } else { NOISY_RUNS });
    let cancel = Cancel::new();
    planning::listen(&cancel);
    let bar = Bar::start(usize::try_from(count).unwrap_or(usize::MAX), "runs", options.quiet);
    let successes = AtomicUsize::new(0);
    let threads = options.threads.unwrap_or_else(cores);
    let replanner = Replanner { program, seed: options.seed, cancel: &cancel };
    let control = if options.replan { Loop::Closed(&replanner) } else { Loop::Open };
    let runs = execute(&execution, &noise, control, (options.seed, count), threads, &cancel, &|report| {
        let so_far = successes.fetch_add(usize::from(report.is_success), Ordering::Relaxed);
        bar.advance(&format!(", {} succeeded", so_far + usize::from(report.is_success)));
    });
    bar.finish();
    if options.json {
        output.print(&json(&runs, &noise, options.seed, count, execution.duration_s(), &prediction())?)?;
    } else if !options.quiet {
        output.tell(&words(&runs, execution.duration_s(), &prediction()))?;
    }
    let shown = runs.runs.iter().find(|run| !run.is_success).or(runs.runs.first());
    if let Some(shown) = shown.filter(|_| page_place.is_some() || mcap_place.is_some())
        && let Some((report, recording)) = execution.record(&noise, (options.seed, shown.run), control, &cancel)
    {
        if let Some(place) = page_place {
            output::write_file(&place, page::file(&plan, &robot, &report, &recording)?.into_bytes())?;
            told(output, options, "page", &place)?;
        }
        if let Some(place) = mcap_place {
            let bytes = mcap::file(&plan, &robot, &recording);
            let bytes =
                bytes.map_err(|error| Failure::new(Exit::CannotWrite, format!("{}: {error}", place.display())))?;
            output::write_file(&place, bytes)?;
            told(output, options, "recording", &place)?;
        }
    }
    if !runs.is_complete {
        let left = counted(count - runs.runs.len() as u64, "run");
        return Err(Failure::new(Exit::Interrupted, format!("{name}: interrupted, {left} left")));
    }
    let failed = runs.runs.len() - runs.successes();
    if failed == 0 {
        return Ok(Exit::Solved);
    }
    let of = counted(count, "run");
    Err(Failure::new(Exit::NotSolved, format!("{name}: executed: {failed} of {of} failed")))
}

/// Says where something was written.
fn told(output: &mut Output, options: &ExecuteOptions, what: &str, place: &Path) -> Result<(), Failure> {
    if options.quiet || options.json { Ok(()) } else { output.print(&format!("{what}: {}", place.display())) }
}

/// The planner, for executions that look where everything is.
struct Replanner<'a> {
    program: &'a dyn Program,
    seed: u64,
    cancel: &'a Cancel,
}

impl Replan for Replanner<'_> {
    fn replan(&self, problem: &ProblemFile, old: &PlanFile) -> Option<PlanFile> {
        let plan = PlanRequest {
            iterations: Some(REPLAN_ITERATIONS),
            time_limit: Some(Duration::MAX),
            ..PlanRequest::new(problem.clone(), self.seed)
        };
        let request = ReplanRequest { plan, from: old.clone(), keep: None };
        self.program.replan(&request, self.cancel, &mut Silent).ok()?.result.plan
    }
}

/// A part of the built-in noise, or a file.
fn noise(text: &str) -> Result<NoiseModel, Failure> {
    let whole = || NoiseModel::real().map_err(|error| Failure::input(error.to_string()));
    match text.parse::<f64>() {
        Ok(part) if (0.0..=1.0).contains(&part) => Ok(whole()?.scaled(part)),
        Ok(part) => Err(Failure::input(format!("--noise is {part}, must be from 0 to 1, or the name of a file"))),
        Err(_) => {
            let read = text_file::read(Path::new(text), MOST_NOISE_BYTES);
            let read = read.map_err(|error| Failure::input(format!("--noise: {error}")))?;
            NoiseModel::from_toml(&read, text).map_err(|error| Failure::input(error.to_string()))
        }
    }
}

fn json(
    runs: &Runs,
    noise: &NoiseModel,
    seed: u64,
    count: u64,
    plan_s: f64,
    prediction: &Prediction,
) -> Result<String, Failure> {
    let value = serde_json::json!({
        "asked": count,
        "complete": runs.is_complete,
        "seed": seed,
        "noise": noise,
        "plan_seconds": plan_s,
        "successes": runs.successes(),
        "within_5_cm": runs.near(),
        "predicted": { "success": prediction.success, "within_5_cm": prediction.within_5_cm },
        "failures": runs.failures(),
        "runs": runs.runs,
    });
    output::json(&value, "the runs")
}

/// What is expected, as a table.
fn expected(prediction: &Prediction, objects: &[&str]) -> String {
    let percent = |part: f64| format!("{:.0} %", 100.0 * part);
    let millimetres = |spread: &Spread| format!("{:.1}", 1000.0 * spread.largest_m());
    let titles = ["step", "primitive", "base (mm)", "hand (mm)", "to hand (mm)", "succeeds"];
    let mut table = table::with_header(
        titles.map(str::to_owned).into_iter().chain(objects.iter().map(|name| format!("{name} (mm)"))),
    );
    for step in &prediction.steps {
        let primitive = if step.looks { format!("look, {}", step.primitive) } else { step.primitive.clone() };
        let against = step.against_hand.as_ref().map(millimetres).unwrap_or_default();
        let cells = [
            step.step.to_string(),
            primitive,
            millimetres(&step.base),
            millimetres(&step.hand),
            against,
            percent(step.success),
        ];
        table.add_row(cells.into_iter().chain(step.objects.iter().map(millimetres)));
    }
    format!(
        "expected: {} within tolerance, {} within 5 cm; standard deviations after every step in their worst direction\n{}",
        percent(prediction.success),
        percent(prediction.within_5_cm),
        table::finished(table, [0]),
    )
}

fn words(runs: &Runs, plan_s: f64, prediction: &Prediction) -> String {
    let all = runs.runs.len();
    let head = format!(
        "executed: {} of {} succeeded, {} within 5 cm (expected {:.0} and {:.0} %); {plan_s:.0} s on the clock of the plan",
        runs.successes(),
        counted(all as u64, "run"),
        runs.near(),
        100.0 * prediction.success,
        100.0 * prediction.within_5_cm,
    );
    let failures = runs.failures();
    if failures.is_empty() {
        return head;
    }
    let mut table = table::with_header(["runs", "step", "primitive", "what went wrong first", "of what"]);
    for failure in &failures {
        table.add_row([
            failure.count.to_string(),
            failure.step.to_string(),
            failure.primitive.clone(),
            failure.cause.words().to_owned(),
            failure.bodies.clone(),
        ]);
    }
    let first = runs.runs.iter().find(|run| !run.is_success);
    let first = first.and_then(|run| Some(format!("\nrun {}: {}", run.run, sentence(run.departure.as_ref()?))));
    format!("{head}\n{}{}", table::finished(table, [0, 1]), first.unwrap_or_default())
}

/// One departure in a sentence.
pub(super) fn sentence(departure: &Departure) -> String {
    let Departure { plan, step, primitive, time, cause, body, other, off_m, lean_deg, force_n } = departure;
    let other = other.as_ref().map_or_else(String::new, |other| format!(" and {other}"));
    let mut numbers = vec![format!("{:.1} mm", off_m * 1000.0), format!("{lean_deg:.1} degrees")];
    if *force_n > 0.0 {
        numbers.push(format!("{force_n:.0} N"));
    }
    let (percent, numbers) = (time * 100.0, numbers.join(", "));
    let plan = if *plan == 0 { String::new() } else { format!("plan {plan}, ") };
    format!("{plan}step {step} ({primitive}) at {percent:.0} %: {body}{other}: {}: {numbers}", cause.words())
}
