//! `darrt check`: judge a plan.

use std::path::Path;

use super::args::CheckOptions;
use super::exit::{Exit, Failure};
use super::output::Output;
use super::steps;
use crate::picture::Story;
use crate::plan_file::PlanFile;
use crate::problem_file::builtin;
use crate::verify::{self, Proof, SmallestClearance};
use crate::words::{counted, on_one_line};

/// Reads a plan and has it verified.
///
/// # Errors
/// [`Exit::Refused`] with the step, the time and the bodies; [`Exit::BadInput`] for a file that is no plan file.
pub(super) fn run(options: &CheckOptions, output: &mut Output) -> Result<Exit, Failure> {
    let plan = read(&options.plan)?;
    let name = options.plan.display();
    let refuse = |why: String| Failure::new(Exit::Refused, on_one_line(&format!("{name}: refused: {why}")));
    plan.problem.check_files().map_err(|error| Failure::input(format!("{name}: {error}")))?;
    plan.check_complete().map_err(|flaw| refuse(flaw.to_string()))?;
    let proof = verify::verify(&plan).map_err(|refusal| refuse(refusal.to_string()))?;
    if options.steps {
        output.print(&steps::table(&Story::of_plan(&plan)?))?;
    }
    if !options.quiet {
        output.print(&format!("{name}: accepted\n{}", words(&proof)))?;
    }
    Ok(Exit::Solved)
}

fn read(path: &Path) -> Result<PlanFile, Failure> {
    PlanFile::read(path).map_err(|error| {
        let name = path.to_str().filter(|name| !path.exists() && builtin::canonical_name(name).is_some());
        let built_in = |name| format!("{name}: is a built-in problem, not a plan; plan it with `darrt plan {name}`");
        name.map_or_else(|| error.into(), |name| Failure::input(built_in(name)))
    })
}

/// What the verifier has seen.
pub(super) fn words(proof: &Proof) -> String {
    let mut text = format!(
        "verified: {} of {} in {}",
        counted(proof.states, "state"),
        counted(proof.waypoints as u64, "waypoint"),
        counted(proof.steps as u64, "step")
    );
    if let Some(smallest) = &proof.smallest_clearance {
        text.push_str(&clearance(smallest));
    }
    text
}

fn clearance(smallest: &SmallestClearance) -> String {
    let (first, second) = &smallest.bodies;
    let place = if smallest.step == 0 { "at the start".to_owned() } else { format!("in step {}", smallest.step) };
    format!("\nsmallest clearance: {:.1} mm between {first} and {second} {place}", smallest.distance_m * 1000.0)
}
