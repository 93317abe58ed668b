//! Options of `darrt show`.

use std::path::PathBuf;

use clap::Args;

use super::any_count;

/// Options of `darrt show`.
#[derive(Debug, Args)]
pub struct ShowOptions {
    /// Name of a built-in problem or robot, a problem file, a robot file, a plan file (.json), or a recorded search (.json)
    pub source: String,
    /// Write the picture here: .html (3-D, moving), .svg, .png or .glb; a recorded search: .html, .graphml or .dot
    /// [default: PROBLEM.html in the current folder]
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Leave out the small view of every step
    #[arg(long)]
    pub overview: bool,
    /// Of a plan: an .svg picture that moves, from above and from the right
    #[arg(long, conflicts_with = "overview")]
    pub moving: bool,
    /// Of a recorded search, show this attempt only
    #[arg(long, value_name = "NUMBER", value_parser = any_count, allow_hyphen_values = true)]
    pub attempt: Option<u64>,
    /// Of a recorded search, show the trees as they were behind this iteration of each attempt
    #[arg(long, value_name = "NUMBER", value_parser = any_count, allow_hyphen_values = true)]
    pub iteration: Option<u64>,
    /// Open the page in the browser
    #[arg(long)]
    pub open: bool,
}
