//! Distances: cost of one call, and what the planner needs with each of them on the puck problems.
//!
//! In the runs to a solution one element is one iteration; how many there were, and how many seeds were solved, is printed.

#![allow(
    clippy::unwrap_used,
    clippy::missing_panics_doc,
    clippy::print_stderr,
    missing_docs,
    unreachable_pub,
    reason = "a benchmark that cannot be set up must stop; the macros of criterion make public functions without docs"
)]

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use darrt_benches::pucks::{DISTANCES, PROBLEMS, SEEDS, run, state, strategy, targets};
use darrt_core::sample::RobotOrObjects;
use darrt_core::testing::puck::problems;

/// One call, with as many pucks as the problem has.
fn cost(c: &mut Criterion) {
    let mut group = c.benchmark_group("distance_variants/cost");
    for (pucks, make) in [(1, problems::open as fn() -> _), (4, problems::four_pucks), (8, problems::eight_pucks)] {
        let problem = make().unwrap();
        let m = problem.domain();
        let pairs: Vec<_> = (0..64).map(|i| state(m, i)).zip(targets(&problem, 64)).collect();
        group.throughput(Throughput::Elements(pairs.len() as u64));
        for (name, distance) in DISTANCES {
            let distance = distance();
            let sum = || pairs.iter().map(|(from, to)| distance.distance(m, from, black_box(to))).sum::<f64>();
            group.bench_function(BenchmarkId::new(name, pucks), |b| b.iter(|| black_box(sum())));
        }
    }
    group.finish();
}

/// Runs over the fixed seeds until solved.
fn to_solution(c: &mut Criterion) {
    let mut group = c.benchmark_group("distance_variants/to_solution");
    group.sample_size(10);
    for (problem_name, make) in PROBLEMS {
        let problem = make().unwrap();
        for (name, variant) in DISTANCES {
            let strategy = strategy(Box::new(RobotOrObjects::new(0.5, 0.0).unwrap()), variant());
            let needed = run(&problem, &strategy);
            eprintln!("{problem_name}, {name}: {}/{SEEDS} solved in {} iterations", needed.solved, needed.iterations);
            group.throughput(Throughput::Elements(needed.iterations));
            group.bench_function(BenchmarkId::new(name, problem_name), |b| {
                b.iter(|| run(black_box(&problem), &strategy));
            });
        }
    }
    group.finish();
}

criterion_group!(benches, cost, to_solution);
criterion_main!(benches);
