use super::*;
use crate::kinematics::RobotDescription;
use crate::testing::arms;
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use std::f64::consts::PI;

const GENERIC: &str = include_str!("../../../tests/data/generic_arm.urdf");

fn inverse_of(text: &str, base: &str, tip: &str) -> ChainInverse {
    let tree = KinematicTree::new(&RobotDescription::from_text(text).unwrap()).unwrap();
    ChainInverse::new(&tree, base, tip, &Isometry3::identity(), InverseOptions::default()).unwrap()
}

fn generic() -> ChainInverse {
    inverse_of(GENERIC, "mount", "probe")
}

fn random(inverse: &ChainInverse, rng: &mut impl Rng) -> JointValues {
    let value = |limit: &JointLimit| {
        let (lower, upper) = if limit.is_unlimited() { (-PI, PI) } else { (limit.lower, limit.upper) };
        rng.random_range(lower..=upper)
    };
    inverse.limits().iter().map(value).collect()
}

fn assert_reaches(inverse: &ChainInverse, q: &[f64], target: &Isometry3<f64>) {
    let reached = inverse.base_from_tool(q).unwrap();
    assert!((reached.translation.vector - target.translation.vector).norm() < 1e-9);
    // 1e-9 is near what the angle between two quaternions can resolve.
    assert!(reached.rotation.angle_to(&target.rotation) < 1e-7);
    assert!(q.iter().zip(inverse.limits()).all(|(value, limit)| limit.contains(*value)));
}

/// How many of `count` poses of random configurations are reached.
fn share(name: &str, inverse: &ChainInverse, count: u32) -> f64 {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(11);
    let mut found = 0_u32;
    for _ in 0..count {
        let target = inverse.base_from_tool(&random(inverse, &mut rng)).unwrap();
        if let Some(q) = inverse.inverse(&target, &mut rng) {
            found += 1;
            assert_reaches(inverse, &q, &target);
        }
    }
    println!("{name}: {found} of {count}");
    f64::from(found) / f64::from(count)
}

#[test]
fn reaches_nearly_all_poses_of_common_arms() {
    for (name, text) in arms::all() {
        let inverse = inverse_of(&text, arms::BASE, arms::TOOL);
        assert!(share(name, &inverse, 1000) >= 0.995, "{name}");
    }
    assert!(share("made-up arm with a follower", &generic(), 1000) >= 0.995);
    assert!(share("planar", &inverse_of(&arms::planar(), arms::BASE, arms::TOOL), 1000) >= 0.995);
}

#[test]
fn redundancy_is_drawn_and_the_same_draws_give_the_same_answer() {
    let inverse = inverse_of(&arms::panda(), arms::BASE, arms::TOOL);
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(2);
    let target = inverse.base_from_tool(&[0.1, 0.2, -0.3, -1.8, 0.4, 1.9, 0.5]).unwrap();
    let mut same = rng.clone();
    let answers: Vec<JointValues> = (0..20).filter_map(|_| inverse.inverse(&target, &mut rng)).collect();
    let again: Vec<JointValues> = (0..20).filter_map(|_| inverse.inverse(&target, &mut same)).collect();
    assert_eq!(answers, again);
    assert!(answers.len() >= 19, "{}", answers.len());
    let is_far = |a: &[f64], b: &[f64]| a.iter().zip(b).any(|(a, b)| (a - b).abs() > 0.05);
    let different = |i: &usize| answers[..*i].iter().all(|before| is_far(before, &answers[*i]));
    let different = (0..answers.len()).filter(different).count();
    assert!(different >= 5, "{different} of {}", answers.len());
}

/// Along a line of the tool in small steps every joint moves in small steps.
#[test]
fn stays_near_along_a_line() {
    for (name, text) in arms::all() {
        let inverse = inverse_of(&text, arms::BASE, arms::TOOL);
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(7);
        let (mut followed, mut lines) = (0, 0);
        while lines < 50 {
            let mut q = random(&inverse, &mut rng);
            let start = inverse.base_from_tool(&q).unwrap();
            let end = Isometry3::translation(0.0, 0.0, 0.1) * start;
            if inverse.inverse(&end, &mut rng).is_none() {
                continue;
            }
            lines += 1;
            let arrived = (1..=20).all(|step| {
                let target = Isometry3::translation(0.0, 0.0, 0.005 * f64::from(step)) * start;
                let Some(next) = inverse.inverse_near(&target, &q, 0.2) else { return false };
                assert_reaches(&inverse, &next, &target);
                let difference = |((a, b), limit): ((&f64, &f64), &JointLimit)| {
                    let d = a - b;
                    if limit.is_unlimited() { wrap_to_pi(d).abs() } else { d.abs() }
                };
                assert!(next.iter().zip(&q).zip(inverse.limits()).map(difference).all(|d| d <= 0.2 + 1e-12));
                q = next;
                true
            });
            followed += u32::from(arrived);
        }
        println!("{name}: {followed} of {lines} lines");
        // Lines from random configurations: many lead out of the limits of the branch they start in.
        assert!(followed >= 25, "{name}: {followed} of {lines}");
    }
}

#[test]
fn near_itself_is_itself() {
    let inverse = generic();
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(5);
    for _ in 0..50 {
        let q = random(&inverse, &mut rng);
        let target = inverse.base_from_tool(&q).unwrap();
        assert_eq!(inverse.inverse_near(&target, &q, 0.0).as_ref(), Some(&q));
    }
    let q = random(&inverse, &mut rng);
    let target = inverse.base_from_tool(&q).unwrap();
    assert_eq!(inverse.inverse_near(&target, &q[1..], 1.0), None);
}

#[test]
fn an_unreachable_pose_is_none() {
    let inverse = generic();
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(1);
    for target in [
        Isometry3::translation(3.0, 0.0, 0.0),
        // Within the lengths of the links, but the shoulder does not bend so far down.
        Isometry3::translation(0.0, 0.0, -0.3),
        Isometry3::translation(f64::NAN, 0.0, 0.0),
        Isometry3::translation(f64::INFINITY, 0.0, 0.0),
    ] {
        assert_eq!(inverse.inverse(&target, &mut rng), None, "{target}");
    }
    assert!(!inverse.may_reach(&Isometry3::translation(3.0, 0.0, 0.0)));
    let q = random(&inverse, &mut rng);
    assert!(inverse.may_reach(&inverse.base_from_tool(&q).unwrap()));
}

/// Half a turn between tool and target is where a rotation vector from a matrix is delicate.
#[test]
fn half_turns_are_reached() {
    let inverse = inverse_of(&arms::ur5e(), arms::BASE, arms::TOOL);
    let q = [0.3, -1.2, 1.4, -0.7, 1.1, 0.2];
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(4);
    for off in [0.0, 1e-12, 1e-9, 1e-7, 1e-5, 1e-3] {
        let mut turned = q;
        turned[5] += PI - off;
        let target = inverse.base_from_tool(&turned).unwrap();
        let near = inverse.inverse_near(&target, &q, 4.0).unwrap();
        assert_reaches(&inverse, &near, &target);
        let found = inverse.inverse(&target, &mut rng).unwrap();
        assert_reaches(&inverse, &found, &target);
    }
}

#[test]
fn the_pose_is_that_of_the_tree() {
    let tree = KinematicTree::new(&RobotDescription::from_text(GENERIC).unwrap()).unwrap();
    let tip_from_tool = Isometry3::new(nalgebra::Vector3::new(0.1, -0.2, 0.3), nalgebra::Vector3::new(0.4, 0.5, -0.6));
    let inverse = ChainInverse::new(&tree, "mount", "probe", &tip_from_tool, InverseOptions::default()).unwrap();
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(9);
    let mut poses = vec![Isometry3::identity(); tree.link_count()];
    let tip = tree.link_index("probe").unwrap();
    for _ in 0..100 {
        let q = random(&inverse, &mut rng);
        let mut all = tree.neutral();
        inverse.variables().iter().zip(&q).for_each(|(variable, value)| all[*variable] = *value);
        tree.forward(&all, &Isometry3::identity(), &mut poses).unwrap();
        let (a, b) = (poses[tip] * tip_from_tool, inverse.base_from_tool(&q).unwrap());
        assert!((a.translation.vector - b.translation.vector).norm() < 1e-14);
        assert!(a.rotation.angle_to(&b.rotation) < 1e-7);
    }
}

#[test]
fn what_is_no_chain_is_refused() {
    let tree = KinematicTree::new(&RobotDescription::from_text(GENERIC).unwrap()).unwrap();
    let new = |base, tip| ChainInverse::new(&tree, base, tip, &Isometry3::identity(), InverseOptions::default());
    assert!(matches!(new("probe", "mount"), Err(KinematicsError::NotAbove { .. })));
    assert!(matches!(new("mount", "mount"), Err(KinematicsError::NoJoint { .. })));
    assert!(new("mount", "probe").unwrap().base_from_tool(&[0.0]).is_err());
}

#[test]
fn joints_that_are_held_stay_where_they_are() {
    let inverse = generic();
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(5);
    let mut found = 0;
    for _ in 0..100 {
        let joints = random(&inverse, &mut rng);
        let target = inverse.base_from_tool(&joints).unwrap();
        let mut limits: Vec<_> = inverse.limits().to_vec();
        limits[1] = JointLimit::new(joints[1], joints[1]);
        let mut start = joints.clone();
        start.iter_mut().skip(2).for_each(|value| *value += 0.05);
        let Some(answer) = inverse.inverse_from(&target, &start, &limits) else { continue };
        assert_eq!(answer[1], joints[1]);
        assert_reaches(&inverse, &answer, &target);
        found += 1;
    }
    assert!(found >= 90, "{found} of 100");
    let joints = random(&inverse, &mut rng);
    assert_eq!(inverse.inverse_from(&Isometry3::identity(), &joints[1..], inverse.limits()), None);
    assert_eq!(inverse.inverse_from(&Isometry3::identity(), &joints, &inverse.limits()[1..]), None);
}

/// A pose that is computed from an answer is reached as well, by an arm that reaches few.
#[test]
fn an_exact_answer_is_as_near_as_rounding_lets_it_be() {
    let tree = KinematicTree::new(&RobotDescription::from_text(&arms::planar()).unwrap()).unwrap();
    let farthest = |exact: bool| {
        let options = InverseOptions { exact, ..InverseOptions::default() };
        let inverse = ChainInverse::new(&tree, arms::BASE, arms::TOOL, &Isometry3::identity(), options).unwrap();
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(6);
        let missing = (0..500).filter_map(|_| {
            let target = inverse.base_from_tool(&random(&inverse, &mut rng)).unwrap();
            let joints = inverse.inverse(&target, &mut rng)?;
            let reached = inverse.base_from_tool(&joints).unwrap();
            Some((reached.translation.vector - target.translation.vector).norm())
        });
        missing.fold(0.0, f64::max)
    };
    let [rough, exact] = [false, true].map(farthest);
    assert!(exact < 1e-14 && rough > 10.0 * exact, "{rough} {exact}");
}
