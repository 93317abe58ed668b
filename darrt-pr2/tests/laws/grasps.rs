//! The grasps of the built-in problems, with the PR2's hand.

use darrt_pr2::problems::{builtin_names, everyday_names, further_names};
use darrt_primitives::laws::check_grasps;
use darrt_primitives::manipulator::Manipulator;

#[test]
fn the_grasps_of_all_built_in_problems_keep_their_laws() {
    let mut families = 0;
    for name in builtin_names().into_iter().chain(further_names()).chain(everyday_names()) {
        let problem = super::support::problem(name);
        let m = problem.domain();
        for movable in m.movables() {
            for (family, seed) in movable.grasps.iter().zip(0..) {
                check_grasps(&**family, &movable.body, m.manipulator().hand(), seed)
                    .unwrap_or_else(|broken| panic!("{name}, {}: {broken}", movable.body.name));
                families += 1;
            }
        }
    }
    assert!(families > 10, "{families}");
}
