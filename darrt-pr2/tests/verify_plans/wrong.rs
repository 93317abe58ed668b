//! Right plans made wrong: each is refused at the right step, for the right reason, with the right bodies.

use std::collections::BTreeMap;

use darrt_pr2::arm::Side;
use darrt_pr2::plan_file::{AllowedContact, ContactReason, PlanFile, Pose, Waypoint};
use darrt_pr2::problem_file::{GoalState, Limits, Obstacle, PrimitiveName, Region, ShapeSpec, Surface, Symmetry};
use darrt_pr2::verify::{Refusal, RefusalKind, verify};
use nalgebra::{Isometry3, UnitQuaternion, Vector3};

use crate::builder::{PLATE, TABLE};
use crate::plans;

/// Edits the plan and checks what is said; `step` 0 means the plan as a whole.
fn refused(mut plan: PlanFile, step: u32, kind: RefusalKind, edit: impl FnOnce(&mut PlanFile)) -> Refusal {
    edit(&mut plan);
    let refusal = verify(&plan).expect_err("the plan is wrong");
    assert_eq!((refusal.step.unwrap_or(0), refusal.kind), (step, kind), "{refusal}");
    assert_eq!(refusal.primitive, refusal.step.map(|step| plan.steps[step as usize - 1].primitive));
    assert!((0.0..=1.0).contains(&refusal.time), "{refusal}");
    refusal
}

/// The bodies are these two, or start like these two, in either order.
fn about(refusal: &Refusal, a: &str, b: &str) {
    let (x, y) = refusal.bodies.as_ref().expect("two bodies");
    let fits = |x: &str, y: &str| x.starts_with(a) && y.starts_with(b);
    assert!(fits(x, y) || fits(y, x), "{refusal}");
}

fn waypoint(plan: &mut PlanFile, step: usize, index: usize) -> &mut Waypoint {
    &mut plan.steps[step - 1].waypoints[index]
}

/// Edits every waypoint from this one on, over the following steps too, so that the chain holds.
fn from_here_on(plan: &mut PlanFile, step: usize, index: usize, edit: impl Fn(&mut Waypoint)) {
    plan.steps[step - 1].waypoints.iter_mut().skip(index).for_each(&edit);
    plan.steps.iter_mut().skip(step).flat_map(|step| &mut step.waypoints).for_each(&edit);
}

fn plate(at: &mut Waypoint) -> &mut Pose {
    at.objects.get_mut(PLATE).unwrap()
}

fn joint<'a>(at: &'a mut Waypoint, name: &str) -> &'a mut f64 {
    at.joints.get_mut(name).unwrap()
}

fn block(name: &str, at: [f64; 3], size: [f64; 3]) -> Obstacle {
    Obstacle {
        name: name.to_owned(),
        shape: ShapeSpec::Box { size },
        at: at.to_vec(),
        standing_on: None,
        yaw: None,
        rpy: None,
        quaternion: None,
    }
}

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
            at.joints.insert("tail_joint".to_owned(), 0.0);
        },
        &|at| *joint(at, "r_gripper_r_finger_tip_joint") += 1e-3,
        &|at| *joint(at, "r_elbow_flex_joint") = f64::NAN,
        &|at| at.base[2] = f64::INFINITY,
        &|at| at.objects = BTreeMap::new(),
        &|at| {
            at.objects.insert("cup".to_owned(), Pose::from(Isometry3::identity()));
        },
        &|at| plate(at).quaternion = [0.0, 0.0, 0.0, 1.01],
    ];
    for edit in edits {
        refused(plans::push(), 2, K::Malformed, |plan| edit(waypoint(plan, 2, 5)));
    }
    refused(plans::push(), 0, K::Malformed, |plan| plan.start.base[0] = f64::NAN);
}

#[test]
fn the_start_is_the_problems() {
    use RefusalKind as K;
    let refusal = refused(plans::push(), 0, K::Start, |plan| plan.problem.objects[0].at[0] += 1e-3);
    assert!(refusal.message.contains("`plate`"), "{refusal}");
    refused(plans::push(), 0, K::Start, |plan| plan.problem.robot.base[2] += 1e-3);
    refused(plans::push(), 0, K::Start, |plan| plan.problem.robot.torso_m = 0.25);
    refused(plans::push(), 0, K::Start, |plan| plan.problem.robot.other_posture = Some("up".to_owned()));
    refused(plans::push(), 0, K::Start, |plan| plan.problem.robot.joints.as_mut().unwrap()[6] += 1e-6);
    let refusal = refused(plans::push(), 0, K::Problem, |plan| plan.problem.objects[0].on = "shelf".to_owned());
    assert!(refusal.message.contains("shelf"), "{refusal}");
    let pillar = block("pillar", [-0.8, 0.0, 1.0], [0.1, 0.1, 1.9]);
    let refusal = refused(plans::push(), 0, K::Collision, |plan| plan.problem.obstacles.push(pillar));
    about(&refusal, "base_link", "pillar");
}

#[test]
fn the_goal_holds_at_the_end() {
    use RefusalKind as K;
    refused(plans::push(), 0, K::Goal, |plan| plan.problem.goal.objects[0].at = Some([-0.2, -0.1]));
    refused(plans::push(), 0, K::Goal, |plan| {
        let goal = &mut plan.problem.goal.objects[0];
        (goal.on, goal.at) = (Some("side table".to_owned()), Some([-2.165, -1.115]));
    });
    refused(plans::push(), 0, K::Goal, |plan| plan.problem.goal.objects[0].state = Some(GoalState::Held));
    refused(plans::carry(), 0, K::Goal, |plan| plan.steps.truncate(5));
    refused(plans::push(), 0, K::Goal, |plan| plan.steps.clear());
    let region = |max: f64| {
        move |plan: &mut PlanFile| {
            let goal = &mut plan.problem.goal.objects[0];
            goal.at = None;
            goal.region = Some(Region { min: [-0.3, -0.4], max: [-0.1, max] });
        }
    };
    refused(plans::push(), 0, K::Goal, region(-0.3));
    let mut plan = plans::push();
    region(-0.2)(&mut plan);
    verify(&plan).unwrap();
    // A goal that is missed beside one that is met: alternatives.
    plan.problem.goal.objects.push(plans::goal_on_table([0.2, 0.2]));
    verify(&plan).unwrap();
}

#[test]
fn obstacles_in_the_way_are_met() {
    use RefusalKind as K;
    let in_the_way = block("brick", [-0.2, -0.3, 0.8], [0.05, 0.05, 0.1]);
    let refusal = refused(plans::push(), 2, K::Collision, |plan| plan.problem.obstacles.push(in_the_way));
    about(&refusal, PLATE, "brick");
    let text = refusal.to_string();
    assert!(text.starts_with("step 2 (Push) at 0.") && text.contains("collide at ("), "{text}");
    let [x, y, z] = refusal.place.unwrap();
    assert!((x + 0.2).abs() < 0.15 && (y + 0.275).abs() < 0.1 && (z - 0.77).abs() < 0.05, "{text}");
    // Thinner than the way between two waypoints, and met only there.
    let wire = block("wire", [-1.3, 0.0, 0.2], [0.002, 0.5, 0.002]);
    let refusal = refused(plans::wave(), 1, K::Collision, |plan| plan.problem.obstacles.push(wire));
    about(&refusal, "base_link", "wire");
    assert!(refusal.time > 0.5, "the hand closes in the first half: {refusal}");
    let beam = block("beam", [-1.9, -0.6, 0.92], [0.8, 0.02, 0.02]);
    let refusal = refused(plans::wave(), 2, K::Collision, |plan| {
        plan.problem.obstacles.push(beam);
        *joint(waypoint(plan, 2, 1), "r_shoulder_lift_joint") = -0.2;
    });
    about(&refusal, "r_", "beam");
    let shelf = block("shelf", [-0.2, -0.45, 0.8], [0.2, 0.1, 0.02]);
    let refusal = refused(plans::carry(), 2, K::Collision, |plan| plan.problem.obstacles.push(shelf));
    about(&refusal, PLATE, "shelf");
}

#[test]
fn the_robot_does_not_meet_itself() {
    let fold = |at: &mut Waypoint| {
        let folded = [0.5, 1.29, -3.7, -2.12, 0.0, -2.0, 0.0];
        let names = ["shoulder_pan", "shoulder_lift", "upper_arm_roll", "elbow_flex", "forearm_roll", "wrist_flex"];
        for (name, value) in names.into_iter().zip(folded) {
            *joint(at, &format!("r_{name}_joint")) = value;
        }
    };
    let refusal = refused(plans::wave(), 2, RefusalKind::Collision, |plan| fold(waypoint(plan, 2, 1)));
    about(&refusal, "r_", "");
    let (a, b) = refusal.bodies.clone().unwrap();
    assert!(a.ends_with("_link") && b.ends_with("_link"), "{refusal}");
}

#[test]
fn contacts_must_be_allowed_and_make_sense() {
    use RefusalKind as K;
    let refusal = refused(plans::push(), 2, K::Collision, |plan| plan.steps[1].allowed_contacts.clear());
    about(&refusal, "r_gripper", PLATE);
    let refusal =
        refused(plans::carry(), 2, K::Collision, |plan| plan.steps[1].allowed_contacts.retain(|c| c.b != PLATE));
    about(&refusal, "r_gripper", PLATE);
    let refusal =
        refused(plans::carry(), 2, K::Collision, |plan| plan.steps[1].allowed_contacts.retain(|c| c.b != TABLE));
    about(&refusal, PLATE, TABLE);
    let contact = |a: &str, b: &str, reason| AllowedContact { a: a.to_owned(), b: b.to_owned(), reason };
    for silly in [
        contact("r_forearm_link", PLATE, ContactReason::Push),
        contact("r_gripper_palm_link", PLATE, ContactReason::Grasp),
        contact("l_gripper_l_finger_tip_link", PLATE, ContactReason::Push),
        contact("r_gripper_l_finger_tip_link", TABLE, ContactReason::Push),
        contact("r_gripper_l_finger_tip_link", "big bowl", ContactReason::Push),
        contact(PLATE, "big bowl", ContactReason::Support),
        contact(PLATE, TABLE, ContactReason::Support),
        contact("nothing", "nowhere", ContactReason::Retreat),
    ] {
        let (a, b) = (silly.a.clone(), silly.b.clone());
        let refusal = refused(plans::push(), 2, K::AllowedContact, |plan| plan.steps[1].allowed_contacts.push(silly));
        about(&refusal, &a, &b);
    }
    let leg = AllowedContact::support(PLATE, "leg near left");
    refused(plans::carry(), 2, K::AllowedContact, |plan| plan.steps[1].allowed_contacts.push(leg));
    let fingers = AllowedContact::fingers(Side::Right, PLATE, ContactReason::Grasp);
    refused(plans::wave(), 2, K::AllowedContact, |plan| {
        plan.steps[1].object = Some(PLATE.to_owned());
        plan.steps[1].allowed_contacts = fingers;
    });
}

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
    let turn = |at: &mut Waypoint| plate(at).quaternion = [0.0, 0.0, 0.01_f64.sin(), 0.01_f64.cos()];
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
    refused(plans::carry(), 3, K::Mode, |plan| plan.steps[2].primitive = PrimitiveName::BaseTransit);
    refused(plans::carry(), 2, K::Mode, |plan| plan.steps[1].primitive = PrimitiveName::ArmRigidTransfer);
    refused(plans::carry(), 7, K::Mode, |plan| plan.steps[6].holds = plan.steps[5].holds.clone());
    refused(plans::carry(), 7, K::Mode, |plan| plan.steps[6].primitive = PrimitiveName::ArmRigidTransfer);
    refused(plans::push(), 2, K::Primitive, |plan| plan.problem.primitives.retain(|p| *p != PrimitiveName::Push));
    refused(plans::push(), 2, K::Stray, |plan| {
        plan.steps[1].primitive = PrimitiveName::StraightLineArmTransit;
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

#[test]
fn straight_lines_are_straight() {
    let bend = |at: &mut Waypoint| *joint(at, "r_wrist_roll_joint") += 0.04;
    let refusal = refused(plans::push(), 1, RefusalKind::StraightLine, |plan| bend(waypoint(plan, 1, 2)));
    assert!(refusal.place.is_some(), "{refusal}");
}

#[test]
fn the_yaw_counts_for_objects_that_are_not_round() {
    let plan = |symmetry, yaw| {
        let mut plan = plans::push();
        plan.problem.objects[0].symmetry = Some(symmetry);
        plan.problem.goal.objects[0].yaw = Some(yaw);
        plan
    };
    verify(&plan(Symmetry::Z, 0.2)).unwrap();
    verify(&plan(Symmetry::None, 0.04)).unwrap();
    refused(plan(Symmetry::None, 0.2), 0, RefusalKind::Goal, |_| ());
}

#[test]
fn objects_do_not_run_into_each_other() {
    let with_saucer = |y: f64| {
        let mut plan = plans::push();
        let mut saucer = plan.problem.objects[0].clone();
        saucer.name = "saucer".to_owned();
        saucer.at = [-0.2, y];
        plan.problem.objects.push(saucer);
        let pose = Pose { position: [-0.2, y, 0.76], quaternion: [0.0, 0.0, 0.0, 1.0] };
        let waypoints = plan.steps.iter_mut().flat_map(|step| &mut step.waypoints);
        for at in waypoints.chain([&mut plan.start]) {
            at.objects.insert("saucer".to_owned(), pose);
        }
        plan
    };
    // Both radii are 0.14; the push ends at y = -0.25.
    verify(&with_saucer(-0.54)).unwrap();
    let refusal = refused(with_saucer(-0.52), 2, RefusalKind::Collision, |_| ());
    about(&refusal, PLATE, "saucer");
    assert!(refusal.time > 0.9, "{refusal}");
    refused(with_saucer(-0.54), 2, RefusalKind::Stray, |plan| {
        from_here_on(plan, 2, 9, |at| at.objects.get_mut("saucer").unwrap().position[1] -= 0.01);
    });
}
