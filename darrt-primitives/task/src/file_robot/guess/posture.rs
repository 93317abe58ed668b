//! A posture to start from, and the pairs of links that stand in each other.

use darrt_core::random::{Purpose, stream};
use darrt_primitives::manipulator::Manipulator as _;
use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use rand::RngExt as _;

use super::super::apart::distances;
use super::super::load::Loaded;
use super::super::sampled;
use crate::problem_file::Limits;
use crate::robot_file::RobotFileError;

/// Places of the hand that are tried for a posture.
const TRIES: usize = 400;
/// How far links keep from each other in it, metres.
const APART_M: f64 = 0.01;

/// A posture in which the hand points down in front of the robot and nothing touches, with the pairs that touch anyway and in
/// which share of all configurations.
pub(super) type Found = (Option<Vec<f64>>, Vec<([String; 2], String)>);

pub(super) fn search(loaded: &Loaded) -> Result<Found, RobotFileError> {
    let robot = loaded.robot(Limits::Soft, [0.0; 3])?;
    let mut rng = stream(0, 0, 0, Purpose::Extend);
    let gap_m = robot.hand().max_gap_m();
    let pairs = sampled::pairs(loaded, &robot)?;
    let ignore = pairs.all.iter().filter(|pair| pair.is_joined(pairs.samples)).map(|pair| {
        let why = format!("{:.0} %", 100.0 * pair.share(pairs.samples));
        (pair.links.clone(), why)
    });
    let ignore: Vec<_> = ignore.collect();
    // The file names links, not the pads that take their place.
    let name = |link: usize| robot.links().get(link).map_or("", |link| link.body.name.trim_end_matches("_pad"));
    let is_joined = |a: usize, b: usize| {
        ignore
            .iter()
            .any(|([first, second], _)| [name(a), name(b)] == [first, second] || [name(b), name(a)] == [first, second])
    };
    let kept: Vec<_> = robot.self_pairs().iter().copied().filter(|(a, b)| !is_joined(*a, *b)).collect();
    let mut best: Option<(f64, Vec<f64>)> = None;
    for _ in 0..TRIES {
        let (ahead, side) = (rng.random_range(0.2..0.7), rng.random_range(-0.2..0.2));
        let height = rng.random_range(0.2..1.4);
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), rng.random_range(-3.1..3.1));
        let down = turn * UnitQuaternion::from_axis_angle(&Vector3::y_axis(), std::f64::consts::FRAC_PI_2);
        let tool = Isometry3::from_parts(Vector3::new(ahead, side, height).into(), down);
        if !robot.may_reach(&[0.0; 3], &tool) {
            continue;
        }
        let Some(arm) = robot.inverse(&[0.0; 3], &tool, &mut rng) else { continue };
        let values = arm.as_ref().iter().zip(robot.limits());
        // How far its joints are from their limits, as a share of half their range.
        let room = values.map(|(value, limit)| {
            if limit.is_unlimited() {
                1.0
            } else {
                (value - limit.lower).min(limit.upper - value) / (0.5 * (limit.upper - limit.lower))
            }
        });
        let room = room.fold(1.0, f64::min);
        if best.as_ref().is_some_and(|(most, _)| *most >= room) {
            continue;
        }
        if distances(&robot, &arm, gap_m, &kept).all(|distance| distance > APART_M) {
            best = Some((room, arm.as_ref().to_vec()));
        }
    }
    Ok((best.map(|(_, values)| values), ignore))
}
