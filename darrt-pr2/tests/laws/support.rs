//! The problems of the paper, built.

use darrt_core::problem::Problem;
use darrt_core::state::State;
use darrt_geom::scene::FixedBody;
use darrt_pr2::problems::builtin;
use darrt_pr2::{World, WorldState};
use darrt_primitives::mode::Contacts;
use darrt_primitives::testing::strategies::any_mode;
use darrt_task::planning::prepare;
use darrt_task::problem_file::ProblemFile;
use darrt_task::world;
use proptest::prelude::*;

/// One problem with a plate, one with a bowl, one with everything.
pub(crate) const PROBLEMS: [&str; 3] = ["plate1", "bowl", "plate3"];

/// The file of an embedded problem.
pub(crate) fn file(name: &str) -> ProblemFile {
    builtin(name).unwrap()
}

/// An embedded problem, ready to be solved.
pub(crate) fn problem(name: &str) -> Problem<World> {
    prepare(&darrt_pr2::registry(), &file(name)).unwrap().problem
}

/// The fixed bodies of a problem.
pub(crate) fn obstacles(name: &str) -> Vec<FixedBody> {
    world::build(&darrt_pr2::registry(), &file(name)).unwrap().scene.bodies().to_vec()
}

/// States of every kind that the problem's own validity accepts.
pub(crate) fn valid_states(problem: &Problem<World>) -> impl Strategy<Value = WorldState> + Clone + '_ {
    let m = problem.domain();
    // Near the start nothing is in the way: half of the states begin there.
    let near = (any_mode(m), any::<bool>()).prop_map(move |(state, is_home)| {
        let is_free = state.mode.is_hand_free();
        if is_home && is_free { State { robot: problem.start().robot, ..state } } else { state }
    });
    near.prop_filter("a valid state", move |s| problem.validity().check(m, s, &Contacts::default()).is_ok())
}
