//! Numeric inverse kinematics on random reachable poses of arms with published dimensions, ours and that of the crate `k`.
//!
//! Before the times, a table of the share that each solves and of its median time per pose. `k` descends from one seed; here it gets
//! up to `K_STARTS` random ones, its own default tolerances (1 mm, 0.3 deg; ours are below 1e-9) and its own treatment of limits
//! (a joint beyond its limit fails the descent). One element is one pose.

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
use darrt_benches::stream;
use darrt_primitives::kinematics::{ChainInverse, InverseOptions, JointValues, KinematicTree, RobotDescription};
use darrt_primitives::testing::arms;
use k::InverseKinematicsSolver as _;
use nalgebra::Isometry3;
use rand::{Rng, RngExt as _};

/// Poses of the table.
const POSES: u64 = 2000;
/// Poses of one measurement by criterion.
const MEASURED: u64 = 256;
/// Random starts that `k` gets for one pose: as many as the attempts of ours.
const K_STARTS: usize = 16;

/// An arm as either sees it.
struct Arm {
    name: &'static str,
    ours: ChainInverse,
    theirs: k::SerialChain<f64>,
}

impl Arm {
    /// From the link above the joint `first` to the link `tip`.
    fn new(name: &'static str, urdf: &str, base: &str, tip: &str) -> Self {
        let tree = KinematicTree::new(&RobotDescription::from_text(urdf).unwrap()).unwrap();
        // The same limits for both: `k` knows the hard ones.
        let options = InverseOptions { soft_limits: false, ..InverseOptions::default() };
        let ours = ChainInverse::new(&tree, base, tip, &Isometry3::identity(), options).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("arm.urdf");
        std::fs::write(&file, urdf).unwrap();
        let whole = k::Chain::<f64>::from_urdf_file(&file).unwrap();
        let first = &tree.variables()[ours.variables()[0]].name;
        let theirs = k::SerialChain::from_end_to_root(whole.find_link(tip).unwrap(), whole.find(first).unwrap());
        let new = Self { name, ours, theirs };
        new.assert_same_chain();
        new
    }

    /// Both have the tool at the same place.
    fn assert_same_chain(&self) {
        let joints = self.configuration(&mut stream(1));
        self.theirs.set_joint_positions(&joints).unwrap();
        let (ours, theirs) = (self.ours.base_from_tool(&joints).unwrap(), self.theirs.end_transform());
        let away =
            (0..3).map(|i| (ours.translation.vector[i] - theirs.translation.vector[i]).abs()).fold(0.0, f64::max);
        assert!(away < 1e-9, "{}: {away} m", self.name);
    }

    fn configuration(&self, rng: &mut impl Rng) -> JointValues {
        let pi = std::f64::consts::PI;
        let value = |limit: &darrt_primitives::kinematics::JointLimit| {
            let (lower, upper) = if limit.is_unlimited() { (-pi, pi) } else { (limit.lower, limit.upper) };
            rng.random_range(lower..=upper)
        };
        self.ours.limits().iter().map(value).collect()
    }

    /// Poses of random configurations.
    fn poses(&self, count: u64) -> Vec<Isometry3<f64>> {
        let pose = |index| self.ours.base_from_tool(&self.configuration(&mut stream(index))).unwrap();
        (0..count).map(pose).collect()
    }

    fn solve(&self, pose: &Isometry3<f64>, rng: &mut impl Rng) -> bool {
        self.ours.inverse(pose, rng).is_some()
    }

    fn solve_with_k(&self, pose: &Isometry3<f64>, rng: &mut impl Rng) -> bool {
        let solver = k::JacobianIkSolver::default();
        let target = theirs(pose);
        (0..K_STARTS).any(|_| {
            self.theirs.set_joint_positions(&self.configuration(rng)).is_ok()
                && solver.solve(&self.theirs, &target).is_ok()
        })
    }
}

/// A pose in the version of nalgebra that `k` has.
fn theirs(pose: &Isometry3<f64>) -> k::Isometry3<f64> {
    let (p, q) = (pose.translation.vector, pose.rotation.quaternion());
    let rotation = k::nalgebra::Quaternion::new(q.w, q.i, q.j, q.k);
    k::Isometry3::from_parts(k::Translation3::new(p.x, p.y, p.z), k::UnitQuaternion::from_quaternion(rotation))
}

fn all() -> Vec<Arm> {
    let common = arms::all();
    let mut all: Vec<Arm> = common.iter().map(|(name, urdf)| Arm::new(name, urdf, arms::BASE, arms::TOOL)).collect();
    all.push(Arm::new("PR2", darrt_pr2::model::URDF, "torso_lift_link", "r_gripper_tool_frame"));
    all
}

/// Percent solved, and median time of a pose, us.
fn table_entry(poses: &[Isometry3<f64>], mut solve: impl FnMut(&Isometry3<f64>) -> bool) -> (f64, f64) {
    let mut solved = 0_u32;
    let time = |pose| {
        let start = Instant::now();
        solved += u32::from(solve(black_box(pose)));
        start.elapsed().as_secs_f64() * 1e6
    };
    let mut times: Vec<f64> = poses.iter().map(time).collect();
    times.sort_by(f64::total_cmp);
    (100.0 * f64::from(solved) / poses.len() as f64, times[times.len() / 2])
}

fn inverse(c: &mut Criterion) {
    let all = all();
    println!("{:18} {:>9} {:>10} {:>9} {:>10}", "", "solved", "median us", "k: solved", "median us");
    for arm in &all {
        let (poses, mut rng) = (arm.poses(POSES), stream(0));
        let ours = table_entry(&poses, |pose| arm.solve(pose, &mut rng));
        let theirs = table_entry(&poses[..200], |pose| arm.solve_with_k(pose, &mut rng));
        println!("{:18} {:8.2}% {:10.1} {:8.1}% {:10.1}", arm.name, ours.0, ours.1, theirs.0, theirs.1);
    }
    let mut group = c.benchmark_group("numeric inverse");
    group.throughput(Throughput::Elements(MEASURED)).sample_size(20);
    for arm in &all {
        let (poses, mut rng) = (arm.poses(MEASURED), stream(0));
        group.bench_function(arm.name, |b| {
            b.iter(|| poses.iter().filter(|pose| arm.solve(black_box(pose), &mut rng)).count());
        });
        // From nearby, as when a line of the hand is followed.
        let moved = |i| arm.configuration(&mut stream(i)).into_iter().map(|q| q + 0.02).collect();
        let near: Vec<JointValues> = (0..MEASURED).map(moved).collect();
        group.bench_function(format!("{}, near", arm.name), |b| {
            let near_one =
                |(pose, near): (_, &JointValues)| arm.ours.inverse_near(black_box(pose), near, 0.3).is_some();
            b.iter(|| poses.iter().zip(&near).map(near_one).filter(|found| *found).count());
        });
        group.bench_function(format!("{}, k", arm.name), |b| {
            b.iter(|| poses.iter().filter(|pose| arm.solve_with_k(black_box(pose), &mut rng)).count());
        });
    }
    group.finish();
}

criterion_group!(benches, inverse);
criterion_main!(benches);
