//! EXTENDTOWARDS on Plate3: targets as the planner draws them, from the start and from nodes of a grown tree. One element
//! is one extension.

#![allow(
    clippy::unwrap_used,
    clippy::missing_panics_doc,
    missing_docs,
    unreachable_pub,
    reason = "a benchmark that cannot be set up must stop; the macros of criterion make public functions without docs"
)]

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use darrt_benches::room::{grown, prepared};
use darrt_benches::stream;
use darrt_core::budget::Interrupt;
use darrt_core::extend::Extender;

const COUNT: u64 = 64;

fn extend(c: &mut Criterion) {
    let (prepared, strategy) = prepared();
    let problem = &prepared.problem;
    let draw = |i| strategy.sampler.sample(problem.domain(), problem.goal(), &mut stream(i));
    let targets: Vec<_> = (0..COUNT).map(draw).collect();
    let nodes = grown(&prepared, &strategy, 100, 64);
    let (options, reroute) = (&strategy.extend, strategy.reroute.as_deref());
    let extender = Extender { problem, options, reroute, interrupt: Interrupt::NEVER };
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
