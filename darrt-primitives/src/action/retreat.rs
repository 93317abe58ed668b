//! Backing the hand straight out of where it stands.

use darrt_core::motion::Instance;
use darrt_core::primitive::Infeasible;
use darrt_core::state::ComponentSet;
use nalgebra::Vector3;

use super::{Chain, label, line};
use crate::arm_motion::{ArmMotion, Carried, Waypoint};
use crate::manipulator::{Configuration, Manipulator};
use crate::mode::{Contacts, TouchReason};
use crate::tabletop::Tabletop;

/// If the hand stands at an object, backs it out along its own axis by `by_m` metres; else does nothing.
///
/// # Errors
/// [`Infeasible::Unreachable`] if the arm cannot follow far enough.
pub fn retreat<M: Manipulator>(m: &Tabletop<M>, chain: &mut Chain<M>, by_m: f64) -> Result<(), Infeasible> {
    let here = &chain.end;
    let Some(object) = here.mode.engaged() else { return Ok(()) };
    let after = here.mode.disengaged().ok_or(Infeasible::Unreachable)?;
    let tool = m.manipulator().world_from_tool(&here.robot);
    let back = tool.rotation * Vector3::new(-by_m, 0.0, 0.0);
    let line = line::follow(m, &here.robot.base, &here.robot.arm, &tool, &back);
    if line.share() < m.settings().least_line_share {
        return Err(Infeasible::Unreachable);
    }
    let base = here.robot.base;
    let waypoints: Vec<_> =
        line.arms.iter().map(|arm| Waypoint { robot: Configuration { base, arm: *arm }, pushed: 0.0 }).collect();
    let motion = ArmMotion::new(m, here, &waypoints, Carried::Nothing, here.mode.clone(), after);
    let instance = Instance {
        label: label::STRAIGHT_LINE_ARM_TRANSIT,
        motion: Box::new(motion),
        contacts: Contacts { fingers: Some((object, TouchReason::Retreat)), support: None },
        moves: ComponentSet::ROBOT,
        object: Some(object),
        reversible: false,
    };
    chain.push(m, instance);
    Ok(())
}
