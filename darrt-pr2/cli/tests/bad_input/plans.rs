//! Plan files that are wrong, files of the other kind, and names that would act on a terminal.

use crate::bad_input::desk::Desk;
use crate::bad_input::{GOAL, POSTURE};

/// A goal that holds at the start: the plan has no steps.
const THERE: &str = "on = \"central table\"\nat = [-0.20, 0.05]";

#[test]
fn plan_files_are_checked() {
    let desk = Desk::new();
    desk.problem("easy.toml", &[(GOAL, THERE)]);
    let output = desk.run(&["plan", "easy.toml", "-o", "good.json", "--no-picture", "--quiet"]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let good = std::fs::read_to_string(desk.path("good.json")).unwrap();
    let cases: [(&str, &str, i32, &[&str]); 7] = [
        ("\"seed\"", "\"seeed\"", 2, &["at `seeed`", "did you mean `seed`?"]),
        ("\"r_elbow_flex_joint\"", "\"r_elbow_joint\"", 3, &["r_elbow"]),
        ("-0.8,\n    0.0,\n", "1e999,\n    0.0,\n", 2, &["`problem.robot.base[0]`", "out of range"]),
        ("-0.8,\n    0.0,\n    0.0\n", "-0.8,\n    0.0,\n    9.0\n", 3, &["`robot.base[2]`", "is 9", "radians"]),
        ("\"torso_m\": 0.2", "\"torso_m\": 9", 3, &["`robot.torso_m`", "is 9", "[0, 0.33]"]),
        ("\"quaternion\": [0.0, 0.0, 0.0, 1.0]", "\"quaternion\": [0.0, 0.0, 0.0, 2.0]", 3, &["plate", "quaternion"]),
        ("\"version\": 2", "\"version\": 9", 2, &["`version` is 9", "version 2"]),
    ];
    for (old, new, exit, parts) in cases {
        assert!(good.contains(old), "the test replaces `{old}`, which is not there");
        desk.write("bad.json", good.replacen(old, new, 1));
        let parts: Vec<&str> = ["bad.json"].iter().chain(parts).copied().collect();
        desk.refused(&["check", "bad.json"], exit, &parts);
    }
}

#[test]
fn what_a_waypoint_lacks_is_named() {
    let desk = Desk::new();
    desk.problem("easy.toml", &[(GOAL, THERE)]);
    desk.run(&["plan", "easy.toml", "-o", "good.json", "--no-picture", "--quiet"]);
    let mut plan: serde_json::Value = serde_json::from_slice(&std::fs::read(desk.path("good.json")).unwrap()).unwrap();
    let start = plan["start"].clone();
    let mut torn = start.clone();
    torn["joints"].as_object_mut().unwrap().remove("r_wrist_roll_joint");
    for (waypoints, index) in [([&torn, &start], 0), ([&start, &torn], 1)] {
        plan["steps"] = serde_json::json!([{
            "primitive": "Arm-Transit", "object": null, "holds": null, "pushes": null, "allowed_contacts": [],
            "waypoints": waypoints,
        }]);
        desk.write("torn.json", plan.to_string());
        let place = format!("step 1 (Arm-Transit): waypoint {index} lacks the joint `r_wrist_roll_joint`");
        desk.refused(&["check", "torn.json"], 3, &["torn.json: refused: ", &place]);
    }
}

#[test]
fn files_of_the_other_kind_are_told_and_sent_to_their_command() {
    let desk = Desk::new();
    desk.problem("easy.toml", &[(GOAL, THERE)]);
    desk.run(&["plan", "easy.toml", "-o", "easy.json", "--no-picture", "--quiet"]);
    let plan = std::fs::read_to_string(desk.path("easy.json")).unwrap();
    // Larger than any problem file may be.
    desk.write("large.json", format!("{plan}{}", " ".repeat(5 << 20)));
    for name in ["easy.json", "large.json"] {
        let command = format!("`darrt check {name}`");
        desk.refused(&["plan", name], 2, &[&format!("{name}: is a plan, not a problem"), &command]);
    }
    desk.refused(&["check", "easy.toml"], 2, &["easy.toml: is a problem, not a plan", "`darrt plan easy.toml`"]);
    desk.refused(&["check", "plate3"], 2, &["plate3: is a built-in problem", "`darrt plan plate3`"]);
    desk.write("problem.json", "{\"format\": \"darrt-problem\"}");
    desk.refused(&["plan", "problem.json"], 2, &["problem.json: is a problem as JSON", "TOML"]);
    desk.refused(&["check", "problem.json"], 2, &["problem.json: is a problem as JSON, not a plan"]);
}

#[test]
fn names_cannot_act_on_the_terminal() {
    let escape = "\\u001b[2J";
    let shown = "\\u{1b}[2J";
    for (old, new, key) in [
        ("name = \"plate1\"", format!("name = \"a{escape}\""), "`name`"),
        ("name = \"plate\"", format!("name = \"a{escape}\""), "`object[0].name`"),
        ("name = \"big bowl\"", format!("name = \"a\\nb{escape}\""), "`obstacle[10].name`"),
        ("mass_kg = ", format!("\"a{escape}\" = "), "unknown field"),
        ("\non = \"central table\"", format!("\non = \"a{escape}\""), "`object[0].on`"),
        (POSTURE, format!("\nposture = \"a{escape}\""), "`robot.posture`"),
    ] {
        let desk = Desk::new();
        desk.problem("bad.toml", &[(old, &new)]);
        desk.plan_refused("bad.toml", &[key, shown]);
    }
    let desk = Desk::new();
    desk.problem("easy.toml", &[(GOAL, THERE)]);
    desk.run(&["plan", "easy.toml", "-o", "good.json", "--no-picture", "--quiet"]);
    let good = std::fs::read_to_string(desk.path("good.json")).unwrap();
    for (old, exit) in [("\"seed\"", 2), ("\"r_elbow_flex_joint\"", 3), ("\"name\": \"plate\"", 3)] {
        let new = if old.contains(':') { format!("\"name\": \"a\\n{escape}\"") } else { format!("\"a\\n{escape}\"") };
        desk.write("bad.json", good.replacen(old, &new, 1));
        desk.refused(&["check", "bad.json"], exit, &[shown]);
    }
}
