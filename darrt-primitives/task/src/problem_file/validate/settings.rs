//! Rules of the primitives' and the planner's settings.

use darrt_primitives::contact::MAX_LEAN;

use super::names::surface;
use super::numbers::{LONGEST_MOTION, length, motion, ordered, positive, within};
use super::objects::WIDEST_GAP;
use crate::problem_file::error::{Flaw, Located};
use crate::problem_file::{Place, PrimitiveName, ProblemFile, Push, Safety, Sampling};

/// Most directions from which Place may approach, most postures, and most primitives.
const MOST_ENTRIES: usize = 64;

/// Farthest turn of an object in one push, degrees.
const MOST_TURN_DEG: f64 = 120.0;

/// Most rules that steer a plan.
const MOST_RULES: usize = 64;

/// Most leans of a pushing hand.
const MOST_LEANS: usize = 16;

/// Largest distance of `[safety]` (m).
const LARGEST_MARGIN: f64 = 0.5;

/// Checks primitives, steer, safety, push, place, sampling, transit and budget.
pub(super) fn check(problem: &ProblemFile) -> Result<(), Located> {
    check_primitives(&problem.primitives)?;
    check_steers(problem)?;
    check_safety(&problem.safety)?;
    check_push(&problem.push)?;
    check_place(&problem.place)?;
    check_sampling(&problem.sampling)?;
    length("transit.postures", problem.transit.postures.len(), 0, MOST_ENTRIES)?;
    let budget = &problem.budget;
    positive("budget.time_limit_s", budget.time_limit_s)?;
    let counts =
        [("iterations", budget.iterations), ("nodes", budget.nodes), ("restart_iterations", budget.restart_iterations)];
    for (name, count) in counts {
        if count == Some(0) {
            positive(&format!("budget.{name}"), 0.0)?;
        }
    }
    Ok(())
}

fn check_steers(problem: &ProblemFile) -> Result<(), Located> {
    length("steer", problem.steers.len(), 0, MOST_RULES)?;
    for (index, rule) in problem.steers.iter().enumerate() {
        let key = |name: &str| format!("steer[{index}]{name}");
        if let Some(name) = rule.object.as_deref().filter(|name| problem.object(name).is_none()) {
            return Err(Flaw::Inconsistent(format!("is `{name}`, and there is no such object")).at(key(".object")));
        }
        if let Some(name) = rule.primitive.as_ref().filter(|name| !problem.allows(name)) {
            let text = format!("is `{name}`, which is not among the `primitives`");
            return Err(Flaw::Inconsistent(text).at(key(".primitive")));
        }
        if let Some([from, to]) = rule.from_deg {
            within(&key(".from_deg[0]"), from, -360.0, 360.0)?;
            within(&key(".from_deg[1]"), to, -360.0, 360.0)?;
            ordered(&key(".from_deg"), [from, to])?;
        }
        for (name, region) in [(".base", &rule.base), (".not_base", &rule.not_base)] {
            let Some(region) = region else { continue };
            for (axis, letter) in ["x", "y"].into_iter().enumerate() {
                let range = [region.min, region.max].map(|corner| corner.get(axis).copied().unwrap_or(0.0));
                ordered(&format!("{}: {letter} of min and max", key(name)), range)?;
            }
        }
        if let Some(name) = &rule.surface {
            surface(problem, &key(".surface"), name)?;
        }
        if rule.forbid && rule.require {
            let text = "has `forbid` and `require`; there is no step that both allow".to_owned();
            return Err(Flaw::Inconsistent(text).at(key("")));
        }
        let has_where = rule.base.is_some() || rule.not_base.is_some() || rule.surface.is_some();
        if !(rule.forbid || rule.require || rule.from_deg.is_some() || has_where) {
            let text = "says nothing: give `forbid`, `require`, `from_deg`, `surface`, `base` or `not_base`".to_owned();
            return Err(Flaw::Inconsistent(text).at(key("")));
        }
    }
    Ok(())
}

fn check_primitives(names: &[PrimitiveName]) -> Result<(), Located> {
    length("primitives", names.len(), 1, MOST_ENTRIES)?;
    for (index, name) in names.iter().enumerate() {
        if let Some(first) = names.iter().take(index).position(|earlier| earlier == name) {
            let (name, taken_by) = (name.to_string(), format!("primitives[{first}]"));
            return Err(Flaw::Duplicate { name, taken_by }.at(format!("primitives[{index}]")));
        }
    }
    Ok(())
}

/// The least margins are no larger than the wanted ones.
fn check_safety(safety: &Safety) -> Result<(), Located> {
    for (name, value) in safety.lengths() {
        within(&format!("safety.{name}"), value, 0.0, LARGEST_MARGIN)?;
    }
    within("safety.contact_margin_m", safety.contact_margin_m, 1e-4, safety.least_margin_m)?;
    for (name, value) in safety.lengths().into_iter().take(3) {
        within(&format!("safety.{name}"), value, safety.least_margin_m, LARGEST_MARGIN)?;
    }
    Ok(())
}

fn check_push(push: &Push) -> Result<(), Located> {
    positive("push.gap_m", push.gap_m)?;
    length("push.leans_deg", push.leans_deg.len(), 1, MOST_LEANS)?;
    for (index, &lean) in push.leans_deg.iter().enumerate() {
        within(&format!("push.leans_deg[{index}]"), lean, 0.0, MAX_LEAN.to_degrees().round())?;
    }
    within("push.max_turn_deg", push.max_turn_deg, 0.0, MOST_TURN_DEG)?;
    for (name, range) in
        [("standoff_m", push.standoff_m), ("approach_m", push.approach_m), ("retreat_m", push.retreat_m)]
    {
        motion(&format!("push.{name}"), range)?;
    }
    within("push.gap_m", push.gap_m, 0.0, WIDEST_GAP)?;
    let lengths = [
        ("fingertip_clearance_m", push.fingertip_clearance_m),
        ("position_error_m", push.position_error_m),
        ("edge_distance_m[0]", push.edge_distance_m[0]),
        ("edge_distance_m[1]", push.edge_distance_m[1]),
    ];
    for (name, value) in lengths {
        within(&format!("push.{name}"), value, 0.0, LONGEST_MOTION)?;
    }
    ordered("push.edge_distance_m", push.edge_distance_m)
}

fn check_place(place: &Place) -> Result<(), Located> {
    let directions = &place.approach_directions;
    length("place.approach_directions", directions.len(), 1, MOST_ENTRIES)?;
    for (index, direction) in directions.iter().enumerate() {
        let key = format!("place.approach_directions[{index}][2]");
        if direction[2] > -1e-6 {
            let bound = "negative, the hand comes from above".to_owned();
            return Err(Flaw::OutOfRange { value: direction[2], bound }.at(key));
        }
    }
    motion("place.approach_m", place.approach_m)?;
    motion("place.retreat_m", place.retreat_m)
}

/// Samples of the goal are moved to edges as well; this many may be.
const MOST_AT_EDGES: f64 = 0.9;

fn check_sampling(sampling: &Sampling) -> Result<(), Located> {
    let shares = [
        ("object_share", sampling.object_share),
        ("goal_bias", sampling.goal_bias),
        ("base_only_share", sampling.base_only_share),
    ];
    shares.into_iter().try_for_each(|(name, share)| within(&format!("sampling.{name}"), share, 0.0, 1.0))?;
    within("sampling.edge_share", sampling.edge_share, 0.0, MOST_AT_EDGES)
}
