//! Searches: what each needs on the puck problems, with the strategy of the paper.
//!
//! One element is one iteration, that is, one extension; how many there were, and how many seeds were solved, is printed.

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
use darrt_benches::pucks::{PROBLEMS, SEEDS, run_by};
use darrt_core::search::Algorithm;
use darrt_core::testing::puck::paper_strategy;

fn to_solution(c: &mut Criterion) {
    let mut group = c.benchmark_group("search_variants/to_solution");
    group.sample_size(10);
    let strategy = paper_strategy().unwrap();
    for (problem_name, make) in PROBLEMS {
        let problem = make().unwrap();
        for algorithm in Algorithm::ALL {
            let needed = run_by(algorithm, &problem, &strategy);
            eprintln!(
                "{problem_name}, {algorithm}: {}/{SEEDS} solved in {} iterations",
                needed.solved, needed.iterations
            );
            group.throughput(Throughput::Elements(needed.iterations));
            group.bench_function(BenchmarkId::new(algorithm.name(), problem_name), |b| {
                b.iter(|| run_by(algorithm, black_box(&problem), &strategy));
            });
        }
    }
    group.finish();
}

criterion_group!(benches, to_solution);
criterion_main!(benches);
