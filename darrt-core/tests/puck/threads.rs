//! The same seed gives the same result, bit for bit, however many threads share the work.

use darrt_core::budget::Stop;
use darrt_core::observe::Silent;
use darrt_core::observe::trace::Trace;
use darrt_core::sample::Full;
use darrt_core::search::Strategy;
use darrt_core::solve::{SolveOptions, solve};
use darrt_core::testing::puck::{paper_strategy, problems};

use super::support::{World, greedy, options};

/// Everything about an outcome but the time, printed; floating-point numbers print so that they round-trip.
fn fingerprint(make: fn() -> problems::Ready, strategy: &Strategy<World>, options: &SolveOptions) -> String {
    let problem = make().unwrap();
    let mut o = solve(&problem, strategy, options, &mut Silent);
    o.elapsed = std::time::Duration::ZERO;
    format!("{o:?}")
}

#[test]
fn one_two_and_eight_threads_agree() {
    let paper = paper_strategy().unwrap();
    let full = greedy(Full);
    let cases: [(fn() -> problems::Ready, _, _); 4] = [
        (problems::four_pucks, &paper, options(3, 2000)),
        (problems::graspable, &paper, options(0, 2000)),
        (problems::two_pucks, &paper, SolveOptions { restart_iterations: Some(20), ..options(0, 2000) }),
        // Never solved: the counts of all attempts must agree as well.
        (problems::fig3, &full, options(5, 700)),
    ];
    for (make, strategy, options) in cases {
        let alone = fingerprint(make, strategy, &options);
        for threads in [2, 8] {
            let shared = fingerprint(make, strategy, &SolveOptions { threads, ..options.clone() });
            assert_eq!(alone, shared, "{threads} threads");
        }
    }
}

#[test]
fn another_seed_gives_another_plan() {
    let paper = paper_strategy().unwrap();
    let plans: Vec<String> = (0..3).map(|seed| fingerprint(problems::open, &paper, &options(seed, 2000))).collect();
    assert!(plans[0] != plans[1] && plans[1] != plans[2] && plans[0] != plans[2]);
}

#[test]
fn every_attempt_has_its_own_stream_of_random_numbers() {
    let problem = problems::fig3().unwrap();
    let mut trace = Trace::default();
    let opts = SolveOptions { restart_iterations: Some(30), ..options(0, 60) };
    let outcome = solve(&problem, &greedy(Full), &opts, &mut trace);
    assert_eq!((outcome.stop, outcome.restarts, outcome.iterations), (Stop::IterationLimit, 1, 60));
    let of = |attempt: u32| -> Vec<String> {
        let prefix = format!("Iteration {{ attempt: {attempt},");
        let lines = trace.lines().iter().filter_map(|line| line.strip_prefix(&prefix));
        lines.map(str::to_owned).collect()
    };
    assert_eq!((of(0).len(), of(1).len()), (30, 30));
    assert_ne!(of(0), of(1));
}
