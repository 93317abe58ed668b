//! Plans whose motions do what no motion does, or go where nothing may be.

use std::sync::Arc;

use rand::RngExt;

use super::forge::{Change, Forge, LEAST_M};
use super::{Tampering, rejected};
use crate::domain::Domain;
use crate::laws::feed::{drift, spoilt_states};
use crate::laws::motion::component_travel;
use crate::plan::Plan;
use crate::random::Stream;
use crate::space::ComponentSpace;
use crate::state::{ComponentId, ObjectId, State};

/// Between these parameters something is wrong.
const WINDOW: (f64, f64) = (0.3, 0.7);
/// What is led into something is already inside of it at these shares of the way.
const DEEP: [f64; 3] = [0.9, 0.95, 1.0];

pub(super) fn ways<D: Domain>() -> Vec<Tampering<D>> {
    vec![
        Tampering { name: "jumps away and back", change: jumps },
        Tampering { name: "jumps in the last thousandth", change: jumps_late },
        Tampering { name: "stands still, and then jumps to the end", change: stands_still },
        Tampering { name: "passes through what is in the way", change: |f, rng| penetrates(f, rng, true) },
        Tampering { name: "passes through what is in the way, in no time", change: |f, rng| penetrates(f, rng, false) },
        Tampering { name: "leads an object through what is in the way", change: object_penetrates },
        Tampering { name: "ends elsewhere", change: |f, rng| ends_elsewhere(f, rng, 1.0) },
        Tampering { name: "ends nearly there", change: |f, rng| ends_elsewhere(f, rng, 0.05) },
        Tampering { name: "moves a bystander", change: |f, rng| bystander(f, rng, false) },
        Tampering { name: "moves a bystander there and back", change: |f, rng| bystander(f, rng, true) },
        Tampering { name: "the robot becomes NaN on the way", change: |f, rng| not_a_number(f, rng, true, WINDOW) },
        Tampering { name: "the robot ends as NaN", change: |f, rng| not_a_number(f, rng, true, (0.9, 1.0)) },
        Tampering { name: "an object becomes NaN on the way", change: |f, rng| not_a_number(f, rng, false, WINDOW) },
        Tampering { name: "a length that is NaN", change: |f, rng| length(f, rng, f64::NAN) },
        Tampering { name: "a length below 0", change: |f, rng| length(f, rng, -1.0) },
        Tampering { name: "a length without end", change: |f, rng| length(f, rng, f64::INFINITY) },
        Tampering { name: "lets go early", change: early },
        Tampering { name: "loses an object", change: loses },
        Tampering { name: "leaves the space of the robot", change: |f, rng| leaves(f, rng, true) },
        Tampering { name: "an object leaves its space", change: |f, rng| leaves(f, rng, false) },
    ]
}

fn is_in((low, high): (f64, f64), t: f64) -> bool {
    low < t && t <= high
}

fn jumps<D: Domain>(forge: &Forge<'_, D>, rng: &mut Stream) -> Option<Plan<D>> {
    let step = forge.moving(rng)?;
    let away = forge.displaced(forge.ends(step)?.0, ComponentId::Robot, rng)?.robot;
    forge.changed(
        step,
        |length| length,
        Arc::new(move |_, t, state| {
            if is_in(WINDOW, t) {
                state.robot.clone_from(&away);
            }
        }),
    )
}

fn jumps_late<D: Domain>(forge: &Forge<'_, D>, rng: &mut Stream) -> Option<Plan<D>> {
    let step = forge.moving(rng)?;
    let away = forge.displaced(forge.ends(step)?.1, ComponentId::Robot, rng)?.robot;
    forge.changed(
        step,
        |length| length,
        Arc::new(move |_, t, state| {
            if t > 0.999 {
                state.robot.clone_from(&away);
            }
        }),
    )
}

fn stands_still<D: Domain>(forge: &Forge<'_, D>, rng: &mut Stream) -> Option<Plan<D>> {
    let step = forge.moving(rng)?;
    let (start, end) = forge.ends(step)?;
    if component_travel(forge.m(), start, end) < 5.0 * LEAST_M {
        return None;
    }
    let start = start.clone();
    forge.changed(
        step,
        |length| length,
        Arc::new(move |_, t, state| {
            if t < 0.999 && t > 0.0 {
                state.robot.clone_from(&start.robot);
                state.objects.clone_from(&start.objects);
            }
        }),
    )
}

/// There and back in the window: 0 at its ends, 1 in the middle.
fn bump(t: f64) -> f64 {
    let (low, high) = WINDOW;
    (1.0 - ((t - low) / (high - low) * 2.0 - 1.0).abs()).max(0.0)
}

/// Leads the robot continuously to a state that is rejected, and back.
fn penetrates<D: Domain>(forge: &Forge<'_, D>, rng: &mut Stream, is_honest: bool) -> Option<Plan<D>> {
    let step = forge.moving(rng)?;
    let instance = &forge.plan.steps().get(step)?.instance;
    let until = forge.plan.steps().get(step)?.until;
    let half = instance.at(forge.m(), 0.5 * until, forge.plan.start());
    let into = (0..64).find_map(|_| {
        let there = forge.displaced(&half, ComponentId::Robot, rng)?;
        // Deep inside, so that a verifier that is content with less room than the validity refuses it as well.
        let is_deep = DEEP.iter().all(|share| {
            let robot = forge.m().robot().interpolate(&half.robot, &there.robot, *share);
            rejected(forge.judged, &State { robot, ..half.clone() }, instance)
        });
        is_deep.then_some(there)
    })?;
    let way_m = forge.m().robot().distance(&half.robot, &into.robot);
    let robot = into.robot;
    let change: Change<D> = Arc::new(move |m, t, state| {
        let share = bump(t);
        if share > 0.0 {
            state.robot = m.robot().interpolate(&state.robot, &robot, share);
        }
    });
    // There and back within less than half of the time, while the old motion goes on.
    forge.changed(step, |length| if is_honest { 10.0 * (length + way_m) } else { 0.0 }, change)
}

/// The same with an object that the step moves, while the robot goes on as before.
fn object_penetrates<D: Domain>(forge: &Forge<'_, D>, rng: &mut Stream) -> Option<Plan<D>> {
    let (step, component) = forge.moving_object(rng)?;
    let planned = forge.plan.steps().get(step)?;
    let half = planned.instance.at(forge.m(), 0.5 * planned.until, forge.plan.start());
    let into = (0..64).find_map(|_| {
        let there = forge.displaced(&half, component, rng)?;
        let is_deep = DEEP.iter().all(|share| {
            let mut state = half.clone();
            drift(forge.m(), &mut state, &there, component, *share);
            rejected(forge.judged, &state, &planned.instance)
        });
        is_deep.then_some(there)
    })?;
    let way_m = component_travel(forge.m(), &half, &into);
    let change: Change<D> = Arc::new(move |m, t, state| drift(m, state, &into, component, bump(t)));
    forge.changed(step, |length| 10.0 * (length + way_m), change)
}

/// The last step ends where the goal is not satisfied, after a motion without jumps.
fn ends_elsewhere<D: Domain>(forge: &Forge<'_, D>, rng: &mut Stream, share: f64) -> Option<Plan<D>> {
    let last = forge.plan.steps().len().checked_sub(1)?;
    let (_, end) = forge.ends(last)?;
    let objects = (0..forge.m().objects().len()).map(|i| ComponentId::Object(ObjectId::new(i)));
    let mut all: Vec<ComponentId> = objects.chain([ComponentId::Robot]).collect();
    while !all.is_empty() {
        let component = all.swap_remove(rng.random_range(0..all.len()));
        let Some(there) = forge.displaced(end, component, rng) else { continue };
        let m = forge.m();
        let change: Change<D> = Arc::new(move |m, t, state| drift(m, state, &there, component, share * t));
        let mut wrong = end.clone();
        change(m, 1.0, &mut wrong);
        if forge.is_goal(&wrong) || component_travel(m, end, &wrong) < LEAST_M * 0.5 {
            continue;
        }
        let far_m = component_travel(m, end, &wrong);
        return forge.changed(last, |length| length + 4.0 * far_m, change);
    }
    None
}

fn bystander<D: Domain>(forge: &Forge<'_, D>, rng: &mut Stream, comes_back: bool) -> Option<Plan<D>> {
    let step = forge.moving(rng)?;
    let id = forge.bystander(step, rng)?;
    let there = forge.displaced(forge.ends(step)?.0, ComponentId::Object(id), rng)?;
    let change: Change<D> = Arc::new(move |m, t, state| {
        let share = if comes_back { bump(t) } else { t };
        drift(m, state, &there, ComponentId::Object(id), share);
    });
    forge.changed(step, |length| 10.0 * (length + 10.0), change)
}

fn not_a_number<D: Domain>(
    forge: &Forge<'_, D>,
    rng: &mut Stream,
    of_robot: bool,
    window: (f64, f64),
) -> Option<Plan<D>> {
    let step = forge.moving(rng)?;
    let all = spoilt_states(forge.m(), forge.ends(step)?.1);
    let of_kind = |bad: &crate::laws::feed::SpoiltState<D>| {
        (bad.component == ComponentId::Robot) == of_robot && bad.what.contains("NaN")
    };
    let mut all: Vec<_> = all.into_iter().filter(of_kind).collect();
    if all.is_empty() {
        return None;
    }
    let bad = all.swap_remove(rng.random_range(0..all.len())).state;
    forge.changed(
        step,
        |length| length,
        Arc::new(move |_, t, state| {
            if is_in(window, t) {
                if of_robot {
                    state.robot.clone_from(&bad.robot);
                } else {
                    state.objects.clone_from(&bad.objects);
                }
            }
        }),
    )
}

fn length<D: Domain>(forge: &Forge<'_, D>, rng: &mut Stream, metres: f64) -> Option<Plan<D>> {
    let step = forge.moving(rng)?;
    forge.changed(step, |_| metres, Arc::new(|_, _, _| {}))
}

/// In the second half of a step the mode is already that of the end of the plan, or of its start.
fn early<D: Domain>(forge: &Forge<'_, D>, rng: &mut Stream) -> Option<Plan<D>> {
    let count = forge.plan.steps().len();
    let step = rng.random_range(0..count.max(1));
    let during = forge.plan.at(forge.m(), step, 0.5)?.mode;
    let ends = [forge.states.last()?, forge.states.first()?];
    let other = ends
        .into_iter()
        .find(|state| state.mode != during && Some(&state.mode) != forge.states.get(step).map(|s| &s.mode))?;
    let mode = other.mode.clone();
    // At the end of the last step it may well be right.
    let is_last = step + 1 == count;
    forge.changed(
        step,
        |length| length,
        Arc::new(move |_, t, state| {
            if t > 0.5 && !(is_last && t >= 1.0) {
                state.mode.clone_from(&mode);
            }
        }),
    )
}

fn loses<D: Domain>(forge: &Forge<'_, D>, rng: &mut Stream) -> Option<Plan<D>> {
    let step = forge.moving(rng)?;
    if forge.m().objects().is_empty() {
        return None;
    }
    forge.changed(
        step,
        |length| length,
        Arc::new(|_, t, state| {
            if t > 0.5 {
                state.objects.pop();
            }
        }),
    )
}

/// One number of the robot, or of an object that the step moves, leaves its space for a while, at a finite speed.
fn leaves<D: Domain>(forge: &Forge<'_, D>, rng: &mut Stream, is_robot: bool) -> Option<Plan<D>> {
    let (step, component) =
        if is_robot { (forge.moving(rng)?, ComponentId::Robot) } else { forge.moving_object(rng)? };
    let (m, start) = (forge.m(), forge.ends(step)?.0);
    let count = crate::laws::feed::count_of(m, start, component);
    let (index, is_upper) = (rng.random_range(0..count.max(1)), rng.random_bool(0.5));
    // As far beyond the face as it is before it, and more.
    let edge = crate::laws::feed::on_face(m, start, component, index, is_upper);
    let metres = component_travel(m, start, &edge) + 0.5;
    let there = crate::laws::feed::beyond_face(m, start, component, index, is_upper, metres);
    let is_inside = match component {
        ComponentId::Robot => m.robot().contains(&there.robot),
        ComponentId::Object(id) => m.objects().get(id.index())?.contains(there.object(id)?),
    };
    // Where a number wraps around, or has no bound, it does not leave.
    if is_inside || edge == *start {
        return None;
    }
    let beyond = value(m, &there, component, index)?;
    let far_m = (beyond - value(m, start, component, index)?).abs();
    let change: Change<D> = Arc::new(move |m, t, state| bring(m, state, component, index, (beyond, bump(t))));
    forge.changed(step, |length| 10.0 * (length + 2.0 * far_m), change)
}

fn value<D: Domain>(m: &D, state: &State<D>, component: ComponentId, index: usize) -> Option<f64> {
    let all = match component {
        ComponentId::Robot => crate::laws::feed::values(m.robot(), &state.robot),
        ComponentId::Object(id) => crate::laws::feed::values(m.objects().get(id.index())?, state.object(id)?),
    };
    all.get(index).copied()
}

/// Brings one number by a share of the way to what it should be.
fn bring<D: Domain>(m: &D, state: &mut State<D>, component: ComponentId, index: usize, (wanted, share): (f64, f64)) {
    let Some(here) = value(m, state, component, index) else { return };
    let at = here + (wanted - here) * share;
    match component {
        ComponentId::Robot => state.robot = crate::laws::feed::with(m.robot(), &state.robot, index, at),
        ComponentId::Object(id) => {
            if let (Some(space), Some(slot)) = (m.objects().get(id.index()), state.objects.get_mut(id.index())) {
                *slot = crate::laws::feed::with(space, slot, index, at);
            }
        }
    }
}
