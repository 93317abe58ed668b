//! Straight lines of a hand that does not go straight between two configurations.
#![cfg(feature = "testing")]
#![allow(clippy::unwrap_used, reason = "a test says no more than that it failed")]

use darrt_primitives::action::line::{Line, follow};
use darrt_primitives::testing::gantry::motion::{self, Configuration, Joints};
use darrt_primitives::testing::gantry::{Gantry, TOOL_M};
use darrt_primitives::testing::table::table;
use nalgebra::{Isometry3, UnitQuaternion, Vector3};

/// How far the hand of a crooked gantry is aside, and how far it is turned, when its slides stand at `x`: not at all up
/// to 0, and then on a parabola.
fn crook<const ASIDE: u32, const TURN: u32>(x: f64) -> (Vector3<f64>, UnitQuaternion<f64>) {
    let bow = x.max(0.0).powi(2);
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), f64::from(TURN) * bow);
    (Vector3::y() * f64::from(ASIDE) * bow, turn)
}

fn forward<const ASIDE: u32, const TURN: u32>(q: &Configuration) -> Isometry3<f64> {
    let straight = motion::forward(q);
    let (aside, turn) = crook::<ASIDE, TURN>(q.arm[0] + q.arm[3]);
    Isometry3::from_parts((straight.translation.vector + aside).into(), turn * straight.rotation)
}

/// For a base at the origin and a hand that points down: its slides stand where the hand is.
fn near<const ASIDE: u32, const TURN: u32>(base: &[f64; 3], tool: &Isometry3<f64>, near: &Joints) -> Option<Joints> {
    let (aside, turn) = crook::<ASIDE, TURN>(tool.translation.x);
    let straight = Isometry3::from_parts((tool.translation.vector - aside).into(), turn.inverse() * tool.rotation);
    motion::near(base, &straight, near)
}

/// The way of the hand from x = -0.06 to 0.06 on a gantry as crooked as this, in steps of 0.02.
fn line<const ASIDE: u32, const TURN: u32>() -> Line<Joints> {
    let robot = Gantry { forward: forward::<ASIDE, TURN>, near: near::<ASIDE, TURN>, ..Gantry::new().unwrap() };
    let arm = motion::pointing_down(-0.06, 0.0, 1.0, 0.0);
    let from = motion::forward(&Configuration { base: [0.0; 3], arm });
    assert!((from.translation.vector - Vector3::new(-0.06, 0.0, 1.0 - TOOL_M)).norm() < 1e-12);
    follow(&table(robot).unwrap(), &[0.0; 3], &arm, &from, &(Vector3::x() * 0.12))
}

/// Midway between two steps of length h the hand is c h^2 / 4 beside its line, and 5e-4 m are allowed. The first half of the
/// way is straight.
#[test]
fn steps_are_halved_up_to_three_times_where_the_hand_strays_from_its_line() {
    for (found, arms) in [
        (line::<0, 0>(), 6),
        (line::<4, 0>(), 6),
        (line::<6, 0>(), 3 + 6),
        (line::<19, 0>(), 3 + 6),
        (line::<21, 0>(), 3 + 12),
        (line::<79, 0>(), 3 + 12),
        (line::<81, 0>(), 3 + 24),
        (line::<319, 0>(), 3 + 24),
    ] {
        assert_eq!((found.arms.len(), found.share()), (arms, 1.0));
    }
}

/// From x = 0.06 back: crooked first.
#[test]
fn steps_are_doubled_again_where_the_line_is_straight() {
    let robot = Gantry { forward: forward::<21, 0>, near: near::<21, 0>, ..Gantry::new().unwrap() };
    let start = Configuration { base: [0.0; 3], arm: motion::pointing_down(0.06, -21.0 * 0.06 * 0.06, 1.0, 0.0) };
    let found =
        follow(&table(robot).unwrap(), &[0.0; 3], &start.arm, &forward::<21, 0>(&start), &(-Vector3::x() * 0.12));
    let steps_m: Vec<_> = [0.0].iter().chain(&found.shares).zip(&found.shares).map(|(a, b)| 0.12 * (b - a)).collect();
    // The last short step is the first that is straight; what is left is split into equal steps.
    let short = steps_m.iter().filter(|step_m| **step_m < 0.0051).count();
    let (_, long) = steps_m.split_at(short);
    assert!(short == 13 && long.len() == 4 && long.iter().all(|step_m| *step_m > 0.009), "{steps_m:?}");
    assert_eq!(found.share(), 1.0);
}

#[test]
fn a_turn_of_the_hand_counts_at_the_fingertips() {
    for (found, arms) in [
        (line::<0, 95>(), 6),
        (line::<0, 105>(), 3 + 6),
        // Each alone would be little enough.
        (line::<3, 60>(), 3 + 6),
    ] {
        assert_eq!((found.arms.len(), found.share()), (arms, 1.0));
    }
}

#[test]
fn a_line_ends_where_the_hand_would_stray() {
    let found = line::<330, 0>();
    assert_eq!((found.arms.len(), found.share()), (3, 0.5));
}

#[test]
fn a_line_has_as_few_steps_as_it_may_and_ends_where_the_arm_does() {
    let m = table(Gantry::new().unwrap()).unwrap();
    let highest = motion::LIMITS[2].upper;
    for (wrist, up, arms, share) in [
        (1.0, 0.05, 3, 1.0),
        (1.0, 0.01, 1, 1.0),
        (1.0, 0.0, 1, 1.0),
        (highest - 0.036, 0.1, 3, 0.35),
        (highest, 0.1, 0, 0.0),
    ] {
        let arm = motion::pointing_down(0.0, 0.0, wrist, 0.0);
        let from = motion::forward(&Configuration { base: [0.0; 3], arm });
        let found = follow(&m, &[0.0; 3], &arm, &from, &(Vector3::z() * up));
        assert!(found.arms.len() == arms && (found.share() - share).abs() < 1e-9, "{:?}", found.shares);
    }
}
