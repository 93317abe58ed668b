//! `darrt export` from outside; what it writes is read by readers of others.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test stops at the first surprise")]

use std::collections::BTreeMap;
use std::path::Path;

use serde_json::Value;
use yaml_rust2::YamlLoader;

use crate::program::run;

fn read(folder: &Path, name: &str) -> String {
    std::fs::read_to_string(folder.join(name)).unwrap()
}

fn json(folder: &Path, name: &str) -> Value {
    serde_json::from_str(&read(folder, name)).unwrap()
}

fn seconds(value: &Value) -> f64 {
    value["sec"].as_f64().unwrap() + value["nanosec"].as_f64().unwrap() * 1e-9
}

/// Plans the bowl and exports it in every format.
fn exported() -> (tempfile::TempDir, Value) {
    let folder = tempfile::tempdir().unwrap();
    let (printed, _) = run(folder.path(), &["plan", "bowl", "--no-picture"], 0);
    assert!(printed.contains(" s at the robot's limits"), "{printed}");
    for format in ["json", "yaml", "moveit", "csv", "mcap", "plan"] {
        let (printed, complaint) = run(folder.path(), &["export", "bowl.plan.json", "--to", format], 0);
        assert!(printed.contains("exported: bowl.") && complaint.is_empty(), "{printed}{complaint}");
    }
    let plan = json(folder.path(), "bowl.plan.json");
    (folder, plan)
}

/// Positions of a trajectory, and that its velocities are theirs.
fn check_trajectory(trajectory: &Value, joints: usize, duration_s: f64) {
    assert_eq!(trajectory["joint_names"].as_array().unwrap().len(), joints);
    let points = trajectory["points"].as_array().unwrap();
    let times: Vec<f64> = points.iter().map(|point| seconds(&point["time_from_start"])).collect();
    assert!(times.windows(2).all(|pair| pair[0] < pair[1]), "times grow");
    assert!(times[0] == 0.0 && (times[times.len() - 1] - duration_s).abs() < 1e-6);
    let numbers = |point: &Value, key: &str| -> Vec<f64> {
        point[key].as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect()
    };
    for (pair, times) in points.windows(2).zip(times.windows(2)) {
        let step_s = times[1] - times[0];
        let [a, b] = [&pair[0], &pair[1]].map(|point| (numbers(point, "positions"), numbers(point, "velocities")));
        assert!(a.0.len() == joints && a.1.len() == joints);
        for i in 0..joints {
            let mean = f64::midpoint(a.1[i], b.1[i]);
            // A trapezoid of a motion whose jerk is bounded by 20.
            assert!((b.0[i] - a.0[i] - mean * step_s).abs() < 20.0 * step_s.powi(3), "{i} at {}", times[0]);
        }
    }
    for end in [&points[0], &points[points.len() - 1]] {
        assert!(numbers(end, "velocities").iter().all(|v| v.abs() < 1e-9), "from rest to rest");
    }
}

#[test]
fn trajectories_by_group_are_read_back() {
    let (folder, plan) = exported();
    let document = json(folder.path(), "bowl.trajectory.json");
    let duration_s = plan["timing"]["duration_s"].as_f64().unwrap();
    assert_eq!(document["format"], "darrt-trajectory");
    for (group, joints) in [("arm", 7), ("base", 3), ("gripper", 1)] {
        check_trajectory(&document["groups"][group], joints, duration_s);
    }
    assert!(document["standing"]["torso_lift_joint"].is_number());
    let steps = document["steps"].as_array().unwrap();
    assert_eq!(steps.len(), plan["steps"].as_array().unwrap().len());
    let commands = document["gripper_commands"].as_array().unwrap();
    let grasp = commands.iter().find(|command| command["command"]["max_effort"].as_f64().unwrap() > 0.0).unwrap();
    // The wall of the bowl is in the hand then.
    let width = grasp["command"]["position"].as_f64().unwrap();
    assert!((0.001..0.03).contains(&width), "{width}");
    let open = commands.last().unwrap();
    assert!(open["command"]["position"].as_f64().unwrap() > width && open["command"]["max_effort"] == -1.0);
    let sensing: Vec<f64> =
        document["sensing"].as_array().unwrap().iter().map(|at| seconds(&at["time_from_start"])).collect();
    // After every drive, and before what is touched next.
    let driven = plan["steps"]
        .as_array()
        .unwrap()
        .iter()
        .zip(steps)
        .filter(|(step, _)| plan["contracts"][step["primitive"].as_str().unwrap()]["moves"] == "base");
    for (_, times) in driven {
        assert!(sensing.iter().any(|at| (at - seconds(&times["end"])).abs() < 1e-6), "{sensing:?} {times}");
    }
}

#[test]
fn yaml_says_the_same_to_another_reader() {
    let (folder, _) = exported();
    let document = json(folder.path(), "bowl.trajectory.json");
    let yaml = &YamlLoader::load_from_str(&read(folder.path(), "bowl.trajectory.yaml")).unwrap()[0];
    let number = |value: &yaml_rust2::Yaml| {
        value.as_f64().or_else(|| value.as_i64().map(|whole| whole as f64)).unwrap_or_else(|| panic!("{value:?}"))
    };
    assert_eq!(yaml["format"].as_str(), Some("darrt-trajectory"));
    assert_eq!(number(&yaml["duration_s"]), document["duration_s"].as_f64().unwrap());
    let (theirs, ours) = (&yaml["groups"]["arm"], &document["groups"]["arm"]);
    let names = ours["joint_names"].as_array().unwrap();
    assert!(names.iter().enumerate().all(|(i, name)| theirs["joint_names"][i].as_str() == name.as_str()));
    let points = ours["points"].as_array().unwrap();
    assert_eq!(theirs["points"].as_vec().unwrap().len(), points.len());
    for (i, point) in points.iter().enumerate() {
        for (j, position) in point["positions"].as_array().unwrap().iter().enumerate() {
            assert_eq!(number(&theirs["points"][i]["positions"][j]), position.as_f64().unwrap(), "{i} {j}");
        }
    }
}

#[test]
fn a_robot_trajectory_has_joints_and_base() {
    let (folder, plan) = exported();
    let robot = json(folder.path(), "bowl.moveit.json");
    let duration_s = plan["timing"]["duration_s"].as_f64().unwrap();
    check_trajectory(&robot["joint_trajectory"], 8, duration_s);
    let base = &robot["multi_dof_joint_trajectory"];
    assert_eq!(
        (base["joint_names"][0].as_str(), base["header"]["frame_id"].as_str()),
        (Some("world_joint"), Some("world"))
    );
    let points = base["points"].as_array().unwrap();
    assert_eq!(points.len(), robot["joint_trajectory"]["points"].as_array().unwrap().len());
    let end = &points[points.len() - 1]["transforms"][0]["translation"];
    let last =
        &plan["steps"].as_array().unwrap().last().unwrap()["waypoints"].as_array().unwrap().last().unwrap()["base"];
    assert!((end["x"].as_f64().unwrap() - last[0].as_f64().unwrap()).abs() < 1e-9);
}

#[test]
fn the_table_is_read_back() {
    let (folder, plan) = exported();
    let mut table = csv::Reader::from_path(folder.path().join("bowl.csv")).unwrap();
    let head = table.headers().unwrap().clone();
    let column = |name: &str| head.iter().position(|head| head == name).unwrap_or_else(|| panic!("{name}: {head:?}"));
    let (time, event, base) = (column("time_s"), column("event"), column("base_x"));
    column("r_elbow_flex_joint_velocity");
    let rows: Vec<_> = table.records().map(Result::unwrap).collect();
    let number = |row: &csv::StringRecord, column: usize| row[column].parse::<f64>().unwrap();
    assert!(rows.windows(2).all(|pair| number(&pair[0], time) < number(&pair[1], time)));
    assert!((number(&rows[rows.len() - 1], time) - plan["timing"]["duration_s"].as_f64().unwrap()).abs() < 1e-9);
    assert_eq!(number(&rows[0], base), plan["start"]["base"][0].as_f64().unwrap());
    assert!(rows.iter().any(|row| row[event].contains("sense")));
    let events = rows.iter().flat_map(|row| row[event].split("; "));
    let grasps = events.filter(|event| event.split(' ').count() == 3).count();
    assert_eq!(grasps, 1, "one grasp with width and force");
}

#[test]
fn the_recording_is_read_back() {
    let (folder, plan) = exported();
    let bytes = std::fs::read(folder.path().join("bowl.mcap")).unwrap();
    let mut last: BTreeMap<String, (u64, Value)> = BTreeMap::new();
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    let mut frames: BTreeMap<String, Value> = BTreeMap::new();
    for message in mcap::MessageStream::new(&bytes).unwrap() {
        let message = message.unwrap();
        let schema = message.channel.schema.clone().unwrap();
        assert_eq!((schema.encoding.as_str(), message.channel.message_encoding.as_str()), ("jsonschema", "json"));
        let _: Value = serde_json::from_slice(&schema.data).unwrap();
        let topic = message.channel.topic.clone();
        let before = last.get(&topic).map_or(0, |(time, _)| *time);
        assert!(message.log_time >= before);
        *counts.entry(topic.clone()).or_default() += 1;
        let value: Value = serde_json::from_slice(&message.data).unwrap();
        for frame in value["transforms"].as_array().into_iter().flatten() {
            frames.insert(frame["child_frame_id"].as_str().unwrap().to_owned(), frame.clone());
        }
        last.insert(topic, (message.log_time, value));
    }
    assert_eq!(counts["/joint_states"], counts["/tf"]);
    assert!(counts["/events"] > plan["steps"].as_array().unwrap().len());
    let (end, _) = &last["/tf"];
    assert!(frames.contains_key("r_gripper_tool_frame") && frames.contains_key("base_footprint"));
    assert!((*end as f64 * 1e-9 - plan["timing"]["duration_s"].as_f64().unwrap()).abs() < 1e-6);
    let bowl = &frames["bowl"];
    let waypoints = plan["steps"].as_array().unwrap().last().unwrap()["waypoints"].as_array().unwrap().last().unwrap();
    let there = waypoints["objects"]["bowl"]["position"][0].as_f64().unwrap();
    assert!((bowl["translation"]["x"].as_f64().unwrap() - there).abs() < 1e-9);
}

#[test]
fn old_plans_get_a_clock_and_wrong_ones_are_refused() {
    let (folder, plan) = exported();
    let mut old = plan.clone();
    old.as_object_mut().unwrap().remove("timing");
    std::fs::write(folder.path().join("old.json"), old.to_string()).unwrap();
    run(folder.path(), &["export", "old.json", "--to", "plan", "-o", "new.json", "--quiet"], 0);
    assert_eq!(json(folder.path(), "new.json")["timing"], plan["timing"], "one plan, one clock");
    let (printed, _) = run(folder.path(), &["check", "new.json"], 0);
    assert!(printed.contains("clock: "), "{printed}");
    let mut wrong = plan;
    wrong["timing"]["duration_s"] = 1.0.into();
    std::fs::write(folder.path().join("wrong.json"), wrong.to_string()).unwrap();
    for command in [&["check", "wrong.json"][..], &["export", "wrong.json", "--to", "csv"]] {
        let (_, complaint) = run(folder.path(), command, 3);
        assert!(complaint.contains("`timing.duration_s` is 1"), "{complaint}");
    }
    assert!(!folder.path().join("wrong.csv").exists());
}

#[test]
fn usage_errors_name_what_is_wrong() {
    let (folder, _) = exported();
    for (arguments, words) in [
        (&["export", "bowl.plan.json"][..], "--to"),
        (&["export", "bowl.plan.json", "--to", "bag"], "possible values"),
        (&["export", "bowl.plan.json", "--to", "csv", "--rate", "0"], "from 1 to 1000"),
        (&["export", "bowl.plan.json", "--to", "csv", "-o", "bowl.plan.json"], "is the plan itself"),
        (&["export", "bowl", "--to", "csv"], "darrt plan bowl"),
    ] {
        let (_, complaint) = run(folder.path(), arguments, 2);
        assert!(complaint.contains(words), "{arguments:?}: {complaint}");
    }
    run(folder.path(), &["export", "bowl.plan.json", "--to", "csv", "-o", "no/such/folder.csv"], 4);
}
