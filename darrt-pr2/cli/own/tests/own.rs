//! What the built-in primitives, costs and samplers can do, a user's can.

#![allow(clippy::unwrap_used)]

use std::cell::Cell;

use darrt_core::budget::Cancel;
use darrt_core::laws::{MotionClaims, PrimitiveClaims, Tried, try_primitive};
use darrt_core::observe::Silent;
use darrt_core::testing::strategies::{config, looks, seen, tasks_from};
use darrt_own::pull::{Pull, PullSettings};
use darrt_pr2::robot::Pr2;
use darrt_primitives::laws::{TabletopClaims, body_travel, check_contracts, check_finger_contacts, check_tabletop};
use darrt_primitives::testing::strategies::resting;
use darrt_task::laws::check_task_primitive;
use darrt_task::picture::{Extent, Story, draw};
use darrt_task::plan_file::PlanFile;
use darrt_task::planning::{PlanRequest, PlanResult, plan, prepare};
use darrt_task::problem_file::{CostName, PrimitiveName, ProblemFile, SamplerName};
use darrt_task::registry::TaskPrimitive;
use darrt_task::verify::{VerifyOptions, verify_for};
use proptest::proptest;

fn problem() -> ProblemFile {
    ProblemFile::from_toml(include_str!("../pull.toml"), "pull.toml").unwrap()
}

fn planned(request: &PlanRequest) -> PlanResult {
    plan(&darrt_own::registry(), request, &Cancel::new(), &mut Silent).unwrap()
}

#[test]
fn a_plan_with_a_primitive_of_ones_own_is_found_written_judged_and_drawn() {
    for seed in 0..3 {
        let result = planned(&PlanRequest::new(problem(), seed));
        let found = result.plan.unwrap();
        let pulls = |plan: &PlanFile| plan.steps.iter().filter(|step| step.primitive.as_str() == "Pull").count();
        assert!(pulls(&found) > 0);
        assert!(result.accounts.rows().any(|(name, _)| name == "Pull"), "it is counted");
        // From the file alone, by a program that has never heard of it.
        let read = PlanFile::from_json(&found.to_json().unwrap(), "pull.plan.json").unwrap();
        let proof = verify_for::<Pr2>(&read, &VerifyOptions::default()).unwrap();
        assert_eq!(proof.steps, read.steps.len());
        let story = Story::of_plan(&read, &darrt_pr2::facts(&read.problem).unwrap()).unwrap();
        assert!(draw(&story, Extent::Whole).contains("Pull"));
    }
}

/// A primitive of one's own is short: without comments and empty lines it takes no more than this.
#[test]
fn pull_takes_sixty_lines() {
    let lines = include_str!("../src/pull.rs").lines().map(str::trim);
    let count = lines.filter(|line| !line.is_empty() && !line.starts_with("//")).count();
    assert!(count <= 60, "{count}");
}

#[test]
fn a_plan_that_pulls_without_touching_is_refused() {
    let mut found = planned(&PlanRequest::new(problem(), 0)).plan.unwrap();
    let contract = found.contracts.get_mut(&PrimitiveName::new("Pull")).unwrap();
    contract.fingers_touch = false;
    let refusal = verify_for::<Pr2>(&found, &VerifyOptions::default()).unwrap_err();
    assert!(refusal.message.contains("without being touched"), "{refusal}");
}

/// The kit that ours are held to, from all kinds of states with an empty hand.
#[test]
fn pull_keeps_the_laws() {
    let registry = darrt_own::registry();
    let prepared = prepare(&registry, &problem()).unwrap().problem;
    let m = prepared.domain();
    let (id, _) = registry.allowed(&problem()).find(|(id, _)| id.name() == "Pull").unwrap();
    let pull = <Pull as TaskPrimitive<Pr2>>::new(id, PullSettings::default()).unwrap();
    check_task_primitive::<Pr2, Pull>().unwrap();
    // Along a line the hand may leave it by some millimetres between two knots, and turn by a few hundredths of a radian.
    let claims = TabletopClaims { knot: 1e-6, bow: 0.05, touch_m: 0.005, slack_m: 1e-7, looks: 16 };
    let succeeded = seen(5, || {
        let count = Cell::new(0);
        proptest!(config(192, None), |((from, to, seed) in tasks_from(m, resting(m)), ts in looks())| {
            let motion = MotionClaims { travel: &body_travel, looks: 16, ..MotionClaims::default() };
            let tried = PrimitiveClaims { ts: &ts, motion, max_instances: 8, ..PrimitiveClaims::default() };
            if let Tried::Propagated(instances) = try_primitive(m, &pull, &from, &to, seed, &tried)? {
                count.set(count.get() + 1);
                check_tabletop(m, &instances, &from, &ts, &claims)?;
                check_contracts(m, &[(id, <Pull as TaskPrimitive<Pr2>>::CONTRACT)], &instances, &from, &ts, &claims)?;
                check_finger_contacts(m, prepared.validity(), &instances, &from, &ts)?;
            }
        });
        count.get()
    });
    assert!(succeeded >= 5, "{succeeded} succeeded");
}

#[test]
fn its_settings_are_checked_with_the_nearest_name() {
    let said = |from: &str, to: &str| {
        let text = include_str!("../pull.toml").replacen(from, to, 1);
        let problem = ProblemFile::from_toml(&text, "pull.toml").unwrap();
        darrt_own::registry().check(&problem, "pull.toml").unwrap_err().to_string()
    };
    let message = said("ahead_m = 0.3", "ahaed_m = 0.3");
    assert!(message.contains("`primitive.Pull`") && message.contains("did you mean `ahead_m`?"), "{message}");
    let message = said("ahead_m = 0.3", "ahead_m = 3");
    assert!(message.contains("`ahead_m` is 3, must be in [0, 2]"), "{message}");
    let message = said("\"Pull\"", "\"Pul\"");
    assert!(message.contains("`primitives[7]`") && message.contains("did you mean `Pull`?"), "{message}");
}

#[test]
fn a_cost_and_a_sampler_of_ones_own_are_used() {
    let request = PlanRequest { cost: CostName::new("gentle"), ..PlanRequest::new(problem(), 1) };
    let gentle = planned(&request);
    let usual = planned(&PlanRequest::new(problem(), 1));
    assert!(gentle.plan.is_some() && gentle.execution_s > usual.execution_s, "what carries counts twice");
    let sampler = SamplerName::new("mostly-objects");
    let result = planned(&PlanRequest { sampler: Some(sampler.clone()), ..PlanRequest::new(problem(), 1) });
    assert_eq!(result.plan.unwrap().planner.sampler, sampler);
}
