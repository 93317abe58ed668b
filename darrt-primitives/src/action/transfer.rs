//! Carrying the held object to a pose in the air.

use darrt_core::domain::Domain;
use darrt_core::primitive::{Infeasible, Instances};
use darrt_core::space::ComponentSpace;
use darrt_core::space::so2::wrap;
use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use rand::{Rng, RngExt};

use super::Chain;
use super::stance::{Probe, Wanted, stance};
use super::travel::{base_to, travel};
use super::turned::turned;
use crate::manipulator::Manipulator;
use crate::mode::Contacts;
use crate::object_space::OBJECT_TOLERANCE_M;
use crate::tabletop::{Tabletop, TabletopState};

/// Moves base and arm so that the held object comes to `target` (its yaw about its own axis free if it is round), with the base
/// at `base` in the end if that is given.
///
/// # Errors
/// [`Infeasible::NoGrasp`] if nothing is held, [`Infeasible::Blocked`], [`Infeasible::Unreachable`].
pub fn transfer<M: Manipulator>(
    m: &Tabletop<M>,
    from: &TabletopState<M>,
    target: &Isometry3<f64>,
    base: Option<[f64; 3]>,
    rng: &mut dyn Rng,
) -> Result<Instances<Tabletop<M>>, Infeasible> {
    let held = *from.mode.held().ok_or(Infeasible::NoGrasp)?;
    let target = freely_turned(m, held.object.index(), target, rng);
    let object_from_tool = held.tool_from_object.inverse();
    let target =
        turned(m, (held.object, from.mode.hand()), &base.unwrap_or(from.robot.base), &target, &object_from_tool, rng);
    let at_target = target * object_from_tool;
    let wanted = Wanted { world_from_tool: &at_target, tries: m.settings().base_tries, base };
    let mut probe = Probe::new(m, from, from.mode.clone());
    let robot = stance(m, from, &wanted, rng, |q, care| probe.check(q, &Contacts::default(), care).map(|()| *q))?;
    let mut chain = Chain::at(from);
    travel(m, &mut chain, &robot, from.mode.gap_m(), rng);
    chain.finish()
}

/// Moves only the base so that the held object comes to `target`: possible when only x, y and yaw differ.
///
/// # Errors
/// [`Infeasible::NoGrasp`] if nothing is held, [`Infeasible::Unreachable`] if the base alone cannot do it,
/// [`Infeasible::Limits`] if it would have to leave its bounds.
pub fn transfer_by_base<M: Manipulator>(
    m: &Tabletop<M>,
    from: &TabletopState<M>,
    target: &Isometry3<f64>,
    rng: &mut dyn Rng,
) -> Result<Instances<Tabletop<M>>, Infeasible> {
    let held = *from.mode.held().ok_or(Infeasible::NoGrasp)?;
    let here = from.object(held.object).ok_or(Infeasible::NoGrasp)?;
    let target = freely_turned(m, held.object.index(), target, rng);
    let turn = target.rotation * here.rotation.inverse();
    let tilt = (turn * Vector3::z()).angle(&Vector3::z());
    let reach = m.movable(held.object).map_or(0.0, |o| o.reach_m);
    if (target.translation.z - here.translation.z).abs() + tilt * reach > OBJECT_TOLERANCE_M {
        return Err(Infeasible::Unreachable);
    }
    let yaw = turn.euler_angles().2;
    let [x, y, heading] = from.robot.base;
    let flat_turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw);
    let offset = flat_turn * (Vector3::new(x, y, 0.0) - here.translation.vector);
    let base = [target.translation.x + offset.x, target.translation.y + offset.y, wrap(heading + yaw)];
    if !m.robot().base().contains(&base) {
        return Err(Infeasible::Limits);
    }
    let mut chain = Chain::at(from);
    base_to(m, &mut chain, &base, from.mode.gap_m());
    chain.finish()
}

/// `target`, turned about its own z axis by a random angle if the object is round.
fn freely_turned<M: Manipulator>(
    m: &Tabletop<M>,
    object: usize,
    target: &Isometry3<f64>,
    rng: &mut dyn Rng,
) -> Isometry3<f64> {
    if m.objects().get(object).is_some_and(crate::object_space::ObjectSpace::is_round) {
        let angle = rng.random_range(-std::f64::consts::PI..std::f64::consts::PI);
        target * UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle)
    } else {
        *target
    }
}
