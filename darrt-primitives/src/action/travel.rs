//! Going to a configuration of base and arm, alone or with an object in the hand.

use darrt_core::motion::Instance;
use darrt_core::state::{ComponentId, ComponentSet};
use rand::{Rng, RngExt};

use super::stance::Probe;
use super::{Chain, label};
use crate::arm_motion::{ArmMotion, Carried, Waypoint};
use crate::manipulator::{Configuration, Manipulator};
use crate::mode::{Contacts, Mode};
use crate::tabletop::Tabletop;

/// How often the arm folds to a posture while the base drives.
const SHARE_VIA_POSTURE: f64 = 0.8;

/// Moves base and arm to `target`, never both at once, in a random order and often through one of the settings'
/// postures: the arm folds, the base drives, the arm unfolds. The empty hand opens to `gap_m`.
///
/// Base and arm are separate because their precision differs (paper section 5.1).
pub fn travel<M: Manipulator>(
    m: &Tabletop<M>,
    chain: &mut Chain<M>,
    target: &Configuration<M::Joints>,
    gap_m: f64,
    rng: &mut dyn Rng,
) {
    let drives = chain.end.robot.base != target.base;
    let arm_first = drives && rng.random_bool(0.5);
    let posture =
        if drives && rng.random_bool(SHARE_VIA_POSTURE) { clear_posture(m, chain, target, rng) } else { None };
    if let Some(posture) = posture {
        arm_to(m, chain, &posture, gap_m);
        base_to(m, chain, &target.base, gap_m);
        arm_to(m, chain, &target.arm, gap_m);
    } else if arm_first {
        arm_to(m, chain, &target.arm, gap_m);
        base_to(m, chain, &target.base, gap_m);
    } else {
        base_to(m, chain, &target.base, gap_m);
        arm_to(m, chain, &target.arm, gap_m);
    }
}

/// One of the postures, at random, in which nothing is in the way of the robot and of what it holds, neither where it
/// stands nor where it goes.
fn clear_posture<M: Manipulator>(
    m: &Tabletop<M>,
    chain: &Chain<M>,
    target: &Configuration<M::Joints>,
    rng: &mut dyn Rng,
) -> Option<M::Joints> {
    let mut probe = Probe::new(m, &chain.end, chain.end.mode.clone());
    let mut is_clear =
        |base: [f64; 3], arm: M::Joints| probe.is_clear(&Configuration { base, arm }, &Contacts::default());
    let postures = &m.settings().postures;
    let first = if postures.is_empty() { 0 } else { rng.random_range(0..postures.len()) };
    let turned = postures.iter().cycle().skip(first).take(postures.len());
    turned.copied().find(|arm| is_clear(chain.end.robot.base, *arm) && is_clear(target.base, *arm))
}

/// Moves the arm in a straight line in joint space; nothing if it is already there.
pub fn arm_to<M: Manipulator>(m: &Tabletop<M>, chain: &mut Chain<M>, arm: &M::Joints, gap_m: f64) {
    if chain.end.robot.arm != *arm {
        let robot = Configuration { base: chain.end.robot.base, arm: *arm };
        let name = if chain.end.mode.held().is_some() { label::ARM_RIGID_TRANSFER } else { label::ARM_TRANSIT };
        go(m, chain, robot, gap_m, name);
    }
}

/// Moves the base in a straight line; nothing if it is already there.
pub fn base_to<M: Manipulator>(m: &Tabletop<M>, chain: &mut Chain<M>, base: &[f64; 3], gap_m: f64) {
    if chain.end.robot.base != *base {
        let robot = Configuration { base: *base, arm: chain.end.robot.arm };
        let name = if chain.end.mode.held().is_some() { label::BASE_RIGID_TRANSFER } else { label::BASE_TRANSIT };
        go(m, chain, robot, gap_m, name);
    }
}

fn go<M: Manipulator>(
    m: &Tabletop<M>,
    chain: &mut Chain<M>,
    robot: Configuration<M::Joints>,
    gap_m: f64,
    label: &'static str,
) {
    let here = &chain.end;
    let mode = here.mode.opened_to(gap_m).unwrap_or_else(|| here.mode.clone());
    let instance = carry(m, chain, &[Waypoint { robot, pushed: 0.0 }], &mode, label, Contacts::default());
    chain.push(m, instance);
}

/// An instance in which the robot passes through `waypoints` in constant `mode`, with what it holds.
pub(super) fn carry<M: Manipulator>(
    m: &Tabletop<M>,
    chain: &Chain<M>,
    waypoints: &[Waypoint<M::Joints>],
    mode: &Mode,
    label: &'static str,
    contacts: Contacts,
) -> Instance<Tabletop<M>> {
    let held = mode.held().copied();
    let moves = held.map_or(ComponentSet::ROBOT, |h| ComponentSet::ROBOT.with(ComponentId::Object(h.object)));
    let carried = held.map_or(Carried::Nothing, Carried::Held);
    let motion = ArmMotion::new(m, &chain.end, waypoints, carried, mode.clone(), mode.clone());
    Instance { label, motion: Box::new(motion), contacts, moves, object: held.map(|h| h.object), reversible: true }
}
