//! The beginning of a plan that was not found, as a plan file that says what is left to do.

use darrt_core::plan::Plan;
use darrt_primitives::tabletop::Tabletop;

use super::Prepared;
use crate::plan_file::{Partial, PlanFile, PlannerFacts};
use crate::robot::TaskRobot;
use crate::verify::{Proof, VerifyOptions, verify_with};

/// How often a beginning that the verifier refuses is cut before the step at fault.
const CUTS: usize = 8;

/// As much of `plan` as the verifier accepts, with what remains of the goal behind it.
pub(super) fn verified<M: TaskRobot>(
    prepared: &Prepared<M>,
    plan: &Plan<Tabletop<M>>,
    (seed, facts): (u64, PlannerFacts),
) -> Option<(PlanFile, Proof)> {
    let m = prepared.problem.domain();
    let mut plan = plan.clone();
    for _ in 0..CUTS {
        if plan.steps().is_empty() {
            return None;
        }
        let mut file = prepared.exporter.export(m, &plan, seed, facts.clone()).ok()?;
        let end = plan.end(m);
        let (mut met, mut remains) = (Vec::new(), Vec::new());
        for group in prepared.goal.groups() {
            let object = group.first().and_then(|goal| m.movable(goal.object))?;
            let list = if group.iter().any(|goal| goal.is_met(&end)) { &mut met } else { &mut remains };
            list.push(object.body.name.to_string());
        }
        let robot_remains = !prepared.goal.is_robot_met(m, &end);
        file.partial = Some(Partial { met, remains, robot_remains });
        match verify_with(&file, &prepared.facts, &VerifyOptions::default()) {
            Ok(proof) => return Some((file, proof)),
            Err(refusal) => {
                // Steps of the file are those of the plan, some of them joined, and those between them in which a hand leaves.
                let good = refusal.step.map_or(0, |step| step.saturating_sub(1) as usize);
                let kept = kept(prepared, &plan, good);
                plan = Plan::new(plan.start().clone(), plan.steps().iter().take(kept).cloned().collect());
            }
        }
    }
    None
}

/// How many steps of the plan make at most `good` steps of its file; fewer than all.
fn kept<M: TaskRobot>(prepared: &Prepared<M>, plan: &Plan<Tabletop<M>>, good: usize) -> usize {
    let m = prepared.problem.domain();
    let fits = |count: &usize| {
        let part = Plan::new(plan.start().clone(), plan.steps().iter().take(*count).cloned().collect());
        let file = prepared.exporter.export(m, &part, 0, PlannerFacts::default());
        file.is_ok_and(|file| file.steps.len() <= good)
    };
    (0..plan.steps().len()).rev().find(fits).unwrap_or(0)
}
