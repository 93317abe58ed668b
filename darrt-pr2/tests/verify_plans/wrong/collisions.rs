//! Bodies in the way, and contacts that nobody may allow.

use darrt_pr2::verify;
use darrt_task::plan_file::{AllowedContact, ContactReason, Pose, Waypoint};
use darrt_task::verify::RefusalKind;

use super::{about, block, from_here_on, joint, refused, waypoint};
use crate::verify_plans::builder::{PLATE, TABLE, finger_links};
use crate::verify_plans::plans;

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
    let (a, b) = *refusal.bodies.clone().unwrap();
    assert!(a.ends_with("_link") && b.ends_with("_link"), "{refusal}");
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
            at.objects.insert("saucer".into(), pose);
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
    let fingers = AllowedContact::fingers(&finger_links(), PLATE, ContactReason::Grasp);
    refused(plans::wave(), 2, K::AllowedContact, |plan| {
        plan.steps[1].object = Some(PLATE.to_owned());
        plan.steps[1].allowed_contacts = fingers;
    });
}
