//! The command line.

use std::ffi::OsString;
use std::process::ExitCode;

/// Runs the program with these arguments, the program's name first, and says how it ended.
pub fn run(_arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    ExitCode::FAILURE
}
