//! Backing the hand straight out of where it stands.

use darrt_core::motion::Instance;
use darrt_core::primitive::Infeasible;
use darrt_core::state::ComponentSet;
use nalgebra::Vector3;

use super::Chain;
use super::line::{cares, follow_in_room};
use super::stance::{Probe, Refused};
use crate::arm_motion::{ArmMotion, Carried, Waypoint};
use crate::length_range::LengthRange;
use crate::manipulator::{Configuration, Manipulator};
use crate::mode::{Contacts, TouchReason};
use crate::primitive;
use crate::tabletop::Tabletop;

/// If the hand stands at an object, backs it out along its own axis, as far as the range wants and there is room; else does
/// nothing.
///
/// # Errors
/// [`Infeasible::Unreachable`] if the arm cannot follow far enough, [`Infeasible::Blocked`] if it finds no room.
pub fn retreat<M: Manipulator>(m: &Tabletop<M>, chain: &mut Chain<M>, by_m: LengthRange) -> Result<(), Infeasible> {
    let here = &chain.end;
    let Some(object) = here.mode.engaged() else { return Ok(()) };
    let after = here.mode.disengaged().ok_or(Infeasible::Unreachable)?;
    let tool = m.manipulator().world_from_tool(&here.robot);
    let back = tool.rotation * -Vector3::x();
    let mut probe = Probe::new(m, here, after.clone());
    let mut line = Err(Refused::Unreachable);
    for care in cares(m) {
        let none = Contacts::default();
        line = follow_in_room(m, &here.robot, &tool, &back, by_m, |q| probe.check_all(q, &none, care));
        if !matches!(line, Err(Refused::Blocked(_))) {
            break;
        }
    }
    let line = line.map_err(|refused| refused.why(m))?;
    let base = here.robot.base;
    let waypoints: Vec<_> =
        line.arms.iter().map(|arm| Waypoint { robot: Configuration { base, arm: *arm }, pushed: 0.0 }).collect();
    let motion = ArmMotion::new(m, here, &waypoints, Carried::Nothing, here.mode.clone(), after);
    let instance = Instance {
        primitive: primitive::STRAIGHT_LINE_ARM_TRANSIT,
        motion: Box::new(motion),
        contacts: Contacts { fingers: Some((object, TouchReason::Retreat)), support: None },
        moves: ComponentSet::ROBOT,
        object: Some(object),
        reversible: false,
    };
    chain.push(m, instance);
    Ok(())
}
