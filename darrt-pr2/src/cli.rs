//! The command line of the program `darrt`.
//!
//! Results go to the standard output, progress and errors to the standard error. Every command ends in one [`Exit`].
//!
//! | question | file |
//! |---|---|
//! | which commands and options are there? | [`args`], [`choices`], [`safety`] |
//! | how did it end? | [`exit`] |
//! | how are texts and files written? | `output`, `drawing` |
//! | what does each command do? | `plan`, `check`, `problems`, `show`, `schema`, `bench`, `generate` |
//! | what is seen while it works? | `progress` |
//! | how are a plan and the planner's counts told? | `steps`, `statistics`, `diagnosis`, `table`, `bench_table` |

pub mod args;
mod bench;
mod bench_table;
mod check;
pub mod choices;
mod diagnosis;
mod drawing;
pub mod exit;
mod generate;
mod output;
mod plan;
mod problems;
mod progress;
pub mod safety;
mod schema;
mod show;
mod statistics;
mod steps;
mod table;

use std::ffi::OsString;
use std::io::Write as _;
use std::process::ExitCode;

use clap::Parser as _;

use args::{Arguments, Command};
pub use exit::{Exit, Failure};
use output::Output;

use crate::words::printable;

/// Runs the program with these arguments, the program's name first, and says how it ended.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let command = match Arguments::try_parse_from(arguments) {
        Ok(parsed) => parsed.command,
        Err(error) => {
            // Help and version count as success; a reader that went away is no reason to complain.
            let _ = error.print();
            return if error.use_stderr() { Exit::BadInput } else { Exit::Solved }.into();
        }
    };
    match dispatch(&command) {
        Ok(exit) => exit.into(),
        Err(failure) => {
            let _ = writeln!(std::io::stderr().lock(), "error: {}", printable(&failure.message));
            failure.exit.into()
        }
    }
}

fn dispatch(command: &Command) -> Result<Exit, Failure> {
    let mut output = Output::stdout();
    match command {
        Command::Plan(options) => plan::run(options, &mut output),
        Command::Check(options) => check::run(options, &mut output),
        Command::Problems(options) => problems::run(options, &mut output),
        Command::Show(options) => show::run(options, &mut output),
        Command::Schema(options) => schema::run(options, &mut output),
        Command::Generate(options) => generate::run(options, &mut output),
        Command::Bench(options) => bench::run(options, &mut output),
    }
}
