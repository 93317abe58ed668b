//! Hands that cannot hold what they have closed on.

use darrt_pr2::verify;
use darrt_task::plan_file::PlanFile;
use darrt_task::problem_file::Object;
use darrt_task::verify::RefusalKind;

use super::refused;
use crate::verify_plans::plans::{self, PICK_PLATE};

/// What is said about the grasp of the carried plate after an edit of the plate.
fn said(edit: impl FnOnce(&mut Object)) -> String {
    refused(plans::carry(), 2, RefusalKind::Hold, |plan| edit(&mut plan.problem.objects[0])).message.to_string()
}

#[test]
fn hands_that_are_not_flush_with_the_rim_do_not_hold() {
    for (lift, degrees) in plans::TILTED.iter().zip(["30.0", "45.0"]) {
        let refusal = refused(plans::lift(lift), 2, RefusalKind::Hold, |_| ());
        assert!(refusal.message.contains(&format!("{degrees} degrees from flush with it, at most 1.0")), "{refusal}");
    }
}

#[test]
fn heavy_and_slippery_plates_are_not_held() {
    assert!(said(|plate| plate.mass_kg = 50.0).contains("it weighs 50 kg, the arm carries 1.8"));
    let heavy = said(|plate| plate.mass_kg = 0.6);
    // 1.5 x 0.6 x 9.81 x 0.118 N m on half of 36 mm: 57.9 N, to what feeling out the pads may be off.
    let needs = heavy.split("less than ").nth(1).and_then(|tail| tail.split(' ').next()).unwrap();
    assert!(heavy.contains("tips out of the pads") && (needs.parse::<f64>().unwrap() - 57.9).abs() < 0.6, "{heavy}");
    assert!(said(|plate| plate.friction.fingers = 0.0).contains("no friction"));
    assert!(said(|plate| plate.friction.fingers = 0.06).contains("slips out with less than 61.3 N"));
}

#[test]
fn the_pads_must_lie_on_enough_of_the_rim() {
    let [x, y] = PICK_PLATE;
    // The fingertips 0.03 m inside the rim instead of 0.04 m.
    let refusal = refused(plans::carry_of([x, y + 0.01], |_| ()), 2, RefusalKind::Hold, |_| ());
    assert!(refusal.message.contains("tips out of the pads"), "{refusal}");
}

#[test]
fn a_plate_that_leans_turns_between_the_pads() {
    // By 10 degrees about the axis of the hand.
    let rolled = || plans::carry_of(PICK_PLATE, |arm| arm[6] += 0.175);
    verify(&rolled()).unwrap();
    let slippery = |plan: &mut PlanFile| plan.problem.objects[0].friction.fingers = 0.09;
    let refusal = refused(rolled(), 4, RefusalKind::Hold, slippery);
    assert!(refusal.message.contains("it turns between the pads as it leans"), "{refusal}");
    let mut level = plans::carry();
    slippery(&mut level);
    verify(&level).unwrap();
}
