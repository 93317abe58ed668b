//! What the primitives share that move one group of joints and nothing else: the arm, or the base.
//!
//! Base and arm never move together because their precision differs (paper section 5.1), so each kind of motion exists
//! twice. Here is what is the same; each primitive's file says which group it moves and what is its own.

use darrt_core::partial::PartialState;
use darrt_core::primitive::{Infeasible, Instances};
use darrt_core::space::GroupSet;

use crate::action::Chain;
use crate::action::travel::{arm_to, base_to};
use crate::manipulator::Manipulator;
use crate::mobile_arm_space::{ARM, BASE};
use crate::tabletop::{Tabletop, TabletopState};
use crate::target_query::{asks_for_group, held_target_in_air, may_carry_along};

/// Does the target ask the robot with its empty hand to move `group`, and no object to be elsewhere?
pub(super) fn asks_for_transit<M: Manipulator>(
    m: &Tabletop<M>,
    from: &TabletopState<M>,
    to: &PartialState<Tabletop<M>>,
    group: GroupSet,
) -> bool {
    from.mode.is_hand_free() && to.are_objects_met(m, from) && asks_for_group(from, to, group)
}

/// Does the target ask the held object to be somewhere in the air, or the robot to move `group` with an object in its
/// hand that may go anywhere?
pub(super) fn asks_for_transfer<M: Manipulator>(
    m: &Tabletop<M>,
    from: &TabletopState<M>,
    to: &PartialState<Tabletop<M>>,
    group: GroupSet,
) -> bool {
    held_target_in_air(m, from, to).is_some() || (may_carry_along(m, from, to) && asks_for_group(from, to, group))
}

/// Moves `group` in a straight line to where the target names it; the empty hand opens to `gap_m`, a closed one stays.
///
/// # Errors
/// [`Infeasible::NoProgress`] when it is there already.
pub(super) fn move_group<M: Manipulator>(
    m: &Tabletop<M>,
    from: &TabletopState<M>,
    to: &PartialState<Tabletop<M>>,
    group: GroupSet,
    gap_m: f64,
) -> Result<Instances<Tabletop<M>>, Infeasible> {
    let target = to.robot_overlay(m, &from.robot);
    let mut chain = Chain::at(from);
    if group.covers(BASE) {
        base_to(m, &mut chain, &target.base, gap_m);
    }
    if group.covers(ARM) {
        arm_to(m, &mut chain, &target.arm, gap_m);
    }
    chain.finish()
}
