//! Steps keep to the rules by which a person steers a plan.

use std::collections::BTreeSet;

use nalgebra::{Point2, Point3, Vector2};

use super::hands::Hands;
use super::motion::State;
use super::refusal::{Refusal, RefusalKind, Site};
use super::robot::{Robot, world_from_robot};
use super::world::World;
use crate::plan_file::{PlanFile, Step, Waypoint};
use crate::problem_file::{Region, Steer};
use crate::robot::RobotFacts;
use darrt_primitives::contract::{Contract, HandUse};

/// A hand that is no farther beside the centre of an object is above it, metres,
const ABOVE_M: f64 = 0.01;
/// and so much more or less of it is forgiven, because the same place has other digits here.
const ABOVE_SLACK_M: f64 = 0.001;
/// An object stands on a surface if its bottom is no farther above or below it, metres.
const ON_TOP_M: f64 = 2e-3;
/// The hand is where a point is that lies so far behind its tool frame, metres.
const WRIST_M: f64 = 0.1;
/// What rounding may do to an angle, degrees, and to a place, metres.
const ROUNDING: f64 = 1e-6;

/// Checks one step, from where everything stands before it to where it stands behind it; notes in `met` which of the rules with
/// `require` it fulfils.
pub(super) fn check(
    rules: &[Steer],
    site: Site<'_>,
    step: &Step,
    (world, robot): (&World<'_>, &Robot),
    (before, after): (&State, &State),
    met: &mut BTreeSet<usize>,
) -> Result<(), Refusal> {
    let Some((name, at)) = subject(site.contract, step, (before, after)) else { return Ok(()) };
    for (index, rule) in rules.iter().enumerate().filter(|(_, rule)| is_about(rule, name, step)) {
        let refuse = |what: String| Err(site.refusal(0.0, RefusalKind::Steer, format!("`steer[{index}]`: {what}")));
        let fault = fault(rule, name, at, (world, robot));
        match fault {
            None if rule.require => drop(met.insert(index)),
            None if rule.forbid => return refuse(format!("{} of `{name}` is forbidden{}", step.primitive, like(rule))),
            Some(fault) if !rule.require && !rule.forbid => return refuse(fault),
            _ => {}
        }
    }
    Ok(())
}

/// The object that a step does something with, and where everything stands when that is judged.
fn subject<'a>(
    contract: Contract,
    step: &'a Step,
    (before, after): (&'a State, &'a State),
) -> Option<(&'a str, &'a State)> {
    let name = step.object.as_deref().filter(|_| contract.manipulates())?;
    Some((name, if contract.hand == HandUse::LetsGo { after } else { before }))
}

fn is_about(rule: &Steer, name: &str, step: &Step) -> bool {
    rule.object.as_deref().is_none_or(|object| object == name)
        && rule.primitive.as_ref().is_none_or(|primitive| *primitive == step.primitive)
}

/// By step of the plan: which of the rules with `require` it fulfils, whether the plan is right or not.
pub(super) fn met_by_step(plan: &PlanFile, facts: &RobotFacts) -> Result<Vec<BTreeSet<usize>>, Refusal> {
    let (hands, world) = (Hands::new(facts)?, World::new(&plan.problem)?);
    let read = |waypoint: &Waypoint| State::read(waypoint, &hands.first, &world).ok();
    let mut before = read(&plan.start);
    let mut all = Vec::new();
    for step in &plan.steps {
        let after = step.waypoints.last().and_then(read);
        let robot = hands.get(step.hand(facts).unwrap_or(0));
        let contract = plan.contracts.get(&step.primitive).copied();
        let judged = contract.zip(before.as_ref().zip(after.as_ref()));
        let subject = judged.and_then(|(contract, states)| subject(contract, step, states));
        let is_met = |rule: &Steer, (name, at): (&str, &State)| {
            rule.require && is_about(rule, name, step) && fault(rule, name, at, (&world, robot)).is_none()
        };
        let rules = plan.problem.steers.iter().enumerate();
        let met = rules.filter(|(_, rule)| subject.is_some_and(|subject| is_met(rule, subject)));
        all.push(met.map(|(index, _)| index).collect());
        before = after;
    }
    Ok(all)
}

/// Checks that every rule with `require` has been fulfilled.
pub(super) fn check_whole(rules: &[Steer], met: &BTreeSet<usize>) -> Result<(), Refusal> {
    let missing = rules.iter().enumerate().find(|(index, rule)| rule.require && !met.contains(index));
    let Some((index, rule)) = missing else { return Ok(()) };
    let primitive =
        rule.primitive.as_ref().map_or_else(|| "that takes, sets down or pushes".to_owned(), |p| format!("{p} of"));
    let object = rule.object.as_ref().map_or_else(|| "an object".to_owned(), |object| format!("`{object}`"));
    let text = format!("`steer[{index}]` requires a step {primitive} {object}{}, and there is none", like(rule));
    Err(Refusal::whole(RefusalKind::Steer, text))
}

/// What more a rule says, in words.
fn like(rule: &Steer) -> String {
    let region = |region: &Region| format!("{:?} to {:?}", region.min, region.max);
    let parts = [
        rule.surface.as_ref().map(|name| format!("on `{name}`")),
        rule.from_deg.map(|[from, to]| format!("from {from} to {to} degrees")),
        rule.base.as_ref().map(|base| format!("with the base in {}", region(base))),
        rule.not_base.as_ref().map(|base| format!("with the base not in {}", region(base))),
    ];
    let mut words = String::new();
    for part in parts.into_iter().flatten() {
        words.push(' ');
        words.push_str(&part);
    }
    words
}

/// What of a rule's keys does not hold. What rounding may do counts for the plan: towards what is wanted, and away from what is
/// forbidden.
fn fault(rule: &Steer, name: &str, at: &State, (world, robot): (&World<'_>, &Robot)) -> Option<String> {
    let slack = if rule.forbid { -1.0 } else { 1.0 };
    let (rounding, above_m) = (slack * ROUNDING, ABOVE_M + slack * ABOVE_SLACK_M);
    let [x, y, _] = at.base;
    let beyond = |low: f64, high: f64, value: f64| (low - value).max(value - high);
    let outside =
        |region: &Region| beyond(region.min[0], region.max[0], x).max(beyond(region.min[1], region.max[1], y));
    if let Some(region) = rule.base.as_ref().filter(|region| outside(region) > rounding) {
        return Some(format!("the base is at ({x:.3}, {y:.3}), it must be in {:?} to {:?}", region.min, region.max));
    }
    if let Some(region) = rule.not_base.as_ref().filter(|region| outside(region) < -rounding) {
        return Some(format!(
            "the base is at ({x:.3}, {y:.3}), it must not be in {:?} to {:?}",
            region.min, region.max
        ));
    }
    if let Some(wanted) = &rule.surface {
        let found = world.object(name).and_then(|index| Some((at.objects.get(index)?, world.movables.get(index)?)));
        let Some(((pose, movable), top)) = found.zip(world.surface_called(wanted)) else {
            return Some(format!("`{name}` or `{wanted}` is not there"));
        };
        let bottom = pose.translation.z - movable.depth_below_origin;
        let centre = Point2::from(pose.translation.vector.xy());
        let (above, inside) = (bottom - top.height(), top.depth(&centre));
        if above.abs() > ON_TOP_M + rounding || inside < -rounding {
            return Some(format!(
                "`{name}` is not on `{wanted}`: {above:.4} m above it, {inside:.4} m inside its edge"
            ));
        }
    }
    let [from, to] = rule.from_deg?;
    let hand = beside(robot, world, at, name).filter(|hand| hand.norm() > above_m)?;
    let degrees = hand.y.atan2(hand.x).to_degrees();
    let past = (degrees - from + rounding).rem_euclid(360.0);
    (past > to - from + 2.0 * rounding)
        .then(|| format!("the hand is at `{name}` from {degrees:.1} degrees, it must be from {from} to {to}"))
}

/// From the centre of the object to the wrist, seen from above.
fn beside(robot: &Robot, world: &World<'_>, at: &State, name: &str) -> Option<Vector2<f64>> {
    let pose = at.objects.get(world.object(name)?)?;
    let mut links = Vec::new();
    robot.link_poses(&at.joints, &mut links);
    let tool = world_from_robot(&at.base) * links.get(robot.tool)?;
    let wrist = tool * Point3::new(-WRIST_M, 0.0, 0.0);
    Some((wrist.coords - pose.translation.vector).xy())
}
