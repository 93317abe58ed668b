//! Robots with two hands that are wrong about which of them is meant.

use darrt_core::laws::Broken;

use super::{Case, unusable};
use crate::joints::Joints;
use crate::laws::manipulator::{HANDS_GAP, HANDS_IDLE, HANDS_INVERSE, HANDS_LINKS, HANDS_OTHERS, MAY_REACH};
use crate::laws::{ManipulatorClaims, check_manipulator};
use crate::manipulator::{Configuration, JointVector as _};
use crate::testing::twins::{self, BASE, Twins};

/// All laws of the robot with this change, for each of its hands.
fn twins(change: fn(&mut Twins)) -> Result<(), Broken> {
    let mut robot = Twins::new().map_err(unusable)?;
    change(&mut robot);
    let seed = darrt_core::testing::broken::seed();
    let at = |values: [f64; 8], hand: usize| -> Result<Configuration<Joints>, Broken> {
        let arm = Joints::from_values(&values).ok_or_else(|| unusable("too many joints"))?;
        Ok(Configuration { base: BASE, arm: arm.with_hand_at_work(hand) })
    };
    for hand in 0..2 {
        let a = at([-0.6, 0.1, 1.0, 0.4, 0.5, -0.2, 1.1, -0.7], hand)?;
        let b = at([-0.1, -0.3, 1.3, -1.1, 0.1, 0.4, 0.8, 0.9], hand)?;
        check_manipulator(&robot, [&a, &b], [0.02, 0.09], seed, &ManipulatorClaims::default())?;
    }
    Ok(())
}

fn case(name: &'static str, wrong: &'static str, law: &'static str, broken: fn() -> Result<(), Broken>) -> Case {
    Case { name, wrong, law, broken, honest: || twins(|_| {}) }
}

pub(super) fn cases() -> Vec<Case> {
    vec![
        case("one hand has all fingers", "left at the default", HANDS_LINKS, || {
            twins(|robot| robot.hand_of_link = |_| 0)
        }),
        case("hands counted from one", "the second hand is number 2", HANDS_LINKS, || {
            twins(|robot| robot.hand_of_link = |link| 1 + link / 3)
        }),
        case("the other arm goes home", "a solution is filled up with zeros", HANDS_INVERSE, || {
            twins(|robot| {
                robot.inverse_from = |now, base, tool| {
                    let home = Joints::zeros(8)?.with_hand_at_work(now.hand_at_work());
                    twins::inverse_from(&home, base, tool)
                };
            })
        }),
        case("always the first hand at work", "a solution is a new vector", HANDS_INVERSE, || {
            twins(|robot| {
                robot.inverse_from = |now, base, tool| Some(twins::inverse_from(now, base, tool)?.with_hand_at_work(0));
            })
        }),
        case("all arms in the posture", "the hand at work too", HANDS_OTHERS, || {
            twins(|robot| robot.with_others_at = |now, posture| posture.with_hand_at_work(now.hand_at_work()))
        }),
        case("the others stay", "left at the default", HANDS_OTHERS, || {
            twins(|robot| robot.with_others_at = |now, _| *now)
        }),
        case("idle hands wide open", "wider than a hand opens", HANDS_IDLE, || {
            twins(|robot| robot.idle_gap_m = || 0.2)
        }),
        case("one gap for all", "all grippers on one line", HANDS_GAP, || twins(|robot| robot.opens_all = true)),
        case("reach of the first hand", "the quick test forgets which hand is meant", MAY_REACH, || {
            twins(|robot| {
                let first: fn(usize, &[f64; 3], &nalgebra::Isometry3<f64>) -> bool =
                    |_, base, tool| Twins::new().is_ok_and(|robot| (robot.may_reach_with)(0, base, tool));
                robot.may_reach_with = first;
            })
        }),
    ]
}
