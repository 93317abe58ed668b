//! Problems that read: refused by the planner with a reason, or a few iterations go without panic and balance.
#![no_main]

use darrt_core::laws::check_accounts;
use darrt_core::search::Darrt;
use darrt_core::shorten::ShortenOptions;
use darrt_fuzz::text::text;
use darrt_pr2::problems::builtin_text;
use darrt_task::planning::{PlanRequest, prepare, strategy};
use darrt_task::problem_file::{ProblemFile, ShapeSpec};
use libfuzzer_sys::fuzz_target;

const ITERATIONS: u64 = 4;

fuzz_target!(|data: &[u8]| {
    let bases = ["simple-plate", "plate3", "bowl"].map(|name| builtin_text(name).expect("a built-in problem"));
    let Ok(file) = ProblemFile::from_toml(&text(data, &bases), "fuzz.toml") else { return };
    let mut shapes = file.obstacles.iter().map(|o| &o.shape).chain(file.objects.iter().map(|o| &o.shape));
    if file.robot.urdf.is_some() || shapes.any(|shape| matches!(shape, ShapeSpec::Mesh { .. })) {
        return;
    }
    let Ok(prepared) = prepare(&darrt_pr2::registry(), &file) else { return };
    let Ok(mut strategy) = strategy(&darrt_pr2::registry(), &PlanRequest::new(file.clone(), 0)) else { return };
    // Hundreds of extensions more once a plan is found, and further trees.
    strategy.shorten = ShortenOptions::default();
    strategy.improve = None;
    let mut darrt = Darrt::new(&prepared.problem, &strategy, data.len() as u64, 0, 10_000);
    for _ in 0..ITERATIONS {
        let step = darrt.step();
        if step.solution.is_some() || step.stop.is_some() {
            break;
        }
    }
    let added = darrt.tree().len() as u64 - 1;
    check_accounts(darrt.accounts(), darrt.iteration(), added).unwrap_or_else(|broken| panic!("{broken}"));
});
