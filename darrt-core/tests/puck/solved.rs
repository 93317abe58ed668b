//! Every ready problem is solved by every sampler and distance that can solve it.

use darrt_core::budget::Stop;
use darrt_core::distance::{Euclidean, ExactTour, GreedyVisit};
use darrt_core::observe::Silent;
use darrt_core::sample::{Full, RandomSubset};
use darrt_core::search::Strategy;
use darrt_core::solve::solve;
use darrt_core::testing::puck::problems;

use super::support::{World, greedy, options, robot_or_objects, strategy};

fn all_solved(strategy: &Strategy<World>, seeds: std::ops::Range<u64>, iterations: u64, but: &[&str]) {
    for (name, make) in problems::ALL.into_iter().filter(|(name, _)| !but.contains(name)) {
        let problem = make().unwrap();
        for seed in seeds.clone() {
            let outcome = solve(&problem, strategy, &options(seed, iterations), &mut Silent);
            assert_eq!(outcome.stop, Stop::Solved, "{name} seed {seed}: {:?}", outcome.accounts);
            assert!(outcome.accounts.are_balanced(), "{name} seed {seed}");
            assert_eq!(outcome.accounts.refused, 0, "{name} seed {seed}: {:?}", outcome.last_refusal);
            let m = problem.domain();
            let end = outcome.solution.unwrap().plan().end(m);
            assert!(problem.goal().is_satisfied(m, &end), "{name} seed {seed}: {end:?}");
        }
    }
}

#[test]
fn robot_or_objects_with_the_greedy_tour() {
    all_solved(&greedy(robot_or_objects()), 0..4, 2000, &[]);
}

#[test]
fn random_subsets_with_the_greedy_tour() {
    all_solved(&greedy(RandomSubset), 0..2, 3000, &[]);
}

#[test]
fn robot_or_objects_with_the_exact_tour() {
    all_solved(&strategy(robot_or_objects(), ExactTour), 0..2, 3000, &[]);
}

/// Without the robot's way in it, the distance to a target for objects is the same at every node that has
/// not moved them: the first node always wins, and a robot that must walk first never gets its chance.
#[test]
fn the_euclidean_distance_solves_what_needs_no_walk_before_the_push() {
    let euclidean = strategy(robot_or_objects(), Euclidean);
    all_solved(&euclidean, 0..2, 3000, &["fig3"]);
    let outcome = solve(&problems::fig3().unwrap(), &euclidean, &options(0, 800), &mut Silent);
    assert_eq!(outcome.stop, Stop::IterationLimit);
}

/// Figure 3a: a sample of everything sends the robot straight for the plate, into the wall, every time.
#[test]
fn figure_3_is_not_solved_by_full_samples_but_by_partial_ones() {
    let problem = problems::fig3().unwrap();
    let never = solve(&problem, &greedy(Full), &options(1, 1500), &mut Silent);
    assert_eq!(never.stop, Stop::IterationLimit);
    let blocks = never.accounts.worst_blocks(9);
    assert_eq!(blocks.len(), 1, "only ever the robot against the wall: {blocks:?}");
    assert_eq!((blocks[0].0.0.as_str(), blocks[0].0.1.as_str()), ("robot", "wall"));
    for seed in 0..10 {
        let soon = solve(&problem, &strategy(robot_or_objects(), GreedyVisit), &options(seed, 1000), &mut Silent);
        assert_eq!(soon.stop, Stop::Solved, "seed {seed}");
    }
}

/// Also with eight objects to be moved, and with eight that are in the way of some.
#[test]
fn one_to_eight_pucks_change_to_the_other_side() {
    for (count, moved) in (1..=8).map(|n| (n, n)).chain([(8, 1), (8, 3)]) {
        let problem = problems::many_pucks(count, moved).unwrap();
        for seed in 0..3 {
            let outcome = solve(&problem, &greedy(robot_or_objects()), &options(seed, 6000), &mut Silent);
            assert_eq!(outcome.stop, Stop::Solved, "{moved} of {count}, seed {seed}");
            assert!(outcome.accounts.are_balanced(), "{moved} of {count}, seed {seed}");
            let (m, start) = (problem.domain(), problem.start());
            let end = outcome.solution.unwrap().plan().end(m);
            let is_over = |i: &usize| end.objects[*i] != start.objects[*i];
            assert!((0..usize::from(moved)).all(|i| is_over(&i)), "{moved} of {count}, seed {seed}: {end:?}");
        }
    }
    assert!(problems::many_pucks(9, 1).is_err(), "there is room for eight");
}
