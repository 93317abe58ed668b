//! One call checks everything of a problem.

use darrt_core::laws::everything::Effort;
use darrt_core::laws::{Report, SpaceClaims, Subjects, ValidityClaims, check_everything};
use darrt_core::partial::PartialState;
use darrt_core::validity::Validity as _;
use darrt_pr2::{World, WorldState};
use darrt_primitives::laws::body_travel;
use darrt_primitives::mode::Contacts;
use darrt_primitives::testing::scene_oracle::SceneOracle;
use darrt_task::planning::{PlanRequest, strategy};

use crate::laws::support::{file, obstacles, problem};

/// What is lifted may go away from its target, and what is let go where it was held moves nothing.
fn is_excused(m: &World, from: &WorldState, to: &PartialState<World>, end: &WorldState) -> bool {
    let lifts = from.mode.held().is_none() && end.mode.held().is_some();
    let was_met = from.mode.held().is_some_and(|held| to.is_object_met(m, from, held.object));
    lifts || (was_met && end.mode.held().is_none() && to.are_objects_met(m, end))
}

#[test]
fn everything_of_a_problem_keeps_its_laws() -> Result<(), Box<Report>> {
    let name = "simple-plate";
    let problem = problem(name);
    let oracle = SceneOracle::new(&obstacles(name));
    // Places on tables are drawn on purpose; turns of a plate about its own axis are free.
    let spaces = SpaceClaims { hears_all: false, ..SpaceClaims::default() };
    let validity = ValidityClaims { tight_m: 0.21, same_names: false, between: 8, anywhere: 1 };
    let effort = Effort { cases: 24, calls: 200, iterations: 12, ..Effort::default() };
    let subjects = Subjects::of(&problem)
        .strategy(strategy(&darrt_pr2::registry(), &PlanRequest::new(file(name), 0)).unwrap())
        .oracle(move |m, state| oracle.check(m, state, &Contacts::default()).is_ok())
        .excuse(is_excused)
        .travel(body_travel)
        .spaces(spaces)
        .samples_in_part()
        .validity_claims(validity)
        .effort(effort);
    println!("{}", check_everything(problem.shared_domain(), subjects)?);
    Ok(())
}
