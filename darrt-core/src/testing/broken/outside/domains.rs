//! Broken domains and distances.

use std::sync::atomic::{AtomicU32, Ordering};

use super::super::bench::{Bench, cart_at, robot_at, sample};
use super::super::distances::Gauge;
use super::super::motions::random_state;
use super::super::{Case, inputs, seed};
use super::CASES;
use crate::distance::{Distance, Euclidean, GreedyVisit};
use crate::laws::distance::{DistanceClaims, FINITE, POSITIVE, RESOLVES, SYMMETRIC, TRIANGLE};
use crate::laws::domain::{PURE, TRAVEL_BETWEEN_SYMMETRIC, TRAVEL_BETWEEN_TRIANGLE};
use crate::laws::nearest::{LINEAR, tree_of};
use crate::laws::{Broken, SpaceClaims, check_distance, check_domain, check_metric, check_nearest};
use crate::partial::PartialState;
use crate::state::{ComponentId, State};

fn domain(m: &Bench) -> Result<(), Broken> {
    for i in 0..CASES / 4 {
        let mut rng = inputs(i);
        let [a, b, c] = [(); 3].map(|()| random_state(&mut rng));
        check_domain(m, &SpaceClaims::default(), [&a, &b, &c], [0.3, 0.8], seed() + i)?;
    }
    Ok(())
}

type Metres = fn(&Bench, &State<Bench>, &PartialState<Bench>) -> f64;

fn honest(m: &Bench, from: &State<Bench>, to: &PartialState<Bench>) -> f64 {
    Euclidean.distance(m, from, to)
}

fn distance(metres: Metres) -> Result<(), Broken> {
    let m = Bench::default();
    for i in 0..CASES {
        let mut rng = inputs(i);
        let [from, elsewhere] = [(); 2].map(|()| random_state(&mut rng));
        for to in [robot_at(sample(&mut rng)), cart_at(sample(&mut rng))] {
            check_distance(&m, &Gauge { metres, nearest: None }, &from, &to, &elsewhere)?;
        }
    }
    Ok(())
}

fn claims(distance: &dyn Distance<Bench>) -> Result<(), Broken> {
    let m = Bench::default();
    let claims = DistanceClaims { symmetric: true, triangle: true };
    (0..CASES).try_for_each(|i| {
        let mut rng = inputs(i);
        let [a, b, c] = [(); 3].map(|()| random_state(&mut rng));
        check_metric(&m, distance, claims, [&a, &b, &c])
    })
}

fn nearest(distance: &dyn Distance<Bench>) -> Result<(), Broken> {
    let m = Bench::default();
    (0..16).try_for_each(|i| {
        let mut rng = inputs(i);
        let states: Vec<_> = (0..12).map(|_| random_state(&mut rng)).collect();
        let tree = tree_of(&m, &random_state(&mut rng), states);
        check_nearest(&m, distance, &tree, &robot_at(sample(&mut rng)))
    })
}

pub(super) fn cases() -> Vec<Case> {
    [domains(), distances(), searches()].concat()
}

fn domains() -> Vec<Case> {
    static CALLS: AtomicU32 = AtomicU32::new(0);
    let case = |name, wrong, law, broken| Case { name, wrong, law, broken, honest: || domain(&Bench::default()) };
    vec![
        case("names that change", "every question gives a component a new number", PURE, || {
            domain(&Bench {
                name: |component| match component {
                    ComponentId::Robot => "robot".to_owned(),
                    ComponentId::Object(_) => format!("cart {}", CALLS.fetch_add(1, Ordering::Relaxed)),
                },
                ..Bench::default()
            })
        }),
        case("one way travel", "uphill counts twice", TRAVEL_BETWEEN_SYMMETRIC, || {
            domain(&Bench { travel_between: |a, b| (b[0] - a[0]).max(2.0 * (a[0] - b[0])), ..Bench::default() })
        }),
        case(
            "far ways are dear",
            "what is farther than a metre counts two and a half times",
            TRAVEL_BETWEEN_TRIANGLE,
            || {
                let dear = |a: &[f64; 2], b: &[f64; 2]| (a[0] - b[0]).abs().max(2.5 * (a[0] - b[0]).abs() - 1.5);
                domain(&Bench { travel_between: dear, ..Bench::default() })
            },
        ),
        case("travel by a counter", "breaks ties with noise of its own", PURE, || {
            domain(&Bench {
                travel_between: |a, b| {
                    (a[0] - b[0]).abs() + 1e-13 * f64::from(CALLS.fetch_add(1, Ordering::Relaxed) % 7)
                },
                ..Bench::default()
            })
        }),
    ]
}

fn distances() -> Vec<Case> {
    let case = |name, wrong, law, broken| Case { name, wrong, law, broken, honest: || distance(honest) };
    vec![
        case("overflows at the far end", "no number for the farthest pairs", FINITE, || {
            distance(|m, from, to| {
                let metres = honest(m, from, to);
                if metres > 6.9 { f64::NAN } else { metres }
            })
        }),
        case(
            "mean over nothing",
            "divides by the number of named components, also when there are none",
            FINITE,
            || {
                distance(|m, from, to| {
                    honest(m, from, to) * to.components().len() as f64 / to.components().len() as f64
                })
            },
        ),
        case("deaf to headings", "measures positions, and calls what is turned away reached", POSITIVE, || {
            distance(|_, from, to| {
                let robot = to
                    .robot()
                    .map_or(0.0, |r| if r.groups.contains(0) { (r.config[0] - from.robot[0]).abs() } else { 0.0 });
                let carts = to.objects().filter_map(|(id, at)| Some((from.object(id)?[0] - at[0]).abs()));
                robot + carts.sum::<f64>()
            })
        }),
        case("all or nothing", "0 where the target is met, and 1 everywhere else", RESOLVES, || {
            distance(|m, from, to| f64::from(u8::from(!to.is_met(m, from))))
        }),
        case("saturates", "nothing is farther than a metre", RESOLVES, || {
            distance(|m, from, to| honest(m, from, to).min(1.0))
        }),
        case(
            "objects count once",
            "an object that is not at its target costs a metre, wherever it is",
            RESOLVES,
            || {
                distance(|m, from, to| {
                    let open = to.objects().filter(|(id, _)| !to.is_object_met(m, from, *id)).count();
                    let robot = PartialState::anywhere(m);
                    let robot = to.robot().map_or(robot.clone(), |r| robot.with_robot_groups(r.config, r.groups));
                    honest(m, from, &robot) + open as f64
                })
            },
        ),
        Case {
            name: "tour there and back",
            wrong: "claims to be symmetric, but a tour begins where the robot is",
            law: SYMMETRIC,
            broken: || claims(&GreedyVisit),
            honest: || claims(&Euclidean),
        },
        Case {
            name: "claims too much",
            wrong: "claims the triangle inequality for a sum of squares",
            law: TRIANGLE,
            broken: || claims(&Gauge { metres: |m, from, to| honest(m, from, to).powi(2), nearest: None }),
            honest: || claims(&Euclidean),
        },
    ]
}

fn searches() -> Vec<Case> {
    let broken: fn() -> Result<(), Broken> = || {
        nearest(&Gauge {
            metres: honest,
            nearest: Some(|m, tree, to| {
                let mut best = None;
                for (id, node) in tree.iter() {
                    let metres = honest(m, &node.state, to);
                    if best.is_none_or(|(_, least)| metres < least) {
                        best = Some((id, metres));
                    }
                }
                best.map(|(id, _)| id)
            }),
        })
    };
    vec![Case {
        name: "deaf to penalties",
        wrong: "a search of its own that compares distances, and forgets the penalties of the tree",
        law: LINEAR,
        broken,
        honest: || nearest(&Euclidean),
    }]
}
