//! A sequence of primitive instances, and its replay at any parameter.

use std::fmt;
use std::sync::Arc;

use crate::domain::Domain;
use crate::motion::Instance;
use crate::state::State;
use crate::tree::{NodeId, Tree};

/// One instance, possibly cut short.
pub struct Step<D: Domain> {
    /// The instance.
    pub instance: Arc<Instance<D>>,
    /// It is run on `[0, until]`, `until` in `(0, 1]`.
    pub until: f64,
    /// Index of the primitive that propagated it.
    pub primitive: u16,
}

impl<D: Domain> Clone for Step<D> {
    fn clone(&self) -> Self {
        Self { instance: Arc::clone(&self.instance), until: self.until, primitive: self.primitive }
    }
}

// Not derived, here and below: that would ask the domain to be printable.
impl<D: Domain> fmt::Debug for Step<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Step")
            .field("instance", &self.instance)
            .field("until", &self.until)
            .field("primitive", &self.primitive)
            .finish()
    }
}

/// What the planner proposes. It is not a solution before the verifier has agreed.
pub struct Plan<D: Domain> {
    start: State<D>,
    steps: Vec<Step<D>>,
}

impl<D: Domain> Clone for Plan<D> {
    fn clone(&self) -> Self {
        Self { start: self.start.clone(), steps: self.steps.clone() }
    }
}

impl<D: Domain> fmt::Debug for Plan<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Plan").field("start", &self.start).field("steps", &self.steps).finish()
    }
}

impl<D: Domain> Plan<D> {
    /// A plan from its parts.
    pub fn new(start: State<D>, steps: Vec<Step<D>>) -> Self {
        Self { start, steps }
    }

    /// The way from the root of `tree` to `node`; nodes along one instance become one step.
    pub fn to_node(tree: &Tree<D>, node: NodeId) -> Option<Self> {
        let mut steps: Vec<Step<D>> = Vec::new();
        let mut at = tree.node(node)?;
        while let Some(edge) = &at.edge {
            let continues = steps.last().is_some_and(|next| Arc::ptr_eq(&next.instance, &edge.instance));
            if !continues {
                steps.push(Step { instance: Arc::clone(&edge.instance), until: edge.t, primitive: edge.primitive });
            }
            at = tree.node(edge.parent)?;
        }
        steps.reverse();
        Some(Self { start: at.state.clone(), steps })
    }

    /// The state it starts from.
    pub fn start(&self) -> &State<D> {
        &self.start
    }

    /// Its steps in order.
    pub fn steps(&self) -> &[Step<D>] {
        &self.steps
    }

    /// The state at fraction `s` in `[0, 1]` of step `index`; `None` past the last step.
    pub fn at(&self, m: &D, index: usize, s: f64) -> Option<State<D>> {
        let step = self.steps.get(index)?;
        Some(step.instance.at(m, s.clamp(0.0, 1.0) * step.until, &self.start))
    }

    /// The state it ends in.
    pub fn end(&self, m: &D) -> State<D> {
        match self.steps.len().checked_sub(1).and_then(|last| self.at(m, last, 1.0)) {
            Some(state) => state,
            None => self.start.clone(),
        }
    }

    /// Metres of travel over all steps.
    pub fn length(&self) -> f64 {
        self.steps.iter().map(|step| step.instance.motion.length() * step.until).sum()
    }
}
