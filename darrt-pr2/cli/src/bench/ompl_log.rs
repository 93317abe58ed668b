//! The results as logs of the Open Motion Planning Library's benchmarks: one log per problem, for
//! `ompl_benchmark_statistics` and Planner Arena.
//!
//! # Source
//! The grammar is that of OMPL's documentation ("How to Benchmark Planners", the benchmark log file format); the parser is
//! OMPL's `ompl_benchmark_statistics.py`. Names stand last on their line and are one word each.

use std::fmt::Write as _;

use super::collection::Collection;
use super::record::Record;
use super::variant::VARIANTS;

/// OMPL's words for how a planner ended, in its order.
const STATUS: &str = "status|Unknown status|Invalid start|Invalid goal|Unrecognized goal type|Timeout|\
                      Approximate solution|Exact solution|Crash|Abort|Infeasible";
/// Place of `Timeout` in [`STATUS`].
const TIMEOUT: &str = "4";
/// Place of `Exact solution` in [`STATUS`].
const EXACT: &str = "6";

/// A value of a run, as the log writes it.
type Value = fn(&Record) -> String;

/// What the log says of each run: OMPL's name and type, and the value; an empty value is none.
const PROPERTIES: [(&str, &str, Value); 17] = [
    ("status", "ENUM", |r| if r.is_in_time() { EXACT } else { TIMEOUT }.to_owned()),
    ("solved", "BOOLEAN", |r| u8::from(r.is_in_time()).to_string()),
    ("approximate solution", "BOOLEAN", |_| "0".to_owned()),
    ("correct solution", "BOOLEAN", |r| u8::from(r.is_in_time()).to_string()),
    ("time", "REAL", |r| r.seconds.total.to_string()),
    ("first plan time", "REAL", |r| optional(r.seconds.first_plan)),
    ("shortening time", "REAL", |r| r.seconds.shortening.to_string()),
    ("verification time", "REAL", |r| r.seconds.verification.to_string()),
    ("preparation time", "REAL", |r| r.seconds.prepare.to_string()),
    ("solution length", "REAL", |r| optional(r.plan.as_ref().map(|p| p.base_m + p.hand_m))),
    ("solution segments", "INTEGER", |r| optional(r.plan.as_ref().map(|p| p.steps))),
    ("solution difference", "REAL", |r| optional(r.nearest_to_goal_m)),
    ("graph states", "INTEGER", |r| r.nodes.to_string()),
    ("iterations", "INTEGER", |r| r.iterations.to_string()),
    ("restarts", "INTEGER", |r| r.restarts.to_string()),
    ("refused plans", "INTEGER", |r| r.refused.to_string()),
    ("seed", "TEXT", |r| r.seed.to_string()),
];

fn optional(value: Option<impl ToString>) -> String {
    value.map_or_else(String::new, |value| value.to_string())
}

/// The log of one problem or family; its runs with one variant are those of one planner. `None` if the problem has no runs.
pub fn log(all: &Collection, problem: &str) -> Option<String> {
    let names = all.variants(&VARIANTS.map(|variant| variant.name));
    let groups = names.iter().map(|name| (name, all.group(problem, name)));
    let groups: Vec<_> = groups.filter(|(_, runs)| !runs.is_empty()).collect();
    let first = groups.first()?.1.first()?;
    let conditions = &first.conditions;
    let runs = || groups.iter().flat_map(|(_, runs)| runs);
    let total: f64 = runs().map(|run| run.seconds.total + run.seconds.prepare).sum();
    let started = runs().map(|run| run.started_unix_s).min().unwrap_or(0);
    let least_runs = groups.iter().map(|(_, runs)| runs.len()).max().unwrap_or(0);
    let machine = &first.machine;
    let mut text = String::new();
    let mut line = |words: std::fmt::Arguments<'_>| {
        // Writing to a string cannot fail.
        let _ = text.write_fmt(words);
        text.push('\n');
    };
    line(format_args!("darrt version {}", word(&conditions.darrt)));
    line(format_args!("Experiment {}", word(problem)));
    line(format_args!("1 experiment properties"));
    line(format_args!("problem_digest TEXT = {}", word(&conditions.problem_digest)));
    line(format_args!("Running on {}", word(&machine.host)));
    line(format_args!("Starting at {}", date(started)));
    line(format_args!("<<<|"));
    line(format_args!("PR2, problem {problem}; the seeds of the runs are their property `seed`"));
    line(format_args!("|>>>"));
    line(format_args!("<<<|"));
    line(format_args!("{}, {} cores, {} runs at a time", machine.cpu, machine.cores, machine.jobs));
    line(format_args!("|>>>"));
    line(format_args!("{} is the random seed", first.seed));
    line(format_args!("{} seconds per run", conditions.time_limit_s));
    line(format_args!("0 MB per run"));
    line(format_args!("{least_runs} runs per planner"));
    line(format_args!("{total} seconds spent to collect the data"));
    line(format_args!("1 enum type"));
    line(format_args!("{STATUS}"));
    line(format_args!("{} planners", groups.len()));
    for (name, runs) in &groups {
        line(format_args!("darrt_{}", word(name)));
        line(format_args!("0 common properties"));
        line(format_args!("{} properties for each run", PROPERTIES.len()));
        for (property, kind, _) in PROPERTIES {
            line(format_args!("{property} {kind}"));
        }
        line(format_args!("{} runs", runs.len()));
        for run in runs {
            let values = PROPERTIES.iter().map(|(_, _, value)| value(run) + "; ");
            line(format_args!("{}", values.collect::<String>()));
        }
        line(format_args!("."));
    }
    Some(text)
}

/// One word: what separates words becomes an underscore.
fn word(name: &str) -> String {
    let word: String = name.chars().map(|c| if c.is_whitespace() || c.is_control() { '_' } else { c }).collect();
    if word.is_empty() { "unknown".to_owned() } else { word }
}

/// `2023-11-14 22:13:20`, in universal time.
///
/// # Source
/// Hinnant, chrono-compatible low-level date algorithms (`civil_from_days`), for days since 1970-01-01.
pub(crate) fn date(unix_s: u64) -> String {
    let (days, second) = (unix_s / 86_400 + 719_468, unix_s % 86_400);
    let (era, day_of_era) = (days / 146_097, days % 146_097);
    let year_of_era = (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    // Years begin in March here.
    let month = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * month + 2) / 5 + 1;
    let (month, later) = if month < 10 { (month + 3, 0) } else { (month - 9, 1) };
    let year = year_of_era + era * 400 + later;
    format!("{year:04}-{month:02}-{day:02} {:02}:{:02}:{:02}", second / 3600, second / 60 % 60, second % 60)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::record::tests::sample;

    /// Reads a log as OMPL's parser does: a count, then so many lines.
    struct Reader<'a>(std::str::Lines<'a>);

    impl<'a> Reader<'a> {
        fn line(&mut self) -> &'a str {
            self.0.next().unwrap()
        }

        fn count(&mut self, ends: &str) -> usize {
            let line = self.line();
            assert!(line.ends_with(ends), "{line}: {ends}");
            line.split_whitespace().next().unwrap().parse().unwrap()
        }

        fn last_word(&mut self, begins: &str) -> &'a str {
            let line = self.line();
            assert!(line.starts_with(begins), "{line}: {begins}");
            line.split_whitespace().last().unwrap()
        }

        fn block(&mut self) -> String {
            assert_eq!(self.line(), "<<<|");
            std::iter::from_fn(|| Some(self.line()).filter(|line| *line != "|>>>")).collect()
        }
    }

    #[test]
    fn the_log_is_read_back_as_the_grammar_says() {
        let mut all = Collection::default();
        for (variant, seed, solved) in [("full", 3, true), ("default", 1, true), ("default", 2, false)] {
            let mut run = sample("my problem", variant, seed, 1.5, solved);
            run.machine.host = String::new();
            all.add(run, "a").unwrap();
        }
        let text = log(&all, "my problem").unwrap();
        let mut reader = Reader(text.lines());
        assert_eq!(reader.last_word("darrt version "), "0.1.0");
        assert_eq!(reader.last_word("Experiment "), "my_problem");
        for _ in 0..reader.count(" experiment properties") {
            assert!(reader.line().contains(" = "));
        }
        assert_eq!(reader.last_word("Running on "), "unknown");
        assert_eq!(reader.line(), "Starting at 2023-11-14 22:13:21");
        assert!(reader.block().contains("my problem") && reader.block().contains("2 cores"));
        assert_eq!(reader.count(" is the random seed"), 1);
        assert_eq!(reader.count(" seconds per run"), 60);
        assert_eq!(reader.count(" MB per run"), 0);
        assert_eq!(reader.count(" runs per planner"), 2);
        assert!(reader.line().ends_with(" seconds spent to collect the data"));
        assert_eq!(reader.count(" enum type"), 1);
        let words: Vec<_> = reader.line().split('|').collect();
        assert_eq!((words[0], words[1 + 4], words[1 + 6]), ("status", "Timeout", "Exact solution"));
        let planners = reader.count(" planners");
        let mut seen = Vec::new();
        for _ in 0..planners {
            let name = reader.line();
            assert_eq!(reader.count(" common properties"), 0);
            let properties = reader.count(" properties for each run");
            let names: Vec<_> = (0..properties).map(|_| reader.line().rsplit_once(' ').unwrap().0).collect();
            for _ in 0..reader.count(" runs") {
                let values: Vec<_> = reader.line().split("; ").collect();
                assert_eq!(values.len(), properties + 1, "a separator after the last value too");
                let value = |name: &str| values[names.iter().position(|other| *other == name).unwrap()];
                seen.push((name, value("seed"), value("status"), value("time"), value("solution segments")));
            }
            assert_eq!(reader.line(), ".");
        }
        let expected = [
            ("darrt_default", "1", EXACT, "1.5", "5"),
            ("darrt_default", "2", TIMEOUT, "1.5", ""),
            ("darrt_full", "3", EXACT, "1.5", "5"),
        ];
        assert_eq!(seen, expected);
        assert!(reader.0.next().is_none());
        assert!(log(&all, "bowl").is_none());
    }

    #[test]
    fn dates_are_those_of_the_calendar() {
        for (second, expected) in [
            (0, "1970-01-01 00:00:00"),
            (951_782_399, "2000-02-28 23:59:59"),
            (951_782_400, "2000-02-29 00:00:00"),
            (951_868_800, "2000-03-01 00:00:00"),
            (1_735_689_599, "2024-12-31 23:59:59"),
            (4_107_542_400, "2100-03-01 00:00:00"),
        ] {
            assert_eq!(date(second), expected);
        }
    }
}
