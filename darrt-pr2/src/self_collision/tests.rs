use super::*;
use crate::arm::{ArmConfiguration, LimitKind};
use crate::model::WholeBody;
use crate::postures::ArmPosture;
use darrt_geom::oracle::{PosedBody, nearest};
use rand::{RngExt, SeedableRng};
use std::f64::consts::PI;

/// Names of the pairs that touch, by the exact oracle.
fn touching(model: &Pr2Model, state: &WholeBody, active: Side) -> Vec<String> {
    touching_of(model, state, &link_pairs(model, active))
}

/// Those of the given pairs that touch.
fn touching_of(model: &Pr2Model, state: &WholeBody, pairs: &[[usize; 2]]) -> Vec<String> {
    let poses = model.link_poses(state);
    let name = |link: usize| model.tree().link_names()[link].to_string();
    let posed = |link: usize| PosedBody { body: model.body(link).unwrap(), world_from_body: poses[link] };
    let meets = |[a, b]: &[usize; 2]| {
        nearest(&[posed(*a), posed(*b)], &|_, _| false).unwrap().is_some_and(|found| found.intersects)
    };
    pairs.iter().filter(|pair| meets(pair)).map(|[a, b]| format!("{} - {}", name(*a), name(*b))).collect()
}

fn state(active: Side, q: ArmConfiguration) -> WholeBody {
    let mut state = WholeBody::at_rest();
    state.arms[active.index()] = q;
    state
}

#[test]
fn worked_examples_are_clear() {
    let model = Pr2Model::embedded().unwrap();
    let file: serde_json::Value =
        serde_json::from_str(include_str!("../../tests/data/witness_configurations.json")).unwrap();
    let witnesses = file["witnesses"].as_array().unwrap();
    assert_eq!(witnesses.len(), 19);
    let mut checked = 0;
    for witness in witnesses {
        for q in witness["configurations"].as_array().unwrap() {
            let q: Vec<f64> = q.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect();
            let found = touching(&model, &state(Side::Right, q.try_into().unwrap()), Side::Right);
            assert!(found.is_empty(), "{} {}: {found:?}", witness["domain"], witness["action"]);
            checked += 1;
        }
    }
    assert_eq!(checked, 50);
}

#[test]
fn postures_are_clear_on_both_sides() {
    let model = Pr2Model::embedded().unwrap();
    for side in Side::BOTH {
        for posture in ArmPosture::ALL {
            let found = touching(&model, &state(side, posture.values(side)), side);
            // The left tucked arm lies across the body: its boxes reach into those of the right shoulder.
            let across = (side, posture) == (Side::Left, ArmPosture::Tucked);
            assert!(found.iter().all(|p| across && p.ends_with(" - r_shoulder_pan_link")), "{posture:?}: {found:?}");
            assert_eq!(found.is_empty(), !across, "{side:?} {posture:?}");
        }
    }
}

#[test]
fn folded_arms_are_reported() {
    let model = Pr2Model::embedded().unwrap();
    let folded = [0.5, 0.6, -1.57, -2.12, 0.0, -2.0, 0.0];
    let found = touching(&model, &state(Side::Right, folded), Side::Right);
    for pair in ["r_forearm_link - l_shoulder_pan_link", "r_gripper_l_finger_tip_link - r_shoulder_pan_link"] {
        assert!(found.iter().any(|p| p == pair), "{found:?}");
    }
    let mirror = touching(&model, &state(Side::Left, crate::postures::mirrored(&folded)), Side::Left);
    assert!(mirror.iter().any(|p| p == "l_forearm_link - r_shoulder_pan_link"), "{mirror:?}");
}

/// Boxes around the same parts met in 2 to 4 % of configurations, measured on another implementation; the shoulder's round
/// part leaves a little more room.
#[test]
fn the_forearm_meets_its_shoulder_about_as_often_as_measured() {
    let model = Pr2Model::embedded().unwrap();
    let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(1);
    let limits = model.limits(Side::Right, LimitKind::Soft);
    let link = |name| model.tree().link_index(name).unwrap();
    let pair = [[link("r_forearm_link"), link("r_shoulder_pan_link")]];
    assert!(link_pairs(&model, Side::Right).contains(&pair[0]));
    let meets = |_: &u32| {
        let q = limits.map(|l| rng.random_range(l.lower.max(-PI)..l.upper.min(PI)));
        !touching_of(&model, &state(Side::Right, q), &pair).is_empty()
    };
    let count = (0..1000).filter(meets).count();
    assert!((10..=45).contains(&count), "{count} of 1000");
}

#[test]
fn rules_are_mirror_images() {
    let swap = |name: &str| match name.split_at(2) {
        ("r_", rest) => format!("l_{rest}"),
        ("l_", rest) => format!("r_{rest}"),
        _ => name.to_owned(),
    };
    let mirrored: Vec<LinkPair> =
        pairs(Side::Right).iter().map(|p| LinkPair { moving: swap(&p.moving), other: swap(&p.other) }).collect();
    assert_eq!(mirrored, pairs(Side::Left));
    let has = |moving: &str, other: &str| {
        pairs(Side::Right).contains(&LinkPair { moving: moving.to_owned(), other: other.to_owned() })
    };
    assert!(has("r_elbow_flex_link", "base_link") && !has("r_elbow_flex_link", "torso_lift_link"));
    assert!(has("r_gripper_palm_link", "head_tilt_link") && !has("r_forearm_link", "head_tilt_link"));
    assert!(has("r_forearm_link", "laser_tilt_mount_link") && !has("r_wrist_roll_link", "laser_tilt_mount_link"));
    assert!(has("r_forearm_link", "r_shoulder_pan_link") && has("r_elbow_flex_link", "r_shoulder_pan_link"));
    assert!(has("r_gripper_palm_link", "r_upper_arm_link") && !has("r_wrist_flex_link", "r_upper_arm_link"));
    assert!(has("r_upper_arm_link", "l_upper_arm_link") && !has("r_elbow_flex_link", "l_shoulder_pan_link"));
    assert!(!has("r_upper_arm_link", "torso_lift_link"));
}

/// What the rules leave out of one arm is kept apart by its joints: nothing with three joints or more between it meets.
#[test]
fn an_arm_meets_itself_only_in_pairs_that_are_checked() {
    let model = Pr2Model::embedded().unwrap();
    let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(2);
    let checked = link_pairs(&model, Side::Right);
    let link = |name: &str| model.tree().link_index(&format!("r_{name}")).filter(|link| model.body(*link).is_some());
    // How many joints move each link of an arm.
    let joints = [1, 2, 3, 3, 4, 5, 5, 6, 7, 7, 7, 7, 7, 7];
    let shaped: Vec<(i32, usize)> = ARM.iter().zip(joints).filter_map(|(name, n)| Some((n, link(name)?))).collect();
    let mut rest = Vec::new();
    for &(moved_by, outer) in &shaped {
        let inner = shaped.iter().filter(|(inner_by, _)| moved_by >= inner_by + 3).map(|(_, inner)| [outer, *inner]);
        rest.extend(inner.filter(|pair| !checked.contains(pair)));
    }
    assert!(!rest.is_empty());
    let limits = model.limits(Side::Right, LimitKind::Hard);
    for _ in 0..4000 {
        let q = limits.map(|l| rng.random_range(l.lower.max(-PI)..l.upper.min(PI)));
        let found = touching_of(&model, &state(Side::Right, q), &rest);
        assert!(found.is_empty(), "{q:?}: {found:?}");
    }
}
