use super::super::tests::{contains, pose_error, random_arm, random_configuration};
use super::super::{LimitKind, Side};
use super::*;
use darrt_primitives::kinematics::lanes::LANES;
use pulp::Scalar;
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

/// How near to the end of a joint's range rounding may decide.
const EDGE: f64 = 1e-9;

/// Lane by lane against the scalar inverse, forward again, and bit by bit against itself without a vector unit.
/// Returns the number of solutions.
fn check(arm: &Arm, pose: &Isometry3<f64>, rolls: &Row) -> usize {
    let (mut many, mut twin) = (RollSolutions::default(), RollSolutions::default());
    arm.inverse_for_rolls(pose, rolls, &mut many);
    Scalar.vectorize(arm.run(pose, rolls, &mut twin));
    let (mut found, mut same, mut expected) = (Solutions::new(), Solutions::new(), Solutions::new());
    let mut count = 0;
    for (lane, roll) in rolls.0.iter().enumerate() {
        many.of_lane(lane, &mut found);
        twin.of_lane(lane, &mut same);
        assert_eq!(found, same, "lane {lane}");
        arm.inverse(pose, *roll, &mut expected);
        for q in &found {
            assert!(arm.within_limits(q), "{q:?}");
            let error = pose_error(&arm.base_from_tool(q), pose);
            assert!(error < 1e-12, "{error} at {q:?}");
        }
        let at_edge = |q: &ArmConfiguration| {
            q.iter().zip(&arm.limits).any(|(v, limit)| (v - limit.lower).abs().min((v - limit.upper).abs()) < EDGE)
        };
        // Where two roots of the quadratic nearly meet, rounding moves them by its square root.
        for (these, those) in [(&found, &expected), (&expected, &found)] {
            for q in these.iter().filter(|q| !at_edge(q)) {
                assert!(contains(arm, those, q, 1e-6), "{q:?} at {roll}: {those:?}");
            }
        }
        count += found.len();
    }
    assert_eq!(many.is_empty(), count == 0);
    count
}

fn rolls(rng: &mut Xoshiro256PlusPlus) -> Row {
    Row(std::array::from_fn(|_| rng.random_range(-5.0..5.0)))
}

#[test]
fn eight_rolls_have_the_solutions_of_each() {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(1);
    let mut count = 0;
    for round in 0..3000 {
        let kind = if round % 2 == 0 { LimitKind::Soft } else { LimitKind::Hard };
        let arm = random_arm(&mut rng, kind);
        let pose = arm.base_from_tool(&random_configuration(&arm, &mut rng));
        count += check(&arm, &pose, &rolls(&mut rng));
    }
    assert!(count > 6000, "{count}");
}

/// Both bends of the elbow and both sides of the wrist.
#[test]
fn without_limits_every_branch_is_there() {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(2);
    let arm = Arm::with_limits(Side::Left, 0.1, [JointLimit::UNLIMITED; 7]).unwrap();
    let mut count = 0;
    for _ in 0..500 {
        let q: ArmConfiguration = std::array::from_fn(|_| rng.random_range(-3.0..3.0));
        count += check(&arm, &arm.base_from_tool(&q), &rolls(&mut rng));
    }
    assert!(count > 500 * 8, "{count}");
}

/// Ranges that begin or end beyond half a turn, where an angle fits after a whole turn only.
#[test]
fn ranges_beyond_half_a_turn_are_kept() {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(3);
    let mut limits = [JointLimit::new(-3.0, 3.0); 7];
    limits[0] = JointLimit::new(1.0, 4.5);
    limits[4] = JointLimit::new(-5.0, -2.0);
    limits[6] = JointLimit::new(4.0, 8.0);
    let arm = Arm::with_limits(Side::Right, 0.0, limits).unwrap();
    let mut count = 0;
    for _ in 0..500 {
        let q = limits.map(|limit| rng.random_range(limit.lower..limit.upper));
        count += check(&arm, &arm.base_from_tool(&q), &rolls(&mut rng));
    }
    assert!(count > 100, "{count}");
}

#[test]
fn near_singular_poses_lose_no_accuracy() {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(4);
    let (mut many, mut out) = (RollSolutions::default(), Solutions::new());
    for round in 0..2000 {
        let arm = random_arm(&mut rng, LimitKind::Hard);
        let mut q = random_configuration(&arm, &mut rng);
        let tiny = -(10.0_f64).powf(rng.random_range(-12.0..-3.0));
        match round % 3 {
            0 => q[3] = tiny,
            1 => q[5] = tiny,
            _ => (q[3], q[5]) = (arm.limits[3].lower, 0.0),
        }
        let pose = arm.base_from_tool(&q);
        arm.inverse_for_rolls(&pose, &Row::splat(q[2]), &mut many);
        assert!(!many.is_empty(), "{q:?}");
        many.of_lane(round % LANES, &mut out);
        for found in &out {
            let error = pose_error(&arm.base_from_tool(found), &pose);
            assert!(error < 1e-12, "{error} at {found:?}");
        }
    }
}

#[test]
fn impossible_poses_and_rolls_have_no_solution() {
    let arm = Arm::new(Side::Right, 0.2, LimitKind::Hard).unwrap();
    let mut many = RollSolutions::default();
    for pose in [
        Isometry3::translation(1.2, 0.0, 1.0),
        Isometry3::translation(f64::NAN, 0.0, 1.0),
        Isometry3::translation(f64::INFINITY, 0.0, 1.0),
        Isometry3::translation(1e200, 0.0, 1.0),
    ] {
        arm.inverse_for_rolls(&pose, &Row::splat(-1.0), &mut many);
        assert!(many.is_empty());
    }
    let reachable = arm.base_from_tool(&[-0.5, 0.3, -1.0, -1.0, 0.5, -0.5, 0.2]);
    arm.inverse_for_rolls(&reachable, &Row([2.0, f64::NAN, -1.0, f64::INFINITY, -1.0, 1e30, 2.0, 2.0]), &mut many);
    let mut out = Solutions::new();
    let found: [bool; LANES] = std::array::from_fn(|lane| {
        many.of_lane(lane, &mut out);
        !out.is_empty()
    });
    assert_eq!(found[..5], [false, false, true, false, true]);
    many.of_lane(LANES, &mut out);
    assert!(out.is_empty());
}
