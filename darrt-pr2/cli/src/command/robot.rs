//! `darrt robot`: robots that come as files.

use std::path::{Path, PathBuf};

use darrt_task::file_kind::FileKind;
use darrt_task::file_robot::inspect::{Inspection, inspect};
use darrt_task::file_robot::{guess, shipped, trial};
use darrt_task::picture::{Extent, Format, Story};
use darrt_task::problem_file::ProblemFile;
use darrt_task::problem_file::read::MAX_BYTES;
use darrt_task::program::Program;
use darrt_task::robot_file::Source;
use darrt_task::text::shell_word;
use darrt_task::text_file;

use crate::args::{RobotCheckOptions, RobotCommand, RobotListOptions, RobotNewOptions, RobotOptions};
use crate::bench::digest::digest;
use crate::drawing;
use crate::exit::{Exit, Failure};
use crate::output::{self, Output};
use crate::table;

/// Does what is asked.
///
/// # Errors
/// What cannot be read, used or written.
pub(crate) fn run(program: &dyn Program, options: &RobotOptions, output: &mut Output) -> Result<Exit, Failure> {
    match &options.command {
        RobotCommand::List(options) => list(options, output),
        RobotCommand::Check(options) => check(program, options, output),
        RobotCommand::New(options) => new(options, output),
    }
}

fn list(options: &RobotListOptions, output: &mut Output) -> Result<Exit, Failure> {
    if let Some(name) = options.print.as_ref().or(options.print_urdf.as_ref()) {
        let robot = shipped::find(name)?;
        output.print(if options.print.is_some() { robot.text } else { robot.urdf }.trim_end())?;
        return Ok(Exit::Solved);
    }
    let mut rows = table::with_header(["name", "what it is"]);
    for robot in shipped::all() {
        let source = Source::from_text(robot.text, robot.name)?;
        rows.add_row([robot.name.to_owned(), source.file.title]);
    }
    output.print(&table::finished(rows, []))?;
    output.tell(
        "\nPlan for one with `darrt plan PROBLEM --robot NAME`, copy one with `darrt robot list --print NAME > FILE`.",
    )?;
    Ok(Exit::Solved)
}

fn check(program: &dyn Program, options: &RobotCheckOptions, output: &mut Output) -> Result<Exit, Failure> {
    let name = &options.robot;
    not_stdin(Path::new(name))?;
    let inspection = inspect(name)?;
    output.print(&format!("{name}: {}", inspection.name))?;
    inspection.understood.iter().try_for_each(|line| output.tell(line))?;
    if options.pairs {
        inspection.pairs.iter().try_for_each(|line| output.print(&format!("pair:     {line}")))?;
    }
    inspection.odd.iter().try_for_each(|line| output.tell(&format!("odd:      {line}")))?;
    if let Some(path) = &options.problem {
        if path.exists() && FileKind::of_file(path) != Some(FileKind::Problem) {
            let text = format!("{}: is there already and is no problem, it would be lost", path.display());
            return Err(Failure::input(text));
        }
        if path.exists() && !is_unedited(path) {
            let text =
                "is there already and was edited, or written by somebody else, and would be lost; give another name";
            return Err(Failure::input(format!("{}: {text}", path.display())));
        }
        let place = output::writable_problem(path)?;
        let line = robot_line(name, path);
        output::write_file(&place, sealed(&trial::problem(&inspection, &line, inspection.drives)))?;
        output.print(&format!("problem:  {}", path.display()))?;
    }
    if !options.no_picture {
        let default = || PathBuf::from(format!("{}.robot.html", output::file_stem(&inspection.name)));
        let path = options.picture.clone().unwrap_or_else(default);
        draw(program, &inspection, name, &path)?;
        output.print(&format!("picture:  {}", path.display()))?;
    }
    if inspection.odd.is_empty() {
        output.print("nothing is odd")?;
    }
    Ok(Exit::Solved)
}

/// What begins the last line of a first problem; the digest of all lines before it follows.
const SEAL: &str = "# As `darrt robot check` wrote it, which writes over it until it is edited: ";

/// The text of a problem with a last line by which it is known as long as nobody edits it.
fn sealed(text: &str) -> String {
    let text = text.trim_end();
    format!("{text}\n{SEAL}{}\n", digest(text.as_bytes()))
}

/// Is a problem there as it was written by this program?
fn is_unedited(path: &Path) -> bool {
    let Ok(text) = text_file::read(path, MAX_BYTES) else { return false };
    text.is_empty() || text.rsplit_once(SEAL).is_some_and(|(before, _)| sealed(before) == text)
}

/// Is this the name of a robot that ships?
pub(super) fn is_shipped(name: &str) -> bool {
    shipped::all().iter().any(|robot| robot.name == name)
}

/// The line of a problem file at `problem` that names the robot.
fn robot_line(name: &str, problem: &Path) -> String {
    let quoted = |text: &str| serde_json::Value::from(text).to_string();
    if is_shipped(name) {
        return format!("model = {}", quoted(name));
    }
    // From the folder of the problem, as far as that is simple; else from the root.
    let folder = |path: &Path| {
        path.parent()
            .map(|folder| if folder.as_os_str().is_empty() { Path::new(".") } else { folder }.canonicalize().ok())
    };
    let path = Path::new(name);
    let same = folder(path) == folder(problem);
    let whole = std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf());
    let file = if same { path.file_name().map_or(whole, PathBuf::from) } else { whole };
    format!("file = {}", quoted(&file.to_string_lossy()))
}

/// The robot before its first problem; where the picture is.
///
/// # Errors
/// What cannot be built, drawn or written.
pub(super) fn draw(
    program: &dyn Program,
    inspection: &Inspection,
    name: &str,
    path: &Path,
) -> Result<PathBuf, Failure> {
    let format = Format::of_path(path)?;
    let place = output::writable(path)?;
    let here = Path::new("problem.toml");
    let text = trial::problem(inspection, &robot_line(name, here), inspection.drives);
    let problem = ProblemFile::from_toml(&text, &inspection.name)?;
    let robot = program.facts(&problem).map_err(|error| Failure::input(error.to_string()))?;
    let story = Story::of_problem(&problem, &robot)?;
    output::write_file(&place, &drawing::file(&story, None, &robot, format, Extent::Whole)?)?;
    Ok(place)
}

/// Robots are files that name other files.
fn not_stdin(path: &Path) -> Result<(), Failure> {
    if output::is_standard_stream(path) {
        let why = "a robot is read from a file, not from the standard input, for it names files that lie beside it";
        return Err(Failure::input(format!("{}: {why}", path.display())));
    }
    Ok(())
}

fn new(options: &RobotNewOptions, output: &mut Output) -> Result<Exit, Failure> {
    not_stdin(&options.urdf)?;
    let path = options.output.clone().unwrap_or_else(|| options.urdf.with_extension("toml"));
    if path.exists() {
        return Err(Failure::new(Exit::CannotWrite, format!("{}: is there already", path.display())));
    }
    let place = output::writable(&path)?;
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let known = guess::Known { packages: options.package.clone() };
    let text = guess::robot_file(&options.urdf, folder, &known)?;
    output::write_file(&place, text)?;
    output.print(&format!(
        "robot:    {}\nLook at the lines with a question mark, then: darrt robot check {}",
        path.display(),
        shell_word(&path.to_string_lossy())
    ))?;
    Ok(Exit::Solved)
}
