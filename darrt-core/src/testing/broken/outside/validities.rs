//! Broken validities.

use std::cell::RefCell;
use std::sync::Arc;

use rand::RngExt;

use super::super::bench::{Bench, Check, Rule, TOUCH_M, blame, check as honest_check, inside, name, sample, scan};
use super::super::motions::{drag, go, random_state};
use super::super::{Case, inputs, seed};
use super::CASES;
use crate::laws::validity::{BLAME_KIND, EXEMPTS, LAX, NAN, ORACLE_PREFIX, PURE, STRICT, WITHOUT_ROBOT};
use crate::laws::{Broken, ValidityClaims, check_by_oracle, check_validity};
use crate::state::{ComponentId, ComponentSet, ObjectId, State};
use crate::validity::{BlockKind, FreePrefix, Validity};

/// The motions of the robot and drags of cart 0, from valid states.
fn check(rule: Rule) -> Result<(), Broken> {
    let m = Bench::default();
    let claims = ValidityClaims { same_names: false, ..ValidityClaims::default() };
    for i in 0..CASES / 4 {
        let mut rng = inputs(i);
        let from = random_state(&mut rng);
        let moved = Arc::new(go(&m, &from, sample(&mut rng)));
        check_validity(&m, &rule, &moved, &from, &claims, seed() + i)?;
        let mut touching = from.clone();
        touching.robot[0] = (touching.objects[0][0] - 0.05).max(0.0);
        if let Some(dragged) = drag(&touching, rng.random_range(0.1..=4.0)) {
            check_validity(&m, &rule, &Arc::new(dragged), &touching, &claims, seed() + i)?;
        }
    }
    Ok(())
}

/// Against the user's oracle: the walls at 1 to 1.5 m, the ends of the rail, and the carts.
fn against(rule: Rule) -> Result<(), Broken> {
    let m = Bench::default();
    let free = |_: &Bench, state: &State<Bench>| {
        let x = state.robot[0];
        inside(&state.robot)
            && state.objects.iter().all(|at| inside(at) && (at[0] - x).abs() >= TOUCH_M)
            && !(1.0..=1.5).contains(&x)
    };
    for i in 0..CASES / 16 {
        let mut rng = inputs(i);
        let states: Vec<_> = (0..32).map(|_| random_state(&mut rng)).collect();
        check_by_oracle(&m, &rule, &free, &states.iter().collect::<Vec<_>>(), seed() + i)?;
    }
    Ok(())
}

fn rule(check_rule: Check) -> Rule {
    Rule { check: check_rule, ..Rule::default() }
}

fn case(name: &'static str, wrong: &'static str, law: &'static str, broken: fn() -> Result<(), Broken>) -> Case {
    Case { name, wrong, law, broken, honest: || check(Rule::default()) }
}

pub(super) fn cases() -> Vec<Case> {
    [from_outside(), kinds(), alone(), memory(), oracles()].concat()
}

/// The honest rule without its bounds.
fn boundless(wall: (f64, f64), state: &State<Bench>, contacts: ComponentSet) -> Result<(), crate::validity::Blame> {
    let mut within = state.clone();
    for at in std::iter::once(&mut within.robot).chain(&mut within.objects) {
        at.iter_mut().filter(|x| !x.is_finite()).for_each(|x| *x = 0.0);
    }
    honest_check(wall, &within, contacts)
}

fn from_outside() -> Vec<Case> {
    vec![
        case("NaN touches nothing", "every comparison with it is false, so it is free", NAN, || check(rule(boundless))),
        case("NaN in good hands", "bounds are checked only where nothing may touch", NAN, || {
            check(rule(|wall, state, contacts| {
                if contacts.is_empty() { honest_check(wall, state, contacts) } else { boundless(wall, state, contacts) }
            }))
        }),
        case("any contact is every contact", "where anything may touch, nothing is looked at", EXEMPTS, || {
            check(rule(|wall, state, contacts| {
                if !contacts.is_empty() && std::iter::once(&state.robot).chain(&state.objects).all(inside) {
                    return Ok(());
                }
                honest_check(wall, state, contacts)
            }))
        }),
        case("one cart for all", "whoever may touch one cart may touch them all", EXEMPTS, || {
            check(rule(|wall, state, contacts| {
                let all =
                    (0..state.objects.len()).fold(contacts, |set, i| set.with(ComponentId::Object(ObjectId::new(i))));
                honest_check(wall, state, if contacts.is_empty() { contacts } else { all })
            }))
        }),
        case("walls are for others", "who handles a cart may stand in the wall", EXEMPTS, || {
            check(rule(|wall, state, contacts| {
                honest_check(if contacts.is_empty() { wall } else { (9.0, 9.0) }, state, contacts)
            }))
        }),
    ]
}

fn kinds() -> Vec<Case> {
    fn called(kind: BlockKind) -> Check {
        match kind {
            BlockKind::RobotFixed => |wall, state, contacts| {
                honest_check(wall, state, contacts).map_err(|b| match b.kind {
                    BlockKind::RobotObject => crate::validity::Blame { kind: BlockKind::RobotFixed, ..b },
                    _ => b,
                })
            },
            BlockKind::RobotObject => |wall, state, contacts| {
                honest_check(wall, state, contacts).map_err(|b| match b.kind {
                    BlockKind::RobotFixed => crate::validity::Blame { kind: BlockKind::RobotObject, ..b },
                    _ => b,
                })
            },
            _ => |wall, state, contacts| {
                honest_check(wall, state, contacts).map_err(|b| match b.kind {
                    BlockKind::Limits => b,
                    _ => crate::validity::Blame { kind: BlockKind::ObjectObject, ..b },
                })
            },
        }
    }
    vec![
        case("everything is an obstacle", "a cart is blamed as a fixed obstacle", BLAME_KIND, || {
            check(rule(called(BlockKind::RobotFixed)))
        }),
        case("everything is an object", "the wall is blamed as an object", BLAME_KIND, || {
            check(rule(called(BlockKind::RobotObject)))
        }),
        case("objects among themselves", "the robot's collisions are put down to objects", BLAME_KIND, || {
            check(rule(called(BlockKind::ObjectObject)))
        }),
    ]
}

/// A rule with another rule for the objects alone.
struct Split(fn(&Bench, &State<Bench>) -> Result<(), crate::validity::Blame>);

impl Validity<Bench> for Split {
    fn check(&self, m: &Bench, state: &State<Bench>, contacts: &ComponentSet) -> Result<(), crate::validity::Blame> {
        Rule::default().check(m, state, contacts)
    }

    fn without_robot(&self) -> Option<Arc<dyn Validity<Bench>>> {
        Some(Arc::new(Alone(self.0)))
    }

    fn free_prefix(&self, m: &Bench, instance: &crate::motion::Instance<Bench>, from: &State<Bench>) -> FreePrefix {
        Rule::default().free_prefix(m, instance, from)
    }
}

struct Alone(fn(&Bench, &State<Bench>) -> Result<(), crate::validity::Blame>);

impl Validity<Bench> for Alone {
    fn check(&self, m: &Bench, state: &State<Bench>, _: &ComponentSet) -> Result<(), crate::validity::Blame> {
        (self.0)(m, state)
    }

    fn free_prefix(&self, _: &Bench, _: &crate::motion::Instance<Bench>, _: &State<Bench>) -> FreePrefix {
        FreePrefix::FREE
    }
}

fn split(alone: fn(&Bench, &State<Bench>) -> Result<(), crate::validity::Blame>) -> Result<(), Broken> {
    let m = Bench::default();
    let claims = ValidityClaims { same_names: false, ..ValidityClaims::default() };
    (0..CASES / 8).try_for_each(|i| {
        let mut rng = inputs(i);
        let from = random_state(&mut rng);
        let moved = Arc::new(go(&m, &from, sample(&mut rng)));
        check_validity(&m, &Split(alone), &moved, &from, &claims, seed() + i)
    })
}

fn alone() -> Vec<Case> {
    let case = |name, wrong, law, broken| Case { name, wrong, law, broken, honest: || split(|_, _| Ok(())) };
    vec![
        case("a ghost in the way", "the rules without the robot still know the robot", WITHOUT_ROBOT, || {
            split(|_, state| honest_check((1.0, 1.5), state, ComponentSet::EMPTY))
        }),
        case(
            "stricter alone",
            "the rules for the objects alone keep a distance that the others do not",
            WITHOUT_ROBOT,
            || {
                split(|_, state| {
                    let near = (state.objects[0][0] - state.objects[1][0]).abs() < 0.5;
                    if near { Err(blame(BlockKind::ObjectObject, "cart 0", state.objects[0][0])) } else { Ok(()) }
                })
            },
        ),
    ]
}

fn memory() -> Vec<Case> {
    thread_local! {
        static LAST: RefCell<Option<([f64; 2], bool)>> = const { RefCell::new(None) };
    }
    vec![case("stale answer", "a cache whose key is the robot alone: moved objects are not noticed", PURE, || {
        LAST.set(None);
        check(rule(|wall, state, contacts| {
            let known = LAST.with_borrow(|last| last.filter(|(robot, _)| *robot == state.robot).map(|(_, ok)| ok));
            if known == Some(true) {
                return Ok(());
            }
            let found = honest_check(wall, state, contacts);
            LAST.set(Some((state.robot, found.is_ok())));
            found
        }))
    })]
}

fn oracles() -> Vec<Case> {
    let case = |name, wrong, law, broken| Case { name, wrong, law, broken, honest: || against(Rule::default()) };
    vec![
        case("both forget the wall", "check and prefix share the list from which the wall is missing", LAX, || {
            against(Rule { wall: (9.0, 9.0), ..Rule::default() })
        }),
        case("wall too thin", "the wall is a centimetre thinner than it is", LAX, || {
            against(Rule { wall: (1.01, 1.5), ..Rule::default() })
        }),
        case("last cart forgotten", "the loop over the carts ends one too early", LAX, || {
            against(rule(|wall, state, contacts| {
                let last = ComponentId::Object(ObjectId::new(state.objects.len() - 1));
                honest_check(wall, state, contacts.with(last))
            }))
        }),
        case("nothing is free", "rejects whatever it is shown", STRICT, || {
            against(rule(|_, state, _| Err(blame(BlockKind::Other, "caution", state.robot[0]))))
        }),
        case("far too careful", "keeps a metre from everything", STRICT, || {
            against(rule(|wall, state, contacts| {
                let x = state.robot[0];
                let near = state.objects.iter().position(|at| (at[0] - x).abs() < 1.0);
                let id = near.map(|i| name(ComponentId::Object(ObjectId::new(i))));
                match id {
                    Some(id) => Err(blame(BlockKind::RobotObject, &id, x)),
                    None => honest_check(wall, state, contacts),
                }
            }))
        }),
        case("cells of ten centimetres", "answers for the middle of the cell that the robot is in", LAX, || {
            against(rule(|wall, state, contacts| {
                let mut middle = state.clone();
                middle.robot[0] = ((state.robot[0] * 10.0).floor() + 0.5) / 10.0;
                honest_check(wall, &middle, contacts)
            }))
        }),
        case("the batch forgets the wall", "the prefix is computed without the obstacles", ORACLE_PREFIX, || {
            against(Rule {
                free_prefix: |rule, m, instance, from| {
                    scan(&Rule { wall: (9.0, 9.0), ..*rule }, m, instance, from, 1e-3)
                },
                ..Rule::default()
            })
        }),
        case("the batch looks at the ends", "whatever is free at both ends is free in between", ORACLE_PREFIX, || {
            against(Rule {
                free_prefix: |rule, m, instance, from| {
                    let is_free = |t: f64| rule.check(m, &instance.at(m, t, from), &instance.contacts);
                    match is_free(0.0).and_then(|()| is_free(1.0)) {
                        Ok(()) => FreePrefix::FREE,
                        Err(blame) => FreePrefix::blocked(0.0, blame),
                    }
                },
                ..Rule::default()
            })
        }),
    ]
}
