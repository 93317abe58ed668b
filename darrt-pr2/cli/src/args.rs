//! Commands and options.

use std::ops::Range;
use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, Parser, Subcommand, ValueEnum};

use super::choices::{ImproveChoice, SearchChoice};
use super::safety::SafetyOptions;
use crate::bench::Shard;

mod help;
mod robot;
mod show;
mod why_not;

pub use robot::{RobotCheckOptions, RobotCommand, RobotListOptions, RobotNewOptions, RobotOptions};
pub use show::ShowOptions;
pub use why_not::WhyNotOptions;

/// Most attempts at the same time.
const MOST_THREADS: u64 = 256;

/// Plan how a PR2 pushes, grasps, carries and places things.
///
/// DARRT searches a tree of states whose edges are whole actions (primitives): driving, moving the arm, pushing,
/// picking, carrying, placing. The plan is checked by a separate verifier, printed as a table, saved as JSON, and drawn.
#[derive(Debug, Parser)]
#[command(name = "darrt", version, after_help = help::EXAMPLES, propagate_version = true, max_term_width = 80)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Solve a problem: print the steps, write the plan and a picture
    Plan(PlanOptions),
    /// Find out with which changes a problem has a plan
    Explain(ExplainOptions),
    /// Look at a state, a place of the hand, a grasp or a plan that you have in mind: what is wrong first, and what works nearby
    WhyNot(WhyNotOptions),
    /// Judge a plan file with the verifier
    Check(CheckOptions),
    /// Execute a plan in physics: free objects, fingers of limited force, errors of perception and motion
    Execute(ExecuteOptions),
    /// List the built-in problems, or print one to copy and edit
    Problems(ProblemsOptions),
    /// Draw a problem or a plan
    Show(ShowOptions),
    /// Write a plan on its clock for controllers and other programs: joint trajectories, tables, recordings
    Export(ExportOptions),
    /// Robots that come as files: list those inside, check one, or begin one for a description
    Robot(RobotOptions),
    /// Print the JSON Schema of problem files, plan files or robot files
    Schema(SchemaOptions),
    /// Make problems like a given one: places, sizes and heights drawn at random
    Generate(GenerateOptions),
    /// Run problems x variants x seeds and tell the times, as a table, a page and logs
    Bench(BenchOptions),
}

/// Options of `darrt plan`.
#[derive(Debug, Args)]
#[command(after_help = help::PLAN_EXAMPLES)]
#[expect(clippy::struct_excessive_bools, reason = "flags of the command line")]
pub struct PlanOptions {
    /// Name of a built-in problem, or a problem file
    pub problem: String,
    /// Plan for this robot instead of the problem's: a robot file, or a name of `darrt robot list`
    #[arg(long, value_name = "FILE|NAME")]
    pub robot: Option<String>,
    /// Seed of every random choice
    #[arg(long, default_value_t = 0, value_name = "NUMBER", value_parser = any_count, allow_hyphen_values = true)]
    pub seed: u64,
    /// Stop after this many seconds [default: as the problem says]
    #[arg(long, value_name = "SECONDS", value_parser = seconds, allow_hyphen_values = true)]
    pub time_limit: Option<Duration>,
    /// Stop after this many iterations, all attempts together [default: as the problem says]
    #[arg(long, value_name = "NUMBER", value_parser = positive, allow_hyphen_values = true)]
    pub iterations: Option<u64>,
    /// Start over with an empty tree after this many iterations [default: as the problem says]
    #[arg(long, value_name = "ITERATIONS", value_parser = positive, allow_hyphen_values = true)]
    pub restart: Option<u64>,
    /// What a sample specifies: robot-or-objects, random-subset, full, or another one that this program knows [default: as
    /// the problem says]
    #[arg(long, value_name = "NAME")]
    pub sampler: Option<String>,
    /// What makes a state of the tree the nearest one: greedy, euclidean, exact-tour, or another one that this program knows
    /// [default: as the problem says]
    #[arg(long, value_name = "NAME")]
    pub distance: Option<String>,
    /// What improving a plan saves: execution-time, success (a robot that does not look again, with errors after every drive),
    /// or another cost that this program knows [default: execution-time]
    #[arg(long, value_name = "NAME", conflicts_with = "no_improve")]
    pub cost: Option<String>,
    /// Which search; the attempts of `portfolio` take all of them in turn
    #[arg(long, value_enum, default_value_t = SearchChoice::Darrt)]
    pub search: SearchChoice,
    /// Plan anew until the limit, and keep the plan with the fewest steps, the shortest travel or the most clearance
    #[arg(long, value_enum, value_name = "COST")]
    pub improve: Option<ImproveChoice>,
    /// Leave plans as they are found: not fewer steps, nearer stops and shorter ways
    #[arg(long)]
    pub no_improve: bool,
    /// Attempts that run at the same time, 1 to 256; helps only with restarts
    #[arg(long, default_value_t = 1, value_name = "NUMBER", value_parser = threads, allow_hyphen_values = true)]
    pub threads: usize,
    /// Write the plan here, `-` for the standard output and nothing else there [default: PROBLEM.plan.json in the current
    /// folder, without the problem's own ending]
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Write the picture here: .html (3-D, moving), .svg, .png or .glb [default: beside the plan, .html]. Where there is no
    /// plan, a page that ends in .why.html tells why
    #[arg(long, value_name = "FILE", conflicts_with = "no_picture")]
    pub picture: Option<PathBuf>,
    /// Write no picture
    #[arg(long)]
    pub no_picture: bool,
    /// Print where the attempts of every primitive ended, and which bodies were in the way
    #[arg(long)]
    pub stats: bool,
    /// Begin with this plan, for the same problem or for one much like it: its first steps that are still right are kept
    #[arg(long, value_name = "PLAN")]
    pub from: Option<PathBuf>,
    /// Keep so many of its first steps, not as many as can be, and plan on from there; the hand must be free behind them [`--at` is
    /// the same]
    #[arg(long, value_name = "STEPS", requires = "from", visible_alias = "at", value_parser = any_count, allow_hyphen_values = true)]
    pub keep: Option<u64>,
    /// Where there is no plan, write down why as JSON
    #[arg(long, value_name = "FILE")]
    pub why: Option<PathBuf>,
    /// Keep how the search went, as JSON: for `darrt show FILE` and as a layer of the page
    #[arg(long, value_name = "FILE")]
    pub record: Option<PathBuf>,
    /// Open the page in the browser
    #[arg(long, conflicts_with = "no_picture")]
    pub open: bool,
    /// Print nothing but errors
    #[arg(short, long, conflicts_with = "stats")]
    pub quiet: bool,
    /// Margins in the place of those of the problem.
    #[command(flatten)]
    pub safety: SafetyOptions,
}

/// Options of `darrt explain`.
#[derive(Debug, Args)]
#[command(after_help = help::EXPLAIN_NOTES)]
pub struct ExplainOptions {
    /// Name of a built-in problem, or a problem file
    pub problem: String,
    /// Seed of every random choice
    #[arg(long, default_value_t = 0, value_name = "NUMBER", value_parser = any_count, allow_hyphen_values = true)]
    pub seed: u64,
    /// Iterations for each changed problem
    #[arg(long, default_value_t = 1000, value_name = "NUMBER", value_parser = positive, allow_hyphen_values = true)]
    pub iterations: u64,
    /// Problems that are planned at the same time, 1 to 256 [default: one for each core]
    #[arg(long, value_name = "NUMBER", value_parser = threads, allow_hyphen_values = true)]
    pub threads: Option<usize>,
    /// Print the answer as JSON
    #[arg(long)]
    pub json: bool,
}

/// Options of `darrt check`.
#[derive(Debug, Args)]
#[expect(clippy::struct_excessive_bools, reason = "flags of the command line")]
pub struct CheckOptions {
    /// The plan file
    pub plan: PathBuf,
    /// Print the steps of the plan too
    #[arg(long)]
    pub steps: bool,
    /// Accept no plan with warnings
    #[arg(long)]
    pub strict: bool,
    /// Look at every state and every pair of bodies exactly, without shortcuts: slow, for the same verdict
    #[arg(long)]
    pub plain: bool,
    /// Print what was found as one JSON object
    #[arg(long, conflicts_with_all = ["steps", "quiet"])]
    pub json: bool,
    /// Print nothing but errors
    #[arg(short, long, conflicts_with = "steps")]
    pub quiet: bool,
}

/// Options of `darrt execute`.
#[derive(Debug, Args)]
#[command(after_help = help::EXECUTE_EXAMPLES)]
#[expect(clippy::struct_excessive_bools, reason = "flags of the command line")]
pub struct ExecuteOptions {
    /// The plan file
    #[arg(required_unless_present = "print_noise")]
    pub plan: Option<PathBuf>,
    /// Errors of the world and the robot: a part of those of a real robot, 0 to 1, or a file
    #[arg(long, value_name = "FILE|0..1", default_value = "0", allow_hyphen_values = true)]
    pub noise: String,
    /// Close the loop: look before every contact and after every drive, correct the arm, plan anew where that is not enough
    #[arg(long)]
    pub replan: bool,
    /// Execute nothing: tell how far off everything may be after every step, and how likely success is
    #[arg(long, conflicts_with = "runs")]
    pub predict: bool,
    /// How often [default: once without noise, else 100 times]
    #[arg(long, value_name = "NUMBER", value_parser = run_count, allow_hyphen_values = true)]
    pub runs: Option<u64>,
    /// Seed of the errors
    #[arg(long, default_value_t = 0, value_name = "NUMBER", value_parser = any_count, allow_hyphen_values = true)]
    pub seed: u64,
    /// Runs at the same time [default: one on every core]
    #[arg(long, value_name = "NUMBER", value_parser = threads, allow_hyphen_values = true)]
    pub threads: Option<usize>,
    /// Write a page of one run beside its plan: the first that fails, else the first
    #[arg(long, value_name = "FILE", conflicts_with = "predict")]
    pub page: Option<PathBuf>,
    /// Write a recording of the same run: joint states and frames, as MCAP
    #[arg(long, value_name = "FILE", conflicts_with = "predict")]
    pub mcap: Option<PathBuf>,
    /// Print all runs, with where the objects were after every step, as one JSON object
    #[arg(long, conflicts_with = "quiet")]
    pub json: bool,
    /// Print the noise of a real robot as a file, and execute nothing
    #[arg(long, exclusive = true)]
    pub print_noise: bool,
    /// Print nothing but errors
    #[arg(short, long)]
    pub quiet: bool,
}

/// Options of `darrt problems`.
#[derive(Debug, Args)]
pub struct ProblemsOptions {
    /// Print this built-in problem as a file to copy and edit
    #[arg(long, value_name = "NAME")]
    pub print: Option<String>,
}

/// Options of `darrt export`.
#[derive(Debug, Args)]
#[command(after_help = help::EXPORT_EXAMPLES)]
pub struct ExportOptions {
    /// The plan file
    pub plan: PathBuf,
    /// What to write
    #[arg(long, value_enum, value_name = "FORMAT")]
    pub to: ExportFormat,
    /// Write it here [default: beside the plan, with an ending of its own]
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Samples per second, 1 to 1000; there are more where the motion changes
    #[arg(long, default_value_t = 50.0, value_name = "HZ", value_parser = rate, allow_hyphen_values = true)]
    pub rate: f64,
    /// Print nothing but errors
    #[arg(short, long)]
    pub quiet: bool,
}

/// What `darrt export` writes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ExportFormat {
    /// The plan file with its clock
    Plan,
    /// Trajectories by group of joints, commands to the hand, sensing points: fields as in `trajectory_msgs`
    Json,
    /// The same as YAML
    Yaml,
    /// One `moveit_msgs/RobotTrajectory` as JSON
    Moveit,
    /// A table: one line per sample
    Csv,
    /// A recording: joint states, frames and events
    Mcap,
}

/// Options of `darrt schema`.
#[derive(Debug, Args)]
pub struct SchemaOptions {
    /// Which kind of file
    #[arg(value_enum)]
    pub kind: SchemaKind,
}

/// Options of `darrt bench`.
#[derive(Debug, Args)]
#[command(after_help = help::BENCH_EXAMPLES)]
pub struct BenchOptions {
    /// Names of built-in problems, problem files, or folders of them [default: the six of the paper]
    #[arg(value_name = "PROBLEM")]
    pub problems: Vec<String>,
    /// What is changed about the planner, by name, or `all`; `--list-variants` lists them
    #[arg(long, value_name = "NAMES", value_delimiter = ',', default_value = "default")]
    pub variants: Vec<String>,
    /// List the variants and end
    #[arg(long)]
    pub list_variants: bool,
    /// Seeds from A to B - 1, or how many from 0 on
    #[arg(long, value_name = "A..B", default_value = "10", value_parser = seeds, allow_hyphen_values = true)]
    pub seeds: Range<u64>,
    /// Stop every run after this many seconds [default: as the problem says]
    #[arg(long, value_name = "SECONDS", value_parser = seconds, allow_hyphen_values = true)]
    pub time_limit: Option<Duration>,
    /// Stop every run after this many iterations [default: as the problem says]
    #[arg(long, value_name = "NUMBER", value_parser = positive, allow_hyphen_values = true)]
    pub iterations: Option<u64>,
    /// Runs at the same time, 1 to 256 [default: half the cores, so that runs do not slow each other down]
    #[arg(long, value_name = "NUMBER", value_parser = threads, allow_hyphen_values = true)]
    pub jobs: Option<usize>,
    /// Do only this share of the runs: 2/5 is the second of five
    #[arg(long, value_name = "I/N")]
    pub shard: Option<Shard>,
    /// Add every run to this file, and skip those that it holds [default: bench.jsonl; with --merge: none]
    #[arg(short, long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Run nothing: put the results of these files together
    #[arg(long, value_name = "FILE", num_args = 1.., conflicts_with_all = ["problems", "variants", "seeds", "time_limit", "iterations", "shard", "jobs"])]
    pub merge: Vec<PathBuf>,
    /// Write a page with curves and tables here, .html
    #[arg(long, value_name = "FILE")]
    pub report: Option<PathBuf>,
    /// Keep the plan of every run, and a page of it, in this folder; the report links to them
    #[arg(long, value_name = "FOLDER")]
    pub keep: Option<PathBuf>,
    /// Write a log for `ompl_benchmark_statistics` per problem into this folder
    #[arg(long, value_name = "FOLDER")]
    pub ompl: Option<PathBuf>,
    /// Print nothing but errors
    #[arg(short, long)]
    pub quiet: bool,
}

/// Options of `darrt generate`.
#[derive(Debug, Args)]
#[command(after_help = help::GENERATE_EXAMPLES)]
pub struct GenerateOptions {
    /// Name of a built-in problem, or a problem file
    pub problem: String,
    /// For this robot instead of the problem's: a robot file, or a name of `darrt robot list`
    #[arg(long, value_name = "FILE|NAME")]
    pub robot: Option<String>,
    /// Seeds from A to B - 1, or how many from 0 on: one problem each
    #[arg(long, value_name = "A..B", default_value = "1", value_parser = seeds, allow_hyphen_values = true)]
    pub seeds: Range<u64>,
    /// Write a file per seed into this folder [default: print the only one]
    #[arg(long, value_name = "FOLDER")]
    pub into: Option<PathBuf>,
    /// Problems that are tried at the same time, 1 to 256 [default: the cores]
    #[arg(long, value_name = "NUMBER", value_parser = threads, allow_hyphen_values = true)]
    pub jobs: Option<usize>,
    /// Print nothing but errors
    #[arg(short, long, requires = "into")]
    pub quiet: bool,
}

/// The kinds of file with a schema.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum SchemaKind {
    /// Problem files (TOML)
    Problem,
    /// Plan files (JSON)
    Plan,
    /// Robot files (TOML)
    Robot,
    /// Why there is no plan, as `darrt plan --why` writes it (JSON)
    Diagnosis,
}

/// A whole number from `least` to `most`, in a message that says so whatever is wrong.
// What looks like an option, such as `-1`, is let through to here: the parser's own answer would be about options.
fn whole(text: &str, least: u64, most: u64) -> Result<u64, String> {
    let value = text.parse().ok().filter(|value| (least..=most).contains(value));
    value.ok_or_else(|| format!("must be a whole number from {least} to {most}"))
}

fn any_count(text: &str) -> Result<u64, String> {
    whole(text, 0, u64::MAX)
}

fn positive(text: &str) -> Result<u64, String> {
    whole(text, 1, u64::MAX)
}

fn run_count(text: &str) -> Result<u64, String> {
    whole(text, 1, 1_000_000)
}

fn threads(text: &str) -> Result<usize, String> {
    whole(text, 1, MOST_THREADS).and_then(|count| usize::try_from(count).map_err(|error| error.to_string()))
}

/// `A..B`, or a count of seeds from 0 on; at least one.
fn seeds(text: &str) -> Result<Range<u64>, String> {
    let range = match text.split_once("..") {
        Some((from, to)) => from.parse().ok().zip(to.parse().ok()).map(|(from, to)| from..to),
        None => text.parse().ok().map(|count| 0..count),
    };
    let range = range.filter(|range: &Range<u64>| !range.is_empty());
    range.ok_or_else(|| "must be a count above 0, or A..B with A below B".to_owned())
}

/// Samples per second.
fn rate(text: &str) -> Result<f64, String> {
    let value = text.parse().ok().filter(|value: &f64| (1.0..=1000.0).contains(value));
    value.ok_or_else(|| "must be a number from 1 to 1000".to_owned())
}

/// A positive time in seconds.
fn seconds(text: &str) -> Result<Duration, String> {
    const MOST: f64 = 1e9;
    let value = text.parse().ok().filter(|value: &f64| *value > 0.0 && *value <= MOST);
    // Less than the clock can tell would be no time at all.
    let time = value.and_then(|value| Duration::try_from_secs_f64(value).ok()).filter(|time| !time.is_zero());
    time.ok_or_else(|| format!("must be a number of seconds above 0 and at most {MOST:e}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory as _;

    #[test]
    fn the_definition_is_consistent() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn times_are_positive_and_finite() {
        assert_eq!(seconds("1.5").unwrap(), Duration::from_millis(1500));
        for bad in ["0", "-1", "nan", "inf", "1e10", "1e300", "1e-300", "soon", ""] {
            assert_eq!(seconds(bad).unwrap_err(), "must be a number of seconds above 0 and at most 1e9", "{bad}");
        }
    }

    #[test]
    fn counts_are_whole_and_in_range() {
        assert_eq!((any_count("0"), any_count("18446744073709551615")), (Ok(0), Ok(u64::MAX)));
        for bad in ["-1", "1.5", "18446744073709551616", "--quiet", ""] {
            assert_eq!(any_count(bad).unwrap_err(), "must be a whole number from 0 to 18446744073709551615", "{bad}");
        }
        assert!(positive("0").is_err() && threads("257").is_err());
        assert_eq!(threads("256"), Ok(256));
    }

    #[test]
    fn seeds_are_a_count_or_a_range() {
        assert_eq!((seeds("3"), seeds("5..9")), (Ok(0..3), Ok(5..9)));
        for bad in ["0", "5..5", "9..5", "a..b", "-1..2", "1..=3", ""] {
            assert!(seeds(bad).is_err(), "{bad}");
        }
    }
}
