//! `darrt schema`: the published JSON Schemas.

use super::args::{SchemaKind, SchemaOptions};
use super::exit::{Exit, Failure};
use super::output::Output;
use crate::plan_file::schema::plan_schema_text;
use crate::schema::problem_schema_text;

/// Prints a schema.
///
/// # Errors
/// None in practice but a standard output that cannot be written.
pub(super) fn run(options: &SchemaOptions, output: &mut Output) -> Result<Exit, Failure> {
    let text = match options.kind {
        SchemaKind::Problem => problem_schema_text(),
        SchemaKind::Plan => plan_schema_text(),
    };
    output.print(&text.map_err(|error| Failure::input(error.to_string()))?)?;
    Ok(Exit::Solved)
}
