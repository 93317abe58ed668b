//! Broken samplers.

use std::sync::atomic::{AtomicU32, Ordering};

use rand::{Rng, RngExt};

use super::Case;
use super::bench::{Bench, cart_at, robot_at, sample};
use crate::goal::{Goal, Reach};
use crate::laws::sampler::{COVERS, INSIDE, NAMES, SEEDED};
use crate::laws::{Broken, check_sampler, check_sampler_covers};
use crate::partial::PartialState;
use crate::sample::{RandomSubset, Sampler};
use crate::space::GroupSet;

type Draw = fn(&Bench, &mut dyn Rng) -> PartialState<Bench>;

/// A sampler made of a function.
pub(super) struct Dice(pub(super) Draw);

impl Sampler<Bench> for Dice {
    fn sample(&self, m: &Bench, _: &dyn Goal<Bench>, rng: &mut dyn Rng) -> PartialState<Bench> {
        (self.0)(m, rng)
    }
}

fn check(sampler: &dyn Sampler<Bench>) -> Result<(), Broken> {
    let (m, goal) = (Bench::default(), Reach::new(robot_at([3.5, 0.0])));
    (0..16).try_for_each(|seed| check_sampler(&m, sampler, &goal, seed))?;
    check_sampler_covers(&m, sampler, &goal, 100, 1)
}

pub(super) fn cases() -> Vec<Case> {
    static CALLS: AtomicU32 = AtomicU32::new(0);
    let case = |name, wrong, law, broken| Case { name, wrong, law, broken, honest: || check(&RandomSubset) };
    vec![
        case("longer rail", "samples the rail of another model", INSIDE, || {
            check(&Dice(|_, rng| robot_at([rng.random_range(0.0..=6.0), 0.0])))
        }),
        case("longer rail, position only", "the same, hidden in a target that names one group", INSIDE, || {
            check(&Dice(|m, rng| {
                PartialState::anywhere(m).with_robot_groups([rng.random_range(0.0..=6.0), 0.0], GroupSet::only(0))
            }))
        }),
        case("may name nothing", "names each component by the toss of a coin, and now and then none", NAMES, || {
            check(&Dice(|m, rng| {
                let s = PartialState::anywhere(m);
                let s = if rng.random_bool(0.5) { s.with_robot(m, sample(rng)) } else { s };
                if rng.random_bool(0.5) { s.with_object(super::bench::cart(), sample(rng)) } else { s }
            }))
        }),
        case("low discrepancy", "a sequence of its own: fine coverage, and no run repeats", SEEDED, || {
            check(&Dice(|_, _| robot_at([f64::from(CALLS.fetch_add(1, Ordering::Relaxed) * 7 % 40) / 10.0, 0.0])))
        }),
        case("never the last object", "an index range that is one too short", COVERS, || {
            check(&Dice(|_, rng| if rng.random_bool(0.5) { robot_at(sample(rng)) } else { cart_at(sample(rng)) }))
        }),
    ]
}
