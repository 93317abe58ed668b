//! Where the robot stands to bring its hand to a pose: base and arm.

use nalgebra::Isometry3;
use rand::{Rng, RngExt};

use crate::manipulator::{Configuration, Manipulator};
use crate::tabletop::{Tabletop, TabletopState};

/// Tries bases for the hand pose `world_from_tool`: sometimes the present one first, then random ones, `base_tries` in
/// all. `accept` gets every configuration that reaches and either makes something of it or lets the next be tried.
pub fn stance<M: Manipulator, T>(
    m: &Tabletop<M>,
    from: &TabletopState<M>,
    world_from_tool: &Isometry3<f64>,
    rng: &mut dyn Rng,
    mut accept: impl FnMut(&Configuration<M::Joints>) -> Option<T>,
) -> Option<T> {
    use darrt_core::domain::Domain;
    use darrt_core::space::ComponentSpace;
    let robot = m.manipulator();
    let [empty, loaded] = m.settings().drives;
    let drives = if from.mode.held().is_some() { loaded } else { empty };
    let stays = !drives || rng.random_bool(0.5);
    for attempt in 0..m.settings().base_tries {
        let base = if !drives || (stays && attempt == 0) { from.robot.base } else { robot.base_for(world_from_tool, rng) };
        if !m.robot().base().contains(&base) || !robot.may_reach(&base, world_from_tool) {
            continue;
        }
        if let Some(arm) = robot.inverse(&base, world_from_tool, rng)
            && let Some(found) = accept(&Configuration { base, arm })
        {
            return Some(found);
        }
    }
    None
}
