//! Broken spaces.

use std::cell::Cell;
use std::collections::HashMap;
use std::f64::consts::PI;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};
use std::time::SystemTime;

use rand::{Rng, RngExt};

use super::super::bench::{self, Config, Sketch};
use super::super::{Case, inputs, seed};
use super::CASES;
use crate::laws::space::{
    DEAF, DIMENSION, FINITE, NAN, NAN_FAR, PLACE_INSIDE, PLACE_SEEDED, PURE, RESOLVES, SAMPLE_FILLS, SAMPLE_INSIDE,
    TOLERANCE_SMALL, TRIANGLE,
};
use crate::laws::watch::PANICS;
use crate::laws::{Broken, SpaceClaims, check_component_space, check_space_covers};
use crate::space::so2::turn;

/// Any three configurations of the honest space, any two parameters.
fn check(space: Sketch) -> Result<(), Broken> {
    check_with(space, &SpaceClaims::default())
}

fn check_with(space: Sketch, claims: &SpaceClaims) -> Result<(), Broken> {
    for i in 0..CASES {
        let mut rng = inputs(i);
        let [a, b, c] = [(); 3].map(|()| bench::sample(&mut rng));
        let ts = [rng.random_range(0.0..=1.0), rng.random_range(0.0..=1.0)];
        check_component_space(&space, claims, [&a, &b, &c], ts, seed() + i)?;
    }
    check_space_covers(&space, 1024, seed())
}

fn case(name: &'static str, wrong: &'static str, law: &'static str, broken: fn() -> Result<(), Broken>) -> Case {
    Case { name, wrong, law, broken, honest: || check(Sketch::default()) }
}

pub(super) fn cases() -> Vec<Case> {
    [numbers(), purity(), resolution(), samples()].concat()
}

fn numbers() -> Vec<Case> {
    vec![
        case("negated bounds", "outside is what is below or above, and NaN is neither", NAN, || {
            check(Sketch {
                contains: |[x, heading]| !(*x < 0.0 || *x > bench::RAIL_M || heading.abs() > PI),
                ..Sketch::default()
            })
        }),
        case("only the heading has bounds", "positions without end, infinity among them", NAN, || {
            check(Sketch { contains: |[_, heading]| heading.abs() <= PI, ..Sketch::default() })
        }),
        case("NaN is the smaller", "takes the maximum of the distance and 0, which drops NaN", NAN_FAR, || {
            check(Sketch { distance: |a, b| bench::distance(a, b).max(0.0), ..Sketch::default() })
        }),
        case("no way is a short way", "what is not positive is zero, NaN among it", NAN_FAR, || {
            check(Sketch {
                distance: |a, b| {
                    let metres = bench::distance(a, b);
                    if metres > 0.0 { metres } else { 0.0 }
                },
                ..Sketch::default()
            })
        }),
        case("root of less than nothing", "the farthest pairs have a distance that is no number", FINITE, || {
            check(Sketch {
                distance: |a, b| {
                    let metres = bench::distance(a, b);
                    // A chord of a circle that is a little too small.
                    if metres > 6.5 { (6.5 - metres).sqrt() } else { metres }
                },
                ..Sketch::default()
            })
        }),
        case("asserts what is near the end", "panics for the last centimetre of the rail", PANICS, || {
            check(Sketch {
                index_coordinates: |q| {
                    assert!(q[0] < 3.995, "past the end of the table");
                    bench::index_coordinates(q)
                },
                ..Sketch::default()
            })
        }),
        case("angles of NaN", "a match on the sign that forgets what has none", PANICS, || {
            check(Sketch {
                overlay: |from, target, groups| match target[1].partial_cmp(&0.0) {
                    Some(_) => bench::overlay(from, target, groups),
                    None => unreachable!("an angle is positive, negative or zero"),
                },
                ..Sketch::default()
            })
        }),
    ]
}

fn purity() -> Vec<Case> {
    static CALLS: AtomicU64 = AtomicU64::new(0);
    thread_local! {
        static LAST: Cell<[f64; 2]> = const { Cell::new([0.0; 2]) };
    }
    vec![
        case("clock in the way", "the interpolation is dithered by the time of day", PURE, || {
            check(Sketch {
                interpolate: |a, b, t| {
                    let now = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).map_or(0, |d| d.subsec_nanos());
                    let [x, heading] = bench::interpolate(a, b, t);
                    if !(1.0..=3.0).contains(&x) || t <= 0.0 || t >= 1.0 {
                        [x, heading]
                    } else {
                        [x + f64::from(now % 1000) * 1e-13, heading]
                    }
                },
                ..Sketch::default()
            })
        }),
        case("order of a hash map", "sums the parts of a distance in the order of a hash map", PURE, || {
            check(Sketch {
                distance: |a, b| {
                    let metres = bench::distance(a, b);
                    // Many parts of different size: their sum depends on the order in the last digits.
                    let parts: HashMap<u32, f64> = (1..=16).map(|i| (i, metres / f64::from(i * i * i))).collect();
                    #[allow(clippy::iter_over_hash_type, reason = "that is what is wrong with it")]
                    let sum = parts.values().fold(0.0, |sum, part| sum + part);
                    sum * 0.84
                },
                ..Sketch::default()
            })
        }),
        case("warms up", "the first distances are computed coarsely, for speed", PURE, || {
            LAST.set([0.0; 2]);
            check(Sketch {
                distance: |a, b| {
                    let [count, _] = LAST.get();
                    LAST.set([count + 1.0, 0.0]);
                    bench::distance(a, b) * if count % 64.0 < 1.0 { 1.0 + 1e-11 } else { 1.0 }
                },
                ..Sketch::default()
            })
        }),
        case("a space that grows", "the bounds widen with every question", PURE, || {
            CALLS.store(0, Ordering::Relaxed);
            check(Sketch {
                index_coordinates: |q| {
                    let calls = CALLS.fetch_add(1, Ordering::Relaxed) as f64;
                    let [x, sine] = bench::index_coordinates(q);
                    [x * (1.0 - 1e-12 * calls), sine]
                },
                ..Sketch::default()
            })
        }),
    ]
}

fn resolution() -> Vec<Case> {
    vec![
        case("dimension left at 0", "the number of degrees of freedom was never filled in", DIMENSION, || {
            check(Sketch { dimension: 0, ..Sketch::default() })
        }),
        case("tolerance of a metre", "so large that nearly everything counts as reached", TOLERANCE_SMALL, || {
            check(Sketch { tolerance: 1.0, ..Sketch::default() })
        }),
        case("nothing below five centimetres", "small distances are rounded down to nothing", RESOLVES, || {
            check(Sketch {
                distance: |a, b| {
                    let metres = bench::distance(a, b);
                    if metres < 0.05 { 0.0 } else { metres }
                },
                index_coordinates: |_| [0.0; 2],
                ..Sketch::default()
            })
        }),
        case("deaf to the heading", "the distance is that of the positions alone", DEAF, || {
            check(Sketch {
                distance: |a, b| (a[0] - b[0]).abs(),
                index_coordinates: |q| [q[0], 0.0],
                ..Sketch::default()
            })
        }),
        case("deaf to the position", "the distance is that of the headings alone", DEAF, || {
            check(Sketch {
                distance: |a, b| turn(a[1], b[1]).abs(),
                index_coordinates: |q| [0.0, q[1].sin()],
                ..Sketch::default()
            })
        }),
        case("squared", "a distance without its root: it adds up too fast", TRIANGLE, || {
            let claims = SpaceClaims { even: false, ..SpaceClaims::default() };
            let distance = |a: &Config, b: &Config| bench::distance(a, b).powi(2);
            check_with(Sketch { distance, index_coordinates: |_| [0.0; 2], ..Sketch::default() }, &claims)
        }),
    ]
}

fn samples() -> Vec<Case> {
    static CALLS: AtomicU32 = AtomicU32::new(0);
    fn rarely(rng: &mut dyn Rng, otherwise: Config) -> Config {
        let honest = bench::sample(rng);
        if rng.random_bool(0.001) { otherwise } else { honest }
    }
    vec![
        case(
            "one in a thousand outside",
            "rounding puts some samples behind the end of the rail",
            SAMPLE_INSIDE,
            || check(Sketch { sample: |rng| rarely(rng, [4.000_001, 0.0]), ..Sketch::default() }),
        ),
        case("one in a thousand is no number", "a rejection that divides by zero now and then", SAMPLE_INSIDE, || {
            check(Sketch { sample: |rng| rarely(rng, [f64::NAN, 0.0]), ..Sketch::default() })
        }),
        case("half of the room", "an integer division: no sample on the second half of the rail", SAMPLE_FILLS, || {
            check(Sketch {
                sample: |rng| [rng.random_range(0.0..=2.0), rng.random_range(-PI..=PI)],
                ..Sketch::default()
            })
        }),
        case("edges beyond the edge", "samples at the edge lie on the far side of it", PLACE_INSIDE, || {
            check(Sketch { sample_at: |rng| Some([-rng.random_range(0.0..=0.1), 0.0]), ..Sketch::default() })
        }),
        case("edges in turn", "samples at the edge come from a counter, not from the generator", PLACE_SEEDED, || {
            check(Sketch {
                sample_at: |_| Some([f64::from(CALLS.fetch_add(1, Ordering::Relaxed) % 19) / 100.0, 0.0]),
                ..Sketch::default()
            })
        }),
    ]
}
