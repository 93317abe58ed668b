//! A chain of steps, cut where what the robot cannot change by moving freely changes.
//!
//! Between two manipulations the robot may go any way: alone (a transit), or with what it holds (a transfer). What such ways
//! leave as it is, the places of all objects that are not held and the grasp of the one that is, is called a leaf.
//!
//! # Source
//! Hauser and Latombe, Multi-modal motion planning in non-expansive spaces, 2010: modes, and transitions between them.

use crate::domain::Domain;
use crate::plan::Step;
use crate::state::{ComponentId, ComponentSet, ObjectId, State};

/// What a step is, as far as other ways to the same end are concerned.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// The robot goes somewhere, alone or with what it holds, and may go any other way.
    Free,
    /// The robot moves, but must move as it does: it approaches an object, or retreats from one.
    Bound,
    /// It leads to another leaf: an object is moved, grasped or let go.
    Change,
}

impl Kind {
    pub(super) fn of<D: Domain>(m: &D, step: &Step<D>, before: &State<D>, after: &State<D>) -> Self {
        let carried = m.carried(&before.mode);
        let moves_others = !step.instance.moves.is_subset_of(carried.union(ComponentSet::ROBOT));
        if moves_others || m.carried(&after.mode) != carried {
            return Self::Change;
        }
        let is_alone = step.instance.object.is_none_or(|object| carried.contains(ComponentId::Object(object)));
        if step.instance.reversible && is_alone { Self::Free } else { Self::Bound }
    }
}

/// The states of a chain that begins at `here`: the one before every step, and the end.
pub(crate) fn states<D: Domain>(m: &D, here: &State<D>, steps: &[Step<D>]) -> Vec<State<D>> {
    let mut states = Vec::with_capacity(steps.len() + 1);
    states.push(here.clone());
    for step in steps {
        let mut end = here.clone();
        step.instance.motion.at_into(m, step.until, &mut end);
        states.push(end);
    }
    states
}

/// One part of a chain, by the indices of its steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Piece {
    /// The way to where the manipulation begins: `from .. entry`.
    pub(crate) from: usize,
    /// Approach and change: `entry .. until`.
    pub(crate) entry: usize,
    /// One past the change.
    pub(crate) until: usize,
}

/// The manipulations of a chain with the ways to them; what follows on the last one is in no piece.
pub(crate) fn pieces<D: Domain>(m: &D, steps: &[Step<D>], states: &[State<D>]) -> Vec<Piece> {
    let kinds: Vec<Kind> =
        steps.iter().zip(states.iter().zip(states.iter().skip(1))).map(|(s, (a, b))| Kind::of(m, s, a, b)).collect();
    let mut pieces = Vec::new();
    let mut from = 0;
    for (at, _) in kinds.iter().enumerate().filter(|(_, kind)| **kind == Kind::Change) {
        let bound = kinds.iter().take(at).skip(from).rev().take_while(|kind| **kind == Kind::Bound).count();
        pieces.push(Piece { from, entry: at - bound, until: at + 1 });
        from = at + 1;
    }
    pieces
}

/// Do two states lie on one leaf?
pub(super) fn is_one_leaf<D: Domain>(m: &D, a: &State<D>, b: &State<D>) -> bool {
    let carried = m.carried(&a.mode);
    carried == m.carried(&b.mode)
        && (carried.is_empty() || a.mode == b.mode)
        && a.objects.len() == b.objects.len()
        && a.objects
            .iter()
            .zip(&b.objects)
            .enumerate()
            .all(|(i, (p, q))| p == q || carried.contains(ComponentId::Object(ObjectId::new(i))))
}
