//! Proptest strategies for the states of any table-top domain: everything at rest, something in the hand, the hand
//! beside something.
//!
//! Together with [`darrt_core::testing::strategies`] they make a law test of a primitive about ten lines long; see
//! [`laws`](crate::laws).

use darrt_core::domain::Domain;
use darrt_core::random::{Purpose, stream};
use darrt_core::space::ComponentSpace;
use darrt_core::state::{ObjectId, State};
use darrt_core::testing::strategies::configs;
use nalgebra::Point2;
use proptest::prelude::*;
use rand::RngExt;

use crate::manipulator::{Configuration, Manipulator};
use crate::mode::{Held, Mode};
use crate::tabletop::{Tabletop, TabletopState};

/// How many bases are drawn to bring the hand to an object.
const BASE_TRIES: u64 = 32;

/// Every object stands somewhere on one of its surfaces, the hand is free, the robot anywhere.
pub fn resting<M: Manipulator>(m: &Tabletop<M>) -> impl Strategy<Value = TabletopState<M>> + Clone + '_ {
    let makes = move |(robot, seed): (Configuration<M::Joints>, u64)| standing(m, robot, seed);
    (configs(m.robot()), any::<u64>()).prop_filter_map("a place for every object", makes)
}

/// One object is in the hand, by one of its grasps, the others rest.
pub fn holding<M: Manipulator>(m: &Tabletop<M>) -> impl Strategy<Value = TabletopState<M>> + Clone + '_ {
    (resting(m), any::<u64>()).prop_filter_map("an object that can be held", move |(state, seed)| held(m, &state, seed))
}

/// The hand stands with a grasp around one resting object, not yet closed; the others rest as well.
pub fn engaged<M: Manipulator>(m: &Tabletop<M>) -> impl Strategy<Value = TabletopState<M>> + Clone + '_ {
    let makes = move |(state, seed): (TabletopState<M>, u64)| beside(m, &state, seed);
    (resting(m), any::<u64>()).prop_filter_map("an object that the hand reaches", makes)
}

/// The hand has just closed on a resting object: it is held upright, where it stands.
pub fn grasping<M: Manipulator>(m: &Tabletop<M>) -> impl Strategy<Value = TabletopState<M>> + Clone + '_ {
    let closes = move |state: TabletopState<M>| {
        let object = state.mode.engaged()?;
        let tool = m.manipulator().world_from_tool(&state.robot);
        let tool_from_object = tool.inverse() * state.object(object)?;
        let held = Held { object, tool_from_object, max_tilt_rad: std::f64::consts::PI };
        let mode = state.mode.attached(held, 0.5 * state.mode.gap_m())?;
        Some(State { mode, ..state })
    };
    engaged(m).prop_filter_map("an object that can be held", closes)
}

/// At rest, with something in the hand, or beside something.
pub fn any_mode<M: Manipulator>(m: &Tabletop<M>) -> impl Strategy<Value = TabletopState<M>> + Clone + '_ {
    let (resting, holding, engaged) = (resting(m), holding(m), engaged(m));
    // A union of three types: chosen by number, so that a failing case shrinks towards rest.
    (0..3_u8, resting, holding, engaged).prop_map(|(kind, resting, holding, engaged)| match kind {
        0 => resting,
        1 => holding,
        _ => engaged,
    })
}

fn standing<M: Manipulator>(m: &Tabletop<M>, robot: Configuration<M::Joints>, seed: u64) -> Option<TabletopState<M>> {
    let mut rng = stream(seed, 0, 0, Purpose::Sample);
    let mut places = Vec::new();
    let mut surfaces = Vec::new();
    for (space, movable) in m.objects().iter().zip(m.movables()) {
        let id = *movable.surfaces.get(rng.random_range(0..movable.surfaces.len().max(1)))?;
        let surface = m.surface(id)?;
        let at: Point2<f64> = surface.sample(&mut rng, 0.0)?;
        let pose = space.standing(surface, &at, rng.random_range(-3.0..3.0));
        if !space.contains(&pose) {
            return None;
        }
        places.push(pose);
        surfaces.push(id);
    }
    let mode = Mode::resting(surfaces, m.settings().travel_gap_m);
    Some(State { robot, objects: places.into_iter().collect(), mode })
}

fn held<M: Manipulator>(m: &Tabletop<M>, state: &TabletopState<M>, seed: u64) -> Option<TabletopState<M>> {
    let mut rng = stream(seed, 0, 0, Purpose::Sample);
    let graspable: Vec<_> =
        (0..m.movables().len()).filter(|i| m.movables().get(*i).is_some_and(can_be_grasped)).collect();
    let index = *graspable.get(rng.random_range(0..graspable.len().max(1)))?;
    let movable = m.movables().get(index)?;
    let family = movable.grasps.get(rng.random_range(0..movable.grasps.len()))?;
    let grasp = family.sample(&mut rng);
    let max_tilt_rad = m.hold(state.mode.hand(), movable, &**family, &grasp).ok()?.max_tilt_rad;
    let held = Held { object: ObjectId::new(index), tool_from_object: grasp.object_from_tool.inverse(), max_tilt_rad };
    let mut state = state.clone();
    state.mode = state.mode.attached(held, grasp.closed_gap_m)?;
    *state.objects.get_mut(index)? = m.manipulator().world_from_tool(&state.robot) * held.tool_from_object;
    m.objects().get(index)?.contains(state.objects.get(index)?).then_some(state)
}

fn can_be_grasped(movable: &crate::tabletop::Movable) -> bool {
    !movable.grasps.is_empty()
}

fn beside<M: Manipulator>(m: &Tabletop<M>, state: &TabletopState<M>, seed: u64) -> Option<TabletopState<M>> {
    let mut rng = stream(seed, 0, 0, Purpose::Sample);
    let index = rng.random_range(0..m.movables().len().max(1));
    let movable = m.movables().get(index).filter(|movable| can_be_grasped(movable))?;
    let grasp = movable.grasps.get(rng.random_range(0..movable.grasps.len()))?.sample(&mut rng);
    let tool = grasp.world_from_tool(state.objects.get(index)?);
    let robot = m.manipulator();
    let reached = (0..BASE_TRIES).find_map(|_| {
        let base = robot.base_for(&tool, &mut rng);
        let q = Configuration { base, arm: robot.inverse(&base, &tool, &mut rng)? };
        m.robot().contains(&q).then_some(q)
    })?;
    let mode = state.mode.opened_to(grasp.open_gap_m)?.engaged_with(ObjectId::new(index))?;
    Some(State { robot: reached, objects: state.objects.clone(), mode })
}
