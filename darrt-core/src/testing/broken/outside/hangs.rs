//! Calls that never come back. They sleep, so that the threads that are left behind cost nothing.

use std::time::Duration;

use rand::Rng;

use super::super::bench::{Act, Bench, Rule, Sketch, distance, inside, interpolate, robot_at, sample, state};
use super::super::distances::Gauge;
use super::super::motions::{Reel, go, instance};
use super::super::samplers::Dice;
use super::super::{Case, seed};
use crate::goal::{Reach, Region};
use crate::laws::watch::RETURNS;
use crate::laws::{
    Broken, MotionClaims, SpaceClaims, ValidityClaims, check_component_space, check_distance, check_goal,
    check_instance, check_primitive, check_sampler, check_validity, or_abandon, with_patience,
};
use crate::state::{ComponentSet, State};

/// How long nobody waits for a rail, seconds.
const PATIENCE_S: f64 = 0.1;

/// Never comes back.
fn forever() {
    loop {
        std::thread::sleep(Duration::from_secs(3600));
    }
}

/// On a thread that can be left behind.
fn abandon(check: fn() -> Result<(), Broken>) -> Result<(), Broken> {
    with_patience(PATIENCE_S, || or_abandon(check))
}

/// The same for what does come back, however busy the machine is.
fn wait_for(check: fn() -> Result<(), Broken>) -> Result<(), Broken> {
    or_abandon(check)
}

const GO: Act = Act {
    useful: |m, from, to| !to.is_robot_met(m, from),
    approach: |_, _, _| None,
    propagate: |m, from, to, _| Ok(vec![go(m, from, to.robot_overlay(m, &from.robot))]),
};

fn primitive(act: Act) -> Result<(), Broken> {
    check_primitive(&Bench::default(), &act, &state([0.5, 0.1]), &robot_at([3.0, 0.3]), seed())
}

fn space(space: Sketch) -> Result<(), Broken> {
    let [a, b, c] = [[0.5, 0.1], [3.0, 0.2], [2.0, 0.3]];
    check_component_space(&space, &SpaceClaims::default(), [&a, &b, &c], [0.3, 0.6], seed())
}

fn validity(rule: Rule) -> Result<(), Broken> {
    let (m, from) = (Bench::default(), state([0.5, 0.1]));
    let instance = std::sync::Arc::new(go(&m, &from, [0.9, 0.2]));
    check_validity(&m, &rule, &instance, &from, &ValidityClaims::default(), seed())
}

fn ahead(t: f64, out: &mut State<Bench>) {
    *out = state([0.5, 0.1]);
    out.robot[0] += t.clamp(0.0, 1.0);
}

fn motion(at: fn(f64, &mut State<Bench>)) -> Result<(), Broken> {
    let instance = instance(Reel { length_m: 1.0, at }, ComponentSet::ROBOT);
    check_instance(&Bench::default(), &instance, &state([0.5, 0.1]), &[0.5], &MotionClaims::default())
}

fn metres(metres: fn(&Bench, &State<Bench>, &crate::partial::PartialState<Bench>) -> f64) -> Result<(), Broken> {
    let (from, elsewhere) = (state([0.5, 0.1]), state([3.0, 0.2]));
    let gauge = Gauge { metres, nearest: None };
    check_distance(&Bench::default(), &gauge, &from, &robot_at([2.0, 0.4]), &elsewhere)
}

fn honest_metres(m: &Bench, from: &State<Bench>, to: &crate::partial::PartialState<Bench>) -> f64 {
    crate::distance::Distance::<Bench>::distance(&crate::distance::Euclidean, m, from, to)
}

fn goal(test: fn(&Bench, &State<Bench>) -> bool) -> Result<(), Broken> {
    let draw = |_: &Bench, _: &mut dyn Rng| Some(robot_at([3.5, 0.0]));
    check_goal(&Bench::default(), &Region::new(Box::new(test), Box::new(draw)), &state([0.5, 0.0]), seed())
}

fn sampler(draw: fn(&Bench, &mut dyn Rng) -> crate::partial::PartialState<Bench>) -> Result<(), Broken> {
    check_sampler(&Bench::default(), &Dice(draw), &Reach::new(robot_at([3.5, 0.0])), seed())
}

fn case(
    name: &'static str,
    wrong: &'static str,
    broken: fn() -> Result<(), Broken>,
    honest: fn() -> Result<(), Broken>,
) -> Case {
    Case { name, wrong, law: RETURNS, broken, honest }
}

pub(super) fn cases() -> Vec<Case> {
    [of_actors(), of_measures()].concat()
}

fn of_actors() -> Vec<Case> {
    vec![
        case(
            "useful without end",
            "a search for the first step that never finds one, and draws nothing",
            || {
                abandon(|| {
                    primitive(Act {
                        useful: |m, from, to| {
                            if !to.is_robot_met(m, from) {
                                forever();
                            }
                            false
                        },
                        ..GO
                    })
                })
            },
            || wait_for(|| primitive(GO)),
        ),
        case(
            "propagates without end",
            "an iteration that waits for an error of 0",
            || {
                abandon(|| {
                    primitive(Act {
                        propagate: |_, _, _, _| {
                            forever();
                            Ok(Vec::new())
                        },
                        ..GO
                    })
                })
            },
            || wait_for(|| primitive(GO)),
        ),
        case(
            "a step of nothing",
            "a prefix that goes on by the room that is left, which is 0",
            || {
                abandon(|| {
                    validity(Rule {
                        free_prefix: |_, _, _, _| {
                            forever();
                            crate::validity::FreePrefix::FREE
                        },
                        ..Rule::default()
                    })
                })
            },
            || wait_for(|| validity(Rule::default())),
        ),
    ]
}

fn of_measures() -> Vec<Case> {
    vec![
        case(
            "bisects for ever",
            "an interpolation that waits until the ends meet",
            || {
                abandon(|| {
                    space(Sketch {
                        interpolate: |a, b, t| {
                            if t > 0.0 && t < 1.0 {
                                forever();
                            }
                            interpolate(a, b, t)
                        },
                        ..Sketch::default()
                    })
                })
            },
            || wait_for(|| space(Sketch::default())),
        ),
        case(
            "counts turns one by one",
            "an angle is brought into its range in steps, and infinity never gets there",
            || {
                abandon(|| {
                    space(Sketch {
                        contains: |q| {
                            if q[1].is_infinite() {
                                forever();
                            }
                            inside(q)
                        },
                        ..Sketch::default()
                    })
                })
            },
            || wait_for(|| space(Sketch { distance, ..Sketch::default() })),
        ),
        case(
            "waits for the end of the segment",
            "a motion that looks for its segment, and finds none at the very end",
            || {
                abandon(|| {
                    motion(|t, out| {
                        if t >= 1.0 {
                            forever();
                        }
                        ahead(t, out);
                    })
                })
            },
            || wait_for(|| motion(ahead)),
        ),
        case(
            "tour without end",
            "a tour that waits until no object is left, and takes none",
            || {
                abandon(|| {
                    metres(|m, from, to| {
                        if to.components().len() > 1 {
                            forever();
                        }
                        honest_metres(m, from, to)
                    })
                })
            },
            || wait_for(|| metres(honest_metres)),
        ),
        case(
            "asks until it is there",
            "a goal that waits for the robot",
            || {
                abandon(|| {
                    goal(|_, state| {
                        if state.robot[0] < 3.0 {
                            forever();
                        }
                        true
                    })
                })
            },
            || wait_for(|| goal(|_, state| state.robot[0] >= 3.0)),
        ),
        case(
            "samples nothing for ever",
            "rejects without drawing anew",
            || {
                abandon(|| {
                    sampler(|_, rng| {
                        if sample(rng)[0] > 1.0 {
                            forever();
                        }
                        robot_at([1.0, 0.0])
                    })
                })
            },
            || wait_for(|| sampler(|_, rng| robot_at(sample(rng)))),
        ),
    ]
}
