//! One run as a page: the viewer with what was executed, and a mark where the plan has every object.

use darrt_execute::RunReport;
use darrt_execute::recording::{Frame, Recording};
use darrt_task::picture::{self, Act, Extent, Story, palette};
use darrt_task::plan_file::PlanFile;
use darrt_task::robot::RobotFacts;
use darrt_task::viewer::data::{
    JointTrack, ObjectData, ObjectTrack, PartData, ShapeData, StartData, StepData, ViewerData, pose, rounded,
};
use darrt_task::viewer::{self, RobotModel};
use nalgebra::Isometry3;

use crate::exit::Failure;

/// A mark of a plan: a needle this thin and long, m.
const NEEDLE_M: [f64; 2] = [0.003, 0.25];
/// Colour of a step that the plan does not have.
const OTHER: &str = "#888888";

/// The page.
///
/// # Errors
/// What cannot be built or drawn.
pub(super) fn file(
    plan: &PlanFile,
    facts: &RobotFacts,
    report: &RunReport,
    recording: &Recording,
) -> Result<String, Failure> {
    let robot = RobotModel::of(facts)?;
    let story = Story::of_plan(plan, facts)?;
    let planned = viewer::of_problem(&plan.problem, &plan.start, &robot)?;
    let colour = |name: &str| {
        let contract = plan.contracts.get(name);
        contract.map_or(OTHER, |contract| palette::of(Act::of(contract)))
    };
    let mut objects = planned.objects.clone();
    let marks = planned.objects.iter().map(|object| {
        let part = PartData { shape: needle(), pose: [0.0, 0.0, NEEDLE_M[1] / 2.0, 0.0, 0.0, 0.0, 1.0] };
        ObjectData {
            name: format!("{} as planned", object.name),
            parts: vec![part],
            goals: Vec::new(),
            regions: Vec::new(),
        }
    });
    objects.extend(marks);
    let mut start = planned.start.clone();
    if let Some(first) = recording.frames.first() {
        start =
            StartData { base: first.base, joints: first.joints.clone(), objects: placed(first).map(pose).collect() };
    }
    let steps = (0..recording.steps.len()).filter_map(|index| {
        let step = recording.steps.get(index)?;
        let name =
            if step.plan == 0 { step.primitive.clone() } else { format!("{} (plan {})", step.primitive, step.plan) };
        of_step(recording.frames_of(index), name, colour(&step.primitive))
    });
    let data = ViewerData { note: note(report), objects, start, steps: steps.collect(), ..planned };
    let figure = picture::draw(&story, Extent::Whole);
    Ok(viewer::page(&data, &figure)?)
}

fn note(report: &RunReport) -> String {
    let ends = report.objects.iter().map(|end| format!("{} {:.1} mm off", end.object, 1000.0 * end.off_m));
    let ends = ends.collect::<Vec<_>>().join(", ");
    let how = if report.is_success { "succeeded" } else { "failed" };
    let first =
        report.departure.as_ref().map_or_else(String::new, |departure| format!("; {}", super::sentence(departure)));
    format!("executed, run {}: {how}, {ends}{first}. Needles show where the plan has the objects.", report.run)
}

fn needle() -> ShapeData {
    ShapeData::Cylinder { radius: NEEDLE_M[0], length: NEEDLE_M[1] }
}

/// Where the objects are, then their marks.
fn placed(frame: &Frame) -> impl Iterator<Item = &Isometry3<f64>> {
    frame.objects.iter().chain(&frame.planned)
}

fn of_step(frames: &[Frame], name: String, colour: &str) -> Option<StepData> {
    let first = frames.first()?;
    if frames.len() < 2 {
        return None;
    }
    let joint = |variable: usize| {
        JointTrack::of(variable, frames.iter().filter_map(|frame| frame.joints.get(variable).copied()))
    };
    let object = |object: usize| ObjectTrack::of(object, frames.iter().filter_map(|frame| placed(frame).nth(object)));
    Some(StepData {
        name,
        colour: colour.to_owned(),
        times: frames.iter().map(|frame| rounded(frame.time_s - first.time_s)).collect(),
        object: None,
        pushes: None,
        tool: None,
        holds: None,
        contacts: Vec::new(),
        base: frames.iter().map(|frame| frame.base.map(rounded)).collect(),
        joints: (0..first.joints.len()).filter_map(joint).collect(),
        objects: (0..2 * first.objects.len()).filter_map(object).collect(),
        clearance: Vec::new(),
    })
}
