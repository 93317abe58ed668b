//! `darrt generate`: problems like a given one.

use std::sync::{Mutex, mpsc};

use darrt_core::budget::Cancel;

use super::plan;
use crate::args::GenerateOptions;
use crate::bench::machine::cores;
use crate::exit::{Exit, Failure};
use crate::generate::{GenerateError, generate};
use crate::output::{self, Output};
use crate::progress::Bar;
use darrt_task::problem_file::ProblemFile;
use darrt_task::program::Program;
use darrt_task::text::counted;

/// Prints one problem, or writes many.
///
/// # Errors
/// A problem that cannot be read, a family of which the planner solves none, files that cannot be written.
pub(crate) fn run(program: &dyn Program, options: &GenerateOptions, output: &mut Output) -> Result<Exit, Failure> {
    // One problem is printed as it is, without a word before it.
    let is_quiet = options.quiet || options.into.is_none();
    let mut base = plan::opened(program, (&options.problem, options.robot.as_ref()), is_quiet, output)?;
    if let Some(file) = &mut base.robot.file {
        // The problems are written elsewhere.
        *file = std::path::absolute(&*file).unwrap_or_else(|_| file.clone());
    }
    let count = options.seeds.end - options.seeds.start;
    let cancel = Cancel::new();
    plan::listen(&cancel);
    let Some(folder) = &options.into else {
        if count > 1 {
            return Err(Failure::input(format!(
                "{count} problems cannot be printed as one: say where with --into FOLDER"
            )));
        }
        let problem = generate(program, &base, options.seeds.start, &cancel)?;
        output.print(&text(&problem)?)?;
        return Ok(Exit::Solved);
    };
    std::fs::create_dir_all(folder)
        .map_err(|error| Failure::new(Exit::CannotWrite, format!("{}: cannot be made: {error}", folder.display())))?;
    let bar = Bar::start(usize::try_from(count).unwrap_or(usize::MAX), "problems", options.quiet);
    let mut written = 0;
    each(program, options, &base, &cancel, |problem| {
        let path = folder.join(format!("{}.toml", output::file_stem(&problem.name)));
        output::write_file(&output::writable_problem(&path)?, &text(&problem)?)?;
        written += 1;
        bar.advance("");
        Ok(())
    })?;
    bar.finish();
    if !options.quiet {
        output.print(&format!("{}: {}", folder.display(), counted(written, "problem")))?;
    }
    Ok(Exit::Solved)
}

/// Generates on several threads and hands over what is done; the first error ends all.
fn each(
    program: &dyn Program,
    options: &GenerateOptions,
    base: &ProblemFile,
    cancel: &Cancel,
    mut sink: impl FnMut(ProblemFile) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let seeds = Mutex::new(options.seeds.clone());
    let take = || seeds.lock().ok().and_then(|mut seeds| seeds.next());
    std::thread::scope(|scope| {
        let (sender, receiver) = mpsc::channel::<Result<ProblemFile, GenerateError>>();
        for _ in 0..options.jobs.unwrap_or_else(cores) {
            let sender = sender.clone();
            scope.spawn(move || {
                while let Some(seed) = take() {
                    let problem = generate(program, base, seed, cancel);
                    let goes_on = problem.is_ok();
                    if sender.send(problem).is_err() || !goes_on {
                        return;
                    }
                }
            });
        }
        drop(sender);
        let mut result = Ok(());
        for outcome in receiver {
            let kept = outcome.map_err(Failure::from).and_then(&mut sink);
            if result.is_ok() && kept.is_err() {
                cancel.cancel();
                result = kept;
            }
        }
        result
    })
}

fn text(problem: &ProblemFile) -> Result<String, Failure> {
    problem.to_toml().map_err(|error| Failure::input(format!("{}: cannot be written as TOML: {error}", problem.name)))
}
