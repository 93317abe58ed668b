//! Robots that come as files, from the command line: the guide as it is written, the robots inside, and what is wrong with a file.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "a test says what is wrong by panicking"
)]

use std::path::Path;
use std::process::Output;

use crate::program::darrt;

fn text(output: &Output) -> String {
    format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr))
}

fn done(folder: &Path, arguments: &[&str]) -> String {
    let output = darrt(folder, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", text(&output));
    String::from_utf8(output.stdout).unwrap()
}

fn refused(folder: &Path, arguments: &[&str]) -> String {
    let output = darrt(folder, arguments);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {}", text(&output));
    String::from_utf8(output.stderr).unwrap()
}

/// The robots inside.
const ROBOTS: [&str; 5] = ["mobile-arm", "panda-arm", "planar-arm", "table-arm", "two-arm"];

#[test]
fn the_guide_can_be_followed() {
    let folder = tempfile::tempdir().unwrap();
    let guide = include_str!("../docs/your-robot.md");
    let mut commands = 0;
    for block in guide.split("```sh\n").skip(1).map(|rest| rest.split("```").next().unwrap()) {
        for line in block.lines() {
            let line = line.split('#').next().unwrap().trim();
            let (command, file) =
                line.split_once(" > ").map_or((line, None), |(command, file)| (command, Some(file.trim())));
            let words: Vec<&str> = command.split_whitespace().collect();
            assert_eq!(words[0], "darrt");
            let said = done(folder.path(), &words[1..]);
            if let Some(file) = file {
                std::fs::write(folder.path().join(file), said).unwrap();
            }
            commands += 1;
        }
    }
    assert_eq!(commands, 10);
    let plan = std::fs::read_to_string(folder.path().join("mine.plan.json")).unwrap();
    assert!(plan.contains("\"file\": \"my.toml\""), "a plan names the robot file from its own folder");
    assert!(folder.path().join("first.html").exists());
}

#[test]
fn nothing_is_odd_about_the_robots_inside() {
    let folder = tempfile::tempdir().unwrap();
    let list = done(folder.path(), &["robot", "list"]);
    for robot in ROBOTS {
        assert!(list.contains(robot), "{list}");
        let said = done(folder.path(), &["robot", "check", robot]);
        assert!(said.ends_with("nothing is odd\n"), "{robot}: {said}");
        assert!(folder.path().join(format!("{robot}.robot.html")).exists());
    }
}

#[test]
fn a_robot_that_is_bolted_down_plans_what_it_reaches_and_says_why_not() {
    let folder = tempfile::tempdir().unwrap();
    done(folder.path(), &["robot", "check", "table-arm", "--no-picture", "--problem", "first.toml"]);
    done(folder.path(), &["plan", "first.toml", "--no-picture"]);
    done(folder.path(), &["check", "first.plan.json"]);
    let output =
        darrt(folder.path(), &["plan", "plate3", "--robot", "table-arm", "--iterations", "50", "--no-picture"]);
    assert_eq!(output.status.code(), Some(1), "{}", text(&output));
    let said = text(&output);
    assert!(said.contains("without Base-Transit and Base-Rigid-Transfer"), "{said}");
    // Its base stays where it is, whoever wrote the plan.
    let path = folder.path().join("first.plan.json");
    let plan = std::fs::read_to_string(&path).unwrap();
    let mut plan: serde_json::Value = serde_json::from_str(&plan).unwrap();
    let waypoint = plan["steps"][0]["waypoints"].as_array_mut().unwrap().last_mut().unwrap();
    waypoint["base"][0] = serde_json::json!(0.01);
    std::fs::write(&path, plan.to_string()).unwrap();
    let output = darrt(folder.path(), &["check", "first.plan.json"]);
    assert_eq!(output.status.code(), Some(3));
    assert!(text(&output).contains("the base moves, which is bolted down"), "{}", text(&output));
}

#[test]
fn a_first_problem_is_written_over_until_it_is_edited() {
    let folder = tempfile::tempdir().unwrap();
    let (folder, path) = (folder.path(), folder.path().join("first.toml"));
    let arguments = ["robot", "check", "table-arm", "--no-picture", "--problem", "first.toml"];
    for _ in 0..2 {
        done(folder, &arguments);
    }
    let edited = std::fs::read_to_string(&path).unwrap().replacen("mass_kg", "# lighter\nmass_kg", 1) + "# mine\n";
    std::fs::write(&path, &edited).unwrap();
    assert!(refused(folder, &arguments).contains("would be lost"));
    assert_eq!(std::fs::read_to_string(&path).unwrap(), edited);
}

#[test]
fn a_rail_is_a_joint_of_the_arm() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let robot = done(folder, &["robot", "list", "--print", "table-arm"]);
    let robot = robot.replace(
        "kind = \"fixed\"",
        "kind = \"rail\"\nrail_axis = [0, 1, 0]\nrail_m = [-0.6, 0.6]\nxyz = [0, 0, 0.02]",
    );
    let robot = robot
        .replace("ready = [", "ready = [0, ")
        .replace("left = [", "left = [0, ")
        .replace("right = [", "right = [0, ");
    std::fs::write(folder.join("my.toml"), robot).unwrap();
    std::fs::write(folder.join("table-arm.urdf"), done(folder, &["robot", "list", "--print-urdf", "table-arm"]))
        .unwrap();
    let said = done(folder, &["robot", "check", "my.toml", "--no-picture", "--problem", "first.toml"]);
    assert!(said.contains("joint:    rail, -0.600 to 0.600") && said.ends_with("nothing is odd\n"), "{said}");
    done(folder, &["plan", "first.toml", "--no-picture"]);
    let plan = std::fs::read_to_string(folder.join("first.plan.json")).unwrap();
    let plan: serde_json::Value = serde_json::from_str(&plan).unwrap();
    let waypoints = plan["steps"].as_array().unwrap().iter().flat_map(|step| step["waypoints"].as_array().unwrap());
    assert!(waypoints.clone().any(|waypoint| waypoint["joints"]["rail"] != 0.0), "the rail is used");
    assert!(waypoints.clone().all(|waypoint| waypoint["base"] == serde_json::json!([0.0, 0.0, 0.0])));
}

/// A robot file in which a line is another one.
fn changed(folder: &Path, from: &str, to: &str) -> usize {
    let robot = done(folder, &["robot", "list", "--print", "mobile-arm"]);
    assert_eq!(robot.matches(from).count(), 1, "{from}");
    std::fs::write(folder.join("mobile-arm.urdf"), done(folder, &["robot", "list", "--print-urdf", "mobile-arm"]))
        .unwrap();
    std::fs::write(folder.join("my.toml"), robot.replace(from, to)).unwrap();
    robot.lines().position(|line| line.contains(from.lines().next().unwrap())).unwrap() + 1
}

#[test]
fn what_is_wrong_with_a_robot_file_has_its_line() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (from, to, why) in [
        ("kind = \"planar\"", "kind = \"diferential\"", "did you mean `differential`?"),
        ("to = \"hand\"", "to = \"hnad\"", "did you mean `hand`?"),
        ("from = \"wagon\"", "from = \"forearm_roll\"", "is moved by 2 joints"),
        ("joint = \"left_jaw\"", "joint = \"right_jaw\"", "follows `left_jaw`: name that one"),
        ("tips = [\"left_finger\", \"right_finger\"]", "tips = [\"right_finger\", \"left_finger\"]", "overlap by"),
        ("xyz = [0, 0, 0.15]", "xyz = [0, 0.01, 0.15]", "10.0 mm beside the middle between the pads"),
        ("rpy = [0, -1.5707963267948966, 0]", "rpy = [0, 0, 0.7]", "along the tool's x axis"),
        ("kind = \"planar\"", "xyz = [0, 0, -0.1]\nkind = \"planar\"", "puts `wagon` 100.0 mm into the floor"),
        ("home = \"ready\"", "home = \"redy\"", "did you mean `ready`?"),
        (
            "right = [-1.57, -0.4, 0, 2.0, 0, 1.54, 0]",
            "right = [-3.57, -0.4, 0, 2.0, 0, 1.54, 0]",
            "must be in [-2.9, 2.9]",
        ),
        ("left = [1.57, -0.4, 0, 2.0, 0, 1.54, 0]", "left = [1.57, -0.4]", "has 2 entries, must have 7"),
        ("payload_kg = 2.0", "payload_kg = nan", "is NaN, must be above 0"),
        ("pad_length_m = 0.04", "pad_lenght_m = 0.04", "did you mean `pad_length_m`?"),
    ] {
        let line = changed(folder, from, to);
        let said = refused(folder, &["robot", "check", "my.toml"]);
        assert!(said.contains(why), "{to}: {said}");
        let planned = refused(folder, &["plan", "bowl", "--robot", "my.toml"]);
        assert!(planned.contains(why), "{to}: {planned}");
        // What is found by two keys together is told at the other one.
        let is_told_elsewhere = to.starts_with("rpy") || to.starts_with("from");
        assert!(said.contains(&format!("my.toml:{line}:")) || is_told_elsewhere, "{to}: line {line}: {said}");
    }
}

#[test]
fn an_arm_in_one_plane_pushes_and_says_that_it_does_not_lift() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for seed in ["0", "1", "2"] {
        let said = done(folder, &["plan", "puck", "--seed", seed, "--no-picture"]);
        assert!(said.contains("Push") && !said.contains("Pick"), "{said}");
        done(folder, &["check", "puck.plan.json"]);
    }
    done(folder, &["show", "puck.plan.json", "-o", "puck.svg"]);
    let said = done(folder, &["robot", "check", "planar-arm", "--no-picture", "--problem", "first.toml"]);
    for line in ["tilt:     the hand is level", "cannot:   the arm does not lift", "can:      push what stands lower"] {
        assert!(said.contains(line), "{said}");
    }
    let first = done(folder, &["plan", "first.toml", "--no-picture"]);
    assert!(first.contains("Push"), "{first}");
    // What needs lifting is no search to the end of the budget.
    let output = darrt(folder, &["plan", "plate3", "--robot", "planar-arm", "--no-picture"]);
    assert_eq!(output.status.code(), Some(6), "{}", text(&output));
    let said = text(&output).split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(said.contains("without Arm-Rigid-Transfer and Pick and Place"), "{said}");
    assert!(said.contains("the arm does not lift: its hand stays 0.782 m above the floor"), "{said}");
    // A table at another height is not searched on either.
    let low = done(folder, &["problems", "--print", "puck"]).replace("0.78]", "0.70]").replace("0.73]", "0.65]");
    std::fs::write(folder.join("low.toml"), low).unwrap();
    let output = darrt(folder, &["plan", "low.toml", "--no-picture"]);
    assert_eq!(output.status.code(), Some(6), "{}", text(&output));
    let said = text(&output).split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        said.contains("the fingertips stay 102.0 mm above `table`, to push it they must be between 5.0 and 50.0 mm"),
        "{said}"
    );
}

#[test]
fn a_robot_that_nobody_has_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let said = refused(folder.path(), &["plan", "bowl", "--robot", "mobil-arm"]);
    assert!(said.contains("did you mean `mobile-arm`?"), "{said}");
    assert!(refused(folder.path(), &["plan", "bowl", "--robot", "none.toml"]).contains("none.toml"));
}

#[test]
fn a_base_with_two_wheels_drives_along_its_heading() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    done(folder, &["plan", "bowl", "--robot", "panda-arm", "--no-picture"]);
    done(folder, &["check", "bowl.plan.json"]);
    let path = folder.join("bowl.plan.json");
    let mut plan: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap();
    let numbers = |waypoint: &serde_json::Value| [0, 1, 2].map(|i| waypoint["base"][i].as_f64().unwrap());
    let (mut drives, mut corner) = (0, None);
    for (number, step) in plan["steps"].as_array().unwrap().iter().enumerate() {
        let bases: Vec<_> = step["waypoints"].as_array().unwrap().iter().map(numbers).collect();
        for (index, pair) in bases.windows(2).enumerate() {
            let ([x, y, yaw], [to_x, to_y, to_yaw]) = (pair[0], pair[1]);
            let (ahead, aside) = (to_x - x, to_y - y);
            if ahead.hypot(aside) > 1e-3 {
                assert!((yaw.cos() * aside - yaw.sin() * ahead).abs() < 1e-6, "{pair:?} goes sideways");
                assert!((yaw - to_yaw).abs() < 1e-6, "{pair:?} turns while it drives");
                drives += 1;
                corner = (index > 0).then_some((number, index)).or(corner);
            }
        }
    }
    assert!(drives > 0);
    // Whoever wrote the plan: a base that starts to drive before it has turned is refused.
    let (step, waypoint) = corner.unwrap();
    let yaw = &mut plan["steps"][step]["waypoints"][waypoint]["base"][2];
    *yaw = serde_json::json!(yaw.as_f64().unwrap() - 0.01);
    std::fs::write(&path, plan.to_string()).unwrap();
    let output = darrt(folder, &["check", "bowl.plan.json"]);
    assert_eq!(output.status.code(), Some(3));
    assert!(text(&output).contains("the base drives along its heading only, and it turns by"), "{}", text(&output));
}
