//! Broken goals and samplers.

use rand::{Rng, RngExt};

use super::super::bench::{Bench, cart, cart_at, robot_at, sample};
use super::super::motions::random_state;
use super::super::samplers::Dice;
use super::super::{Case, inputs, seed};
use super::CASES;
use crate::goal::{Goal, Reach, Region};
use crate::laws::goal::{DISCERNS, FITS, NAN};
use crate::laws::sampler::{FILLS, INSIDE};
use crate::laws::watch::RETURNS;
use crate::laws::{Broken, check_goal, check_sampler, check_sampler_covers};
use crate::partial::PartialState;
use crate::sample::{RandomSubset, Sampler};
use crate::state::State;

type Test = fn(&Bench, &State<Bench>) -> bool;
type Draw = fn(&Bench, &mut dyn Rng) -> Option<PartialState<Bench>>;

fn goal(test: Test, draw: Draw) -> Result<(), Broken> {
    let goal: Box<dyn Goal<Bench>> = Box::new(Region::new(Box::new(test), Box::new(draw)));
    let m = Bench::default();
    (0..CASES).try_for_each(|i| check_goal(&m, &*goal, &random_state(&mut inputs(i)), seed() + i))
}

fn sampler(sampler: &dyn Sampler<Bench>) -> Result<(), Broken> {
    let (m, goal) = (Bench::default(), Reach::new(robot_at([3.5, 0.0])));
    (0..CASES).try_for_each(|i| check_sampler(&m, sampler, &goal, seed() * CASES + i))?;
    check_sampler_covers(&m, sampler, &goal, 512, seed())
}

/// The robot on the last metre of the rail.
fn on_last_metre(_: &Bench, state: &State<Bench>) -> bool {
    state.robot[0] >= 3.0
}

fn draw_last_metre(rng: &mut dyn Rng) -> PartialState<Bench> {
    robot_at([rng.random_range(3.0..=4.0), 0.0])
}

pub(super) fn cases() -> Vec<Case> {
    [goals(), samplers()].concat()
}

fn goals() -> Vec<Case> {
    let case = |name, wrong, law, broken| Case {
        name,
        wrong,
        law,
        broken,
        honest: || goal(on_last_metre, |_, rng| Some(draw_last_metre(rng))),
    };
    vec![
        case("not too far", "refuses what is too far away, which NaN is not", NAN, || {
            #[allow(clippy::neg_cmp_op_on_partial_ord, reason = "that is what is wrong with it")]
            let near: Test = |_, state| !(state.robot[0] < 3.0);
            goal(near, |_, rng| Some(draw_last_metre(rng)))
        }),
        case("NaN is clamped", "the error is clamped before it is compared", NAN, || {
            goal(|_, state| (3.0 - state.robot[0]).max(0.0) <= 1e-9, |_, rng| Some(draw_last_metre(rng)))
        }),
        case("always there", "a test that was left at its default", DISCERNS, || {
            goal(|_, _| true, |_, rng| Some(draw_last_metre(rng)))
        }),
        case("always there, and nowhere", "a test that was left at its default, and no samples", DISCERNS, || {
            goal(|_, _| true, |_, _| None)
        }),
        case("one in a thousand is no number", "a sample that divides by what it has drawn", FITS, || {
            goal(on_last_metre, |_, rng| {
                let target = draw_last_metre(rng);
                Some(if rng.random_bool(0.001) { robot_at([f64::NAN, 0.0]) } else { target })
            })
        }),
        case("waits for luck", "draws until a condition holds that can never hold", RETURNS, || {
            goal(on_last_metre, |_, rng| {
                while rng.random_range(0.0..1.0) <= 1.0 {}
                Some(draw_last_metre(rng))
            })
        }),
    ]
}

fn samplers() -> Vec<Case> {
    let case = |name, wrong, law, broken| Case { name, wrong, law, broken, honest: || sampler(&RandomSubset) };
    vec![
        case("half of the room", "never names the second half of the rail", FILLS, || {
            sampler(&Dice(|_, rng| {
                let [x, heading] = sample(rng);
                somebody(rng, [x / 2.0, heading])
            }))
        }),
        case("only where it should end", "the robot is named by the goal alone", FILLS, || {
            sampler(&Dice(|m, rng| {
                if rng.random_bool(0.1) {
                    return robot_at([3.5, 0.0]);
                }
                let id = if rng.random_bool(0.5) { cart() } else { second() };
                PartialState::anywhere(m).with_object(id, sample(rng))
            }))
        }),
        case("ahead only", "never asks anybody to look back", FILLS, || {
            sampler(&Dice(|_, rng| {
                let [x, heading] = sample(rng);
                somebody(rng, [x, heading / 2.0])
            }))
        }),
        case("one in a thousand is no number", "normalises a direction of no length now and then", INSIDE, || {
            sampler(&Dice(|_, rng| {
                let at = sample(rng);
                let is_bad = rng.random_bool(0.001);
                somebody(rng, if is_bad { [at[0], f64::NAN] } else { at })
            }))
        }),
        case("one in a thousand outside", "rounds up at the end of the rail", INSIDE, || {
            sampler(&Dice(|_, rng| {
                let at = sample(rng);
                let is_bad = rng.random_bool(0.001);
                somebody(rng, if is_bad { [4.000_001, at[1]] } else { at })
            }))
        }),
        case("never content", "draws until the target is better than any", RETURNS, || {
            sampler(&Dice(|_, rng| {
                while rng.random_range(0.0..1.0) <= 1.0 {}
                robot_at(sample(rng))
            }))
        }),
    ]
}

fn second() -> crate::state::ObjectId {
    crate::state::ObjectId::new(1)
}

/// One of the three components at `at`.
fn somebody(rng: &mut dyn Rng, at: [f64; 2]) -> PartialState<Bench> {
    match rng.random_range(0..3_u8) {
        0 => robot_at(at),
        1 => cart_at(at),
        _ => PartialState::anywhere(&Bench::default()).with_object(second(), at),
    }
}
