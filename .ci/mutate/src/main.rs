//! Are the laws sharp? Changes one thing at a time in the sources of shipped implementors of `darrt-core` (a comparison turned
//! round, a sign, a dropped term, a number off by one), and asks whether one run of `check_everything` on the puck domain
//! notices. All of it happens in a copy of the package under `target/mutate`.
//!
//! ```text
//! .ci/mutate/run                          every mutant of the default files
//! .ci/mutate/run --every 5                each fifth
//! .ci/mutate/run --only 354,361           these, by the numbers that a run prints
//! .ci/mutate/run --jobs 2 src/space/real_box.rs
//! ```
//!
//! Prints one line for each mutant, and at the end the share that was killed, for all and for those that the run reaches at
//! all. A mutant is killed if a law is broken, if the kit warns of it, if it panics where the program begins, or does not end.

mod plant;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Output, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::time::{Duration, Instant};

use plant::{Mutant, Planter};

type Fault = Box<dyn std::error::Error>;

/// What the puck domain consists of.
const FILES: [&str; 18] = [
    "src/space/real_box.rs",
    "src/motion/waypoints.rs",
    "src/goal.rs",
    "src/distance/greedy_visit.rs",
    "src/sample/goal_biased.rs",
    "src/sample/robot_or_objects.rs",
    "src/testing/puck/approach.rs",
    "src/testing/puck/carry.rs",
    "src/testing/puck/clearance.rs",
    "src/testing/puck/judge.rs",
    "src/testing/puck/pick.rs",
    "src/testing/puck/place.rs",
    "src/testing/puck/plane.rs",
    "src/testing/puck/push.rs",
    "src/testing/puck/transit.rs",
    "src/testing/puck/world.rs",
    "src/motion/straight.rs",
    "src/motion/reversed.rs",
];
/// One that takes longer hangs.
const PATIENCE: Duration = Duration::from_secs(170);

struct Options {
    every: usize,
    jobs: usize,
    /// Only these numbers; empty for all.
    only: Vec<u32>,
    files: Vec<String>,
}

fn options() -> Result<Options, Fault> {
    let mut options = Options { every: 1, jobs: 2, only: Vec::new(), files: Vec::new() };
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or_else(|| format!("{word} wants a value"));
        match &*word {
            "--every" => options.every = number(&word, &value()?)?,
            "--jobs" => options.jobs = number(&word, &value()?)?,
            "--only" => {
                let all = value()?;
                let numbers = all.split(',').map(|text| number(&word, text).and_then(|n| Ok(u32::try_from(n)?)));
                options.only = numbers.collect::<Result<_, _>>()?;
            }
            _ if word.starts_with('-') => return Err(format!("{word}: there are --every, --jobs and --only").into()),
            _ => options.files.push(word),
        }
    }
    if options.files.is_empty() {
        options.files = FILES.map(str::to_owned).to_vec();
    }
    Ok(options)
}

fn number(option: &str, text: &str) -> Result<usize, Fault> {
    match text.parse() {
        Ok(0) => Err(format!("{option} 0: at least 1").into()),
        Ok(value) => Ok(value),
        Err(error) => Err(format!("{option} {text}: {error}").into()),
    }
}

fn copy(from: &Path, to: &Path) -> Result<(), Fault> {
    std::fs::create_dir_all(to)?;
    for entry in std::fs::read_dir(from)? {
        let entry = entry?;
        let target = to.join(entry.file_name());
        if entry.file_type()?.is_dir() {
            copy(&entry.path(), &target)?;
        } else {
            write(&target, &std::fs::read(entry.path())?)?;
        }
    }
    Ok(())
}

/// What stays the same is not written, so that it is not built again.
fn write(path: &Path, bytes: &[u8]) -> Result<(), Fault> {
    if std::fs::read(path).ok().as_deref() != Some(bytes) {
        std::fs::write(path, bytes)?;
    }
    Ok(())
}

/// The workspace of the copy: the package, and the judge.
fn lay_out(root: &Path, out: &Path) -> Result<(), Fault> {
    copy(&root.join("darrt-core"), &out.join("darrt-core"))?;
    let manifest = std::fs::read_to_string(root.join("Cargo.toml"))?;
    let lines = manifest.lines().filter_map(|line| {
        if line.starts_with("members") {
            Some("members = [\"darrt-core\", \"judge\"]")
        } else if line.starts_with("default-members") || line.starts_with("exclude") {
            None
        } else {
            Some(line)
        }
    });
    write(&out.join("Cargo.toml"), (lines.collect::<Vec<_>>().join("\n") + "\n").as_bytes())?;
    if !out.join("Cargo.lock").exists() {
        std::fs::copy(root.join("Cargo.lock"), out.join("Cargo.lock"))?;
    }
    std::fs::create_dir_all(out.join("judge/src"))?;
    let manifest = "[package]\nname = \"judge\"\nversion = \"0.1.0\"\nedition = \"2024\"\n\n[dependencies]\n\
        darrt-core = { workspace = true, features = [\"testing\"] }\n";
    write(&out.join("judge/Cargo.toml"), manifest.as_bytes())?;
    write(&out.join("judge/src/main.rs"), include_bytes!("judge.rs"))?;
    write(&out.join("darrt-core/src/mutants.rs"), include_bytes!("mutants.rs"))?;
    let lib = std::fs::read_to_string(root.join("darrt-core/src/lib.rs"))?;
    write(&out.join("darrt-core/src/lib.rs"), format!("{lib}\npub mod mutants;\n").as_bytes())
}

/// Plants all mutants; returns where they are.
fn plant(root: &Path, out: &Path, files: &[String], unfit: &[u32]) -> Result<Vec<Mutant>, Fault> {
    let mut planter = Planter::without(unfit.to_vec());
    let mut written = Vec::new();
    for file in files {
        let text =
            std::fs::read_to_string(root.join("darrt-core").join(file)).map_err(|error| format!("{file}: {error}"))?;
        let switched = planter.plant(file, &text).map_err(|error| format!("{file}: {error}"))?;
        let path = out.join("darrt-core").join(file);
        std::fs::write(&path, format!("#![allow(warnings)]\n{switched}"))?;
        written.push(path);
    }
    let done =
        Command::new("rustfmt").args(["--edition", "2024", "--config", "skip_children=true"]).args(&written).output();
    let done = match done {
        Ok(done) if done.status.success() => done,
        // Without the option, which only some versions know.
        _ => Command::new("rustfmt").args(["--edition", "2024"]).args(&written).output()?,
    };
    if done.status.success() {
        Ok(planter.mutants)
    } else {
        Err(String::from_utf8_lossy(&done.stderr).into_owned().into())
    }
}

fn build(out: &Path, target: &Path) -> Result<Output, Fault> {
    let mut cargo = Command::new("cargo");
    cargo.args(["build", "--message-format", "short", "-p", "judge", "--target-dir"]).arg(target).current_dir(out);
    Ok(cargo.stdin(Stdio::null()).output()?)
}

/// The switches in or just above the lines of which the compiler complains.
fn complaints(out: &Path, said: &str) -> Vec<u32> {
    let mut found = Vec::new();
    for line in said.lines().filter(|line| line.contains(": error")) {
        let mut parts = line.split(':');
        let (Some(file), Some(number)) = (parts.next(), parts.next()) else { continue };
        let Ok(number) = number.trim().parse::<usize>() else { continue };
        let Ok(text) = std::fs::read_to_string(out.join(file)) else { continue };
        let lines: Vec<&str> = text.lines().collect();
        // The branch of the switch begins at most a few lines above.
        let above = (number.saturating_sub(6)..number).rev().filter_map(|i| lines.get(i));
        let switches = |line: &&str| {
            line.match_indices("mutants::on(")
                .filter_map(|(at, word)| {
                    line[at + word.len()..].split(|c: char| !c.is_ascii_digit()).next()?.parse::<u32>().ok()
                })
                .collect::<Vec<_>>()
        };
        found.extend(above.map(switches).find(|switches| !switches.is_empty()).unwrap_or_default());
    }
    found
}

#[derive(Debug, Clone, PartialEq)]
enum Fate {
    Killed(String),
    Survived,
    /// No part of the run asks for it.
    NotReached,
    NotRun(String),
}

fn run(judge: &Path, number: u32) -> Result<Fate, Fault> {
    let mut child =
        Command::new(judge).env("MUTANT", number.to_string()).stdout(Stdio::piped()).stderr(Stdio::null()).spawn()?;
    let began = Instant::now();
    loop {
        if let Some(status) = child.try_wait()? {
            let output = child.wait_with_output()?;
            let said = String::from_utf8_lossy(&output.stdout).lines().next().unwrap_or("panic").to_owned();
            return Ok(if status.success() { Fate::Survived } else { Fate::Killed(said) });
        }
        if began.elapsed() > PATIENCE {
            child.kill()?;
            child.wait()?;
            return Ok(Fate::Killed("does not end".into()));
        }
        std::thread::sleep(Duration::from_millis(50));
    }
}

fn reached(judge: &Path) -> Result<Vec<u32>, Fault> {
    let output = Command::new(judge).env("MUTANT", "0").env("MUTANT_REACHED", "1").output()?;
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    if !output.status.success() {
        return Err(format!("without any mutant something is noticed: {text}").into());
    }
    let numbers = text.lines().next().unwrap_or_default().trim_matches(['[', ']']).split(", ");
    Ok(numbers.filter_map(|number| number.parse().ok()).collect())
}

fn all(options: &Options) -> Result<(), Fault> {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize()?;
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), PathBuf::from);
    let out = target.join("mutate");
    // Of its own: in a shared one the copy would be taken for the package.
    let target = out.join("target");
    lay_out(&root, &out)?;
    let mut unfit = Vec::new();
    let mutants = loop {
        let mutants = plant(&root, &out, &options.files, &unfit)?;
        let done = build(&out, &target)?;
        if done.status.success() {
            break mutants;
        }
        let said = String::from_utf8_lossy(&done.stderr);
        let found = complaints(&out, &said);
        if found.is_empty() {
            return Err(said.into_owned().into());
        }
        eprintln!("{} changes do not compile and are left out", found.len());
        unfit.extend(found);
    };
    let judge = target.join("debug/judge");
    let reached = reached(&judge)?;
    let is_asked = |mutant: &&Mutant| options.only.is_empty() || options.only.contains(&mutant.number);
    let chosen: Vec<_> = mutants.iter().filter(is_asked).step_by(options.every).collect();
    eprintln!("{} mutants, {} of them chosen", mutants.len(), chosen.len());
    let (next, fates) = (AtomicUsize::new(0), Mutex::new(BTreeMap::new()));
    std::thread::scope(|scope| {
        for _ in 0..options.jobs {
            scope.spawn(|| {
                while let Some(mutant) = chosen.get(next.fetch_add(1, Relaxed)) {
                    let fate = if reached.contains(&mutant.number) {
                        run(&judge, mutant.number).unwrap_or_else(|error| Fate::NotRun(error.to_string()))
                    } else {
                        Fate::NotReached
                    };
                    let Mutant { number, file, line, function, change } = mutant;
                    println!("{number} {file}:{line} {function}: {change}: {fate:?}");
                    fates.lock().unwrap_or_else(std::sync::PoisonError::into_inner).insert(*number, fate);
                }
            });
        }
    });
    let fates = fates.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
    let count = |is: &dyn Fn(&Fate) -> bool| fates.values().filter(|fate| is(fate)).count();
    let killed = count(&|fate| matches!(fate, Fate::Killed(_)));
    let looked_at = count(&|fate| matches!(fate, Fate::Killed(_) | Fate::Survived));
    let percent = |of: usize| 100.0 * killed as f64 / of.max(1) as f64;
    println!(
        "{killed} killed: {:.1} % of {} mutants, {:.1} % of the {looked_at} that the run reaches; {} did not compile",
        percent(fates.len()),
        fates.len(),
        percent(looked_at),
        unfit.len()
    );
    Ok(())
}

fn main() -> ExitCode {
    match options().and_then(|options| all(&options)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}
