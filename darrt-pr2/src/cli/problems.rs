//! `darrt problems`: what is built in.

use comfy_table::{CellAlignment, ContentArrangement, Table, presets};

use super::args::ProblemsOptions;
use super::exit::{Exit, Failure};
use super::output::Output;
use crate::problem_file::{ProblemFile, builtin, builtin_names, builtin_text};

/// Width of the table in characters.
const WIDTH: u16 = 100;

/// Lists the problems, or prints the text of one.
///
/// # Errors
/// An unknown name.
pub(super) fn run(options: &ProblemsOptions, output: &mut Output) -> Result<Exit, Failure> {
    if let Some(name) = &options.print {
        output.print(builtin_text(name)?)?;
        return Ok(Exit::Solved);
    }
    let problems = builtin_names().into_iter().map(builtin).collect::<Result<Vec<_>, _>>()?;
    output.print(&table(&problems))?;
    output.print("\nPaper: mean planning time of ten trials that the paper reports for the problem of that name.")?;
    output.print("Solve one with `darrt plan NAME`, copy one with `darrt problems --print NAME > FILE`.")?;
    Ok(Exit::Solved)
}

fn table(problems: &[ProblemFile]) -> String {
    let mut table = Table::new();
    table.load_preset(presets::UTF8_HORIZONTAL_ONLY);
    table.set_content_arrangement(ContentArrangement::Dynamic).set_width(WIDTH);
    table.set_header(["name", "what it is about", "paper"]);
    for problem in problems {
        // The title begins with the problem's name, which has a column of its own.
        let title = problem.title.split_once(": ").map_or(problem.title.as_str(), |(_, rest)| rest);
        let paper = problem.paper.as_ref().map_or_else(String::new, |paper| format!("{} s", paper.planning_time_s));
        table.add_row([problem.name.clone(), title.to_owned(), paper]);
    }
    if let Some(column) = table.column_mut(2) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table.trim_fmt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_problem_has_a_row_with_the_time_of_the_paper() {
        let problems: Vec<_> = builtin_names().into_iter().map(|name| builtin(name).unwrap()).collect();
        let text = table(&problems);
        for (name, time) in [("plate1", "257 s"), ("plate3", "480 s"), ("bowl", "66 s"), ("simple-plate", "19 s")] {
            let line = text.lines().find(|line| line.split_whitespace().next() == Some(name)).unwrap();
            assert!(line.ends_with(time), "{line}");
        }
    }
}
