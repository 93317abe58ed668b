//! A plan as a table: one line for each sample.

use darrt_task::clock::{Event, EventKind, Moment};
use darrt_task::plan_file::PlanFile;
use darrt_task::trajectory::{BASE_JOINTS, Sampled};

/// Two times that are nearer to each other are the same, seconds.
const SAME_S: f64 = 1e-6;

/// The bytes of the table, or why there are none.
///
/// Columns: `time_s`, `step` (from 1), `primitive`, position of base and of every joint, velocity of base and of every joint that
/// may move, and `event`: `sense`, or `fingers WIDTH_M FORCE_N` without a force where it is not limited; `fingers of TOOL ...` for
/// a hand that is not the robot's first.
pub(super) fn file(plan: &PlanFile, sampled: &Sampled) -> Result<Vec<u8>, String> {
    let words = |error: &dyn std::fmt::Display| error.to_string();
    let mut table = csv::Writer::from_writer(Vec::new());
    let timed = sampled.timed();
    let moving = sampled.moving();
    let joints = 0..timed.tree().variables().len();
    let mut head = ["time_s", "step", "primitive"].map(str::to_owned).to_vec();
    head.extend(BASE_JOINTS.map(str::to_owned));
    head.extend(joints.clone().map(|variable| sampled.name(variable)));
    head.extend(BASE_JOINTS.map(|name| format!("{name}_velocity")));
    head.extend(moving.iter().map(|variable| format!("{}_velocity", sampled.name(*variable))));
    head.push("event".to_owned());
    table.write_record(&head).map_err(|error| words(&error))?;
    let events = sampled.events();
    let mut events = events.iter().peekable();
    for (t_s, moment) in sampled.samples() {
        let mut happening = Vec::new();
        while let Some(event) = events.next_if(|event| event.time_s <= t_s + SAME_S) {
            happening.push(told(plan, sampled, event));
        }
        table.write_record(row(plan, *t_s, moment, &moving, &happening.join("; "))).map_err(|error| words(&error))?;
    }
    table.into_inner().map_err(|error| words(&error))
}

fn row(plan: &PlanFile, t_s: f64, moment: &Moment, moving: &[usize], event: &str) -> Vec<String> {
    let primitive = plan.steps.get(moment.step).map_or_else(String::new, |step| step.primitive.to_string());
    // The step is that of the sample; a plan without steps has a single line.
    let step = if plan.steps.is_empty() { String::new() } else { (moment.step + 1).to_string() };
    let mut row = vec![t_s.to_string(), step, primitive];
    let velocity = moving.iter().map(|variable| moment.joint_velocity.get(*variable).copied().unwrap_or(0.0));
    let values = moment.base.into_iter().chain(moment.joints.iter().copied()).chain(moment.base_velocity);
    row.extend(values.chain(velocity).map(|value| value.to_string()));
    row.push(event.to_owned());
    row
}

fn told(plan: &PlanFile, sampled: &Sampled, event: &Event) -> String {
    let tool = plan.steps.get(event.step).and_then(|step| step.tool.as_ref());
    let fingers = tool.map_or_else(|| "fingers".to_owned(), |tool| format!("fingers of {tool}"));
    match (event.kind, sampled.command(event)) {
        (EventKind::Fingers { force_n: Some(force_n), .. }, Some(command)) => {
            format!("{fingers} {} {force_n}", command.position)
        }
        (EventKind::Fingers { .. }, Some(command)) => format!("{fingers} {}", command.position),
        _ => "sense".to_owned(),
    }
}
