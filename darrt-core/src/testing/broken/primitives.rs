//! Broken primitives.

use std::cell::Cell;
use std::sync::atomic::{AtomicU32, Ordering};

use rand::RngExt;

use super::Case;
use super::bench::{Act, Bench, Propagate, Rule, cart, cart_at, robot_at, state};
use super::motions::{drag, go, instance};
use crate::laws::primitive::{
    APPROACH, CHAINED, CONTACTS, ENDS, NOT_EMPTY, PANICS, PROGRESS, SEEDED, TRUNCATED, UNNAMED, UNTOUCHED, USEFUL_MET,
    USEFUL_PURE,
};
use crate::laws::{Broken, PrimitiveClaims, check_contacts, motion, try_primitive};
use crate::motion::{Instance, Waypoints};
use crate::partial::PartialState;
use crate::primitive::Infeasible;
use crate::space::{ComponentSpace, GroupSet};
use crate::state::{ComponentId, ComponentSet, State};

/// The honest primitive for the robot: straight to its target.
const GO: Act = Act {
    useful: |m, from, to| to.are_objects_met(m, from) && !to.is_robot_met(m, from),
    approach: |_, _, _| None,
    propagate: |m, from, to, _| Ok(vec![go(m, from, to.robot_overlay(m, &from.robot))]),
};

/// The honest primitive for cart 0: to the cart, then along with it to the position asked for.
const DRAG: Act = Act {
    useful: |_, from, to| misplaced(from, to).is_some(),
    approach: |_, from, to| misplaced(from, to).map(|(at, _)| (at - 0.05 - from.robot[0]).abs()),
    propagate: |m, from, to, _| {
        let (touching, approach, x) = approach(m, from, to)?;
        Ok(vec![approach, drag(&touching, x).ok_or(Infeasible::NoContact)?])
    },
};

/// Position of cart 0 and where it should be, if that differs.
fn misplaced(from: &State<Bench>, to: &PartialState<Bench>) -> Option<(f64, f64)> {
    let (at, target) = (from.object(cart())?, to.object(cart())?);
    ((at[0] - target[0]).abs() > 1e-9).then_some((at[0], target[0]))
}

/// To the cart: the state there, the instance, and where the cart should go.
fn approach(
    m: &Bench,
    from: &State<Bench>,
    to: &PartialState<Bench>,
) -> Result<(State<Bench>, Instance<Bench>, f64), Infeasible> {
    let (at, x) = misplaced(from, to).ok_or(Infeasible::NoProgress)?;
    let robot = [at - 0.05, from.robot[1]];
    let instance = Instance {
        object: Some(cart()),
        contacts: ComponentSet::EMPTY.with(ComponentId::Object(cart())),
        ..go(m, from, robot)
    };
    Ok((State { robot, ..from.clone() }, instance, x))
}

/// `act` for a target of the whole robot, of its position, of cart 0, and for one that is met.
fn check(act: Act, claims: &PrimitiveClaims<'_, Bench>) -> Result<(), Broken> {
    let (m, from) = (Bench::default(), state([0.5, 3.0]));
    let position = PartialState::anywhere(&m).with_robot_groups([1.0, -1.0], GroupSet::only(0));
    for to in [robot_at([1.0, -3.0]), position, cart_at([3.5, 0.0]), PartialState::of_state(&m, &from)] {
        try_primitive(&m, &act, &from, &to, 1, claims)?;
    }
    Ok(())
}

fn robot(act: Act) -> Result<(), Broken> {
    check(act, &PrimitiveClaims::default())
}

fn going(propagate: Propagate) -> Result<(), Broken> {
    robot(Act { propagate, ..GO })
}

fn dragging(propagate: Propagate) -> Result<(), Broken> {
    robot(Act { propagate, ..DRAG })
}

fn case(name: &'static str, wrong: &'static str, law: &'static str, broken: fn() -> Result<(), Broken>) -> Case {
    let honest = || robot(GO).and_then(|()| robot(DRAG));
    Case { name, wrong, law, broken, honest }
}

pub(super) fn cases() -> Vec<Case> {
    [answers(), choices(), chains(), ends()].concat()
}

fn answers() -> Vec<Case> {
    static CALLS: AtomicU32 = AtomicU32::new(0);
    vec![
        case("unwraps the target", "takes for granted that the target names an object", PANICS, || {
            let useful = |_: &Bench, from: &State<Bench>, to: &PartialState<Bench>| {
                let named: Vec<_> = to.objects().collect();
                from.object(named[0].0).is_some()
            };
            robot(Act { useful, ..DRAG })
        }),
        case("hidden state in useful", "answers a question only once", USEFUL_PURE, || {
            let useful = |m: &Bench, from: &State<Bench>, to: &PartialState<Bench>| {
                CALLS.fetch_add(1, Ordering::Relaxed).is_multiple_of(2) && (GO.useful)(m, from, to)
            };
            robot(Act { useful, ..GO })
        }),
        case("always useful", "wants to go to where it is already", USEFUL_MET, || {
            robot(Act { useful: |_, _, to| to.robot().is_some(), ..GO })
        }),
        case("useful by the free group", "looks at the heading of a target that names the position", UNNAMED, || {
            let useful = |m: &Bench, from: &State<Bench>, to: &PartialState<Bench>| {
                (GO.useful)(m, from, to) && to.robot().is_some_and(|robot| robot.config[1] < 0.0)
            };
            let (m, from) = (Bench::default(), state([0.5, 3.0]));
            let to = PartialState::anywhere(&m).with_robot_groups([1.0, -1.0], GroupSet::only(0));
            (0..16).try_for_each(|seed| {
                let claims = PrimitiveClaims::default();
                try_primitive(&m, &Act { useful, ..GO }, &from, &to, seed, &claims).map(|_| ())
            })
        }),
        case("approach to the target", "measures to where the cart should go, not to where it is", APPROACH, || {
            robot(Act { approach: |_, from, to| Some(to.object(cart())?[0] - from.robot[0] + 1.0), ..DRAG })
        }),
        case("negative approach", "subtracts the radius of the cart also when inside it", APPROACH, || {
            robot(Act { approach: |_, _, _| Some(-0.05), ..DRAG })
        }),
    ]
}

fn choices() -> Vec<Case> {
    static CALLS: AtomicU32 = AtomicU32::new(0);
    thread_local! {
        static LAST: Cell<u32> = const { Cell::new(u32::MAX) };
    }
    vec![
        case(
            "global random state",
            "draws from a sequence of its own instead of the caller's generator",
            SEEDED,
            || {
                going(|m, from, to, _| {
                    let [x, heading] = to.robot_overlay(m, &from.robot);
                    let jitter = f64::from(CALLS.fetch_add(1, Ordering::Relaxed) % 97) * 1e-6;
                    Ok(vec![go(m, from, [x - jitter, heading])])
                })
            },
        ),
        case("hidden state between calls", "warm start: begins its search where the last call ended", SEEDED, || {
            going(|m, from, to, rng| {
                let mine = rng.random_range(0..1000_u32);
                if LAST.replace(mine) == mine {
                    return Err(Infeasible::Unreachable);
                }
                Ok(vec![go(m, from, to.robot_overlay(m, &from.robot))])
            })
        }),
        case("writes to its input", "marks the mode of the state that it was given", UNTOUCHED, || {
            going(|m, from, to, _| {
                from.mode.overwrite(9);
                Ok(vec![go(m, from, to.robot_overlay(m, &from.robot))])
            })
        }),
        case("free group as target", "goes to the heading of a target that names the position alone", UNNAMED, || {
            going(|m, from, to, _| {
                let target = to.robot().map_or(from.robot, |robot| robot.config);
                Ok(vec![go(m, from, target)])
            })
        }),
        case("rejection without end", "draws until a condition holds that can never hold", ENDS, || {
            going(|m, from, to, rng| {
                while rng.random_range(0.0..1.0) <= 1.0 {}
                Ok(vec![go(m, from, to.robot_overlay(m, &from.robot))])
            })
        }),
        case("a thousand steps", "gives one instance per millimetre", ENDS, || {
            going(|m, from, to, _| {
                let mut at = from.clone();
                let end = to.robot_overlay(m, &from.robot);
                let steps = (1..=1000).map(|i| {
                    let next = m.robot.interpolate(&from.robot, &end, f64::from(i) / 1000.0);
                    let step = go(m, &at, next);
                    at.robot = next;
                    step
                });
                Ok(steps.collect())
            })
        }),
    ]
}

fn chains() -> Vec<Case> {
    vec![
        case("nothing to do", "succeeds with no instances", NOT_EMPTY, || going(|_, _, _, _| Ok(Vec::new()))),
        case(
            "teleports to the contact",
            "leaves the approach out: the drag begins where the robot is not",
            CHAINED,
            || {
                dragging(|m, from, to, _| {
                    let (touching, _, x) = approach(m, from, to)?;
                    Ok(vec![drag(&touching, x).ok_or(Infeasible::NoContact)?])
                })
            },
        ),
        case("starts again from the beginning", "the second instance starts where the first did", CHAINED, || {
            dragging(|m, from, to, _| {
                let (_, approach, x) = approach(m, from, to)?;
                Ok(vec![approach, drag(from, x).ok_or(Infeasible::NoContact)?])
            })
        }),
        case("loses the object on the way", "moves the robot, but not the cart that it holds", motion::FRAME, || {
            dragging(|m, from, to, _| {
                let (touching, approach, x) = approach(m, from, to)?;
                let all = drag(&touching, x).ok_or(Infeasible::NoContact)?;
                Ok(vec![approach, Instance { moves: ComponentSet::ROBOT, ..all }])
            })
        }),
        case(
            "grasp that drifts",
            "the cart slides away from the robot, faster than the length says",
            motion::TRAVEL,
            || {
                dragging(|m, from, to, _| {
                    let (touching, approach, x) = approach(m, from, to)?;
                    let mut end = touching.clone();
                    end.robot[0] += 0.1;
                    if let Some(slot) = end.objects.get_mut(0) {
                        slot[0] = x;
                    }
                    let motion = Waypoints::new(vec![touching.clone(), end], &[0.1], touching.mode.clone());
                    let moves = ComponentSet::ROBOT.with(ComponentId::Object(cart()));
                    Ok(vec![
                        approach,
                        Instance { object: Some(cart()), ..instance(motion.ok_or(Infeasible::NoContact)?, moves) },
                    ])
                })
            },
        ),
    ]
}

fn ends() -> Vec<Case> {
    vec![
        case("useful without progress", "approaches the cart and leaves it where it is", PROGRESS, || {
            dragging(|m, from, to, _| Ok(vec![approach(m, from, to)?.1]))
        }),
        case("wrong direction", "the sign of the push is wrong: the cart ends farther away", PROGRESS, || {
            dragging(|m, from, to, _| {
                let (touching, approach, x) = approach(m, from, to)?;
                let at = touching.object(cart()).map_or(x, |at| at[0]);
                Ok(vec![approach, drag(&touching, 2.0 * at - x).ok_or(Infeasible::NoContact)?])
            })
        }),
        case("overshoots", "goes twice the way: neither nearer nor farther", PROGRESS, || {
            going(|m, from, to, _| {
                let end = to.robot_overlay(m, &from.robot);
                Ok(vec![go(m, from, [2.0 * end[0] - from.robot[0], from.robot[1]])])
            })
        }),
        Case {
            name: "fixed stroke",
            wrong: "always drives half of the way, and claims that it can stop anywhere",
            law: TRUNCATED,
            broken: || {
                let propagate: Propagate = |m, from, to, _| {
                    let end = to.robot_overlay(m, &from.robot);
                    Ok(vec![go(m, from, m.robot.interpolate(&from.robot, &end, 0.5))])
                };
                check(Act { propagate, ..GO }, &PrimitiveClaims { truncates: true, ..PrimitiveClaims::default() })
            },
            honest: || {
                let claims = PrimitiveClaims { truncates: true, ..PrimitiveClaims::default() };
                check(GO, &claims).and_then(|()| check(DRAG, &claims))
            },
        },
        Case {
            name: "forgets an exemption",
            wrong: "drags the cart, but does not allow the contact with it",
            law: CONTACTS,
            broken: || contacts(|instance| Instance { contacts: ComponentSet::EMPTY, ..instance }),
            honest: || contacts(|instance| instance),
        },
    ]
}

fn contacts(change: fn(Instance<Bench>) -> Instance<Bench>) -> Result<(), Broken> {
    let (m, from) = (Bench::default(), state([1.95, 0.0]));
    let instances: Vec<_> = drag(&from, 2.5).map(change).into_iter().collect();
    check_contacts(&m, &Rule::default(), &instances, &from, &[0.3, 0.6])
}
