//! A robot with two arms, from the command line: the search chooses the hand for every step, and a problem that no arm can solve alone.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "a test says what is wrong by panicking"
)]

use std::collections::BTreeSet;

use crate::program::darrt;

/// The step, as `primitive`, and the tool of the hand at work, of every step of a plan.
fn steps(text: &str) -> Vec<(String, Option<String>)> {
    let plan: serde_json::Value = serde_json::from_str(text).unwrap();
    let word = |step: &serde_json::Value, key: &str| step[key].as_str().map(str::to_owned);
    plan["steps"]
        .as_array()
        .unwrap()
        .iter()
        .map(|step| (word(step, "primitive").unwrap(), word(step, "tool")))
        .collect()
}

#[test]
fn what_one_hand_sets_down_the_other_takes_up() {
    let folder = tempfile::tempdir().unwrap();
    for seed in ["0", "1"] {
        let output = darrt(folder.path(), &["plan", "hand-over", "--seed", seed, "-o", "plan.json"]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        for how in [&["check", "plan.json"][..], &["check", "plan.json", "--plain"]] {
            let checked = darrt(folder.path(), how);
            assert!(checked.status.success(), "{}", String::from_utf8_lossy(&checked.stderr));
        }
        // A driver is told which hand; what executes plans here has one arm and says so.
        let told = darrt(folder.path(), &["export", "plan.json", "--to", "json", "-o", "told.json"]);
        assert!(told.status.success(), "{}", String::from_utf8_lossy(&told.stderr));
        let told = std::fs::read_to_string(folder.path().join("told.json")).unwrap();
        let told: serde_json::Value = serde_json::from_str(&told).unwrap();
        let hands: BTreeSet<_> =
            told["gripper_commands"].as_array().unwrap().iter().map(|c| c["tool"].as_str()).collect();
        assert_eq!(hands, BTreeSet::from([None, Some("left_hand_tool")]));
        assert!(told["groups"].as_object().unwrap().contains_key("second_gripper"));
        let executed = darrt(folder.path(), &["execute", "plan.json"]);
        let words = String::from_utf8_lossy(&executed.stderr);
        assert!(!executed.status.success() && words.contains("the first arm and hand of a robot only"), "{words}");
        let steps = steps(&std::fs::read_to_string(folder.path().join("plan.json")).unwrap());
        let of = |primitive: &str| -> BTreeSet<_> {
            steps.iter().filter(|(name, _)| name == primitive).map(|(_, tool)| tool.clone()).collect()
        };
        let both = BTreeSet::from([None, Some("left_hand_tool".to_owned())]);
        assert_eq!((of("Pick"), of("Place")), (both.clone(), both), "{steps:?}");
        // The mug stands on the left.
        let first = steps.iter().find(|(name, _)| name == "Pick").unwrap();
        assert_eq!(first.1.as_deref(), Some("left_hand_tool"));
    }
}

#[test]
fn one_arm_does_not_do_it() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["plan", "hand-over", "--robot", "mobile-arm", "--iterations", "300", "--no-picture"];
    let output = darrt(folder.path(), &arguments);
    assert!(!output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
}
