//! What an instance says about itself.

use darrt_core::laws::{Broken, ensure};
use darrt_core::state::{ComponentId, ObjectId};

use super::{DECLARED, GAP, ONE_WAY, Trial};
use crate::manipulator::Manipulator;

impl<M: Manipulator> Trial<'_, M> {
    pub(super) fn claims(&self) -> Result<(), Broken> {
        let widest = self.m.manipulator().hand_of(self.during.mode.hand()).max_gap_m();
        for mode in [&self.during.mode, &self.end.mode] {
            let gap_m = mode.gap_m();
            // What is held may be a little wider than the fingers open, by its own rounding.
            let fits = (0.0..=widest + 1e-9).contains(&gap_m);
            ensure(GAP, fits, || format!("{gap_m:?} m"), "between 0 and the widest gap")?;
        }
        let held = self.during.mode.held().map(|held| held.object);
        for id in (0..self.m.movables().len()).map(ObjectId::new) {
            let is_declared = self.instance.moves.contains(ComponentId::Object(id));
            let is_named = self.instance.object == Some(id) || held == Some(id);
            let of = |broken: Broken| broken.of(self.name(id));
            ensure(DECLARED, !is_declared || is_named, || "declared".to_owned(), "only what is named or held")
                .map_err(of)?;
            let moves = self.from.object(id) != self.end.object(id);
            ensure(DECLARED, is_declared || !moves, || "moves undeclared".to_owned(), "declared").map_err(of)?;
            let is_pushed = moves && self.during.mode.support_of(id).is_some();
            ensure(ONE_WAY, !is_pushed || !self.instance.reversible, || "reversible".to_owned(), "not reversible")
                .map_err(of)?;
        }
        Ok(())
    }
}
