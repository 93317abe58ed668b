//! `darrt show`: draw a problem or a plan.

use std::path::{Path, PathBuf};

use crate::args::ShowOptions;
use crate::exit::{Exit, Failure};
use crate::output::{self, Output};
use crate::{drawing, steps};
use darrt_task::file_kind;
use darrt_task::picture::{Extent, Format, Story};
use darrt_task::plan_file::PlanFile;
use darrt_task::problem_file::ProblemFile;
use darrt_task::program::Program;
use darrt_task::robot::RobotFacts;

/// Draws the picture; for a plan prints its steps too. The plan is not judged.
///
/// # Errors
/// What cannot be read, built or written.
pub(crate) fn run(program: &dyn Program, options: &ShowOptions, output: &mut Output) -> Result<Exit, Failure> {
    let Source { story, plan, robot } = read(program, &options.source)?;
    let default = || PathBuf::from(format!("{}.html", output::file_stem(&story.problem.name)));
    let path = options.output.clone().unwrap_or_else(default);
    let format = Format::of_path(&path)?;
    let place = output::writable(&path)?;
    let extent = if options.overview { Extent::Overview } else { Extent::Whole };
    output::write_file(&place, &drawing::file(&story, plan.as_ref(), &robot, format, extent)?)?;
    if !story.steps.is_empty() {
        output.print(&steps::table(&story))?;
    }
    output.print(&format!("picture:  {}", path.display()))?;
    Ok(Exit::Solved)
}

/// What there is to see.
struct Source {
    story: Story,
    plan: Option<PlanFile>,
    robot: RobotFacts,
}

fn read(program: &dyn Program, source: &str) -> Result<Source, Failure> {
    let facts =
        |problem: &ProblemFile| program.facts(problem).map_err(|error| Failure::input(format!("{source}: {error}")));
    if program.problems().find(source).is_some() || !is_plan(Path::new(source)) {
        let problem = program.open(source)?;
        let robot = facts(&problem)?;
        return Ok(Source { story: Story::of_problem(&problem, &robot)?, plan: None, robot });
    }
    let plan = PlanFile::read(source)?;
    plan.problem.validate(source)?;
    let robot = facts(&plan.problem)?;
    let story = Story::of_plan(&plan, &robot).map_err(|error| Failure::input(format!("{source}: {error}")))?;
    Ok(Source { story, plan: Some(plan), robot })
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
