//! Arms of four and five joints, bolted down and on wheels, as their files are written and as they are guessed, each with its first
//! problem: to pick something up and set it down elsewhere.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test stops at the first surprise")]

use std::path::{Path, PathBuf};

use darrt_core::budget::Cancel;
use darrt_core::observe::Silent;
use darrt_task::file_robot::inspect::inspect;
use darrt_task::file_robot::{FileRobot, guess, trial};
use darrt_task::plan_file::PlanFile;
use darrt_task::planning::{PlanRequest, plan};
use darrt_task::problem_file::{GraspFamily, ProblemFile};
use darrt_task::registry::Registry;

const ROBOTS: [(&str, &str, &str); 3] = [
    ("scara", include_str!("data/few-joints/scara.urdf"), include_str!("data/few-joints/scara.toml")),
    ("desk-arm-5", include_str!("data/few-joints/desk-arm-5.urdf"), include_str!("data/few-joints/desk-arm-5.toml")),
    ("desk-arm-4", include_str!("data/few-joints/desk-arm-4.urdf"), include_str!("data/few-joints/desk-arm-4.toml")),
];

/// The robot files in a folder: as they are, on wheels, and guessed from a description that writes right angles with few digits.
fn files(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for (name, urdf, text) in ROBOTS {
        let path = |end: &str| folder.join(format!("{name}{end}"));
        std::fs::write(path(".urdf"), urdf).unwrap();
        let mobile = text.replace("kind = \"fixed\"", "kind = \"planar\"");
        assert_ne!(mobile, text);
        // The first frame of the arm turned about itself, and back.
        let rough = urdf.replacen("<axis xyz=\"0 0 1\"/>", "<axis xyz=\"0 0.0002 1\"/>", 1);
        assert_ne!(rough, urdf);
        std::fs::write(path("-rough.urdf"), rough).unwrap();
        let guessed = guess::robot_file(&path("-rough.urdf"), folder, &guess::Known::default()).unwrap();
        for (end, text) in [("-fixed.toml", text), ("-mobile.toml", &mobile), ("-guessed.toml", &guessed)] {
            std::fs::write(path(end), text).unwrap();
            files.push(path(end));
        }
    }
    files
}

fn first_problem(file: &Path) -> ProblemFile {
    let inspection = inspect(file.to_str().unwrap()).unwrap();
    assert_eq!(inspection.odd, Vec::<String>::new(), "{}", file.display());
    assert!(inspection.understood.iter().any(|line| line.starts_with("heading:")), "{:?}", inspection.understood);
    let is_guessed = file.to_string_lossy().ends_with("-guessed.toml");
    assert_eq!(inspection.understood.iter().any(|line| line.starts_with("straight:")), is_guessed);
    let line = format!("file = {}", serde_json::Value::from(file.to_str().unwrap()));
    ProblemFile::from_toml(&trial::problem(&inspection, &line, inspection.drives), "first").unwrap()
}

fn planned(problem: &ProblemFile, seed: u64) -> Option<PlanFile> {
    let mut request = PlanRequest::new(problem.clone(), seed);
    request.iterations = Some(2000);
    // What comes back was accepted by the verifier.
    plan(&Registry::<FileRobot>::new(), &request, &Cancel::new(), &mut Silent).unwrap().plan
}

fn solved(seeds: u64) {
    let folder = tempfile::tempdir().unwrap();
    for file in files(folder.path()) {
        let mut problem = first_problem(&file);
        // From the side there is one heading for each place, if the base does not move.
        if file.to_string_lossy().contains("desk-arm") && file.to_string_lossy().ends_with("-fixed.toml") {
            problem.objects.iter_mut().for_each(|object| object.grasps = vec![GraspFamily::Side]);
        }
        for seed in 0..seeds {
            let plan = planned(&problem, seed).unwrap_or_else(|| panic!("{}: seed {seed}: no plan", file.display()));
            let names: Vec<_> = plan.steps.iter().map(|step| step.primitive.as_str()).collect();
            assert!(names.contains(&"Pick") && names.contains(&"Place"), "{names:?}");
        }
    }
}

#[test]
fn they_pick_and_place() {
    solved(1);
}

#[test]
fn a_hand_that_points_down_is_not_searched_with_for_a_grasp_from_the_side() {
    let folder = tempfile::tempdir().unwrap();
    let file = files(folder.path()).remove(0);
    let mut problem = first_problem(&file);
    assert!(planned(&problem, 0).is_some());
    problem.objects.iter_mut().for_each(|object| object.grasps = vec![GraspFamily::Side]);
    let refused = plan(&Registry::<FileRobot>::new(), &PlanRequest::new(problem, 0), &Cancel::new(), &mut Silent);
    let refused = refused.unwrap_err();
    assert!(refused.is_impossible(), "{refused}");
    let why = "the hand is always tilted alike, and no grasp of it (`side`) is tilted so";
    assert!(refused.to_string().contains(why), "{refused}");
}

/// `cargo test -p darrt-task --test few_joints -- --ignored`
#[test]
#[ignore = "ninety plans take a minute"]
fn they_pick_and_place_whatever_the_seed() {
    solved(10);
}
