//! Broken hands, joints that do nothing, bases that are always the same, and numbers in another unit.

use nalgebra::{Isometry3, Translation3};

use super::Case;
use super::robots::{case, robot};
use crate::laws::manipulator::{
    BASE_VARIED, CENTRED, CLEAR, DURATION, HAND, JOINTS, MAY_NOT_REACH, NEAR_FINDS, PAIRS, TIPS, TRAVEL_TIGHT,
};
use crate::testing::gantry::{Configuration, Joints, motion, poses};

pub(super) fn cases() -> Vec<Case> {
    [fingers(), arms(), units()].concat()
}

fn fingers() -> Vec<Case> {
    vec![
        case("one finger moves", "the mimic joint of the other was forgotten", CENTRED, || {
            robot(|robot| {
                robot.poses = |q, gap_m| {
                    let mut all = poses(q, 0.0);
                    all[3] = motion::forward(q) * Translation3::new(0.0, gap_m + 0.01, 0.0);
                    all
                };
            })
        }),
        case("fingers above the tool", "the tool frame is at the flange's height", CENTRED, || {
            robot(|robot| {
                robot.poses = |q, gap_m| {
                    let mut all = poses(q, gap_m);
                    for finger in [3, 4] {
                        all[finger] *= Translation3::new(0.0, 0.0, 0.05);
                    }
                    all
                };
            })
        }),
        case("palm between the fingers", "the palm is posed at the tool", CLEAR, || {
            robot(|robot| {
                robot.poses = |q, gap_m| {
                    let mut all = poses(q, gap_m);
                    all[2] = motion::forward(q);
                    all
                };
            })
        }),
        case("palm ahead of the tips", "the palm's offset has the wrong sign", CLEAR, || {
            robot(|robot| {
                robot.poses = |q, gap_m| {
                    let mut all = poses(q, gap_m);
                    all[2] = motion::forward(q) * Translation3::new(0.08, 0.0, 0.0);
                    all
                };
            })
        }),
        case("pads of a metre", "centimetres were wanted", TIPS, || robot(|robot| robot.hand.pad_length_m = 1.0)),
        case("widest gap in millimetres", "the data sheet has them", HAND, || {
            robot(|robot| robot.hand.max_gap_m = 100.0)
        }),
    ]
}

/// The arm without its last joint.
fn stiff(q: &Configuration) -> Configuration {
    let mut stiff = *q;
    stiff.arm[6] = 0.0;
    stiff
}

/// Only such solutions as the stiff arm has.
fn unturned(joints: Joints) -> Option<Joints> {
    (joints[6].abs() < 1e-9).then_some(joints)
}

fn arms() -> Vec<Case> {
    vec![
        case("a joint that does nothing", "its axis was never filled in", JOINTS, || {
            robot(|robot| {
                robot.forward = |q| motion::forward(&stiff(q));
                robot.poses = |q, gap_m| poses(&stiff(q), gap_m);
                robot.inverse = |base, tool, rng| motion::inverse(base, tool, rng).and_then(unturned);
                robot.near = |base, tool, near| {
                    let mut found = motion::near(base, tool, near).and_then(unturned)?;
                    found[6] = near[6];
                    Some(found)
                };
            })
        }),
        case("near is only here", "a tolerance of the joints where one of steps was wanted", NEAR_FINDS, || {
            robot(|robot| {
                robot.near = |base, tool, near| {
                    let found = motion::near(base, tool, near)?;
                    let is_here = found.iter().zip(near).all(|(a, b)| (a - b).abs() < 1e-7);
                    is_here.then_some(found)
                };
            })
        }),
        case("a pair that always touches", "neighbours whose shapes overlap are named as a pair", PAIRS, || {
            robot(|robot| {
                robot.self_pairs.push((1, 2));
                robot.poses = |q, gap_m| {
                    let mut all = poses(q, gap_m);
                    all[2] = motion::forward(q) * Translation3::new(-0.12, 0.0, 0.0);
                    all
                };
            })
        }),
        case("always the same base", "the offset to the hand is not drawn", BASE_VARIED, || {
            robot(|robot| robot.base_for = |tool, _| [tool.translation.x - 0.3, tool.translation.y, 0.0])
        }),
        case("reaches up to fifty metres", "a bound in another unit", MAY_NOT_REACH, || {
            robot(|robot| {
                robot.may_reach = |base, tool: &Isometry3<f64>| {
                    (tool.translation.x - base[0]).hypot(tool.translation.y - base[1]) < 50.0
                };
            })
        }),
    ]
}

fn units() -> Vec<Case> {
    vec![
        case("milliseconds", "the drives count in them", DURATION, || {
            robot(|robot| robot.duration = |a, b, _| 2e3 * motion::travel(a, b, 0.0))
        }),
        case("five hundred metres a second", "a time in kiloseconds", DURATION, || {
            robot(|robot| robot.duration = |a, b, _| 2e-3 * motion::travel(a, b, 0.0))
        }),
        case("long ways take longer and longer", "the square of the travel", DURATION, || {
            robot(|robot| robot.duration = |a, b, _| 2.0 * motion::travel(a, b, 0.0).powi(2))
        }),
        case("a kilometre for every link", "a bound so large that it always holds", TRAVEL_TIGHT, || {
            robot(|robot| {
                robot.link_travel = |a, b, held_reach_m, out| {
                    let bound = motion::travel(a, b, held_reach_m);
                    out.fill(if bound > 0.0 { bound + 1e3 } else { 0.0 });
                    bound
                };
            })
        }),
    ]
}
