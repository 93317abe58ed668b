use super::*;
use crate::model::{Pr2Model, WholeBody};
use darrt_primitives::kinematics::{ChainInverse, InverseOptions};
use nalgebra::{Translation3, Vector3};
use rand::{Rng, RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

/// Largest entry of the difference of two poses.
pub(super) fn pose_error(a: &Isometry3<f64>, b: &Isometry3<f64>) -> f64 {
    (a.to_homogeneous() - b.to_homogeneous()).abs().max()
}

pub(super) fn random_arm(rng: &mut dyn Rng, kind: LimitKind) -> Arm {
    let side = Side::BOTH[rng.random_range(0..2)];
    Arm::new(side, rng.random_range(0.0..0.33), kind).unwrap()
}

pub(super) fn random_configuration(arm: &Arm, rng: &mut dyn Rng) -> ArmConfiguration {
    arm.limits.map(|l| rng.random_range(l.lower.max(-3.9)..=l.upper.min(3.9)))
}

/// Solutions reproduce the pose to 1e-12 and keep the limits.
fn check(arm: &Arm, pose: &Isometry3<f64>, solutions: &Solutions) {
    for q in solutions {
        assert!(arm.within_limits(q), "{q:?}");
        let error = pose_error(&arm.base_from_tool(q), pose);
        assert!(error < 1e-12, "{error} at {q:?}");
    }
}

pub(super) fn contains(arm: &Arm, solutions: &Solutions, q: &ArmConfiguration, tolerance: f64) -> bool {
    solutions.iter().any(|s| joint_distance(&arm.limits, s, q) < tolerance)
}

#[test]
fn random_configurations_are_found_again() {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(1);
    let mut out = Solutions::new();
    for _ in 0..2000 {
        let arm = random_arm(&mut rng, LimitKind::Soft);
        let q = random_configuration(&arm, &mut rng);
        let pose = arm.base_from_tool(&q);
        arm.inverse(&pose, q[2], &mut out);
        check(&arm, &pose, &out);
        assert!(contains(&arm, &out, &q, 1e-7), "{q:?}: {out:?}");
        arm.inverse_with_pan(&pose, q[0], &mut out);
        check(&arm, &pose, &out);
        assert!(contains(&arm, &out, &q, 1e-6), "{q:?}: {out:?}");
    }
}

#[test]
fn near_singular_poses_lose_no_accuracy() {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(2);
    let mut out = Solutions::new();
    for round in 0..2000 {
        let arm = random_arm(&mut rng, LimitKind::Hard);
        let mut q = random_configuration(&arm, &mut rng);
        let tiny = -(10.0_f64).powf(rng.random_range(-12.0..-3.0));
        match round % 4 {
            0 => q[3] = tiny,
            1 => q[5] = tiny,
            2 => (q[3], q[5]) = (tiny, tiny),
            _ => (q[3], q[5]) = (arm.limits[3].lower, 0.0),
        }
        let pose = arm.base_from_tool(&q);
        arm.inverse(&pose, q[2], &mut out);
        assert!(!out.is_empty(), "{q:?}");
        check(&arm, &pose, &out);
        arm.inverse_with_pan(&pose, q[0], &mut out);
        check(&arm, &pose, &out);
    }
}

/// With limits wide enough for both bends of elbow and wrist, all eight branches can appear; each must be right.
#[test]
fn every_branch_is_a_solution() {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(3);
    let mut out = Solutions::new();
    let mut most = 0;
    for _ in 0..300 {
        let arm = Arm::with_limits(Side::Left, 0.1, [JointLimit::UNLIMITED; 7]).unwrap();
        let q: ArmConfiguration = std::array::from_fn(|_| rng.random_range(-3.0..3.0));
        let pose = arm.base_from_tool(&q);
        arm.inverse(&pose, q[2], &mut out);
        check(&arm, &pose, &out);
        assert!(contains(&arm, &out, &q, 1e-5), "{q:?}: {out:?}");
        most = most.max(out.len());
        arm.inverse_with_pan(&pose, q[0], &mut out);
        check(&arm, &pose, &out);
        assert!(contains(&arm, &out, &q, 1e-5), "{q:?}: {out:?}");
    }
    assert_eq!(most, 8);
}

#[test]
fn impossible_poses_have_no_solution() {
    let arm = Arm::new(Side::Right, 0.2, LimitKind::Hard).unwrap();
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(4);
    let mut out = Solutions::new();
    for pose in [
        Isometry3::translation(1.2, 0.0, 1.0),
        Isometry3::translation(f64::NAN, 0.0, 1.0),
        Isometry3::translation(f64::INFINITY, 0.0, 1.0),
        Isometry3::translation(1e200, 0.0, 1.0),
    ] {
        arm.inverse(&pose, -1.0, &mut out);
        assert!(out.is_empty());
        arm.inverse_with_pan(&pose, -1.0, &mut out);
        assert!(out.is_empty());
        assert_eq!(arm.inverse_any(&pose, &mut rng), None);
        assert_eq!(arm.inverse_near(&pose, &[0.0; 7], 0.5), None);
    }
    let reachable = arm.base_from_tool(&[-0.5, 0.3, -1.0, -1.0, 0.5, -0.5, 0.2]);
    for roll in [2.0, f64::NAN] {
        arm.inverse(&reachable, roll, &mut out);
        assert!(out.is_empty(), "{roll} is outside the limits");
    }
}

#[test]
fn any_finds_nearly_every_reachable_pose() {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(5);
    let mut found = 0;
    for _ in 0..500 {
        let arm = random_arm(&mut rng, LimitKind::Soft);
        let pose = arm.base_from_tool(&random_configuration(&arm, &mut rng));
        if let Some(q) = arm.inverse_any(&pose, &mut rng) {
            check(&arm, &pose, &Solutions::from_iter([q]));
            found += 1;
        }
    }
    assert!(found >= 480, "{found} of 500");
}

/// A solution is found when one of the same rolls, one by one, has one.
#[test]
fn any_finds_what_the_rolls_one_by_one_have() {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(9);
    let (mut out, mut found) = (Solutions::new(), 0);
    for seed in 0..600 {
        let arm = random_arm(&mut rng, LimitKind::Soft);
        let away = Translation3::new(rng.random_range(-0.4..0.4), rng.random_range(-0.4..0.4), 0.0);
        let pose = away * arm.base_from_tool(&random_configuration(&arm, &mut rng));
        let same = || Xoshiro256PlusPlus::seed_from_u64(seed);
        let exists = arm.rolls(&mut same()).iter().any(|roll| {
            arm.inverse(&pose, *roll, &mut out);
            !out.is_empty()
        });
        assert_eq!(arm.inverse_any(&pose, &mut same()).is_some(), exists);
        found += u32::from(exists);
    }
    assert!((100..500).contains(&found), "{found} of 600");
}

#[test]
fn where_shows_every_solution_until_one_is_taken() {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(10);
    let mut shown = 0;
    for _ in 0..200 {
        let arm = random_arm(&mut rng, LimitKind::Soft);
        let pose = arm.base_from_tool(&random_configuration(&arm, &mut rng));
        let mut all = Vec::new();
        let mut refuse = |q: &ArmConfiguration| {
            all.push(*q);
            false
        };
        assert_eq!(arm.inverse_where(&pose, &mut rng, &mut refuse), None);
        for (i, q) in all.iter().enumerate() {
            check(&arm, &pose, &Solutions::from_iter([*q]));
            assert!(!all[..i].contains(q));
        }
        let wanted = all.len() / 2;
        let mut calls = 0;
        let taken = arm.inverse_where(&pose, &mut rng, |_| {
            calls += 1;
            calls == wanted
        });
        assert_eq!(taken.is_some(), (1..=calls).contains(&wanted));
        shown += all.len();
    }
    assert!(shown > 200 * 10, "{shown}");
}

/// [`Arm::inverse_near`] with the rolls one by one.
fn near_one_by_one(arm: &Arm, pose: &Isometry3<f64>, near: &ArmConfiguration, most: f64) -> Option<ArmConfiguration> {
    let mut out = Solutions::new();
    let mut all = Vec::new();
    for step in -8..=8 {
        arm.inverse(pose, near[2] + most * f64::from(step) / 8.0, &mut out);
        all.extend(out.iter().copied());
    }
    all.retain(|q| joint_differences(&arm.limits, near, q).iter().all(|d| d.abs() <= most + 1e-12));
    all.into_iter().min_by(|a, b| joint_distance(&arm.limits, near, a).total_cmp(&joint_distance(&arm.limits, near, b)))
}

#[test]
fn near_finds_the_nearest_of_all_rolls() {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(11);
    let mut found = 0;
    for _ in 0..500 {
        let arm = random_arm(&mut rng, LimitKind::Soft);
        let q = random_configuration(&arm, &mut rng);
        let away = Translation3::from(Vector3::from_fn(|_, _| rng.random_range(-0.05..0.05)));
        let pose = away * arm.base_from_tool(&q);
        let [fast, slow] = [arm.inverse_near(&pose, &q, 0.4), near_one_by_one(&arm, &pose, &q, 0.4)];
        assert_eq!(fast.is_some(), slow.is_some());
        if let (Some(fast), Some(slow)) = (fast, slow) {
            let [fast, slow] = [fast, slow].map(|s| joint_distance(&arm.limits, &q, &s));
            assert!((fast - slow).abs() < 1e-9, "{fast} {slow}");
            found += 1;
        }
    }
    assert!(found > 300, "{found}");
}

/// Straight lines of the tool in steps of 1 cm, tracked from wherever the elbow was.
#[test]
fn near_follows_straight_lines() {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(6);
    let (mut steps, mut lost) = (0, 0);
    for _ in 0..100 {
        let arm = random_arm(&mut rng, LimitKind::Soft);
        let mut q = random_configuration(&arm, &mut rng);
        let start = arm.base_from_tool(&q);
        let direction = Vector3::new(rng.random_range(-1.0..1.0), rng.random_range(-1.0..1.0), 0.3).normalize();
        for step in 1..=10 {
            let pose = Translation3::from(direction * (0.01 * f64::from(step))) * start;
            steps += 1;
            let Some(next) = arm.inverse_near(&pose, &q, 0.3) else {
                lost += 1;
                break;
            };
            check(&arm, &pose, &Solutions::from_iter([next]));
            assert!(joint_differences(&arm.limits, &q, &next).iter().all(|d| d.abs() <= 0.3 + 1e-9));
            q = next;
        }
    }
    assert!(steps > 500 && lost < 50, "{lost} lines lost in {steps} steps");
}

#[test]
fn near_returns_the_configuration_itself() {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(7);
    for _ in 0..200 {
        let arm = random_arm(&mut rng, LimitKind::Soft);
        let q = random_configuration(&arm, &mut rng);
        let same = arm.inverse_near(&arm.base_from_tool(&q), &q, 0.1).unwrap();
        assert!(joint_distance(&arm.limits, &q, &same) < 1e-7);
    }
}

/// The general numeric inverse and the closed form agree: the latter, given the former's roll, returns the same joints.
#[test]
fn agrees_with_the_numeric_inverse() {
    let model = Pr2Model::embedded().unwrap();
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(8);
    let mut out = Solutions::new();
    for side in Side::BOTH {
        let arm = model.arm(side, WholeBody::at_rest().torso_m, LimitKind::Soft).unwrap();
        let wider = model.arm(side, WholeBody::at_rest().torso_m, LimitKind::Hard).unwrap();
        let tip = format!("{}_gripper_tool_frame", side.prefix());
        let (tool, options) = (Isometry3::identity(), InverseOptions::default());
        let numeric = ChainInverse::new(model.tree(), "torso_lift_link", &tip, &tool, options).unwrap();
        let mut solved = 0;
        let some = random_configuration(&arm, &mut rng);
        let torso_from_base = numeric.base_from_tool(&some).unwrap() * arm.base_from_tool(&some).inverse();
        for _ in 0..500 {
            let pose = arm.base_from_tool(&random_configuration(&arm, &mut rng));
            let Some(values) = numeric.inverse(&(torso_from_base * pose), &mut rng) else {
                continue;
            };
            solved += 1;
            let q: ArmConfiguration = std::array::from_fn(|i| values[i]);
            // The numeric solution may lie on a soft limit, within its tolerance of the pose.
            wider.inverse(&pose, q[2], &mut out);
            assert!(contains(&wider, &out, &q, 1e-5), "{q:?}: {out:?}");
        }
        assert!(solved >= 498, "{solved} of 500");
    }
}
