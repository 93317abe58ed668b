//! The program `darrt`: the PR2, the paper's primitives and problems.

use std::process::ExitCode;

fn main() -> ExitCode {
    darrt_cli::main_with(&darrt_pr2::registry())
}
