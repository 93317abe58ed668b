//! Whole iterations of Algorithm 1: their cost against the size of the tree, and their rate on one and on two threads.
//!
//! One element is one iteration. The trees of the puck domain are grown by the planner towards a goal that nothing reaches; to
//! grow a million nodes takes minutes.

#![allow(
    clippy::unwrap_used,
    clippy::missing_panics_doc,
    clippy::print_stderr,
    missing_docs,
    unreachable_pub,
    reason = "a benchmark that cannot be set up must stop; the macros of criterion make public functions without docs"
)]

use std::hint::black_box;
use std::time::{Duration, Instant};

use criterion::{BenchmarkId, Criterion, SamplingMode, Throughput, criterion_group, criterion_main};
use darrt_benches::pucks;
use darrt_benches::room::prepared;
use darrt_core::budget::Budget;
use darrt_core::domain::Domain;
use darrt_core::observe::Silent;
use darrt_core::problem::Problem;
use darrt_core::search::{Darrt, Strategy};
use darrt_core::solve::{SolveOptions, solve};
use darrt_core::testing::puck::paper_strategy;

/// Iterations of one measurement.
const ITERATIONS: u64 = 50;

/// Iterations that go on from a tree of so many nodes, and of no more than a quarter more.
fn sizes<D: Domain>(c: &mut Criterion, name: &str, problem: &Problem<D>, strategy: &Strategy<D>, sizes: &[usize]) {
    let mut group = c.benchmark_group(format!("iterate/{name}"));
    group.sample_size(10).sampling_mode(SamplingMode::Flat).throughput(Throughput::Elements(ITERATIONS));
    for size in sizes {
        let grown = || {
            let mut darrt = Darrt::new(problem, strategy, 1, 0, usize::MAX);
            while darrt.tree().len() < *size {
                darrt.step();
            }
            darrt
        };
        let mut darrt = grown();
        eprintln!("{name}, {size}: {} nodes after {} iterations", darrt.tree().len(), darrt.iteration());
        group.bench_function(BenchmarkId::from_parameter(size), |b| {
            b.iter_custom(|count| {
                let mut time = Duration::ZERO;
                for _ in 0..count {
                    if 4 * darrt.tree().len() > 5 * size {
                        darrt = grown();
                    }
                    let start = Instant::now();
                    (0..ITERATIONS).for_each(|_| drop(black_box(darrt.step())));
                    time += start.elapsed();
                }
                time
            });
        });
    }
    group.finish();
}

fn size_of_the_tree(c: &mut Criterion) {
    let puck = pucks::unreachable();
    // Without a penalty the same few placements are asked again and again, and thousands of nodes are equally near.
    let strategy = Strategy { try_penalty_m: 0.1, ..paper_strategy().unwrap() };
    sizes(c, "puck", &puck, &strategy, &[1_000, 10_000, 100_000, 1_000_000]);
    let (prepared, strategy) = prepared();
    sizes(c, "PR2", &prepared.problem, &strategy, &[1_000, 10_000]);
}

/// Independent attempts of a problem that is not solved within its budget.
fn threads(c: &mut Criterion) {
    let puck = pucks::unreachable();
    let strategy = paper_strategy().unwrap();
    let mut group = c.benchmark_group("iterate/threads");
    let (each, attempts) = (50, 16);
    group.sample_size(10).measurement_time(Duration::from_secs(10)).throughput(Throughput::Elements(each * attempts));
    for threads in [1, 2] {
        let options = SolveOptions {
            seed: 1,
            budget: Budget { iterations: Some(each * attempts), ..Budget::default() },
            restart_iterations: Some(each),
            threads,
        };
        group.bench_function(BenchmarkId::new("puck", threads), |b| {
            b.iter(|| {
                let outcome = solve(&puck, &strategy, &options, &mut Silent);
                assert_eq!(outcome.iterations, each * attempts);
                outcome.accounts.extensions
            });
        });
    }
    group.finish();
}

criterion_group!(benches, size_of_the_tree, threads);
criterion_main!(benches);
