//! The node nearest to a target over trees of 10^2 to 10^5 nodes, four pucks. One element is one node looked at.

#![allow(
    clippy::unwrap_used,
    clippy::missing_panics_doc,
    missing_docs,
    unreachable_pub,
    reason = "a benchmark that cannot be set up must stop; the macros of criterion make public functions without docs"
)]

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use darrt_benches::pucks::{DISTANCES, targets, tree};
use darrt_core::testing::puck::problems;

fn nearest(c: &mut Criterion) {
    let problem = problems::four_pucks().unwrap();
    let m = problem.domain();
    let targets = targets(&problem, 64);
    let mut group = c.benchmark_group("nearest");
    group.sample_size(20);
    for size in [100, 1_000, 10_000, 100_000] {
        let tree = tree(m, size);
        group.throughput(Throughput::Elements(size));
        for (name, distance) in DISTANCES {
            // One call takes longer than a whole sample should.
            if name == "exact tour" && size > 10_000 {
                continue;
            }
            let distance = distance();
            let mut next = targets.iter().cycle();
            group.bench_function(BenchmarkId::new(format!("linear, {name}"), size), |b| {
                b.iter(|| next.next().and_then(|to| black_box(distance.nearest(m, &tree, black_box(to)))));
            });
        }
    }
    group.finish();
}

criterion_group!(benches, nearest);
criterion_main!(benches);
