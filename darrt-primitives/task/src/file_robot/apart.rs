//! How far links are from each other, at arm configurations drawn at random.

use darrt_core::random::Stream;
use darrt_geom::clearance;
use darrt_primitives::joints::Joints;
use darrt_primitives::manipulator::{Configuration, JointVector as _, Manipulator as _};
use nalgebra::Isometry3;
use rand::RngExt as _;

use super::FileRobot;

/// An arm within its limits.
pub(super) fn drawn_arm(robot: &FileRobot, rng: &mut Stream) -> Option<Joints> {
    let values = robot.limits.iter().map(|limit| {
        if limit.is_unlimited() { rng.random_range(-3.1..3.1) } else { rng.random_range(limit.lower..=limit.upper) }
    });
    Joints::from_values(&values.collect::<Vec<_>>())
}

/// The distances of pairs of links, metres; infinite where it is not known.
pub(super) fn distances<'a>(
    robot: &'a FileRobot,
    arm: &Joints,
    gap_m: f64,
    pairs: &'a [(usize, usize)],
) -> impl Iterator<Item = f64> + use<'a> {
    let mut poses = vec![Isometry3::identity(); robot.links().len()];
    robot.link_poses(&Configuration { base: [0.0; 3], arm: *arm }, gap_m, &mut poses);
    let links = robot.links();
    let between = move |(a, b): &(usize, usize)| {
        let ((a, at), (b, bt)) = ((links.get(*a)?, poses.get(*a)?), (links.get(*b)?, poses.get(*b)?));
        clearance::between(&a.body, at, &b.body, bt).ok().map(|found| found.distance)
    };
    pairs.iter().map(move |pair| between(pair).unwrap_or(f64::INFINITY))
}
