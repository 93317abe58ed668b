//! Broken parts that show when everything is checked together.

use super::super::bench::{Act, Bench, Rule, cart, robot_at, state};
use super::super::motions::go;
use super::super::{Case, seed};
use crate::goal::Region;
use crate::laws::everything::Effort;
use crate::laws::planner::PROBLEM;
use crate::laws::primitive::FEASIBLE;
use crate::laws::{Broken, Subjects, check_everything};
use crate::primitive::{Infeasible, Primitive};
use crate::state::State;
use crate::verify::Replay;

const GO: Act = Act {
    useful: |m, from, to| to.are_objects_met(m, from) && !to.is_robot_met(m, from),
    approach: |_, _, _| None,
    propagate: |m, from, to, _| Ok(vec![go(m, from, to.robot_overlay(m, &from.robot))]),
};

fn check(start: State<Bench>, act: Act) -> Result<(), Broken> {
    let rule = Rule::default();
    let primitives: Vec<Box<dyn Primitive<Bench>>> = vec![Box::new(act)];
    let goal = Region::<Bench>::new(
        Box::new(|_, s: &State<Bench>| s.robot[0] < 0.1),
        Box::new(|_, _| Some(robot_at([0.05, 0.0]))),
    );
    let subjects = Subjects::new(start)
        .goal(goal)
        .primitives(primitives)
        .validity(rule)
        .verifier(Replay::new(rule, 1e-2))
        .effort(Effort { cases: 4, calls: 2048, iterations: 20, apart_ms: 0, seed: seed(), ..Effort::default() });
    match check_everything(Bench::default(), subjects) {
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
        case("starts in the wall", "a start that no rule of its own accepts", PROBLEM, || {
            let mut start = state([1.2, 0.1]);
            start.objects[cart().index()] = [3.0, 0.0];
            check(start, GO)
        }),
    ]
}
