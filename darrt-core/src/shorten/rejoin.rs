//! Back to an old plan: from a placement of its objects to one of its states in which they stand alike.

use rand::Rng;

use super::leap::{Old, joined};
use crate::domain::Domain;
use crate::extend::Extender;
use crate::partial::PartialState;
use crate::plan::Step;
use crate::state::State;

/// How many states of the old plan are tried.
const TRIES: usize = 3;

/// A way back to an old plan.
pub(super) struct Joint<D: Domain> {
    pub(super) steps: Vec<Step<D>>,
    /// The step of the old plan that goes on from its end.
    pub(super) step: usize,
}

/// From `here`, with `done` placements behind, to a state of the old plan before the next one: the last that an extension
/// reaches, because the robot needs no more steps to a later one.
pub(super) fn rejoin<D: Domain>(
    extender: &Extender<'_, D>,
    old: &Old<'_, D>,
    done: usize,
    here: &State<D>,
    left: &mut usize,
    rng: &mut dyn Rng,
) -> Option<Joint<D>> {
    let m = extender.problem.domain();
    // Behind the last placement only the goal counts, to which a leap leads.
    old.placements.get(done)?;
    let between = old.begin(done) + 1..old.end(done);
    for step in between.rev().take(TRIES) {
        let Some(state) = old.plan.at(m, step - 1, 1.0).filter(|state| state.objects == here.objects) else { continue };
        *left = left.checked_sub(1)?;
        let extension = extender.extend(here, &PartialState::of_state(m, &state), rng);
        let Some(end) = extension.reached.last().filter(|_| extension.is_met).map(|last| &last.state) else { continue };
        // The steps that follow were made for exactly this state.
        if end.robot == state.robot && end.objects == state.objects && m.may_go_on(&end.mode, &state.mode) {
            return Some(Joint { steps: joined(extension.reached), step });
        }
    }
    None
}
