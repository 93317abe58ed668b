//! Sequences of picks, places, pushes and retreats at the table: what is where, against a plain model of it. Every
//! instance on the way keeps the laws of table-top instances.
#![cfg(feature = "testing")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test says no more than that it failed")]

use darrt_core::primitive::{Infeasible, Instances};
use darrt_core::random::{Purpose, Stream, stream};
use darrt_core::state::ObjectId;
use darrt_core::testing::strategies::config;
use darrt_primitives::action::{Chain, pick::pick, place::place, push::push, retreat::retreat};
use darrt_primitives::laws::{TabletopClaims, check_tabletop};
use darrt_primitives::mode::SurfaceId;
use darrt_primitives::object_space::upright;
use darrt_primitives::testing::table::{Table, TableState, honest_table, start};
use nalgebra::{Isometry3, Vector3};
use proptest::prelude::*;
use proptest_state_machine::{ReferenceStateMachine, StateMachineTest, prop_state_machine};

/// Two tins that can be pushed, and a box.
const OBJECTS: usize = 3;
/// How often an action is tried before it counts as impossible.
const SEEDS: u64 = 24;
/// How far an object may be from where the model has it, metres.
const NEAR_M: f64 = 1e-6;

/// Where everything is.
#[derive(Debug, Clone)]
struct Model {
    /// Surface and place of every object that rests.
    rests: [Option<(usize, [f64; 2])>; OBJECTS],
    held: Option<usize>,
    engaged: Option<usize>,
    was_legal: bool,
}

/// What is asked for; often it is not possible.
#[derive(Debug, Clone)]
enum Step {
    Pick { object: usize },
    Place { surface: usize, at: [f64; 2] },
    Push { object: usize, at: [f64; 2] },
    Retreat,
}

/// Where a wish for `object` lies: across from the middle of the surface, along from the middle of the object's own lane.
/// In lanes no object and no hand comes into the way of another, so the model need not know their shapes.
fn spot(object: usize, surface: usize, [across, along]: [f64; 2]) -> [f64; 2] {
    [[-0.5, 0.5][surface] + across, [-0.3, 0.3, 0.0][object] + along]
}

impl Model {
    fn after(&self, step: &Step) -> Option<Self> {
        let mut next = self.clone();
        match *step {
            Step::Pick { object } => {
                (self.held.is_none() && self.rests[object].is_some()).then_some(())?;
                (next.held, next.engaged, next.rests[object]) = (Some(object), None, None);
            }
            Step::Place { surface, at } => {
                let object = self.held?;
                // It lets go and retreats.
                (next.held, next.engaged, next.rests[object]) =
                    (None, None, Some((surface, spot(object, surface, at))));
            }
            Step::Push { object, at } => {
                // Only a tin is pushed, and only along its own surface.
                (self.held.is_none() && object != 2).then_some(())?;
                let (surface, _) = self.rests[object]?;
                next.rests[object] = Some((surface, spot(object, surface, at)));
                next.engaged = Some(object);
            }
            Step::Retreat => {
                self.engaged?;
                next.engaged = None;
            }
        }
        Some(next)
    }
}

impl ReferenceStateMachine for Model {
    type State = Self;
    type Transition = Step;

    fn init_state() -> BoxedStrategy<Self> {
        let rests = [[-0.6, -0.3], [-0.4, 0.3], [-0.5, 0.0]].map(|at| Some((0, at)));
        Just(Self { rests, held: None, engaged: None, was_legal: true }).boxed()
    }

    fn transitions(_: &Self) -> BoxedStrategy<Step> {
        let place = || [-0.25..0.25_f64, -0.06..0.06_f64];
        prop_oneof![
            3 => (0..OBJECTS).prop_map(|object| Step::Pick { object }),
            3 => (0..2_usize, place()).prop_map(|(surface, at)| Step::Place { surface, at }),
            3 => (0..OBJECTS, place()).prop_map(|(object, at)| Step::Push { object, at }),
            1 => Just(Step::Retreat),
        ]
        .boxed()
    }

    fn apply(state: Self, step: &Step) -> Self {
        match state.after(step) {
            Some(next) => Self { was_legal: true, ..next },
            None => Self { was_legal: false, ..state },
        }
    }
}

/// The table, and how it stands there.
struct Real {
    m: Table,
    state: TableState,
}

impl Real {
    fn act(&self, step: &Step, rng: &mut Stream) -> Result<Instances<Table>, Infeasible> {
        let (m, from) = (&self.m, &self.state);
        let standing = |[x, y]: [f64; 2], z: f64| upright(Vector3::new(x, y, z), 0.4);
        match *step {
            Step::Pick { object } => pick(m, from, ObjectId::new(object), rng),
            Step::Place { surface, at } => {
                let object = from.mode.held().map_or(0, |held| held.object.index());
                place(m, from, &standing(spot(object, surface, at), 0.73), rng)
            }
            Step::Push { object, at } => {
                let id = ObjectId::new(object);
                let surface = from.mode.support_of(id).map_or(0, SurfaceId::index);
                push(m, from, id, &standing(spot(object, surface, at), 0.74), rng)
            }
            Step::Retreat => {
                let mut chain = Chain::at(from);
                retreat(m, &mut chain, m.settings().retreat_m)?;
                chain.finish()
            }
        }
    }
}

impl StateMachineTest for Real {
    type SystemUnderTest = Self;
    type Reference = Model;

    fn init_test(_: &Model) -> Self {
        let m = honest_table().unwrap();
        let state = start(&m);
        Self { m, state }
    }

    fn apply(mut real: Self, model: &Model, step: Step) -> Self {
        let seeds = if model.was_legal { SEEDS } else { 2 };
        let found = (0..seeds).find_map(|seed| real.act(&step, &mut stream(seed, 0, 0, Purpose::Extend)).ok());
        assert_eq!(found.is_some(), model.was_legal, "{step:?} from {:?}", real.state);
        if let Some(instances) = found {
            check_tabletop(&real.m, &instances, &real.state, &[0.2, 0.5, 0.8], &TabletopClaims::default())
                .unwrap_or_else(|broken| panic!("{broken}"));
            for instance in instances {
                real.state = instance.at(&real.m, 1.0, &real.state);
            }
        }
        real
    }

    fn check_invariants(real: &Self, model: &Model) {
        let mode = &real.state.mode;
        assert_eq!(mode.held().map(|held| held.object.index()), model.held);
        assert_eq!(mode.engaged().map(ObjectId::index), model.engaged);
        for (i, rests) in model.rests.iter().enumerate() {
            let pose: &Isometry3<f64> = &real.state.objects[i];
            assert_eq!(mode.support_of(ObjectId::new(i)).map(SurfaceId::index), rests.map(|(surface, _)| surface));
            if let Some((_, [x, y])) = rests {
                let off = (pose.translation.x - x).hypot(pose.translation.y - y);
                assert!(off < NEAR_M, "object {i} is {off} m from where it should be");
            }
        }
    }
}

/// The red tin is pushed towards the box, and beyond it: the box is no matter of the model's lanes.
#[test]
fn a_push_stops_before_another_object() {
    let m = honest_table().unwrap();
    let state = start(&m);
    let red = ObjectId::new(0);
    let beyond = upright(Vector3::new(-0.45, 0.2, 0.74), 0.0);
    let found =
        (0..SEEDS).find_map(|seed| push(&m, &state, red, &beyond, &mut stream(seed, 0, 0, Purpose::Extend)).ok());
    let instances = found.unwrap();
    check_tabletop(&m, &instances, &state, &[0.2, 0.5, 0.8], &TabletopClaims::default()).unwrap();
    let end = instances.iter().fold(state.clone(), |at, instance| instance.at(&m, 1.0, &at));
    let y = |state: &TableState, object: usize| state.objects[object].translation.y;
    assert!(y(&end, 0) > y(&state, 0) + 0.05, "it moves");
    // The tin has a radius of 0.04 m, the box is at least 0.025 m deep.
    assert!(y(&end, 0) < y(&state, 2) - 0.065, "it stops before the box, at {}", y(&end, 0));
    assert_eq!(end.objects[2], state.objects[2]);
}

prop_state_machine! {
    #![proptest_config(config(24, Some("tests/regressions/laws_sequences.txt")))]

    /// Any sequence of wishes, possible or not.
    #[test]
    fn picks_places_and_pushes_in_any_order(sequential 1..12 => Real);
}
