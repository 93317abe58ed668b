//! `darrt problems`: what is built in.

use comfy_table::ContentArrangement;

use super::args::ProblemsOptions;
use super::exit::{Exit, Failure};
use super::output::Output;
use super::table;
use crate::problem_file::{ProblemFile, builtin, builtin_names, builtin_text, further_names};

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
    let problems = builtin_names().into_iter().chain(further_names()).map(builtin).collect::<Result<Vec<_>, _>>()?;
    output.print(&list(&problems))?;
    output.print("\nPaper: mean planning time of ten trials that the paper reports for the problem of that name.")?;
    output.print("Solve one with `darrt plan NAME`, copy one with `darrt problems --print NAME > FILE`.")?;
    Ok(Exit::Solved)
}

fn list(problems: &[ProblemFile]) -> String {
    let mut table = table::with_header(["name", "what it is about", "paper"]);
    table.set_content_arrangement(ContentArrangement::Dynamic).set_width(WIDTH);
    for problem in problems {
        // The title begins with the problem's name, which has a column of its own.
        let title = problem.title.split_once(": ").map_or(problem.title.as_str(), |(_, rest)| rest);
        let paper = problem.paper.as_ref().map_or_else(String::new, |paper| format!("{} s", paper.planning_time_s));
        table.add_row([problem.name.clone(), title.to_owned(), paper]);
    }
    table::finished(table, [2])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_problem_has_a_row_with_the_time_of_the_paper() {
        let problems: Vec<_> =
            builtin_names().into_iter().chain(further_names()).map(|name| builtin(name).unwrap()).collect();
        let text = list(&problems);
        for (name, time) in [("plate1", "257 s"), ("plate3", "480 s"), ("bowl", "66 s"), ("simple-plate", "19 s")] {
            let line = text.lines().find(|line| line.split_whitespace().next() == Some(name)).unwrap();
            assert!(line.ends_with(time), "{line}");
        }
    }
}
