//! The bounds of the PR2's domain are bounds, and the nearest node is that of the linear scan.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test says no more than that it failed")]

use darrt_benches::room::prepared;
use darrt_benches::trees;
use darrt_core::distance::{Distance, Euclidean, ExactTour, GreedyVisit};
use darrt_core::laws::domain::{POINT, REACH_AT_LEAST};
use darrt_core::laws::space::{COORDINATES, COORDINATES_ALIKE};
use darrt_core::laws::{SpaceClaims, check_domain, check_nearest};
use darrt_core::tree::Tree;
use darrt_core::variants::Weighted;
use darrt_pr2::World;

fn tree() -> Tree<World> {
    let (prepared, _) = prepared();
    let problem = &prepared.problem;
    let mut tree = trees::random(problem.domain(), problem.start(), 3_000);
    let ids: Vec<_> = tree.iter().map(|(id, _)| id).collect();
    for id in ids.iter().step_by(7) {
        tree.penalise(*id, 0.1);
    }
    tree
}

#[test]
fn points_reach_and_shadows_bound_from_below() {
    let (prepared, _) = prepared();
    let tree = tree();
    let states: Vec<_> = tree.iter().map(|(_, node)| &node.state).collect();
    for (i, three) in (0..).zip(states.chunks_exact(3)) {
        let [a, b, c] = three else { continue };
        let checked = check_domain(prepared.problem.domain(), &SpaceClaims::default(), [a, b, c], [0.3, 0.7], i);
        // The other laws have tests of their own.
        let laws = [POINT, REACH_AT_LEAST, COORDINATES, COORDINATES_ALIKE];
        if let Some(broken) = checked.err().filter(|broken| laws.contains(&broken.law)) {
            panic!("{broken}");
        }
    }
}

#[test]
fn the_nearest_node_is_that_of_the_linear_scan() {
    let (prepared, strategy) = prepared();
    let problem = &prepared.problem;
    let tree = tree();
    let maximum = Weighted::maximum(1.0, 1.0).unwrap();
    for to in trees::targets(problem, &strategy, 60) {
        for distance in [&GreedyVisit as &dyn Distance<World>, &ExactTour, &Euclidean, &maximum] {
            check_nearest(problem.domain(), distance, &tree, &to).unwrap();
        }
    }
}
