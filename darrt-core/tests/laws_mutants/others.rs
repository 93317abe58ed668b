//! Goals, samplers, distances, verifiers.

use darrt_core::distance::{Distance, GreedyVisit};
use darrt_core::partial::PartialState;
use darrt_core::plan::Plan;
use darrt_core::prelude::*;
use darrt_core::sample::{RandomSubset, Sampler};
use darrt_core::testing::puck::{Judge, PuckWorld};
use darrt_core::verify::{Refusal, Verified, Verifier};
use rand::Rng;

use super::{Mutant, notices, problem};

struct Aim {
    test: fn(bool) -> bool,
    draw: fn(PartialState<PuckWorld>) -> Option<PartialState<PuckWorld>>,
}

impl Goal<PuckWorld> for Aim {
    fn is_satisfied(&self, m: &PuckWorld, state: &State<PuckWorld>) -> bool {
        (self.test)(problem().goal().is_satisfied(m, state))
    }

    fn sample(&self, m: &PuckWorld, rng: &mut dyn Rng) -> Option<PartialState<PuckWorld>> {
        (self.draw)(problem().goal().sample(m, rng)?)
    }
}

struct Draw(fn(&PuckWorld, PartialState<PuckWorld>, &mut dyn Rng) -> PartialState<PuckWorld>);

impl Sampler<PuckWorld> for Draw {
    fn sample(&self, m: &PuckWorld, goal: &dyn Goal<PuckWorld>, rng: &mut dyn Rng) -> PartialState<PuckWorld> {
        let sample = RandomSubset.sample(m, goal, rng);
        (self.0)(m, sample, rng)
    }
}

struct Metres(fn(f64, &PuckWorld, &State<PuckWorld>, &PartialState<PuckWorld>) -> f64);

impl Distance<PuckWorld> for Metres {
    fn distance(&self, m: &PuckWorld, from: &State<PuckWorld>, to: &PartialState<PuckWorld>) -> f64 {
        (self.0)(GreedyVisit.distance(m, from, to), m, from, to)
    }
}

type Verdict = fn(&Judge, &PuckWorld, &State<PuckWorld>, &dyn Goal<PuckWorld>, &Plan<PuckWorld>) -> bool;

struct Court(Verdict);

impl Verifier<PuckWorld> for Court {
    fn verify(
        &self,
        m: &PuckWorld,
        start: &State<PuckWorld>,
        goal: &dyn Goal<PuckWorld>,
        plan: &Plan<PuckWorld>,
    ) -> Result<Verified, Refusal> {
        let wall = darrt_core::testing::puck::Outline::Rectangle { lower: [1.9, 0.0], upper: [2.1, 1.0] };
        let wall = darrt_core::testing::puck::Obstacle { name: "wall".into(), outline: wall };
        let is_right = (self.0)(&Judge::new(vec![wall]), m, start, goal, plan);
        let refusal = || Refusal { step: None, at: 0.0, reason: "wrong".to_owned() };
        if is_right { Ok(Verified::default()) } else { Err(refusal()) }
    }
}

pub(super) fn all() -> Vec<Mutant> {
    let mut all: Vec<Mutant> = Vec::new();
    let goals: Vec<(&'static str, Aim)> = vec![
        ("is negated", Aim { test: |found| !found, draw: Some }),
        ("is always satisfied", Aim { test: |_| true, draw: Some }),
        ("is never satisfied", Aim { test: |_| false, draw: Some }),
        (
            "samples another place",
            Aim { test: |found| found, draw: |target| Some(target.with_object(ObjectId::new(0), [1.2, 2.3])) },
        ),
        (
            "samples a place outside",
            Aim { test: |found| found, draw: |target| Some(target.with_object(ObjectId::new(0), [1.2, 9.0])) },
        ),
    ];
    for (what, Aim { test, draw }) in goals {
        all.push(("Reach", what, Box::new(move || notices(|all| all.goal(Aim { test, draw })))));
    }
    let samplers: Vec<(&'static str, Draw)> =
        vec![
            (
                "names nothing now and then",
                Draw(|m, s, rng| if rand::RngExt::random_bool(rng, 0.01) { PartialState::anywhere(m) } else { s }),
            ),
            (
                "never names the robot",
                Draw(|m, s, _| {
                    let objects = s.objects().fold(PartialState::anywhere(m), |all, (id, at)| all.with_object(id, *at));
                    if objects.components().is_empty() {
                        objects.with_object(ObjectId::new(0), [1.0, 1.0])
                    } else {
                        objects
                    }
                }),
            ),
            (
                "outside now and then",
                Draw(|_, s, rng| {
                    if rand::RngExt::random_bool(rng, 0.01) { s.with_object(ObjectId::new(1), [9.0, 1.0]) } else { s }
                }),
            ),
            (
                "half of the room",
                Draw(|_, s, _| match s.object(ObjectId::new(0)).copied() {
                    Some([x, y]) => s.with_object(ObjectId::new(0), [0.5 * x + 0.06, y]),
                    None => s,
                }),
            ),
        ];
    for (what, Draw(draw)) in samplers {
        all.push(("RandomSubset", what, Box::new(move || notices(|all| all.sampler(Draw(draw))))));
    }
    let distances: Vec<(&'static str, Metres)> = vec![
        ("is 0", Metres(|_, _, _, _| 0.0)),
        ("has another sign", Metres(|metres, _, _, _| -metres)),
        ("is one too much", Metres(|metres, _, _, _| metres + 1.0)),
        ("is at most one", Metres(|metres, _, _, _| metres.min(1.0))),
        ("is the rest", Metres(|metres, _, _, _| 1.0 / metres)),
        (
            "forgets the objects",
            Metres(|_, m, from, to| m.robot().distance(&from.robot, &to.robot_overlay(m, &from.robot))),
        ),
        ("forgets the robot", Metres(|metres, m, from, to| if to.are_objects_met(m, from) { 0.0 } else { metres })),
        ("counts everything", Metres(|metres, _, from, _| metres + from.objects[1][0])),
        ("is rounded", Metres(|metres, _, _, _| (metres * 2.0).floor() / 2.0)),
    ];
    for (what, Metres(metres)) in distances {
        all.push(("GreedyVisit", what, Box::new(move || notices(|all| all.distance(Metres(metres))))));
    }
    let verdicts: Vec<(&'static str, Verdict)> = vec![
        ("accepts everything", |_, _, _, _, _| true),
        ("refuses everything", |_, _, _, _, _| false),
        ("forgets the goal", |judge, m, start, _, plan| {
            let any = darrt_core::goal::Region::<PuckWorld>::new(Box::new(|_, _| true), Box::new(|_, _| None));
            judge.verify(m, start, &any, plan).is_ok()
        }),
        ("forgets the start", |judge, m, _, goal, plan| judge.verify(m, plan.start(), goal, plan).is_ok()),
        ("forgets the first step", |judge, m, start, goal, plan| {
            let rest: Vec<_> = plan.steps().iter().skip(1).cloned().collect();
            let start = if plan.steps().is_empty() { start.clone() } else { plan.at(m, 0, 1.0).unwrap() };
            judge.verify(m, &start, goal, &Plan::new(start.clone(), rest)).is_ok()
        }),
        ("looks at the end alone", |_, m, _, goal, plan| goal.is_satisfied(m, &plan.end(m))),
    ];
    for (what, verdict) in verdicts {
        all.push(("Judge", what, Box::new(move || notices(|all| all.verifier(Court(verdict))))));
    }
    all
}
