//! A robot file that is begun from a description: two arms on a lift on two wheels, no hand, a mesh in a package, an SRDF.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "a test says what is wrong by panicking"
)]

use std::path::Path;

use crate::program::{darrt, run};

fn done(folder: &Path, arguments: &[&str]) -> String {
    run(folder, arguments, 0).0
}

/// A box as an OBJ.
fn mesh([x, y, z]: [f64; 3]) -> String {
    let corners = (0..8).map(|i| {
        let side = |bit: u32, half: f64| if i >> bit & 1 == 0 { -half } else { half };
        format!("v {} {} {}\n", side(0, x), side(1, y), side(2, z))
    });
    let faces = ["1 3 4 2", "5 6 8 7", "1 2 6 5", "3 7 8 4", "1 5 7 3", "2 4 8 6"].map(|face| format!("f {face}\n"));
    corners.chain(faces).collect()
}

/// The links and joints of an arm of seven joints, mounted on `column` so far to the left; all names begin with `side`.
fn arm(urdf: &str, side: &str, left_m: f64) -> String {
    let links =
        urdf.split("<link name=\"shoulder\">").nth(1).unwrap().split("<link name=\"left_finger\">").next().unwrap();
    let joints = urdf.split("<joint name=\"shoulder_turn\"").nth(1).unwrap();
    let joints = joints.split("<joint name=\"left_jaw\"").next().unwrap();
    let text = format!("<link name=\"shoulder\">{links}<joint name=\"shoulder_turn\"{joints}");
    let text = text.replace("xyz=\"0 0 0.92\"", &format!("xyz=\"0 {left_m} 0.5\""));
    let text = text.replace("name=\"", &format!("name=\"{side}")).replace("link=\"", &format!("link=\"{side}"));
    text.replace(&format!("link=\"{side}wagon\""), "link=\"column\"")
}

fn robot(folder: &Path) -> String {
    let urdf = done(folder, &["robot", "list", "--print-urdf", "mobile-arm"]);
    let wheel = |name: &str, y: f64| {
        format!(
            "<link name='{name}'><collision><origin rpy='1.5707963 0 0'/><geometry><cylinder radius='0.1' length='0.04'/></geometry>\
             </collision></link><joint name='{name}_turn' type='continuous'><parent link='wagon'/><child link='{name}'/>\
             <origin xyz='0 {y} 0.1'/><axis xyz='0 1 0'/></joint>"
        )
    };
    format!(
        "<robot name='two-arms'><link name='wagon'><collision><origin xyz='0 0 0.2'/><geometry>\
         <mesh filename='package://wagon/meshes/wagon.obj'/></geometry></collision></link>{}{}\
         <link name='column'><collision><origin xyz='0 0 0.25'/><geometry><box size='0.16 0.16 0.5'/></geometry></collision></link>\
         <joint name='lift' type='prismatic'><parent link='wagon'/><child link='column'/><origin xyz='0 0 0.36'/><axis xyz='0 0 1'/>\
         <limit lower='0' upper='0.2' effort='100' velocity='0.1'/></joint>{}{}</robot>",
        wheel("left_wheel", 0.23),
        wheel("right_wheel", -0.23),
        arm(&urdf, "right_", -0.2),
        arm(&urdf, "left_", 0.2)
    )
}

#[test]
fn a_first_robot_file_says_what_it_was_guessed_from_and_plans() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    std::fs::create_dir_all(folder.join("shapes/meshes")).unwrap();
    std::fs::write(folder.join("shapes/meshes/wagon.obj"), mesh([0.25, 0.2, 0.15])).unwrap();
    std::fs::write(folder.join("my.urdf"), robot(folder)).unwrap();
    let srdf = "<robot name='two-arms'><group name='arm'><chain base_link='column' tip_link='right_hand'/></group>\
                <group_state name='up' group='arm'><joint name='right_shoulder_lift' value='0.1'/></group_state>\
                <disable_collisions link1='column' link2='right_upper_arm' reason='Never'/></robot>";
    std::fs::write(folder.join("my.srdf"), srdf).unwrap();
    // Without the package the mesh is missed by name.
    let output = darrt(folder, &["robot", "new", "my.urdf"]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("package://wagon/meshes/wagon.obj") && said.contains("`packages`"), "{said}");

    done(folder, &["robot", "new", "my.urdf", "--package", "wagon=shapes"]);
    let file = std::fs::read_to_string(folder.join("my.toml")).unwrap();
    let table: toml::Table = file.parse().unwrap();
    assert_eq!(table["base"]["kind"].as_str(), Some("differential"), "{file}");
    assert_eq!(table["packages"]["wagon"].as_str(), Some("shapes"), "{file}");
    assert_eq!(table["srdf"].as_str(), Some("my.srdf"), "{file}");
    assert_eq!(table["hand"]["on"].as_str(), Some("right_hand"), "{file}");
    assert!(
        (table["hand"]["xyz"][2].as_float().unwrap() - 0.1).abs() < 1e-6,
        "the hand is at the end of its link: {file}"
    );
    assert_eq!(table["rest"]["lift"].as_float(), Some(0.1), "{file}");
    let left = table["rest"].as_table().unwrap().keys().filter(|name| name.starts_with("left_"));
    assert_eq!(left.count(), 7, "{file}");
    assert!(table["postures"].get("home").is_some() && table["postures"].get("hand-down").is_some(), "{file}");

    let said = done(folder, &["robot", "check", "my.toml", "--no-picture", "--pairs", "--problem", "first.toml"]);
    let disabled = said.lines().find(|line| line.contains("column with right_upper_arm")).unwrap_or_default();
    assert!(disabled.contains("not checked: disabled by the SRDF (Never)"), "{said}");
    done(folder, &["plan", "first.toml", "--no-picture", "--time-limit", "60"]);
    let plan = std::fs::read_to_string(folder.join("first.plan.json")).unwrap();
    let plan: serde_json::Value = serde_json::from_str(&plan).unwrap();
    let rest = table["rest"]["left_shoulder_lift"].as_float().unwrap();
    assert!(
        (plan["start"]["joints"]["left_shoulder_lift"].as_f64().unwrap() - rest).abs() < 1e-6,
        "the other arm rests"
    );
}

#[test]
fn problems_are_made_for_another_robot() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    done(folder, &["generate", "bowl", "--robot", "panda-arm", "--seeds", "1", "--into", "many"]);
    let files: Vec<_> = std::fs::read_dir(folder.join("many")).unwrap().map(|entry| entry.unwrap().path()).collect();
    assert_eq!(files.len(), 1);
    let problem: toml::Table = std::fs::read_to_string(&files[0]).unwrap().parse().unwrap();
    assert_eq!(problem["robot"]["model"].as_str(), Some("panda-arm"));
    done(folder, &["plan", files[0].to_str().unwrap(), "--no-picture", "--time-limit", "60"]);
}
