//! `darrt export`: a plan on its clock, in the files that controllers and tools of others read.

mod csv;
mod mcap;

use std::path::{Path, PathBuf};

use darrt_core::budget::Cancel;
use serde::Serialize;

use super::check;
use crate::args::{ExportFormat, ExportOptions};
use crate::exit::{Exit, Failure};
use crate::output::{self, Output};
use darrt_task::clock::{ClockError, NoClock, give_clock};
use darrt_task::program::Program;
use darrt_task::text::{counted, on_one_line};
use darrt_task::trajectory::Sampled;
use darrt_task::trajectory::document::Document;
use darrt_task::verify::{self, VerifyOptions};

/// Writes a plan that the verifier accepts; a plan without a clock gets one.
///
/// # Errors
/// [`Exit::Refused`] for a plan that is not right, [`Exit::BadInput`] for a file that is no plan, [`Exit::CannotWrite`].
pub(crate) fn run(program: &dyn Program, options: &ExportOptions, output: &mut Output) -> Result<Exit, Failure> {
    let mut plan = check::read(program, &options.plan)?;
    let name = options.plan.display();
    let path = options.output.clone().unwrap_or_else(|| beside(&options.plan, options.to));
    let place = output::writable(&path)?;
    if options.to != ExportFormat::Plan {
        output::keep_apart(&[("plan", &options.plan)], &[("export", &place)])?;
    }
    let refuse = |why: String| Failure::new(Exit::Refused, on_one_line(&format!("{name}: refused: {why}")));
    plan.problem.check_files().map_err(|error| Failure::input(format!("{name}: {error}")))?;
    plan.check_complete().map_err(|flaw| refuse(flaw.to_string()))?;
    let facts = program.facts(&plan.problem);
    let facts = facts.map_err(|error| refuse(format!("the robot of the problem cannot be built: {error}")))?;
    // What goes to a robot has been judged.
    let how = VerifyOptions::default();
    verify::verify_with(&plan, &facts, &how).map_err(|refusal| refuse(refusal.to_string()))?;
    if plan.timing.is_none() {
        give_clock(&mut plan, &facts, &how, &Cancel::new()).map_err(|error| match error {
            NoClock::Clock(error) => unfit(&name.to_string(), &error),
            NoClock::Refused(_) => refuse(error.to_string()),
        })?;
    }
    let sampled = Sampled::new(&plan, &facts, 1.0 / options.rate).map_err(|error| unfit(&name.to_string(), &error))?;
    let written = |error: String| Failure::new(Exit::CannotWrite, format!("{}: {error}", path.display()));
    let bytes = match options.to {
        ExportFormat::Plan => {
            plan.write(&place)?;
            None
        }
        ExportFormat::Json => Some(json(&Document::new(&plan, &sampled)).map_err(written)?),
        ExportFormat::Yaml => Some(yaml(&Document::new(&plan, &sampled)).map_err(written)?),
        ExportFormat::Moveit => Some(json(&sampled.robot()).map_err(written)?),
        ExportFormat::Csv => Some(csv::file(&plan, &sampled).map_err(written)?),
        ExportFormat::Mcap => Some(mcap::file(&plan, &sampled).map_err(written)?),
    };
    if let Some(bytes) = bytes {
        output::write_file(&place, bytes)?;
    }
    if !options.quiet {
        if let Some(timing) = &plan.timing {
            output.print(&check::clock(timing))?;
        }
        let samples = counted(sampled.samples().len() as u64, "sample");
        let what = if options.to == ExportFormat::Plan { String::new() } else { format!(", {samples}") };
        output.print(&format!("exported: {}{what}", path.display()))?;
    }
    Ok(Exit::Solved)
}

fn unfit(name: &str, error: &ClockError) -> Failure {
    Failure::input(format!("{name}: {error}"))
}

fn json(value: &impl Serialize) -> Result<Vec<u8>, String> {
    let mut text = serde_json::to_string(value).map_err(|error| error.to_string())?;
    text.push('\n');
    Ok(text.into_bytes())
}

fn yaml(value: &impl Serialize) -> Result<Vec<u8>, String> {
    serde_saphyr::to_string(value).map(String::into_bytes).map_err(|error| error.to_string())
}

/// Where an export goes if nobody says where: `a/b.plan.json` becomes `a/b.csv` beside it.
fn beside(plan: &Path, to: ExportFormat) -> PathBuf {
    let bare = plan.with_extension("");
    let bare = if bare.extension().is_some_and(|ending| ending == "plan") { bare.with_extension("") } else { bare };
    let mut name = bare.into_os_string();
    name.push(match to {
        ExportFormat::Plan => ".timed.plan.json",
        ExportFormat::Json => ".trajectory.json",
        ExportFormat::Yaml => ".trajectory.yaml",
        ExportFormat::Moveit => ".moveit.json",
        ExportFormat::Csv => ".csv",
        ExportFormat::Mcap => ".mcap",
    });
    PathBuf::from(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exports_lie_beside_the_plan() {
        let place = |plan: &str, to| beside(Path::new(plan), to).to_string_lossy().into_owned();
        assert_eq!(place("a/plate3.plan.json", ExportFormat::Csv), "a/plate3.csv");
        assert_eq!(place("p.json", ExportFormat::Moveit), "p.moveit.json");
        assert_eq!(place("v1.2.plan.json", ExportFormat::Plan), "v1.2.timed.plan.json");
    }
}
