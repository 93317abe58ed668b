//! Broken robots at their limits, asked for nonsense, or with what was never filled in.

use darrt_core::laws::watch::{PANICS, RETURNS};
use darrt_core::laws::{or_abandon, with_patience};
use nalgebra::{Isometry3, Translation3};

use super::Case;
use super::robots::{case, robot};
use crate::laws::manipulator::{
    DURATION, INVERSE_LIMITS, MAY_NOT_REACH, MAY_REACH, NAN, PAIRS, PURE, RIGID, STRENGTH, TRAVEL, TRAVEL_MEASURE,
    TRAVEL_TIGHT,
};
use crate::testing::gantry::{Configuration, motion, poses};

pub(super) fn cases() -> Vec<Case> {
    [nonsense(), left_out(), borders()].concat()
}

fn nonsense() -> Vec<Case> {
    vec![
        case("solves for NaN", "clamps every joint to its limits, and NaN becomes one of them", NAN, || {
            robot(|robot| {
                robot.inverse = |base, tool, rng| {
                    if tool.translation.vector.iter().chain(&tool.rotation.coords).any(|x| x.is_nan()) {
                        return Some([0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0]);
                    }
                    motion::inverse(base, tool, rng)
                };
            })
        }),
        case("stays for NaN", "where it finds nothing, near is where it was", NAN, || {
            robot(|robot| {
                robot.near = |base, tool, near| {
                    let is_number = tool.translation.vector.iter().chain(&tool.rotation.coords).all(|x| !x.is_nan());
                    if is_number { motion::near(base, tool, near) } else { Some(*near) }
                };
            })
        }),
        case("not too far for NaN", "refuses what is too far away, which NaN is not", NAN, || {
            robot(|robot| {
                robot.may_reach = |base, tool| {
                    let at = tool.translation.vector;
                    let d = (at.x - base[0]).hypot(at.y - base[1]);
                    #[allow(clippy::neg_cmp_op_on_partial_ord, reason = "that is what is wrong with it")]
                    let is_near = !(d > 2.5);
                    is_near
                };
            })
        }),
        case("unwraps the pose", "an index made of a coordinate, also of NaN", PANICS, || {
            robot(|robot| {
                robot.may_reach = |base, tool| {
                    assert!(!tool.translation.vector.y.is_nan(), "no cell for it");
                    motion::may_reach(base, tool)
                };
            })
        }),
        Case {
            name: "iterates for ever",
            wrong: "goes on until the error is small, and NaN never is",
            law: RETURNS,
            broken: || {
                with_patience(0.1, || {
                    or_abandon(|| {
                        robot(|robot| {
                            robot.inverse = |base, tool, rng| {
                                while tool.rotation.i.is_nan() || tool.translation.y.is_nan() {
                                    std::thread::sleep(std::time::Duration::from_secs(60));
                                }
                                motion::inverse(base, tool, rng)
                            };
                        })
                    })
                })
            },
            honest: || or_abandon(|| robot(|_| {})),
        },
    ]
}

fn left_out() -> Vec<Case> {
    vec![
        case("reaches everything", "the quick test was left at true", MAY_NOT_REACH, || {
            robot(|robot| robot.may_reach = |_, tool| tool.translation.vector.iter().all(|x| x.is_finite()))
        }),
        case("no pairs", "the list of pairs that can collide was never filled in", PAIRS, || {
            robot(|robot| robot.self_pairs = Vec::new())
        }),
        case("pairs twice", "every pair in both orders", PAIRS, || {
            robot(|robot| robot.self_pairs = vec![(0, 2), (2, 0), (0, 3), (3, 0)])
        }),
        case("carries nothing", "the payload was left at 0", STRENGTH, || robot(|robot| robot.payload_kg = 0.0)),
        case("a grip of no number", "a force divided by a stroke of 0", STRENGTH, || {
            robot(|robot| robot.hand.grip_force_n = f64::NAN)
        }),
        case("a grip in kilonewton", "the data sheet of a press", STRENGTH, || {
            robot(|robot| {
                robot.hand.grip_force_n = 0.06;
                robot.payload_kg = 2.0;
            })
        }),
        case("pads of no length", "the length of the pads was left at 0", STRENGTH, || {
            robot(|robot| robot.hand.pad_length_m = 0.0)
        }),
        case("a head start", "the time of speeding up is subtracted, also where nothing moves", DURATION, || {
            robot(|robot| robot.duration = |a, b, _| motion::travel(a, b, 0.0) - 0.1)
        }),
        case("no time at rest", "divides by the travel, which is 0 at rest", DURATION, || {
            robot(|robot| robot.duration = |a, b, _| motion::travel(a, b, 0.0).powi(2) / motion::travel(a, b, 0.0))
        }),
        case("the base drives for nothing", "only the arm takes its time", DURATION, || {
            robot(|robot| {
                robot.duration = |a, b, _| motion::travel(a, &Configuration { base: a.base, ..*b }, 0.0);
            })
        }),
        case("in a hurry with a full hand", "loaded and empty are exchanged", DURATION, || {
            robot(|robot| {
                robot.duration = |a, b, is_loaded| if is_loaded { 1.0 } else { 2.0 } * motion::travel(a, b, 0.0);
            })
        }),
        case("travel without measure", "a bound so large that it always holds", TRAVEL_TIGHT, || {
            robot(|robot| robot.travel = |a, b, held_m| 1000.0 * motion::travel(a, b, held_m))
        }),
        case("a kilometre to be sure", "adds a constant to the bound, except to itself", TRAVEL_TIGHT, || {
            robot(|robot| {
                robot.travel = |a, b, held_m| {
                    let metres = motion::travel(a, b, held_m);
                    if metres > 0.0 { metres + 1000.0 } else { metres }
                };
            })
        }),
        case("travel of no number", "the root of what rounding made negative", TRAVEL_MEASURE, || {
            robot(|robot| {
                robot.travel = |a, b, held_m| {
                    let metres = motion::travel(a, b, held_m);
                    if metres < 1.0 { f64::NAN } else { metres }
                };
            })
        }),
    ]
}

fn borders() -> Vec<Case> {
    vec![
        case("no number at the stop", "an arc cosine of slightly more than 1 at the end of the range", RIGID, || {
            robot(|robot| {
                robot.forward = |q| {
                    let pose = motion::forward(q);
                    let is_at_stop = q.arm[5] <= 0.1 || q.arm[5] >= 3.0;
                    if is_at_stop { Translation3::new(f64::NAN, 0.0, 0.0) * pose } else { pose }
                };
            })
        }),
        case("open borders", "the quick test leaves out what is exactly at a stop", MAY_REACH, || {
            robot(|robot| {
                robot.may_reach = |base, tool| {
                    let z = tool.translation.z;
                    let is_at_stop = (z - 1.8).abs() < 0.16 || (z - 0.4).abs() < 0.16;
                    !is_at_stop && motion::may_reach(base, tool)
                };
            })
        }),
        case("over the stop", "solutions at the end of the range are a hair beyond it", INVERSE_LIMITS, || {
            robot(|robot| {
                robot.inverse = |base, tool, rng| {
                    let mut arm = motion::inverse(base, tool, rng)?;
                    for (value, limit) in arm.iter_mut().zip(motion::LIMITS) {
                        if !limit.is_unlimited() && *value >= limit.upper - 1e-9 {
                            *value = limit.upper + 1e-6;
                        }
                        if !limit.is_unlimited() && *value <= limit.lower + 1e-9 {
                            *value = limit.lower - 1e-6;
                        }
                    }
                    Some(arm)
                };
            })
        }),
        case("a link at its stop", "the palm is posed by a table that ends before the stop", RIGID, || {
            robot(|robot| {
                robot.poses = |q, gap_m| {
                    let mut all = poses(q, gap_m);
                    if q.arm[6] >= 2.5 || q.arm[6] <= -2.5 {
                        all[2] = Isometry3::translation(f64::INFINITY, 0.0, 0.0);
                    }
                    all
                };
            })
        }),
        case("travel forgets the turn at the stop", "the last degree before the stop is not counted", TRAVEL, || {
            robot(|robot| {
                robot.travel = |a, b, held_m| {
                    let is_at_stop = |q: &motion::Configuration| q.arm[5] <= 0.1 || q.arm[5] >= 3.0;
                    let metres = motion::travel(a, b, held_m);
                    if is_at_stop(a) == is_at_stop(b) { metres } else { 0.1 * metres }
                };
            })
        }),
        case("dithers at random", "forward kinematics adds what it counted", PURE, || {
            use std::sync::atomic::{AtomicU32, Ordering::Relaxed};
            static CALLS: AtomicU32 = AtomicU32::new(0);
            robot(|robot| {
                robot.poses = |q, gap_m| {
                    let mut all = poses(q, gap_m);
                    let noise = f64::from(CALLS.fetch_add(1, Relaxed) % 5) * 1e-13;
                    all[1] = Translation3::new(noise, 0.0, 0.0) * all[1];
                    all
                };
            })
        }),
    ]
}
