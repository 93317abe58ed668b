//! Where the robot stands to bring its hand to a pose: base and arm.

use darrt_core::domain::Domain;
use darrt_core::space::ComponentSpace;
use nalgebra::Isometry3;
use rand::{Rng, RngExt};

use crate::manipulator::{Configuration, Manipulator};
use crate::tabletop::{Tabletop, TabletopState};

/// How many arm configurations are drawn for one base.
const ARM_TRIES: usize = 4;

/// What is asked of a stance.
#[derive(Debug, Clone, Copy)]
pub struct Wanted<'a> {
    /// Where the hand shall be.
    pub world_from_tool: &'a Isometry3<f64>,
    /// How far it shall be open, metres.
    pub gap_m: f64,
    /// How many bases are tried.
    pub tries: usize,
}

/// Tries bases for the wanted hand pose: sometimes the present one first, then random ones, each with a few arm
/// configurations. Stances in which the robot passes through itself or a support surface are
/// passed over. `accept` gets every other one and either makes something of it or lets the next be tried.
pub fn stance<M: Manipulator, T>(
    m: &Tabletop<M>,
    from: &TabletopState<M>,
    wanted: &Wanted<'_>,
    rng: &mut dyn Rng,
    mut accept: impl FnMut(&Configuration<M::Joints>) -> Option<T>,
) -> Option<T> {
    let robot = m.manipulator();
    let Wanted { world_from_tool, gap_m, tries } = *wanted;
    let [empty, loaded] = m.settings().drives;
    let drives = if from.mode.held().is_some() { loaded } else { empty };
    let stays = !drives || rng.random_bool(0.5);
    for attempt in 0..tries {
        let base =
            if !drives || (stays && attempt == 0) { from.robot.base } else { robot.base_for(world_from_tool, rng) };
        let parked = Configuration { base, arm: from.robot.arm };
        if !m.robot().base().contains(&base)
            || !robot.may_reach(&base, world_from_tool)
            || !m.stances().is_base_clear(robot, &parked)
        {
            continue;
        }
        for _ in 0..ARM_TRIES {
            let Some(arm) = robot.inverse(&base, world_from_tool, rng) else { break };
            let q = Configuration { base, arm };
            if m.stances().is_clear(robot, &q, gap_m)
                && let Some(found) = accept(&q)
            {
                return Some(found);
            }
        }
    }
    None
}
