//! Broken validities.

use std::cell::Cell;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use super::Case;
use super::bench::{Bench, Check, Rule, TOUCH_M, blame, check as honest_check, scan, state};
use super::motions::{drag, go};
use crate::laws::validity::{
    BLAME_NAMES, BLAME_REAL, BLAME_TEXT, CARE, CUT, ENLARGED, EXEMPTIONS, FRACTION, ONE_BY_ONE, ORACLE, PURE,
};
use crate::laws::{Broken, ValidityClaims, check_against_oracle, check_enlarged, check_validity};
use crate::motion::Instance;
use crate::state::{ComponentId, ComponentSet, ObjectId, State};
use crate::validity::{Blame, BlockKind, FreePrefix, Validity};

/// A motion that ends in the wall, one that runs through it, one that is free, one that begins in it, one
/// that is short, and a drag.
fn check(rule: Rule) -> Result<(), Broken> {
    check_with(rule, &ValidityClaims::default())
}

fn check_with(rule: Rule, claims: &ValidityClaims) -> Result<(), Broken> {
    let m = Bench::default();
    for (from, to) in [(0.5, 1.02), (0.5, 1.2), (0.9, 1.6), (0.5, 1.8), (0.2, 0.9), (1.2, 0.5), (0.5, 0.51), (1.6, 2.5)]
    {
        let from = state([from, 3.0]);
        check_validity(&m, &rule, &Arc::new(go(&m, &from, [to, 3.0])), &from, claims, 1)?;
    }
    let from = state([1.95, 0.0]);
    let Some(dragged) = drag(&from, 2.5) else { return Ok(()) };
    check_validity(&m, &rule, &Arc::new(dragged), &from, claims, 1)
}

fn prefix(free_prefix: fn(&Rule, &Bench, &Instance<Bench>, &State<Bench>) -> FreePrefix) -> Result<(), Broken> {
    check(Rule { free_prefix, ..Rule::default() })
}

/// For prefixes that do not claim to be tight.
fn loose(free_prefix: fn(&Rule, &Bench, &Instance<Bench>, &State<Bench>) -> FreePrefix) -> Result<(), Broken> {
    let claims = ValidityClaims { tight_m: 1.0, ..ValidityClaims::default() };
    check_with(Rule { free_prefix, ..Rule::default() }, &claims)
}

fn case(name: &'static str, wrong: &'static str, law: &'static str, broken: fn() -> Result<(), Broken>) -> Case {
    Case { name, wrong, law, broken, honest: || check(Rule::default()) }
}

pub(super) fn cases() -> Vec<Case> {
    [prefixes(), blames(), rules(), pairs()].concat()
}

fn honest(rule: &Rule, m: &Bench, instance: &Instance<Bench>, from: &State<Bench>) -> FreePrefix {
    scan(rule, m, instance, from, 1e-3)
}

fn prefixes() -> Vec<Case> {
    static CALLS: AtomicU32 = AtomicU32::new(0);
    vec![
        case("off by one at the last waypoint", "the loop ends before the end of the motion", ONE_BY_ONE, || {
            loose(|rule, m, instance, from| {
                let mut free = 0.0;
                for i in 0..10 {
                    let t = f64::from(i) / 10.0;
                    if let Err(blame) = (rule.check)(rule.wall, &instance.at(m, t, from), instance.contacts) {
                        return FreePrefix::blocked(free, blame);
                    }
                    free = t;
                }
                FreePrefix::FREE
            })
        }),
        case("steps over the wall", "its step is longer than the wall is thick", ONE_BY_ONE, || {
            loose(|rule, m, instance, from| scan(rule, m, instance, from, 0.8))
        }),
        case("blames the last free state", "the fraction is that of the first blocked state", ONE_BY_ONE, || {
            prefix(|rule, m, instance, from| {
                let free = honest(rule, m, instance, from);
                let step = 1e-3 / instance.motion.length();
                match free.blame {
                    Some(blame) => FreePrefix::blocked(free.fraction + 2.0 * step, blame),
                    None => free,
                }
            })
        }),
        case("ends only", "checks where the motion begins and ends", ONE_BY_ONE, || {
            loose(|rule, m, instance, from| scan(rule, m, instance, from, f64::INFINITY))
        }),
        case("free, but blamed", "says 1 and a blame, when only the last state is blocked", FRACTION, || {
            prefix(|rule, m, instance, from| {
                let free = honest(rule, m, instance, from);
                FreePrefix { fraction: if free.fraction > 0.5 { 1.0 } else { free.fraction }, ..free }
            })
        }),
        case("blocked, but nobody knows by what", "a prefix that ends early without blame", FRACTION, || {
            prefix(|rule, m, instance, from| FreePrefix { blame: None, ..honest(rule, m, instance, from) })
        }),
        case("too short to look at", "no steps for short motions, and no steps means blocked", CUT, || {
            prefix(|rule, m, instance, from| {
                let is_short = instance.motion.length() < 0.15 && instance.motion.length() > 0.1;
                if is_short {
                    FreePrefix::blocked(0.0, blame(BlockKind::Other, "nothing", 0.0))
                } else {
                    honest(rule, m, instance, from)
                }
            })
        }),
        case("remembers the last answer", "a cache whose key leaves out the motion", PURE, || {
            prefix(|rule, m, instance, from| {
                let free = honest(rule, m, instance, from);
                let is_stale = CALLS.fetch_add(1, Ordering::Relaxed) % 2 == 1;
                if is_stale {
                    FreePrefix { fraction: free.fraction * 0.999, blame: Some(blame(BlockKind::Other, "cache", 0.0)) }
                } else {
                    free
                }
            })
        }),
    ]
}

fn blames() -> Vec<Case> {
    vec![
        case("bounding sphere", "blames what only the bounds of the bodies touch", BLAME_REAL, || {
            prefix(|rule, m, instance, from| {
                let padded = Rule { wall: (rule.wall.0 - 0.2, rule.wall.1 + 0.05), ..*rule };
                honest(&padded, m, instance, from)
            })
        }),
        case("always the first body", "blames the body of index 0, whichever it was", BLAME_NAMES, || {
            prefix(|rule, m, instance, from| {
                let mut free = honest(rule, m, instance, from);
                if let Some(blame) = &mut free.blame {
                    blame.second = "cart 0".into();
                }
                free
            })
        }),
        case("nameless", "a blame without names", BLAME_TEXT, || {
            prefix(|rule, m, instance, from| {
                let mut free = honest(rule, m, instance, from);
                if let Some(blame) = &mut free.blame {
                    blame.second = "".into();
                }
                free
            })
        }),
    ]
}

fn rules() -> Vec<Case> {
    thread_local! {
        static EXEMPT: Cell<bool> = const { Cell::new(false) };
    }
    vec![
        case("exemption that stays", "contacts once allowed are allowed from then on", EXEMPTIONS, || {
            EXEMPT.set(false);
            let check_rule = |wall: (f64, f64), state: &State<Bench>, contacts: ComponentSet| {
                let cart = ComponentId::Object(ObjectId::new(0));
                EXEMPT.set(EXEMPT.get() || contacts.contains(cart));
                honest_check(wall, state, if EXEMPT.get() { contacts.with(cart) } else { contacts })
            };
            check(Rule { check: check_rule, ..Rule::default() })
        }),
        case("inverted exemption", "the contacts are what must not touch", EXEMPTIONS, || {
            check(Rule {
                check: |wall, state, contacts| {
                    let far = |i: usize| ComponentId::Object(ObjectId::new(i));
                    let all = ComponentSet::EMPTY.with(far(0)).with(far(1));
                    let cart = state.objects.first().map_or(f64::INFINITY, |at| (at[0] - state.robot[0]).abs());
                    if contacts.contains(far(0)) && cart < TOUCH_M {
                        return Err(blame(BlockKind::RobotObject, "cart 0", state.robot[0]));
                    }
                    honest_check(wall, state, all)
                },
                ..Rule::default()
            })
        }),
    ]
}

/// Rules, and what is asked with care.
struct Careful {
    rules: Rule,
    with_care: Rule,
}

impl Validity<Bench> for Careful {
    fn check(&self, m: &Bench, state: &State<Bench>, contacts: &ComponentSet) -> Result<(), Blame> {
        self.rules.check(m, state, contacts)
    }

    fn free_prefix(&self, m: &Bench, instance: &Instance<Bench>, from: &State<Bench>) -> FreePrefix {
        self.rules.free_prefix(m, instance, from)
    }

    fn most_care(&self) -> usize {
        1
    }

    fn check_with(&self, care: usize, m: &Bench, state: &State<Bench>, contacts: &ComponentSet) -> Result<(), Blame> {
        if care > 0 { self.with_care.check(m, state, contacts) } else { self.rules.check(m, state, contacts) }
    }

    fn free_prefix_with(&self, care: usize, m: &Bench, instance: &Instance<Bench>, from: &State<Bench>) -> FreePrefix {
        let rule = if care > 0 { &self.with_care } else { &self.rules };
        rule.free_prefix(m, instance, from)
    }
}

fn careful(wall: (f64, f64)) -> Result<(), Broken> {
    let m = Bench::default();
    let rule = Careful { rules: Rule::default(), with_care: Rule { wall, ..Rule::default() } };
    let from = state([0.5, 3.0]);
    let check =
        |to| check_validity(&m, &rule, &Arc::new(go(&m, &from, [to, 3.0])), &from, &ValidityClaims::default(), 1);
    [0.6, 0.97, 1.05, 1.2].into_iter().try_for_each(check)
}

fn pairs() -> Vec<Case> {
    vec![
        Case {
            name: "careless with care",
            wrong: "the margin is taken from the obstacle, not added to it",
            law: CARE,
            broken: || careful((1.1, 1.4)),
            honest: || careful((0.9, 1.6)),
        },
        Case {
            name: "hollow obstacle",
            wrong: "tests the faces of the obstacle only: well inside it everything is free",
            law: ENLARGED,
            broken: || {
                enlarged(|wall, state, _| {
                    let x = state.robot[0];
                    let near = |face: f64| (x - face).abs() < 0.1;
                    if near(wall.0) || near(wall.1) { Err(blame(BlockKind::RobotFixed, "wall", x)) } else { Ok(()) }
                })
            },
            honest: || enlarged(honest_check),
        },
        Case {
            name: "thinner for speed",
            wrong: "the fast check shrinks the obstacle, where it should grow it",
            law: ORACLE,
            broken: || oracle((1.1, 1.4)),
            honest: || oracle((0.9, 1.6)),
        },
    ]
}

fn enlarged(rule: Check) -> Result<(), Broken> {
    let small = Rule { check: rule, ..Rule::default() };
    let large = Rule { wall: (0.5, 2.0), ..small };
    let check = |x: f64| {
        check_enlarged(&Bench::default(), &small as &dyn Validity<_>, &large, &state([x, 0.0]), &ComponentSet::EMPTY)
    };
    [0.2, 0.95, 1.05, 1.25, 1.45, 1.7].into_iter().try_for_each(check)
}

fn oracle(wall: (f64, f64)) -> Result<(), Broken> {
    let (m, from) = (Bench::default(), state([0.5, 0.0]));
    let fast = Rule { wall, ..Rule::default() };
    check_against_oracle(&m, &fast, &Rule::default(), &go(&m, &from, [1.3, 0.0]), &from, 500)
}
