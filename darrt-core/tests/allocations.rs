//! Heap allocations on the way of an extension: their number does not grow with the number of discretised states. Up to two
//! objects, whose configurations a state holds inline.
#![cfg(feature = "testing")]
#![allow(clippy::unwrap_used, reason = "a test says no more than that it failed")]

use allocation_counter::measure;
use darrt_core::extend::{ExtendOptions, extend_towards};
use darrt_core::partial::PartialState;
use darrt_core::random::{Purpose, stream};
use darrt_core::state::ObjectId;
use darrt_core::testing::puck::{PuckWorld, Setup, problems};

/// An extension that pushes puck 0 across the floor: how many states it reached, and how often it allocated.
fn extension(setup: fn() -> problems::Ready, spacing_m: f64) -> (usize, u64) {
    let problem = setup().unwrap();
    let to = PartialState::<PuckWorld>::anywhere(problem.domain()).with_object(ObjectId::new(0), [3.5, 1.5]);
    let options = ExtendOptions { spacing_m, ..ExtendOptions::default() };
    let mut reached = 0;
    let info = measure(|| {
        let rng = &mut stream(1, 0, 0, Purpose::Extend);
        reached = extend_towards(&problem, &options, problem.start(), &to, rng).reached.len();
    });
    (reached, info.count_total)
}

#[test]
fn an_extension_allocates_as_often_for_ten_states_as_for_a_thousand() {
    for setup in [problems::open, problems::two_pucks] {
        let (few, often) = extension(setup, 0.5);
        let (many, as_often) = extension(setup, 0.002);
        assert!(few > 2 && many > 100 * few, "{few} and {many} states");
        assert_eq!(often, as_often, "{few} and {many} states");
    }
}

#[test]
fn a_motion_is_evaluated_and_checked_without_allocating() {
    let setup = || Setup::new([4.0, 3.0], 0.15).robot_at([0.5, 1.5]).puck("red", 0.12, [1.0, 1.5]);
    let problem = setup().wall("wall", [0.0, 0.0], [4.0, 0.2]).problem().unwrap();
    let m = problem.domain();
    let to = PartialState::anywhere(m).with_object(ObjectId::new(0), [3.5, 1.5]);
    let rng = &mut stream(1, 0, 0, Purpose::Extend);
    let extension = extend_towards(&problem, &ExtendOptions::default(), problem.start(), &to, rng);
    let push = &extension.reached.last().unwrap().instance;
    let start = push.at(m, 0.0, problem.start());
    let mut state = start.clone();
    let evaluated = measure(|| (0..1000).for_each(|i| push.motion.at_into(m, f64::from(i) / 1000.0, &mut state)));
    let checked = measure(|| assert!(problem.validity().free_prefix(m, push, &start).blame.is_none()));
    assert_eq!((evaluated.count_total, checked.count_total), (0, 0));
}
