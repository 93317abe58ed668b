//! `darrt show`: draw a problem or a plan.

use std::path::{Path, PathBuf};

use super::args::ShowOptions;
use super::exit::{Exit, Failure};
use super::output::{self, Output};
use super::{drawing, steps};
use crate::file_kind;
use crate::picture::{Extent, Format, Story};
use crate::plan_file::PlanFile;
use crate::problem_file::{ProblemFile, builtin};

/// Draws the picture; for a plan prints its steps too. The plan is not judged.
///
/// # Errors
/// What cannot be read, built or written.
pub(super) fn run(options: &ShowOptions, output: &mut Output) -> Result<Exit, Failure> {
    let (story, plan) = read(&options.source)?;
    let default = || PathBuf::from(format!("{}.html", output::file_stem(&story.problem.name)));
    let path = options.output.clone().unwrap_or_else(default);
    let format = Format::of_path(&path)?;
    let place = output::writable(&path)?;
    let extent = if options.overview { Extent::Overview } else { Extent::Whole };
    output::write_file(&place, &drawing::file(&story, plan.as_ref(), format, extent)?)?;
    if !story.steps.is_empty() {
        output.print(&steps::table(&story))?;
    }
    output.print(&format!("picture:  {}", path.display()))?;
    Ok(Exit::Solved)
}

fn read(source: &str) -> Result<(Story, Option<PlanFile>), Failure> {
    if builtin::canonical_name(source).is_some() || !is_plan(Path::new(source)) {
        return Ok((Story::of_problem(&ProblemFile::open(source)?)?, None));
    }
    let plan = PlanFile::read(source)?;
    plan.problem.validate(source)?;
    let story = Story::of_plan(&plan).map_err(|error| Failure::input(format!("{source}: {error}")))?;
    Ok((story, Some(plan)))
}

/// Whether a file is a plan rather than a problem: its name ends in `.json`, or it begins as JSON does.
fn is_plan(path: &Path) -> bool {
    if path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("json")) {
        return true;
    }
    file_kind::is_json(&file_kind::head(path))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plans_are_told_from_problems() {
        let folder = tempfile::tempdir().unwrap();
        let file = |name: &str, text: &str| {
            let path = folder.path().join(name);
            std::fs::write(&path, text).unwrap();
            path
        };
        assert!(is_plan(&file("a.JSON", "")) && is_plan(&file("plan", "\n {\"format\"")));
        assert!(!is_plan(&file("b.toml", "format = 1")) && !is_plan(folder.path()));
        assert!(!is_plan(&folder.path().join("missing")));
    }
}
