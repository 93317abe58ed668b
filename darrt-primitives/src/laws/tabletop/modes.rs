//! Changes of mode and exemptions.

use darrt_core::laws::{Broken, ensure};
use darrt_core::state::ObjectId;

use super::{EXEMPT, MODES, Trial};
use crate::manipulator::{JointVector as _, Manipulator};
use crate::mode::{Mode, TouchReason};

impl<M: Manipulator> Trial<'_, M> {
    pub(super) fn modes(&self) -> Result<(), Broken> {
        let text = |from: &Mode, to: &Mode| format!("from {from:?} to {to:?}");
        let (before, during, after) = (&self.from.mode, &self.during.mode, &self.end.mode);
        ensure(MODES, self.may_begin(before, during), || text(before, during), "a legal transition at the start")
            .map_err(|broken| broken.at(0.0))?;
        ensure(MODES, may_end(during, after), || text(during, after), "a legal transition at the end")
            .map_err(|broken| broken.at(1.0))?;
        for (state, t) in [(&self.during, 0.5), (&self.end, 1.0)] {
            let (of_mode, of_joints) = (state.mode.hand(), state.robot.arm.hand_at_work());
            let text = || format!("hand {of_mode} by the mode, hand {of_joints} by the joints");
            ensure(MODES, of_mode == of_joints, text, "one hand at work").map_err(|broken| broken.at(t))?;
        }
        Ok(())
    }

    /// At the start the empty hand opens or closes, comes to stand at an object, or attaches the one it stands at; one that is free
    /// may be another hand than before.
    fn may_begin(&self, before: &Mode, during: &Mode) -> bool {
        let opened = [Some(before.clone()), before.opened_to(during.gap_m())];
        let opened = opened.map(|mode| mode.map(|mode| mode.with_hand(during.hand())));
        let objects = (0..self.m.movables().len()).map(ObjectId::new);
        let engaged = objects.flat_map(|id| opened.iter().flatten().map(move |mode| mode.engaged_with(id)));
        let attached = during
            .held()
            .filter(|held| before.engaged() == Some(held.object))
            .and_then(|held| before.attached(*held, during.gap_m()));
        opened.iter().cloned().chain(engaged).chain([attached]).flatten().any(|mode| mode == *during)
    }

    pub(super) fn exemptions(&self) -> Result<(), Broken> {
        let contacts = &self.instance.contacts;
        let mode = &self.during.mode;
        let is_held = |id| mode.held().is_some_and(|held| held.object == id);
        let text = || format!("{contacts:?} in {mode:?}");
        if let Some((id, reason)) = contacts.fingers {
            let is_at = self.instance.object == Some(id) && (is_held(id) || mode.engaged() == Some(id));
            ensure(EXEMPT, is_at, text, "fingers touch only what they stand at or hold")?;
            let leaves = mode.engaged() == Some(id) && self.end.mode.engaged().is_none();
            let fits = match reason {
                TouchReason::Push => !is_held(id) && self.from.object(id) != self.end.object(id),
                TouchReason::Retreat => leaves,
                TouchReason::Grasp => !leaves,
            };
            ensure(EXEMPT, fits, text, "a reason that fits what happens")?;
        }
        if let Some((id, surface)) = contacts.support {
            let is_handed_over =
                self.from.mode.support_of(id) == Some(surface) || self.end.mode.support_of(id) == Some(surface);
            let fits = self.instance.object == Some(id) && is_held(id) && is_handed_over;
            ensure(EXEMPT, fits, text, "an object touches only the surface it is lifted from or set down on")?;
        }
        Ok(())
    }
}

/// At the end the hand has retreated, or lets go.
fn may_end(during: &Mode, after: &Mode) -> bool {
    let released = during.held().and_then(|held| during.released_on(after.support_of(held.object)?, after.gap_m()));
    [Some(during.clone()), during.disengaged(), released].into_iter().flatten().any(|mode| mode == *after)
}
