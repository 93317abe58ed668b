//! The verifier on plans made by hand: three right ones, and dozens of ways to make them wrong.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test says what is wrong by panicking")]

#[path = "verify_plans/builder.rs"]
mod builder;
#[path = "verify_plans/plans.rs"]
mod plans;
#[path = "verify_plans/wrong.rs"]
mod wrong;

use darrt_pr2::robot::Pr2;
use darrt_pr2::verify;
use darrt_task::plan_file::PlanFile;
use darrt_task::verify::{VerifyOptions, verify_for};

fn proven(plan: &PlanFile) -> darrt_task::verify::Proof {
    verify(plan).unwrap_or_else(|refusal| panic!("{refusal}"))
}

#[test]
fn right_plans_are_proven() {
    for (plan, steps) in [(plans::push(), 3), (plans::carry(), 7), (plans::wave(), 2)] {
        let proof = proven(&plan);
        assert_eq!(proof.steps, steps);
        assert_eq!(proof.waypoints, plan.steps.iter().map(|step| step.waypoints.len()).sum::<usize>());
        assert!(proof.states > proof.waypoints as u64);
        let nearest = proof.smallest_clearance.unwrap();
        assert!(nearest.distance_m > 0.0 && nearest.step as usize <= steps, "{nearest:?}");
    }
}

#[test]
fn proofs_survive_the_file() {
    for plan in [plans::push(), plans::carry()] {
        let text = plan.to_json().unwrap();
        let back = PlanFile::from_json(&text, "text").unwrap();
        assert_eq!(back, plan);
        assert_eq!(proven(&back), proven(&plan));
    }
}

#[test]
fn a_finer_replay_looks_at_more_states() {
    let plan = plans::push();
    let fine = VerifyOptions { travel_m: 1e-3, ..VerifyOptions::default() };
    let proof = verify_for::<Pr2>(&plan, &fine).unwrap();
    assert!(proof.states > 2 * proven(&plan).states);
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let refusal =
            verify_for::<Pr2>(&plan, &VerifyOptions { travel_m: bad, ..VerifyOptions::default() }).unwrap_err();
        assert!(refusal.to_string().contains("travel_m"), "{refusal}");
    }
}

#[test]
fn grasps_from_above_are_proven() {
    assert_eq!(proven(&plans::lift(&plans::OVERHEAD)).steps, 4);
}
