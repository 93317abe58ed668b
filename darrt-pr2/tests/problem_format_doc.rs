//! The example of `docs/problem-format.md` is a valid problem.

use std::collections::BTreeSet;

use darrt_pr2::postures::ArmPosture;
use darrt_pr2::problems::{builtin, builtin_names};
use darrt_task::problem_file::{GoalState, GoalTarget, ProblemFile};

#[test]
fn the_example_in_the_documentation_is_valid() {
    let page = include_str!("../../darrt-primitives/task/docs/problem-format.md");
    let example = page.split("```toml\n").nth(1).and_then(|rest| rest.split("```").next()).unwrap();
    let problem = ProblemFile::from_toml(example, "docs/problem-format.md").unwrap();
    assert_eq!(problem.name, "mug-aside");
    let goal = &problem.goal.objects[0];
    assert_eq!(goal.state(), GoalState::Released);
    assert!(matches!(goal.target(), Some(GoalTarget::Within { .. })));
    let geometry = problem.geometry().unwrap();
    assert_eq!(geometry.scene.bodies().len(), 3, "table, kettle and floor");
    let kettle = geometry.scene.body("kettle").unwrap();
    assert!((kettle.world_from_body.translation.z - 0.84).abs() < 1e-12);
    assert!((geometry.objects[0].world_from_object.translation.z - 0.79).abs() < 1e-12);
}

/// The keys of all tables inside `value`.
fn keys(value: &serde_json::Value, found: &mut Vec<String>) {
    match value {
        serde_json::Value::Object(table) => {
            for (key, value) in table {
                found.push(key.clone());
                keys(value, found);
            }
        }
        serde_json::Value::Array(values) => values.iter().for_each(|value| keys(value, found)),
        _ => {}
    }
}

#[test]
fn every_key_and_every_posture_is_documented() {
    let page = include_str!("../../darrt-primitives/task/docs/problem-format.md");
    let mut found = Vec::new();
    for name in builtin_names() {
        keys(&serde_json::to_value(builtin(name).unwrap()).unwrap(), &mut found);
    }
    let words: BTreeSet<&str> = page.split(|c: char| !c.is_ascii_alphanumeric() && c != '_').collect();
    for name in found.iter().map(String::as_str).chain(ArmPosture::ALL.map(ArmPosture::name)) {
        assert!(words.contains(name), "`{name}` is not documented");
    }
}
