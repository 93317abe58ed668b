//! Plans whose steps are in disorder.

use std::sync::Arc;

use rand::RngExt;

use super::Tampering;
use super::forge::{Backwards, Forge, instance_of};
use crate::domain::Domain;
use crate::laws::motion::component_travel;
use crate::plan::Plan;
use crate::random::Stream;
use crate::state::{ComponentId, ComponentSet};

pub(super) fn ways<D: Domain>() -> Vec<Tampering<D>> {
    vec![
        Tampering { name: "starts elsewhere", change: starts_elsewhere },
        Tampering { name: "starts where its first step ends", change: starts_later },
        Tampering { name: "no steps at all", change: no_steps },
        Tampering { name: "the first step is missing", change: |forge, _| without(forge, 0) },
        Tampering { name: "a step is missing", change: |forge, rng| without(forge, forge.moving(rng)?) },
        Tampering { name: "the last step is missing", change: last_missing },
        Tampering { name: "two steps are swapped", change: swapped },
        Tampering { name: "a step comes twice", change: twice },
        Tampering { name: "a step runs backwards", change: backwards },
        Tampering { name: "a step is cut, and the next begins at its end", change: cut_in_the_middle },
        Tampering { name: "the last step is cut", change: cut_at_the_end },
        Tampering { name: "a step that runs until NaN", change: |forge, rng| until(forge, rng, f64::NAN) },
        Tampering { name: "a step that runs until 0", change: |forge, rng| until(forge, rng, 0.0) },
        Tampering { name: "a step that runs until -1", change: |forge, rng| until(forge, rng, -1.0) },
        Tampering { name: "a step that runs until 1.5", change: |forge, rng| until(forge, rng, 1.5) },
        Tampering { name: "a step that says it moves nothing", change: moves_nothing },
    ]
}

fn starts_elsewhere<D: Domain>(forge: &Forge<'_, D>, rng: &mut Stream) -> Option<Plan<D>> {
    let start = forge.displaced(forge.plan.start(), ComponentId::Robot, rng)?;
    Some(Plan::new(start, forge.steps()))
}

/// A plan without a fault, of another problem.
fn starts_later<D: Domain>(forge: &Forge<'_, D>, _: &mut Stream) -> Option<Plan<D>> {
    let (before, after) = forge.ends(0)?;
    (before != after).then(|| Plan::new(after.clone(), forge.steps().split_off(1)))
}

fn no_steps<D: Domain>(forge: &Forge<'_, D>, _: &mut Stream) -> Option<Plan<D>> {
    (!forge.is_goal(forge.plan.start())).then(|| forge.with(Vec::new()))
}

/// Without a step that leads elsewhere, unless that is just the rest of the plan.
fn without<D: Domain>(forge: &Forge<'_, D>, step: usize) -> Option<Plan<D>> {
    let (before, after) = forge.ends(step)?;
    let is_last = step + 1 == forge.plan.steps().len();
    if before == after || is_last && forge.is_goal(before) {
        return None;
    }
    let mut steps = forge.steps();
    steps.remove(step);
    Some(forge.with(steps))
}

fn last_missing<D: Domain>(forge: &Forge<'_, D>, _: &mut Stream) -> Option<Plan<D>> {
    without(forge, forge.plan.steps().len().checked_sub(1)?)
}

fn swapped<D: Domain>(forge: &Forge<'_, D>, rng: &mut Stream) -> Option<Plan<D>> {
    let last = forge.plan.steps().len().checked_sub(1)?;
    let step = rng.random_range(0..last.max(1));
    let ((before, between), (_, after)) = (forge.ends(step)?, forge.ends(step + 1)?);
    if before == between || between == after {
        return None;
    }
    let mut steps = forge.steps();
    steps.swap(step, step + 1);
    Some(forge.with(steps))
}

fn twice<D: Domain>(forge: &Forge<'_, D>, rng: &mut Stream) -> Option<Plan<D>> {
    let step = forge.moving(rng)?;
    let mut steps = forge.steps();
    let again = steps.get(step)?.clone();
    steps.insert(step, again);
    Some(forge.with(steps))
}

fn backwards<D: Domain>(forge: &Forge<'_, D>, rng: &mut Stream) -> Option<Plan<D>> {
    let step = forge.moving(rng)?;
    let mut steps = forge.steps();
    let slot = steps.get_mut(step)?;
    let moves = slot.instance.moves;
    slot.instance = Arc::new(instance_of(&slot.instance, moves, Backwards(Arc::clone(&slot.instance))));
    Some(forge.with(steps))
}

fn cut_in_the_middle<D: Domain>(forge: &Forge<'_, D>, rng: &mut Stream) -> Option<Plan<D>> {
    let step = forge.moving(rng)?;
    let mut steps = forge.steps();
    let is_last = step + 1 == steps.len();
    let slot = steps.get_mut(step)?;
    slot.until *= 0.5;
    let cut = slot.instance.at(forge.m(), slot.until, forge.plan.start());
    let (_, end) = forge.ends(step)?;
    let is_elsewhere = component_travel(forge.m(), &cut, end) > super::forge::LEAST_M;
    (is_elsewhere && !is_last).then(|| forge.with(steps))
}

fn cut_at_the_end<D: Domain>(forge: &Forge<'_, D>, rng: &mut Stream) -> Option<Plan<D>> {
    let mut steps = forge.steps();
    let last = steps.last_mut()?;
    last.until *= rng.random_range(0.3..0.9);
    let cut = last.instance.at(forge.m(), last.until, forge.plan.start());
    (!forge.is_goal(&cut)).then(|| forge.with(steps))
}

fn until<D: Domain>(forge: &Forge<'_, D>, rng: &mut Stream, until: f64) -> Option<Plan<D>> {
    let step = forge.moving(rng)?;
    let mut steps = forge.steps();
    steps.get_mut(step)?.until = until;
    Some(forge.with(steps))
}

fn moves_nothing<D: Domain>(forge: &Forge<'_, D>, rng: &mut Stream) -> Option<Plan<D>> {
    let step = forge.moving(rng)?;
    let mut steps = forge.steps();
    let slot = steps.get_mut(step)?;
    let inner = Backwards(Arc::clone(&slot.instance));
    // Backwards twice is forwards.
    let forwards = Arc::new(instance_of(&slot.instance, ComponentSet::EMPTY, inner));
    slot.instance = Arc::new(instance_of(&forwards, ComponentSet::EMPTY, Backwards(Arc::clone(&forwards))));
    Some(forge.with(steps))
}
