//! What others wrote: faults of the same kinds that nobody had in mind when the laws were made.

use std::sync::Arc;

use rand::{Rng, RngExt};

use super::super::bench::{self, Bench, Rule, Sketch, cart_at, inside, name, robot_at, sample};
use super::super::motions::{go, random_state};
use super::super::{Case, inputs, seed};
use super::CASES;
use crate::distance::Distance;
use crate::goal::Region;
use crate::laws::distance::RESOLVES;
use crate::laws::goal::ASKS;
use crate::laws::space::{DIMENSION, EVEN, SAMPLE_FILLS};
use crate::laws::validity::{CUT, INSIDE, LAX};
use crate::laws::watch::PANICS;
use crate::laws::{
    Broken, SpaceClaims, ValidityClaims, check_by_oracle, check_component_space, check_distance, check_goal,
    check_space_covers, check_validity,
};
use crate::partial::PartialState;
use crate::state::{ComponentId, ComponentSet, ObjectId, State};
use crate::validity::{Blame, BlockKind, FreePrefix};

fn space(space: Sketch) -> Result<(), Broken> {
    for i in 0..CASES {
        let mut rng = inputs(i);
        let [a, b, c] = [(); 3].map(|()| sample(&mut rng));
        check_component_space(&space, &SpaceClaims::default(), [&a, &b, &c], [0.3, 0.6], seed() + i)?;
    }
    check_space_covers(&space, 1024, seed())
}

struct Gauge(fn(&Bench, &State<Bench>, &PartialState<Bench>) -> f64);

impl Distance<Bench> for Gauge {
    fn distance(&self, m: &Bench, from: &State<Bench>, to: &PartialState<Bench>) -> f64 {
        (self.0)(m, from, to)
    }
}

/// The sum over all named components.
fn metres(m: &Bench, from: &State<Bench>, to: &PartialState<Bench>) -> f64 {
    let there = to.overlay(m, from);
    let objects = from.objects.iter().zip(&there.objects).map(|(p, q)| bench::distance(p, q));
    objects.fold(bench::distance(&from.robot, &there.robot), |sum, metres| sum + metres)
}

fn distance(metres: fn(&Bench, &State<Bench>, &PartialState<Bench>) -> f64) -> Result<(), Broken> {
    let m = Bench::default();
    (0..CASES / 4).try_for_each(|i| {
        let mut rng = inputs(i);
        let [from, elsewhere] = [(); 2].map(|()| random_state(&mut rng));
        check_distance(&m, &Gauge(metres), &from, &robot_at(sample(&mut rng)), &elsewhere)
    })
}

/// To the end of the rail and beyond it.
fn beyond(rule: Rule) -> Result<(), Broken> {
    let (m, mut rng) = (Bench::default(), inputs(0));
    let mut from = random_state(&mut rng);
    from.robot = [3.9, 0.0];
    from.objects.iter_mut().for_each(|at| at[0] = 0.5);
    let moved = Arc::new(go(&m, &from, [rng.random_range(4.2..5.0), 0.0]));
    let claims = ValidityClaims { same_names: false, ..ValidityClaims::default() };
    check_validity(&m, &rule, &moved, &from, &claims, seed())
}

/// From before the wall into it.
fn into_the_wall(rule: Rule) -> Result<(), Broken> {
    let (m, mut rng) = (Bench::default(), inputs(0));
    let mut from = random_state(&mut rng);
    from.robot = [rng.random_range(0.2..0.6), 0.0];
    from.objects.iter_mut().for_each(|at| at[0] = 3.5);
    let moved = Arc::new(go(&m, &from, [rng.random_range(1.2..1.4), 0.0]));
    let claims = ValidityClaims { same_names: false, ..ValidityClaims::default() };
    check_validity(&m, &rule, &moved, &from, &claims, seed())
}

/// Carts keep 0.2 m from each other, says the oracle.
fn among_carts(rule: Rule) -> Result<(), Broken> {
    let m = Bench::default();
    let free = |_: &Bench, state: &State<Bench>| {
        let [p, q] = [0, 1].map(|i| state.objects.get(i).map_or(f64::NAN, |at| at[0]));
        let clear = state.objects.iter().all(|at| (at[0] - state.robot[0]).abs() >= bench::TOUCH_M);
        (p - q).abs() >= 0.2 && clear && inside(&state.robot) && !(1.0..=1.5).contains(&state.robot[0])
    };
    for i in 0..CASES / 16 {
        let mut rng = inputs(i);
        let states: Vec<_> = (0..16).map(|_| random_state(&mut rng)).collect();
        check_by_oracle(&m, &rule, &free, &states.iter().collect::<Vec<_>>(), seed() + i)?;
    }
    Ok(())
}

fn goal(test: fn(&Bench, &State<Bench>) -> bool) -> Result<(), Broken> {
    let both = |m: &Bench, rng: &mut dyn Rng| {
        let robot = [rng.random_range(3.0..=4.0), 0.0];
        Some(cart_at([rng.random_range(0.0..=1.0), 0.0]).with_robot(m, robot))
    };
    let goal = Region::<Bench>::new(Box::new(test), Box::new(both));
    let m = Bench::default();
    (0..CASES).try_for_each(|i| check_goal(&m, &goal, &random_state(&mut inputs(i)), seed() + i))
}

/// The rule of the bench, and a room of `least_m` between the carts.
fn spaced(wall: (f64, f64), state: &State<Bench>, contacts: ComponentSet, least_m: f64) -> Result<(), Blame> {
    let [p, q] = [0, 1].map(|i| state.objects.get(i).map_or(f64::NAN, |at| at[0]));
    if (p - q).abs() < least_m {
        let [first, second] = [0, 1].map(|i| name(ComponentId::Object(ObjectId::new(i))));
        return Err(Blame { first: first.into(), ..bench::blame(BlockKind::ObjectObject, &second, p) });
    }
    bench::check(wall, state, contacts)
}

pub(super) fn cases() -> Vec<Case> {
    [of_spaces(), of_others()].concat()
}

fn of_spaces() -> Vec<Case> {
    let case = |name, wrong, law, broken| Case { name, wrong, law, broken, honest: || space(Sketch::default()) };
    vec![
        case("never near the end", "the rail ends 0.3 m too early for whoever draws", SAMPLE_FILLS, || {
            space(Sketch { sample: |rng| [rng.random_range(0.0..=3.7), sample(rng)[1]], ..Sketch::default() })
        }),
        case("a lattice", "positions are drawn as whole decimetres", SAMPLE_FILLS, || {
            space(Sketch {
                sample: |rng| [f64::from(rng.random_range(0..=40)) / 10.0, sample(rng)[1]],
                ..Sketch::default()
            })
        }),
        case("always ahead", "the heading is left at 0", SAMPLE_FILLS, || {
            space(Sketch { sample: |rng| [sample(rng)[0], 0.0], ..Sketch::default() })
        }),
        case("one dimension for each joint of another robot", "a number copied from elsewhere", DIMENSION, || {
            space(Sketch { dimension: 7, ..Sketch::default() })
        }),
        case("one dimension too few", "the heading was added later, and not counted", DIMENSION, || {
            space(Sketch { dimension: 1, ..Sketch::default() })
        }),
        case("one draw for both", "position and heading come from the same number", SAMPLE_FILLS, || {
            space(Sketch {
                sample: |rng| {
                    let share: f64 = rng.random_range(0.0..=1.0);
                    [4.0 * share, 6.0 * share - 3.0]
                },
                ..Sketch::default()
            })
        }),
        case("a corner is cut", "far along the rail it never looks to the left", SAMPLE_FILLS, || {
            space(Sketch {
                sample: |rng| loop {
                    let q = sample(rng);
                    if q[0] < 3.0 || q[1] < 1.5 {
                        return q;
                    }
                },
                ..Sketch::default()
            })
        }),
        case("a fine lattice", "positions are drawn in whole centimetres", SAMPLE_FILLS, || {
            space(Sketch {
                sample: |rng| [f64::from(rng.random_range(0..=400)) / 100.0, sample(rng)[1]],
                ..Sketch::default()
            })
        }),
        case(
            "the long way round",
            "the heading goes from one angle to the other without a look at the circle",
            EVEN,
            || {
                space(Sketch {
                    interpolate: |a, b, t| {
                        let between = |i: usize| a[i] + (b[i] - a[i]) * t;
                        if t <= 0.0 {
                            *a
                        } else if t >= 1.0 {
                            *b
                        } else {
                            [between(0), between(1)]
                        }
                    },
                    ..Sketch::default()
                })
            },
        ),
    ]
}

fn of_others() -> Vec<Case> {
    vec![
        Case {
            name: "steps of a decimetre",
            wrong: "a distance that is looked up in a table of decimetres",
            law: RESOLVES,
            broken: || distance(|m, from, to| (10.0 * metres(m, from, to)).ceil() / 10.0),
            honest: || distance(metres),
        },
        Case {
            name: "single precision",
            wrong: "the sum is kept in single precision: far away small steps make no difference",
            law: RESOLVES,
            broken: || distance(|m, from, to| single(metres(m, from, to))),
            honest: || distance(metres),
        },
        Case {
            name: "saturates smoothly",
            wrong: "a hyperbolic tangent keeps it below a metre: all that is far is equally far",
            law: RESOLVES,
            broken: || distance(|m, from, to| (4.0 * metres(m, from, to)).tanh()),
            honest: || distance(metres),
        },
        Case {
            name: "short ways are free",
            wrong: "no looks at motions of less than two centimetres: the number of steps is rounded down",
            law: CUT,
            broken: || {
                into_the_wall(Rule {
                    free_prefix: |rule, m, motion, from| {
                        let is_short = motion.motion.length() < 0.02;
                        if is_short { FreePrefix::FREE } else { bench::scan(rule, m, motion, from, 1e-3) }
                    },
                    ..Rule::default()
                })
            },
            honest: || into_the_wall(Rule::default()),
        },
        Case {
            name: "a table that ends with the rail",
            wrong: "looks up the cell of the robot in a table of just the cells that there are",
            law: PANICS,
            broken: || {
                into_the_wall(Rule {
                    check: |wall, state, contacts| {
                        let cell = (10.0 * state.robot[0]).floor();
                        assert!(!cell.is_finite() || (0.0..=40.0).contains(&cell), "index out of bounds");
                        bench::check(wall, state, contacts)
                    },
                    ..Rule::default()
                })
            },
            honest: || into_the_wall(Rule::default()),
        },
        Case {
            name: "no ends",
            wrong: "the ends of the rail are left to whoever proposes motions",
            law: INSIDE,
            broken: || beyond(Rule { check: |_, state, _| finite(state), ..Rule::default() }),
            honest: || beyond(Rule::default()),
        },
        Case {
            name: "carts may meet",
            wrong: "only the robot is looked at: nobody asks whether objects collide with each other",
            law: LAX,
            broken: || among_carts(Rule::default()),
            honest: || among_carts(Rule { check: |w, s, c| spaced(w, s, c, 0.2), ..Rule::default() }),
        },
        Case {
            name: "carts are a little too small",
            wrong: "the radius of one of the two is a centimetre short",
            law: LAX,
            broken: || among_carts(Rule { check: |w, s, c| spaced(w, s, c, 0.19), ..Rule::default() }),
            honest: || among_carts(Rule { check: |w, s, c| spaced(w, s, c, 0.2), ..Rule::default() }),
        },
        Case {
            name: "half a goal",
            wrong: "samples for robot and cart, of which only the robot is looked at",
            law: ASKS,
            broken: || goal(|_, state| state.robot[0] >= 3.0),
            honest: || goal(|_, state| state.robot[0] >= 3.0 && state.objects.first().is_some_and(|at| at[0] <= 1.0)),
        },
    ]
}

/// On the rail without ends.
fn finite(state: &State<Bench>) -> Result<(), Blame> {
    let is_finite = state.objects.iter().chain([&state.robot]).flatten().all(|x| x.is_finite());
    if is_finite { Ok(()) } else { Err(bench::blame(BlockKind::Limits, "no number", 0.0)) }
}

/// In single precision.
fn single(value: f64) -> f64 {
    #[expect(clippy::cast_possible_truncation, reason = "that is the fault")]
    let single = value as f32;
    f64::from(single)
}
