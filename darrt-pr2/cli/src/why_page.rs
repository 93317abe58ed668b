//! The page of a search that found no plan: the causes with their bodies, the beginning of a plan, the nearest state, and what was
//! how often in the way.

use darrt_task::diagnosis::Diagnosis;
use darrt_task::diagnosis::cause::Cause;
use darrt_task::picture::{Extent, Story};
use darrt_task::planning::PlanResult;
use darrt_task::problem_file::ProblemFile;
use darrt_task::program::Program;
use darrt_task::viewer::search::SearchData;
use darrt_task::viewer::why::{NearestData, ReasonData, WhyData, blocks};
use darrt_task::viewer::{self, RobotModel};

use crate::exit::Failure;
use crate::{diagnosis, drawing};

/// What there is to tell.
pub(crate) struct Told<'a> {
    /// The problem.
    pub(crate) problem: &'a ProblemFile,
    /// The search; none for a problem that was refused before.
    pub(crate) result: Option<&'a PlanResult>,
    /// Why there is no plan.
    pub(crate) diagnosis: &'a Diagnosis,
}

/// The bytes of the page.
///
/// # Errors
/// What cannot be built or drawn.
pub(crate) fn page(program: &dyn Program, told: &Told<'_>) -> Result<Vec<u8>, Failure> {
    let partial = told.result.and_then(|result| result.partial.as_ref()).map(|(plan, _)| plan);
    let problem = partial.map_or(told.problem, |plan| &plan.problem);
    let robot = program.facts(problem).map_err(|error| Failure::input(error.to_string()))?;
    let story = match partial {
        Some(plan) => Story::of_plan(plan, &robot)?,
        None => Story::of_problem(problem, &robot)?,
    };
    let robot = RobotModel::of(&robot)?;
    let why = why(told, &robot)?;
    let search = told.result.and_then(|result| result.recording.as_ref()).map(SearchData::of);
    drawing::page(&story, partial, &robot, (Extent::Whole, Some(why), search))
}

fn why(told: &Told<'_>, robot: &RobotModel) -> Result<WhyData, Failure> {
    let Told { problem, result, diagnosis } = told;
    let (told_blocks, other_blocks) = result.map(|result| blocks(&result.accounts)).unwrap_or_default();
    let nearest = match result.and_then(|result| Some((result.nearest.as_ref()?, result.nearest_to_goal))) {
        Some((waypoint, to_go_m)) if to_go_m.is_finite() => {
            Some(NearestData { to_go_m, state: viewer::state(problem, waypoint, robot)? })
        }
        _ => None,
    };
    Ok(WhyData {
        headline: result.map_or_else(|| "refused before the search".to_owned(), diagnosis::headline),
        causes: diagnosis.causes.iter().map(reason).collect(),
        advice: result.map(|result| diagnosis::advice(result, diagnosis)).unwrap_or_default(),
        blocks: told_blocks,
        other_blocks,
        nearest,
    })
}

fn reason(cause: &Cause) -> ReasonData {
    let at = match cause {
        Cause::GoalOccupied { at, .. } => Some(*at),
        _ => None,
    };
    ReasonData { text: diagnosis::text::of_cause(cause).join("\n"), bodies: cause.bodies(), at }
}
