//! The puck domain keeps every law: its primitives, its motions, its validity and the planner on it.
#![cfg(feature = "testing")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test says no more than that it failed")]

use std::cell::Cell;
use std::f64::consts::TAU;
use std::sync::Arc;

use darrt_core::budget::Budget;
use darrt_core::distance::ExactTour;
use darrt_core::laws::{
    PrimitiveClaims, Tried, ValidityClaims, check_against_oracle, check_contacts, check_enlarged, check_lower_bound,
    check_planner, check_validity, try_primitive,
};
use darrt_core::observe::Silent;
use darrt_core::partial::PartialState;
use darrt_core::primitive::Primitive;
use darrt_core::solve::{SolveOptions, solve};
use darrt_core::state::{ComponentSet, ObjectId, State};
use darrt_core::testing::puck::world::Grip;
use darrt_core::testing::puck::{
    Carry, Clearance, Mode, Obstacle, Oracle, Outline, Pick, Place, Puck, PuckWorld, Push, Transit, paper_strategy,
    problems,
};
use darrt_core::testing::strategies::{config, looks, seeds, states, tasks_from, valid_states};
use darrt_core::validity::Validity;
use proptest::prelude::*;

const REGRESSIONS: Option<&str> = Some("tests/regressions/laws_puck.txt");

fn world(count: usize) -> PuckWorld {
    let puck = |i| Puck { name: format!("puck {i}").into(), radius_m: 0.12, is_graspable: i != 1 };
    PuckWorld::new([4.0, 3.0], 0.15, (0..count).map(puck).collect()).unwrap()
}

fn obstacles(grow_m: f64) -> Vec<Obstacle> {
    let wall = Outline::Rectangle { lower: [1.9 - grow_m, 0.6 - grow_m], upper: [2.1 + grow_m, 2.0 + grow_m] };
    let pillar = Outline::Disc { centre: [3.0, 1.0], radius_m: 0.2 + grow_m };
    vec![Obstacle { name: "wall".into(), outline: wall }, Obstacle { name: "pillar".into(), outline: pillar }]
}

/// Nothing held, nothing touched.
fn resting<'a>(m: &'a PuckWorld, b: &'a Clearance) -> impl Strategy<Value = State<PuckWorld>> + Clone + 'a {
    valid_states(m, Mode::resting(m.pucks().len()), b)
}

/// Puck 0 held at its rim.
fn holding<'a>(m: &'a PuckWorld, b: &'a Clearance) -> impl Strategy<Value = State<PuckWorld>> + Clone + 'a {
    let accepts = move |state: &State<PuckWorld>| b.check(m, state, &ComponentSet::EMPTY).is_ok();
    let grasp = move |(mut state, angle): (State<PuckWorld>, f64)| {
        let reach = m.touch_distance(ObjectId::new(0));
        let offset = [reach * angle.cos(), reach * angle.sin()];
        state.mode = state.mode.with_grip(ObjectId::new(0), Grip::Held { offset });
        state.objects[0] = [state.robot[0] + offset[0], state.robot[1] + offset[1]];
        state
    };
    let poses = (states(m, Mode::resting(m.pucks().len())), 0.0..TAU).prop_map(grasp);
    poses.prop_filter("a valid state", accepts)
}

/// All laws of one primitive from all kinds of states; it must succeed now and then, or nothing is shown.
fn check_all(primitive: &dyn Primitive<PuckWorld>, truncates: bool) {
    let free = Clearance::new(Vec::new());
    let succeeded = Cell::new(0);
    for count in [1, 3] {
        let m = world(count);
        let starts = prop_oneof![resting(&m, &free), holding(&m, &free)];
        proptest!(config(128, REGRESSIONS), |((from, to, seed) in tasks_from(&m, starts), ts in looks())| {
            let claims = PrimitiveClaims { ts: &ts, truncates, max_instances: 4, ..PrimitiveClaims::default() };
            if let Tried::Propagated(instances) = try_primitive(&m, primitive, &from, &to, seed, &claims)? {
                succeeded.set(succeeded.get() + 1);
                check_contacts(&m, &free, &instances, &from, &ts)?;
                check_lower_bound(&m, &ExactTour, &from, &to, &instances)?;
            }
        });
    }
    assert!(succeeded.get() >= 5, "{} succeeded {} times only", primitive.name(), succeeded.get());
}

#[test]
fn transit() {
    check_all(&Transit, true);
}

#[test]
fn push() {
    check_all(&Push, false);
}

#[test]
fn pick() {
    check_all(&Pick, false);
}

#[test]
fn carry() {
    check_all(&Carry, true);
}

#[test]
fn place() {
    check_all(&Place, false);
}

#[test]
fn clearance_keeps_the_laws_of_validity_and_is_never_laxer_than_the_oracle() {
    let m = world(3);
    let (clearance, oracle) = (Clearance::new(obstacles(0.0)), Oracle::new(obstacles(0.0)));
    let starts = prop_oneof![resting(&m, &clearance), holding(&m, &clearance)];
    let primitives: [&dyn Primitive<PuckWorld>; 5] = [&Transit, &Push, &Pick, &Carry, &Place];
    let blocked = Cell::new(0);
    proptest!(config(96, REGRESSIONS), |((from, to, seed) in tasks_from(&m, starts))| {
        for primitive in primitives {
            let Tried::Propagated(instances) =
                try_primitive(&m, primitive, &from, &to, seed, &PrimitiveClaims::default())? else { continue };
            let mut at = from.clone();
            for instance in instances {
                check_against_oracle(&m, &clearance, &oracle, &instance, &at, 200)?;
                let end = instance.at(&m, 1.0, &at);
                let instance = Arc::new(instance);
                check_validity(&m, &clearance, &instance, &at, &ValidityClaims::default(), seed)?;
                let is_blocked = clearance.free_prefix(&m, &instance, &at).blame.is_some();
                blocked.set(blocked.get() + u32::from(is_blocked));
                at = end;
            }
        }
    });
    assert!(blocked.get() >= 5, "{}", blocked.get());
}

/// Found by the laws: the advancement knew the obstacles but not the edge of the floor, and stepped over a
/// corner of the way that lies outside.
#[test]
fn a_detour_over_the_edge_of_the_floor_is_blocked_where_it_leaves() {
    let m = world(3);
    let clearance = Clearance::new(Vec::new());
    let objects = [[2.234, 1.326], [0.86, 2.548], [1.757, 1.66]].into_iter().collect();
    let from = State { robot: [3.553, 2.024], objects, mode: Mode::resting(3) };
    let to = PartialState::anywhere(&m).with_object(ObjectId::new(1), [1.5, 2.397]);
    let tried = try_primitive(&m, &Push, &from, &to, 0, &PrimitiveClaims::default()).unwrap();
    let Tried::Propagated(instances) = tried else { panic!("{tried:?}") };
    let approach = Arc::new(instances.into_iter().next().unwrap());
    let leaves = (0..=1000).any(|i| approach.at(&m, f64::from(i) / 1000.0, &from).robot[1] > 2.85);
    assert!(leaves, "the case is to lead off the floor");
    assert!(clearance.free_prefix(&m, &approach, &from).blame.is_some());
    check_validity(&m, &clearance, &approach, &from, &ValidityClaims::default(), 0).unwrap();
}

#[test]
fn larger_obstacles_forbid_more() {
    let m = world(2);
    proptest!(config(128, REGRESSIONS), |(state in states(&m, Mode::resting(2)), grow in 0.0..0.5)| {
        let contacts = ComponentSet::EMPTY;
        let (small, large) = (Clearance::new(obstacles(0.0)), Clearance::new(obstacles(grow)));
        check_enlarged(&m, &small, &large, &state, &contacts)?;
        check_enlarged(&m, &Oracle::new(obstacles(0.0)), &Oracle::new(obstacles(grow)), &state, &contacts)?;
        check_enlarged(&m, &Oracle::new(obstacles(0.0)), &small, &state, &contacts)?;
    });
}

#[test]
fn planning_keeps_its_laws_on_every_ready_problem() {
    let strategy = paper_strategy().unwrap();
    for (name, problem) in problems::ALL {
        let problem = problem().unwrap();
        proptest!(config(2, REGRESSIONS), |(seed in seeds(), restart in prop::option::of(10_u64..30), full in any::<bool>())| {
            let nodes = full.then_some(40);
            let budget = Budget { iterations: Some(30), nodes, ..Budget::default() };
            let options = SolveOptions { seed, budget, restart_iterations: restart, threads: 1 };
            check_planner(&problem, &strategy, &options).map_err(|broken| broken.of(name))?;
        });
    }
    // And one that is solved for sure.
    let open = problems::open().unwrap();
    let options = SolveOptions { seed: 1, ..SolveOptions::default() };
    let budget = Budget { iterations: Some(2000), ..Budget::default() };
    check_planner(&open, &strategy, &SolveOptions { budget: budget.clone(), ..options.clone() }).unwrap();
    assert!(solve(&open, &strategy, &SolveOptions { budget, ..options }, &mut Silent).solution.is_some());
}
