//! `darrt plan`: solve, verify, print, write.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use darrt_core::budget::{Cancel, Stop};
use darrt_core::search::Algorithm;

use super::check;
use crate::args::PlanOptions;
use crate::exit::{Exit, Failure};
use crate::output::{self, Output};
use crate::progress::Progress;
use crate::why_page::{self, Told};
use crate::{browser, diagnosis, drawing, safety, statistics, steps};
use darrt_task::diagnosis::Diagnosis;
use darrt_task::picture::{Extent, Format, Story, Travel};
use darrt_task::plan_file::PlanFile;
use darrt_task::planning::{PlanRequest, PlanResult};
use darrt_task::planning_error::PlanningError;
use darrt_task::problem_file::ProblemFile;
use darrt_task::program::Program;
use darrt_task::recording::Recording;
use darrt_task::replan::{ReplanRequest, Replanned};
use darrt_task::robot::{RobotError, RobotFacts};
use darrt_task::text::{counted, on_one_line};
use darrt_task::viewer::RobotModel;
use darrt_task::viewer::search::SearchData;

/// So long it is looked for reasons after any search.
const A_MOMENT: Duration = Duration::from_secs(5);
/// How often the clock is looked at meanwhile.
const BETWEEN_LOOKS: Duration = Duration::from_millis(20);

/// Plans and reports.
///
/// # Errors
/// Every end but a verified plan that is written, with its exit code.
pub(crate) fn run(program: &dyn Program, options: &PlanOptions, output: &mut Output) -> Result<Exit, Failure> {
    // A plan on the standard output is alone there.
    let is_quiet = options.quiet || options.output.as_deref().is_some_and(output::is_standard_stream);
    let problem = options
        .safety
        .applied(opened(program, (&options.problem, options.robot.as_ref()), is_quiet, output)?, &options.problem)?;
    check_recorded(options)?;
    let files = Files::choose(options)?;
    let request = request(options, problem);
    let cancel = Cancel::new();
    listen(&cancel);
    let mut progress = Progress::start(&request.problem.name, limit(&request), options.quiet);
    let (result, kept) = planned(program, options, (&request, &files), &cancel, &mut progress)?;
    progress.finish();
    if let Some(kept) = kept.filter(|_| !is_quiet) {
        output.tell(&kept)?;
    }
    if options.stats && !is_quiet {
        output.print(&statistics::report(&result.accounts))?;
    }
    let (Some(plan), Some(proof)) = (&result.plan, &result.proof) else {
        return Err(failed(program, options, (&request, &result), (&files, &cancel), output)?);
    };
    let robot = program.facts(&plan.problem).map_err(|error| Failure::input(error.to_string()))?;
    let story = Story::of_plan(plan, &robot)?;
    // First of all: a terminal that has gone away must not cost the plan.
    files.put(plan, output)?;
    if !is_quiet {
        output.tell(&summary(&request, &result, cancel.is_cancelled()))?;
        if let Some(words) = improvement(&result, &story, &robot)? {
            output.tell(&words)?;
        }
        output.print(&steps::table(&story))?;
        output.tell(&check::words(proof))?;
        match (&plan.timing, &result.no_clock) {
            (Some(timing), _) => output.print(&check::clock(timing))?,
            (None, Some(why)) => output.tell(&format!("notice:   {why}"))?,
            (None, None) => {}
        }
        output.tell(&safety::margins(&request.problem))?;
        if !proof.warnings.is_empty() {
            output.tell(&safety::notices(&proof.warnings))?;
        }
        check::notices(plan, output)?;
        for shown in result.doubts.iter().filter_map(|doubt| doubt.refuted.as_ref()) {
            output.tell(&format!("notice:   {shown}"))?;
        }
    }
    // Last: nobody waits for a picture to read the steps.
    files.keep(&result)?;
    files.draw(plan, &story, &robot, result.recording.as_ref())?;
    if !is_quiet {
        output.print(&files.words(&result))?;
    }
    if let Some((path, _)) = files.picture.as_ref().filter(|_| options.open) {
        browser::open(path)?;
    }
    Ok(Exit::Solved)
}

/// The problem, with the robot that is asked for.
///
/// # Errors
/// What cannot be read, or does not fit the robot.
pub(super) fn opened(
    program: &dyn Program,
    (name, robot): (&str, Option<&String>),
    quiet: bool,
    output: &mut Output,
) -> Result<ProblemFile, Failure> {
    let Some(robot) = robot else { return Ok(program.open(name)?) };
    let problem = program.problems().open(name)?;
    let failed = |error: RobotError| Failure::input(located(name, &error.to_string()));
    let (problem, changes) = program.with_robot(problem, robot).map_err(failed)?;
    program.check(&problem, name)?;
    if !quiet {
        changes.iter().try_for_each(|change| output.tell(&format!("{}: {change}", problem.name)))?;
    }
    Ok(problem)
}

/// Searches whose trees are not of the whole problem are not recorded.
fn check_recorded(options: &PlanOptions) -> Result<(), Failure> {
    let whole = [Algorithm::Darrt, Algorithm::Connect];
    match options.search.algorithms().iter().find(|algorithm| !whole.contains(algorithm)) {
        Some(other) if options.record.is_some() => Err(Failure::input(format!(
            "--record: the search `{other}` has no tree of the whole problem; choose --search darrt or connect"
        ))),
        _ => Ok(()),
    }
}

fn request(options: &PlanOptions, problem: ProblemFile) -> PlanRequest {
    PlanRequest {
        problem,
        seed: options.seed,
        threads: options.threads,
        time_limit: options.time_limit,
        iterations: options.iterations,
        restart: options.restart,
        sampler: options.sampler.clone().map(Into::into),
        distance: options.distance.clone().map(Into::into),
        algorithms: options.search.algorithms(),
        improve: options.improve.map(Into::into),
        as_found: options.no_improve,
        bases_from_reachability: false,
        cost: options.cost.clone().map_or_else(Default::default, Into::into),
        changes: Vec::new(),
        hints: Vec::new(),
        record: options.record.is_some(),
    }
}

/// Plans, from an old plan if there is one; what is kept of that in words.
fn planned(
    program: &dyn Program,
    options: &PlanOptions,
    (request, files): (&PlanRequest, &Files),
    cancel: &Cancel,
    progress: &mut Progress,
) -> Result<(PlanResult, Option<String>), Failure> {
    let refused = |error: PlanningError| refused(program, options, (request, files), &error);
    let Some(path) = &options.from else {
        return Ok((program.plan(request, cancel, progress).map_err(refused)?, None));
    };
    let from = check::read(program, path)?;
    let keep = options.keep.map(|keep| usize::try_from(keep).unwrap_or(usize::MAX));
    let whole = ReplanRequest { plan: request.clone(), from, keep };
    let Replanned { result, kept, tail, of, refused: why } =
        program.replan(&whole, cancel, progress).map_err(refused)?;
    let steps = counted(of as u64, "step");
    let kept = match (kept, tail) {
        (0, 0) => "none is kept".to_owned(),
        (kept, 0) if kept == of => "all are kept".to_owned(),
        (kept, 0) => format!("the first {kept} are kept"),
        (0, tail) => format!("the last {tail} are kept"),
        (kept, tail) => format!("the first {kept} and the last {tail} are kept"),
    };
    let why = why.map_or_else(String::new, |why| format!("; the plan is no longer right: {why}"));
    Ok((result, Some(format!("from {}: of {steps} {kept}{why}", path.display()))))
}

fn limit(request: &PlanRequest) -> Option<Duration> {
    request.time_limit.or_else(|| Duration::try_from_secs_f64(request.problem.budget.time_limit_s).ok())
}

/// Cancels on Ctrl-C and on a request to terminate; without a handler the system's default does it less politely.
pub(crate) fn listen(cancel: &Cancel) {
    let cancel = cancel.clone();
    let _ = ctrlc::set_handler(move || cancel.cancel());
}

/// The message with the name of the problem in front, unless it says where by itself.
fn located(problem: &str, message: &str) -> String {
    if message.contains(problem) { message.to_owned() } else { format!("{problem}: {message}") }
}

/// Tells why there is no plan, and writes the beginning of one if there is any.
fn failed(
    program: &dyn Program,
    options: &PlanOptions,
    (request, result): (&PlanRequest, &PlanResult),
    (files, cancel): (&Files, &Cancel),
    output: &mut Output,
) -> Result<Failure, Failure> {
    let name = &request.problem.name;
    let diagnosis = program
        .diagnose(request, result, &patience(cancel, result.elapsed))
        .map_err(|error| Failure::input(located(&options.problem, &error.to_string())))?;
    write_why(options, &diagnosis)?;
    if options.stats && !output::is_standard_stream(&files.plan) {
        output.print(&diagnosis::details(result, &diagnosis))?;
    }
    let mut why = diagnosis::explain(result, &diagnosis);
    let mut exit = if result.stop == Stop::Cancelled { Exit::Interrupted } else { Exit::NotSolved };
    if let Some((plan, _)) = &result.partial {
        let path = files.write_partial(program, plan, output)?;
        why = format!("{why}\n  {}", diagnosis::text::of_partial(plan, &path));
        exit = Exit::Partial;
    }
    let told = Told { problem: &request.problem, result: Some(result), diagnosis: &diagnosis };
    // What cannot be written or opened must not hide why there is no plan.
    // Who interrupts does not wait for a page.
    let is_wanted = exit != Exit::Interrupted;
    let page = || if is_wanted { files.write_why(program, &told) } else { Ok(None) };
    match files.keep(result).and_then(|()| page()) {
        Ok(None) => {}
        Ok(Some(page)) => {
            why = format!("{why}\n  to see it: {}", page.display());
            if let Err(failure) = if options.open { browser::open(&page) } else { Ok(()) } {
                why = format!("{why}\n  {}", failure.message);
            }
        }
        Err(failure) => {
            why = format!("{why}\n  {}", failure.message);
            exit = failure.exit;
        }
    }
    Ok(Failure::new(exit, format!("{name}: no plan found (seed {}): {why}", request.seed)))
}

/// Nobody waits for reasons longer than for the plan, or than a moment; after a search that was interrupted, than that.
fn patience(cancel: &Cancel, searched: Duration) -> Cancel {
    let (over, was_interrupted) = (Cancel::new(), cancel.is_cancelled());
    let end = Instant::now() + if was_interrupted { A_MOMENT } else { searched.max(A_MOMENT) };
    let (clock, interrupt) = (over.clone(), cancel.clone());
    std::thread::spawn(move || {
        while Instant::now() < end && (was_interrupted || !interrupt.is_cancelled()) {
            std::thread::sleep(BETWEEN_LOOKS);
        }
        clock.cancel();
    });
    over
}

/// The error of a problem that cannot be planned; what keeps a plan away is written down as well, and drawn.
fn refused(
    program: &dyn Program,
    options: &PlanOptions,
    (request, files): (&PlanRequest, &Files),
    error: &PlanningError,
) -> Failure {
    let exit = Exit::from(error);
    let message = on_one_line(&located(&options.problem, &error.to_string())).into_owned();
    let Some(diagnosis) = Diagnosis::of_error(&request.problem.name, error) else {
        let unwritten = |path: &PathBuf| {
            format!("{message}; --why: there is no search to explain, {} is not written", path.display())
        };
        return Failure::new(exit, options.why.as_ref().map_or_else(|| message.clone(), unwritten));
    };
    if let Err(failure) = write_why(options, &diagnosis) {
        return failure;
    }
    let told = Told { problem: &request.problem, result: None, diagnosis: &diagnosis };
    match files.write_why(program, &told) {
        Err(failure) => Failure::new(exit, format!("{message}; {}", failure.message)),
        Ok(Some(page)) => Failure::new(exit, format!("{message}; to see it: {}", page.display())),
        Ok(None) => Failure::new(exit, message),
    }
}

/// Writes the diagnosis where `--why` says.
fn write_why(options: &PlanOptions, diagnosis: &Diagnosis) -> Result<(), Failure> {
    let Some(path) = &options.why else { return Ok(()) };
    let text = serde_json::to_string_pretty(diagnosis).map_err(|error| Failure::input(error.to_string()))?;
    output::write_file(path, (text + "\n").as_bytes())
}

/// Plans that are improved end with "solved" also when they were interrupted: a plan there is, but it might have been better.
fn summary(request: &PlanRequest, result: &PlanResult, is_interrupted: bool) -> String {
    let solved = match request.improve {
        Some(_) => format!("the best of {} in", counted(result.plans, "plan")),
        None => "solved in".to_owned(),
    };
    format!(
        "{}: {solved} {}{} (seed {}, {}, {}, largest tree {})",
        request.problem.name,
        diagnosis::seconds(result.elapsed),
        if is_interrupted { ", interrupted" } else { "" },
        request.seed,
        counted(result.iterations, "iteration"),
        counted(result.restarts, "restart"),
        counted(result.nodes as u64, "node")
    )
}

/// What improving the plan did; `None` if it is as it was found.
///
/// # Errors
/// The plan that was found cannot be told.
fn improvement(result: &PlanResult, story: &Story, robot: &RobotFacts) -> Result<Option<String>, Failure> {
    let (Some((found, found_s)), Some(seconds)) = (&result.found, result.execution_s) else { return Ok(None) };
    let before = Story::of_plan(found, robot)?;
    let [from, to] = [&before, story]
        .map(|story| story.steps.iter().fold(Travel::default(), |sum, step| sum.plus(&Travel::of(story, step))));
    let steps = [before.steps.len(), story.steps.len()];
    if seconds > *found_s {
        // What was found is shorter because it was not looked at whether all of it is free.
        return Ok(Some(format!(
            "improved: found with {} of {found_s:.0} s, in some of which something was in the way; free in {} of {seconds:.0} s, \
             {:.1} m driven, {:.0} degrees turned, {:.0} rad of arm travel",
            counted(steps[0] as u64, "step"),
            counted(steps[1] as u64, "step"),
            to.base_m,
            to.base_turn.to_degrees(),
            to.arm_turn,
        )));
    }
    Ok(Some(format!(
        "improved: {} to {} steps, {:.1} to {:.1} m driven, {:.0} to {:.0} degrees turned, {:.0} to {:.0} rad of arm travel, \
         {found_s:.0} to {seconds:.0} s",
        steps[0],
        steps[1],
        from.base_m,
        to.base_m,
        from.base_turn.to_degrees(),
        to.base_turn.to_degrees(),
        from.arm_turn,
        to.arm_turn,
    )))
}

/// The files to write, checked before the work.
struct Files {
    /// Also [the standard output](output::is_standard_stream).
    plan: PathBuf,
    picture: Option<(PathBuf, Format)>,
    record: Option<PathBuf>,
}

impl Files {
    fn choose(options: &PlanOptions) -> Result<Self, Failure> {
        // Named after what the user named: a copy of a problem must not overwrite the plan of the original.
        let asked = Path::new(&options.problem);
        let stem = asked.file_stem().map_or_else(|| options.problem.clone(), |s| s.to_string_lossy().into_owned());
        let default = || PathBuf::from(format!("{}.plan.json", output::file_stem(&stem)));
        let plan = options.output.clone().unwrap_or_else(default);
        let picture = match (&options.picture, options.no_picture) {
            (_, true) => None,
            (Some(path), _) => Some(path.clone()),
            (None, _) if output::is_standard_stream(&plan) => None,
            (None, _) => Some(beside(&plan)),
        };
        let plan = if output::is_standard_stream(&plan) { plan } else { output::writable(&plan)? };
        let picture = match picture {
            Some(path) => Some((output::writable(&path)?, Format::of_path(&path)?)),
            None => None,
        };
        let record = options.record.as_deref().map(output::writable).transpose()?;
        let why = options.why.as_deref().map(output::writable).transpose()?;
        let mut read = vec![("problem file", asked)];
        let mut written = vec![("plan", plan.as_path())];
        written.extend(picture.as_ref().map(|(path, _)| ("picture", path.as_path())));
        let further: Vec<_> = [("recorded search", &record), ("reasons", &why)]
            .into_iter()
            .filter_map(|(what, path)| Some((what, path.as_deref()?)))
            .collect();
        // A plan may take the place of the one that it was made from.
        if let Some(from) = &options.from {
            output::keep_apart(&[("old plan", from.as_path())], &further)?;
        }
        if let Some(robot) = &options.robot {
            read.push(("robot file", Path::new(robot)));
        }
        written.extend(further);
        output::keep_apart(&read, &written)?;
        Ok(Self { plan, picture, record })
    }

    fn draw(
        &self,
        plan: &PlanFile,
        story: &Story,
        robot: &RobotFacts,
        recording: Option<&Recording>,
    ) -> Result<(), Failure> {
        match &self.picture {
            Some((path, Format::Html)) => {
                let search = recording.map(SearchData::of);
                let page = drawing::page(story, Some(plan), &RobotModel::of(robot)?, (Extent::Whole, None, search))?;
                output::write_file(path, page)
            }
            Some((path, format)) => {
                output::write_file(path, drawing::file(story, Some(plan), robot, *format, Extent::Whole)?)
            }
            None => Ok(()),
        }
    }

    /// Puts the plan where it was asked for.
    fn put(&self, plan: &PlanFile, output: &mut Output) -> Result<(), Failure> {
        if output::is_standard_stream(&self.plan) {
            return output.print(&plan.to_json_in(Path::new("."))?);
        }
        Ok(plan.write(&self.plan)?)
    }

    /// Writes the recorded search, if there is one.
    fn keep(&self, result: &PlanResult) -> Result<(), Failure> {
        match (&self.record, &result.recording) {
            (Some(path), Some(recording)) => Ok(recording.write(path)?),
            _ => Ok(()),
        }
    }

    /// Writes the page that tells why there is no plan, unless no page is wanted; says where.
    fn write_why(&self, program: &dyn Program, told: &Told<'_>) -> Result<Option<PathBuf>, Failure> {
        let Some((picture, Format::Html)) = &self.picture else { return Ok(None) };
        let path = with_mark(picture, "why");
        output::write_file(&path, why_page::page(program, told)?)?;
        Ok(Some(path))
    }

    /// Writes the beginning of a plan beside where the plan would be, and its picture; says where.
    fn write_partial(&self, program: &dyn Program, plan: &PlanFile, output: &mut Output) -> Result<PathBuf, Failure> {
        let is_stdout = output::is_standard_stream(&self.plan);
        let path = if is_stdout { PathBuf::from("the standard output") } else { with_mark(&self.plan, "partial") };
        if is_stdout {
            self.put(plan, output)?;
        } else {
            plan.write(&path)?;
        }
        // A page tells why there is no plan as well, and is written then.
        if let Some((picture, format)) = self.picture.as_ref().filter(|(_, format)| *format != Format::Html) {
            let robot = program.facts(&plan.problem).map_err(|error| Failure::input(error.to_string()))?;
            let story = Story::of_plan(plan, &robot)?;
            let bytes = drawing::file(&story, Some(plan), &robot, *format, Extent::Whole)?;
            output::write_file(&with_mark(picture, "partial"), bytes)?;
        }
        Ok(path)
    }

    fn words(&self, result: &PlanResult) -> String {
        let mut words = format!("plan:     {}", self.plan.display());
        if let Some((path, _)) = &self.picture {
            let _ = write!(words, "\npicture:  {}", path.display());
        }
        if let Some(path) = &self.record {
            let _ = match result.recording {
                Some(_) => write!(words, "\nsearch:   {}", path.display()),
                None => write!(words, "\nsearch:   there was none, {} is not written", path.display()),
            };
        }
        words
    }
}

/// Where something else goes than the plan that would be written to `path`: with the mark `partial`, `a/b.plan.json` and
/// `a/b.json` have `a/b.partial.json`. What an earlier run wrote there stays.
fn with_mark(path: &Path, mark: &str) -> PathBuf {
    let bare = path.with_extension("");
    let bare = if bare.extension().is_some_and(|ending| ending == "plan") { bare.with_extension("") } else { bare };
    let mut name = bare.into_os_string();
    name.push(".");
    name.push(mark);
    if let Some(ending) = path.extension() {
        name.push(".");
        name.push(ending);
    }
    PathBuf::from(name)
}

/// The picture that belongs to a plan file: `a/b.plan.json` and `a/b.json` have `a/b.html`.
fn beside(plan: &Path) -> PathBuf {
    let bare = plan.with_extension("");
    let bare = if bare.extension().is_some_and(|ending| ending == "plan") { bare.with_extension("") } else { bare };
    let mut name = bare.into_os_string();
    name.push(".html");
    PathBuf::from(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_picture_lies_beside_the_plan() {
        for (plan, picture) in [
            ("plate3.plan.json", "plate3.html"),
            ("a/p.json", "a/p.html"),
            ("a.b/p", "a.b/p.html"),
            ("v1.2.json", "v1.2.html"),
        ] {
            assert_eq!(beside(Path::new(plan)), Path::new(picture));
        }
    }

    #[test]
    fn the_beginning_of_a_plan_lies_beside_it() {
        for (plan, partial) in [
            ("plate3.plan.json", "plate3.partial.json"),
            ("a/p.json", "a/p.partial.json"),
            ("a.b/p", "a.b/p.partial"),
            ("p.html", "p.partial.html"),
        ] {
            assert_eq!(with_mark(Path::new(plan), "partial"), Path::new(partial));
        }
    }

    #[test]
    fn a_message_names_the_problem_once() {
        assert_eq!(located("a.toml", "a.toml: wrong"), "a.toml: wrong");
        assert_eq!(located("a.toml", "wrong"), "a.toml: wrong");
    }
}
