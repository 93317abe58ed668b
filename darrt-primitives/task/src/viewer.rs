//! The viewer: a problem or a plan in 3-D, moving, as one page that needs no network, no server and no other file.
//!
//! | question | file |
//! |---|---|
//! | what is the page told? | [`data`], explained for strangers in `docs/viewer-data.md` |
//! | what do robot, room and objects look like? | `scene`, `meshes` |
//! | what moves, and when? | `timeline` |
//! | how near does what come? | `clearance` |
//! | why is there no plan, and what was in the way? | [`why`] |
//! | how did the search go? | [`search`] |
//! | how is it drawn? | the files of `page`, which are also fit for data of others |
//! | and as a file for other programs? | [`glb`], with the triangles of `solids` |

mod clearance;
pub mod data;
pub mod glb;
mod meshes;
mod scene;
pub mod search;
mod solids;
mod timeline;
pub mod why;

use darrt_primitives::kinematics::UrdfError;

use crate::picture::ink;
use crate::plan_file::joints::JointFlaw;
use crate::plan_file::{PlanFile, UnknownTool, Waypoint};
use crate::problem_file::geometry::Geometry;
use crate::problem_file::{ProblemFile, ProblemFileError};
use data::ViewerData;
pub use scene::RobotModel;
use timeline::Moment;

/// The page without style, script, data and figure.
const PAGE: &str = include_str!("viewer/page/page.html");
/// How it looks.
const STYLE: &str = include_str!("viewer/page/style.css");
/// What it does: one script, in the order in which a reader wants it.
const SCRIPT: [&str; 11] = [
    include_str!("viewer/page/poses.js"),
    include_str!("viewer/page/solids.js"),
    include_str!("viewer/page/renderer.js"),
    include_str!("viewer/page/scene.js"),
    include_str!("viewer/page/marked.js"),
    include_str!("viewer/page/search.js"),
    include_str!("viewer/page/time.js"),
    include_str!("viewer/page/panel.js"),
    include_str!("viewer/page/why.js"),
    include_str!("viewer/page/hands.js"),
    include_str!("viewer/page/begin.js"),
];

/// Why there is nothing to see.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ViewerError {
    /// The room or an object cannot be built.
    #[error(transparent)]
    Problem(#[from] ProblemFileError),
    /// The robot cannot be built.
    #[error(transparent)]
    Robot(#[from] UrdfError),
    /// The robot lacks the link that holds things.
    #[error("the robot has no link `{name}`")]
    NoLink {
        /// Its name.
        name: String,
    },
    /// A step names a tool that the robot does not have.
    #[error("`{place}`: {error}")]
    Tool {
        /// Path of the key in the plan file.
        place: String,
        /// What is wrong.
        error: Box<UnknownTool>,
    },
    /// A waypoint's joints are not those of the robot.
    #[error("`{place}`: {flaw}")]
    Joints {
        /// Path of the key in the plan file.
        place: String,
        /// What is wrong.
        flaw: JointFlaw,
    },
    /// A plan refers to something that is not there.
    #[error("`{place}` lacks the {what} `{name}`")]
    Missing {
        /// Path of the key in the plan file.
        place: String,
        /// Kind of thing.
        what: &'static str,
        /// Its name.
        name: String,
    },
    /// A binary glTF file would be larger than its format allows.
    #[error("a glTF file of {bytes} bytes cannot be written, at most {} are possible", u32::MAX)]
    TooLarge {
        /// Its size.
        bytes: usize,
    },
    /// The data cannot be written.
    #[error("the data of the page cannot be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
}

/// What the page shows of a problem whose robot and objects stand as `start` says.
///
/// # Errors
/// When something cannot be built, or the start lacks a joint or an object.
pub fn of_problem(problem: &ProblemFile, start: &Waypoint, robot: &RobotModel) -> Result<ViewerData, ViewerError> {
    still(problem, &problem.geometry()?, start, robot)
}

/// What the page shows before anything moves.
fn still(
    problem: &ProblemFile,
    geometry: &Geometry,
    start: &Waypoint,
    robot: &RobotModel,
) -> Result<ViewerData, ViewerError> {
    Ok(ViewerData {
        format: data::FORMAT.to_owned(),
        version: data::VERSION,
        title: if problem.title.is_empty() { &problem.name } else { &problem.title }.clone(),
        description: problem.description.clone(),
        note: String::new(),
        robot: robot.data(),
        bodies: scene::bodies(problem, geometry),
        surfaces: scene::surfaces(geometry),
        objects: scene::objects(problem, geometry),
        start: Moment::read(start, robot, problem, || "start".to_owned())?.data(),
        steps: Vec::new(),
        why: None,
        search: None,
    })
}

/// Where everything stands at a waypoint of a problem.
///
/// # Errors
/// It lacks a joint or an object.
pub fn state(problem: &ProblemFile, waypoint: &Waypoint, robot: &RobotModel) -> Result<data::StartData, ViewerError> {
    Ok(Moment::read(waypoint, robot, problem, || "state".to_owned())?.data())
}

/// What the page shows of a plan; `note` is one line about it.
///
/// # Errors
/// As [`of_problem`], and when a step or a waypoint lacks something.
pub fn of_plan(plan: &PlanFile, note: &str, robot: &RobotModel) -> Result<ViewerData, ViewerError> {
    let acts = timeline::acts(plan, robot)?;
    let geometry = plan.problem.geometry()?;
    let clearances = clearance::of_steps(&acts, robot, &geometry);
    let steps = acts.iter().zip(clearances).map(|(act, clearance)| data::StepData { clearance, ..act.data(robot) });
    let steps = steps.collect();
    Ok(ViewerData { note: note.to_owned(), steps, ..still(&plan.problem, &geometry, &plan.start, robot)? })
}

/// The page: the viewer with data and figure, an SVG file.
///
/// # Errors
/// When a number of the data is not finite.
pub fn page(data: &ViewerData, figure: &str) -> Result<String, ViewerError> {
    // Nothing in a text may end the element that it stands in.
    let json = serde_json::to_string(data)?.replace('<', "\\u003c");
    let title = svg::node::Text::new(ink::clean(&data.title)).to_string();
    // Inside a page an SVG element needs no heading, and no name of its language.
    let figure = figure.find("<svg").and_then(|at| figure.get(at..)).unwrap_or_default();
    let figure = figure.replacen(" xmlns=\"http://www.w3.org/2000/svg\"", "", 1);
    let script = SCRIPT.concat();
    let mut page = String::with_capacity(PAGE.len() + STYLE.len() + script.len() + json.len() + figure.len());
    let mut rest = PAGE;
    let marks = [
        ("<!--title-->", title.as_str()),
        ("/*style*/\n", STYLE),
        ("<!--figure-->", &figure),
        ("<!--data-->", &json),
        ("/*script*/\n", &script),
    ];
    for (mark, text) in marks {
        if let Some((before, after)) = rest.split_once(mark) {
            page.push_str(before);
            page.push_str(text);
            rest = after;
        }
    }
    page.push_str(rest);
    Ok(page)
}
