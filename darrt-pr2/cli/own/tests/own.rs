//! What the built-in primitives, costs and samplers can do, a user's can.

#![allow(clippy::unwrap_used)]

use darrt_core::budget::Cancel;
use darrt_core::observe::Silent;
use darrt_pr2::robot::Pr2;
use darrt_task::picture::{Extent, Story, draw};
use darrt_task::plan_file::PlanFile;
use darrt_task::planning::{PlanRequest, PlanResult, plan};
use darrt_task::problem_file::{CostName, PrimitiveName, ProblemFile, SamplerName};
use darrt_task::verify::{VerifyOptions, verify_for};

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

#[test]
fn a_plan_that_pulls_without_touching_is_refused() {
    let mut found = planned(&PlanRequest::new(problem(), 0)).plan.unwrap();
    let contract = found.contracts.get_mut(&PrimitiveName::new("Pull")).unwrap();
    contract.fingers_touch = false;
    let refusal = verify_for::<Pr2>(&found, &VerifyOptions::default()).unwrap_err();
    assert!(refusal.message.contains("without being touched"), "{refusal}");
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
