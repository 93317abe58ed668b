//! A plan that was found is made shorter, as long as somebody waits for it.

use std::sync::atomic::{AtomicU64, Ordering};

use darrt_core::budget::{Cancel, Stop};
use darrt_core::goal::Goal;
use darrt_core::observe::Silent;
use darrt_core::plan::Plan;
use darrt_core::problem::Problem;
use darrt_core::search::Strategy;
use darrt_core::shorten::ShortenOptions;
use darrt_core::solve::{SolveOptions, solve};
use darrt_core::state::State;
use darrt_core::testing::puck::{paper_strategy, problems};
use darrt_core::verify::{Refusal, Verifier};

use super::support::{World, options, small};

fn shortening(extensions: usize) -> Strategy<World> {
    Strategy { shorten: ShortenOptions { extensions }, ..paper_strategy().unwrap() }
}

#[test]
fn a_shortened_plan_never_has_more_steps_and_some_have_fewer() {
    let problem = problems::two_pucks().unwrap();
    let steps = |extensions, seed| {
        let outcome = solve(&problem, &shortening(extensions), &options(seed, 5000), &mut Silent);
        // Solved means verified: a short plan that is wrong would not be one.
        outcome.solution.unwrap().plan().steps().len()
    };
    let pairs: Vec<_> = (0..8).map(|seed| (steps(0, seed), steps(2000, seed))).collect();
    assert!(pairs.iter().all(|(found, short)| short <= found), "{pairs:?}");
    assert!(pairs.iter().any(|(found, short)| short < found), "{pairs:?}");
}

/// Cancels while it judges, and gives up. Counts the plans it is shown.
struct Cancelling {
    cancel: Cancel,
    shown: std::sync::Arc<AtomicU64>,
}

impl Verifier<World> for Cancelling {
    fn verify(&self, _: &World, _: &State<World>, _: &dyn Goal<World>, _: &Plan<World>) -> Result<(), Refusal> {
        self.shown.fetch_add(1, Ordering::SeqCst);
        self.cancel.cancel();
        Err(Refusal { step: None, at: 0.0, reason: "nobody waits".to_owned() })
    }
}

#[test]
fn a_verifier_cancelled_at_work_is_asked_no_more_and_its_answer_is_no_refusal() {
    for extensions in [0, 50] {
        let mut opts = options(1, 5000);
        let cancel = Cancel::new();
        opts.budget.cancel = cancel.clone();
        let shown = std::sync::Arc::default();
        let mut parts = small().puck_goal(0, [2.0, 1.0]).parts().unwrap();
        parts.verifier = Box::new(Cancelling { cancel, shown: std::sync::Arc::clone(&shown) });
        let outcome = solve(&Problem::new(parts).unwrap(), &shortening(extensions), &opts, &mut Silent);
        assert_eq!(outcome.stop, Stop::Cancelled);
        assert_eq!((outcome.accounts.refused, outcome.last_refusal), (0, None));
        assert_eq!(shown.load(Ordering::SeqCst), 1);
        assert!(outcome.accounts.are_balanced());
    }
}

/// Cancels as soon as a plan of any length is judged; judges it nevertheless.
struct Late {
    judge: Box<dyn Verifier<World>>,
    cancel: Cancel,
}

impl Verifier<World> for Late {
    fn verify(
        &self,
        m: &World,
        start: &State<World>,
        goal: &dyn Goal<World>,
        plan: &Plan<World>,
    ) -> Result<(), Refusal> {
        self.cancel.cancel();
        self.judge.verify(m, start, goal, plan)
    }
}

#[test]
fn a_plan_that_was_verified_before_the_end_is_not_lost() {
    let cancel = Cancel::new();
    let mut parts = small().puck_goal(0, [2.0, 1.0]).parts().unwrap();
    parts.verifier = Box::new(Late { judge: parts.verifier, cancel: cancel.clone() });
    let opts = options(1, 5000);
    let opts = SolveOptions { budget: darrt_core::budget::Budget { cancel, ..opts.budget }, ..opts };
    let outcome = solve(&Problem::new(parts).unwrap(), &shortening(50), &opts, &mut Silent);
    assert_eq!(outcome.stop, Stop::Solved);
    assert!(outcome.solution.is_some());
}
