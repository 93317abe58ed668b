//! EXTENDTOWARDS on Plate3: targets as the planner draws them, from the start and from nodes of a grown tree. One element
//! is one extension. Before the times it prints the median of a whole iteration over whole searches.

#![allow(
    clippy::unwrap_used,
    clippy::missing_panics_doc,
    clippy::print_stdout,
    missing_docs,
    unreachable_pub,
    reason = "a benchmark that cannot be set up must stop; the macros of criterion make public functions without docs"
)]

use std::hint::black_box;
use std::time::Instant;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use darrt_benches::room::{grown, prepared};
use darrt_benches::stream;
use darrt_core::budget::Interrupt;
use darrt_core::extend::Extender;
use darrt_core::search::Darrt;

const COUNT: u64 = 64;

/// Searches that are timed iteration by iteration.
const SEARCHES: u64 = 20;

/// Every iteration of whole searches, the one that reaches the goal apart, as it also proves a plan. An iteration draws a
/// sample, looks for the nearest node and extends it, so an extension takes less.
fn whole_searches() {
    let (prepared, strategy) = prepared();
    let mut times_us = Vec::new();
    for seed in 0..SEARCHES {
        let mut darrt = Darrt::new(&prepared.problem, &strategy, seed, 0, usize::MAX);
        loop {
            let begun = Instant::now();
            let step = darrt.step();
            let time_us = begun.elapsed().as_secs_f64() * 1e6;
            if step.solution.is_some() {
                break;
            }
            if step.withdrawn.is_none() && step.refusal.is_none() {
                times_us.push(time_us);
            }
        }
    }
    times_us.sort_by(f64::total_cmp);
    let [median, late] = [50, 95].map(|percent| times_us[times_us.len() * percent / 100]);
    let mean = times_us.iter().sum::<f64>() / times_us.len() as f64;
    println!(
        "{} iterations of {SEARCHES} searches: median {median:.0} us, mean {mean:.0} us, 95th percentile {late:.0} us",
        times_us.len()
    );
}

fn extend(c: &mut Criterion) {
    whole_searches();
    let (prepared, strategy) = prepared();
    let problem = &prepared.problem;
    let draw = |i| strategy.sampler.sample(problem.domain(), problem.goal(), &mut stream(i));
    let targets: Vec<_> = (0..COUNT).map(draw).collect();
    let nodes = grown(&prepared, &strategy, 100, 64);
    let (options, local_repair) = (&strategy.extend, strategy.local_repair.as_deref());
    let extender = Extender { problem, options, local_repair, interrupt: Interrupt::NEVER };
    let mut group = c.benchmark_group("extend");
    group.sample_size(20);
    group.throughput(Throughput::Elements(COUNT));
    for (name, from) in [("from the start", std::slice::from_ref(problem.start())), ("from a grown tree", &nodes)] {
        group.bench_function(name, |b| {
            b.iter(|| {
                for ((i, to), from) in (0..COUNT).zip(&targets).zip(from.iter().cycle()) {
                    let rng = &mut stream(COUNT + i);
                    black_box(extender.extend(from, to, rng).reached.len());
                }
            });
        });
    }
    group.finish();
}

criterion_group!(benches, extend);
criterion_main!(benches);
