//! Extensions from one placement of the objects of a plan to a later one.

use std::ops::Range;
use std::sync::Arc;

use rand::Rng;

use crate::domain::Domain;
use crate::extend::{Extender, Reached};
use crate::partial::PartialState;
use crate::plan::{Plan, Step};
use crate::state::{ObjectId, State};

/// How often one extension is drawn before the next nearer target is tried.
const DRAWS: usize = 2;

/// Where the objects stand after a step that moves one.
pub(super) struct Placement<D: Domain> {
    /// Index of the step.
    step: usize,
    /// The objects that the plan has moved so far, where they are.
    target: PartialState<D>,
}

/// A plan that is to become shorter, with the placements on its way.
pub(super) struct Old<'a, D: Domain> {
    pub(super) plan: &'a Plan<D>,
    pub(super) placements: Vec<Placement<D>>,
}

impl<'a, D: Domain> Old<'a, D> {
    pub(super) fn new(m: &D, plan: &'a Plan<D>) -> Self {
        Self { plan, placements: placements(m, plan) }
    }

    /// How many steps it has.
    pub(super) fn len(&self) -> usize {
        self.plan.steps().len()
    }

    /// The step that begins where `done` placements lie behind.
    pub(super) fn begin(&self, done: usize) -> usize {
        let last = done.checked_sub(1).and_then(|last| self.placements.get(last));
        last.map_or(0, |last| last.step + 1)
    }

    /// One past the step that leads to the next placement, or to the end behind the last one.
    pub(super) fn end(&self, done: usize) -> usize {
        self.placements.get(done).map_or(self.len(), |next| next.step + 1)
    }

    /// The placements that do not lie behind.
    pub(super) fn ahead(&self, done: usize) -> &[Placement<D>] {
        self.placements.get(done..).unwrap_or_default()
    }

    /// Some of its steps.
    pub(super) fn steps(&self, range: Range<usize>) -> impl Iterator<Item = Step<D>> + '_ {
        self.plan.steps().get(range).unwrap_or_default().iter().cloned()
    }
}

fn placements<D: Domain>(m: &D, plan: &Plan<D>) -> Vec<Placement<D>> {
    let start = plan.start();
    let mut before = start.clone();
    let mut placements = Vec::new();
    for step in 0..plan.steps().len() {
        let Some(after) = plan.at(m, step, 1.0) else { break };
        if after.objects != before.objects {
            let ids = (0..after.objects.len()).map(ObjectId::new);
            let moved = ids.filter(|id| after.object(*id) != start.object(*id));
            let named = moved.filter_map(|id| Some((id, after.object(id)?.clone())));
            let target = named.fold(PartialState::anywhere(m), |target, (id, at)| target.with_object(id, at));
            placements.push(Placement { step, target });
        }
        before = after;
    }
    placements
}

/// What becomes of the steps of a leap from a state that passes so many placements (`None`: to the goal). `None`: it is not
/// made.
pub(super) type Judge<'a, D> =
    &'a mut dyn FnMut(&State<D>, Option<usize>, Vec<Step<D>>, &mut dyn Rng) -> Option<Vec<Step<D>>>;

/// An extension to a placement, or to the goal.
pub(super) struct Leap<D: Domain> {
    pub(super) steps: Vec<Step<D>>,
    pub(super) end: State<D>,
    /// How many placements lie behind now; `None` at the goal.
    pub(super) passed: Option<usize>,
}

/// The goal if one extension reaches it, else the placement half as far ahead, and so on down to the next.
pub(super) fn leap<D: Domain>(
    extender: &Extender<'_, D>,
    here: &State<D>,
    ahead: &[Placement<D>],
    left: &mut usize,
    judge: Judge<'_, D>,
    rng: &mut dyn Rng,
) -> Option<Leap<D>> {
    let Extender { problem, interrupt, .. } = *extender;
    let m = problem.domain();
    let mut count = ahead.len() + 1;
    while count > 0 {
        for _ in 0..DRAWS {
            *left = left.checked_sub(1)?;
            if interrupt.stop().is_some() {
                return None;
            }
            let goal = if count > ahead.len() { Some(problem.goal().sample(m, rng)?) } else { None };
            let Some(target) = goal.as_ref().or(ahead.get(count - 1).map(|p| &p.target)) else { break };
            let mut extension = extender.extend(here, target, rng);
            let is_goal = |reached: &Reached<D>| problem.goal().is_satisfied(m, &reached.state);
            let passed = if let Some(last) = extension.reached.iter().position(is_goal) {
                extension.reached.truncate(last + 1);
                None
            } else if extension.is_met && count <= ahead.len() {
                Some(count)
            } else {
                continue;
            };
            let end = extension.reached.last().map_or_else(|| here.clone(), |last| last.state.clone());
            if let Some(steps) = judge(here, passed, joined(extension.reached), rng) {
                return Some(Leap { steps, end, passed });
            }
        }
        count /= 2;
    }
    None
}

/// What an extension reached, the states of one instance as one step.
pub(crate) fn joined<D: Domain>(reached: Vec<Reached<D>>) -> Vec<Step<D>> {
    let mut steps: Vec<Step<D>> = Vec::new();
    for r in reached {
        match steps.last_mut().filter(|last| Arc::ptr_eq(&last.instance, &r.instance)) {
            Some(last) => last.until = r.t,
            None => steps.push(Step { instance: r.instance, until: r.t, primitive: r.primitive }),
        }
    }
    steps
}
