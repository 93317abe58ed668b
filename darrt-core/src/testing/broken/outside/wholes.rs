//! Broken parts that show when everything is checked together.

use super::super::bench::{Act, Bench, Config, Propagate, Rule, cart, robot_at, state};
use super::super::motions::{go, instance};
use super::super::{Case, seed};
use crate::goal::{Goal, Region};
use crate::laws::everything::Effort;
use crate::laws::planner::PROBLEM;
use crate::laws::primitive::{FEASIBLE, FREE};
use crate::laws::validity::HELD;
use crate::laws::verifier::ACCEPTS;
use crate::laws::{Broken, Subjects, ValidityClaims, check_everything};
use crate::motion::{Instance, Waypoints};
use crate::plan::Plan;
use crate::primitive::{Infeasible, Primitive};
use crate::state::{ComponentSet, State};
use crate::testing::puck::{Clearance, Obstacle, Outline, PuckWorld, Setup};
use crate::validity::{Blame, BlockKind, FreePrefix, Validity};
use crate::verify::{Refusal, Replay, Verified, Verifier};

/// Refuses whatever ends in its goal.
struct Contrary;

impl Verifier<Bench> for Contrary {
    fn verify(
        &self,
        m: &Bench,
        start: &State<Bench>,
        goal: &dyn Goal<Bench>,
        plan: &Plan<Bench>,
    ) -> Result<Verified, Refusal> {
        if plan.end(m).robot[0] < 0.1 {
            return Err(Refusal { step: None, at: 0.0, reason: "it ends in the goal".to_owned() });
        }
        Replay::new(Rule::default(), 1e-2).verify(m, start, goal, plan)
    }
}

const GO: Act = Act {
    useful: |m, from, to| to.are_objects_met(m, from) && !to.is_robot_met(m, from),
    approach: |_, _, _| None,
    propagate: |m, from, to, _| Ok(vec![go(m, from, to.robot_overlay(m, &from.robot))]),
};

/// To the wall, and from there to the target.
fn through(m: &Bench, from: &State<Bench>, target: Config) -> Option<Instance<Bench>> {
    let [middle, end] = [[1.2, 0.0], target].map(|robot| State { robot, ..from.clone() });
    let segments = [(from, &middle), (&middle, &end)].map(|(a, b)| (m.robot.distance)(&a.robot, &b.robot));
    Some(instance(Waypoints::new(vec![from.clone(), middle, end], &segments, from.mode.clone())?, ComponentSet::ROBOT))
}

fn check(start: State<Bench>, act: Act) -> Result<(), Broken> {
    check_with(4, start, act)
}

fn check_with(cases: u64, start: State<Bench>, act: Act) -> Result<(), Broken> {
    check_by(Replay::new(Rule::default(), 1e-2), cases, start, act)
}

fn check_by(verifier: impl Verifier<Bench> + 'static, cases: u64, start: State<Bench>, act: Act) -> Result<(), Broken> {
    let rule = Rule::default();
    let primitives: Vec<Box<dyn Primitive<Bench>>> = vec![Box::new(act)];
    let goal = Region::<Bench>::new(
        Box::new(|_, s: &State<Bench>| s.robot[0] < 0.1),
        Box::new(|_, _| Some(robot_at([0.05, 0.0]))),
    );
    let subjects =
        Subjects::new(start).goal(goal).primitives(primitives).validity(rule).verifier(verifier).effort(Effort {
            cases,
            calls: 8192,
            iterations: if cases > 4 { 0 } else { 20 },
            apart_ms: 0,
            seed: seed(),
            ..Effort::default()
        });
    match check_everything(Bench::default(), subjects) {
        Ok(_) => Ok(()),
        Err(report) => report.broken().next().map_or(Ok(()), |broken| Err(broken.clone())),
    }
}

type Check = fn(&Clearance, &PuckWorld, &State<PuckWorld>, &ComponentSet) -> Result<(), Blame>;

/// A clearance that checks states in its own way.
struct Hands(Check, Clearance);

impl Validity<PuckWorld> for Hands {
    fn check(&self, m: &PuckWorld, state: &State<PuckWorld>, contacts: &ComponentSet) -> Result<(), Blame> {
        (self.0)(&self.1, m, state, contacts)
    }

    fn free_prefix(&self, m: &PuckWorld, instance: &Instance<PuckWorld>, from: &State<PuckWorld>) -> FreePrefix {
        let steps = (instance.motion.length() / 2e-3).ceil().clamp(1.0, 1e5);
        let (mut free, mut i) = (0.0, 0.0);
        while i <= steps {
            let t = i / steps;
            if let Err(blame) = self.check(m, &instance.at(m, t, from), &instance.contacts) {
                return FreePrefix::blocked(free, blame);
            }
            free = t;
            i += 1.0;
        }
        FreePrefix::FREE
    }
}

/// Everything of a room with a large pillar, and a puck that is picked and carried.
fn puck(rule: Check) -> Result<(), Broken> {
    let problem = Setup::new([4.0, 3.0], 0.15)
        .robot_at([0.6, 0.6])
        .graspable_puck("red", 0.12, [1.0, 1.0])
        .pillar("pillar", [2.0, 1.5], 0.4)
        .puck_goal(0, [3.5, 2.5])
        .problem()
        .map_err(|error| Broken::new("testing.bench: the honest twin can be built", error.to_string(), "a problem"))?;
    let pillar = Outline::Disc { centre: [2.0, 1.5], radius_m: 0.4 };
    let clearance = Clearance::new(vec![Obstacle { name: "pillar".into(), outline: pillar }]);
    let effort = Effort { cases: 2, calls: 16, iterations: 0, apart_ms: 0, seed: seed(), ..Effort::default() };
    let claims = ValidityClaims { same_names: false, ..ValidityClaims::default() };
    let subjects = Subjects::of(&problem).validity(Hands(rule, clearance)).validity_claims(claims);
    match check_everything(problem.shared_domain(), subjects.effort(effort)) {
        Ok(_) => Ok(()),
        Err(report) => report.broken().next().map_or(Ok(()), |broken| Err(broken.clone())),
    }
}

pub(super) fn cases() -> Vec<Case> {
    let case = |name, wrong, law, broken| Case { name, wrong, law, broken, honest: || check(state([0.5, 0.1]), GO) };
    vec![
        case("finds nothing, ever", "looks useful, and every way is infeasible", FEASIBLE, || {
            check(state([0.5, 0.1]), Act { propagate: |_, _, _, _| Err(Infeasible::Unreachable), ..GO })
        }),
        case("never free", "proposes ways that end in the wall, whatever the target", FREE, || {
            let propagate: Propagate = |m, from, to, _| {
                let way = through(m, from, to.robot_overlay(m, &from.robot));
                way.map(|way| vec![way]).ok_or(Infeasible::Unreachable)
            };
            check_with(512, state([0.5, 0.1]), Act { propagate, ..GO })
        }),
        case("refuses what ends well", "the sign of how the goal is met", ACCEPTS, || {
            check_by(Contrary, 4, state([0.5, 0.1]), GO)
        }),
        Case {
            name: "held is fine",
            wrong: "what is in the hand is not looked at any more",
            law: HELD,
            broken: || {
                // Only the robot is looked at, and whether there is anything in its hand.
                puck(|inner, m, state, contacts| match inner.check(m, state, contacts) {
                    Err(blame) if blame.kind == BlockKind::ObjectFixed && state.mode.held().is_some() => Ok(()),
                    found => found,
                })
            },
            honest: || puck(Clearance::check),
        },
        case("starts in the wall", "a start that no rule of its own accepts", PROBLEM, || {
            let mut start = state([1.2, 0.1]);
            start.objects[cart().index()] = [3.0, 0.0];
            check(start, GO)
        }),
    ]
}
