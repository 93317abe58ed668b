//! Broken verifiers.

use rand::RngExt;

use super::super::bench::{self, Bench, Rule, cart, robot_at, state};
use super::super::motions::{drag, go};
use super::super::{Case, inputs, seed};
use crate::domain::Domain;
use crate::goal::{Goal, Region};
use crate::laws::verifier::{ITS_GOAL, REFUSES, STEADY};
use crate::laws::{Broken, Judged, check_verifier};
use crate::plan::{Plan, Step};
use crate::space::ComponentSpace;
use crate::state::State;
use crate::validity::{BlockKind, Validity};
use crate::verify::{Refusal, Replay, Verified, Verifier};

use std::cell::Cell;
use std::sync::Arc;

/// What a verifier made of a function looks at.
struct Court<'a> {
    m: &'a Bench,
    start: &'a State<Bench>,
    goal: &'a dyn Goal<Bench>,
    plan: &'a Plan<Bench>,
}

type Verdict = fn(&Court<'_>) -> bool;

struct Judge(Verdict);

impl Verifier<Bench> for Judge {
    fn verify(
        &self,
        m: &Bench,
        start: &State<Bench>,
        goal: &dyn Goal<Bench>,
        plan: &Plan<Bench>,
    ) -> Result<Verified, Refusal> {
        let is_right = (self.0)(&Court { m, start, goal, plan });
        let refusal = || Refusal { step: None, at: 0.0, reason: "it is wrong".to_owned() };
        if is_right { Ok(Verified::default()) } else { Err(refusal()) }
    }
}

/// Behind the wall.
const RULE: fn() -> Rule = || Rule { wall: (0.1, 0.2), ..Rule::default() };

/// To the cart, along with it, back, and to the end of the rail.
fn plan(m: &Bench, start: &State<Bench>) -> Option<Plan<Bench>> {
    let mut rng = inputs(0);
    let mut steps = Vec::new();
    let mut here = start.clone();
    let mut then = |here: &mut State<Bench>, instance: crate::motion::Instance<Bench>| {
        let instance = Arc::new(instance);
        *here = instance.at(m, 1.0, here);
        steps.push(Step { instance, until: 1.0, primitive: 0 });
    };
    let turn = rng.random_range(-1.0..1.0);
    let all = crate::state::ComponentSet::EMPTY.with(crate::state::ComponentId::Object(cart()));
    let mut there = go(m, start, [1.93, turn]);
    there.contacts = all;
    then(&mut here, there);
    let mut dragged = drag(&here, rng.random_range(2.3..2.7))?;
    dragged.contacts = all;
    then(&mut here, dragged);
    let mut back = go(m, &here, [rng.random_range(0.8..1.2), turn]);
    back.contacts = all;
    then(&mut here, back);
    let last = go(m, &here, [rng.random_range(0.4..0.6), 0.0]);
    then(&mut here, last);
    Some(Plan::new(start.clone(), steps))
}

fn check(verifier: &dyn Verifier<Bench>) -> Result<(), Broken> {
    let m = Bench::default();
    let mut start = state([0.8, 0.3]);
    start.objects = [[2.0, 0.0], [3.8, 0.5]].into_iter().collect();
    let goal = Region::<Bench>::new(
        Box::new(|_, s| s.robot[0] <= 0.61 && s.objects.first().is_some_and(|at| at[0] > 2.25)),
        Box::new(|_, _| Some(robot_at([0.5, 0.0]))),
    );
    let rule = RULE();
    let judged = Judged { domain: &m, start: &start, goal: &goal, validity: Some(&rule), verifier };
    let Some(plan) = plan(&m, &start) else { return Ok(()) };
    let tampered = check_verifier(&judged, &plan, seed())?;
    // Enough ways for this plan.
    if tampered.tried.len() < 24 {
        return Err(Broken::new("verifier.tried: enough ways are tried", format!("{tampered:?}"), "24"));
    }
    Ok(())
}

fn judged(verdict: Verdict) -> Result<(), Broken> {
    check(&Judge(verdict))
}

/// All states of all steps at this spacing are valid, begin where the last one ended, and the end is in the goal.
fn replayed(court: &Court<'_>, looks: u32, is_valid: fn(&Bench, &State<Bench>, &Step<Bench>) -> bool) -> bool {
    let Court { m, start, goal, plan } = court;
    if plan.start() != *start {
        return false;
    }
    let mut here = (*start).clone();
    for (i, step) in plan.steps().iter().enumerate() {
        if !(step.until > 0.0 && step.until <= 1.0) || plan.at(m, i, 0.0).as_ref() != Some(&here) {
            return false;
        }
        for look in 0..=looks {
            let Some(state) = plan.at(m, i, f64::from(look) / f64::from(looks)) else { return false };
            if !is_valid(m, &state, step) {
                return false;
            }
            here = state;
        }
    }
    goal.is_satisfied(m, &here)
}

fn is_valid(m: &Bench, state: &State<Bench>, step: &Step<Bench>) -> bool {
    RULE().check(m, state, &step.instance.contacts).is_ok()
}

fn honest(court: &Court<'_>) -> bool {
    Replay::new(RULE(), 1e-3).verify(court.m, court.start, court.goal, court.plan).is_ok()
}

fn case(name: &'static str, wrong: &'static str, law: &'static str, broken: fn() -> Result<(), Broken>) -> Case {
    Case { name, wrong, law, broken, honest: || check(&Replay::new(RULE(), 1e-3)) }
}

pub(super) fn cases() -> Vec<Case> {
    [refusing(), steady()].concat()
}

fn refusing() -> Vec<Case> {
    thread_local! {
        static CALLS: Cell<u32> = const { Cell::new(0) };
    }
    vec![
        case("accepts everything", "the judge was never filled in", REFUSES, || judged(|_| true)),
        case("judges the end", "looks whether the goal is reached, and not how", REFUSES, || {
            judged(|court| court.goal.is_satisfied(court.m, &court.plan.end(court.m)))
        }),
        case(
            "judges the chain",
            "steps begin where the last one ended: nothing is said of what is between",
            REFUSES,
            || judged(|court| replayed(court, 1, |_, state, _| state.robot[0].is_finite())),
        ),
        case("a few looks", "sixteen states of every step", REFUSES, || judged(|court| replayed(court, 16, is_valid))),
        case("looks at states alone", "every state is valid, however it came about", REFUSES, || {
            judged(|court| replayed(court, 1000, is_valid))
        }),
        case("forgets the goal", "a plan that is possible is a plan", REFUSES, || {
            judged(|court| {
                let anywhere = Region::<Bench>::new(Box::new(|_, _| true), Box::new(|_, _| None));
                honest(&Court { goal: &anywhere, m: court.m, start: court.start, plan: court.plan })
            })
        }),
        case("forgets the start", "believes the plan where it starts", REFUSES, || {
            judged(|court| honest(&Court { start: court.plan.start(), goal: court.goal, m: court.m, plan: court.plan }))
        }),
        case("skips the last step", "a range that is one too short", REFUSES, || {
            judged(|court| {
                let all = court.plan.steps();
                let but_last = all.get(..all.len().saturating_sub(1)).unwrap_or_default().to_vec();
                let end = court.plan.end(court.m);
                let anywhere = Region::<Bench>::new(Box::new(|_, _| true), Box::new(|_, _| None));
                let plan = Plan::new(court.plan.start().clone(), but_last);
                honest(&Court { goal: &anywhere, m: court.m, start: court.start, plan: &plan })
                    && court.goal.is_satisfied(court.m, &end)
            })
        }),
        case("only the robot counts", "objects may be anywhere on the way", REFUSES, || {
            judged(|court| {
                replayed(court, 1000, |m, state, step| {
                    let mut alone = state.clone();
                    alone.objects.clone_from(&step.instance.at(m, 0.0, state).objects);
                    is_valid(m, &alone, step)
                })
            })
        }),
        case(
            "believes the length",
            "as many looks as the length asks for: none for a motion of no length",
            REFUSES,
            || {
                judged(|court| {
                    let looks = |step: &Step<Bench>| (step.instance.motion.length() / 0.01).ceil().clamp(1.0, 1e4);
                    let is_continuous = court.plan.steps().iter().enumerate().all(|(i, step)| {
                        let (mut last, mut k) = (court.plan.at(court.m, i, 0.0), 0.0);
                        let count = looks(step);
                        while k < count {
                            k += 1.0;
                            let now = court.plan.at(court.m, i, k / count);
                            let (Some(p), Some(q)) = (&last, &now) else { return false };
                            let metres = court.m.robot().distance(&p.robot, &q.robot);
                            if !(metres <= step.instance.motion.length() / count + 1e-6
                                || step.instance.motion.length() == 0.0)
                            {
                                return false;
                            }
                            if !is_valid(court.m, q, step) {
                                return false;
                            }
                            last = now;
                        }
                        true
                    });
                    is_continuous && replayed(court, 2, is_valid)
                })
            },
        ),
        case("carts know no end", "the ends of the rail are for the robot", REFUSES, || {
            let lenient = |wall, state: &State<Bench>, contacts| match bench::check(wall, state, contacts) {
                Err(blame) if blame.kind == BlockKind::Limits && *blame.first != *"robot" => Ok(()),
                found => found,
            };
            check(&Replay::new(Rule { check: lenient, ..RULE() }, 1e-3))
        }),
        case("the first is as good as the next", "does not look again at a plan of as many steps", REFUSES, || {
            CALLS.set(0);
            judged(|court| {
                CALLS.set(CALLS.get() + 1);
                court.plan.steps().len() == 4 || honest(court)
            })
        }),
    ]
}

fn steady() -> Vec<Case> {
    thread_local! {
        static CALLS: Cell<u32> = const { Cell::new(0) };
    }
    vec![
        case("another mood", "accepts a plan, and refuses it when asked again", STEADY, || {
            CALLS.set(0);
            judged(|court| {
                CALLS.set(CALLS.get() + 1);
                CALLS.get() % 2 == 1 && honest(court)
            })
        }),
        case("a start with some slack", "the robot may start within a hand's breadth", ITS_GOAL, || {
            judged(|court| {
                let aside_m = (court.plan.start().robot[0] - court.start.robot[0]).abs();
                let start = court.plan.start();
                aside_m < 0.1 && honest(&Court { start, m: court.m, goal: court.goal, plan: court.plan })
            })
        }),
        case("a goal of its own", "judges by the goal that it was made with", ITS_GOAL, || {
            judged(|court| {
                let own = Region::<Bench>::new(
                    Box::new(|_, s| s.robot[0] <= 0.61 && s.objects.first().is_some_and(|at| at[0] > 2.25)),
                    Box::new(|_, _| None),
                );
                honest(&Court { goal: &own, m: court.m, start: court.start, plan: court.plan })
            })
        }),
    ]
}
