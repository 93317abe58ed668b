//! `darrt bench`: run, keep, tell.

use std::path::{Path, PathBuf};

use darrt_core::budget::Cancel;

use super::{bench_table, plan};
use crate::args::BenchOptions;
use crate::bench::error::Unlike;
use crate::bench::machine::{Machine, cores};
use crate::bench::record::{Key, Record};
use crate::bench::run as workers;
use crate::bench::statistics::summaries;
use crate::bench::variant::VARIANTS;
use crate::bench::{
    BenchError, Collection, Job, JobSet, Journal, Shard, Subject, Variant, journal, kept, ompl_log, report,
};
use crate::exit::{Exit, Failure};
use crate::output::{self, Output};
use crate::progress::Bar;
use darrt_task::planning_error::PlanningError;
use darrt_task::program::Program;
use darrt_task::text::counted;

/// Where results go if nothing else is said.
const DEFAULT_OUT: &str = "bench.jsonl";
/// What to do when the file of results holds runs under other conditions.
const REMEDY: &str = "choose another --out, or delete the file";

/// Runs or merges, and tells the results.
///
/// # Errors
/// Bad names, results that do not go together, files that cannot be written; an interruption keeps what is done.
pub(crate) fn run(program: &dyn Program, options: &BenchOptions, output: &mut Output) -> Result<Exit, Failure> {
    if options.list_variants {
        output.print(&bench_table::variants())?;
        return Ok(Exit::Solved);
    }
    let told = Told::choose(options)?;
    let Measured { all, left_out, end } = if options.merge.is_empty() {
        measure(program, options, output)?
    } else {
        Measured { all: merge(options)?, left_out: Vec::new(), end: End::All }
    };
    for (key, proof) in &left_out {
        output.tell(&format!("left out: {} ({}): {proof}", key.problem, key.variant))?;
    }
    let known = program.problems().first_names();
    told.write(&all, &known)?;
    if !options.quiet {
        let summaries = summaries(&all, &known);
        output.print(&bench_table::times(&summaries))?;
        output.print(&bench_table::efforts(&summaries))?;
        output.print(&bench_table::plans(&summaries))?;
        let words = told.words();
        if !words.is_empty() {
            output.print(&words)?;
        }
    }
    match end {
        End::All if all.is_empty() && !left_out.is_empty() => Ok(Exit::Impossible),
        End::All => Ok(Exit::Solved),
        End::Interrupted { left } => {
            let left = counted(left as u64, "run");
            Err(Failure::new(Exit::Interrupted, format!("interrupted, {left} left: the same command goes on")))
        }
    }
}

/// How the runs ended.
enum End {
    All,
    Interrupted { left: usize },
}

/// What the runs gave.
struct Measured {
    all: Collection,
    /// What is proven to have no plan, of the problems with their variants, and why; they have no runs.
    left_out: Vec<(Key, PlanningError)>,
    end: End,
}

/// Does the runs that are not in the file yet; all that were asked for.
fn measure(program: &dyn Program, options: &BenchOptions, output: &mut Output) -> Result<Measured, Failure> {
    let set = job_set(program, options)?;
    let set = match &options.keep {
        Some(folder) => set.keeping(folder.clone()),
        None => set,
    };
    let path = options.out.clone().unwrap_or_else(|| PathBuf::from(DEFAULT_OUT));
    let path = output::writable(&path)?;
    let machine = Machine::this(options.jobs.unwrap_or_else(|| (cores() / 2).max(1)));
    let (mut journal, contents) = Journal::open(&path)?;
    let jobs: Vec<Job> = set.jobs(options.shard.unwrap_or(Shard::WHOLE)).collect();
    let mut all = taken_up(&set, &jobs, &machine, contents.records, &path)?;
    let left: Vec<Job> = jobs.iter().copied().filter(|job| !all.contains(&set.key(*job))).collect();
    if !options.quiet && !all.is_empty() {
        let torn = if contents.is_torn { ", a torn last line is dropped" } else { "" };
        output.print(&format!("{}: {} are done already{torn}", path.display(), counted(all.len() as u64, "run")))?;
    }
    let cancel = Cancel::new();
    plan::listen(&cancel);
    let progress = Bar::start(left.len(), "runs", options.quiet);
    let mut solved = 0;
    let name = path.display().to_string();
    let proofs = workers::run(program, &set, &left, &machine, &cancel, |record| {
        journal.add(&record)?;
        solved += usize::from(record.is_in_time());
        progress.advance(&format!(", {solved} solved"));
        all.add(record, &name)
    })?;
    progress.finish();
    let is_impossible = |job: &Job| proofs.contains_key(&(job.problem, job.variant));
    let missing = jobs.iter().filter(|job| !is_impossible(job) && !all.contains(&set.key(**job))).count();
    let end = if missing == 0 { End::All } else { End::Interrupted { left: missing } };
    let seed = options.seeds.start;
    let left_out =
        proofs.into_iter().map(|((problem, variant), proof)| (set.key(Job { problem, variant, seed }), proof));
    Ok(Measured { left_out: left_out.collect(), all, end })
}

fn job_set(program: &dyn Program, options: &BenchOptions) -> Result<JobSet, Failure> {
    let builtin = || program.problems().first_names().into_iter().map(str::to_owned).collect();
    let names = if options.problems.is_empty() { builtin() } else { options.problems.clone() };
    let names = names.iter().map(|name| opened(program, name)).collect::<Result<Vec<_>, _>>()?.concat();
    let subjects = names.iter().map(|name| Subject::open(program, name)).collect::<Result<Vec<_>, _>>()?;
    let variants = if options.variants.iter().any(|name| name == "all") {
        VARIANTS.to_vec()
    } else {
        options.variants.iter().map(|name| Variant::named(name)).collect::<Result<Vec<_>, _>>()?
    };
    Ok(JobSet::new(subjects, variants, options.seeds.clone(), options.time_limit, options.iterations)?)
}

/// The problem files in a folder, by name; what is no folder stands for itself.
fn opened(program: &dyn Program, name: &str) -> Result<Vec<String>, Failure> {
    let path = Path::new(name);
    if program.problems().find(name).is_some() || !path.is_dir() {
        return Ok(vec![name.to_owned()]);
    }
    let refuse = |reason: String| Failure::input(format!("{name}: {reason}"));
    let entries = std::fs::read_dir(path).and_then(Iterator::collect::<Result<Vec<_>, _>>);
    let entries = entries.map_err(|error| refuse(format!("cannot be read: {error}")))?;
    let paths = entries.into_iter().map(|entry| entry.path());
    let mut files: Vec<_> = paths.filter(|path| path.extension().is_some_and(|ending| ending == "toml")).collect();
    files.sort();
    if files.is_empty() {
        return Err(refuse("holds no problem file (.toml)".to_owned()));
    }
    Ok(files.into_iter().map(|path| path.to_string_lossy().into_owned()).collect())
}

/// The runs of the file that were asked for.
fn taken_up(
    set: &JobSet,
    jobs: &[Job],
    machine: &Machine,
    records: Vec<Record>,
    path: &Path,
) -> Result<Collection, BenchError> {
    let name = path.display().to_string();
    let asked: std::collections::BTreeMap<Key, Job> = jobs.iter().map(|job| (set.key(*job), *job)).collect();
    let mut all = Collection::default();
    for record in records {
        let key = record.key();
        let Some(expected) = asked.get(&key).and_then(|job| set.conditions(job.problem)) else { continue };
        record.conditions.check(&expected, &key, &name, REMEDY)?;
        if record.machine.build != machine.build {
            let unlike = Unlike {
                file: name,
                run: key.to_string(),
                what: "a program of digest",
                found: record.machine.build,
                expected: machine.build.clone(),
                remedy: REMEDY,
            };
            return Err(unlike.into());
        }
        all.add(record, &name)?;
    }
    Ok(all)
}

/// The results of several files, and the file that they are put into.
fn merge(options: &BenchOptions) -> Result<Collection, Failure> {
    let mut all = Collection::default();
    for path in &options.merge {
        for record in journal::read(path)?.records {
            all.add(record, &path.display().to_string())?;
        }
    }
    if let Some(path) = &options.out {
        let mut text = String::new();
        for record in all.records() {
            text.push_str(&serde_json::to_string(record).map_err(|error| Failure::input(error.to_string()))?);
            text.push('\n');
        }
        output::write_file(&output::writable(path)?, &text)?;
    }
    Ok(all)
}

/// The files to write besides, checked before the work.
struct Told {
    report: Option<PathBuf>,
    logs: Option<PathBuf>,
    plans: Option<PathBuf>,
}

impl Told {
    fn choose(options: &BenchOptions) -> Result<Self, Failure> {
        let report = options.report.as_deref().map(output::writable_page).transpose()?;
        let out = options.out.as_deref().unwrap_or(Path::new(DEFAULT_OUT));
        let problems = options.problems.iter().map(|name| ("problem file", Path::new(name)));
        let results = options.merge.iter().map(|path| ("file of results", path.as_path()));
        if let Some(page) = &report {
            // Those of an earlier run are taken up.
            let read: Vec<_> = problems.chain(results).chain([("file of results", out)]).collect();
            output::keep_apart(&read, &[("page", page)])?;
            output::keep_apart(&[], &[("page", page), ("file of results", out)])?;
        }
        for folder in [&options.ompl, &options.keep].into_iter().flatten() {
            std::fs::create_dir_all(folder).map_err(|error| {
                Failure::new(Exit::CannotWrite, format!("{}: cannot be made: {error}", folder.display()))
            })?;
        }
        Ok(Self { report, logs: options.ompl.clone(), plans: options.keep.clone() })
    }

    fn write(&self, all: &Collection, known: &[&str]) -> Result<(), Failure> {
        if let Some(path) = &self.report {
            let folder = self.plans.as_deref();
            let is_there = |name: &str| folder.is_some_and(|folder| folder.join(name).is_file());
            let link = folder.and_then(|folder| kept::link_to(folder, path));
            let plans = link.map(|link| kept::Kept { link, is_there: &is_there });
            output::write_file(path, report::page(all, known, plans.as_ref()))?;
        }
        let Some(folder) = &self.logs else { return Ok(()) };
        for problem in all.problems(known) {
            let Some(log) = ompl_log::log(all, &problem) else { continue };
            let path = output::writable(&folder.join(format!("{}.log", output::file_stem(&problem))))?;
            output::write_file(&path, &log)?;
        }
        Ok(())
    }

    fn words(&self) -> String {
        let report = self.report.iter().map(|path| format!("report:    {}", path.display()));
        let logs = self.logs.iter().map(|path| format!("OMPL logs: {}", path.join("*.log").display()));
        report.chain(logs).collect::<Vec<_>>().join("\n")
    }
}
