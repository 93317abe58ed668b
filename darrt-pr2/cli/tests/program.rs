//! The program, run in a folder: what all tests of the command line share.
#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

use std::path::Path;
use std::process::{Command, Output};

pub(crate) fn darrt(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_darrt")).current_dir(folder).args(arguments).output().unwrap()
}

pub(crate) fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// Runs, expects this exit code, returns what was printed and what was complained about.
pub(crate) fn run(folder: &Path, arguments: &[&str], expected: i32) -> (String, String) {
    let output = darrt(folder, arguments);
    let (printed, complaint) = (text(&output.stdout), text(&output.stderr));
    assert_eq!(output.status.code(), Some(expected), "{arguments:?}: {printed}{complaint}");
    assert!(!complaint.contains("panicked"), "{complaint}");
    (printed, complaint)
}
