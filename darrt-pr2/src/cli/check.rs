//! `darrt check`: judge a plan.

use super::args::CheckOptions;
use super::exit::{Exit, Failure};
use super::output::Output;
use super::steps;
use crate::picture::Story;
use crate::plan_file::PlanFile;
use crate::verify::{self, Proof, SmallestClearance};

/// Reads a plan and has it verified.
///
/// # Errors
/// [`Exit::Refused`] with the step, the time and the bodies; [`Exit::BadInput`] for a file that is no plan file.
pub(super) fn run(options: &CheckOptions, output: &mut Output) -> Result<Exit, Failure> {
    let plan = PlanFile::read(&options.plan)?;
    let name = options.plan.display();
    let refuse = |refusal| Failure::new(Exit::Refused, format!("{name}: refused: {refusal}"));
    let proof = verify::verify(&plan).map_err(refuse)?;
    if options.steps {
        output.print(&steps::table(&Story::of_plan(&plan)?))?;
    }
    if !options.quiet {
        output.print(&format!("{name}: accepted\n{}", words(&proof)))?;
    }
    Ok(Exit::Solved)
}

/// What the verifier has seen.
pub(super) fn words(proof: &Proof) -> String {
    let mut text =
        format!("verified: {} states of {} waypoints in {} steps", proof.states, proof.waypoints, proof.steps);
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
