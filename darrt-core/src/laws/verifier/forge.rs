//! What plans are forged with: states at the borders of steps, and motions that are changed on the way.

use std::fmt;
use std::sync::Arc;

use rand::{Rng, RngExt};

use super::Judged;
use crate::domain::Domain;
use crate::laws::feed::{components, elsewhere};
use crate::laws::motion::component_travel;
use crate::motion::{Instance, Motion};
use crate::plan::{Plan, Step};
use crate::state::{ComponentId, ComponentSet, ObjectId, State};

/// Less than this is no difference worth forging, metres.
pub(super) const LEAST_M: f64 = 0.02;

/// A plan, and what it does.
pub(super) struct Forge<'a, D: Domain> {
    pub(super) judged: &'a Judged<'a, D>,
    pub(super) plan: &'a Plan<D>,
    /// Before the first step, and after each.
    pub(super) states: Vec<State<D>>,
}

/// What is done to the state at a share of the step.
pub(super) type Change<D> = Arc<dyn Fn(&D, f64, &mut State<D>) + Send + Sync>;

impl<'a, D: Domain> Forge<'a, D> {
    pub(super) fn new(judged: &'a Judged<'a, D>, plan: &'a Plan<D>) -> Self {
        let ends = (0..plan.steps().len()).filter_map(|i| plan.at(judged.domain, i, 1.0));
        let states = std::iter::once(plan.start().clone()).chain(ends).collect();
        Self { judged, plan, states }
    }

    pub(super) fn m(&self) -> &'a D {
        self.judged.domain
    }

    pub(super) fn steps(&self) -> Vec<Step<D>> {
        self.plan.steps().to_vec()
    }

    pub(super) fn with(&self, steps: Vec<Step<D>>) -> Plan<D> {
        Plan::new(self.plan.start().clone(), steps)
    }

    pub(super) fn is_goal(&self, state: &State<D>) -> bool {
        self.judged.goal.is_satisfied(self.m(), state)
    }

    /// The states before and after a step.
    pub(super) fn ends(&self, step: usize) -> Option<(&State<D>, &State<D>)> {
        Some((self.states.get(step)?, self.states.get(step + 1)?))
    }

    /// A random step that moves something by more than a hair.
    pub(super) fn moving(&self, rng: &mut dyn Rng) -> Option<usize> {
        let far = |i: &usize| self.ends(*i).is_some_and(|(p, q)| component_travel(self.m(), p, q) > LEAST_M);
        let all: Vec<usize> = (0..self.plan.steps().len()).filter(far).collect();
        all.get(rng.random_range(0..all.len().max(1))).copied()
    }

    /// A random step that moves an object by more than a hair, and the last of those that it moves.
    pub(super) fn moving_object(&self, rng: &mut dyn Rng) -> Option<(usize, ComponentId)> {
        let of = |(i, step): (usize, &Step<D>)| {
            let (before, after) = self.ends(i)?;
            let all = components(self.m(), step.instance.moves);
            let object = all.into_iter().rfind(|id| *id != ComponentId::Robot)?;
            let same_robot = State { robot: before.robot.clone(), ..after.clone() };
            (component_travel(self.m(), before, &same_robot) > LEAST_M).then_some((i, object))
        };
        let all: Vec<_> = self.plan.steps().iter().enumerate().filter_map(of).collect();
        all.get(rng.random_range(0..all.len().max(1))).copied()
    }

    /// A state like `state`, in which `component` is so far away that nobody can overlook it.
    pub(super) fn displaced(&self, state: &State<D>, component: ComponentId, rng: &mut dyn Rng) -> Option<State<D>> {
        (0..32).find_map(|_| {
            let there = elsewhere(self.m(), state, rng);
            let mut at = state.clone();
            match component {
                ComponentId::Robot => at.robot = there.robot,
                ComponentId::Object(id) => {
                    let place = there.object(id)?.clone();
                    *at.objects.get_mut(id.index())? = place;
                }
            }
            (component_travel(self.m(), state, &at) > 10.0 * LEAST_M).then_some(at)
        })
    }

    /// An object that a step does not move.
    pub(super) fn bystander(&self, step: usize, rng: &mut dyn Rng) -> Option<ObjectId> {
        let moves = self.plan.steps().get(step)?.instance.moves;
        let ids = (0..self.m().objects().len()).map(ObjectId::new);
        let all: Vec<_> = ids.filter(|id| !moves.contains(ComponentId::Object(*id))).collect();
        all.get(rng.random_range(0..all.len().max(1))).copied()
    }

    /// The plan with another motion in one step.
    pub(super) fn changed(&self, step: usize, length_m: impl Fn(f64) -> f64, change: Change<D>) -> Option<Plan<D>> {
        let mut steps = self.steps();
        let slot = steps.get_mut(step)?;
        let inner = Arc::clone(&slot.instance);
        let length_m = length_m(inner.motion.length());
        let (moves, until) = (inner.moves, slot.until);
        let forged = Forged { inner: Arc::clone(&inner), length_m, until, change };
        slot.instance = Arc::new(instance_of(&inner, moves, forged));
        Some(self.with(steps))
    }
}

/// `like` with another motion, moving `moves`.
pub(super) fn instance_of<D: Domain>(
    like: &Instance<D>,
    moves: ComponentSet,
    motion: impl Motion<D> + 'static,
) -> Instance<D> {
    Instance {
        primitive: like.primitive,
        motion: Box::new(motion),
        contacts: like.contacts.clone(),
        moves,
        object: like.object,
        reversible: like.reversible,
    }
}

/// A motion that is changed on the way.
pub(super) struct Forged<D: Domain> {
    inner: Arc<Instance<D>>,
    length_m: f64,
    /// Where the step ends on it.
    until: f64,
    change: Change<D>,
}

impl<D: Domain> Motion<D> for Forged<D> {
    fn length(&self) -> f64 {
        self.length_m
    }

    fn knots(&self) -> &[f64] {
        self.inner.motion.knots()
    }

    fn at_into(&self, m: &D, t: f64, out: &mut State<D>) {
        self.inner.motion.at_into(m, t, out);
        (self.change)(m, (t / self.until).clamp(0.0, 1.0), out);
    }
}

impl<D: Domain> fmt::Debug for Forged<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Forged").field("inner", &self.inner).field("length_m", &self.length_m).finish_non_exhaustive()
    }
}

/// The motion of an instance backwards.
pub(super) struct Backwards<D: Domain>(pub(super) Arc<Instance<D>>);

impl<D: Domain> fmt::Debug for Backwards<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Backwards").field(&self.0).finish()
    }
}

impl<D: Domain> Motion<D> for Backwards<D> {
    fn length(&self) -> f64 {
        self.0.motion.length()
    }

    fn at_into(&self, m: &D, t: f64, out: &mut State<D>) {
        self.0.motion.at_into(m, 1.0 - t.clamp(0.0, 1.0), out);
    }
}
