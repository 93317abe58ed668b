//! `darrt schema`: the published JSON Schemas.

use super::args::{SchemaKind, SchemaOptions};
use super::exit::{Exit, Failure};
use super::output::Output;
use crate::plan_file::PlanFile;
use crate::problem_file::ProblemFile;
use crate::schema::schema_text;

/// Prints a schema.
///
/// # Errors
/// None in practice but a standard output that cannot be written.
pub(super) fn run(options: &SchemaOptions, output: &mut Output) -> Result<Exit, Failure> {
    let text = match options.kind {
        SchemaKind::Problem => schema_text::<ProblemFile>(),
        SchemaKind::Plan => schema_text::<PlanFile>(),
    };
    output.print(&text.map_err(|error| Failure::input(error.to_string()))?)?;
    Ok(Exit::Solved)
}
