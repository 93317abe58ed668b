//! `darrt execute` from outside.

#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

use std::path::Path;
use std::process::Command;

/// Runs, expects this exit code, returns what was printed and what was complained about.
fn run(folder: &Path, arguments: &[&str], expected: i32) -> (String, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_darrt")).current_dir(folder).args(arguments).output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).unwrap();
    let (printed, complaint) = (text(&output.stdout), text(&output.stderr));
    assert_eq!(output.status.code(), Some(expected), "{arguments:?}: {printed}{complaint}");
    assert!(!complaint.contains("panicked"), "{complaint}");
    (printed, complaint)
}

#[test]
fn a_plan_is_carried_out_and_the_same_whatever_the_number_of_threads() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    run(folder, &["plan", "bowl", "-o", "plan.json", "--no-picture", "--quiet"], 0);
    let (printed, _) = run(folder, &["execute", "plan.json"], 0);
    assert!(printed.starts_with("executed: 1 of 1 run succeeded"), "{printed}");
    // Far off, so that runs fail early, and differ.
    std::fs::write(folder.join("far.toml"), "detection_m = 0.1\n").unwrap();
    let far = ["execute", "plan.json", "--noise", "far.toml", "--runs", "3", "--json"];
    let json = |threads| run(folder, &[&far[..], &["--threads", threads]].concat(), 1).0;
    let one = json("1");
    assert_eq!(one, json("3"));
    let value: serde_json::Value = serde_json::from_str(&one).unwrap();
    let runs = value["runs"].as_array().unwrap();
    assert_eq!((runs.len(), value["complete"].as_bool()), (3, Some(true)));
    assert_ne!(runs[0]["objects"], runs[1]["objects"]);
    let departure = &runs.iter().find(|run| run["is_success"] == false).unwrap()["departure"];
    assert!(departure["step"].as_u64().unwrap() >= 1 && departure["cause"].is_string(), "{departure}");
}

#[test]
fn noise_is_a_part_or_a_file_that_makes_sense() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    run(folder, &["plan", "bowl", "-o", "plan.json", "--no-picture", "--quiet"], 0);
    let (real, _) = run(folder, &["execute", "--print-noise"], 0);
    assert!(real.contains("detection_m = 0.010"), "{real}");
    let files = [("key.toml", "detection = 1"), ("range.toml", "mass = 0.5"), ("text.toml", "= 1")];
    for (name, text) in files {
        std::fs::write(folder.join(name), text).unwrap();
    }
    let cases = [
        ("1.5", "from 0 to 1"),
        ("nan", "from 0 to 1"),
        ("key.toml", "unknown field `detection`"),
        ("range.toml", "`mass` is 0.5, must be from 0 to 0.33"),
        ("text.toml", "text.toml:1"),
        ("none.toml", "none.toml"),
    ];
    for (noise, words) in cases {
        let (_, complaint) = run(folder, &["execute", "plan.json", "--noise", noise], 2);
        assert!(complaint.contains(words), "{noise}: {complaint}");
    }
    run(folder, &["execute", "bowl"], 2);
    run(folder, &["execute"], 2);
}
