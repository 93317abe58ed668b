//! Laws of [`PartialState`] as a domain makes them: overlays, subsets, unions.

use crate::domain::Domain;
use crate::partial::PartialState;
use crate::space::ComponentSpace;
use crate::state::{ComponentId, ObjectId, State};

use super::{Broken, ensure, equal};

/// Overlay meets.
pub const OVERLAY_MET: &str =
    "partial.overlay-met: a state overlaid with a target meets it, and overlaying again changes nothing";
/// Overlay keeps.
pub const OVERLAY_KEEPS: &str = "partial.overlay-keeps: an overlay changes neither unnamed components nor the mode";
/// The targets that name nothing and everything.
pub const EXTREMES: &str =
    "partial.extremes: the empty target is met by every state; the one made of a state names all and overlays to it";
/// Unnamed groups.
pub const UNNAMED: &str = "partial.unnamed: robot groups that a target does not name have no influence";
/// Subset.
pub const SUBSET: &str = "partial.subset: whoever meets a target meets every subset of it";
/// Union.
pub const UNION: &str =
    "partial.union: a target is a subset of its union with another, which overlays like the other and then the target";

/// The laws of this file.
pub const LAWS: &[&str] = &[OVERLAY_MET, OVERLAY_KEEPS, EXTREMES, UNNAMED, SUBSET, UNION];

/// All laws of partial states, for two targets and two states of the domain.
///
/// They can only fail through the overlay, groups or distance of a component space of `m`.
///
/// # Errors
/// The first law that is [`Broken`].
pub fn check_partial<D: Domain>(
    m: &D,
    targets: [&PartialState<D>; 2],
    state: &State<D>,
    elsewhere: &State<D>,
) -> Result<(), Broken> {
    let [target, other] = targets;
    let check = || {
        overlay(m, target, state)?;
        empty_and_full(m, target, state, elsewhere)?;
        unnamed(m, target, state, elsewhere)?;
        union(m, target, other, [state, elsewhere])
    };
    check().map_err(|broken| {
        broken.replayed_by(|| format!("check_partial([&{target:?}, &{other:?}], &{state:?}, &{elsewhere:?})"))
    })
}

fn overlay<D: Domain>(m: &D, target: &PartialState<D>, state: &State<D>) -> Result<(), Broken> {
    let over = target.overlay(m, state);
    ensure(OVERLAY_MET, target.is_met(m, &over), || format!("{over:?}"), "a state that meets the target")?;
    equal(OVERLAY_MET, &target.overlay(m, &over), &over)?;
    equal(OVERLAY_KEEPS, &over.mode, &state.mode).map_err(|broken| broken.of("mode"))?;
    for (i, (p, q)) in over.objects.iter().zip(&state.objects).enumerate() {
        let id = ObjectId::new(i);
        let of = |broken: Broken| broken.of(m.component_name(ComponentId::Object(id)));
        match target.object(id) {
            None => equal(OVERLAY_KEEPS, p, q).map_err(of)?,
            Some(there) => equal(OVERLAY_MET, p, there).map_err(of)?,
        }
    }
    let restored = match target.robot() {
        None => over.robot,
        Some(robot) => m.robot().overlay(&over.robot, &state.robot, robot.groups),
    };
    equal(OVERLAY_KEEPS, &restored, &state.robot).map_err(|broken| broken.of(m.component_name(ComponentId::Robot)))
}

fn empty_and_full<D: Domain>(
    m: &D,
    target: &PartialState<D>,
    state: &State<D>,
    elsewhere: &State<D>,
) -> Result<(), Broken> {
    let anywhere = PartialState::anywhere(m);
    ensure(EXTREMES, anywhere.components().is_empty(), || format!("{:?}", anywhere.components()), "no component")?;
    ensure(EXTREMES, anywhere.is_met(m, state), || format!("{state:?} does not meet it"), "met by every state")?;
    ensure(EXTREMES, anywhere.is_subset_of(m, target), || format!("not a subset of {target:?}"), "a subset of all")?;
    equal(EXTREMES, &anywhere.overlay(m, state), state)?;

    let full = PartialState::of_state(m, state);
    equal(EXTREMES, &full.components().len(), &(state.objects.len() + 1))?;
    ensure(EXTREMES, full.is_met(m, state), || format!("{state:?} does not meet {full:?}"), "met by its own state")?;
    let over = full.overlay(m, elsewhere);
    equal(EXTREMES, &over.robot, &state.robot)?;
    equal(EXTREMES, &over.objects, &state.objects)
}

fn unnamed<D: Domain>(m: &D, target: &PartialState<D>, state: &State<D>, elsewhere: &State<D>) -> Result<(), Broken> {
    let twin = with_other_unnamed(m, target, elsewhere);
    equal(UNNAMED, &twin.overlay(m, state), &target.overlay(m, state))?;
    equal(UNNAMED, &twin.is_met(m, state), &target.is_met(m, state))?;
    equal(UNNAMED, &twin.is_subset_of(m, target), &true)
}

/// The same target, but with other values in the robot groups that it does not name.
pub(super) fn with_other_unnamed<D: Domain>(m: &D, target: &PartialState<D>, elsewhere: &State<D>) -> PartialState<D> {
    match target.robot() {
        None => target.clone(),
        Some(robot) => {
            let config = m.robot().overlay(&elsewhere.robot, &robot.config, robot.groups);
            target.clone().with_robot_groups(config, robot.groups)
        }
    }
}

fn union<D: Domain>(
    m: &D,
    target: &PartialState<D>,
    other: &PartialState<D>,
    states: [&State<D>; 2],
) -> Result<(), Broken> {
    let both = target.clone().or(m, other);
    equal(UNION, &both.components(), &target.components().union(other.components()))?;
    for (small, large) in [(target, target), (target, &both), (&both, &both)] {
        let text = || format!("{small:?} is not a subset of {large:?}");
        ensure(UNION, small.is_subset_of(m, large), text, "a subset")?;
    }
    equal(UNION, &both.overlay(m, states[0]), &target.overlay(m, &other.overlay(m, states[0])))?;
    let met = both.overlay(m, states[0]);
    for state in [states[0], states[1], &met] {
        for (small, large) in [(target, &both), (target, other), (other, target)] {
            let holds = !small.is_subset_of(m, large) || !large.is_met(m, state) || small.is_met(m, state);
            ensure(SUBSET, holds, || format!("{state:?} meets {large:?}, not {small:?}"), "the subset met as well")?;
        }
    }
    Ok(())
}
