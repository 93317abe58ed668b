//! Pushes, grasps, places and hands that cannot be.

use darrt_pr2::verify;
use darrt_task::plan_file::{PlanFile, Waypoint};
use darrt_task::problem_file::{PrimitiveName, Surface};
use darrt_task::verify::RefusalKind;
use nalgebra::{Isometry3, UnitQuaternion, Vector3};

use super::{about, from_here_on, plate, refused, waypoint};
use crate::verify_plans::builder::{PLATE, TABLE};
use crate::verify_plans::plans;

#[test]
fn pushes_go_as_pushes_go() {
    use RefusalKind as K;
    // 4 mm beside the centre line: the ray from the contacts runs through elsewhere.
    let aside = refused(plans::push_of([-0.196, 0.05]), 2, K::Push, |_| ());
    assert!(aside.message.contains("degrees off the ray") || aside.message.contains("from the rim"), "{aside}");
    let swap = |plan: &mut PlanFile| plan.steps[1].waypoints.swap(6, 7);
    refused(plans::push(), 2, K::Push, swap);
    let shift = |x: f64, y: f64, z: f64| {
        move |at: &mut Waypoint| {
            let position = &mut plate(at).position;
            *position = [position[0] + x, position[1] + y, position[2] + z];
        }
    };
    let ahead = refused(plans::push(), 2, K::Push, |plan| from_here_on(plan, 2, 8, shift(0.0, -0.004, 0.0)));
    assert!(ahead.message.contains("from the rim"), "{ahead}");
    let behind = refused(plans::push(), 2, K::Push, |plan| from_here_on(plan, 2, 8, shift(0.0, 0.004, 0.0)));
    assert!(behind.message.contains("presses into"), "{behind}");
    about(&behind, "r_gripper", PLATE);
    refused(plans::push(), 2, K::Push, |plan| from_here_on(plan, 2, 8, shift(0.001, 0.0, 0.0)));
    refused(plans::push(), 2, K::Push, |plan| from_here_on(plan, 2, 8, shift(0.0, 0.0, 1e-4)));
    let turn = |at: &mut Waypoint| plate(at).quaternion = [0.0, 0.0, 0.03_f64.sin(), 0.03_f64.cos()];
    refused(plans::push(), 2, K::Push, |plan| from_here_on(plan, 2, 8, turn));
    refused(plans::push(), 2, K::Push, |plan| plan.problem.objects[0].pushable = Some(false));
    // The surface ends before the push does, though the table does not.
    let short = Surface {
        name: "central table".to_owned(),
        top_of: None,
        polygon: Some(vec![[-0.45, -0.15], [0.0, -0.15], [0.0, -0.6], [0.45, -0.6], [0.45, 0.6], [-0.45, 0.6]]),
        z: Some(0.75),
        body: Some(TABLE.to_owned()),
    };
    let off = refused(plans::push(), 2, K::Support, |plan| {
        plan.problem.surfaces[0] = short;
        plan.problem.goal.objects[0].at = Some([0.0, 0.0]);
    });
    about(&off, PLATE, "central table");
}

#[test]
fn what_is_carried_leans_no_farther_than_it_may() {
    let refusal =
        refused(plans::carry(), 2, RefusalKind::Tilt, |plan| plan.problem.objects[0].max_tilt_deg = Some(0.0));
    assert!(refusal.message.contains("while it is carried, at most 0"), "{refusal}");
    about(&refusal, PLATE, "the vertical");
}

#[test]
fn what_is_too_heavy_is_not_pushed() {
    // 0.3 * 10.2 kg * 9.81 m/s^2 = 30.02 N.
    let refusal = refused(plans::push(), 2, RefusalKind::Push, |plan| plan.problem.objects[0].mass_kg = 10.2);
    assert!(refusal.message.contains("30.0 N against its friction"), "{refusal}");
    verify(&with(plans::push(), |plan| plan.problem.objects[0].mass_kg = 10.1)).unwrap();
}

/// A plan after a change.
fn with(mut plan: PlanFile, change: impl FnOnce(&mut PlanFile)) -> PlanFile {
    change(&mut plan);
    plan
}

#[test]
fn nothing_is_left_at_an_edge_unless_its_goal_is_there() {
    use RefusalKind as K;
    // The push ends 0.25 m inside the edge, the plate is set down 0.07 m inside.
    for (plan, step, margin_m) in [(plans::push(), 2, 0.26), (plans::carry(), 6, 0.08)] {
        let far = |plan: &mut PlanFile| plan.problem.safety.edge_margin_m = margin_m;
        let elsewhere = |plan: &mut PlanFile| {
            far(plan);
            plan.problem.goal.objects[0].at = Some([0.2, 0.0]);
        };
        let refusal = refused(plan.clone(), step, K::Edge, elsewhere);
        about(&refusal, PLATE, "central table");
        assert!(refusal.message.contains("inside the edge"), "{refusal}");
        // The goal that is there forces it.
        verify(&with(plan, far)).unwrap();
    }
}

#[test]
fn held_objects_are_rigid_to_the_hand() {
    use RefusalKind as K;
    let refusal = refused(plans::carry(), 2, K::Grasp, |plan| plate(waypoint(plan, 2, 3)).position[1] += 2e-6);
    assert!(refusal.message.contains("from where the hand holds it"), "{refusal}");
    let tilt = |plan: &mut PlanFile| {
        let pose = plate(waypoint(plan, 4, 1));
        let turned = Isometry3::from(*pose) * UnitQuaternion::from_axis_angle(&Vector3::x_axis(), 2e-6);
        *pose = turned.into();
    };
    refused(plans::carry(), 4, K::Grasp, tilt);
    let slip = |plan: &mut PlanFile| plan.steps[2].holds.as_mut().unwrap().tool_from_object.position[0] += 1e-6;
    let refusal = refused(plans::carry(), 3, K::Grasp, slip);
    assert!(refusal.message.contains("tool_from_object"), "{refusal}");
    let loose = |plan: &mut PlanFile| {
        let angle = darrt_pr2::gripper::finger_angle(0.03);
        for at in plan.steps.iter_mut().skip(1).flat_map(|step| step.waypoints.iter_mut().skip(1)) {
            at.joints.iter_mut().filter(|(name, _)| name.starts_with("r_gripper")).for_each(|(_, q)| *q = angle);
        }
    };
    let refusal = refused(plans::carry(), 2, K::Grasp, loose);
    about(&refusal, "r_gripper", PLATE);
}

#[test]
fn the_hand_opens_and_closes_only_where_it_must() {
    use RefusalKind as K;
    let set = |at: &mut Waypoint, gap: f64| {
        let angle = darrt_pr2::gripper::finger_angle(gap);
        at.joints.iter_mut().filter(|(name, _)| name.starts_with("r_gripper")).for_each(|(_, q)| *q = angle);
    };
    refused(plans::carry(), 2, K::Gripper, |plan| drop(plan.steps[1].waypoints.remove(1)));
    refused(plans::carry(), 4, K::Gripper, |plan| set(waypoint(plan, 4, 1), 0.021));
    refused(plans::push(), 2, K::Gripper, |plan| set(waypoint(plan, 2, 5), 0.07));
    refused(plans::carry(), 6, K::Gripper, |plan| drop(plan.steps[5].waypoints.pop()));
    refused(plans::wave(), 2, K::Gripper, |plan| set(waypoint(plan, 2, 1), 0.05));
}

#[test]
fn steps_and_what_is_held_fit_together() {
    use RefusalKind as K;
    let cup = || Some("cup".to_owned());
    refused(plans::push(), 2, K::Mode, |plan| plan.steps[1].object = cup());
    refused(plans::push(), 2, K::Mode, |plan| plan.steps[1].pushes = None);
    refused(plans::push(), 1, K::Mode, |plan| plan.steps[0].pushes = Some(PLATE.to_owned()));
    refused(plans::carry(), 2, K::Mode, |plan| plan.steps[1].holds = None);
    refused(plans::carry(), 3, K::Mode, |plan| plan.steps[2].holds = None);
    refused(plans::carry(), 3, K::Mode, |plan| plan.steps[2].primitive = PrimitiveName::BASE_TRANSIT);
    refused(plans::carry(), 2, K::Mode, |plan| plan.steps[1].primitive = PrimitiveName::ARM_RIGID_TRANSFER);
    refused(plans::carry(), 7, K::Mode, |plan| plan.steps[6].holds = plan.steps[5].holds.clone());
    refused(plans::carry(), 7, K::Mode, |plan| plan.steps[6].primitive = PrimitiveName::ARM_RIGID_TRANSFER);
    refused(plans::push(), 2, K::Primitive, |plan| plan.problem.primitives.retain(|p| *p != PrimitiveName::PUSH));
    refused(plans::push(), 2, K::Stray, |plan| {
        plan.steps[1].primitive = PrimitiveName::STRAIGHT_LINE_ARM_TRANSIT;
        plan.steps[1].pushes = None;
    });
}

#[test]
fn a_place_ends_on_a_surface() {
    use RefusalKind as K;
    // Let go 3 cm above the table.
    let high = |plan: &mut PlanFile| {
        let open = plan.steps[5].waypoints.last().unwrap().joints["r_gripper_l_finger_joint"];
        let mut last = plan.steps[5].waypoints[1].clone();
        last.joints.iter_mut().filter(|(name, _)| name.starts_with("r_gripper")).for_each(|(_, q)| *q = open);
        plan.steps[5].waypoints.truncate(2);
        plan.steps[5].waypoints.push(last);
    };
    let refusal = refused(plans::carry(), 6, K::Support, high);
    assert!(refusal.message.contains("above `central table`"), "{refusal}");
    refused(plans::carry(), 0, K::Problem, |plan| plan.problem.objects[0].surfaces = Some(vec!["shelf".to_owned()]));
    // The table is 3 mm higher: the plate starts in it.
    refused(plans::carry(), 0, K::Start, |plan| plan.problem.obstacles[0].at[2] += 0.003);
}
