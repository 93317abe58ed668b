//! The command line of the program `darrt`, for any robot and any primitives.
//!
//! Results go to the standard output, progress and errors to the standard error. Every command ends in one [`Exit`].
//!
//! A program of your own, with all commands for your primitives:
//! ```no_run
//! fn main() -> std::process::ExitCode {
//!     let registry = darrt_pr2::registry(); // .with_primitive::<Yours>()
//!     darrt_cli::main_with(&registry)
//! }
//! ```
//!
//! | question | file |
//! |---|---|
//! | which commands and options are there? | [`args`], [`choices`], [`safety`] |
//! | what does each command do? | `command` |
//! | how did it end? | [`exit`] |
//! | how are texts and files written? | `output`, `drawing`, `why_page` |
//! | how does a browser open them? | `browser` |
//! | what is seen while it works? | `progress` |
//! | how are a plan and the planner's counts told? | `steps`, `statistics`, `diagnosis`, `table` |
//! | how well does it plan? | [`mod@bench`], [`mod@generate`] |

pub mod args;
pub mod bench;
mod browser;
pub mod choices;
mod command;
mod diagnosis;
mod drawing;
pub mod exit;
pub mod generate;
mod output;
mod progress;
pub mod safety;
mod statistics;
mod steps;
mod table;
mod why_page;

use std::ffi::OsString;
use std::io::Write as _;
use std::process::ExitCode;

use clap::Parser as _;

use args::{Arguments, Command};
pub use exit::{Exit, Failure};
use output::Output;

use darrt_task::program::Program;
use darrt_task::text::printable;

/// Runs the program with the arguments that it was started with.
pub fn main_with(program: &dyn Program) -> ExitCode {
    run(program, std::env::args_os())
}

/// Runs the program with these arguments, the program's name first, and says how it ended.
pub fn run(program: &dyn Program, arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let command = match Arguments::try_parse_from(arguments) {
        Ok(parsed) => parsed.command,
        Err(error) => {
            // Help and version count as success; a reader that went away is no reason to complain.
            let _ = error.print();
            return if error.use_stderr() { Exit::BadInput } else { Exit::Solved }.into();
        }
    };
    match dispatch(program, &command) {
        Ok(exit) => exit.into(),
        Err(failure) => {
            let _ = writeln!(std::io::stderr().lock(), "error: {}", printable(&failure.message));
            failure.exit.into()
        }
    }
}

fn dispatch(program: &dyn Program, command: &Command) -> Result<Exit, Failure> {
    use crate::command::{
        bench, check, execute, explain, export, generate, plan, problems, robot, schema, show, why_not,
    };
    let mut output = Output::stdout();
    match command {
        Command::Plan(options) => plan::run(program, options, &mut output),
        Command::Explain(options) => explain::run(program, options, &mut output),
        Command::WhyNot(options) => why_not::run(program, options, &mut output),
        Command::Check(options) => check::run(program, options, &mut output),
        Command::Execute(options) => execute::run(program, options, &mut output),
        Command::Problems(options) => problems::run(program, options, &mut output),
        Command::Show(options) => show::run(program, options, &mut output),
        Command::Export(options) => export::run(program, options, &mut output),
        Command::Robot(options) => robot::run(program, options, &mut output),
        Command::Schema(options) => schema::run(options, &mut output),
        Command::Generate(options) => generate::run(program, options, &mut output),
        Command::Bench(options) => bench::run(program, options, &mut output),
    }
}
