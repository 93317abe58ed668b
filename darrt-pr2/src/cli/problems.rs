//! `darrt problems`: what is built in.

use comfy_table::ContentArrangement;

use super::args::ProblemsOptions;
use super::exit::{Exit, Failure};
use super::output::Output;
use super::table;
use crate::problem_file::{
    ProblemFile, builtin, builtin_names, builtin_text, everyday_names, further_names, hopeless_names,
};

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
    for (number, (heading, names)) in groups().into_iter().enumerate() {
        let problems = names.into_iter().map(builtin).collect::<Result<Vec<_>, _>>()?;
        output.print(&format!("{}{heading}", if number == 0 { "" } else { "\n" }))?;
        output.print(&list(&problems))?;
    }
    output.print("\nPaper: mean planning time of ten trials that the paper reports for the problem of that name.")?;
    output.print("Solve one with `darrt plan NAME`, copy one with `darrt problems --print NAME > FILE`.")?;
    Ok(Exit::Solved)
}

/// Headings, and the names under each.
fn groups() -> [(&'static str, Vec<&'static str>); 4] {
    [
        ("The paper's problems", builtin_names().to_vec()),
        ("Two tables, several objects", further_names().to_vec()),
        ("Everyday problems, each with one thing that is easy to get wrong", everyday_names().to_vec()),
        ("Without a plan, and the answer says why", hopeless_names().to_vec()),
    ]
}

fn list(problems: &[ProblemFile]) -> String {
    let from_paper = problems.iter().any(|problem| problem.paper.is_some());
    let header = ["name", "what it is about", "paper"];
    let mut table = table::with_header(header.into_iter().take(if from_paper { 3 } else { 2 }));
    table.set_content_arrangement(ContentArrangement::Dynamic).set_width(WIDTH);
    for problem in problems {
        // The title begins with the problem's name, which has a column of its own.
        let title = problem.title.split_once(": ").map_or(problem.title.as_str(), |(_, rest)| rest);
        let paper = problem.paper.as_ref().map_or_else(String::new, |paper| format!("{} s", paper.planning_time_s));
        let row = [problem.name.clone(), title.to_owned(), paper];
        table.add_row(row.into_iter().take(if from_paper { 3 } else { 2 }));
    }
    if from_paper { table::finished(table, [2]) } else { table::finished(table, []) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_problem_has_a_row_with_the_time_of_the_paper() {
        let names = groups().into_iter().flat_map(|(_, names)| names);
        let problems: Vec<_> = names.map(|name| builtin(name).unwrap()).collect();
        let text = list(&problems);
        for (name, time) in [("plate1", "257 s"), ("plate3", "480 s"), ("bowl", "66 s"), ("simple-plate", "19 s")] {
            let line = text.lines().find(|line| line.split_whitespace().next() == Some(name)).unwrap();
            assert!(line.ends_with(time), "{line}");
        }
    }
}
