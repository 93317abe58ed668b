//! Steps keep to the rules by which a person steers a plan.

use nalgebra::{Point3, Vector2};

use super::motion::State;
use super::refusal::{Refusal, RefusalKind, Site};
use super::robot::{Robot, world_from_robot};
use super::world::World;
use crate::plan_file::Step;
use crate::problem_file::Steer;
use darrt_primitives::contract::HandUse;

/// A hand that is no farther beside the centre of an object is above it, metres. More than the planner allows, because the same
/// place has other digits here.
const ABOVE_M: f64 = 0.011;
/// The hand is where a point is that lies so far behind its tool frame, metres.
const WRIST_M: f64 = 0.1;
/// What rounding may do to an angle, degrees, and to a place, metres.
const ROUNDING: f64 = 1e-6;

/// Checks one step, from where everything stands before it to where it stands behind it.
pub(super) fn check(
    rules: &[Steer],
    site: Site<'_>,
    step: &Step,
    (world, robot): (&World<'_>, &Robot),
    (before, after): (&State, &State),
) -> Result<(), Refusal> {
    let Some(name) = step.object.as_deref().filter(|_| site.contract.manipulates()) else { return Ok(()) };
    let at = if site.contract.hand == HandUse::LetsGo { after } else { before };
    let about = |rule: &&Steer| {
        rule.object.as_deref().is_none_or(|object| object == name)
            && rule.primitive.as_ref().is_none_or(|primitive| *primitive == step.primitive)
    };
    let [x, y, _] = at.base;
    for rule in rules.iter().filter(about) {
        let refuse = |what: String| Err(site.refusal(0.0, RefusalKind::Steer, format!("`steer`: {what}")));
        if rule.forbid {
            return refuse(format!("{} of `{name}` is forbidden", step.primitive));
        }
        let beyond = |low: f64, high: f64, value: f64| (low - value).max(value - high);
        let outside = |region: &crate::problem_file::Region| {
            beyond(region.min[0], region.max[0], x).max(beyond(region.min[1], region.max[1], y))
        };
        if let Some(region) = rule.base.as_ref().filter(|region| outside(region) > ROUNDING) {
            return refuse(format!(
                "the base is at ({x:.3}, {y:.3}), it must be in {:?} to {:?}",
                region.min, region.max
            ));
        }
        if let Some(region) = rule.not_base.as_ref().filter(|region| outside(region) < -ROUNDING) {
            return refuse(format!(
                "the base is at ({x:.3}, {y:.3}), it must not be in {:?} to {:?}",
                region.min, region.max
            ));
        }
        let Some([from, to]) = rule.from_deg else { continue };
        let hand = beside(robot, world, at, name);
        let Some(hand) = hand.filter(|hand| hand.norm() > ABOVE_M) else { continue };
        let degrees = hand.y.atan2(hand.x).to_degrees();
        let past = (degrees - from + ROUNDING).rem_euclid(360.0);
        if past > to - from + 2.0 * ROUNDING {
            return refuse(format!(
                "the hand is at `{name}` from {degrees:.1} degrees, it must be from {from} to {to}"
            ));
        }
    }
    Ok(())
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
