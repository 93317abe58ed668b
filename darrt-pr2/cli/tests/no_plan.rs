//! What the program says, writes and ends with where there is no plan.
#![allow(clippy::unwrap_used, reason = "a test says what is wrong by panicking")]

use darrt_task::diagnosis::cause::Cause;
use darrt_task::diagnosis::explain::Explanation;
use darrt_task::diagnosis::relax::Relaxation;
use darrt_task::diagnosis::{Diagnosis, Outcome};

use crate::program::{darrt, text};

/// A mug on a table that shall go to a shelf; where the shelf stands, and what else there is.
fn problem(shelf_z: f64, more: &str) -> String {
    format!(
        "format = \"darrt-problem\"\nversion = 1\nname = \"mug\"\nprimitives = [\"Arm-Transit\", \"Straight-Line-Arm-Transit\", \
         \"Arm-Rigid-Transfer\", \"Base-Transit\", \"Base-Rigid-Transfer\", \"Pick\", \"Place\", \"Push\"]\n[robot]\nbase = [-1.0, \
         0.0, 0.0]\n[bounds]\nobject_z = [0.0, 2.5]\n[[obstacle]]\nname = \"table\"\nshape = {{ box = {{ size = [0.8, 1.2, 0.74] \
         }} }}\nat = [0, 0, 0.37]\n[[obstacle]]\nname = \"shelf\"\nshape = {{ box = {{ size = [0.6, 0.6, 0.05] }} }}\nat = [0, \
         2.0, {shelf_z}]\n{more}\n[[surface]]\nname = \"table\"\ntop_of = \"table\"\n[[surface]]\nname = \"shelf\"\ntop_of = \
         \"shelf\"\n[[object]]\nname = \"mug\"\nshape = {{ cylinder = {{ radius = 0.035, height = 0.1 }} }}\non = \
         \"table\"\nat = [-0.2, 0.2]\ngrasps = [\"side\"]\n[[goal.object]]\nobject = \"mug\"\non = \"shelf\"\nat = [-0.1, 1.9]\n"
    )
}

#[test]
fn a_failed_search_says_why_and_leaves_its_beginning() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    std::fs::write(path("high.toml"), problem(1.975, "")).unwrap();
    let plan = ["plan", "high.toml", "--iterations", "300", "--no-picture", "--why", "why.json"];
    let output = darrt(folder.path(), &plan);
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(5), "{said}");
    assert!(said.lines().count() <= 10, "{said}");
    assert!(!said.contains("--time-limit") && !said.contains("more --iterations"), "more time is no help: {said}");
    let why: Diagnosis = serde_json::from_str(&std::fs::read_to_string(path("why.json")).unwrap()).unwrap();
    assert_eq!(why.outcome, Outcome::Hopeless);
    assert!(matches!(&why.causes[..], [Cause::NoHand { hands }] if hands.object == "mug"), "{why:?}");

    assert!(!path("high.plan.json").exists());
    let check = darrt(folder.path(), &["check", "high.partial.json"]);
    assert_eq!(check.status.code(), Some(5), "{}", text(&check.stderr));
    let json = text(&darrt(folder.path(), &["check", "high.partial.json", "--json"]).stdout);
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!((json["accepted"].as_bool(), &json["partial"]["remains"][0]), (Some(false), &"mug".into()));
    let show = darrt(folder.path(), &["show", "high.partial.json", "-o", "high.svg"]);
    assert_eq!(show.status.code(), Some(0), "{}", text(&show.stderr));
}

#[test]
fn a_refused_problem_has_a_diagnosis_too() {
    let folder = tempfile::tempdir().unwrap();
    let block = "[[obstacle]]\nname = \"jar\"\nshape = { box = { size = [0.2, 0.2, 0.2] } }\nat = [-0.1, 1.9, 0.8]\n";
    std::fs::write(folder.path().join("jar.toml"), problem(0.7, block)).unwrap();
    let output = darrt(folder.path(), &["plan", "jar.toml", "--why", "why.json"]);
    assert_eq!(output.status.code(), Some(6));
    let why = std::fs::read_to_string(folder.path().join("why.json")).unwrap();
    let why: Diagnosis = serde_json::from_str(&why).unwrap();
    assert!(matches!(&why.causes[..], [Cause::GoalOccupied { by, .. }] if by == "jar"), "{why:?}");
}

#[test]
fn explain_names_the_change_that_makes_a_plan() {
    let folder = tempfile::tempdir().unwrap();
    // Two boards, the upper one as low as the mug is high.
    let board =
        "[[obstacle]]\nname = \"board above\"\nshape = { box = { size = [0.6, 0.6, 0.02] } }\nat = [0, 2.0, 0.84]\n";
    std::fs::write(folder.path().join("low.toml"), problem(0.7, board)).unwrap();
    let output = darrt(folder.path(), &["explain", "low.toml", "--iterations", "400", "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let answer: Explanation = serde_json::from_str(&text(&output.stdout)).unwrap();
    let without = vec![Relaxation::Without { obstacles: vec!["board above".to_owned()] }];
    assert!(answer.solved.iter().any(|solved| solved.changes == without), "{answer:?}");
}
