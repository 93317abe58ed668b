//! Going to a configuration of base and arm, alone or with an object in the hand.

use darrt_core::motion::Instance;
use darrt_core::primitive::PrimitiveId;
use darrt_core::state::{ComponentId, ComponentSet};
use rand::Rng;

use super::Chain;
use super::fold::{Order, order};
use crate::arm_motion::{ArmMotion, Carried, Waypoint};
use crate::manipulator::{Configuration, JointVector as _, Manipulator};
use crate::mode::{Contacts, Mode};
use crate::primitive;
use crate::tabletop::Tabletop;

/// Moves base and arm to `target`, never both at once. The arm drives along folded, or what it holds near the robot and
/// upright, where that is worth the way; the module `fold` says when. The empty hand opens to `gap_m`.
///
/// Base and arm are separate because their precision differs (paper section 5.1).
pub fn travel<M: Manipulator>(
    m: &Tabletop<M>,
    chain: &mut Chain<M>,
    target: &Configuration<M::Joints>,
    gap_m: f64,
    rng: &mut dyn Rng,
) {
    if chain.end.robot.base == target.base {
        arm_to(m, chain, &target.arm, gap_m);
        return;
    }
    match order(m, chain, target, rng) {
        Order::BaseFirst => {}
        Order::ArmFirst => arm_to(m, chain, &target.arm, gap_m),
        Order::Through(arm) => arm_to(m, chain, &arm.with_hand_at_work(target.arm.hand_at_work()), gap_m),
    }
    // The hand that goes to work is the one that is opened, before the drive.
    drive_to(m, chain, &target.base, target.arm.hand_at_work(), gap_m);
    arm_to(m, chain, &target.arm, gap_m);
}

/// Moves the arm in a straight line in joint space; nothing if it is already there.
pub fn arm_to<M: Manipulator>(m: &Tabletop<M>, chain: &mut Chain<M>, arm: &M::Joints, gap_m: f64) {
    // Which hand is at work is no way to go.
    if chain.end.robot.arm.as_ref() != arm.as_ref() {
        let robot = Configuration { base: chain.end.robot.base, arm: *arm };
        let primitive =
            if chain.end.mode.held().is_some() { primitive::ARM_RIGID_TRANSFER } else { primitive::ARM_TRANSIT };
        go(m, chain, robot, gap_m, primitive);
    }
}

/// Moves the base in a straight line; nothing if it is already there.
pub fn base_to<M: Manipulator>(m: &Tabletop<M>, chain: &mut Chain<M>, base: &[f64; 3], gap_m: f64) {
    let hand = chain.end.robot.arm.hand_at_work();
    drive_to(m, chain, base, hand, gap_m);
}

fn drive_to<M: Manipulator>(m: &Tabletop<M>, chain: &mut Chain<M>, base: &[f64; 3], hand: usize, gap_m: f64) {
    if chain.end.robot.base != *base {
        let robot = Configuration { base: *base, arm: chain.end.robot.arm.with_hand_at_work(hand) };
        let primitive =
            if chain.end.mode.held().is_some() { primitive::BASE_RIGID_TRANSFER } else { primitive::BASE_TRANSIT };
        go(m, chain, robot, gap_m, primitive);
    }
}

fn go<M: Manipulator>(
    m: &Tabletop<M>,
    chain: &mut Chain<M>,
    robot: Configuration<M::Joints>,
    gap_m: f64,
    primitive: PrimitiveId,
) {
    let here = &chain.end;
    let mode = here.mode.opened_to(gap_m).unwrap_or_else(|| here.mode.clone());
    // A hand that is not free stays at work.
    let mode = mode.with_hand(robot.arm.hand_at_work());
    let robot = Configuration { arm: robot.arm.with_hand_at_work(mode.hand()), ..robot };
    let instance = carry(m, chain, &[Waypoint { robot, pushed: 0.0 }], &mode, primitive, Contacts::default());
    chain.push(m, instance);
}

/// An instance that begins where `chain` ends and in which the robot passes through `waypoints` in constant `mode`, with what
/// that holds; straight in base and joints between them. It may be run backwards, and nothing but `contacts` may touch.
pub fn carry<M: Manipulator>(
    m: &Tabletop<M>,
    chain: &Chain<M>,
    waypoints: &[Waypoint<M::Joints>],
    mode: &Mode,
    primitive: PrimitiveId,
    contacts: Contacts,
) -> Instance<Tabletop<M>> {
    let held = mode.held().copied();
    let moves = held.map_or(ComponentSet::ROBOT, |h| ComponentSet::ROBOT.with(ComponentId::Object(h.object)));
    let carried = held.map_or(Carried::Nothing, Carried::Held);
    let motion = ArmMotion::new(m, &chain.end, waypoints, carried, mode.clone(), mode.clone());
    Instance { primitive, motion: Box::new(motion), contacts, moves, object: held.map(|h| h.object), reversible: true }
}
