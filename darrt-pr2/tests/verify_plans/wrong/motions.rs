//! Objects that move by themselves, joints out of turn, broken chains, limits, malformed waypoints.

use std::collections::BTreeMap;

use darrt_pr2::verify;
use darrt_task::plan_file::{PlanFile, Pose, Waypoint};
use darrt_task::problem_file::Limits;
use darrt_task::verify::RefusalKind;
use nalgebra::Isometry3;

use super::{from_here_on, joint, plate, refused, waypoint};
use crate::verify_plans::plans;

#[test]
fn objects_do_not_move_by_themselves() {
    use RefusalKind as K;
    let jump = |at: &mut Waypoint| plate(at).position[0] += 1e-6;
    let text = refused(plans::push(), 1, K::Stray, |plan| from_here_on(plan, 1, 3, jump)).to_string();
    assert!(text.starts_with("step 1 (Straight-Line-Arm-Transit) at 0.4") && text.contains("plate moves"), "{text}");
    let text = refused(plans::push(), 2, K::Chain, |plan| from_here_on(plan, 2, 0, jump)).to_string();
    assert!(text.contains("plate was at"), "{text}");
    refused(plans::carry(), 7, K::Stray, |plan| from_here_on(plan, 7, 2, jump));
    refused(plans::wave(), 2, K::Stray, |plan| from_here_on(plan, 2, 1, jump));
}

#[test]
fn only_the_acting_part_of_the_robot_moves() {
    use RefusalKind as K;
    for (name, delta) in
        [("torso_lift_joint", 1e-3), ("head_pan_joint", 0.1), ("l_elbow_flex_joint", 1e-6), ("l_wrist_roll_joint", 0.1)]
    {
        let edit = |plan: &mut PlanFile| from_here_on(plan, 1, 2, |at| *joint(at, name) += delta);
        let refusal = refused(plans::push(), 1, K::Stray, edit);
        assert!(refusal.message.contains(name), "{refusal}");
    }
    let text =
        refused(plans::push(), 2, K::Stray, |plan| from_here_on(plan, 2, 4, |at| at.base[0] -= 1e-6)).to_string();
    assert!(text.contains("the base moves in Push"), "{text}");
    let elbow = |at: &mut Waypoint| *joint(at, "r_elbow_flex_joint") -= 1e-3;
    let text = refused(plans::wave(), 1, K::Stray, |plan| from_here_on(plan, 1, 2, elbow)).to_string();
    assert!(text.contains("`r_elbow_flex_joint` moves in Base-Transit"), "{text}");
}

#[test]
fn steps_chain_bit_for_bit() {
    use RefusalKind as K;
    let last_bit = |value: &mut f64| *value = f64::from_bits(value.to_bits() + 1);
    refused(plans::push(), 2, K::Chain, |plan| last_bit(joint(waypoint(plan, 2, 0), "r_elbow_flex_joint")));
    refused(plans::push(), 1, K::Chain, |plan| last_bit(&mut waypoint(plan, 1, 0).base[0]));
    refused(plans::push(), 1, K::Chain, |plan| drop(plan.steps.remove(0)));
    refused(plans::push(), 3, K::Malformed, |plan| plan.steps[2].waypoints.truncate(1));
    refused(plans::push(), 3, K::Malformed, |plan| plan.steps[2].waypoints.clear());
}

#[test]
fn limits_and_bounds_hold() {
    use RefusalKind as K;
    let lift = |value: f64| move |at: &mut Waypoint| *joint(at, "r_shoulder_lift_joint") = value;
    let refusal = refused(plans::wave(), 2, K::Joints, |plan| lift(1.3)(waypoint(plan, 2, 1)));
    assert!(refusal.message.contains("r_shoulder_lift_joint` is 1.3"), "{refusal}");
    let hard = |plan: &mut PlanFile| {
        plan.problem.robot.limits = Limits::Hard;
        lift(1.3)(waypoint(plan, 2, 1));
    };
    let mut plan = plans::wave();
    hard(&mut plan);
    verify(&plan).unwrap();
    refused(plans::wave(), 2, K::Joints, |plan| {
        hard(plan);
        lift(1.4)(waypoint(plan, 2, 1));
    });
    let roll = |at: &mut Waypoint| *joint(at, "r_wrist_roll_joint") += std::f64::consts::PI;
    let refusal = refused(plans::wave(), 2, K::Joints, |plan| roll(waypoint(plan, 2, 1)));
    assert!(refusal.message.contains("r_wrist_roll_joint"), "{refusal}");
    refused(plans::wave(), 1, K::Bounds, |plan| from_here_on(plan, 1, 2, |at| at.base[0] = -3.01));
    refused(plans::carry(), 2, K::Bounds, |plan| plan.problem.bounds.object_z = [0.0, 0.79]);
}

#[test]
fn waypoints_are_well_formed() {
    use RefusalKind as K;
    let edits: [&dyn Fn(&mut Waypoint); 8] = [
        &|at| {
            at.joints.remove("l_forearm_roll_joint");
        },
        &|at| {
            at.joints.insert("tail_joint".into(), 0.0);
        },
        &|at| *joint(at, "r_gripper_r_finger_tip_joint") += 1e-3,
        &|at| *joint(at, "r_elbow_flex_joint") = f64::NAN,
        &|at| at.base[2] = f64::INFINITY,
        &|at| at.objects = BTreeMap::new(),
        &|at| {
            at.objects.insert("cup".into(), Pose::from(Isometry3::identity()));
        },
        &|at| plate(at).quaternion = [0.0, 0.0, 0.0, 1.01],
    ];
    for edit in edits {
        refused(plans::push(), 2, K::Malformed, |plan| edit(waypoint(plan, 2, 5)));
    }
    refused(plans::push(), 0, K::Malformed, |plan| plan.start.base[0] = f64::NAN);
}

#[test]
fn straight_lines_are_straight() {
    let bend = |at: &mut Waypoint| *joint(at, "r_wrist_roll_joint") += 0.04;
    let refusal = refused(plans::push(), 1, RefusalKind::StraightLine, |plan| bend(waypoint(plan, 1, 2)));
    assert!(refusal.place.is_some(), "{refusal}");
}
