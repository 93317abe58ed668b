//! Costs that are wrong about where the robot comes from, and about where objects may be left on the way.

use std::sync::atomic::{AtomicU32, Ordering};

use rand::{Rng, RngExt};

use super::super::bench::{Bench, Config, RAIL_M, cart, cart_at, robot_at};
use super::super::motions::{drag, random_state};
use super::super::{Case, inputs};
use super::CASES;
use crate::cost::ExecutionCost;
use crate::laws::cost::{FINITE, PURE, STOPOVER};
use crate::laws::watch::PANICS;
use crate::laws::{Broken, check_cost};
use crate::motion::Instance;
use crate::partial::PartialState;
use crate::state::State;

/// What a cost made of functions says besides its seconds.
#[derive(Clone, Copy)]
struct Toll {
    /// By the robot where it comes from, and where it begins.
    arrival: fn(f64, f64) -> f64,
    /// By the cart where it is, and where it will be.
    stopover: fn(Config, Config, &mut dyn Rng) -> Option<PartialState<Bench>>,
}

const FAIR: Toll = Toll {
    arrival: |last, entry| 0.3 * (last - entry).abs(),
    stopover: |at, to, rng| (at != to).then(|| cart_at([at[0] + (to[0] - at[0]) * rng.random_range(0.2..0.8), at[1]])),
};

impl ExecutionCost<Bench> for Toll {
    fn seconds(&self, _: &Bench, motion: &Instance<Bench>, _: &State<Bench>, until: f64) -> f64 {
        motion.motion.length() * until
    }

    fn arrival(&self, _: &Bench, last: &State<Bench>, entry: &State<Bench>, _: &State<Bench>) -> f64 {
        (self.arrival)(last.robot[0], entry.robot[0])
    }

    fn stopover(
        &self,
        _: &Bench,
        from: &State<Bench>,
        to: &State<Bench>,
        rng: &mut dyn Rng,
    ) -> Option<PartialState<Bench>> {
        (self.stopover)(*from.object(cart())?, *to.object(cart())?, rng)
    }
}

fn check(toll: Toll) -> Result<(), Broken> {
    let m = Bench::default();
    for i in 0..CASES / 8 {
        let mut rng = inputs(i);
        let mut from = random_state(&mut rng);
        from.robot[0] = rng.random_range(0.5..2.0);
        from.objects[cart().index()][0] = from.robot[0];
        if let Some(dragged) = drag(&from, rng.random_range(2.5..3.5)) {
            check_cost(&m, &toll, &dragged, &from)?;
        }
    }
    Ok(())
}

static CALLS: AtomicU32 = AtomicU32::new(0);

fn counted() -> f64 {
    f64::from(CALLS.fetch_add(1, Ordering::Relaxed))
}

pub(super) fn cases() -> Vec<Case> {
    let case = |name, wrong, law, broken| Case { name, wrong, law, broken, honest: || check(FAIR) };
    vec![
        case("arrives from nowhere", "divides by the way that it came, which may be none", FINITE, || {
            check(Toll { arrival: |last, entry| (last - entry).powi(2) / (last - entry).abs(), ..FAIR })
        }),
        case("a reward for staying", "what is near is cheaper than nothing", FINITE, || {
            check(Toll { arrival: |last, entry| 0.3 * (last - entry).abs() - 0.1, ..FAIR })
        }),
        case("the first call is free", "the toll is paid once, it remembers", PURE, || {
            check(Toll { arrival: |last, entry| 0.3 * (last - entry).abs() + 1e-9 * counted(), ..FAIR })
        }),
        case("a stop beyond the rail", "half-way is added to the end", STOPOVER, || {
            check(Toll { stopover: |_, to, _| Some(cart_at([to[0] + RAIL_M, to[1]])), ..FAIR })
        }),
        case("stops in turn", "the place of a stop comes from a counter", STOPOVER, || {
            let stopover: fn(Config, Config, &mut dyn Rng) -> _ =
                |at, _, _| Some(cart_at([0.5 + 0.01 * (counted() % 7.0), at[1]]));
            check(Toll { stopover, ..FAIR })
        }),
        case("stops the robot", "names the robot, which nobody can put down", STOPOVER, || {
            check(Toll { stopover: |at, _, _| Some(robot_at(at)), ..FAIR })
        }),
        case("a stop at a post", "takes for granted that there is a post to the left of the cart", PANICS, || {
            check(Toll {
                stopover: |at, to, _| {
                    let post = [0.8, 2.0].into_iter().rfind(|x| *x < at[0]);
                    assert!(post.is_some(), "a post to the left of {at:?}");
                    Some(cart_at(to))
                },
                ..FAIR
            })
        }),
    ]
}
