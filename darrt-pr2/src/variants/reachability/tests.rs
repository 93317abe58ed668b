use super::*;
use crate::arm::{ArmConfiguration, LimitKind, Side};
use crate::forward::world_from_base;
use rand::SeedableRng;
use rand_xoshiro::Xoshiro256PlusPlus;

fn arm(side: Side) -> Arm {
    Arm::new(side, 0.2, LimitKind::Soft).unwrap()
}

fn random_configuration(arm: &Arm, rng: &mut dyn Rng) -> ArmConfiguration {
    arm.limits.map(|l| rng.random_range(l.lower.max(-PI)..=l.upper.min(PI)))
}

/// A base anywhere and a pose that the arm reaches from there.
fn reached(arm: &Arm, rng: &mut dyn Rng) -> ([f64; 3], Isometry3<f64>) {
    let base = [rng.random_range(-3.0..3.0), rng.random_range(-3.0..3.0), rng.random_range(-PI..PI)];
    let q = random_configuration(arm, rng);
    (base, world_from_base(&base) * arm.base_from_tool(&q))
}

fn reaches(arm: &Arm, base: &[f64; 3], tool: &Isometry3<f64>, rng: &mut dyn Rng) -> bool {
    arm.inverse_any(&(world_from_base(base).inverse() * tool), rng).is_some()
}

/// A tool pose as manipulation at tables asks for it: the hand down, level or in between, at the height of a table.
fn at_a_table(rng: &mut dyn Rng) -> Isometry3<f64> {
    let tilt = [-FRAC_PI_2, -1.0, -0.3, 0.0][rng.random_range(0..4)];
    let turn = UnitQuaternion::from_euler_angles(0.0, -tilt, rng.random_range(-PI..PI))
        * UnitQuaternion::from_euler_angles(rng.random_range(-PI..PI), 0.0, 0.0);
    Isometry3::from_parts(Translation3::new(1.0, 2.0, rng.random_range(0.75..1.0)), turn)
}

#[test]
fn what_is_called_unreachable_is_never_reached() {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(1);
    let mut missed = 0;
    for side in Side::BOTH {
        let arm = arm(side);
        let model = Reachability::new(&arm, 0.3);
        for _ in 0..5000 {
            let (base, tool) = reached(&arm, &mut rng);
            missed += u32::from(!model.may_reach(&base, &tool));
        }
    }
    assert!(missed <= 2, "{missed} of 10000 reachable poses are called unreachable");
}

#[test]
fn much_is_called_unreachable() {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(2);
    let arm = arm(Side::Right);
    let model = Reachability::new(&arm, 0.3);
    let (mut reached, mut allowed) = (0, 0);
    for _ in 0..3000 {
        let tool = at_a_table(&mut rng);
        let base = [1.0 + rng.random_range(-1.0..1.0), 2.0 + rng.random_range(-1.0..1.0), rng.random_range(-PI..PI)];
        reached += u32::from(reaches(&arm, &base, &tool, &mut rng));
        allowed += u32::from(model.may_reach(&base, &tool));
    }
    assert!(reached > 100 && allowed < 1200, "{reached} reached, {allowed} allowed of 3000");
}

#[test]
fn bases_drawn_reach_far_more_often_than_uniform_ones() {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(3);
    for side in Side::BOTH {
        let arm = arm(side);
        let model = Reachability::new(&arm, 0.3);
        let (mut drawn, mut uniform) = (0, 0);
        for _ in 0..1500 {
            let tool = at_a_table(&mut rng);
            let base = model.base_for(&tool, &mut rng).unwrap();
            drawn += u32::from(reaches(&arm, &base, &tool, &mut rng));
            // As far from the tool as the arm can be.
            let base =
                [1.0 + rng.random_range(-1.1..1.1), 2.0 + rng.random_range(-1.1..1.1), rng.random_range(-PI..PI)];
            uniform += u32::from(reaches(&arm, &base, &tool, &mut rng));
        }
        assert!(drawn > 1200 && drawn > 5 * uniform, "{drawn} against {uniform} of 1500");
    }
}

/// The model of the left arm is that of the right one in a mirror.
#[test]
fn the_arms_mirror_each_other() {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(4);
    let [right, left] = Side::BOTH.map(|side| Reachability::new(&arm(side), 0.3));
    let (mut same, mut count) = (0, 0);
    for _ in 0..500 {
        let tool = at_a_table(&mut rng);
        let axis = tool.rotation * Vector3::x();
        let base = [rng.random_range(0.0..2.0), rng.random_range(1.0..3.0), rng.random_range(-PI..PI)];
        let turn = UnitQuaternion::rotation_between(&Vector3::x(), &Vector3::new(axis.x, -axis.y, axis.z));
        let at = tool.translation.vector;
        let mirrored = Isometry3::from_parts(Translation3::new(at.x, -at.y, at.z), turn.unwrap());
        let [a, b] = [right.may_reach(&base, &tool), left.may_reach(&[base[0], -base[1], -base[2]], &mirrored)];
        (same, count) = (same + u32::from(a == b), count + 1);
    }
    // Rolls and bearings are rounded, not mirrored.
    assert!(same * 20 > count * 19, "{same} of {count}");
}

#[test]
fn poses_out_of_reach_have_no_base() {
    let model = Reachability::new(&arm(Side::Right), 0.3);
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(5);
    for tool in [
        Isometry3::translation(0.0, 0.0, 3.0),
        Isometry3::translation(0.0, 0.0, -1.0),
        Isometry3::translation(f64::NAN, 0.0, 1.0),
        Isometry3::translation(0.0, 0.0, f64::INFINITY),
    ] {
        assert_eq!(model.base_for(&tool, &mut rng), None);
        assert!(!model.may_reach(&[0.0; 3], &tool));
    }
}

#[test]
fn same_seed_same_base_whatever_was_asked_before() {
    let arm = arm(Side::Right);
    let [fresh, used] = [(); 2].map(|()| Reachability::new(&arm, 0.3));
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(6);
    for _ in 0..50 {
        used.base_for(&at_a_table(&mut rng), &mut rng);
    }
    for seed in 0..50 {
        let tool = at_a_table(&mut rng);
        let draw = |model: &Reachability| model.base_for(&tool, &mut Xoshiro256PlusPlus::seed_from_u64(seed));
        assert_eq!(draw(&fresh), draw(&used));
    }
}
