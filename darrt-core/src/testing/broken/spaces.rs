//! Broken spaces, and domains with broken reach, travel or names.

use std::f64::consts::PI;
use std::sync::atomic::{AtomicU32, Ordering};

use rand::{Rng, RngExt};

use super::Case;
use super::bench::{self, Bench, Config, Sketch, robot_at, state};
use crate::laws::{self, Broken, SpaceClaims, check_component_space, check_covering, check_domain, check_partial};
use crate::partial::PartialState;
use crate::space::so2::{turn, wrap};
use crate::space::{ComponentSpace, GroupSet};
use crate::state::State;

/// Three ordinary configurations.
const TRIPLE: [Config; 3] = [[0.5, 3.0], [3.5, -3.0], [2.0, 0.5]];

fn check(space: Sketch) -> Result<(), Broken> {
    check_at(space, TRIPLE)
}

fn check_at(space: Sketch, [a, b, c]: [Config; 3]) -> Result<(), Broken> {
    check_component_space(&space, &SpaceClaims::default(), [&a, &b, &c], [0.25, 0.6], 1)
}

fn honest() -> Result<(), Broken> {
    check(Sketch::default())
}

pub(super) fn cases() -> Vec<Case> {
    [metrics(), ways(), samples(), index_coordinates(), overlays(), targets(), domains()].concat()
}

fn case(name: &'static str, wrong: &'static str, law: &'static str, broken: fn() -> Result<(), Broken>) -> Case {
    Case { name, wrong, law, broken, honest }
}

fn metrics() -> Vec<Case> {
    use laws::space::{FINITE, GIVEN, SELF, SEPARATES, SYMMETRIC, TOLERANCE, TRIANGLE};
    vec![
        case("open interval", "contains excludes the upper limit, where joints like to stand", GIVEN, || {
            check_at(Sketch { contains: |q| bench::inside(q) && q[0] < 4.0, ..Sketch::default() }, [[4.0, 0.0]; 3])
        }),
        case("angle by arc cosine", "rounding lifts the cosine above 1, and the angle is not a number", FINITE, || {
            let distance = |a: &Config, b: &Config| ((a[1] - b[1]).cos() * (1.0 + f64::EPSILON)).acos();
            check(Sketch { distance, ..Sketch::default() })
        }),
        case("signed distance", "the absolute value is forgotten", FINITE, || {
            check(Sketch { distance: |a, b| a[0] - b[0], ..Sketch::default() })
        }),
        case("lossy self", "distance through single precision sines: not zero to itself", SELF, || {
            check(Sketch { distance: |a, b| 1e-8 + bench::distance(a, b), ..Sketch::default() })
        }),
        case("uphill is longer", "the distance is weighted by the side that one starts from", SYMMETRIC, || {
            check(Sketch { distance: |a, b| bench::distance(a, b) * (1.0 + a[0]), ..Sketch::default() })
        }),
        case("squared metres", "the square root is saved", TRIANGLE, || {
            let space = Sketch { distance: |a, b| (a[0] - b[0]).powi(2), ..Sketch::default() };
            check_at(space, [[0.5, 0.0], [2.0, 0.0], [3.5, 0.0]])
        }),
        case("no weights", "the weights of the coordinates are never filled in", SEPARATES, || {
            check(Sketch { distance: |a, b| bench::distance(a, b) * f64::default(), ..Sketch::default() })
        }),
        case("exact tolerance", "a tolerance of zero, and no target is ever met", TOLERANCE, || {
            check(Sketch { tolerance: 0.0, ..Sketch::default() })
        }),
    ]
}

fn ways() -> Vec<Case> {
    use laws::space::{ENDS, EVEN, INSIDE, MONOTONE, REST};
    vec![
        case("rounded end", "a + (b - a) * t is not b at t = 1", ENDS, || {
            let interpolate =
                |a: &Config, b: &Config, t: f64| [a[0] + (b[0] - a[0]) * t, wrap(a[1] + turn(a[1], b[1]) * t)];
            check_at(Sketch { interpolate, ..Sketch::default() }, [[0.1, 1.0], [1e-17, 2.9], [0.0; 2]])
        }),
        case("wrapped angle", "the angle runs past pi and is not brought back", INSIDE, || {
            check(Sketch { interpolate: |a, b, t| between(a, b, t, a[1] + turn(a[1], b[1]) * t), ..Sketch::default() })
        }),
        case("long way round", "the angle is interpolated as a number: from 3 to -3 it passes 0", MONOTONE, || {
            let interpolate = |a: &Config, b: &Config, t: f64| between(a, b, t, a[1] + (b[1] - a[1]) * t);
            let claims = SpaceClaims { even: false, ..SpaceClaims::default() };
            let [a, b, c] = TRIPLE;
            let space = Sketch { interpolate, ..Sketch::default() };
            check_component_space(&space, &claims, [&a, &b, &c], [0.25, 0.6], 1)
        }),
        case("left-handed", "the turn has the wrong sign on the way, and only the ends are right", EVEN, || {
            let interpolate = |a: &Config, b: &Config, t: f64| between(a, b, t, wrap(a[1] - turn(a[1], b[1]) * t));
            check(Sketch { interpolate, ..Sketch::default() })
        }),
        case(
            "ease in, ease out",
            "a smooth start for the drives: the middle is faster than the length allows",
            EVEN,
            || {
                check(Sketch {
                    interpolate: |a, b, t| bench::interpolate(a, b, t * t * (3.0 - 2.0 * t)),
                    ..Sketch::default()
                })
            },
        ),
        case("unit direction", "divides by the distance, also between equal configurations", REST, || {
            let interpolate = |a: &Config, b: &Config, t: f64| {
                let d = bench::distance(a, b);
                let way = [(b[0] - a[0]) / d, turn(a[1], b[1]) / d];
                if t <= 0.0 || t >= 1.0 {
                    bench::interpolate(a, b, t)
                } else {
                    [a[0] + way[0] * d * t, wrap(a[1] + way[1] * d * t)]
                }
            };
            check(Sketch { interpolate, ..Sketch::default() })
        }),
    ]
}

/// The honest position, and this heading between the ends.
fn between(a: &Config, b: &Config, t: f64, heading: f64) -> Config {
    let [x, honest] = bench::interpolate(a, b, t);
    [x, if t <= 0.0 || t >= 1.0 { honest } else { heading }]
}

fn samples() -> Vec<Case> {
    use laws::space::{SAMPLE_COVERS, SAMPLE_INSIDE, SAMPLE_SEEDED};
    static CALLS: AtomicU32 = AtomicU32::new(0);
    vec![
        case("full turn", "samples angles in [0, 2 pi], but contains wants [-pi, pi]", SAMPLE_INSIDE, || {
            check(Sketch {
                sample: |rng| [rng.random_range(0.0..=4.0), rng.random_range(0.0..=2.0 * PI)],
                ..Sketch::default()
            })
        }),
        case(
            "own generator",
            "samples from a global sequence instead of the caller's generator",
            SAMPLE_SEEDED,
            || {
                let sample = |_: &mut dyn Rng| [f64::from(CALLS.fetch_add(1, Ordering::Relaxed) % 41) / 10.0, 0.0];
                check(Sketch { sample, ..Sketch::default() })
            },
        ),
        Case {
            name: "half a circle",
            wrong: "samples only headings that look ahead",
            law: SAMPLE_COVERS,
            broken: || {
                let sample = |rng: &mut dyn Rng| [rng.random_range(0.0..=4.0), rng.random_range(-PI / 2.0..=PI / 2.0)];
                check_covering(&Sketch { sample, ..Sketch::default() }, &[2.0, 3.0], 0.5, 1000, 1)
            },
            honest: || check_covering(&Sketch::default(), &[2.0, 3.0], 0.5, 1000, 1),
        },
    ]
}

fn index_coordinates() -> Vec<Case> {
    use laws::space::{COORDINATES, COORDINATES_ALIKE};
    vec![
        case(
            "unwrapped index coordinates",
            "the heading as it is: almost a turn apart where the way is short",
            COORDINATES,
            || check(Sketch { index_coordinates: |q| *q, ..Sketch::default() }),
        ),
        Case {
            name: "one coordinate more",
            wrong: "marks the heading only where there is one",
            law: COORDINATES_ALIKE,
            broken: || growing(|q| if q[1] > 0.0 { 2 } else { 1 }, 0),
            honest: || growing(|_| 2, 0),
        },
        Case {
            name: "groups counted from one",
            wrong: "marks its only group as the second",
            law: COORDINATES_ALIKE,
            broken: || growing(|_| 2, 1),
            honest: || growing(|_| 2, 0),
        },
    ]
}

/// The honest space with as many index coordinates as this says, of this group.
struct Marked {
    count: fn(&Config) -> usize,
    group: u32,
}

impl ComponentSpace for Marked {
    type Config = Config;

    fn dimension(&self) -> usize {
        2
    }

    fn contains(&self, q: &Config) -> bool {
        bench::inside(q)
    }

    fn distance(&self, a: &Config, b: &Config) -> f64 {
        bench::distance(a, b)
    }

    fn interpolate(&self, a: &Config, b: &Config, t: f64) -> Config {
        bench::interpolate(a, b, t)
    }

    fn sample(&self, rng: &mut dyn Rng) -> Config {
        bench::sample(rng)
    }

    fn index_coordinates(&self, q: &Config, mark: &mut dyn FnMut(u32, f64)) {
        bench::index_coordinates(q).into_iter().take((self.count)(q)).for_each(|x| mark(self.group, x));
    }
}

fn growing(count: fn(&Config) -> usize, group: u32) -> Result<(), Broken> {
    let [a, b, c] = TRIPLE;
    check_component_space(&Marked { count, group }, &SpaceClaims::default(), [&a, &b, &c], [0.25, 0.6], 1)
}

fn overlays() -> Vec<Case> {
    use laws::space::{OVERLAY_ENDS, OVERLAY_GROUPS, OVERLAY_INSIDE};
    vec![
        case("groups ignored", "a free component is used as a target: overlay takes all of it", OVERLAY_ENDS, || {
            check(Sketch { overlay: |_, target, _| *target, ..Sketch::default() })
        }),
        case(
            "two groups, default overlay",
            "declares groups, but overlays only all or nothing",
            OVERLAY_GROUPS,
            || check(Sketch { overlay: all_or_nothing, ..Sketch::default() }),
        ),
        case("relative target", "a partial target is added instead of set", OVERLAY_INSIDE, || {
            let overlay = |from: &Config, target: &Config, groups: GroupSet| match groups {
                GroupSet::NONE => *from,
                _ if groups.covers(GroupSet::first(2)) => *target,
                _ => [from[0] + target[0], from[1]],
            };
            check_at(Sketch { overlay, ..Sketch::default() }, [[3.0, 0.0], [2.0, 1.0], [0.0; 2]])
        }),
    ]
}

fn all_or_nothing(from: &Config, target: &Config, groups: GroupSet) -> Config {
    if groups.covers(GroupSet::first(2)) { *target } else { *from }
}

fn with_robot(robot: Sketch) -> Bench {
    Bench { robot, ..Bench::default() }
}

fn position_only(x: f64) -> PartialState<Bench> {
    PartialState::anywhere(&Bench::default()).with_robot_groups([x, 1.0], GroupSet::only(0))
}

fn heading_only(heading: f64) -> PartialState<Bench> {
    PartialState::anywhere(&Bench::default()).with_robot_groups([3.9, heading], GroupSet::only(1))
}

/// Targets for position and heading apart, checked in a bench with this space of the robot.
fn partial(robot: Sketch) -> Result<(), Broken> {
    let m = with_robot(robot);
    check_partial(&m, [&position_only(1.0), &heading_only(2.0)], &state([3.0, 0.2]), &state([0.4, -1.5]))
}

fn targets() -> Vec<Case> {
    use laws::partial::{EXTREMES, OVERLAY_KEEPS, OVERLAY_MET, SUBSET, UNION, UNNAMED};
    let case = |name, wrong, law, broken| Case { name, wrong, law, broken, honest: || partial(Sketch::default()) };
    vec![
        case("never there", "a distance that is not zero to itself: what is reached is not met", OVERLAY_MET, || {
            partial(Sketch { distance: |a, b| 1e-8 + bench::distance(a, b), ..Sketch::default() })
        }),
        case("stiff neck", "turns the turret along with the base", OVERLAY_KEEPS, || {
            let overlay = |from: &Config, target: &Config, groups: GroupSet| {
                let [x, heading] = bench::overlay(from, target, groups);
                [x, if groups == GroupSet::only(0) { 0.0 } else { heading }]
            };
            partial(Sketch { overlay, ..Sketch::default() })
        }),
        case("all groups forgotten", "overlay knows the groups one by one, but not all together", EXTREMES, || {
            let overlay = |from: &Config, target: &Config, groups: GroupSet| {
                if groups == GroupSet::first(2) { *from } else { bench::overlay(from, target, groups) }
            };
            partial(Sketch { overlay, ..Sketch::default() })
        }),
        Case {
            name: "peeks at the turret",
            wrong: "drives to a position that it corrects for a heading that nobody asked for",
            law: UNNAMED,
            broken: || {
                let overlay = |from: &Config, target: &Config, groups: GroupSet| {
                    let [x, heading] = bench::overlay(from, target, groups);
                    [if groups.contains(0) { x + 0.1 * target[1] } else { x }, heading]
                };
                unnamed(Sketch { overlay, ..Sketch::default() })
            },
            honest: || unnamed(Sketch::default()),
        },
        Case {
            name: "coordinates cancel",
            wrong: "the absolute value is taken of the sum, so errors in two groups make up for each other",
            law: SUBSET,
            broken: || {
                let distance = |a: &Config, b: &Config| ((a[0] - b[0]) + turn(b[1], a[1])).abs();
                subset(Sketch { distance, ..Sketch::default() })
            },
            honest: || subset(Sketch::default()),
        },
        case(
            "two groups, default overlay, in a target",
            "position and heading apart are lost in the union",
            UNION,
            || partial(Sketch { overlay: all_or_nothing, ..Sketch::default() }),
        ),
    ]
}

/// A position alone, from a state that looks straight ahead.
fn unnamed(robot: Sketch) -> Result<(), Broken> {
    let m = with_robot(robot);
    check_partial(&m, [&position_only(1.0), &heading_only(2.0)], &state([3.0, 0.0]), &state([0.4, -1.5]))
}

/// The position of a full target, and the full target, at a state that is off by 0.5 in both groups.
fn subset(robot: Sketch) -> Result<(), Broken> {
    let m = with_robot(robot);
    check_partial(&m, [&position_only(1.0), &robot_at([1.0, 1.0])], &state([1.5, 0.5]), &state([2.0, 2.0]))
}

fn domains() -> Vec<Case> {
    use laws::domain::{COUNT, MAY_GO_ON, NAMES, POINT, REACH, REACH_AT_LEAST, REACH_FROM, TRAVEL_BETWEEN};
    let case = |name, wrong, law, broken| Case { name, wrong, law, broken, honest: || domain(&Bench::default()) };
    vec![
        case("inside the object", "reach subtracts the radius of the object, and is negative inside it", REACH, || {
            domain(&Bench { reach: |robot, at| (robot[0] - at[0]).abs() - 5.0, ..Bench::default() })
        }),
        case(
            "another working point",
            "the short cut measures in the plane, the long way along the rail",
            REACH_FROM,
            || domain(&Bench { reach_from: |point, at| (point[0] - at[0]).hypot(at[1] / 10.0), ..Bench::default() }),
        ),
        case("point in millimetres", "the point of an object is given in another unit", POINT, || {
            let reach_at_least = |_| 0.0;
            let (a, b) = (state([0.5, 3.0]), [[0.2, 2.0], [1.1, -2.0]].into_iter().collect());
            let b = State { objects: b, ..a.clone() };
            let m = Bench { object_point: |at| 1000.0 * at[0], reach_at_least, ..Bench::default() };
            check_domain(&m, &SpaceClaims::default(), [&a, &b, &a], [0.25, 0.6], 1)
        }),
        case("there and back again", "bounds the reach by twice the gap", REACH_AT_LEAST, || {
            domain(&Bench { reach_at_least: |gap_m| 2.0 * gap_m, ..Bench::default() })
        }),
        case("normalised travel", "divides by the distance of two objects at the same place", TRAVEL_BETWEEN, || {
            domain(&Bench { travel_between: |a, b| (a[0] - b[0]).powi(2) / (a[0] - b[0]).abs(), ..Bench::default() })
        }),
        case("only ever onwards", "asks for a later mode, and so refuses the very one", MAY_GO_ON, || {
            domain(&Bench { may_go_on: |mode, next| mode.number() < next.number(), ..Bench::default() })
        }),
        case("all called cart", "two objects of one name: nobody can tell what blocked", NAMES, || {
            domain(&Bench { name: |_| "cart".to_owned(), ..Bench::default() })
        }),
        case("one cart missing", "a state without a configuration for the last object", COUNT, || {
            let mut short = state([0.5, 0.0]);
            short.objects.pop();
            check_domain(&Bench::default(), &SpaceClaims::default(), [&short; 3], [0.25, 0.6], 1)
        }),
    ]
}

fn domain(m: &Bench) -> Result<(), Broken> {
    let [a, b, c] = TRIPLE.map(state);
    check_domain(m, &SpaceClaims::default(), [&a, &b, &c], [0.25, 0.6], 1)
}
