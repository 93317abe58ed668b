//! Plans that read: proven or refused, without panic and in bounded time.
#![no_main]

use darrt_fuzz::text::text;
use darrt_pr2::verify;
use darrt_task::plan_file::PlanFile;
use darrt_task::problem_file::ShapeSpec;
use libfuzzer_sys::fuzz_target;

const WAVE: &str = include_str!("../seeds/plan_reader/wave.json");
const PUSH: &str = include_str!("../seeds/plan_verifier/push.json");

fuzz_target!(|data: &[u8]| {
    let Ok(plan) = PlanFile::from_json(&text(data, &[WAVE, PUSH]), "fuzz.json") else { return };
    let problem = &plan.problem;
    let mut shapes = problem.obstacles.iter().map(|o| &o.shape).chain(problem.objects.iter().map(|o| &o.shape));
    // Files that a fuzzed text names are not opened.
    if problem.robot.urdf.is_some() || shapes.any(|shape| matches!(shape, ShapeSpec::Mesh { .. })) {
        return;
    }
    match verify(&plan) {
        Ok(proof) => assert_eq!(proof.steps, plan.steps.len()),
        Err(refusal) => assert!(!refusal.to_string().is_empty()),
    }
});
