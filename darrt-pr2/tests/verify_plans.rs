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

/// The quick verdict is the plain one, over right plans and over those of other kinds of fault.
#[test]
fn the_quick_verdict_is_the_plain_one() {
    let breaks: [fn(&mut PlanFile); 5] = [
        |_| {},
        // Into the table, and away from where the step before ended.
        |plan| plan.steps[0].waypoints.iter_mut().for_each(|at| at.base[0] += 0.4),
        |plan| plan.steps[1].waypoints.iter_mut().for_each(|at| at.base[0] += 1e-3),
        |plan| {
            let last = plan.steps.len() - 1;
            plan.steps[last].waypoints.iter_mut().for_each(|at| at.base[2] += 0.3);
        },
        |plan| plan.problem.safety.least_margin_m = 0.019,
    ];
    let plain = VerifyOptions { is_plain: true, travel_m: 0.02, ..VerifyOptions::default() };
    let quick = VerifyOptions { is_plain: false, ..plain.clone() };
    for make in [plans::push, plans::carry] {
        for change in breaks {
            let mut plan = make();
            change(&mut plan);
            let verdict = |options| verify_for::<Pr2>(&plan, options).map_err(|refusal| (refusal.step, refusal.kind));
            let (plain, quick) = (verdict(&plain), verdict(&quick));
            assert_eq!(plain.as_ref().err(), quick.as_ref().err());
            let clearance = |proof: darrt_task::verify::Proof| proof.smallest_clearance.map(|found| found.distance_m);
            let (plain, quick) = (plain.ok().and_then(clearance), quick.ok().and_then(clearance));
            // The quick one knows the smallest clearance to within a half.
            assert!(plain.zip(quick).is_none_or(|(a, b)| a <= b + 1e-6 && b <= 2.0 * a + 1e-6), "{plain:?} {quick:?}");
        }
    }
}
