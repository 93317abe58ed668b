//! Numbers that are not metres, constants where something should count, and spaces, samplers and goals that are deaf to part of
//! what they are asked.

use rand::{Rng, RngExt};

use super::super::bench::{self, Bench, Sketch, cart_at, inside, robot_at, sample};
use super::super::distances::Gauge;
use super::super::motions::random_state;
use super::super::samplers::Dice;
use super::super::{Case, inputs, seed};
use super::CASES;
use crate::distance::{Distance, Euclidean};
use crate::goal::{AnyOf, Goal, Reach};
use crate::laws::distance::{METRES, RESOLVES};
use crate::laws::domain::{REACH_DEAF, REACH_METRES, TRAVEL_BETWEEN_DEAF, TRAVEL_BETWEEN_METRES};
use crate::laws::goal::{ASKS, NEAR, PARTS};
use crate::laws::sampler::{FILLS, INSIDE, LEARNS};
use crate::laws::space::{DEAF, EVEN, OVERLAY_GROUPS, PLACE_VARIED, TOLERANCE_SMALL};
use crate::laws::watch::PANICS;
use crate::laws::{
    Broken, SpaceClaims, check_component_space, check_distance, check_domain, check_goal, check_nearest, check_sampler,
    check_sampler_covers, check_sampler_learns, nearest,
};
use crate::partial::PartialState;
use crate::sample::{RandomSubset, Sampler};
use crate::space::GroupSet;
use crate::state::State;
use crate::tree::{NodeId, Tree};

pub(super) fn cases() -> Vec<Case> {
    [spaces(), domains(), distances(), samplers(), goals()].concat()
}

fn space(space: Sketch) -> Result<(), Broken> {
    for i in 0..CASES / 8 {
        let mut rng = inputs(i);
        let [a, b, c] = [(); 3].map(|()| sample(&mut rng));
        check_component_space(&space, &SpaceClaims::default(), [&a, &b, &c], [0.3, 0.6], seed() + i)?;
    }
    Ok(())
}

fn spaces() -> Vec<Case> {
    let case = |name, wrong, law, broken| Case { name, wrong, law, broken, honest: || space(Sketch::default()) };
    vec![
        case("deaf without end", "positions have no bounds, and no distance", DEAF, || {
            space(Sketch {
                contains: |q| q[0].is_finite() && inside(&[0.0, q[1]]),
                distance: |a, b| bench::distance(&[0.0, a[1]], &[0.0, b[1]]),
                index_coordinates: |q| [0.0, q[1].sin()],
                ..Sketch::default()
            })
        }),
        case("three centimetres are near enough", "a tolerance that fits another room", TOLERANCE_SMALL, || {
            space(Sketch { tolerance: 0.03, ..Sketch::default() })
        }),
        case("nearly there is there", "the last thousandth of the way is skipped", EVEN, || {
            space(Sketch {
                interpolate: |a, b, t| if t > 0.999 { *b } else { bench::interpolate(a, b, t) },
                ..Sketch::default()
            })
        }),
        case("always the same place", "the edge was written down once", PLACE_VARIED, || {
            space(Sketch { sample_at: |_| Some([0.1, 0.0]), ..Sketch::default() })
        }),
        case(
            "the heading takes the position along",
            "an overlay of one group that reads the other",
            OVERLAY_GROUPS,
            || {
                space(Sketch {
                    overlay: |from, target, groups| {
                        let over = bench::overlay(from, target, groups);
                        if groups.contains(1) { [target[0], over[1]] } else { over }
                    },
                    ..Sketch::default()
                })
            },
        ),
    ]
}

fn domain(m: &Bench) -> Result<(), Broken> {
    (0..CASES / 16).try_for_each(|i| {
        let mut rng = inputs(i);
        let [a, b, c] = [(); 3].map(|()| random_state(&mut rng));
        check_domain(m, &SpaceClaims::default(), [&a, &b, &c], [0.3, 0.8], seed() + i)
    })
}

/// The bench with another reach, and no short cuts for it.
fn reaching(
    reach: fn(&bench::Config, &bench::Config) -> f64,
    reach_from: fn([f64; 3], &bench::Config) -> f64,
) -> Bench {
    Bench { reach, reach_from, reach_at_least: |_| 0.0, ..Bench::default() }
}

fn domains() -> Vec<Case> {
    let case = |name, wrong, law, broken| Case { name, wrong, law, broken, honest: || domain(&Bench::default()) };
    vec![
        case("reach in millimetres", "the arm's data sheet has them", REACH_METRES, || {
            domain(&reaching(|r, at| 1e3 * (r[0] - at[0]).abs(), |point, at| 1e3 * (point[0] - at[0]).abs()))
        }),
        case("squared reach", "the root is saved", REACH_METRES, || {
            domain(&reaching(|r, at| (r[0] - at[0]).powi(2), |point, at| (point[0] - at[0]).powi(2)))
        }),
        case("reach of a metre", "a constant until somebody fills it in", REACH_DEAF, || {
            domain(&reaching(|_, _| 1.0, |_, _| 1.0))
        }),
        case("reach from nowhere", "the robot is left out", REACH_DEAF, || {
            domain(&reaching(|_, at| at[0], |_, at| at[0]))
        }),
        case("reach to nowhere", "the object is left out", REACH_DEAF, || {
            domain(&reaching(|r, _| r[0], |point, _| point[0]))
        }),
        case("travel in millimetres", "copied from a map", TRAVEL_BETWEEN_METRES, || {
            domain(&Bench { travel_between: |a, b| 1e3 * (a[0] - b[0]).abs(), ..Bench::default() })
        }),
        case("half a metre for every stop", "the time of a grasp is counted as a way", TRAVEL_BETWEEN_METRES, || {
            domain(&Bench { travel_between: |a, b| 0.5 + (a[0] - b[0]).abs(), ..Bench::default() })
        }),
        case("no travel between objects", "it was left at 0", TRAVEL_BETWEEN_DEAF, || {
            domain(&Bench { travel_between: |_, _| 0.0, ..Bench::default() })
        }),
    ]
}

type Metres = fn(&Bench, &State<Bench>, &PartialState<Bench>) -> f64;

fn honest(m: &Bench, from: &State<Bench>, to: &PartialState<Bench>) -> f64 {
    Euclidean.distance(m, from, to)
}

/// What the objects are away from their targets, and the robot from its own.
fn apart(m: &Bench, from: &State<Bench>, to: &PartialState<Bench>) -> (f64, f64) {
    let there = to.overlay(m, from);
    let objects = from.objects.iter().zip(&there.objects).map(|(p, q)| bench::distance(p, q));
    (bench::distance(&from.robot, &there.robot), objects.sum())
}

fn distance(metres: Metres) -> Result<(), Broken> {
    let m = Bench::default();
    (0..CASES / 8).try_for_each(|i| {
        let mut rng = inputs(i);
        let [from, elsewhere] = [(); 2].map(|()| random_state(&mut rng));
        check_distance(&m, &Gauge { metres, nearest: None }, &from, &robot_at(sample(&mut rng)), &elsewhere)
    })
}

/// Answers nothing for a tree of one node.
struct Shy;

impl Distance<Bench> for Shy {
    fn distance(&self, m: &Bench, from: &State<Bench>, to: &PartialState<Bench>) -> f64 {
        honest(m, from, to)
    }

    fn nearest(&self, m: &Bench, tree: &Tree<Bench>, to: &PartialState<Bench>) -> Option<NodeId> {
        if tree.len() < 2 { None } else { Euclidean.nearest(m, tree, to) }
    }
}

fn search(distance: &dyn Distance<Bench>) -> Result<(), Broken> {
    let (m, mut rng) = (Bench::default(), inputs(0));
    let states: Vec<_> = (0..12).map(|_| random_state(&mut rng)).collect();
    check_nearest(&m, distance, &nearest::tree_of(&m, &random_state(&mut rng), states), &robot_at(sample(&mut rng)))
}

fn distances() -> Vec<Case> {
    let case = |name, wrong, law, broken| Case { name, wrong, law, broken, honest: || distance(honest) };
    vec![
        case("squared distance", "the root is saved, as only comparisons count", METRES, || {
            distance(|m, from, to| honest(m, from, to).powi(2))
        }),
        case("root of the distance", "to make far targets less terrible", RESOLVES, || {
            distance(|m, from, to| honest(m, from, to).sqrt())
        }),
        case("logarithm", "so that it never grows too large", RESOLVES, || {
            distance(|m, from, to| honest(m, from, to).ln_1p())
        }),
        case("squares of the objects", "the robot in metres, and objects in square metres", METRES, || {
            distance(|m, from, to| {
                let (robot, objects) = apart(m, from, to);
                robot + objects * objects
            })
        }),
        case("millimetres", "in the unit of the drives", METRES, || distance(|m, from, to| 1e3 * honest(m, from, to))),
        Case {
            name: "nobody is nearest",
            wrong: "a search that starts with the second node",
            law: nearest::LINEAR,
            broken: || search(&Shy),
            honest: || search(&Euclidean),
        },
    ]
}

/// Samples for the goal, if there are any, and else anything.
struct Greedy;

impl Sampler<Bench> for Greedy {
    fn sample(&self, m: &Bench, goal: &dyn Goal<Bench>, rng: &mut dyn Rng) -> PartialState<Bench> {
        #[allow(clippy::unwrap_used, reason = "that is what is wrong with it")]
        let wanted = if rng.random_bool(0.3) { Some(goal.sample(m, rng).unwrap()) } else { None };
        wanted.unwrap_or_else(|| RandomSubset.sample(m, goal, rng))
    }
}

/// Learns, and what it has learnt comes out in its samples.
struct Pupil {
    blocks: u32,
    /// After so many it has learnt too much.
    most: u32,
}

impl Sampler<Bench> for Pupil {
    fn sample(&self, m: &Bench, goal: &dyn Goal<Bench>, rng: &mut dyn Rng) -> PartialState<Bench> {
        if self.blocks > self.most { robot_at([9.0, 0.0]) } else { RandomSubset.sample(m, goal, rng) }
    }

    fn for_one_attempt(&self) -> Option<Box<dyn Sampler<Bench>>> {
        Some(Box::new(Self { blocks: 0, most: self.most }))
    }

    fn learn_block(&mut self, _: &Bench, _: &State<Bench>, _: &PartialState<Bench>) {
        self.blocks = self.blocks.saturating_add(1);
    }
}

fn sampler(sampler: &dyn Sampler<Bench>) -> Result<(), Broken> {
    let (m, goal) = (Bench::default(), Reach::new(robot_at([3.5, 0.0])));
    (0..CASES / 16).try_for_each(|i| check_sampler(&m, sampler, &goal, seed() * CASES + i))?;
    check_sampler_covers(&m, sampler, &goal, 512, seed())?;
    check_sampler_learns(&m, sampler, &goal, &random_state(&mut inputs(0)), seed())
}

/// Robot or carts; the robot by this function.
fn any(m: &Bench, rng: &mut dyn Rng, robot: fn(&mut dyn Rng) -> bench::Config) -> PartialState<Bench> {
    let target = RandomSubset.sample(m, &AnyOf::new(Vec::new()), rng);
    if target.robot().is_some() { target.with_robot(m, robot(rng)) } else { target }
}

fn samplers() -> Vec<Case> {
    let case = |name, wrong, law, broken| Case { name, wrong, law, broken, honest: || sampler(&RandomSubset) };
    vec![
        case("groups of another robot", "names an arm that this robot does not have", INSIDE, || {
            sampler(&Dice(|m, rng| PartialState::anywhere(m).with_robot_groups(sample(rng), GroupSet::first(3))))
        }),
        case("unwraps the goal", "every goal it was tried with could be sampled", PANICS, || sampler(&Greedy)),
        case("a corner is never asked for", "far along the rail nobody looks to the left", FILLS, || {
            sampler(&Dice(|m, rng| {
                any(m, rng, |rng| {
                    loop {
                        let q = sample(rng);
                        if q[0] < 2.4 || q[1] < 0.8 {
                            return q;
                        }
                    }
                })
            }))
        }),
        case("carts at one place", "the place of objects was left where it was tried", FILLS, || {
            sampler(&Dice(|m, rng| {
                let target = RandomSubset.sample(m, &AnyOf::new(Vec::new()), rng);
                let carts: Vec<_> = target.objects().map(|(id, _)| id).collect();
                carts.into_iter().fold(target, |target, id| target.with_object(id, [1.0, 0.0]))
            }))
        }),
        case("learns to leave the rail", "what was blocked is avoided ever more", LEARNS, || {
            sampler(&Pupil { blocks: 0, most: 20 })
        }),
    ]
}

/// A goal made of functions: cart 0 at 1 m.
#[derive(Clone, Copy)]
struct Aim {
    is_there: fn(&State<Bench>) -> bool,
    parts: fn(&State<Bench>) -> usize,
}

fn is_there(state: &State<Bench>) -> bool {
    state.objects.first().is_some_and(|at| bench::distance(at, &[1.0, 0.5]) <= 1e-9)
}

const AIM: Aim = Aim { is_there, parts: |state| usize::from(is_there(state)) };

impl Goal<Bench> for Aim {
    fn is_satisfied(&self, _: &Bench, state: &State<Bench>) -> bool {
        (self.is_there)(state)
    }

    fn sample(&self, _: &Bench, _: &mut dyn Rng) -> Option<PartialState<Bench>> {
        Some(cart_at([1.0, 0.5]))
    }

    fn parts_met(&self, _: &Bench, state: &State<Bench>) -> usize {
        (self.parts)(state)
    }
}

fn goal(aim: Aim) -> Result<(), Broken> {
    let m = Bench::default();
    (0..CASES / 8).try_for_each(|i| check_goal(&m, &aim, &random_state(&mut inputs(i)), seed() + i))
}

fn goals() -> Vec<Case> {
    let case = |name, wrong, law, broken| Case { name, wrong, law, broken, honest: || goal(AIM) };
    vec![
        case("a metre is near enough", "a tolerance that was meant for something else", NEAR, || {
            let is_near =
                |state: &State<Bench>| state.objects.first().is_some_and(|at| bench::distance(at, &[1.0, 0.5]) <= 1.0);
            goal(Aim { is_there: is_near, parts: |_| 1 })
        }),
        case("any heading will do", "only the position is compared", ASKS, || {
            let by_place = |state: &State<Bench>| state.objects.first().is_some_and(|at| (at[0] - 1.0).abs() <= 1e-9);
            goal(Aim { is_there: by_place, ..AIM })
        }),
        case("no part is ever met", "the count was never filled in", PARTS, || goal(Aim { parts: |_| 0, ..AIM })),
        case("every part is met everywhere", "counts what is asked for", PARTS, || goal(Aim { parts: |_| 1, ..AIM })),
        case("parts that are missing", "counts what is not yet met", PARTS, || {
            goal(Aim { parts: |state| 2 - usize::from(is_there(state)), ..AIM })
        }),
    ]
}
