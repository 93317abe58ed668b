//! What a plan must be before it is written down. A file goes straight from waypoint to waypoint, so it would hide a step
//! that begins elsewhere than the last one ended, a motion that jumps, and a mode that changes on the way.

use darrt_core::domain::Domain;
use darrt_core::goal::Goal;
use darrt_core::plan::{Plan, Step};
use darrt_core::space::ComponentSpace;
use darrt_core::state::{ComponentId, ObjectId};
use darrt_core::verify::Refusal;

use darrt_primitives::manipulator::Manipulator;
use darrt_primitives::tabletop::{Tabletop, TabletopState};

/// States of every step that are looked at besides its beginning: a jump to anywhere is longer than this part of a step.
const LOOKS: u32 = 12;
/// Rounding that is forgiven between two looks, metres.
const SLACK_M: f64 = 1e-4;

/// Is `plan` one that begins at `start`, goes on from step to step without jumps, and ends in `goal`?
///
/// # Errors
/// The first [`Refusal`] found.
pub(super) fn check<M: Manipulator>(
    m: &Tabletop<M>,
    start: &TabletopState<M>,
    goal: &dyn Goal<Tabletop<M>>,
    plan: &Plan<Tabletop<M>>,
) -> Result<(), Refusal> {
    let whole = |reason: &str| Refusal { step: None, at: 0.0, reason: reason.to_owned() };
    if plan.start() != start {
        return Err(whole("it starts elsewhere"));
    }
    let mut here = start.clone();
    for (index, step) in plan.steps().iter().enumerate() {
        here = run(m, step, &here).map_err(|(at, reason)| Refusal { step: Some(index), at, reason })?;
    }
    if goal.is_satisfied(m, &here) { Ok(()) } else { Err(whole("it does not end in the goal")) }
}

/// The state after `step`, or at which share of it something is wrong, and what.
fn run<M: Manipulator>(
    m: &Tabletop<M>,
    step: &Step<Tabletop<M>>,
    before: &TabletopState<M>,
) -> Result<TabletopState<M>, (f64, String)> {
    let (motion, until) = (&step.instance.motion, step.until);
    let length_m = motion.length();
    let is_sound = until > 0.0 && until <= 1.0 && length_m.is_finite() && length_m >= 0.0;
    if !is_sound {
        return Err((0.0, format!("it runs until {until} on a motion of {length_m} m")));
    }
    let mut last = before.clone();
    motion.at_into(m, 0.0, &mut last);
    if !follows(before, &last) {
        return Err((0.0, "it begins elsewhere than the step before ends".to_owned()));
    }
    let most_m = length_m * until / f64::from(LOOKS) + SLACK_M;
    let mut here = before.clone();
    let mut mode = None;
    for look in 1..=LOOKS {
        let s = f64::from(look) / f64::from(LOOKS);
        motion.at_into(m, s * until, &mut here);
        let wrong = |what: String| Err((s, what));
        let metres = travel_m(m, &last, &here);
        // Also if it is no number.
        if metres.is_nan() || metres > most_m {
            return wrong(format!("something moves {metres} m, of which {most_m} m are possible"));
        }
        if s * until < 1.0 && *mode.get_or_insert_with(|| here.mode.clone()) != here.mode {
            return wrong("the mode changes on the way".to_owned());
        }
        if let Some(stray) = stray(m, step, before, &here) {
            return wrong(format!("{stray} moves, but the step does not move it"));
        }
        last.clone_from(&here);
    }
    Ok(here)
}

/// Does a step that begins at `here` go on from where the one before ended? An empty hand may have to open or close first:
/// the file shows that as the beginning of the step, and the verifier judges it there.
fn follows<M: Manipulator>(end: &TabletopState<M>, here: &TabletopState<M>) -> bool {
    let is_same_mode = end.mode == here.mode || end.mode.opened_to(here.mode.gap_m()).as_ref() == Some(&here.mode);
    is_same_mode && end.robot == here.robot && end.objects == here.objects
}

/// How far any point of the robot, or any object, is from where it was, metres; NaN if objects are missing.
fn travel_m<M: Manipulator>(m: &Tabletop<M>, a: &TabletopState<M>, b: &TabletopState<M>) -> f64 {
    if a.objects.len() != b.objects.len() {
        return f64::NAN;
    }
    let objects = a.objects.iter().zip(&b.objects).map(|(p, q)| (p.translation.vector - q.translation.vector).norm());
    // A maximum that keeps NaN.
    let larger = |most: f64, metres: f64| if most >= metres || most.is_nan() { most } else { metres };
    objects.fold(m.robot().distance(&a.robot, &b.robot), larger)
}

fn stray<M: Manipulator>(
    m: &Tabletop<M>,
    step: &Step<Tabletop<M>>,
    before: &TabletopState<M>,
    here: &TabletopState<M>,
) -> Option<String> {
    let moves = step.instance.moves;
    let robot = (!moves.contains(ComponentId::Robot) && before.robot != here.robot).then_some(ComponentId::Robot);
    let objects = (0..before.objects.len()).map(|i| ComponentId::Object(ObjectId::new(i)));
    let differs = |id: &ComponentId| match id {
        ComponentId::Object(id) => before.object(*id) != here.object(*id),
        ComponentId::Robot => false,
    };
    let object = objects.filter(|id| !moves.contains(*id)).find(differs);
    robot.or(object).map(|id| m.component_name(id).into_owned())
}
