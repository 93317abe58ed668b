//! What slips, what is far too long, refusals that say nothing, and rules that take care in one place only.

use std::sync::Arc;

use rand::RngExt;

use super::super::bench::{Act, Bench, Rule, Tag, blame, cart, cart_at, check as honest_check, name, robot_at, state};
use super::super::motions::{go, instance, random_state};
use super::super::{Case, inputs, seed};
use super::CASES;
use crate::goal::{Goal, Region};
use crate::laws::motion::{MotionClaims, TIGHT};
use crate::laws::planner::check_planner;
use crate::laws::primitive::HOLDS;
use crate::laws::validity::{BLAME_KIND, BLAME_PLACE, CARE, WITHOUT_ROBOT};
use crate::laws::verifier::{ACCEPTS, CLEARANCE, REFUSAL};
use crate::laws::{
    Broken, Judged, PrimitiveClaims, ValidityClaims, check_instance, check_validity, check_verifier, try_primitive,
};
use crate::motion::{Instance, Motion, Waypoints};
use crate::plan::{Plan, Step};
use crate::primitive::{Infeasible, Primitive};
use crate::state::{ComponentId, ComponentSet, ObjectId, State};
use crate::validity::{Blame, BlockKind, FreePrefix, Validity};
use crate::verify::{Refusal, Replay, Verified, Verifier};

pub(super) fn cases() -> Vec<Case> {
    [held(), rules(), judges()].concat()
}

/// The motion of another, with cart 0 where it was a little earlier.
#[derive(Debug)]
struct Lagging {
    inner: Waypoints<Bench>,
    by: f64,
}

impl Motion<Bench> for Lagging {
    fn length(&self) -> f64 {
        2.0 * self.inner.length()
    }

    fn at_into(&self, m: &Bench, t: f64, out: &mut State<Bench>) {
        self.inner.at_into(m, t, out);
        if t > 0.0 && t < 1.0 {
            let mut before = out.clone();
            self.inner.at_into(m, t - self.by * t * (1.0 - t), &mut before);
            out.objects.clone_from(&before.objects);
        }
    }
}

/// Robot and cart 0 along the rail to where the target wants the cart.
fn along(from: &State<Bench>, x: f64, by: f64) -> Option<Instance<Bench>> {
    let mut end = from.clone();
    let slot = end.objects.get_mut(cart().index())?;
    let metres = x - slot[0];
    slot[0] = x;
    end.robot[0] += metres;
    let inner = Waypoints::new(vec![from.clone(), end], &[metres.abs() + 1e-12], from.mode.clone())?;
    let moves = ComponentSet::ROBOT.with(ComponentId::Object(cart()));
    let motion = Lagging { inner, by };
    Some(Instance { object: Some(cart()), contacts: moves, reversible: false, ..instance(motion, moves) })
}

/// Drags cart 0, which the domain may call carried.
fn dragging(is_carried: bool, lag: bool) -> Result<(), Broken> {
    let objects = |tag: &Tag| {
        if tag.number() > 0 { ComponentSet::EMPTY.with(ComponentId::Object(cart())) } else { ComponentSet::EMPTY }
    };
    let m = Bench { carried: objects, ..Bench::default() };
    let useful =
        |m: &Bench, from: &State<Bench>, to: &crate::partial::PartialState<Bench>| !to.are_objects_met(m, from);
    let slack: Act = Act {
        useful,
        approach: |_, _, _| None,
        propagate: |_, from, to, _| {
            let target = to.object(cart()).ok_or(Infeasible::NoProgress)?;
            along(from, target[0], 0.2).map(|instance| vec![instance]).ok_or(Infeasible::NoContact)
        },
    };
    let firm: Act = Act {
        propagate: |_, from, to, _| {
            let target = to.object(cart()).ok_or(Infeasible::NoProgress)?;
            along(from, target[0], 0.0).map(|instance| vec![instance]).ok_or(Infeasible::NoContact)
        },
        ..slack
    };
    for i in 0..CASES / 16 {
        let mut rng = inputs(i);
        let mut from = random_state(&mut rng);
        from.mode = Tag::new(u32::from(is_carried));
        from.objects[0] = [2.0 + 0.5 * rng.random_range(-1.0..1.0), 0.0];
        from.robot = [from.objects[0][0] - 0.05, 0.0];
        let x = rng.random_range(0.4..3.6);
        let to = cart_at([x, 0.0]);
        let act: &dyn Primitive<Bench> = if lag { &slack } else { &firm };
        try_primitive(&m, act, &from, &to, seed() + i, &PrimitiveClaims::default())?;
    }
    Ok(())
}

/// One metre along the rail, with this many metres for every metre.
fn long(factor: f64) -> Result<(), Broken> {
    let (m, from) = (Bench::default(), state([0.5, 0.1]));
    let mut way = go(&m, &from, [1.5, 0.1]);
    let inner = Waypoints::new(vec![from.clone(), way.at(&m, 1.0, &from)], &[factor], from.mode.clone());
    if let Some(inner) = inner {
        way.motion = Box::new(inner);
    }
    check_instance(&m, &way, &from, &[0.3], &MotionClaims::default())
}

fn held() -> Vec<Case> {
    vec![
        Case {
            name: "what is carried lags",
            wrong: "follows where the robot was a little earlier, and is there at the end",
            law: HOLDS,
            broken: || dragging(true, true),
            honest: || dragging(true, false),
        },
        Case {
            name: "the hand runs ahead",
            wrong: "the cart starts late and catches up: in between nobody pushes it",
            law: HOLDS,
            broken: || dragging(false, true),
            honest: || dragging(false, false),
        },
        Case {
            name: "length in millimetres",
            wrong: "a bound that holds, and is far too large",
            law: TIGHT,
            broken: || long(1e4),
            honest: || long(1.0),
        },
    ]
}

/// The rule of the bench as a whole, with more care and without the robot.
#[derive(Clone, Copy)]
struct Careful {
    rule: Rule,
    /// Metres that are added to the wall with care: of states, and of motions.
    wider_m: [f64; 2],
    alone: fn(&State<Bench>) -> Result<(), Blame>,
}

const CAREFUL: Careful = Careful {
    rule: Rule {
        wall: (1.0, 1.5),
        check: spaced,
        free_prefix: |r, m, i, from| super::super::bench::scan(r, m, i, from, 1e-3),
    },
    wider_m: [0.1; 2],
    alone: apart,
};

/// Carts keep 0.2 m from each other.
fn apart(state: &State<Bench>) -> Result<(), Blame> {
    let [p, q] = [0, 1].map(|i| state.objects.get(i).map_or(f64::NAN, |at| at[0]));
    if (p - q).abs() < 0.2 {
        let [first, second] = [0, 1].map(|i| name(ComponentId::Object(ObjectId::new(i))));
        return Err(Blame { first: first.into(), ..blame(BlockKind::ObjectObject, &second, p) });
    }
    Ok(())
}

fn spaced(wall: (f64, f64), state: &State<Bench>, contacts: ComponentSet) -> Result<(), Blame> {
    honest_check(wall, state, contacts)?;
    apart(state)
}

impl Careful {
    fn with(&self, care: usize, which: usize) -> Rule {
        let wider_m = if care == 0 { 0.0 } else { self.wider_m.get(which).copied().unwrap_or(0.0) };
        Rule { wall: (self.rule.wall.0 - wider_m, self.rule.wall.1 + wider_m), ..self.rule }
    }
}

/// The objects alone.
struct Alone(fn(&State<Bench>) -> Result<(), Blame>);

impl Validity<Bench> for Alone {
    fn check(&self, _: &Bench, state: &State<Bench>, _: &ComponentSet) -> Result<(), Blame> {
        (self.0)(state)
    }

    fn free_prefix(&self, m: &Bench, instance: &Instance<Bench>, from: &State<Bench>) -> FreePrefix {
        CAREFUL.rule.free_prefix(m, instance, from)
    }
}

impl Validity<Bench> for Careful {
    fn check(&self, m: &Bench, state: &State<Bench>, contacts: &ComponentSet) -> Result<(), Blame> {
        self.rule.check(m, state, contacts)
    }

    fn free_prefix(&self, m: &Bench, instance: &Instance<Bench>, from: &State<Bench>) -> FreePrefix {
        self.rule.free_prefix(m, instance, from)
    }

    fn most_care(&self) -> usize {
        1
    }

    fn check_with(&self, care: usize, m: &Bench, state: &State<Bench>, contacts: &ComponentSet) -> Result<(), Blame> {
        self.with(care, 0).check(m, state, contacts)
    }

    fn free_prefix_with(&self, care: usize, m: &Bench, instance: &Instance<Bench>, from: &State<Bench>) -> FreePrefix {
        self.with(care, 1).free_prefix(m, instance, from)
    }

    fn without_robot(&self) -> Option<Arc<dyn Validity<Bench>>> {
        Some(Arc::new(Alone(self.alone)))
    }
}

/// Ways of the robot between free places.
fn rule(careful: Careful) -> Result<(), Broken> {
    let m = Bench::default();
    let claims = ValidityClaims { same_names: false, ..ValidityClaims::default() };
    for i in 0..CASES / 16 {
        let mut rng = inputs(i);
        let mut from = random_state(&mut rng);
        from.objects[0][0] = 0.3;
        from.objects[1][0] = 3.8;
        from.robot[0] = 0.6;
        let to = super::super::bench::sample(&mut rng);
        let moved = Arc::new(go(&m, &from, to));
        check_validity(&m, &careful, &moved, &from, &claims, seed() + i)?;
    }
    Ok(())
}

fn rules() -> Vec<Case> {
    let case = |name, wrong, law, broken| Case { name, wrong, law, broken, honest: || rule(CAREFUL) };
    vec![
        case("care for motions only", "the margin was added where motions are looked at", CARE, || {
            rule(Careful { wider_m: [0.0, 0.1], ..CAREFUL })
        }),
        case("care for states only", "the margin was added where states are looked at", CARE, || {
            rule(Careful { wider_m: [0.1, 0.0], ..CAREFUL })
        }),
        case("everything may be alone", "without the robot nothing is in the way of anything", WITHOUT_ROBOT, || {
            rule(Careful { alone: |_| Ok(()), ..CAREFUL })
        }),
        case("nowhere", "the place of a blame was never filled in", BLAME_PLACE, || {
            let check = |wall, state: &State<Bench>, contacts| {
                spaced(wall, state, contacts).map_err(|blame| Blame { place: [0.0; 3], ..blame })
            };
            rule(Careful { rule: Rule { check, ..CAREFUL.rule }, ..CAREFUL })
        }),
        case("elsewhere", "the place of a blame is in millimetres", BLAME_PLACE, || {
            let check = |wall, state: &State<Bench>, contacts| {
                spaced(wall, state, contacts).map_err(|blame| Blame { place: blame.place.map(|x| 1e3 * x), ..blame })
            };
            rule(Careful { rule: Rule { check, ..CAREFUL.rule }, ..CAREFUL })
        }),
        case("something else", "every rule is called another rule", BLAME_KIND, || {
            let check = |wall, state: &State<Bench>, contacts| {
                spaced(wall, state, contacts).map_err(|blame| Blame { kind: BlockKind::Other, ..blame })
            };
            rule(Careful { rule: Rule { check, ..CAREFUL.rule }, ..CAREFUL })
        }),
        case("names by number", "objects are called by their index", BLAME_KIND, || {
            let check = |wall, state: &State<Bench>, contacts| {
                spaced(wall, state, contacts).map_err(|blame| match blame.kind {
                    BlockKind::RobotObject => Blame { second: "object 0".into(), ..blame },
                    _ => blame,
                })
            };
            rule(Careful { rule: Rule { check, ..CAREFUL.rule }, ..CAREFUL })
        }),
    ]
}

/// A judge whose verdicts are changed.
struct Clerk {
    verified: fn(Verified) -> Verified,
    refusal: fn(Refusal) -> Refusal,
}

impl Verifier<Bench> for Clerk {
    fn verify(
        &self,
        m: &Bench,
        start: &State<Bench>,
        goal: &dyn Goal<Bench>,
        plan: &Plan<Bench>,
    ) -> Result<Verified, Refusal> {
        let rule = Rule { wall: (0.1, 0.2), ..Rule::default() };
        Replay::new(rule, 1e-3).verify(m, start, goal, plan).map(self.verified).map_err(self.refusal)
    }
}

const CLERK: Clerk = Clerk { verified: |v| v, refusal: |r| r };

fn clerk(clerk: &Clerk) -> Result<(), Broken> {
    let (m, start) = (Bench::default(), state([0.8, 0.3]));
    let goal = Region::<Bench>::new(Box::new(|_, s| s.robot[0] > 1.4), Box::new(|_, _| Some(robot_at([1.5, 0.0]))));
    let mut here = start.clone();
    let steps = [1.1, 1.5].map(|x| {
        let instance = Arc::new(go(&m, &here, [x, 0.0]));
        here = instance.at(&m, 1.0, &here);
        Step { instance, until: 1.0, primitive: 0 }
    });
    let judged = Judged { domain: &m, start: &start, goal: &goal, validity: None, verifier: clerk };
    check_verifier(&judged, &Plan::new(start.clone(), steps.to_vec()), seed()).map(|_| ())
}

/// Refuses, or judges.
struct Stern(bool);

impl Verifier<Bench> for Stern {
    fn verify(
        &self,
        m: &Bench,
        start: &State<Bench>,
        goal: &dyn Goal<Bench>,
        plan: &Plan<Bench>,
    ) -> Result<Verified, Refusal> {
        if self.0 {
            return Err(Refusal { step: Some(0), at: 0.0, reason: "not good enough".to_owned() });
        }
        Replay::new(Rule::default(), 1e-3).verify(m, start, goal, plan)
    }
}

/// A search that is judged by it.
fn stern(refuses: bool) -> Result<(), Broken> {
    let unusable =
        |error: crate::error::Error| Broken::new("testing.bench: the bench is sound", error.to_string(), "no error");
    let act = Act {
        useful: |m, from, to| to.are_objects_met(m, from) && !to.is_robot_met(m, from),
        approach: |_, _, _| None,
        propagate: |m, from, to, _| Ok(vec![go(m, from, to.robot_overlay(m, &from.robot))]),
    };
    let goal = Region::<Bench>::new(
        Box::new(|_, s: &State<Bench>| s.robot[0] < 0.02),
        Box::new(|_, _| Some(robot_at([0.01, 0.0]))),
    );
    let problem = crate::problem::Problem::new(crate::problem::Parts {
        domain: Bench::default(),
        start: state([0.5, 0.1]),
        goal: Box::new(goal),
        primitives: vec![Box::new(act)],
        validity: Box::new(Rule::default()),
        verifier: Box::new(Stern(refuses)),
    })
    .map_err(unusable)?;
    let strategy = crate::search::Strategy {
        sampler: Box::new(crate::sample::RandomSubset),
        distance: Box::new(crate::distance::Euclidean),
        extend: crate::extend::ExtendOptions::default(),
        local_repair: None,
        try_penalty_m: 0.0,
        shorten: crate::shorten::ShortenOptions::default(),
        improve: None,
    };
    let budget = crate::budget::Budget { iterations: Some(80), ..crate::budget::Budget::default() };
    let options = crate::solve::SolveOptions { seed: seed(), budget, restart_iterations: None, threads: 1 };
    check_planner(&problem, &strategy, &options)
}

fn judges() -> Vec<Case> {
    let case = |name, wrong, law, broken| Case { name, wrong, law, broken, honest: || clerk(&CLERK) };
    vec![
        case("no reason", "refuses, and does not say why", REFUSAL, || {
            clerk(&Clerk { refusal: |r| Refusal { reason: String::new(), ..r }, ..CLERK })
        }),
        case("step of another plan", "counts from the end of a longer plan", REFUSAL, || {
            clerk(&Clerk { refusal: |r| Refusal { step: Some(99), ..r }, ..CLERK })
        }),
        case("less than no room", "measures into the bodies, and accepts", CLEARANCE, || {
            clerk(&Clerk { verified: |_| Verified { clearance_m: Some(-0.2), ..Verified::default() }, ..CLERK })
        }),
        Case {
            name: "refuses everything",
            wrong: "a comparison the wrong way round",
            law: ACCEPTS,
            broken: || stern(true),
            honest: || stern(false),
        },
    ]
}
