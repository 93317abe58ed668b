//! Broken goals.

use std::sync::atomic::{AtomicU32, Ordering};

use rand::{Rng, RngExt};

use super::Case;
use super::bench::{Bench, cart_at, robot_at, state};
use crate::goal::{Goal, Reach, Region};
use crate::laws::goal::{FITS, PURE, SAMPLED};
use crate::laws::{Broken, check_goal};
use crate::partial::PartialState;
use crate::state::State;

type Test = fn(&Bench, &State<Bench>) -> bool;
type Draw = fn(&Bench, &mut dyn Rng) -> Option<PartialState<Bench>>;

fn check(test: Test, draw: Draw) -> Result<(), Broken> {
    every_seed(&Region::new(Box::new(test), Box::new(draw)))
}

fn every_seed(goal: &dyn Goal<Bench>) -> Result<(), Broken> {
    let (m, from) = (Bench::default(), state([0.5, 0.0]));
    (0..16).try_for_each(|seed| check_goal(&m, goal, &from, seed))
}

/// The robot on the last metre of the rail.
fn on_last_metre(_: &Bench, state: &State<Bench>) -> bool {
    state.robot[0] >= 3.0
}

fn draw_last_metre(rng: &mut dyn Rng) -> PartialState<Bench> {
    robot_at([rng.random_range(3.0..=4.0), 0.0])
}

pub(super) fn cases() -> Vec<Case> {
    static CALLS: AtomicU32 = AtomicU32::new(0);
    let case = |name, wrong, law, broken| Case {
        name,
        wrong,
        law,
        broken,
        honest: || check(on_last_metre, |_, rng| Some(draw_last_metre(rng))),
    };
    vec![
        case("draws beside the goal", "the generator's region is larger than the test's", SAMPLED, || {
            check(on_last_metre, |_, rng| Some(robot_at([rng.random_range(2.5..=4.0), 0.0])))
        }),
        case("bit for bit goal", "asks for equality where the planner works with tolerances", SAMPLED, || {
            let near = |_: &Bench, s: &State<Bench>| s.object(super::bench::cart()) == Some(&[2.0, 0.0]);
            check(near, |_, _| Some(cart_at([2.0 + 5e-10, 0.0])))
        }),
        case("behind the buffer", "asks for a place outside the rail", FITS, || {
            check(|_, state| state.robot[0] > 3.9, |_, rng| Some(robot_at([rng.random_range(4.0..=4.5), 0.0])))
        }),
        case("a new goal every time", "draws from a sequence of its own", PURE, || {
            check(on_last_metre, |_, _| {
                let step = CALLS.fetch_add(1, Ordering::Relaxed) % 7;
                Some(robot_at([3.0 + f64::from(step) / 10.0, 0.0]))
            })
        }),
        Case {
            name: "goal in the wrong mode",
            wrong: "the test wants a mode that no start has; the law says so when that mode is promised",
            law: SAMPLED,
            broken: || every_seed(&Reach::new(robot_at([3.5, 0.0])).in_mode(Box::new(|mode| mode.number() == 1))),
            honest: || every_seed(&Reach::new(robot_at([3.5, 0.0])).in_mode(Box::new(|mode| mode.number() == 0))),
        },
    ]
}
