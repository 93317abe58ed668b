//! `darrt plan` and `darrt check` from outside.

#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

use std::path::Path;
use std::process::{Command, Output};

use crate::program::{run, text};

/// Plate1 with a goal that holds already: solved before the first iteration.
fn solved_problem(folder: &Path) {
    let text = darrt_pr2::problems::builtin_text("plate1").unwrap();
    let (head, tail) = text.split_once("on = \"side table\"\nat = [-2.14, -1.09]").unwrap();
    let text = format!("{head}on = \"central table\"\nat = [-0.20, 0.05]{tail}");
    std::fs::write(folder.join("easy.toml"), text).unwrap();
}

fn files(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn a_plan_is_printed_written_drawn_and_accepted() {
    let folder = tempfile::tempdir().unwrap();
    solved_problem(folder.path());
    let (printed, complaint) = run(folder.path(), &["plan", "easy.toml", "--seed", "3"], 0);
    for words in ["solved in", "seed 3", "primitive", "object moves", "verified: ", "easy.plan.json", "easy.html"] {
        assert!(printed.contains(words), "{words}: {printed}");
    }
    assert_eq!(complaint, "", "quiet when piped");
    assert_eq!(files(folder.path()), ["easy.html", "easy.plan.json", "easy.toml"]);
    let (printed, _) = run(folder.path(), &["check", "easy.plan.json"], 0);
    assert!(printed.contains("easy.plan.json: accepted"), "{printed}");
    let (printed, _) = run(folder.path(), &["show", "easy.plan.json", "-o", "again.html"], 0);
    assert!(printed.contains("again.html"));
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    assert_eq!(read("again.html"), read("easy.html"));
}

#[test]
fn a_plan_never_overwrites_its_problem() {
    let folder = tempfile::tempdir().unwrap();
    solved_problem(folder.path());
    let (_, complaint) = run(folder.path(), &["plan", "easy.toml", "-o", "./easy.toml"], 2);
    assert!(complaint.contains("easy.toml: is there already and is a problem, it would be lost"), "{complaint}");
    assert_eq!(files(folder.path()), ["easy.toml"]);
}

#[test]
fn one_seed_gives_one_file() {
    let folder = tempfile::tempdir().unwrap();
    solved_problem(folder.path());
    for name in ["a.json", "b.json"] {
        let (printed, _) = run(folder.path(), &["plan", "easy.toml", "-o", name, "--no-picture", "--quiet"], 0);
        assert_eq!(printed, "");
    }
    let read = |name: &str| std::fs::read(folder.path().join(name)).unwrap();
    assert_eq!(read("a.json"), read("b.json"));
    assert_eq!(files(folder.path()), ["a.json", "b.json", "easy.toml"]);
}

#[test]
fn every_search_solves_the_bowl_and_says_so() {
    let folder = tempfile::tempdir().unwrap();
    for search in ["darrt", "connect", "hierarchical", "hierarchical-connect", "portfolio"] {
        let (printed, _) = run(folder.path(), &["plan", "bowl", "--search", search, "--no-picture"], 0);
        assert!(printed.contains("bowl: solved in") && printed.contains("verified: "), "{search}: {printed}");
    }
}

#[test]
fn improved_plans_are_counted_and_the_same_on_any_number_of_threads() {
    let folder = tempfile::tempdir().unwrap();
    // The time limit is only there to end the test if something is wrong.
    let common = ["--improve", "steps", "--iterations", "600", "--restart", "100", "--time-limit", "600"];
    for (search, threads) in [("darrt", "1"), ("darrt", "3"), ("portfolio", "1"), ("portfolio", "3")] {
        let name = format!("{search}-{threads}.json");
        let own = ["plan", "bowl", "--search", search, "--threads", threads, "-o", &name, "--no-picture"];
        let (printed, _) = run(folder.path(), &[&own[..], &common].concat(), 0);
        assert!(printed.contains("bowl: the best of ") && printed.contains(" plans in "), "{printed}");
    }
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    // The files say how they were made, but for the threads.
    let facts = |name: &str| serde_json::from_str::<serde_json::Value>(&read(name)).unwrap()["planner"].clone();
    let searches = ["darrt", "connect", "hierarchical", "hierarchical-connect"];
    assert_eq!(facts("portfolio-1.json")["searches"], serde_json::json!(searches));
    assert_eq!(facts("darrt-1.json")["searches"], serde_json::json!(["darrt"]));
    assert_eq!(facts("darrt-1.json")["improve"], "steps");
    assert!(facts("darrt-1.json").get("as_found").is_none());
    assert_eq!(read("darrt-1.json"), read("darrt-3.json"));
    assert_eq!(read("portfolio-1.json"), read("portfolio-3.json"));
}

#[test]
fn an_edited_plan_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    solved_problem(folder.path());
    run(folder.path(), &["plan", "easy.toml", "-o", "p.json", "--no-picture"], 0);
    let path = folder.path().join("p.json");
    let mut plan: serde_json::Value = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
    plan["start"]["base"][0] = serde_json::json!(-0.7);
    std::fs::write(&path, plan.to_string()).unwrap();
    let (printed, complaint) = run(folder.path(), &["check", "p.json"], 3);
    assert!(printed.is_empty() && complaint.starts_with("error: p.json: refused: "), "{complaint}");
}

#[test]
fn what_cannot_be_drawn_is_named() {
    let folder = tempfile::tempdir().unwrap();
    solved_problem(folder.path());
    run(folder.path(), &["plan", "easy.toml", "-o", "p.json", "--no-picture"], 0);
    let path = folder.path().join("p.json");
    let plan: serde_json::Value = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
    let complaint = |edit: &dyn Fn(&mut serde_json::Value)| {
        let mut plan = plan.clone();
        edit(&mut plan["start"]);
        std::fs::write(&path, plan.to_string()).unwrap();
        run(folder.path(), &["show", "p.json"], 2).1
    };
    let far = complaint(&|start| start["base"][1] = serde_json::json!(1e300));
    assert!(far.contains("p.json: `start`: base is 1e300, at most 10000"), "{far}");
    let zero = complaint(&|start| start["objects"]["plate"]["quaternion"] = serde_json::json!([0.0, 0.0, 0.0, 0.0]));
    assert!(zero.contains("plate (norm of the quaternion"), "{zero}");
    let gone = complaint(&|start| drop(start["joints"].as_object_mut().unwrap().remove("r_elbow_flex_joint")));
    assert!(gone.contains("`start`: the joint `r_elbow_flex_joint` is missing"), "{gone}");
    assert_eq!(files(folder.path()), ["easy.toml", "p.json"]);
}

#[test]
fn a_budget_that_ends_is_explained() {
    let folder = tempfile::tempdir().unwrap();
    let (printed, complaint) = run(folder.path(), &["plan", "plate3", "--iterations", "3", "--stats"], 5);
    for words in
        ["plate3: no plan found (seed 0)", "iteration limit reached", "3 iterations say nothing", "its beginning is in"]
    {
        assert!(complaint.contains(words), "{words}: {complaint}");
    }
    assert!(!complaint.contains("doubtful"), "{complaint}");
    assert!(printed.contains("Every extension ends in one row") && printed.contains("3 extensions"), "{printed}");
    let written = ["plate3.partial.json", "plate3.why.html"];
    assert_eq!(files(folder.path()), written, "without a plan its beginning is written, and why it is no more");
}

/// Interrupted after two seconds; the handler is set within moments.
#[cfg(unix)]
fn interrupted(folder: &Path, arguments: &[&str]) -> Output {
    use std::process::Stdio;
    let child = Command::new(env!("CARGO_BIN_EXE_darrt"))
        .current_dir(folder)
        .args(arguments)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    std::thread::sleep(std::time::Duration::from_secs(2));
    let killed = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(killed.success());
    child.wait_with_output().unwrap()
}

#[cfg(unix)]
#[test]
fn an_interrupt_ends_the_search_and_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    // A restart after every iteration keeps the search from ever getting anywhere.
    let arguments = ["plan", "plate3", "--seed", "1", "--time-limit", "600", "--restart", "1"];
    let output = interrupted(folder.path(), &arguments);
    assert_eq!(output.status.code(), Some(130), "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("cancelled after"), "{}", text(&output.stderr));
    assert!(files(folder.path()).is_empty());
}

#[cfg(unix)]
#[test]
fn improved_plans_that_are_interrupted_give_the_best_so_far_and_say_so() {
    let folder = tempfile::tempdir().unwrap();
    solved_problem(folder.path());
    let arguments = ["plan", "easy.toml", "--improve", "steps", "--time-limit", "600", "--no-picture"];
    let output = interrupted(folder.path(), &arguments);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let first = text(&output.stdout).lines().next().unwrap().to_owned();
    assert!(first.contains(": the best of ") && first.contains(" s, interrupted (seed 0"), "{first}");
    run(folder.path(), &["check", "easy.plan.json"], 0);
}

/// A box of 0.2 m around the origin.
const STONE: &str = "v -0.1 -0.1 -0.1\nv 0.1 -0.1 -0.1\nv 0.1 0.1 -0.1\nv -0.1 0.1 -0.1\nv -0.1 -0.1 0.1\n\
    v 0.1 -0.1 0.1\nv 0.1 0.1 0.1\nv -0.1 0.1 0.1\nf 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

#[test]
fn a_plan_finds_its_meshes_from_every_folder_and_after_a_move() {
    let top = tempfile::tempdir().unwrap();
    let path = |name: &str| top.path().join(name);
    for folder in ["room/meshes", "room/plans", "elsewhere"] {
        std::fs::create_dir_all(path(folder)).unwrap();
    }
    solved_problem(&path("room"));
    std::fs::write(path("room/meshes/stone.obj"), STONE).unwrap();
    std::fs::copy(path("room/easy.toml"), path("room/mesh.toml")).unwrap();
    let mut text = std::fs::read_to_string(path("room/mesh.toml")).unwrap();
    text.push_str(
        "\n[[obstacle]]\nname = \"stone\"\nshape = { mesh = { file = \"meshes/stone.obj\" } }\nat = [2, 2, 0.2]\n",
    );
    std::fs::write(path("room/mesh.toml"), text).unwrap();
    // Problem and plan named from the top, from beside, and from another place.
    run(top.path(), &["plan", "room/mesh.toml", "-o", "room/plans/p.json", "--no-picture"], 0);
    run(&path("room"), &["plan", "mesh.toml", "--no-picture"], 0);
    let all = [path("room/mesh.toml"), path("elsewhere/p.json")].map(|path| path.to_str().unwrap().to_owned());
    run(&path("elsewhere"), &["plan", &all[0], "-o", &all[1], "--no-picture"], 0);
    let plan = std::fs::read_to_string(path("room/plans/p.json")).unwrap();
    assert!(plan.contains("\"../meshes/stone.obj\""), "{plan}");

    run(top.path(), &["check", "room/plans/p.json"], 0);
    run(&path("room/plans"), &["check", "p.json"], 0);
    run(&path("elsewhere"), &["check", "../room/mesh.plan.json"], 0);
    run(&path("elsewhere"), &["show", "../room/mesh.plan.json", "-o", "p.html"], 0);
    run(Path::new("/"), &["check", &all[1]], 0);
    std::fs::rename(path("room"), path("moved")).unwrap();
    run(top.path(), &["check", "moved/plans/p.json"], 0);
    run(top.path(), &["check", "moved/mesh.plan.json"], 0);

    // Without its mesh it is not wrong, it cannot be read.
    let (_, complaint) = run(&path("elsewhere"), &["check", "p.json"], 2);
    for words in ["p.json: ", "`obstacle[", "meshes/stone.obj: cannot be read: "] {
        assert!(complaint.contains(words), "{words}: {complaint}");
    }
}

#[cfg(unix)]
#[test]
fn a_plan_written_through_a_link_is_read_through_it() {
    let top = tempfile::tempdir().unwrap();
    let path = |name: &str| top.path().join(name);
    std::fs::create_dir_all(path("store")).unwrap();
    solved_problem(top.path());
    std::fs::write(path("stone.obj"), STONE).unwrap();
    let mut text = std::fs::read_to_string(path("easy.toml")).unwrap();
    text.push_str("\n[[obstacle]]\nname = \"stone\"\nshape = { mesh = { file = \"stone.obj\" } }\nat = [2, 2, 0.2]\n");
    std::fs::write(path("easy.toml"), text).unwrap();
    std::fs::write(path("store/p.json"), "").unwrap();
    std::os::unix::fs::symlink("store/p.json", path("p.json")).unwrap();
    run(top.path(), &["plan", "easy.toml", "-o", "p.json", "--no-picture"], 0);
    run(top.path(), &["check", "p.json"], 0);
    run(top.path(), &["check", "store/p.json"], 0);
}

#[test]
fn what_is_read_is_never_written_over() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    solved_problem(folder);
    run(folder, &["plan", "easy.toml", "-o", "old.json", "--no-picture", "-q"], 0);
    std::fs::write(folder.join("noise.toml"), run(folder, &["execute", "--print-noise"], 0).0).unwrap();
    let inputs = ["easy.toml", "old.json", "noise.toml"];
    let before = inputs.map(|name| std::fs::read(folder.join(name)).unwrap());
    for arguments in [
        &["plan", "easy.toml", "--why", "easy.toml"][..],
        &["plan", "easy.toml", "--record", "./easy.toml"],
        &["plan", "easy.toml", "--from", "old.json", "--why", "old.json", "-o", "new.json"],
        &["plan", "easy.toml", "--from", "old.json", "--record", "old.json", "-o", "new.json"],
        &["execute", "old.json", "--page", "old.json"],
        &["execute", "old.json", "--mcap", "old.json"],
        &["execute", "old.json", "--noise", "noise.toml", "--page", "noise.toml"],
        &["robot", "check", "table-arm", "--problem", "noise.toml"],
        &["bench", "easy.toml", "--seeds", "1", "--report", "easy.toml"],
    ] {
        let (_, complaint) = run(folder, arguments, 2);
        assert!(complaint.contains("would be lost"), "{arguments:?}: {complaint}");
    }
    let (_, complaint) = run(folder, &["execute", "old.json", "--page", "one.html", "--mcap", "one.html"], 2);
    assert!(complaint.contains("cannot be both the page and the recording"), "{complaint}");
    assert_eq!(inputs.map(|name| std::fs::read(folder.join(name)).unwrap()), before);
}
