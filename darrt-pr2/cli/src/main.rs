//! The program `darrt`: the PR2, the paper's primitives and problems.

use std::process::ExitCode;

use darrt_task::program::Robots;

fn main() -> ExitCode {
    darrt_cli::main_with(&Robots::new(darrt_pr2::registry()))
}
