//! What the replaying verifier looks at, and how it names what is wrong.

use std::sync::{Arc, Mutex};

use darrt_core::goal::Reach;
use darrt_core::motion::{Instance, Motion};
use darrt_core::partial::PartialState;
use darrt_core::plan::{Plan, Step};
use darrt_core::state::{ComponentSet, State};
use darrt_core::validity::{AlwaysValid, Blame, FreePrefix, Validity};
use darrt_core::verify::{Refusal, Replay, Verifier};

use super::support::{World, robot_instance, small};

/// Accepts everything and notes where the robot was.
#[derive(Clone, Default)]
struct Noting(Arc<Mutex<Vec<f64>>>);

impl Validity<World> for Noting {
    fn check(&self, _: &World, state: &State<World>, _: &ComponentSet) -> Result<(), Blame> {
        self.0.lock().unwrap().push(state.robot[1]);
        Ok(())
    }

    fn free_prefix(&self, _: &World, _: &Instance<World>, _: &State<World>) -> FreePrefix {
        FreePrefix::FREE
    }
}

/// The states that are looked at when a robot step from y = 1 to y = 0, one metre, ends at `until`. The goal is where it ends.
fn looks(until: f64, spacing_m: f64) -> Vec<f64> {
    let problem = small().puck_goal(0, [2.0, 1.0]).problem().unwrap();
    let (m, start) = (problem.domain(), problem.start());
    let instance = robot_instance(start, &State { robot: [0.5, 0.0], ..start.clone() });
    let goal = Reach::new(PartialState::of_state(m, &instance.at(m, until, start)));
    let plan = Plan::new(start.clone(), vec![Step { instance: instance.into(), until, primitive: 0 }]);
    let noting = Noting::default();
    Replay::new(noting.clone(), spacing_m).verify(m, start, &goal, &plan).unwrap();
    noting.0.lock().unwrap().clone()
}

#[test]
fn a_step_is_looked_at_in_equal_parts_no_longer_than_the_spacing_up_to_its_end() {
    for (until, spacing_m, expected) in [
        (1.0, 0.25, vec![0.75, 0.5, 0.25, 0.0]),
        (0.5, 0.25, vec![0.75, 0.5]),
        (1.0, 0.4, vec![2.0 / 3.0, 1.0 / 3.0, 0.0]),
        (0.5, 2.0, vec![0.5]),
    ] {
        let found = looks(until, spacing_m);
        assert_eq!(found.len(), expected.len(), "{found:?}");
        assert!(found.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?}");
    }
}

/// A motion that lies about how long it is.
#[derive(Debug)]
struct Lying(Box<dyn Motion<World>>, f64);

impl Motion<World> for Lying {
    fn length(&self) -> f64 {
        self.1
    }

    fn at_into(&self, m: &World, t: f64, out: &mut State<World>) {
        self.0.at_into(m, t, out);
    }
}

/// What is said about a plan of one step, changed by `spoil`.
fn refusal(spoil: impl Fn(&mut Step<World>)) -> Refusal {
    let problem = small().puck_goal(0, [2.0, 1.0]).problem().unwrap();
    let (m, start) = (problem.domain(), problem.start());
    let instance = robot_instance(start, &State { robot: [0.5, 0.5], ..start.clone() });
    let mut step = Step { instance: instance.into(), until: 1.0, primitive: 0 };
    spoil(&mut step);
    let plan = Plan::new(start.clone(), vec![step]);
    Replay::new(AlwaysValid, 0.1).verify(m, start, problem.goal(), &plan).unwrap_err()
}

#[test]
fn a_length_that_is_none_is_refused() {
    for length in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1.0] {
        let why = refusal(|step| {
            let problem = small().puck_goal(0, [2.0, 1.0]).problem().unwrap();
            let instance = robot_instance(problem.start(), problem.start());
            step.instance = Instance { motion: Box::new(Lying(instance.motion, length)), ..instance }.into();
        });
        assert_eq!((why.step, why.at), (Some(0), 0.0));
        assert!(why.reason.contains("must be finite and not negative"), "{length}: {}", why.reason);
    }
}

#[test]
fn what_is_wrong_with_a_step_as_such_is_found_at_its_beginning() {
    let why = refusal(|step| step.until = 1.5);
    assert_eq!((why.step, why.at), (Some(0), 0.0), "{why}");
    let why = refusal(|step| {
        let problem = small().robot_at([0.6, 1.0]).puck_goal(0, [2.0, 1.0]).problem().unwrap();
        step.instance = robot_instance(problem.start(), problem.start()).into();
    });
    assert_eq!((why.step, why.at), (Some(0), 0.0), "{why}");
    // The step is right, but the plan as a whole does not end in the goal.
    let why = refusal(|_| ());
    assert_eq!((why.step, why.at), (None, 0.0), "{why}");
}
