//! `darrt bench` from outside: runs, interruptions, shares, merging, and what is refused.

#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

use std::collections::BTreeSet;
use std::path::Path;
use std::process::{Command, Stdio};

use crate::program::run;

/// Two problems of other names: Plate1 with a goal that holds already, so that every run is short.
fn easy_problems(folder: &Path) {
    let text = darrt_pr2::problems::builtin_text("plate1").unwrap();
    let (head, tail) = text.split_once("on = \"side table\"\nat = [-2.14, -1.09]").unwrap();
    let text = format!("{head}on = \"central table\"\nat = [-0.20, 0.05]{tail}");
    for name in ["one", "two"] {
        let named = text.replacen("name = \"plate1\"", &format!("name = \"{name}\""), 1);
        assert_ne!(named, text);
        std::fs::write(folder.join(format!("{name}.toml")), named).unwrap();
    }
}

/// The names of the runs in a file of results, as often as they are there.
fn runs(path: &Path) -> Vec<String> {
    let text = std::fs::read_to_string(path).unwrap();
    let name = |line: &str| {
        let run: serde_json::Value = serde_json::from_str(line).unwrap();
        format!("{}/{}/{}", run["problem"], run["variant"], run["seed"])
    };
    text.lines().map(name).collect()
}

#[test]
fn results_are_printed_kept_drawn_and_logged() {
    let folder = tempfile::tempdir().unwrap();
    easy_problems(folder.path());
    let command = ["bench", "one.toml", "two.toml", "--seeds", "3", "--report", "page.html", "--ompl", "logs"];
    let (printed, complaint) = run(folder.path(), &command, 0);
    for words in ["problem", "median", "95 % interval", "one", "two", "3/3", "257", "page.html", "*.log"] {
        assert!(printed.contains(words), "{words}: {printed}");
    }
    assert_eq!(complaint, "", "quiet when piped");
    assert_eq!(runs(&folder.path().join("bench.jsonl")).len(), 6);
    let page = std::fs::read_to_string(folder.path().join("page.html")).unwrap();
    assert!(page.contains("6 runs") && !page.contains("http"));
    let log = std::fs::read_to_string(folder.path().join("logs/two.log")).unwrap();
    assert!(log.contains("Experiment two\n") && log.contains("darrt_default\n"));
    let (printed, _) = run(folder.path(), &command, 0);
    assert!(printed.contains("6 runs are done already"), "{printed}");
}

#[test]
fn a_killed_benchmark_goes_on_and_counts_every_run_once() {
    let folder = tempfile::tempdir().unwrap();
    easy_problems(folder.path());
    let command = ["bench", "one.toml", "--seeds", "12", "--variants", "default,full", "--jobs", "2", "--quiet"];
    let out = folder.path().join("bench.jsonl");
    let lines = || std::fs::read_to_string(&out).map_or(0, |text| text.lines().count());
    let mut program = Command::new(env!("CARGO_BIN_EXE_darrt"));
    let mut child = program.current_dir(folder.path()).args(command).stderr(Stdio::null()).spawn().unwrap();
    while lines() < 3 && child.try_wait().unwrap().is_none() {
        std::thread::yield_now();
    }
    child.kill().unwrap();
    child.wait().unwrap();
    // A kill in the middle of a line.
    let mut torn = std::fs::read(&out).unwrap();
    torn.truncate(torn.len() - 20);
    std::fs::write(&out, torn).unwrap();
    run(folder.path(), &command, 0);
    let runs = runs(&out);
    assert_eq!((runs.len(), runs.iter().collect::<BTreeSet<_>>().len()), (24, 24));
}

#[test]
fn shares_of_two_machines_make_up_the_whole() {
    let folder = tempfile::tempdir().unwrap();
    easy_problems(folder.path());
    let share = |shard, out| {
        let set = ["bench", "one.toml", "two.toml", "--variants", "default,euclidean", "--seeds", "5..8"];
        run(folder.path(), &[&set[..], &["--shard", shard, "--out", out]].concat(), 0);
        runs(&folder.path().join(out))
    };
    let (first, second) = (share("1/2", "a.jsonl"), share("2/2", "b.jsonl"));
    let both: BTreeSet<_> = first.iter().chain(&second).cloned().collect();
    assert_eq!((first.len(), second.len(), both.len()), (6, 6, 12));
    let (printed, _) = run(folder.path(), &["bench", "--merge", "a.jsonl", "b.jsonl", "--out", "all.jsonl"], 0);
    assert!(printed.contains("euclidean") && printed.contains("3/3"), "{printed}");
    assert_eq!(runs(&folder.path().join("all.jsonl")).into_iter().collect::<BTreeSet<_>>(), both);

    let text = std::fs::read_to_string(folder.path().join("a.jsonl")).unwrap();
    std::fs::write(folder.path().join("c.jsonl"), text.replacen("\"iterations\":0", "\"iterations\":9", 1)).unwrap();
    let (_, complaint) = run(folder.path(), &["bench", "--merge", "a.jsonl", "c.jsonl"], 2);
    assert!(complaint.contains("c.jsonl: ") && complaint.contains("is also in a.jsonl"), "{complaint}");
}

#[test]
fn runs_under_other_conditions_are_not_taken_up() {
    let folder = tempfile::tempdir().unwrap();
    easy_problems(folder.path());
    run(folder.path(), &["bench", "one.toml", "--seeds", "1", "--quiet"], 0);
    let before = std::fs::read(folder.path().join("bench.jsonl")).unwrap();
    let (_, complaint) = run(folder.path(), &["bench", "one.toml", "--seeds", "2", "--time-limit", "7"], 2);
    assert!(
        complaint.contains("one/default/0 was run with the time limit") && complaint.contains("not 7 s"),
        "{complaint}"
    );
    let path = folder.path().join("one.toml");
    let text = std::fs::read_to_string(&path).unwrap();
    std::fs::write(&path, format!("{text}# changed\n")).unwrap();
    let (_, complaint) = run(folder.path(), &["bench", "one.toml", "--seeds", "2"], 2);
    assert!(complaint.contains("a problem of digest") && complaint.contains("another --out"), "{complaint}");
    assert_eq!(std::fs::read(folder.path().join("bench.jsonl")).unwrap(), before, "nothing is lost");
}

#[test]
fn bad_usage_is_answered_before_any_run() {
    let folder = tempfile::tempdir().unwrap();
    easy_problems(folder.path());
    for (arguments, words) in [
        (&["bench", "plate4"][..], "plate"),
        (&["bench", "bowl", "--variants", "ful"], "did you mean `full`?"),
        (&["bench", "bowl", "--seeds", "0"], "a count above 0"),
        (&["bench", "bowl", "--shard", "3/2"], "i from 1 to n"),
        (&["bench", "bowl", "--jobs", "0"], "from 1 to 256"),
        (&["bench", "--merge", "none.jsonl"], "none.jsonl"),
        (&["bench", "--merge", "one.toml"], "one.toml:1: is not the record of a run"),
        (&["bench", "bowl", "--merge", "a.jsonl"], "--merge"),
    ] {
        let (printed, complaint) = run(folder.path(), arguments, 2);
        assert!(printed.is_empty() && complaint.contains(words), "{arguments:?}: {complaint}");
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
    let (printed, _) = run(folder.path(), &["bench", "--list-variants"], 0);
    assert!(printed.contains("no-local-repair") && printed.contains("Algorithm 1 as printed"), "{printed}");
}

#[test]
fn generated_problems_are_the_same_again_and_told_as_one_family() {
    let folder = tempfile::tempdir().unwrap();
    let (printed, _) = run(folder.path(), &["generate", "bowl", "--seeds", "3", "--into", "many"], 0);
    assert!(printed.contains("many: 3 problems"), "{printed}");
    let (printed, _) = run(folder.path(), &["generate", "bowl", "--seeds", "2..3"], 0);
    assert_eq!(std::fs::read_to_string(folder.path().join("many/bowl-g2.toml")).unwrap(), printed);
    let command = ["bench", "many", "--seeds", "1", "--iterations", "2000", "--out", "r.jsonl"];
    let (printed, _) = run(folder.path(), &command, 0);
    let rows: Vec<_> = printed.lines().filter(|line| line.contains("bowl")).collect();
    // One row in each table.
    assert!(rows.len() == 3 && rows.iter().all(|row| row.contains("bowl-g*")), "{printed}");
    assert!(rows[0].contains("/3"), "{printed}");
    assert_eq!(runs(&folder.path().join("r.jsonl")).len(), 3);
    std::fs::create_dir(folder.path().join("empty")).unwrap();
    let (_, complaint) = run(folder.path(), &["bench", "empty"], 2);
    assert!(complaint.contains("holds no problem file"), "{complaint}");
    let (_, complaint) = run(folder.path(), &["generate", "bowl", "--seeds", "2"], 2);
    assert!(complaint.contains("--into FOLDER"), "{complaint}");
}

/// A mug that no finger comes to: it stands between posts.
fn caged() -> String {
    let posts = (0..8).map(|index| {
        let (sin, cos) = (f64::from(index) * std::f64::consts::FRAC_PI_4).sin_cos();
        let at = [0.065 * cos - 0.2, 0.065 * sin + 0.2, 0.9];
        format!(
            "[[obstacle]]\nname = \"post {index}\"\nat = {at:?}\n\
             shape = {{ cylinder = {{ radius = 0.01, height = 0.3 }} }}\n"
        )
    });
    let posts: String = posts.collect();
    format!(
        "format = \"darrt-problem\"\nversion = 1\nname = \"hopeless\"\n\
         primitives = [\"Arm-Transit\", \"Base-Transit\", \"Pick\", \"Place\", \"Arm-Rigid-Transfer\", \
         \"Straight-Line-Arm-Transit\"]\n[robot]\nbase = [-1.0, 0.0, 0.0]\n\
         [[obstacle]]\nname = \"table\"\nat = [0.0, 0.0, 0.37]\nshape = {{ box = {{ size = [0.8, 1.2, 0.74] }} }}\n{posts}\
         [[surface]]\nname = \"table\"\ntop_of = \"table\"\n\
         [[object]]\nname = \"mug\"\nshape = {{ cylinder = {{ radius = 0.035, height = 0.1 }} }}\non = \"table\"\n\
         at = [-0.2, 0.2]\ngrasps = [\"side\"]\n\
         [[goal.object]]\nobject = \"mug\"\non = \"table\"\nat = [-0.2, -0.3]\n"
    )
}

#[cfg(unix)]
#[test]
fn an_interrupt_keeps_what_is_finished() {
    let folder = tempfile::tempdir().unwrap();
    easy_problems(folder.path());
    std::fs::write(folder.path().join("hopeless.toml"), caged()).unwrap();
    let mut child = Command::new(env!("CARGO_BIN_EXE_darrt"))
        .current_dir(folder.path())
        .args(["bench", "one.toml", "hopeless.toml", "--seeds", "1", "--jobs", "1", "--time-limit", "600"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let out = folder.path().join("bench.jsonl");
    let has_line = || std::fs::read_to_string(&out).is_ok_and(|text| text.contains('\n'));
    while !has_line() && child.try_wait().unwrap().is_none() {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    let complaint = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(130), "{complaint}");
    assert!(complaint.contains("interrupted, 1 run left: the same command goes on"), "{complaint}");
    assert!(String::from_utf8(output.stdout).unwrap().contains("1/1"), "what is done is told");
    assert_eq!(runs(&out), ["\"one\"/\"default\"/0"]);
}

#[test]
fn the_page_does_not_overwrite_results() {
    let folder = tempfile::tempdir().unwrap();
    easy_problems(folder.path());
    run(folder.path(), &["bench", "one.toml", "--seeds", "1"], 0);
    for command in [
        &["bench", "one.toml", "--seeds", "1", "--report", "bench.jsonl"][..],
        &["bench", "--merge", "bench.jsonl", "--report", "./bench.jsonl"],
    ] {
        let (_, complaint) = run(folder.path(), command, 2);
        assert!(complaint.contains("would be lost"), "{complaint}");
    }
    assert_eq!(runs(&folder.path().join("bench.jsonl")).len(), 1);
    // Nor those that are not there yet.
    run(folder.path(), &["bench", "one.toml", "--seeds", "1", "--out", "new.jsonl", "--report", "./new.jsonl"], 2);
}
