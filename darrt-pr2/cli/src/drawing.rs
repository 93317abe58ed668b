//! A problem or a plan as a file to look at.

use darrt_task::picture::{self, Extent, Format, Story, raster};
use darrt_task::plan_file::{PlanFile, Waypoint};
use darrt_task::robot::RobotFacts;
use darrt_task::viewer::data::ViewerData;
use darrt_task::viewer::search::SearchData;
use darrt_task::viewer::why::WhyData;
use darrt_task::viewer::{self, RobotModel, ViewerError};

use crate::exit::Failure;

/// The bytes of the file: of the plan, if there is one, else of the story's problem.
///
/// # Errors
/// What cannot be built or drawn.
pub(crate) fn file(
    story: &Story,
    plan: Option<&PlanFile>,
    robot: &RobotFacts,
    format: Format,
    extent: Extent,
) -> Result<Vec<u8>, Failure> {
    Ok(match format {
        Format::Svg => picture::draw(story, extent).into_bytes(),
        Format::Png => raster::png(&picture::draw(story, extent))?,
        Format::Glb => viewer::glb::file(&data(story, plan, &RobotModel::of(robot)?)?)?,
        Format::Html => page(story, plan, &RobotModel::of(robot)?, (extent, None, None))?,
    })
}

/// The page, with what else there is to tell: why there is no plan, how the search went.
///
/// # Errors
/// As [`file`].
pub(crate) fn page(
    story: &Story,
    plan: Option<&PlanFile>,
    robot: &RobotModel,
    (extent, why, search): (Extent, Option<WhyData>, Option<SearchData>),
) -> Result<Vec<u8>, Failure> {
    let data = ViewerData { why, search, ..data(story, plan, robot)? };
    Ok(viewer::page(&data, &picture::draw(story, extent))?.into_bytes())
}

fn data(story: &Story, plan: Option<&PlanFile>, robot: &RobotModel) -> Result<ViewerData, ViewerError> {
    match plan {
        Some(plan) => viewer::of_plan(plan, &story.note, robot),
        None => viewer::of_problem(&story.problem, &start(story, robot), robot),
    }
}

/// Where everything stands in a problem.
fn start(story: &Story, robot: &RobotModel) -> Waypoint {
    let objects = story.problem.objects.iter().zip(&story.start.objects);
    Waypoint {
        base: story.start.robot.base,
        joints: robot.table().complete(&story.start.robot.joints),
        objects: objects.map(|(object, pose)| (object.name.as_str().into(), (*pose).into())).collect(),
    }
}
