//! `darrt schema`: the published JSON Schemas.

use crate::args::{SchemaKind, SchemaOptions};
use crate::exit::{Exit, Failure};
use crate::output::Output;
use darrt_task::diagnosis::Diagnosis;
use darrt_task::plan_file::PlanFile;
use darrt_task::problem_file::ProblemFile;
use darrt_task::robot_file::RobotFile;
use darrt_task::schema::schema_text;

/// Prints a schema.
///
/// # Errors
/// None in practice but a standard output that cannot be written.
pub(crate) fn run(options: &SchemaOptions, output: &mut Output) -> Result<Exit, Failure> {
    let text = match options.kind {
        SchemaKind::Problem => schema_text::<ProblemFile>(),
        SchemaKind::Plan => schema_text::<PlanFile>(),
        SchemaKind::Robot => schema_text::<RobotFile>(),
        SchemaKind::Diagnosis => schema_text::<Diagnosis>(),
    };
    output.print(&text.map_err(|error| Failure::input(error.to_string()))?)?;
    Ok(Exit::Solved)
}
