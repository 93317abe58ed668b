//! The PR2's right arm: forward chain, closed-form inverse, inverse near a configuration. One element is one call.

#![allow(
    clippy::unwrap_used,
    clippy::missing_panics_doc,
    missing_docs,
    unreachable_pub,
    reason = "a benchmark that cannot be set up must stop; the macros of criterion make public functions without docs"
)]

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use darrt_benches::arm::{TORSO_M, configurations, poses, right_arm};
use darrt_benches::stream;
use darrt_pr2::arm::{Side, Solutions};
use darrt_pr2::forward::{ArmChain, ArmPoses};

const COUNT: u64 = 256;

fn kinematics(c: &mut Criterion) {
    let arm = right_arm();
    let all = configurations(&arm, COUNT);
    let reached = poses(&arm, &all);
    let mut group = c.benchmark_group("kinematics");
    group.throughput(Throughput::Elements(COUNT));

    let chain = ArmChain::new(Side::Right, TORSO_M);
    group.bench_function("forward, tool only", |b| {
        b.iter(|| all.iter().map(|q| chain.base_from_tool(black_box(q)).translation.x).sum::<f64>());
    });
    let mut links = ArmPoses::default();
    group.bench_function("forward, all links", |b| {
        b.iter(|| all.iter().for_each(|q| chain.world_from_links(&[0.1, 0.2, 0.3], black_box(q), 0.2, &mut links)));
    });
    let mut solutions = Solutions::new();
    group.bench_function("inverse for one roll", |b| {
        b.iter(|| {
            for (pose, q) in reached.iter().zip(&all) {
                arm.inverse(black_box(pose), q[2], &mut solutions);
                black_box(solutions.len());
            }
        });
    });
    group.bench_function("inverse_any", |b| {
        let rng = &mut stream(0);
        b.iter(|| reached.iter().filter(|pose| arm.inverse_any(black_box(pose), rng).is_some()).count());
    });
    // From a configuration nearby, as when a line of the hand is followed.
    let near: Vec<_> = all.iter().map(|q| q.map(|angle| angle + 0.05)).collect();
    group.bench_function("inverse_near", |b| {
        b.iter(|| {
            let pairs = reached.iter().zip(&near);
            pairs.filter(|(pose, q)| arm.inverse_near(black_box(pose), q, 0.3).is_some()).count()
        });
    });
    group.finish();
}

criterion_group!(benches, kinematics);
criterion_main!(benches);
