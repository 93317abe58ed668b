//! The beginning of an instance, run backwards.

use std::fmt;
use std::sync::Arc;

use super::{Instance, Motion};
use crate::domain::Domain;
use crate::state::State;

/// From the state at `until` on an instance back to its beginning. Only for instances that are reversible: a push is not.
pub struct Reversed<D: Domain> {
    forward: Arc<Instance<D>>,
    until: f64,
    knots: Vec<f64>,
}

impl<D: Domain> Reversed<D> {
    /// The way back from `until` in `(0, 1]`; `None` if the instance may not be run backwards.
    pub fn new(forward: Arc<Instance<D>>, until: f64) -> Option<Self> {
        if !forward.reversible || until.is_nan() || until <= 0.0 || until > 1.0 {
            return None;
        }
        let knots = forward.motion.knots().iter().rev().filter(|k| **k <= until);
        let knots = knots.map(|k| (1.0 - k / until).clamp(0.0, 1.0)).collect();
        Some(Self { forward, until, knots })
    }

    /// The same as an instance: it moves and touches what the forward one does.
    pub fn instance(forward: &Arc<Instance<D>>, until: f64) -> Option<Instance<D>> {
        let motion = Self::new(Arc::clone(forward), until)?;
        let Instance { primitive, moves, object, reversible, .. } = **forward;
        Some(Instance {
            primitive,
            motion: Box::new(motion),
            contacts: forward.contacts.clone(),
            moves,
            object,
            reversible,
        })
    }
}

impl<D: Domain> Motion<D> for Reversed<D> {
    fn length(&self) -> f64 {
        self.forward.motion.length() * self.until
    }

    fn knots(&self) -> &[f64] {
        &self.knots
    }

    fn at_into(&self, m: &D, t: f64, out: &mut State<D>) {
        self.forward.motion.at_into(m, (1.0 - t.clamp(0.0, 1.0)) * self.until, out);
    }
}

impl<D: Domain> fmt::Debug for Reversed<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Reversed").field("forward", &self.forward).field("until", &self.until).finish_non_exhaustive()
    }
}
