use super::*;
use darrt_primitives::primitive::STANDARD;

use crate::plan_file::{
    AllowedContact, ContactReason, GradeName, Hold, PlanFormat, PlannerFacts, Pose, SearchName, Step, Waypoint,
};
use crate::problem_file::{DistanceName, PrimitiveName, SamplerName};
use crate::testing::builtin;
use std::collections::BTreeMap;

/// A plan with something in every key; not a right one.
pub(in crate::plan_file) fn sample() -> PlanFile {
    let pose = Pose { position: [-0.2, 0.05, 0.76], quaternion: [0.0, 0.0, 0.0, 1.0] };
    let joints = ["a_joint", "b_joint", "c_joint", "d_joint", "e_joint", "f_joint"];
    let at = Waypoint {
        base: [-0.8, 0.0, 0.0],
        joints: joints.into_iter().map(|name| (name.into(), 0.125)).collect(),
        objects: BTreeMap::from([("plate".into(), pose)]),
    };
    let step = Step {
        primitive: PrimitiveName::PICK,
        object: Some("plate".to_owned()),
        tool: Some("l_gripper_tool_frame".to_owned()),
        holds: Some(Hold { object: "plate".to_owned(), tool_from_object: pose }),
        pushes: None,
        allowed_contacts: AllowedContact::fingers(
            &["r_gripper_l_finger_tip_link".to_owned()],
            "plate",
            ContactReason::Grasp,
        ),
        waypoints: vec![at.clone(), at.clone()],
    };
    let contracts = [(PrimitiveName::PICK, STANDARD[5].1)].into();
    PlanFile {
        contracts,
        format: PlanFormat::DarrtPlan,
        version: VERSION,
        problem: builtin("plate1").unwrap(),
        seed: 7,
        planner: PlannerFacts {
            sampler: SamplerName::ROBOT_OR_OBJECTS,
            distance: DistanceName::GREEDY,
            searches: vec![SearchName::Darrt, SearchName::Connect],
            improve: Some(GradeName::Steps),
            as_found: true,
            iterations: 10,
            restarts: 1,
            nodes: 5,
        },
        partial: None,
        start: at,
        steps: vec![step],
        timing: None,
    }
}

fn refused(from: &str, to: &str) -> String {
    let text = sample().to_json().unwrap();
    let edited = text.replacen(from, to, 1);
    assert_ne!(text, edited, "{from}");
    PlanFile::from_json(&edited, "plan.json").unwrap_err().to_string()
}

#[test]
fn flaws_are_told_with_place_and_key() {
    let unknown = refused("\"holds\"", "\"hold\"");
    assert!(unknown.contains("at `steps[0].hold`"), "{unknown}");
    assert!(unknown.contains("did you mean `holds`?"), "{unknown}");
    let kind = refused("\"base\": [-0.8, 0.0, 0.0]", "\"base\": [-0.8, \"0\", 0.0]");
    assert!(kind.starts_with("plan.json:") && kind.contains("at `steps[0].waypoints[0].base[1]`"), "{kind}");
    let joint = refused("\"c_joint\": 0.125", "\"c_joint\": null");
    assert!(joint.contains("at `start.joints.c_joint`"), "{joint}");
    let missing = refused("\"seed\": 7,", "");
    assert!(missing.contains("missing field `seed`"), "{missing}");
    let twice = refused("\"c_joint\"", "\"b_joint\"");
    assert!(twice.contains("duplicate key `b_joint`"), "{twice}");
    let huge = refused("0.125", "1e999");
    assert!(huge.contains("out of range"), "{huge}");
    let hand = refused("\"takes\"", "\"take\"");
    assert!(hand.contains("at `contracts.Pick.hand`") && hand.contains("did you mean `takes`?"), "{hand}");
    let cut = refused("}", "");
    assert!(cut.starts_with("plan.json:"), "{cut}");
}

#[test]
fn other_versions_and_formats_are_refused() {
    assert!(matches!(
        PlanFile::from_json(&sample().to_json().unwrap().replacen("\"version\": 2", "\"version\": 1", 1), "p"),
        Err(PlanFileError::Version { found: 1, supported: 2, .. })
    ));
    let later = PlanFile::from_json("{\"format\": \"darrt-plan\", \"version\": 9, \"other\": []}", "p").unwrap_err();
    assert_eq!(later.to_string(), "p: `version` is 9, this program reads version 2");
    assert!(refused("darrt-plan", "darrt-plot").contains("did you mean `darrt-plan`?"));
}

#[test]
fn hostile_files_are_refused_before_parsing() {
    use darrt_geom::FileError as F;
    use text_file::TextFileError as T;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("plan.json");
    let refuse = |path: &Path| PlanFile::read(path).unwrap_err();
    assert!(matches!(refuse(&path), PlanFileError::Text(T::File(F::Unreadable { .. }))));
    assert!(matches!(refuse(folder.path()), PlanFileError::Text(T::File(F::NotAFile { .. }))));
    std::fs::write(&path, [b'{', 0xff]).unwrap();
    assert!(matches!(refuse(&path), PlanFileError::Text(T::File(F::NotUtf8 { offset: 1, .. }))));
    std::fs::write(&path, "[".repeat(10_000)).unwrap();
    assert!(matches!(refuse(&path), PlanFileError::Text(T::TooDeep { line: 1, column: 65, limit: 64, .. })));
    // A sparse file: large by its metadata, nothing on the disk.
    std::fs::File::create(&path).unwrap().set_len(MAX_BYTES + 1).unwrap();
    assert!(matches!(refuse(&path), PlanFileError::Text(T::File(F::TooLarge { .. }))));
    for text in ["", "nonsense", "{}", "[]", "null", "\"\\"] {
        std::fs::write(&path, text).unwrap();
        assert!(refuse(&path).to_string().contains("plan.json:1:"), "{text}");
    }
}
