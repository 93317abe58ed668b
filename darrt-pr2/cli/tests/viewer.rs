//! The page and the other files that show a plan in 3-D.

#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use darrt_primitives::kinematics::{MeshPlaces, RobotDescription};
use darrt_task::plan_file::PlanFile;
use darrt_task::viewer::data::{JointKindData, PoseData, StepData, ViewerData};
use darrt_task::viewer::{self, RobotModel};
use nalgebra::{Isometry3, Quaternion, Translation3, Unit, UnitQuaternion, Vector3};

use crate::browser;
use crate::program::{darrt, run};

/// A folder with a plan of Plate3 and its page, made once.
fn plate3() -> &'static Path {
    static FOLDER: OnceLock<tempfile::TempDir> = OnceLock::new();
    FOLDER
        .get_or_init(|| {
            let folder = tempfile::tempdir().unwrap();
            run(folder.path(), &["plan", "plate3", "--quiet"], 0);
            folder
        })
        .path()
}

fn page() -> String {
    std::fs::read_to_string(plate3().join("plate3.html")).unwrap()
}

/// What stands in the page between the tags of its data.
fn data_in(page: &str) -> ViewerData {
    let (_, rest) = page.split_once("<script id=\"data\" type=\"application/json\">").unwrap();
    serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap()
}

fn isometry([x, y, z, i, j, k, w]: PoseData) -> Isometry3<f64> {
    let rotation = UnitQuaternion::from_quaternion(Quaternion::new(w, i, j, k));
    Isometry3::from_parts(Translation3::new(x, y, z), rotation)
}

/// Where the tool is, by the documented format alone.
fn world_from_tool(data: &ViewerData, base: [f64; 3], joints: &[f64]) -> Isometry3<f64> {
    let mut poses: Vec<Isometry3<f64>> = Vec::new();
    for link in &data.robot.links {
        let Some(parent) = link.parent else {
            let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), base[2]);
            poses.push(Isometry3::from_parts(Translation3::new(base[0], base[1], 0.0), turn));
            continue;
        };
        let mut pose = poses[parent] * isometry(link.pose);
        if let Some(joint) = &link.joint {
            let value = joint.multiplier * joints[joint.variable] + joint.offset;
            let axis = Vector3::from(joint.axis);
            pose *= match joint.kind {
                JointKindData::Turning => Isometry3::from_parts(
                    Translation3::identity(),
                    UnitQuaternion::from_axis_angle(&Unit::new_normalize(axis), value),
                ),
                JointKindData::Sliding => Isometry3::from_parts((axis * value).into(), UnitQuaternion::identity()),
            };
        }
        poses.push(pose);
    }
    poses[data.robot.tool]
}

#[test]
fn the_page_stands_alone_and_is_small() {
    let page = page();
    assert!(page.starts_with("<!DOCTYPE html>") && page.len() <= 1_500_000, "{} bytes", page.len());
    for foreign in ["http:", "https:", "src=", "href=", "@import", "url("] {
        assert!(!page.contains(foreign), "{foreign}");
    }
    assert!(page.contains("<svg ") && !page.contains("<!--data-->") && !page.contains("<!--figure-->"));
    let parts = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../darrt-primitives/task/src/viewer/page");
    for part in std::fs::read_dir(parts).unwrap().map(|part| part.unwrap().path()) {
        let text = std::fs::read_to_string(&part).unwrap();
        let lines = text.lines().count();
        assert!(lines <= 300, "{}: {lines} lines: a person must be able to read the viewer", part.display());
        let line = text.lines().max_by_key(|line| line.len()).unwrap_or_default();
        assert!(page.contains(line), "{} is not in the page", part.display());
    }
}

#[test]
fn the_data_are_those_of_the_plan_and_survive_writing_and_reading() {
    let data = data_in(&page());
    let plan = PlanFile::read(plate3().join("plate3.plan.json")).unwrap();
    let robot = RobotModel::of(&darrt_pr2::facts(&plan.problem).unwrap()).unwrap();
    assert_eq!(data, viewer::of_plan(&plan, &data.note, &robot).unwrap());
    assert_eq!(data, serde_json::from_str(&serde_json::to_string(&data).unwrap()).unwrap());

    let description = RobotDescription::from_text(darrt_pr2::model::URDF).unwrap();
    for link in &description.links {
        let drawn = data.robot.links.iter().find(|drawn| *drawn.name == *link.name).unwrap();
        assert_eq!(drawn.parts.len(), link.collision.len(), "{}", link.name);
    }
    let names = |names: Vec<&String>| names.into_iter().cloned().collect::<Vec<String>>();
    assert_eq!(
        names(data.objects.iter().map(|o| &o.name).collect()),
        names(plan.problem.objects.iter().map(|o| &o.name).collect())
    );
    assert_eq!(
        names(data.bodies.iter().map(|b| &b.name).collect()),
        names(plan.problem.obstacles.iter().map(|o| &o.name).collect())
    );
    assert_eq!(data.steps.len(), plan.steps.len());
    for (drawn, step) in data.steps.iter().zip(&plan.steps) {
        assert_eq!((drawn.name.as_str(), drawn.times.len()), (step.primitive.as_str(), step.waypoints.len()));
        assert_eq!(drawn.contacts.len(), step.allowed_contacts.len());
        assert!(drawn.times[0] == 0.0 && drawn.times.windows(2).all(|pair| pair[0] < pair[1]));
    }
}

#[test]
fn whoever_replays_the_data_sees_what_the_plan_says() {
    let data = data_in(&page());
    let plan = PlanFile::read(plate3().join("plate3.plan.json")).unwrap();
    let (mut base, mut joints, mut objects) = (data.start.base, data.start.joints.clone(), data.start.objects.clone());
    for (drawn, step) in data.steps.iter().zip(&plan.steps) {
        let StepData { holds, .. } = drawn;
        for (index, waypoint) in step.waypoints.iter().enumerate() {
            base = drawn.base.get(index).copied().unwrap_or(base);
            for track in &drawn.joints {
                joints[track.variable] = track.values[index];
            }
            for track in &drawn.objects {
                objects[track.object] = track.poses[index];
            }
            let tool = world_from_tool(&data, base, &joints);
            for (object, name) in data.objects.iter().enumerate().map(|(index, object)| (index, &object.name)) {
                let held = holds.as_ref().filter(|hold| hold.object == object);
                let shown = held.map_or(isometry(objects[object]), |hold| tool * isometry(hold.tool_from_object));
                let told = Isometry3::from(waypoint.objects[name.as_str()]);
                let off = (shown.translation.vector - told.translation.vector).norm();
                assert!(off < 2e-4 && shown.rotation.angle_to(&told.rotation) < 2e-4, "{name}: {off} m off");
                if held.is_some() {
                    objects[object] = (*waypoint.objects[name.as_str()].position.first_chunk::<3>().unwrap())
                        .into_iter()
                        .chain(waypoint.objects[name.as_str()].quaternion)
                        .collect::<Vec<_>>()
                        .try_into()
                        .unwrap();
                }
            }
        }
    }
}

#[test]
fn clearances_are_between_the_points_shown_and_no_smaller_than_the_verifiers() {
    let data = data_in(&page());
    let plan = PlanFile::read(plate3().join("plate3.plan.json")).unwrap();
    let proof = darrt_pr2::verify(&plan).unwrap();
    let least = [proof.smallest_clearance, proof.smallest_intended];
    let least = least.into_iter().flatten().map(|smallest| smallest.distance_m).fold(f64::INFINITY, f64::min);
    let mut count = 0;
    for step in &data.steps {
        assert!(step.clearance.len() >= 2, "{}", step.name);
        for nearest in &step.clearance {
            let [p, q] = nearest.points.map(Vector3::from);
            assert!(((p - q).norm() - nearest.distance).abs() < 1e-4, "{nearest:?}");
            assert!(nearest.distance > 0.5 * least, "{nearest:?}, the verifier's least is {least}");
            count += 1;
        }
    }
    assert!((200..1000).contains(&count), "{count}");
}

#[test]
fn any_robot_can_be_shown() {
    let urdf = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../darrt-primitives/tests/data/generic_arm.urdf");
    let description = RobotDescription::from_file(&urdf).unwrap();
    let last = description.links.last().unwrap().name.clone();
    let robot = RobotModel::new(&description, &MeshPlaces::default(), &last).unwrap();
    let problem = darrt_pr2::problems::builtin("bowl").unwrap();
    let geometry = problem.geometry().unwrap();
    let objects = problem.objects.iter().zip(&geometry.objects);
    let start = darrt_task::plan_file::Waypoint {
        base: [0.1, 0.2, 0.3],
        joints: robot.table().complete(&[]),
        objects: objects.map(|(o, solid)| (o.name.as_str().into(), solid.world_from_object.into())).collect(),
    };
    let data = viewer::of_problem(&problem, &start, &robot).unwrap();
    assert_eq!(data.robot.links.len(), description.links.len());
    assert!(data.steps.is_empty() && !data.objects[0].goals.is_empty());
    assert!(
        RobotModel::new(&description, &MeshPlaces::default(), "no such link")
            .unwrap_err()
            .to_string()
            .contains("no such link")
    );
}

#[test]
fn hostile_texts_stay_texts() {
    let mut data = data_in(&page());
    data.title = "</title></script><script>alert(1)</script>".to_owned();
    data.objects[0].name = "</script><!--".to_owned();
    let page = viewer::page(&data, "").unwrap();
    assert!(!page.contains("alert(1)</script>") && !page.contains("</script><!--"));
    assert_eq!(data_in(&page), data);
}

/// The JSON and the binary part of a glTF file.
fn parts_of_glb(bytes: &[u8]) -> (serde_json::Value, &[u8]) {
    let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
    assert_eq!((&bytes[..4], word(4), word(8)), (&b"glTF"[..], 2, bytes.len()));
    let json = word(12);
    let binary = 20 + json;
    assert_eq!((&bytes[16..20], &bytes[binary + 4..binary + 8]), (&b"JSON"[..], &b"BIN\0"[..]));
    assert_eq!(word(binary), bytes.len() - binary - 8);
    (serde_json::from_slice(&bytes[20..binary]).unwrap(), &bytes[binary + 8..])
}

#[test]
fn a_gltf_file_has_a_node_for_everything_and_an_animation() {
    run(plate3(), &["show", "plate3.plan.json", "-o", "plate3.glb"], 0);
    let bytes = std::fs::read(plate3().join("plate3.glb")).unwrap();
    let (json, binary) = parts_of_glb(&bytes);
    let nodes = json["nodes"].as_array().unwrap();
    let data = data_in(&page());
    let links = data.robot.links.iter().map(|link| &link.name);
    for name in links.chain(data.bodies.iter().map(|b| &b.name)).chain(data.objects.iter().map(|o| &o.name)) {
        assert_eq!(nodes.iter().filter(|node| node["name"] == **name).count(), 1, "{name}");
    }
    let singles = |accessor: &serde_json::Value| -> Vec<f32> {
        let accessor = &json["accessors"][usize::try_from(accessor.as_u64().unwrap()).unwrap()];
        let view = &json["bufferViews"][usize::try_from(accessor["bufferView"].as_u64().unwrap()).unwrap()];
        let [from, length] =
            ["byteOffset", "byteLength"].map(|key| usize::try_from(view[key].as_u64().unwrap()).unwrap());
        let part = &binary[from..from + length];
        part.chunks_exact(4).map(|four| f32::from_le_bytes(four.try_into().unwrap())).collect()
    };
    let animation = &json["animations"][0];
    let duration: f64 = data.steps.iter().map(|step| step.times.last().unwrap()).sum();
    for sampler in animation["samplers"].as_array().unwrap() {
        let times = singles(&sampler["input"]);
        assert!(times.windows(2).all(|pair| pair[0] < pair[1]) && f64::from(*times.last().unwrap()) < duration + 1e-2);
        assert!(singles(&sampler["output"]).iter().all(|number| number.is_finite()));
    }
    // The plate ends where the plan says, seen in the frame of the world's node.
    let plate = nodes.iter().position(|node| node["name"] == "plate").unwrap();
    let channels = animation["channels"].as_array().unwrap();
    let way = channels.iter().find(|c| c["target"]["node"] == plate && c["target"]["path"] == "translation").unwrap();
    let sampler = &animation["samplers"][usize::try_from(way["sampler"].as_u64().unwrap()).unwrap()];
    let places = singles(&sampler["output"]);
    let plan = PlanFile::read(plate3().join("plate3.plan.json")).unwrap();
    let end = plan.steps.last().unwrap().waypoints.last().unwrap().objects["plate"].position;
    for (shown, told) in places[places.len() - 3..].iter().zip(end) {
        assert!((f64::from(*shown) - told).abs() < 1e-3, "{shown} {told}");
    }
}

#[test]
fn a_picture_becomes_dots_or_says_why_not() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["show", "bowl", "-o", "bowl.png"];
    let output = darrt(folder.path(), &arguments);
    if output.status.success() {
        let bytes = std::fs::read(folder.path().join("bowl.png")).unwrap();
        assert!(bytes.starts_with(b"\x89PNG\r\n\x1a\n"));
    } else {
        let complaint = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(complaint.contains("no fonts"), "{complaint}");
    }
}

#[test]
fn a_browser_draws_the_page_without_a_complaint() {
    let folder = tempfile::tempdir().unwrap();
    let show = |second: &str, time_ms: u32| {
        let picture = folder.path().join(format!("{second}.png"));
        let page = format!("file://{}#{second}", plate3().join("plate3.html").display());
        let [screenshot, budget] =
            [format!("--screenshot={}", picture.display()), format!("--virtual-time-budget={time_ms}")];
        browser::open(&page, &["--window-size=1000,700", &screenshot, &budget])?;
        Some(resvg::tiny_skia::Pixmap::load_png(picture).unwrap())
    };
    if show("0", 1).is_none() {
        return;
    }
    // Dots of the scene, without what stands beside and below it.
    let dots = || (60..480).flat_map(|y| (0..650).map(move |x| (x, y)));
    // A machine with much else to do may take the picture before anything is drawn.
    let drawn = |second: &str| {
        let mut pictures = (0..6).filter_map(|doublings| show(second, 2_000 << doublings));
        let is_drawn = |picture: &resvg::tiny_skia::Pixmap| {
            let colours: HashSet<_> =
                dots().filter_map(|(x, y)| picture.pixel(x, y)).map(|c| [c.red(), c.green(), c.blue()]).collect();
            colours.len() > 100
        };
        pictures.any(|picture| is_drawn(&picture))
    };
    // Dots of two pictures are not compared: a slow machine draws coarsely what a fast one draws finely.
    for second in ["0", "20"] {
        assert!(drawn(second), "at second {second} nothing is drawn");
    }
}
