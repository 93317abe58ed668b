//! The planner's collision check and the exact oracle on the same states: PR2 and plate in the room of Plate3. One
//! element is one state; of a motion, one configuration at the verifier's resolution.

#![allow(
    clippy::unwrap_used,
    clippy::missing_panics_doc,
    missing_docs,
    unreachable_pub,
    reason = "a benchmark that cannot be set up must stop; the macros of criterion make public functions without docs"
)]

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use darrt_benches::room::{HeldMotion, Room, held_motions};
use darrt_core::validity::Validity as _;
use darrt_geom::{AllowedContacts, BodySet, oracle};
use darrt_primitives::mode::Contacts;
use darrt_primitives::testing::scene_oracle::SceneOracle;

const COUNT: u64 = 256;
/// What the oracle gets: it is slow.
const FEW: usize = 16;
/// Metres, as the planner asks.
const CLEARANCE: f64 = 0.002;

fn collide(c: &mut Criterion) {
    let room = Room::new();
    let model = room.validity.model();
    let states = room.states(COUNT);
    let poses: Vec<_> = states.iter().map(|state| room.moving_poses(state)).collect();
    let none = AllowedContacts::none();
    let mut scratch = model.scratch();
    let mut group = c.benchmark_group("collide");

    group.throughput(Throughput::Elements(COUNT));
    for cap in [0.0, 0.2] {
        group.bench_function(format!("clearance, cap {cap} m"), |b| {
            b.iter(|| {
                for poses in &poses {
                    model.set_poses(&mut scratch, black_box(poses));
                    let _ = black_box(model.clearance(&mut scratch, &BodySet::ALL, &none, CLEARANCE, cap));
                }
            });
        });
    }
    group.bench_function("validity check with kinematics", |b| {
        let free = |state: &&_| room.validity.check(&room.world, state, &Contacts::default()).is_ok();
        b.iter(|| states.iter().filter(free).count());
    });

    let indices: Vec<_> = model.indices().collect();
    let skip = |i: usize, j: usize| !model.is_tested(indices[i], indices[j]);
    let posed: Vec<_> = states.iter().take(FEW).map(|state| room.posed(state)).collect();
    group.throughput(Throughput::Elements(FEW as u64));
    group.sample_size(10);
    group.bench_function("oracle, nearest", |b| {
        b.iter(|| {
            posed.iter().map(|bodies| oracle::nearest(bodies, &skip).unwrap().map_or(0.0, |f| f.distance)).sum::<f64>()
        });
    });
    group.bench_function("oracle, intersections", |b| {
        b.iter(|| posed.iter().map(|bodies| oracle::intersections(bodies, &skip).unwrap().len()).sum::<usize>());
    });
    group.finish();
}

/// Whole motions of the arm with the plate in its hand, self-collision included: by the planner, which proves them free
/// between configurations too, and configuration by configuration.
fn motions(c: &mut Criterion) {
    let room = Room::new();
    let motions = held_motions(128);
    let mut group = c.benchmark_group("motion");
    let configurations: f64 = motions.iter().map(|motion| motion.configurations).sum();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a sum of counts")]
    group.throughput(Throughput::Elements(configurations as u64));
    group.bench_function("free prefix", |b| {
        b.iter(|| {
            for HeldMotion { from, instance, .. } in &motions {
                black_box(room.validity.free_prefix(&room.world, instance, black_box(from)).fraction);
            }
        });
    });
    let some: Vec<_> = motions.iter().step_by(8).map(|motion| motion.at(&room, 0.3)).collect();
    group.throughput(Throughput::Elements(some.len() as u64));
    group.bench_function("each configuration by itself", |b| {
        let free = |state: &&_| room.validity.check(&room.world, state, &Contacts::default()).is_ok();
        b.iter(|| some.iter().filter(free).count());
    });
    group.sample_size(10);
    let oracle = SceneOracle::new(room.scene.bodies());
    group.bench_function("each configuration by the oracle", |b| {
        let free = |state: &&_| oracle.check(&room.world, state, &Contacts::default()).is_ok();
        b.iter(|| some.iter().filter(free).count());
    });
    group.finish();
}

criterion_group!(benches, collide, motions);
criterion_main!(benches);
