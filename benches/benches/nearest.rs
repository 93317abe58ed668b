//! The node nearest to a target over trees of 10^2 to 10^6 random nodes: one puck, four pucks, and the PR2 with a plate. One
//! element is one node of the tree, looked at or not. `linear` is the reference: every node is measured.

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
use darrt_benches::room::prepared;
use darrt_benches::trees;
use darrt_core::distance::{Distance, GreedyVisit};
use darrt_core::domain::Domain;
use darrt_core::nearest::linear::nearest_by;
use darrt_core::partial::PartialState;
use darrt_core::testing::puck::problems;
use darrt_core::tree::Tree;

const SIZES: [u64; 5] = [100, 1_000, 10_000, 100_000, 1_000_000];

/// Every distance, four pucks.
fn variants(c: &mut Criterion) {
    let problem = problems::four_pucks().unwrap();
    let m = problem.domain();
    let targets = targets(&problem, 64);
    let mut group = c.benchmark_group("nearest/four pucks");
    group.sample_size(20);
    for size in [1_000, 100_000] {
        let tree = tree(m, size);
        group.throughput(Throughput::Elements(size));
        for (name, distance) in DISTANCES {
            let distance = distance();
            let mut next = targets.iter().cycle();
            group.bench_function(BenchmarkId::new(name, size), |b| {
                b.iter(|| next.next().and_then(|to| black_box(distance.nearest(m, &tree, black_box(to)))));
            });
        }
    }
    group.finish();
}

/// The greedy distance with one object against the size of the tree.
fn sizes<D: Domain>(
    c: &mut Criterion,
    name: &str,
    m: &D,
    tree_of: impl Fn(u64) -> Tree<D>,
    targets: &[PartialState<D>],
) {
    let mut group = c.benchmark_group(format!("nearest/{name}"));
    group.sample_size(20);
    for size in SIZES {
        let tree = tree_of(size);
        group.throughput(Throughput::Elements(size));
        let mut next = targets.iter().cycle();
        group.bench_function(BenchmarkId::new("pruned", size), |b| {
            b.iter(|| next.next().and_then(|to| black_box(GreedyVisit.nearest(m, &tree, black_box(to)))));
        });
        if size > 100_000 {
            continue;
        }
        group.bench_function(BenchmarkId::new("linear", size), |b| {
            b.iter(|| {
                let to = next.next()?;
                black_box(nearest_by(&tree, |state| GreedyVisit.distance(m, state, black_box(to))))
            });
        });
    }
    group.finish();
}

fn one_object(c: &mut Criterion) {
    let problem = problems::open().unwrap();
    let m = problem.domain();
    let all = targets(&problem, 256);
    let (objects, robots): (Vec<_>, Vec<_>) = all.into_iter().partition(|to| to.robot().is_none());
    sizes(c, "puck, targets of the object", m, |size| tree(m, size), &objects);
    sizes(c, "puck, targets of the robot", m, |size| tree(m, size), &robots);

    let (prepared, strategy) = prepared();
    let problem = &prepared.problem;
    let m = problem.domain();
    let all = trees::targets(problem, &strategy, 256);
    let (objects, robots): (Vec<_>, Vec<_>) = all.into_iter().partition(|to| to.robot().is_none());
    let random = |size| trees::random(m, problem.start(), size);
    sizes(c, "PR2, targets of the plate", m, random, &objects);
    sizes(c, "PR2, targets of the robot", m, random, &robots);
}

criterion_group!(benches, variants, one_object);
criterion_main!(benches);
