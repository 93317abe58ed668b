//! Distances, samplers, goals and the search itself.

use darrt_core::budget::Budget;
use darrt_core::distance::{Distance, Euclidean, ExactTour, GreedyVisit};
use darrt_core::laws::nearest::tree_of;
use darrt_core::laws::{
    check_distance, check_goal, check_nearest, check_not_above, check_planner, check_sampler, check_sampler_covers,
};
use darrt_core::solve::SolveOptions;
use darrt_core::testing::strategies::{config, seeds, targets};
use darrt_pr2::World;
use darrt_primitives::testing::strategies::{any_mode, resting};
use darrt_task::planning::{PlanRequest, strategy};
use darrt_task::problem_file::SamplerName;
use proptest::prelude::*;

use crate::laws::support::{PROBLEMS, file, problem};

const REGRESSIONS: Option<&str> = Some("tests/regressions/laws_search.txt");

#[test]
fn distances_keep_their_laws() {
    let all = [&Euclidean as &dyn Distance<World>, &GreedyVisit, &ExactTour];
    for name in PROBLEMS {
        let problem = problem(name);
        let m = problem.domain();
        let s = any_mode(m);
        proptest!(config(32, REGRESSIONS), |(to in targets(m), here in s.clone(), there in s)| {
            for distance in all {
                check_distance(m, distance, &here, &to, &there)?;
                check_distance(m, distance, &to.overlay(m, &here), &to, &there)?;
            }
            check_not_above(m, &ExactTour, &GreedyVisit, &here, &to)?;
        });
    }
}

#[test]
fn the_nearest_node_is_the_nearest() {
    let all = [&Euclidean as &dyn Distance<World>, &GreedyVisit, &ExactTour];
    let problem = problem("plate3");
    let m = problem.domain();
    let many = proptest::collection::vec(any_mode(m), 0..12);
    proptest!(config(12, REGRESSIONS), |(to in targets(m), others in many)| {
        let tree = tree_of(problem.domain(), problem.start(), others.iter().chain(&others).cloned());
        for distance in all {
            check_nearest(m, distance, &tree, &to)?;
        }
    });
}

#[test]
fn samplers_keep_their_laws() {
    for name in PROBLEMS {
        let problem = problem(name);
        for sampler in [SamplerName::ROBOT_OR_OBJECTS, SamplerName::RANDOM_SUBSET, SamplerName::FULL] {
            let strategy = strategy(
                &darrt_pr2::registry(),
                &PlanRequest { sampler: Some(sampler), ..PlanRequest::new(file(name), 0) },
            )
            .unwrap();
            let (m, sampler) = (problem.domain(), &*strategy.sampler);
            proptest!(config(32, REGRESSIONS), |(seed in seeds())| {
                check_sampler(m, sampler, problem.goal(), seed)?;
            });
            check_sampler_covers(m, sampler, problem.goal(), 300, 1).unwrap_or_else(|broken| panic!("{broken}"));
        }
    }
}

/// A goal that asks for something in the hand, or let go, is satisfied only in such a mode: the samples of these goals
/// are asked from states at rest.
#[test]
fn goals_keep_their_laws() {
    for name in PROBLEMS {
        let problem = problem(name);
        let m = problem.domain();
        proptest!(config(64, REGRESSIONS), |(from in resting(m), seed in seeds())| {
            check_goal(m, problem.goal(), &from, seed)?;
        });
    }
}

#[test]
fn the_search_keeps_its_laws() {
    for name in ["simple-plate", "plate3"] {
        let problem = problem(name);
        let strategy = strategy(&darrt_pr2::registry(), &PlanRequest::new(file(name), 0)).unwrap();
        proptest!(config(1, REGRESSIONS), |(seed in seeds(), restart in prop::option::of(8_u64..12))| {
            let budget = Budget { iterations: Some(16), ..Budget::default() };
            let options = SolveOptions { seed, budget, restart_iterations: restart, threads: 1 };
            check_planner(&problem, &strategy, &options).map_err(|broken| broken.of(name))?;
        });
    }
}
