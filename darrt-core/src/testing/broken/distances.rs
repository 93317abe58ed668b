//! Broken distances and broken searches for the nearest node.

use std::sync::atomic::{AtomicU32, Ordering};

use super::Case;
use super::bench::{Bench, cart, cart_at, robot_at, state};
use super::motions::go;
use crate::distance::{Distance, Euclidean, GreedyVisit};
use crate::laws::distance::{FINITE, LOWER_BOUND, NOT_ABOVE, POSITIVE, PURE, UNNAMED, ZERO_MET};
use crate::laws::nearest::{LINEAR, tree_of};
use crate::laws::{Broken, check_distance, check_lower_bound, check_nearest, check_not_above};
use crate::partial::PartialState;
use crate::space::{ComponentSpace, GroupSet};
use crate::state::State;
use crate::tree::{NodeId, Tree};

type Metres = fn(&Bench, &State<Bench>, &PartialState<Bench>) -> f64;
type Nearest = fn(&Bench, &Tree<Bench>, &PartialState<Bench>) -> Option<NodeId>;

/// A distance made of functions.
pub(super) struct Gauge {
    pub(super) metres: Metres,
    pub(super) nearest: Option<Nearest>,
}

impl Distance<Bench> for Gauge {
    fn distance(&self, m: &Bench, from: &State<Bench>, to: &PartialState<Bench>) -> f64 {
        (self.metres)(m, from, to)
    }

    fn nearest(&self, m: &Bench, tree: &Tree<Bench>, to: &PartialState<Bench>) -> Option<NodeId> {
        match self.nearest {
            Some(nearest) => nearest(m, tree, to),
            None => crate::nearest::linear::nearest_by(tree, |s| self.distance(m, s, to)),
        }
    }
}

fn honest_metres(m: &Bench, from: &State<Bench>, to: &PartialState<Bench>) -> f64 {
    Euclidean.distance(m, from, to)
}

/// A target for the whole robot, for one group of it, for a cart, and one that is met.
fn check(metres: Metres) -> Result<(), Broken> {
    let (m, from, elsewhere) = (Bench::default(), state([0.5, 3.0]), state([3.5, -3.0]));
    let elsewhere = State { objects: [[0.2, 2.0], [1.1, -2.0]].into_iter().collect(), ..elsewhere };
    let group = PartialState::anywhere(&m).with_robot_groups([1.0, 1.0], GroupSet::only(0));
    for to in [robot_at([1.0, -3.0]), group, cart_at([3.0, 1.0]), PartialState::of_state(&m, &from)] {
        check_distance(&m, &Gauge { metres, nearest: None }, &from, &to, &elsewhere)?;
    }
    Ok(())
}

fn case(name: &'static str, wrong: &'static str, law: &'static str, broken: fn() -> Result<(), Broken>) -> Case {
    Case { name, wrong, law, broken, honest: || check(honest_metres) }
}

pub(super) fn cases() -> Vec<Case> {
    [measures(), bounds(), searches()].concat()
}

fn measures() -> Vec<Case> {
    static CALLS: AtomicU32 = AtomicU32::new(0);
    vec![
        case("infinite sentinel", "answers infinity where it has no opinion", FINITE, || {
            check(|m, from, to| if to.robot().is_some() { honest_metres(m, from, to) } else { f64::INFINITY })
        }),
        case("jitter", "breaks ties with noise of its own", PURE, || {
            check(|m, from, to| honest_metres(m, from, to) + 1e-12 * f64::from(CALLS.fetch_add(1, Ordering::Relaxed)))
        }),
        case("constant effort", "adds the cost of one action, also when nothing is left to do", ZERO_MET, || {
            check(|m, from, to| honest_metres(m, from, to) + 0.5)
        }),
        case("robot only", "forgets the objects: far targets are as near as met ones", POSITIVE, || {
            check(|m, from, to| m.robot.distance(&from.robot, &to.robot_overlay(m, &from.robot)))
        }),
        case("free group as target", "measures to the whole robot of a target that names one group", UNNAMED, || {
            check(|m, from, to| match to.robot() {
                Some(robot) if !to.is_met(m, from) => m.robot.distance(&from.robot, &robot.config),
                _ => honest_metres(m, from, to),
            })
        }),
        case("all objects count", "adds what unnamed objects are away from the origin", UNNAMED, || {
            check(|m, from, to| {
                let is_far = |i: usize| !to.is_met(m, from) && to.object(crate::state::ObjectId::new(i)).is_none();
                let stray = from.objects.iter().enumerate().filter(|(i, _)| is_far(*i)).map(|(_, at)| at[0]);
                honest_metres(m, from, to) + stray.sum::<f64>()
            })
        }),
    ]
}

fn bounds() -> Vec<Case> {
    vec![
        Case {
            name: "there and back",
            wrong: "claims to be a lower bound, but counts the way twice",
            law: LOWER_BOUND,
            broken: || lower_bound(|m, from, to| 2.0 * honest_metres(m, from, to)),
            honest: || lower_bound(honest_metres),
        },
        Case {
            name: "tours swapped",
            wrong: "a tour that visits the objects in the order of their ids is sold as the shortest",
            law: NOT_ABOVE,
            broken: || not_above(by_id),
            honest: || not_above(|m, from, to| crate::distance::ExactTour.distance(m, from, to)),
        },
    ]
}

/// The robot straight to its target.
fn lower_bound(metres: Metres) -> Result<(), Broken> {
    let (m, from, to) = (Bench::default(), state([0.5, 3.0]), [1.5, -3.0]);
    let instances = [go(&m, &from, to)];
    check_lower_bound(&m, &Gauge { metres, nearest: None }, &from, &robot_at(to), &instances)
}

/// Carts at 2 and 3 m, robot at 4 m: first the farther one by id, and the way is longer.
fn not_above(metres: Metres) -> Result<(), Broken> {
    let (m, from) = (Bench::default(), state([4.0, 0.0]));
    let to = cart_at([1.9, 0.0]).with_object(crate::state::ObjectId::new(1), [2.9, 0.5]);
    check_not_above(&m, &Gauge { metres, nearest: None }, &GreedyVisit, &from, &to)
}

fn by_id(m: &Bench, from: &State<Bench>, to: &PartialState<Bench>) -> f64 {
    let mut at = from.robot;
    let mut metres = 0.0;
    for (id, target) in to.objects() {
        let Some(here) = from.object(id) else { continue };
        metres += (m.reach)(&at, here) + super::bench::distance(here, target);
        at = *target;
    }
    metres
}

fn searches() -> Vec<Case> {
    let case = |name, wrong, broken| Case { name, wrong, law: LINEAR, broken, honest: || nearest(None) };
    vec![
        case("last on a tie", "compares with <=, so that the tree's order no longer decides", || {
            nearest(Some(|m, tree, to| {
                let mut best: Option<(NodeId, f64)> = None;
                for (id, node) in tree.iter() {
                    let metres = honest_metres(m, &node.state, to);
                    if best.is_none_or(|(_, least)| metres <= least) {
                        best = Some((id, metres));
                    }
                }
                best.map(|(id, _)| id)
            }))
        }),
        case(
            "pruned too much",
            "skips nodes whose position alone is as far as the best, counting radians twice",
            || {
                nearest(Some(|m, tree, to| {
                    let mut best: Option<(NodeId, f64)> = None;
                    for (id, node) in tree.iter() {
                        let bound = node.state.object(cart()).map_or(0.0, |at| 2.0 * at[1].abs());
                        let metres = honest_metres(m, &node.state, to);
                        if best.is_none_or(|(_, least)| bound < least && metres < least) {
                            best = Some((id, metres));
                        }
                    }
                    best.map(|(id, _)| id)
                }))
            },
        ),
    ]
}

/// Two nodes of the same distance, then a nearer one.
fn nearest(nearest: Option<Nearest>) -> Result<(), Broken> {
    let m = Bench::default();
    let with_cart = |at| State { objects: [at, [3.0, 0.5]].into_iter().collect(), ..state([0.5, 0.0]) };
    let gauge = Gauge { metres: honest_metres, nearest };
    let twins = tree_of(&m, &with_cart([1.0, 0.0]), [with_cart([3.0, 0.0]), with_cart([0.2, 0.0])]);
    check_nearest(&m, &gauge, &twins, &cart_at([2.0, 0.0]))?;
    let turned = tree_of(&m, &with_cart([1.0, 0.0]), [with_cart([1.9, 0.9])]);
    check_nearest(&m, &gauge, &turned, &cart_at([2.0, 0.5]))
}
