//! A plan that was found is made shorter, as long as somebody waits for it.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use darrt_core::budget::{Cancel, Interrupt, Stop};
use darrt_core::extend::{ExtendOptions, Extender};
use darrt_core::goal::Goal;
use darrt_core::motion::Instance;
use darrt_core::observe::Silent;
use darrt_core::partial::PartialState;
use darrt_core::plan::{Plan, Step};
use darrt_core::problem::Problem;
use darrt_core::search::Strategy;
use darrt_core::shorten::{ShortenOptions, shorten};
use darrt_core::solve::{SolveOptions, solve};
use darrt_core::state::{ComponentSet, State};
use darrt_core::testing::puck::{Point, Setup, paper_strategy, problems};
use darrt_core::validity::{Blame, BlockKind, FreePrefix, Validity};
use darrt_core::verify::{Refusal, Verified, Verifier};

use super::support::{World, id, options, rng, small};

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

/// Where the effort ends in the middle, the old steps follow on the new ones. Seen directly: the planner drops a plan that
/// does not verify, so that a wrong one would only look like none.
#[test]
fn every_shorter_plan_is_right_however_early_the_effort_ends() {
    // Behind the last puck the robot still has to go somewhere.
    let home = small().puck("blue", 0.12, [1.0, 1.5]).puck_goal(0, [2.0, 1.0]).puck_goal(1, [2.0, 1.5]);
    let home = home.robot_goal([0.5, 0.5]).problem().unwrap();
    let strategy = shortening(0);
    let mut shorter = [0; 5];
    for (problem, seed) in [problems::two_pucks().unwrap(), home].iter().flat_map(|p| (0..3).map(move |seed| (p, seed)))
    {
        let outcome = solve(problem, &strategy, &options(seed, 5000), &mut Silent);
        let plan = outcome.solution.unwrap().plan().clone();
        // Of little depth an extension reaches only what is near: the old steps stay up to there.
        for max_depth in [1, 2, 20] {
            let (limits, interrupt) = (ExtendOptions { max_depth, ..strategy.extend }, Interrupt::NEVER);
            let extender = Extender { problem, options: &limits, local_repair: None, interrupt };
            for (extensions, shorter) in [0, 2, 8, 30, 100].into_iter().zip(&mut shorter) {
                let effort = ShortenOptions { extensions };
                let Some(short) = shorten(&extender, &plan, effort, &mut rng(seed)) else { continue };
                *shorter += 1;
                assert!(short.steps().len() < plan.steps().len());
                let verdict = problem.verifier().verify(problem.domain(), problem.start(), problem.goal(), &short);
                assert_eq!(verdict.err(), None, "seed {seed}, depth {max_depth}, {extensions} extensions");
            }
        }
    }
    assert_eq!(shorter[0], 0, "no effort, no plan");
    assert!(shorter.iter().filter(|n| **n > 0).count() >= 3, "{shorter:?}");
}

const FIRST_STOP: Point = [1.5, 2.0];
const LAST_STOP: Point = [2.0, 1.5];
const BESIDE: Point = [1.6, 2.0];
const GOAL: Point = [2.0, 0.6];

/// The puck comes to its goal only from the last stop, and the robot only from beside it to where it pushes there. Nothing is
/// pushed to the stop that is barred.
struct OneWay {
    inner: Box<dyn Validity<World>>,
    barred: Option<Point>,
}

impl Validity<World> for OneWay {
    fn check(&self, m: &World, state: &State<World>, contacts: &ComponentSet) -> Result<(), Blame> {
        self.inner.check(m, state, contacts)
    }

    fn free_prefix(&self, m: &World, instance: &Instance<World>, from: &State<World>) -> FreePrefix {
        let end = instance.at(m, 1.0, from);
        let is_allowed = match instance.primitive.name() {
            "Push" if Some(end.objects[0]) == self.barred => false,
            "Push" => end.objects[0] != GOAL || from.objects[0] == LAST_STOP,
            _ => end.mode.touching.is_none() || from.objects[0] != LAST_STOP || from.robot == BESIDE,
        };
        if is_allowed {
            return self.inner.free_prefix(m, instance, from);
        }
        let bar = Blame { kind: BlockKind::Other, first: "robot".into(), second: "bar".into(), place: [0.0; 3] };
        FreePrefix::blocked(0.5, bar)
    }
}

/// Three pushes, and before the last one the robot goes around the puck. Every motion is one step.
fn pushed_thrice(extender: &Extender<'_, World>) -> Plan<World> {
    let problem = extender.problem;
    let anywhere = || PartialState::anywhere(problem.domain());
    let puck_at = |at| anywhere().with_object(id(0), at);
    let beside = anywhere().with_robot(problem.domain(), BESIDE);
    let (mut here, mut steps) = (problem.start().clone(), Vec::new());
    for target in [puck_at(FIRST_STOP), puck_at(LAST_STOP), beside, puck_at(GOAL)] {
        let extension = extender.extend(&here, &target, &mut rng(0));
        assert!(extension.is_met, "{target:?}: {:?}", extension.blame);
        for reached in extension.reached {
            here = reached.state;
            steps.push(Step { instance: reached.instance, until: reached.t, primitive: reached.primitive });
        }
    }
    assert_eq!(steps.len(), 7);
    Plan::new(problem.start().clone(), steps)
}

/// The first two pushes become one; what is behind stays, because no single extension does the same: the new push comes back
/// to the old plan beside the puck. Either because that is shorter, or because the first push turns out to be blocked when
/// the plan is judged.
#[test]
fn old_steps_follow_on_new_ones() {
    for (defer, barred) in [(false, None), (true, Some(FIRST_STOP))] {
        let floor = Setup::new([4.0, 3.0], 0.15).robot_at([0.3, 1.5]).puck("red", 0.12, [1.0, 1.5]);
        let mut parts = floor.puck_goal(0, GOAL).parts().unwrap();
        parts.validity = Box::new(OneWay { inner: parts.validity, barred });
        let problem = Problem::new(parts).unwrap();
        let limits = ExtendOptions { spacing_m: 100.0, defer, ..ExtendOptions::default() };
        let extender =
            Extender { problem: &problem, options: &limits, local_repair: None, interrupt: Interrupt::NEVER };
        let plan = pushed_thrice(&extender);
        let short = shorten(&extender, &plan, ShortenOptions { extensions: 100 }, &mut rng(0)).unwrap();
        let is_old = |step: &Step<World>| plan.steps().iter().any(|old| Arc::ptr_eq(&old.instance, &step.instance));
        assert_eq!(short.steps().iter().map(is_old).collect::<Vec<_>>(), [false, false, false, true, true], "{defer}");
        let verdict = problem.verifier().verify(problem.domain(), problem.start(), problem.goal(), &short);
        assert_eq!(verdict.err(), None);
    }
}

/// Cancels while it judges, and gives up. Counts the plans it is shown.
struct Cancelling {
    cancel: Cancel,
    shown: std::sync::Arc<AtomicU64>,
}

impl Verifier<World> for Cancelling {
    fn verify(&self, _: &World, _: &State<World>, _: &dyn Goal<World>, _: &Plan<World>) -> Result<Verified, Refusal> {
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
    ) -> Result<Verified, Refusal> {
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
