//! Broken inverse kinematics and base placement.

use std::f64::consts::{PI, TAU};
use std::sync::atomic::{AtomicU32, Ordering};

use darrt_core::laws::Broken;
use nalgebra::{Isometry3, Translation3};
use rand::RngExt;

use super::robots::{case, robot, robot_that};
use super::{Case, unusable};
use crate::kinematics::JointLimit;
use crate::laws::manipulator::{
    BASE_FINDS, BASE_FOR, INVERSE_FINDS, INVERSE_LIMITS, INVERSE_POSE, INVERSE_VARIED, LINE_BOW, LINE_STEP, MAY_REACH,
    NEAR_SELF, PURE, SEEDED,
};
use crate::laws::{ManipulatorClaims, ReachClaims, check_reaches};
use crate::testing::gantry::{Configuration, Gantry, Joints, TOOL_M, motion};

pub(super) fn cases() -> Vec<Case> {
    [solutions(), draws(), lines(), reaches()].concat()
}

fn solutions() -> Vec<Case> {
    vec![
        case("tool offset forgotten", "brings the wrist to where the tool should be", INVERSE_POSE, || {
            robot(|robot| {
                robot.inverse =
                    |base, tool, rng| motion::inverse(base, &(tool * Translation3::new(TOOL_M, 0.0, 0.0)), rng);
            })
        }),
        case("nearly there", "an iteration that stops at a tenth of a millimetre", INVERSE_POSE, || {
            robot(|robot| {
                robot.near = |base, tool, near| {
                    motion::near(base, tool, near).map(|mut arm| {
                        arm[1] += 1e-4 * (0.5 - arm[1]).signum();
                        arm
                    })
                };
            })
        }),
        case("solution outside limits", "limits are clamped for one slide only", INVERSE_LIMITS, || {
            robot(|robot| {
                robot.inverse = |base, tool, rng| {
                    let mut arm = motion::inverse(base, tool, rng)?;
                    // Turning the wrist over gives the same pose with another bend.
                    arm[4] = crate::kinematics::limit::wrap_to_pi(arm[4] + PI);
                    arm[5] = -arm[5];
                    arm[6] += if arm[6] > 0.0 { -PI } else { PI };
                    Some(arm)
                };
            })
        }),
        case("full turn", "a continuous joint in [0, 2 pi) where (-pi, pi] is asked for", INVERSE_LIMITS, || {
            robot(|robot| {
                robot.inverse = |base, tool, rng| {
                    let mut arm = motion::inverse(base, tool, rng)?;
                    arm[4] = arm[4].rem_euclid(TAU);
                    Some(arm)
                };
            })
        }),
        case(
            "nearest to zero",
            "takes the solution nearest to the middle of its limits, not to here",
            NEAR_SELF,
            || robot(|robot| robot.near = |base, tool, _| motion::solve(base, tool, 0.25)),
        ),
        case("measured from the wagon", "the quick test knows the arm's length, but not its slides", MAY_REACH, || {
            robot(|robot| {
                robot.may_reach = |base, tool| {
                    let at = tool.translation.vector;
                    (at.x - base[0]).hypot(at.y - base[1]) < 0.5
                };
            })
        }),
    ]
}

fn draws() -> Vec<Case> {
    static CALLS: AtomicU32 = AtomicU32::new(0);
    static LAST: AtomicU32 = AtomicU32::new(0);
    vec![
        case("global random state", "the redundant joint comes from a sequence of its own", SEEDED, || {
            robot(|robot| {
                robot.inverse = |base, tool, _| {
                    motion::solve(base, tool, f64::from(CALLS.fetch_add(1, Ordering::Relaxed) % 5) * 0.1)
                };
            })
        }),
        case("a posture of its own", "the redundant joint is always in the middle", INVERSE_VARIED, || {
            robot(|robot| robot.inverse = |base, tool, _| motion::solve(base, tool, 0.25))
        }),
        case("warm start", "a search for a near configuration begins where the last one ended", PURE, || {
            robot(|robot| {
                robot.near = |base, tool, near| {
                    let found = motion::near(base, tool, near)?;
                    let mine = u32::try_from(near[0].to_bits() >> 40).unwrap_or(0);
                    let is_warm = LAST.swap(mine, Ordering::Relaxed) == mine;
                    motion::solve(base, tool, found[3] + if is_warm { 1e-8 } else { 0.0 })
                };
            })
        }),
        case("yaw past half a turn", "a heading in [0, 2 pi) that the base's space does not contain", BASE_FOR, || {
            robot(|robot| {
                robot.base_for = |tool, rng| {
                    let [x, y, yaw] = motion::base_for(tool, rng);
                    [x, y, yaw + 2.0 * PI]
                };
            })
        }),
    ]
}

/// A last joint that has room for more than a turn.
fn turns_on(robot: &mut Gantry) {
    robot.limits[6] = JointLimit::new(-9.0, 9.0);
    robot.near = flips;
}

/// The right pose, but with the last joint a whole turn away whenever the hand has moved.
fn flips(base: &[f64; 3], tool: &Isometry3<f64>, near: &Joints) -> Option<Joints> {
    let mut arm = motion::near(base, tool, near)?;
    let here = motion::forward(&Configuration { base: *base, arm: *near });
    let is_moved = (here.translation.vector - tool.translation.vector).norm() > 1e-6;
    if is_moved {
        arm[6] += if near[6] > 0.0 { -TAU } else { TAU };
    }
    Some(arm)
}

fn lines() -> Vec<Case> {
    vec![
        case(
            "wrapped angle the long way",
            "a joint runs a whole turn back because its angle is wrapped",
            LINE_STEP,
            || robot(turns_on),
        ),
        case(
            "jumps between postures",
            "near means any posture: the two slides change places at every step",
            LINE_STEP,
            || {
                robot(|robot| {
                    robot.near = |base, tool, near| {
                        let same = motion::near(base, tool, near)?;
                        let stays = same.iter().zip(near).all(|(p, q)| (p - q).abs() < 1e-6);
                        if stays { Some(same) } else { motion::solve(base, tool, 0.5 - near[3]) }
                    };
                })
            },
        ),
        case(
            "turns over between the steps",
            "every step ends on the line, but the hand swings round on the way",
            LINE_BOW,
            || robot_that(turns_on, &ManipulatorClaims { joint_step: 10.0, ..ManipulatorClaims::default() }),
        ),
    ]
}

/// Shares of what the gantry with this change finds.
fn share(change: fn(&mut Gantry)) -> Result<(), Broken> {
    let mut robot = Gantry::new().map_err(unusable)?;
    change(&mut robot);
    let along = |i: u32| {
        let s = f64::from(i) / 64.0;
        let arm = [s - 0.5, 0.7 - s, 0.5 + s, 0.4 * s, 3.0 - 6.0 * s, 0.2 + 2.5 * s, 2.0 * s - 1.0];
        Configuration { base: [s, -s, 2.0 * s], arm }
    };
    check_reaches(&robot, &(0..64).map(along).collect::<Vec<_>>(), 1, &ReachClaims::default())
}

fn reaches() -> Vec<Case> {
    let case = |name, wrong, law, broken| Case { name, wrong, law, broken, honest: || share(|_| {}) };
    vec![
        case("gives up early", "one descent from a random start, and no second try", INVERSE_FINDS, || {
            share(|robot| {
                robot.inverse = |base, tool, rng| {
                    let is_lucky = rng.random_bool(0.5);
                    motion::inverse(base, tool, rng).filter(|_| is_lucky)
                };
            })
        }),
        case(
            "stands on the wrong side",
            "the offset to the hand is added where it must be subtracted",
            BASE_FINDS,
            || {
                share(|robot| {
                    robot.base_for = |tool, rng| {
                        let [x, y, yaw] = motion::base_for(tool, rng);
                        [x + 4.0, y, yaw]
                    };
                })
            },
        ),
    ]
}
