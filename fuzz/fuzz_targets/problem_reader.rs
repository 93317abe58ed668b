//! Problem files: refused, or complete; what is written reads back as the same problem, and the geometry can be built.
#![no_main]

use darrt_fuzz::text::text;
use darrt_pr2::problems::builtin_text;
use darrt_task::problem_file::{ProblemFile, ShapeSpec};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let bases = ["simple-plate", "plate3", "bowl"].map(|name| builtin_text(name).expect("a built-in problem"));
    let Ok(problem) = ProblemFile::from_toml(&text(data, &bases), "fuzz.toml") else { return };

    let toml = problem.to_toml().expect("a problem from TOML fits into TOML");
    let again = ProblemFile::from_toml(&toml, "again.toml").unwrap_or_else(|error| panic!("{error}\n{toml}"));
    assert_eq!(again, problem);
    let json = serde_json::to_string(&problem).expect("finite numbers");
    let again: ProblemFile = serde_json::from_str(&json).unwrap_or_else(|error| panic!("{error}\n{json}"));
    assert_eq!(again, problem);

    // Files that a fuzzed text names are not opened.
    let mut shapes = problem.obstacles.iter().map(|o| &o.shape).chain(problem.objects.iter().map(|o| &o.shape));
    if !shapes.any(|shape| matches!(shape, ShapeSpec::Mesh { .. })) {
        let _ = problem.geometry();
    }
});
