//! A posture to start from, and the pairs of links that stand in each other.

use darrt_core::random::{Purpose, stream};
use darrt_primitives::manipulator::Manipulator as _;
use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use rand::RngExt as _;

use super::super::apart::{distances, drawn_arm};
use super::super::load::Loaded;
use crate::problem_file::Limits;
use crate::robot_file::RobotFileError;

/// Configurations that are looked at for pairs that touch.
const SAMPLES: usize = 300;
/// A pair that touches in so large a share of them is joined.
const JOINED: f64 = 0.9;
/// Places of the hand that are tried for a posture.
const TRIES: usize = 400;
/// How far links keep from each other in it, metres.
const APART_M: f64 = 0.01;

/// A posture in which the hand points down in front of the robot and nothing touches, with the pairs that touch anyway.
type Found = (Option<Vec<f64>>, Vec<[String; 2]>);

pub(super) fn search(loaded: &Loaded) -> Result<Found, RobotFileError> {
    let robot = loaded.robot(Limits::Soft, [0.0; 3])?;
    let mut rng = stream(0, 0, 0, Purpose::Extend);
    let gap_m = robot.hand().max_gap_m();
    let pairs = robot.self_pairs().to_vec();
    let mut touches = vec![0_usize; pairs.len()];
    for _ in 0..SAMPLES {
        let Some(arm) = drawn_arm(&robot, &mut rng) else { break };
        for (count, distance) in touches.iter_mut().zip(distances(&robot, &arm, gap_m, &pairs)) {
            *count += usize::from(distance <= 0.0);
        }
    }
    let is_joined = |count: &usize| *count as f64 >= JOINED * SAMPLES as f64;
    let name = |link: usize| robot.links().get(link).map_or_else(String::new, |link| link.body.name.to_string());
    let joined = pairs.iter().zip(&touches).filter(|(_, count)| is_joined(count));
    // The file names links, not the pads that take their place.
    let ignore = joined.map(|((a, b), _)| [name(*a), name(*b)].map(|name| name.trim_end_matches("_pad").to_owned()));
    let kept: Vec<_> =
        pairs.iter().zip(&touches).filter(|(_, count)| !is_joined(count)).map(|(pair, _)| *pair).collect();
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
    Ok((best.map(|(_, values)| values), ignore.collect()))
}
