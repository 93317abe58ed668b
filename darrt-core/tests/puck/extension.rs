//! EXTENDTOWARDS keeps the valid prefix and every state on the way.

use std::sync::Arc;

use darrt_core::extend::{ExtendOptions, extend_towards};
use darrt_core::motion::Instance;
use darrt_core::partial::PartialState;
use darrt_core::problem::Problem;
use darrt_core::state::{ComponentSet, State};
use darrt_core::testing::puck::PuckWorld;
use darrt_core::validity::{Blame, FreePrefix, Validity};

use super::support::{World, id, rng, small};

fn walled() -> Problem<World> {
    small().wall("wall", [2.0, 0.0], [2.1, 2.0]).puck_goal(0, [1.5, 1.5]).problem().unwrap()
}

#[test]
fn a_blocked_extension_keeps_all_states_up_to_the_wall() {
    let problem = walled();
    let m = problem.domain();
    let target = PartialState::anywhere(m).with_object(id(0), [2.5, 1.0]);
    let options = ExtendOptions { spacing_m: 0.05, ..ExtendOptions::default() };
    let e = extend_towards(&problem, &options, problem.start(), &target, &mut rng(0));
    assert!(!e.is_met);
    let labels: Vec<_> = e.reached.iter().map(|r| r.instance.primitive.name()).collect();
    assert_eq!(labels.iter().filter(|l| **l == "Transit").count(), 5, "0.23 m in steps of 0.05 m: {labels:?}");
    assert!(labels.windows(2).all(|w| w[0] == w[1] || w == ["Transit", "Push"]));
    let mut before = problem.start().clone();
    for reached in &e.reached {
        assert_eq!(reached.state, reached.instance.at(m, reached.t, problem.start()));
        assert_eq!(problem.validity().check(m, &reached.state, &reached.instance.contacts), Ok(()));
        let step = (reached.state.robot[0] - before.robot[0]).hypot(reached.state.robot[1] - before.robot[1]);
        assert!(step > 0.0 && step <= 0.05 + 1e-12, "{step}");
        before = reached.state.clone();
    }
    let gap = 2.0 - (before.objects[0][0] + 0.12);
    assert!((0.0009..0.003).contains(&gap), "the puck ends {gap} m from the wall");
}

#[test]
fn an_extension_that_is_blocked_at_once_adds_nothing() {
    let problem = small().wall("wall", [0.652, 0.0], [0.7, 2.0]).puck_goal(0, [1.5, 1.0]).problem().unwrap();
    let target = PartialState::anywhere(problem.domain()).with_robot(problem.domain(), [0.51, 1.0]);
    let e = extend_towards(&problem, &ExtendOptions::default(), problem.start(), &target, &mut rng(0));
    assert!(!e.is_met && e.blame.is_some());
    assert!(e.reached.iter().all(|r| r.t > 0.0 && r.state.robot[0] > 0.5));
}

#[test]
fn a_target_that_is_met_needs_nothing() {
    let problem = walled();
    let target = PartialState::of_state(problem.domain(), problem.start());
    let e = extend_towards(&problem, &ExtendOptions::default(), problem.start(), &target, &mut rng(0));
    assert!(e.is_met && e.reached.is_empty());
}

/// Answers every motion with one and the same prefix.
struct Always(FreePrefix);

impl Validity<World> for Always {
    fn check(&self, _: &World, _: &State<World>, _: &ComponentSet) -> Result<(), Blame> {
        Ok(())
    }

    fn free_prefix(&self, _: &World, _: &Instance<PuckWorld>, _: &State<World>) -> FreePrefix {
        self.0.clone()
    }
}

/// A validity check that stops short without a reason, or answers nonsense, must not pass for success.
#[test]
fn a_prefix_without_blame_is_not_a_free_motion() {
    for (fraction, states) in [(0.5, 3), (0.0, 0), (f64::NAN, 0), (-1.0, 0)] {
        let mut parts = small().puck_goal(0, [1.5, 1.5]).parts().unwrap();
        parts.validity = Box::new(Always(FreePrefix { fraction, blame: None }));
        let problem = Problem::new(parts).unwrap();
        let target = PartialState::anywhere(problem.domain()).with_robot(problem.domain(), [0.5, 0.5]);
        let e = extend_towards(&problem, &ExtendOptions::default(), problem.start(), &target, &mut rng(0));
        assert!(!e.is_met, "{fraction}");
        assert_eq!(e.reached.len(), states, "{fraction}");
        assert_eq!(e.blame.unwrap().to_string(), "not valid: motion and unexplained block at (0.000, 0.000, 0.000)");
    }
}

/// Rounding must not shift the end: what was found free ends there, bit for bit.
#[test]
fn the_last_state_lies_exactly_where_the_free_part_ends() {
    for fraction in [0.1, 0.3, 0.55, 0.7, 0.9, 0.999] {
        let mut parts = small().puck_goal(0, [1.5, 1.5]).parts().unwrap();
        parts.validity = Box::new(Always(FreePrefix { fraction, blame: None }));
        let problem = Problem::new(parts).unwrap();
        let target = PartialState::anywhere(problem.domain()).with_robot(problem.domain(), [0.5, 0.3]);
        for spacing_m in [0.01, 0.03, 0.07] {
            let options = ExtendOptions { spacing_m, ..ExtendOptions::default() };
            let e = extend_towards(&problem, &options, problem.start(), &target, &mut rng(0));
            assert_eq!(e.reached.last().unwrap().t, fraction);
            assert_eq!(e.reached.len() as f64, (0.7 * fraction / spacing_m).ceil());
        }
    }
}

#[test]
fn one_step_is_not_longer_than_the_spacing() {
    let problem = small().puck_goal(0, [1.5, 1.5]).problem().unwrap();
    let target = PartialState::anywhere(problem.domain()).with_robot(problem.domain(), [0.5, 0.5]);
    for (spacing_m, states) in [(0.6, 1), (0.5, 1), (0.3, 2), (0.2, 3)] {
        let options = ExtendOptions { spacing_m, ..ExtendOptions::default() };
        let e = extend_towards(&problem, &options, problem.start(), &target, &mut rng(0));
        assert_eq!(e.reached.len(), states, "{spacing_m}");
    }
}

#[test]
fn spacings_out_of_range_are_named_and_do_no_harm() {
    let problem = small().puck_goal(0, [1.5, 1.5]).problem().unwrap();
    let target = PartialState::anywhere(problem.domain()).with_robot(problem.domain(), [0.5, 0.5]);
    for (spacing_m, states) in [(0.0, 10_000), (-1.0, 1), (f64::NAN, 1), (f64::INFINITY, 1), (1e-300, 10_000)] {
        let options = ExtendOptions { spacing_m, ..ExtendOptions::default() };
        let e = extend_towards(&problem, &options, problem.start(), &target, &mut rng(0));
        assert_eq!(e.reached.len(), states, "{spacing_m}");
        assert_eq!(e.reached.last().unwrap().state.robot, [0.5, 0.5]);
        assert_eq!(options.check().is_err(), spacing_m != 1e-300, "{spacing_m}");
    }
    assert!(ExtendOptions { max_depth: 1, ..ExtendOptions::default() }.check().is_ok());
    let no_depth = ExtendOptions { max_depth: 0, ..ExtendOptions::default() };
    assert_eq!(no_depth.check().unwrap_err().to_string(), "max_depth is 0, but must be at least 1");
}

#[test]
fn all_states_of_one_instance_share_it() {
    let problem = small().puck_goal(0, [1.5, 1.5]).problem().unwrap();
    let target = PartialState::anywhere(problem.domain()).with_robot(problem.domain(), [0.5, 0.3]);
    let e = extend_towards(&problem, &ExtendOptions::default(), problem.start(), &target, &mut rng(0));
    assert_eq!(e.reached.len(), 7);
    assert!(e.reached.iter().all(|r| Arc::ptr_eq(&r.instance, &e.reached[0].instance)));
}
