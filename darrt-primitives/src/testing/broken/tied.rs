//! Robots that are wrong about what ties their hand, and about how to turn what is round.

use std::f64::consts::FRAC_PI_2;
use std::sync::atomic::{AtomicU32, Ordering};

use darrt_core::laws::Broken;
use nalgebra::{Unit, Vector3};
use rand::RngExt;

use super::{Case, unusable};
use crate::hand_ties::HandTies;
use crate::laws::manipulator::{PURE, SEEDED, TIES, TIES_ALL, TURN, TURN_FINDS};
use crate::laws::{ManipulatorClaims, ReachClaims, check_manipulator, check_reaches};
use crate::manipulator::Configuration;
use crate::testing::crane::{self, BASE, Crane, HEIGHT_M};

fn along(i: u32) -> Configuration<[f64; 2]> {
    let s = f64::from(i) / 32.0;
    Configuration { base: BASE, arm: [0.7 - 1.4 * s, 0.6 * s - 0.2] }
}

/// All laws of the crane with this change.
fn crane(change: fn(&mut Crane)) -> Result<(), Broken> {
    let mut robot = Crane::new().map_err(unusable)?;
    change(&mut robot);
    let seed = darrt_core::testing::broken::seed();
    let elsewhere = Configuration { base: [1.0, 0.5, -2.0], ..along(25) };
    check_manipulator(&robot, [&along(3), &elsewhere], [0.02, 0.08], seed, &ManipulatorClaims::default())?;
    check_reaches(&robot, &(0..32).map(along).collect::<Vec<_>>(), seed, &ReachClaims::default())
}

fn case(name: &'static str, wrong: &'static str, law: &'static str, broken: fn() -> Result<(), Broken>) -> Case {
    Case { name, wrong, law, broken, honest: || crane(|_| {}) }
}

pub(super) fn cases() -> Vec<Case> {
    [ties(), turns()].concat()
}

fn ties() -> Vec<Case> {
    static CALLS: AtomicU32 = AtomicU32::new(0);
    vec![
        case("ties of another hand", "level, where the hand points down", TIES, || {
            crane(|robot| robot.ties = || HandTies { up_in_tool: Some(Vector3::z_axis()), ..crane::ties() })
        }),
        case("down for up", "the sign of the axis: where the hand points in the world", TIES, || {
            crane(|robot| robot.ties = || HandTies { up_in_tool: Some(Vector3::x_axis()), ..crane::ties() })
        }),
        case("height of the flange", "measured where the hand is bolted on", TIES, || {
            crane(|robot| robot.ties = || HandTies { height_m: Some(HEIGHT_M + 0.1), ..crane::ties() })
        }),
        case("tied height in millimetres", "from the data sheet", TIES, || {
            crane(|robot| robot.ties = || HandTies { height_m: Some(1e3 * HEIGHT_M), ..crane::ties() })
        }),
        case("tied to no number", "a quotient of two slides that stand still", TIES, || {
            crane(|robot| robot.ties = || HandTies { height_m: Some(f64::NAN), ..crane::ties() })
        }),
        case("an axis of no length", "a normal that was never normalised", TIES, || {
            crane(|robot| {
                robot.ties = || {
                    let up = Unit::new_unchecked(Vector3::new(-1e-3, 0.0, 0.0));
                    HandTies { up_in_tool: Some(up), ..crane::ties() }
                };
            })
        }),
        case("no ties", "left at the default", TIES_ALL, || crane(|robot| robot.ties = HandTies::default)),
        case("may rise, it says", "the tilt is told, the height forgotten", TIES_ALL, || {
            crane(|robot| robot.ties = || HandTies { height_m: None, ..crane::ties() })
        }),
        case("may tilt, it says", "the height is told, the tilt forgotten", TIES_ALL, || {
            crane(|robot| robot.ties = || HandTies { up_in_tool: None, ..crane::ties() })
        }),
        case("ties that come and go", "a flag that is toggled when it is read", PURE, || {
            crane(|robot| {
                robot.ties = || {
                    let is_even = CALLS.fetch_add(1, Ordering::Relaxed).is_multiple_of(2);
                    if is_even { crane::ties() } else { HandTies { up_in_tool: None, ..crane::ties() } }
                };
            })
        }),
        case("lifts less and less", "a payload that is what is left of the battery", PURE, || {
            crane(|robot| robot.payload_kg = || 2.0 / f64::from(1 + CALLS.fetch_add(1, Ordering::Relaxed)))
        }),
    ]
}

fn turns() -> Vec<Case> {
    static CALLS: AtomicU32 = AtomicU32::new(0);
    vec![
        case("turned the other way", "a turn of the hand, where one of the object was asked for", TURN, || {
            crane(|robot| robot.turn = |base, tool, at, rng| crane::turn(base, tool, at, rng).map(|turn| -turn))
        }),
        case("where the hand points, not by how much", "an angle in the world, not a difference", TURN, || {
            crane(|robot| robot.turn = |base, _, _, _| Some(base[2] + FRAC_PI_2))
        }),
        case("turned about the heading of the world", "the heading of the base is forgotten", TURN, || {
            crane(|robot| robot.turn = |_, tool, at, rng| crane::turn(&[0.0; 3], tool, at, rng))
        }),
        case("a quarter turn off", "the axis along the fingers for the one across", TURN, || {
            crane(|robot| {
                robot.turn = |base, tool, at, rng| crane::turn(base, tool, at, rng).map(|turn| turn + FRAC_PI_2);
            })
        }),
        case("turned by degrees", "the controller counts in them", TURN, || {
            crane(|robot| robot.turn = |base, tool, at, rng| crane::turn(base, tool, at, rng).map(f64::to_degrees))
        }),
        case("any turn will do", "a turn drawn at random, in the hope that the arm reaches it", TURN, || {
            crane(|robot| robot.turn = |_, _, _, rng| Some(rng.random_range(-3.0..3.0)))
        }),
        case("no turn at all", "as it is, it says", TURN, || crane(|robot| robot.turn = |_, _, _, _| Some(0.0))),
        case("turned by no number", "an arc sine of what rounding made larger than 1", TURN, || {
            crane(|robot| robot.turn = |_, _, _, _| Some(f64::NAN))
        }),
        case("turned about the tool, not the centre", "near where it works, never where it is used", TURN, || {
            crane(|robot| {
                robot.turn = |base, tool, at, rng| {
                    let is_at_tool = (tool.translation.vector.xy() - at.coords).norm() < 1e-6;
                    crane::turn(base, tool, at, rng).map(|turn| if is_at_tool { turn } else { 0.5 * turn + 1.0 })
                };
            })
        }),
        case("turned by its own generator", "now this way round, now that way", SEEDED, || {
            crane(|robot| {
                robot.turn = |base, tool, at, rng| {
                    let aside = f64::from(CALLS.fetch_add(1, Ordering::Relaxed) % 3) * 1e-12;
                    crane::turn(base, tool, at, rng).map(|turn| turn + aside)
                };
            })
        }),
        case("never turned", "left at the default, for an arm of two joints", TURN_FINDS, || {
            crane(|robot| robot.turn = |_, _, _, _| None)
        }),
        case("seldom turned", "one draw, which nearly always fails", TURN_FINDS, || {
            crane(|robot| {
                robot.turn = |base, tool, at, rng| {
                    let is_lucky = rng.random_bool(0.06);
                    crane::turn(base, tool, at, rng).filter(|_| is_lucky)
                };
            })
        }),
    ]
}
