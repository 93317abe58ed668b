//! The program `darrt`; see [`darrt_pr2::cli`].

use std::process::ExitCode;

fn main() -> ExitCode {
    darrt_pr2::cli::run(std::env::args_os())
}
