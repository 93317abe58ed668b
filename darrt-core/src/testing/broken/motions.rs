//! Broken motions and instances.

use crate::primitive::PrimitiveId;
use std::fmt;

use rand::Rng;

use super::Case;
use super::bench::{Bench, Config, Tag, cart, sample, state};
use crate::laws::motion::{CLAMPED, FRAME, LENGTH, MODE, MotionClaims, NAMED, PURE, START, TRAVEL};
use crate::laws::{Broken, check_instance};
use crate::motion::{Instance, Motion, Straight, Waypoints};
use crate::space::ComponentSpace;
use crate::state::{ComponentId, ComponentSet, ObjectId, State};

/// A motion made of a length and a function.
pub(super) struct Reel {
    pub(super) length_m: f64,
    pub(super) at: fn(f64, &mut State<Bench>),
}

impl Motion<Bench> for Reel {
    fn length(&self) -> f64 {
        self.length_m
    }

    fn at_into(&self, _: &Bench, t: f64, out: &mut State<Bench>) {
        (self.at)(t, out);
    }
}

impl fmt::Debug for Reel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Reel({:?} m)", self.length_m)
    }
}

/// Everything anywhere.
pub(super) fn random_state(rng: &mut dyn Rng) -> State<Bench> {
    State { robot: sample(rng), objects: [sample(rng), sample(rng)].into_iter().collect(), mode: Tag::default() }
}

/// An honest instance: the robot straight to `target`.
pub(super) fn go(m: &Bench, from: &State<Bench>, target: Config) -> Instance<Bench> {
    let length = m.robot.distance(&from.robot, &target);
    instance(Straight::new(from.clone(), target, length), ComponentSet::ROBOT)
}

/// An honest instance: robot and cart 0 move by the same metres until the cart is at `x`.
pub(super) fn drag(from: &State<Bench>, x: f64) -> Option<Instance<Bench>> {
    let mut end = from.clone();
    let slot = end.objects.get_mut(cart().index())?;
    let metres = x - slot[0];
    slot[0] = x;
    end.robot[0] += metres;
    let motion = Waypoints::new(vec![from.clone(), end], &[metres.abs() + 1e-12], from.mode.clone())?;
    let moves = ComponentSet::ROBOT.with(ComponentId::Object(cart()));
    Some(Instance { object: Some(cart()), contacts: moves, ..instance(motion, moves) })
}

/// An instance that needs no contact.
pub(super) fn instance(motion: impl Motion<Bench> + 'static, moves: ComponentSet) -> Instance<Bench> {
    let contacts = ComponentSet::EMPTY;
    Instance {
        primitive: PrimitiveId::new(10, "reel"),
        motion: Box::new(motion),
        contacts,
        moves,
        object: None,
        reversible: true,
    }
}

/// Where all of these motions start.
fn start() -> State<Bench> {
    state([0.5, 3.0])
}

fn check_all(instance: &Instance<Bench>) -> Result<(), Broken> {
    check_instance(&Bench::default(), instance, &start(), &[0.2, 0.5, 0.9, 0.999], &MotionClaims::default())
}

fn check(length_m: f64, at: fn(f64, &mut State<Bench>)) -> Result<(), Broken> {
    check_all(&instance(Reel { length_m, at }, ComponentSet::ROBOT))
}

/// One metre forward.
fn forward(t: f64, out: &mut State<Bench>) {
    *out = start();
    out.robot[0] = 0.5 + t.clamp(0.0, 1.0);
}

fn case(name: &'static str, wrong: &'static str, law: &'static str, broken: fn() -> Result<(), Broken>) -> Case {
    Case { name, wrong, law, broken, honest: || check(1.0, forward) }
}

pub(super) fn cases() -> Vec<Case> {
    [functions(), lengths(), frames()].concat()
}

fn functions() -> Vec<Case> {
    vec![
        case("starts one step in", "the first waypoint is where the first step ends", START, || {
            check(1.0, |t, out| forward(0.01 + 0.99 * t, out))
        }),
        case("starts almost there", "the start is computed anew, and differs in the last digits", START, || {
            check(1.0, |t, out| {
                forward(t, out);
                out.robot[1] = (out.robot[1].sin()).atan2(out.robot[1].cos()) + 1e-15;
            })
        }),
        case("adds to the output", "moves on from what the output held before", PURE, || {
            check(1.0, |t, out| if t <= 0.0 { forward(0.0, out) } else { out.robot[0] = (out.robot[0] + t).min(4.0) })
        }),
        case(
            "leaves the rest to the caller",
            "writes the robot only, and keeps the old objects of the output",
            PURE,
            || {
                let at = |t: f64, out: &mut State<Bench>| {
                    out.robot = [0.5, 3.0];
                    if let (true, Some(slot)) = (t >= 1.0, out.objects.get_mut(0)) {
                        slot[0] += 0.5;
                    }
                };
                let moves = ComponentSet::ROBOT.with(ComponentId::Object(cart()));
                check_all(&instance(Reel { length_m: 1.0, at }, moves))
            },
        ),
        case("runs on", "extrapolates past the end", CLAMPED, || {
            check(1.0, |t, out| {
                forward(0.0, out);
                out.robot[0] = 0.5 + t;
            })
        }),
        case("grasps half way", "the mode changes in the middle of the motion", MODE, || {
            check(1.0, |t, out| {
                forward(t, out);
                out.mode = Tag::new(u32::from(t > 0.6));
            })
        }),
    ]
}

fn lengths() -> Vec<Case> {
    vec![
        case("length of nothing", "the length is 0 / 0 for a path of equal waypoints", LENGTH, || {
            check(f64::NAN, forward)
        }),
        case("negative length", "the length is end minus start", LENGTH, || check(-1.0, forward)),
        case("angles for free", "the length leaves the turn out", TRAVEL, || {
            check(1.0, |t, out| {
                forward(t, out);
                out.robot[1] = 3.0 - t.clamp(0.0, 1.0);
            })
        }),
        case("hurries at the end", "the length is right, but half of it is done in the last tenth", TRAVEL, || {
            check(1.0, |t, out| forward(if t < 0.9 { t / 1.8 } else { 0.5 + (t - 0.9) * 5.0 }, out))
        }),
        case("off by one at the last waypoint", "jumps from the last waypoint but one to the end", TRAVEL, || {
            check(1.0, |t, out| forward(if t < 1.0 { 0.9 * t } else { 1.0 }, out))
        }),
        case(
            "wrapped angle the long way",
            "turns from 3 to -3 through 0 with the length of the short way",
            TRAVEL,
            || {
                check(0.3, |t, out| {
                    forward(0.0, out);
                    out.robot[1] = 3.0 - 6.0 * t.clamp(0.0, 1.0);
                })
            },
        ),
        case("teleports the object", "the pushed cart is at its target as soon as the motion begins", TRAVEL, || {
            let moves = ComponentSet::ROBOT.with(ComponentId::Object(cart()));
            let at = |t: f64, out: &mut State<Bench>| {
                forward(t, out);
                if let (true, Some(slot)) = (t > 0.0, out.objects.get_mut(0)) {
                    slot[0] = 3.5;
                }
            };
            check_all(&instance(Reel { length_m: 1.0, at }, moves))
        }),
    ]
}

fn frames() -> Vec<Case> {
    vec![
        case("moves the robot, too", "a motion of the cart alone that takes the robot along", FRAME, || {
            check_all(&instance(
                Reel { length_m: 1.0, at: forward },
                ComponentSet::EMPTY.with(ComponentId::Object(cart())),
            ))
        }),
        case("nudges a bystander", "another cart shifts by a hair, because its place is computed anew", FRAME, || {
            check(1.0, |t, out| {
                forward(t, out);
                if let (true, Some(slot)) = (t > 0.0, out.objects.get_mut(1)) {
                    slot[1] += 1e-15;
                }
            })
        }),
        case("moves cart 7", "names an object that the domain does not have", NAMED, || {
            let moves = ComponentSet::ROBOT.with(ComponentId::Object(ObjectId::new(7)));
            check_all(&instance(Reel { length_m: 1.0, at: forward }, moves))
        }),
        case("loses an object", "rebuilds the state without the objects", NAMED, || {
            check(1.0, |t, out| {
                forward(t, out);
                if t > 0.0 {
                    out.objects.clear();
                }
            })
        }),
    ]
}
