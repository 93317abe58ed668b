//! `darrt check`: judge a plan.

use std::path::Path;

use crate::args::CheckOptions;
use crate::diagnosis;
use crate::exit::{Exit, Failure};
use crate::output::{self, Output};
use crate::steps;
use darrt_task::goal_edges;
use darrt_task::picture::Story;
use darrt_task::plan_file::{PlanFile, Timing};
use darrt_task::problem_file::PrimitiveName;
use darrt_task::program::Program;
use darrt_task::text::{counted, on_one_line};
use darrt_task::verify::{self, Proof, Refusal, SmallestClearance, VerifyOptions, Warning};

/// Reads a plan and has it verified.
///
/// # Errors
/// [`Exit::Refused`] with the step, the time and the bodies, or if the plan must have no warnings and has some;
/// [`Exit::BadInput`] for a file that is no plan file.
pub(crate) fn run(program: &dyn Program, options: &CheckOptions, output: &mut Output) -> Result<Exit, Failure> {
    let plan = read(program, &options.plan)?;
    let name = options.plan.display();
    let refuse = |why: String| Failure::new(Exit::Refused, on_one_line(&format!("{name}: refused: {why}")));
    plan.problem.check_files().map_err(|error| Failure::input(format!("{name}: {error}")))?;
    plan.check_complete().map_err(|flaw| refuse(flaw.to_string()))?;
    let robot = program.facts(&plan.problem);
    let robot = robot.map_err(|error| refuse(format!("the robot of the problem cannot be built: {error}")))?;
    let how = VerifyOptions { is_plain: options.plain, ..VerifyOptions::default() };
    let proof = match verify::verify_with(&plan, &robot, &how) {
        Ok(proof) => proof,
        Err(refusal) => {
            if options.json {
                output.print(&refused(&refusal)?)?;
            }
            return Err(refuse(refusal.to_string()));
        }
    };
    if options.steps {
        output.print(&steps::table(&Story::of_plan(&plan, &robot)?))?;
    }
    let is_refused = options.strict && !proof.warnings.is_empty();
    if options.json {
        output.print(&json(&plan, &proof, !is_refused)?)?;
    } else if !options.quiet {
        let verdict = match &plan.partial {
            _ if is_refused => "right, but not accepted".to_owned(),
            None => "accepted".to_owned(),
            partial => {
                format!("right, but only the beginning of a plan: {}", diagnosis::text::of_parts(partial.as_ref()))
            }
        };
        let warnings = proof.warnings.iter().map(|warning| format!("\nwarning:  {warning}"));
        let clock = plan.timing.as_ref().map_or_else(String::new, |timing| format!("\n{}", clock(timing)));
        output.tell(&format!("{name}: {verdict}\n{}{clock}{}", words(&proof), warnings.collect::<String>()))?;
        notices(&plan, output)?;
    }
    if is_refused {
        let count = counted(proof.warnings.len() as u64, "warning");
        return Err(refuse(format!("{count}, and with --strict there may be none")));
    }
    Ok(if plan.partial.is_some() { Exit::Partial } else { Exit::Solved })
}

/// What the verifier has seen, for programs: lengths in metres, the numbers of a warning in metres or degrees.
fn json(plan: &PlanFile, proof: &Proof, is_accepted: bool) -> Result<String, Failure> {
    let clearance = |smallest: &SmallestClearance| {
        let SmallestClearance { distance_m, bodies: (a, b), step, time } = smallest;
        serde_json::json!({ "distance_m": distance_m, "bodies": [a, b], "step": step, "time": time })
    };
    let warnings = proof.warnings.iter().map(|warning| {
        let Warning { kind, step, bodies, found, wanted } = warning;
        let (unit, message) = (kind.unit(), warning.to_string());
        serde_json::json!({ "kind": kind, "step": step, "bodies": bodies, "found": found, "wanted": wanted, "unit": unit,
            "message": message })
    });
    let value = serde_json::json!({
        "accepted": is_accepted && plan.partial.is_none(),
        "partial": plan.partial,
        "steps": proof.steps,
        "waypoints": proof.waypoints,
        "states": proof.states,
        "duration_s": proof.duration_s,
        "smallest_clearance": proof.smallest_clearance.as_ref().map(clearance),
        "smallest_intended": proof.smallest_intended.as_ref().map(clearance),
        "warnings": warnings.collect::<Vec<_>>(),
    });
    written(&value)
}

/// The same for a plan that is refused.
fn refused(refusal: &Refusal) -> Result<String, Failure> {
    written(&serde_json::json!({ "accepted": false, "refusal": self::refusal(refusal) }))
}

/// What is wrong with a plan, for programs.
pub(super) fn refusal(refusal: &Refusal) -> serde_json::Value {
    let Refusal { step, primitive, time, kind, bodies, place, message } = refusal;
    let primitive = primitive.as_ref().map(PrimitiveName::as_str);
    let bodies = bodies.as_deref().map(|(a, b)| [a, b]);
    serde_json::json!({ "kind": format!("{kind:?}"), "step": step, "primitive": primitive, "time": time, "bodies": bodies,
        "place": place, "message": message })
}

fn written(value: &serde_json::Value) -> Result<String, Failure> {
    output::json(value, "the verdict")
}

/// Reads a plan file.
///
/// # Errors
/// [`Exit::BadInput`] with the file, and what is wrong with it.
pub(crate) fn read(program: &dyn Program, path: &Path) -> Result<PlanFile, Failure> {
    PlanFile::read(path).map_err(|error| {
        let name = path.to_str().filter(|name| !path.exists() && program.problems().find(name).is_some());
        let built_in = |name| format!("{name}: is a built-in problem, not a plan; plan it with `darrt plan {name}`");
        name.map_or_else(|| error.into(), |name| Failure::input(built_in(name)))
    })
}

/// What the verifier has seen.
pub(crate) fn words(proof: &Proof) -> String {
    let mut text = format!(
        "verified: {} of {} in {}",
        counted(proof.states, "state"),
        counted(proof.waypoints as u64, "waypoint"),
        counted(proof.steps as u64, "step")
    );
    let kinds = [("", &proof.smallest_clearance), (" at work", &proof.smallest_intended)];
    for (kind, smallest) in kinds {
        if let Some(smallest) = smallest {
            text.push_str(&clearance(kind, smallest));
        }
    }
    text
}

/// How long the plan takes.
pub(crate) fn clock(timing: &Timing) -> String {
    // Not -0.0, which a sum of nothing is.
    format!("clock:    {:.1} s at the robot's limits", timing.duration_s + 0.0)
}

/// What a person should know besides.
pub(crate) fn notices(plan: &PlanFile, output: &mut Output) -> Result<(), Failure> {
    let lines = goal_edges::notices(&plan.problem).map_err(|error| Failure::input(error.to_string()))?;
    lines.iter().try_for_each(|line| output.tell(&format!("notice:   {line}")))
}

fn clearance(kind: &str, smallest: &SmallestClearance) -> String {
    let (first, second) = &smallest.bodies;
    let place = if smallest.step == 0 { "at the start".to_owned() } else { format!("in step {}", smallest.step) };
    format!("\nsmallest clearance{kind}: {:.1} mm between {first} and {second} {place}", smallest.distance_m * 1000.0)
}
