//! `darrt problems`: what is built in.

use crate::args::ProblemsOptions;
use crate::exit::{Exit, Failure};
use crate::output::Output;
use crate::table;
use darrt_task::problem_file::ProblemFile;
use darrt_task::program::Program;

/// Lists the problems, or prints the text of one.
///
/// # Errors
/// An unknown name.
pub(crate) fn run(program: &dyn Program, options: &ProblemsOptions, output: &mut Output) -> Result<Exit, Failure> {
    let collection = program.problems();
    if let Some(name) = &options.print {
        output.print(collection.find(name).ok_or_else(|| collection.unknown(name))?.text)?;
        return Ok(Exit::Solved);
    }
    for (number, group) in collection.groups().iter().enumerate() {
        let problems =
            group.problems.iter().map(|problem| collection.read(problem.name)).collect::<Result<Vec<_>, _>>()?;
        output.print(&format!("{}{}", if number == 0 { "" } else { "\n" }, group.title))?;
        output.print(&list(&problems))?;
    }
    output.tell("\nPaper: mean planning time of ten trials that the paper reports for the problem of that name.")?;
    output.tell("Solve one with `darrt plan NAME`, copy one with `darrt problems --print NAME > FILE`.")?;
    Ok(Exit::Solved)
}

fn list(problems: &[ProblemFile]) -> String {
    let from_paper = problems.iter().any(|problem| problem.paper.is_some());
    let header = ["name", "what it is about", "paper"];
    let mut table = table::with_header(header.into_iter().take(if from_paper { 3 } else { 2 }));
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
        let collection = darrt_pr2::problems::collection();
        let problems: Vec<_> = collection.all().map(|problem| collection.read(problem.name).unwrap()).collect();
        let text = list(&problems);
        for (name, time) in [("plate1", "257 s"), ("plate3", "480 s"), ("bowl", "66 s"), ("simple-plate", "19 s")] {
            let line = text.lines().find(|line| line.split_whitespace().next() == Some(name)).unwrap();
            assert!(line.ends_with(time), "{line}");
        }
    }
}
