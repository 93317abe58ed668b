//! The arm of a PR2 among a table and ten boxes, moved by the search that a transit makes when the straight line is blocked.
//! One element is one query, the proof that the way is free between its configurations included. Before the times it prints
//! how many queries were answered, and the median of one.

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
use darrt_benches::boxes::Boxes;

const QUERIES: usize = 400;

fn transit(c: &mut Criterion) {
    let boxes = Boxes::new(QUERIES);
    let mut times_us = Vec::new();
    let mut found = 0;
    for (seed, query) in (0..).zip(&boxes.queries) {
        let begun = Instant::now();
        found += usize::from(black_box(boxes.way(query, seed)).is_some());
        times_us.push(begun.elapsed().as_secs_f64() * 1e6);
    }
    times_us.sort_by(f64::total_cmp);
    let [median, late] = [times_us[QUERIES / 2], times_us[QUERIES * 95 / 100]];
    println!("{found} of {QUERIES} ways found; median {median:.0} us, 95th percentile {late:.0} us");
    let mut group = c.benchmark_group("transit");
    group.sample_size(10);
    group.throughput(Throughput::Elements(QUERIES as u64));
    group.bench_function("table and ten boxes", |b| {
        b.iter(|| (0..).zip(&boxes.queries).filter(|(seed, query)| boxes.way(query, *seed).is_some()).count());
    });
    group.finish();
}

criterion_group!(benches, transit);
criterion_main!(benches);
