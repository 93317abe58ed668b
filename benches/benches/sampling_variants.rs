//! Ways of sampling: cost of one sample, and what the planner needs with each of them on the puck problems.
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
use darrt_benches::pucks::{PROBLEMS, SAMPLERS, SEEDS, run, strategy};
use darrt_benches::stream;
use darrt_core::distance::GreedyVisit;
use darrt_core::testing::puck::problems;

/// One sample of the problem with four pucks.
fn cost(c: &mut Criterion) {
    let problem = problems::four_pucks().unwrap();
    let mut group = c.benchmark_group("sampling_variants/cost");
    for (name, sampler) in SAMPLERS {
        let sampler = sampler();
        let rng = &mut stream(0);
        group.bench_function(name, |b| b.iter(|| black_box(sampler.sample(problem.domain(), problem.goal(), rng))));
    }
    group.finish();
}

/// Runs over the fixed seeds until solved.
fn to_solution(c: &mut Criterion) {
    let mut group = c.benchmark_group("sampling_variants/to_solution");
    group.sample_size(10);
    for (problem_name, make) in PROBLEMS {
        let problem = make().unwrap();
        for (name, variant) in SAMPLERS {
            let strategy = strategy(variant(), Box::new(GreedyVisit));
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
