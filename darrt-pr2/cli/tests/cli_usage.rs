//! The program from outside: help, lists, schemas, and what bad usage gets.

#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

use std::path::Path;
use std::process::{Command, Output, Stdio};

use crate::program::darrt;

fn code(output: &Output) -> i32 {
    output.status.code().unwrap()
}

fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

/// Runs with something on the standard input.
fn fed(folder: &Path, input: &[u8], arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_darrt"));
    let command = command.current_dir(folder).args(arguments);
    let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    std::io::Write::write_all(&mut child.stdin.take().unwrap(), input).unwrap();
    child.wait_with_output().unwrap()
}

/// Runs, expects this exit code and one message without a panic, and returns the message.
fn refused(folder: &Path, arguments: &[&str], expected: i32) -> String {
    let output = darrt(folder, arguments);
    let message = stderr(&output);
    assert_eq!(code(&output), expected, "{arguments:?}: {message}");
    assert!(message.starts_with("error: ") && !message.contains("panicked"), "{arguments:?}: {message}");
    assert!(output.stdout.is_empty(), "{arguments:?}: results only on the standard output");
    message
}

#[test]
fn help_teaches_commands_options_and_exit_codes() {
    let folder = tempfile::tempdir().unwrap();
    let help = darrt(folder.path(), &["--help"]);
    assert_eq!(code(&help), 0);
    for word in ["plan", "check", "execute", "problems", "show", "schema", "bench", "Examples:", "Exit codes:", "130"] {
        assert!(stdout(&help).contains(word), "{word}");
    }
    let help = stdout(&darrt(folder.path(), &["plan", "--help"]));
    for word in [
        "--seed",
        "--time-limit",
        "--iterations",
        "--restart",
        "--sampler",
        "--distance",
        "--search",
        "--improve",
        "--threads",
    ] {
        assert!(help.contains(word), "{word}");
    }
    assert!(stdout(&darrt(folder.path(), &["--version"])).starts_with("darrt "));
}

#[test]
fn bad_usage_is_one_message_and_exit_code_2() {
    let folder = tempfile::tempdir().unwrap();
    for arguments in [
        &["plane"][..],
        &[],
        &["plan"],
        &["plan", "plate1", "--seed", "-1"],
        &["plan", "plate1", "--time-limit", "nan"],
        &["plan", "plate1", "--time-limit", "0"],
        &["plan", "plate1", "--iterations", "0"],
        &["plan", "plate1", "--restart", "0"],
        &["plan", "plate1", "--threads", "0"],
        &["plan", "plate1", "--sampler", "some"],
        &["plan", "plate1", "--search", "both"],
        &["plan", "plate1", "--improve"],
        &["plan", "plate1", "--improve", "time"],
        &["plan", "plate1", "--picture", "a.svg", "--no-picture"],
        &["schema", "planet"],
    ] {
        let output = darrt(folder.path(), arguments);
        assert_eq!(code(&output), 2, "{arguments:?}");
        assert!(output.stdout.is_empty() && !output.stderr.is_empty(), "{arguments:?}");
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn bad_numbers_are_answered_with_their_bound() {
    let folder = tempfile::tempdir().unwrap();
    for (option, values, bound) in [
        ("--seed", &["-1", "1.5", "x"][..], "a whole number from 0 to 18446744073709551615"),
        ("--iterations", &["-5", "0"], "a whole number from 1 to 18446744073709551615"),
        ("--restart", &["-5", "0", "--stats"], "a whole number from 1 to 18446744073709551615"),
        ("--threads", &["-2", "0", "257"], "a whole number from 1 to 256"),
        ("--time-limit", &["-3", "0", "1e300", "inf", "-inf", "nan"], "a number of seconds above 0 and at most 1e9"),
    ] {
        for value in values {
            let message = refused(folder.path(), &["plan", "plate1", option, value], 2);
            assert!(message.contains(&format!("invalid value '{value}' for '{option} ")), "{message}");
            assert!(message.contains(bound) && !message.contains("tip:"), "{message}");
        }
    }
}

#[test]
fn problems_are_listed_and_printed_to_be_copied() {
    use darrt_pr2::problems::{builtin_names, everyday_names, further_names, hopeless_names};
    let folder = tempfile::tempdir().unwrap();
    let list = stdout(&darrt(folder.path(), &["problems"]));
    for name in builtin_names().into_iter().chain(further_names()).chain(everyday_names()).chain(hopeless_names()) {
        assert!(list.contains(name), "{name}");
        let text = stdout(&darrt(folder.path(), &["problems", "--print", name]));
        assert_eq!(text, darrt_pr2::problems::builtin_text(name).unwrap());
    }
    let message = refused(folder.path(), &["problems", "--print", "plate9"], 2);
    assert!(message.contains("plate9") && message.contains("did you mean"), "{message}");
}

#[test]
fn schemas_are_json() {
    let folder = tempfile::tempdir().unwrap();
    for kind in ["problem", "plan", "robot"] {
        let schema: serde_json::Value =
            serde_json::from_str(&stdout(&darrt(folder.path(), &["schema", kind]))).unwrap();
        assert!(schema["$schema"].is_string() && schema["properties"]["format"].is_object(), "{kind}");
    }
}

#[test]
fn a_problem_is_drawn_by_name_and_from_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let shown = darrt(folder.path(), &["show", "Plate3 (No Place)"]);
    assert_eq!(code(&shown), 0, "{}", stderr(&shown));
    assert!(stdout(&shown).contains("plate3-no-place.html"));
    let page = std::fs::read_to_string(folder.path().join("plate3-no-place.html")).unwrap();
    assert!(page.starts_with("<!DOCTYPE html>") && page.contains("Plate3 (No Place)"));

    let text = darrt_pr2::problems::builtin_text("bowl").unwrap();
    std::fs::write(folder.path().join("mine.toml"), text).unwrap();
    assert_eq!(code(&darrt(folder.path(), &["show", "mine.toml", "-o", "mine.svg"])), 0);
    assert!(std::fs::read_to_string(folder.path().join("mine.svg")).unwrap().starts_with("<?xml"));
    let message = refused(folder.path(), &["show", "bowl", "-o", "bowl.gif"], 2);
    assert!(message.contains("bowl.gif") && message.contains(".html, .svg, .png or .glb"), "{message}");
}

#[test]
fn missing_malformed_large_and_deep_files_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("deep.json", &"[".repeat(10_000));
    write("deep.toml", &format!("a = {}", "[".repeat(10_000)));
    write("bad.json", "{\"format\": \"darrt-plan\", \"version\": 2, \"seeed\": 2}");
    write("bad.toml", "format = \"darrt-problem\"\nversion = 1\nnaem = \"x\"\n");
    std::fs::File::create(folder.path().join("large.json")).unwrap().set_len(300_000_000).unwrap();
    std::fs::File::create(folder.path().join("large.toml")).unwrap().set_len(100_000_000).unwrap();
    for (command, file, words) in [
        ("check", "missing.json", "cannot be read"),
        ("check", ".", "not a regular file"),
        ("check", "deep.json", "nested deeper"),
        ("check", "large.json", "300000000"),
        ("check", "bad.json", "seeed"),
        ("show", "missing.json", "cannot be read"),
        ("show", "deep.json", "nested deeper"),
        ("show", "deep.toml", "nested deeper"),
        ("show", "large.toml", "100000000"),
        ("plan", "bad.toml", "naem"),
        ("plan", "nothing", "built-in"),
        ("plan", ".", "not a regular file"),
    ] {
        let message = refused(folder.path(), &[command, file], 2);
        assert!(message.contains(words) && message.contains(file), "{command} {file}: {message}");
        assert!(message.len() < 2000, "{command} {file}: {} characters", message.len());
    }
}

#[test]
fn an_output_that_cannot_be_written_is_refused_before_the_work() {
    let folder = tempfile::tempdir().unwrap();
    for arguments in [
        &["show", "bowl", "-o", "no/such/folder/a.svg"][..],
        &["plan", "plate3", "-o", "no/such/folder/a.json"],
        &["plan", "plate3", "--picture", "no/such/folder/a.svg"],
        &["plan", "plate3", "-o", "."],
    ] {
        refused(folder.path(), arguments, 4);
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[cfg(unix)]
#[test]
fn a_closed_pipe_and_a_full_disk_end_quietly_and_loudly() {
    let full = std::fs::OpenOptions::new().write(true).open("/dev/full");
    if let Ok(full) = full {
        let output = Command::new(env!("CARGO_BIN_EXE_darrt")).arg("problems").stdout(full).output().unwrap();
        assert_eq!(code(&output), 4);
        assert!(stderr(&output).contains("standard output"));
    }
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let output = Command::new(env!("CARGO_BIN_EXE_darrt")).arg("problems").stdout(writer).output().unwrap();
    assert_eq!((code(&output), stderr(&output).as_str()), (0, ""));
}

#[test]
fn a_plan_on_the_standard_output_is_alone_there_and_other_results_are_files() {
    let folder = tempfile::tempdir().unwrap();
    let output = darrt(folder.path(), &["plan", "bowl", "-o", "-"]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let plan: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(plan["format"], "darrt-plan");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0, "no file is written");
    // Where it can be read again, like a problem.
    let problem = darrt(folder.path(), &["problems", "--print", "bowl"]).stdout;
    for (input, arguments, said) in [
        (&output.stdout, &["check", "-"][..], "accepted"),
        (&output.stdout, &["show", "-", "-o", "plan.svg"], "picture:  plan.svg"),
        (&output.stdout, &["why-not", "-"], "nothing is wrong with it"),
        (&problem, &["show", "-", "-o", "problem.svg"], "picture:  problem.svg"),
        (&problem, &["why-not", "-", "--base=-1.0,0,0"], "nothing is wrong with it"),
    ] {
        let output = fed(folder.path(), input, arguments);
        assert_eq!(code(&output), 0, "{arguments:?}: {}", stderr(&output));
        assert!(stdout(&output).contains(said), "{arguments:?}: {}", stdout(&output));
    }
    let message = refused(folder.path(), &["plan", "bowl", "-o", "a.json", "--record", "-"], 4);
    assert!(message.contains("is the standard output"), "{message}");
}

#[test]
fn what_a_person_wrote_is_not_written_over() {
    let folder = tempfile::tempdir().unwrap();
    let problem = stdout(&darrt(folder.path(), &["problems", "--print", "bowl"]));
    let robot = stdout(&darrt(folder.path(), &["robot", "list", "--print", "panda-arm"]));
    for (name, text) in [("mine.toml", problem.as_str()), ("mine.robot", &robot), ("mine.urdf", "<robot name=\"a\"/>")]
    {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        for arguments in [&["plan", "bowl", "-o", name][..], &["plan", "bowl", "--why", name]] {
            let message = refused(folder.path(), arguments, 2);
            assert!(message.contains(name) && message.contains("it would be lost"), "{message}");
        }
        assert_eq!(std::fs::read_to_string(&path).unwrap(), text);
    }
}

#[test]
fn lines_fit_a_terminal() {
    let folder = tempfile::tempdir().unwrap();
    for arguments in [
        &["plan", "simple-plate", "--no-picture"][..],
        &["check", "simple-plate.plan.json"],
        &["problems"],
        &["plan", "--help"],
        &["explain", "--help"],
        &["robot", "list"],
    ] {
        let output = darrt(folder.path(), arguments);
        assert_eq!(code(&output), 0, "{arguments:?}: {}", stderr(&output));
        for line in stdout(&output).lines() {
            assert!(line.chars().count() <= 80, "{arguments:?}: {line}");
        }
    }
}
