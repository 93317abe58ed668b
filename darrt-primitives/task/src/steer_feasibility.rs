//! Can what the rules of a problem require be done at all? Asked before the search, like the means of its goals.

use darrt_core::primitive::PrimitiveId;
use darrt_primitives::contract::{Contract, HandUse};
use darrt_primitives::manipulator::Manipulator;

use crate::goal_feasibility::Feasibility;
use crate::planning_error::PlanningError;
use crate::problem_file::error::{Flaw, Located};
use crate::problem_file::{ProblemFile, Steer};

/// A rule about a primitive with whose steps it has nothing to do.
pub(crate) fn idle_rule(
    problem: &ProblemFile,
    allowed: impl IntoIterator<Item = (PrimitiveId, Contract)>,
) -> Option<Located> {
    let idle: Vec<_> = allowed.into_iter().filter(|(_, contract)| !contract.manipulates()).collect();
    problem.steers.iter().enumerate().find_map(|(index, rule)| {
        let name = rule.primitive.as_ref()?;
        idle.iter().find(|(id, _)| id.name() == name.as_str())?;
        let text =
            format!("is `{name}`, which neither takes, sets down nor pushes an object; rules are about steps that do");
        Some(Flaw::Inconsistent(text).at(format!("steer[{index}].primitive")))
    })
}

/// Checks that for every rule with `require` there is a primitive that can do it with some object.
///
/// # Errors
/// [`PlanningError::InfeasibleRule`] with the rule and what is missing.
pub(crate) fn check_rules(
    problem: &ProblemFile,
    allowed: &[(PrimitiveId, Contract)],
    robot: &impl Manipulator,
) -> Result<(), PlanningError> {
    for (index, rule) in problem.steers.iter().enumerate().filter(|(_, rule)| rule.require) {
        let objects =
            problem.objects.iter().filter(|object| rule.object.as_ref().is_none_or(|name| *name == object.name));
        let mut lacks = Vec::new();
        for object in objects {
            let means = Feasibility::new(problem, object, allowed, robot);
            let Some(lack) = lack(rule, &means, allowed, problem) else {
                lacks.clear();
                break;
            };
            lacks.push(format!("`{}`: {lack}", object.name));
        }
        if !lacks.is_empty() {
            return Err(PlanningError::InfeasibleRule { index, why: lacks.join("; ") });
        }
    }
    Ok(())
}

/// Why no step with this object fulfils the rule; `None` if one may.
fn lack(
    rule: &Steer,
    means: &Feasibility<'_>,
    allowed: &[(PrimitiveId, Contract)],
    problem: &ProblemFile,
) -> Option<String> {
    if let Some(surface) = rule.surface.as_deref().filter(|name| !problem.allowed_surfaces(means.object).contains(name))
    {
        return Some(format!("it may not stand on `{surface}`"));
    }
    let about = |(id, contract): &&(PrimitiveId, Contract)| {
        contract.manipulates() && rule.primitive.as_ref().is_none_or(|name| name.as_str() == id.name())
    };
    let mut lacks = Vec::new();
    for (_, contract) in allowed.iter().filter(about) {
        let means = match contract.hand {
            HandUse::Takes => &means.pick,
            HandUse::LetsGo => &means.place,
            _ => &means.push,
        };
        match means {
            Ok(()) => return None,
            Err(lack) if !lacks.contains(lack) => lacks.push(lack.clone()),
            Err(_) => {}
        }
    }
    Some(if lacks.is_empty() { "no primitive does it".to_owned() } else { lacks.join(", ") })
}
