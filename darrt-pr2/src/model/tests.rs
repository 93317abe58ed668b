use super::*;
use crate::arm::stock_limits;
use darrt_primitives::kinematics::lanes::{LANES, Row};
use darrt_primitives::kinematics::{BatchForward, PoseLanes, UrdfError};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use rand::{RngExt, SeedableRng};

fn model() -> Pr2Model {
    Pr2Model::embedded().unwrap()
}

#[test]
fn limits_of_the_description_are_the_stock_ones() {
    let model = model();
    for side in Side::BOTH {
        for kind in [LimitKind::Soft, LimitKind::Hard] {
            assert_eq!(model.limits(side, kind), stock_limits(side, kind), "{side:?} {kind:?}");
        }
    }
}

#[test]
fn every_part_of_the_robot_is_there() {
    let model = model();
    let parts: usize = model.bodies().iter().flatten().map(|b| b.parts.len()).sum();
    // Trunk: 4 base, 4 casters, 1 bellow, 5 torso, 2 head, 1 sensor block, 1 scanner.
    // Arm: 3 shoulder, 1 collar, 3 upper arm, 1 elbow, 2 forearm, 1 wrist, 1 palm, 4 fingers.
    assert_eq!(parts, 18 + 2 * 16);
    assert_eq!(model.arm_bodies(Side::Right).len(), 11);
    assert_eq!(model.trunk_links().count(), 7);
}

/// Golden poses, computed with another library: see the note in the file.
#[test]
fn tree_and_chain_reach_the_reference_poses() {
    let file: serde_json::Value =
        serde_json::from_str(include_str!("../../tests/data/forward_reference.json")).unwrap();
    let numbers =
        |v: &serde_json::Value| -> Vec<f64> { v.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect() };
    let model = model();
    let cases = file["cases"].as_array().unwrap();
    assert_eq!(cases.len(), 16);
    for case in cases {
        let side = if case["side"] == "r" { Side::Right } else { Side::Left };
        let q: ArmConfiguration = numbers(&case["q"]).try_into().unwrap();
        let torso = case["torso"].as_f64().unwrap();
        let xyz = Vector3::from_vec(numbers(&case["tool_xyz"]));
        let xyzw = numbers(&case["tool_xyzw"]);
        let rotation = UnitQuaternion::from_quaternion(Quaternion::new(xyzw[3], xyzw[0], xyzw[1], xyzw[2]));
        let wrist = Vector3::from_vec(numbers(&case["wrist_xyz"]));

        let mut state = WholeBody::at_rest();
        state.torso_m = torso;
        state.arms[side.index()] = q;
        let poses = model.link_poses(&state);
        let tool = model.tree().link_index(&format!("{}_gripper_tool_frame", side.prefix())).unwrap();
        let mut chain = ArmPoses::default();
        ArmChain::new(side, torso).world_from_links(&[0.0; 3], &q, 0.1, &mut chain);
        let in_batch = batch_pose(&model, &state, tool);
        for pose in [&poses[tool], chain.pose(Frame::Tool), &in_batch] {
            assert!((pose.translation.vector - xyz).norm() < 1e-9, "{}", case["id"]);
            assert!(pose.rotation.angle_to(&rotation) < 1e-9, "{}", case["id"]);
        }
        assert!((chain.pose(Frame::WristRoll).translation.vector - wrist).norm() < 1e-9);
    }
}

/// Pose of one link from a batch whose lanes all have this state.
fn batch_pose(model: &Pr2Model, state: &WholeBody, link: usize) -> Isometry3<f64> {
    let batch = BatchForward::for_links(model.tree(), &[link]).unwrap();
    let rows: Vec<Row> = model.joint_values(state).into_iter().map(Row::splat).collect();
    let mut out = batch.poses();
    batch.forward(&rows, &PoseLanes::splat(&world_from_base(&state.base)), &mut out).unwrap();
    out.link(link).unwrap().pose(LANES - 1).unwrap()
}

/// Every link of the right arm, eight configurations at once.
#[test]
fn batch_equals_chain() {
    let model = model();
    let links: Vec<usize> = Frame::ALL
        .iter()
        .flat_map(|frame| frame.links())
        .map(|name| model.tree().link_index(&format!("r_{name}")).unwrap())
        .collect();
    let batch = BatchForward::for_links(model.tree(), &links).unwrap();
    let mut out = batch.poses();
    let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(8);
    for _ in 0..200 {
        let states: [WholeBody; LANES] = std::array::from_fn(|_| {
            let mut state = WholeBody::at_rest();
            state.arms[0] = std::array::from_fn(|_| rng.random_range(-4.0..4.0));
            state.finger_angles[0] = rng.random_range(0.0..0.548);
            state
        });
        let values = states.each_ref().map(|state| model.joint_values(state));
        let rows: Vec<Row> = (0..values[0].len()).map(|v| Row(std::array::from_fn(|lane| values[lane][v]))).collect();
        let base = [rng.random_range(-3.0..3.0), rng.random_range(-3.0..3.0), rng.random_range(-3.0..3.0)];
        batch.forward(&rows, &PoseLanes::splat(&world_from_base(&base)), &mut out).unwrap();
        for (lane, state) in states.iter().enumerate() {
            let mut chain = ArmPoses::default();
            let angle = state.finger_angles[0];
            ArmChain::new(Side::Right, state.torso_m).world_from_links(&base, &state.arms[0], angle, &mut chain);
            for frame in Frame::ALL {
                for name in frame.links() {
                    let link = model.tree().link_index(&format!("r_{name}")).unwrap();
                    let pose = out.link(link).unwrap().pose(lane).unwrap();
                    let difference = pose.to_homogeneous() - chain.pose(frame).to_homogeneous();
                    assert!(difference.abs().max() < 1e-13, "{name}: {difference}");
                }
            }
        }
    }
}

#[test]
fn chain_equals_tree() {
    let model = model();
    let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(7);
    for _ in 0..200 {
        let mut state = WholeBody::at_rest();
        state.base = std::array::from_fn(|_| rng.random_range(-3.0..3.0));
        state.torso_m = rng.random_range(0.0..0.33);
        state.arms = std::array::from_fn(|_| std::array::from_fn(|_| rng.random_range(-3.0..3.0)));
        state.finger_angles = std::array::from_fn(|_| rng.random_range(0.0..0.548));
        let poses = model.link_poses(&state);
        for side in Side::BOTH {
            let i = side.index();
            let mut chain = ArmPoses::default();
            ArmChain::new(side, state.torso_m).world_from_links(
                &state.base,
                &state.arms[i],
                state.finger_angles[i],
                &mut chain,
            );
            for frame in Frame::ALL {
                for name in frame.links() {
                    let link = model.tree().link_index(&format!("{}_{name}", side.prefix())).unwrap();
                    let (a, b) = (poses[link].to_homogeneous(), chain.pose(frame).to_homogeneous());
                    assert!((a - b).abs().max() < 1e-12, "{side:?} {name}");
                }
            }
        }
    }
}

#[test]
fn other_robots_are_refused_by_name() {
    let read = |from: &str, to: &str| {
        let text = URDF.replace(from, to);
        assert_ne!(text, URDF, "{from}");
        RobotDescription::from_text(&text)
            .map_err(ModelError::from)
            .and_then(|r| Pr2Model::from_urdf(&r, &no_meshes))
            .expect_err(from)
    };
    let longer = read("xyz=\"0.321 0 0\"", "xyz=\"0.322 0 0\"");
    assert!(matches!(&longer, ModelError::OtherKinematics { link, .. } if link == "r_wrist_flex_link"), "{longer}");
    let renamed = read("torso_lift_joint", "torso_joint");
    assert!(matches!(&renamed, ModelError::MissingJoint { name } if name == "torso_lift_joint"), "{renamed}");
    let renamed = read("l_gripper_tool_frame", "l_tool");
    assert!(matches!(&renamed, ModelError::MissingLink { name } if name == "l_gripper_tool_frame"), "{renamed}");
    let broken = read("0 0 0.051", "0 0 NaN");
    assert!(matches!(broken, ModelError::Urdf(UrdfError::NotFinite { .. })));
}

#[test]
fn a_torso_out_of_range_is_refused() {
    for torso in [-0.01, 0.34, f64::NAN] {
        assert!(matches!(model().arm(Side::Left, torso, LimitKind::Soft), Err(ModelError::Torso { .. })));
    }
}
