//! What a command is given that takes problems and plans: a name, a file, or the standard input, which is read once.

use std::path::Path;

use darrt_task::file_kind;
use darrt_task::plan_file::{PlanFile, read::MAX_BYTES};
use darrt_task::problem_file::ProblemFile;
use darrt_task::program::Program;
use darrt_task::text_file::{self, STDIN_NAME};

use crate::exit::Failure;
use crate::output;

/// What is on the standard input: a plan if it begins as JSON does, else a problem. `None` if `source` is not the standard input.
///
/// # Errors
/// What cannot be read, and whatever is neither.
pub(super) fn on_stdin(program: &dyn Program, source: &str) -> Result<Option<Given>, Failure> {
    if !output::is_standard_stream(Path::new(source)) {
        return Ok(None);
    }
    let text = text_file::read_stdin(MAX_BYTES).map_err(|error| Failure::input(error.to_string()))?;
    if file_kind::is_json(text.trim_start_matches('\u{feff}').as_bytes()) {
        return Ok(Some(Given::Plan(Box::new(PlanFile::from_json(&text, STDIN_NAME)?))));
    }
    let problem = ProblemFile::from_toml(&text, STDIN_NAME)?;
    program.check(&problem, STDIN_NAME)?;
    Ok(Some(Given::Problem(Box::new(problem))))
}

/// A plan or a problem.
pub(super) enum Given {
    Plan(Box<PlanFile>),
    Problem(Box<ProblemFile>),
}
