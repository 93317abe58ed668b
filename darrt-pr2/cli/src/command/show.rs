//! `darrt show`: draw a problem, a plan or a recorded search.

use std::path::{Path, PathBuf};

use super::robot;
use super::source::{Given, on_stdin};
use crate::args::ShowOptions;
use crate::exit::{Exit, Failure};
use crate::output::{self, Output};
use crate::{browser, drawing, steps};
use darrt_task::file_kind::{self, FileKind};
use darrt_task::file_robot::inspect::inspect;
use darrt_task::picture::{self, Extent, Format, Story};
use darrt_task::plan_file::PlanFile;
use darrt_task::problem_file::ProblemFile;
use darrt_task::program::Program;
use darrt_task::recording::{Recording, graph};
use darrt_task::robot::RobotFacts;
use darrt_task::text::counted;
use darrt_task::viewer::RobotModel;
use darrt_task::viewer::search::SearchData;

/// Draws the picture; for a plan prints its steps too. The plan is not judged.
///
/// # Errors
/// What cannot be read, built or written.
pub(crate) fn run(program: &dyn Program, options: &ShowOptions, output: &mut Output) -> Result<Exit, Failure> {
    let path = Path::new(&options.source);
    let is_problem = program.problems().find(&options.source).is_some();
    if !is_problem && (FileKind::of_file(path) == Some(FileKind::Robot) || robot::is_shipped(&options.source)) {
        return robot_file(program, options, output);
    }
    if !is_problem && FileKind::of_file(path) == Some(FileKind::Recording) {
        return recorded(program, options, output);
    }
    if let Some(option) =
        [("--attempt", options.attempt), ("--iteration", options.iteration)].iter().find(|(_, value)| value.is_some())
    {
        return Err(Failure::input(format!("{}: {} is for recorded searches", options.source, option.0)));
    }
    let Source { story, plan, robot } = read(program, &options.source)?;
    let default = || {
        let ending = if options.moving { "svg" } else { "html" };
        PathBuf::from(format!("{}.{ending}", output::file_stem(&story.problem.name)))
    };
    let path = options.output.clone().unwrap_or_else(default);
    let format = Format::of_path(&path)?;
    let place = output::writable(&path)?;
    output::keep_apart(&[("file that is drawn", Path::new(&options.source))], &[("picture", &place)])?;
    let extent = if options.overview { Extent::Overview } else { Extent::Whole };
    let bytes = match (&plan, options.moving) {
        (_, false) => drawing::file(&story, plan.as_ref(), &robot, format, extent)?,
        (Some(plan), true) if format == Format::Svg => picture::animate(plan, &robot)?.into_bytes(),
        (Some(_), true) => {
            let text = format!("{}: --moving makes an .svg file; an .html page moves by itself", path.display());
            return Err(Failure::input(text));
        }
        (None, true) => return Err(Failure::input(format!("{}: is no plan, nothing moves in it", options.source))),
    };
    output::write_file(&place, bytes)?;
    if !story.steps.is_empty() {
        output.print(&steps::table(&story))?;
    }
    output.print(&format!("picture:  {}", path.display()))?;
    if options.open {
        browser::open(&place)?;
    }
    Ok(Exit::Solved)
}

/// Shows a robot: its shapes, and on the page a slider for every joint.
fn robot_file(program: &dyn Program, options: &ShowOptions, output: &mut Output) -> Result<Exit, Failure> {
    let given = [("--moving", options.moving), ("--overview", options.overview)];
    let given = given
        .into_iter()
        .chain([("--attempt", options.attempt.is_some()), ("--iteration", options.iteration.is_some())]);
    if let Some((option, _)) = given.into_iter().find(|(_, is_given)| *is_given) {
        return Err(Failure::input(format!("{}: {option} is not for robots", options.source)));
    }
    let inspection = inspect(&options.source)?;
    let default = || PathBuf::from(format!("{}.robot.html", output::file_stem(&inspection.name)));
    let path = options.output.clone().unwrap_or_else(default);
    let place = robot::draw(program, &inspection, &options.source, &path)?;
    output.print(&format!("picture:  {}", path.display()))?;
    if options.open {
        browser::open(&place)?;
    }
    Ok(Exit::Solved)
}

/// Shows a recorded search: its trees as a layer of the page, or as a graph.
fn recorded(program: &dyn Program, options: &ShowOptions, output: &mut Output) -> Result<Exit, Failure> {
    let source = Path::new(&options.source);
    let whole = Recording::read(source)?;
    whole.problem.validate(&options.source)?;
    let there: Vec<_> = whole.attempts.iter().map(|attempt| attempt.attempt.to_string()).collect();
    let recording = whole.at(options.attempt, options.iteration);
    if recording.attempts.is_empty() {
        let text = format!("{}: has no such attempt; its attempts: {}", options.source, there.join(", "));
        return Err(Failure::input(text));
    }
    let default = || PathBuf::from(format!("{}.search.html", output::file_stem(&recording.problem.name)));
    let path = options.output.clone().unwrap_or_else(default);
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
    let place = output::writable(&path)?;
    let bytes = match ending.as_str() {
        "dot" | "gv" => graph::dot(&recording).into_bytes(),
        "graphml" => graph::graphml(&recording).into_bytes(),
        "html" | "htm" => {
            let problem = &recording.problem;
            let robot =
                program.facts(problem).map_err(|error| Failure::input(format!("{}: {error}", options.source)))?;
            let story = Story::of_problem(problem, &robot)?;
            drawing::page(
                &story,
                None,
                &RobotModel::of(&robot)?,
                (Extent::Whole, None, Some(SearchData::of(&recording))),
            )?
        }
        _ => {
            let text = format!("{}: a recorded search becomes an .html, .graphml or .dot file", path.display());
            return Err(Failure::input(text));
        }
    };
    output::write_file(&place, bytes)?;
    for attempt in &recording.attempts {
        let solved = if recording.solved == Some(attempt.attempt) { ", with the plan" } else { "" };
        output.print(&format!(
            "attempt {}: {}, {}, {} taken back, {} blocked{solved}",
            attempt.attempt,
            counted(attempt.iterations, "iteration"),
            counted(attempt.nodes.len() as u64, "node"),
            attempt.removed.len(),
            counted(attempt.blocked.len() as u64, "extension"),
        ))?;
    }
    output.print(&format!("picture:  {}", path.display()))?;
    if options.open {
        browser::open(&place)?;
    }
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
    let is_problem = program.problems().find(source).is_some() || !is_plan(Path::new(source));
    let plan = match on_stdin(program, source)? {
        Some(Given::Plan(plan)) => *plan,
        None if !is_problem => PlanFile::read(source)?,
        given => {
            let problem = if let Some(Given::Problem(problem)) = given { *problem } else { program.open(source)? };
            let robot = facts(&problem)?;
            return Ok(Source { story: Story::of_problem(&problem, &robot)?, plan: None, robot });
        }
    };
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
