//! The PR2's right arm: forward chain, closed-form inverse, inverse near a configuration, each one by one and in batches; base
//! poses for a tool pose. One element is one configuration, one pair of pose and roll, or one base.

#![allow(
    clippy::unwrap_used,
    clippy::missing_panics_doc,
    missing_docs,
    unreachable_pub,
    reason = "a benchmark that cannot be set up must stop; the macros of criterion make public functions without docs"
)]

use std::hint::black_box;

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main};
use darrt_benches::arm::{TORSO_M, configurations, poses, right_arm};
use darrt_benches::room::Room;
use darrt_benches::stream;
use darrt_pr2::WorldState;
use darrt_pr2::arm::many_rolls::RollSolutions;
use darrt_pr2::arm::{Arm, ArmConfiguration, Side, Solutions};
use darrt_pr2::forward::{ArmChain, ArmPoses, Frame, world_from_base};
use darrt_pr2::model::{Pr2Model, WholeBody};
use darrt_pr2::variants::reachability::Reachability;
use darrt_primitives::kinematics::lanes::{LANES, Row};
use darrt_primitives::kinematics::{BatchForward, PoseLanes};
use darrt_primitives::manipulator::Manipulator as _;
use darrt_primitives::mode::Contacts;
use nalgebra::Isometry3;

const COUNT: u64 = 256;

/// The frames that the seven joints move, and the tool's.
const SEVEN_AND_TOOL: [Frame; 8] = [
    Frame::ShoulderPan,
    Frame::ShoulderLift,
    Frame::UpperArmRoll,
    Frame::ElbowFlex,
    Frame::ForearmRoll,
    Frame::WristFlex,
    Frame::WristRoll,
    Frame::Tool,
];

/// The link of the right arm that has this frame.
fn link(model: &Pr2Model, frame: Frame) -> usize {
    model.tree().link_index(&format!("r_{}", frame.links()[0])).unwrap()
}

/// The configurations in batches: one row per variable of the tree.
fn rows(model: &Pr2Model, all: &[ArmConfiguration]) -> Vec<Vec<Row>> {
    let values = |q: &ArmConfiguration| {
        let mut state = WholeBody::at_rest();
        state.arms[Side::Right.index()] = *q;
        model.joint_values(&state)
    };
    let batch = |chunk: &[ArmConfiguration]| {
        let values: Vec<_> = chunk.iter().map(values).collect();
        (0..model.tree().variables().len()).map(|v| Row(std::array::from_fn(|lane| values[lane][v]))).collect()
    };
    all.chunks(LANES).map(batch).collect()
}

/// Rolls all over the range, one of them that of `q`.
fn rolls(arm: &Arm, q: &ArmConfiguration) -> Row {
    let roll = arm.limits[2];
    let step = (roll.upper - roll.lower) / LANES as f64;
    Row(std::array::from_fn(|lane| q[2] + lane as f64 * step))
}

/// The first configuration that collides with nothing, the robot itself included, in the room of Plate3: the poses are
/// those of states that are free.
fn first_free(group: &mut BenchmarkGroup<'_, WallTime>) {
    let room = Room::new();
    let robot = room.world.manipulator();
    let collision_scene = room.world.collision_scene();
    let contacts = Contacts::default();
    let is_free = |state: &WorldState| collision_scene.check(robot, state, &contacts).is_ok();
    let mut states: Vec<_> =
        room.states(20 * COUNT).into_iter().filter(is_free).take(usize::try_from(COUNT).unwrap()).collect();
    assert_eq!(states.len() as u64, COUNT);
    let poses: Vec<_> =
        states.iter().map(|s| world_from_base(&s.robot.base).inverse() * robot.world_from_tool(&s.robot)).collect();
    group.bench_function("inverse, first without collision", |b| {
        let rng = &mut stream(0);
        b.iter(|| {
            let pairs = poses.iter().zip(&mut states);
            let found = pairs.filter_map(|(pose, state)| {
                robot.arm().inverse_where(black_box(pose), rng, |q| {
                    state.robot.arm = *q;
                    is_free(state)
                })
            });
            found.count()
        });
    });
}

/// Bases for poses that are reached from somewhere: from a ring around the wrist, from the inverse reachability model
/// when it knows its slices, and with a slice to be computed for every one.
fn bases(group: &mut BenchmarkGroup<'_, WallTime>) {
    let room = Room::new();
    let ring = room.world.manipulator().clone();
    let modelled = ring.clone().with_bases_from_reachability();
    let poses: Vec<_> = room.states(COUNT).iter().map(|state| ring.world_from_tool(&state.robot)).collect();
    for (name, robot) in [("ring", &ring), ("model", &modelled)] {
        group.bench_function(format!("base, from the {name}"), |b| {
            let rng = &mut stream(0);
            b.iter(|| poses.iter().map(|pose| robot.base_for(black_box(pose), rng)[0]).sum::<f64>());
        });
    }
    group.throughput(Throughput::Elements(1));
    group.bench_function("base, slice of the model computed", |b| {
        let rng = &mut stream(0);
        let mut next = poses.iter().cycle();
        b.iter(|| Reachability::new(ring.arm(), 0.3).base_for(next.next().unwrap(), rng));
    });
}

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
    let model = Pr2Model::embedded().unwrap();
    let rows = rows(&model, &all);
    let root = PoseLanes::splat(&Isometry3::translation(0.1, 0.2, 0.3));
    for (name, frames) in [("seven links and tool", &SEVEN_AND_TOOL[..]), ("all links", &Frame::ALL[..])] {
        let links: Vec<usize> = frames.iter().map(|frame| link(&model, *frame)).collect();
        let batch = BatchForward::for_links(model.tree(), &links).unwrap();
        let mut poses = batch.poses();
        group.bench_function(format!("forward in batches, {name}"), |b| {
            b.iter(|| rows.iter().for_each(|rows| batch.forward(black_box(rows), &root, &mut poses).unwrap()));
        });
    }
    let mut solutions = Solutions::new();
    group.bench_function("inverse for one roll", |b| {
        b.iter(|| {
            for (pose, q) in reached.iter().zip(&all) {
                arm.inverse(black_box(pose), q[2], &mut solutions);
                black_box(solutions.len());
            }
        });
    });
    group.throughput(Throughput::Elements(COUNT * LANES as u64));
    group.bench_function("inverse for eight rolls, one by one", |b| {
        b.iter(|| {
            for (pose, q) in reached.iter().zip(&all) {
                for roll in rolls(&arm, q).0 {
                    arm.inverse(black_box(pose), roll, &mut solutions);
                    black_box(solutions.len());
                }
            }
        });
    });
    let mut many = RollSolutions::default();
    group.bench_function("inverse for eight rolls, at once", |b| {
        b.iter(|| {
            for (pose, q) in reached.iter().zip(&all) {
                arm.inverse_for_rolls(black_box(pose), &rolls(&arm, q), &mut many);
                black_box(many.is_empty());
            }
        });
    });
    group.throughput(Throughput::Elements(COUNT));
    group.bench_function("inverse_any", |b| {
        let rng = &mut stream(0);
        b.iter(|| reached.iter().filter(|pose| arm.inverse_any(black_box(pose), rng).is_some()).count());
    });
    let far: Vec<_> = reached.iter().map(|pose| Isometry3::translation(0.4, 0.3, 0.0) * pose).collect();
    group.bench_function("inverse_any, moved away by half a metre", |b| {
        let rng = &mut stream(0);
        b.iter(|| far.iter().filter(|pose| arm.inverse_any(black_box(pose), rng).is_some()).count());
    });
    first_free(&mut group);
    // From a configuration nearby, as when a line of the hand is followed.
    let near: Vec<_> = all.iter().map(|q| q.map(|angle| angle + 0.05)).collect();
    group.bench_function("inverse_near", |b| {
        b.iter(|| {
            let pairs = reached.iter().zip(&near);
            pairs.filter(|(pose, q)| arm.inverse_near(black_box(pose), q, 0.3).is_some()).count()
        });
    });
    bases(&mut group);
    group.finish();
}

criterion_group!(benches, kinematics);
criterion_main!(benches);
