//! Why a search stops: limits, cancellation, restarts.

use std::ops::ControlFlow;
use std::sync::Barrier;
use std::time::Duration;

use darrt_core::budget::{Budget, Cancel, Stop};
use darrt_core::observe::{Event, Silent};
use darrt_core::sample::Full;
use darrt_core::solve::{SolveOptions, solve};
use darrt_core::testing::puck::problems;

use super::support::{greedy, options, run, run_observed, small};

/// A problem that full samples never solve, and options without any limit.
fn endless() -> SolveOptions {
    SolveOptions { budget: Budget::default(), ..options(0, 0) }
}

#[test]
fn a_limit_of_no_iterations_does_none() {
    let problem = problems::open().unwrap();
    for restart_iterations in [None, Some(0), Some(7)] {
        let outcome = run(&problem, &SolveOptions { restart_iterations, ..options(0, 0) });
        assert_eq!((outcome.stop, outcome.iterations, outcome.nodes), (Stop::IterationLimit, 0, 1));
        assert!(outcome.solution.is_none() && outcome.nearest_to_goal.is_finite());
    }
}

#[test]
fn the_iteration_limit_is_kept_to_the_iteration() {
    let problem = problems::fig3().unwrap();
    for (restart_iterations, restarts) in [(None, 0), (Some(1), 499), (Some(200), 2), (Some(499), 1), (Some(500), 0)] {
        for threads in [1, 3] {
            let opts = SolveOptions { restart_iterations, threads, ..options(0, 500) };
            let outcome = solve(&problem, &greedy(Full), &opts, &mut Silent);
            assert_eq!((outcome.stop, outcome.iterations, outcome.restarts), (Stop::IterationLimit, 500, restarts));
            assert_eq!(outcome.accounts.extensions, 500);
        }
    }
}

#[test]
fn no_time_is_a_time_limit() {
    let problem = problems::fig3().unwrap();
    let mut opts = endless();
    opts.budget.time = Some(Duration::ZERO);
    let outcome = run(&problem, &opts);
    assert_eq!((outcome.stop, outcome.iterations, outcome.nodes), (Stop::TimeLimit, 0, 1));
    // Too long to be represented: no limit.
    opts.budget.time = Some(Duration::MAX);
    opts.budget.iterations = Some(3);
    assert_eq!(solve(&problem, &greedy(Full), &opts, &mut Silent).stop, Stop::IterationLimit);
}

#[test]
fn a_time_limit_between_two_attempts_is_told_as_such() {
    let problem = problems::fig3().unwrap();
    let cancel = Cancel::new();
    let mut opts = SolveOptions { restart_iterations: Some(10), ..endless() };
    opts.budget.cancel = cancel.clone();
    let outcome = run_observed(&problem, &opts, |event| {
        if matches!(event, Event::AttemptEnded { .. }) {
            cancel.cancel();
        }
        ControlFlow::Continue(())
    });
    assert_eq!((outcome.stop, outcome.iterations), (Stop::Cancelled, 10));
}

#[test]
fn a_full_tree_ends_the_search_or_the_attempt() {
    let problem = problems::fig3().unwrap();
    let mut opts = SolveOptions { restart_iterations: None, ..options(0, 500) };
    for nodes in [0, 1, 50] {
        opts.budget.nodes = Some(nodes);
        let outcome = run(&problem, &opts);
        assert_eq!((outcome.stop, outcome.nodes), (Stop::NodeLimit, nodes.max(1)));
        assert_eq!(outcome.accounts.added, outcome.nodes as u64 - 1);
        assert!(outcome.accounts.are_balanced());
    }
    opts.restart_iterations = Some(200);
    let outcome = run(&problem, &opts);
    assert_eq!(outcome.nodes, 50);
    assert_eq!(outcome.restarts, 2, "500 iterations are three attempts of at most 200");
}

#[test]
fn cancelled_from_another_thread_within_one_extension_per_worker() {
    let problem = problems::fig3().unwrap();
    for threads in [1, 4] {
        let mut opts = SolveOptions { threads, restart_iterations: Some(1000), ..endless() };
        let cancel = Cancel::new();
        opts.budget.cancel = cancel.clone();
        let meeting = Barrier::new(2);
        let mut seen = 0;
        let outcome = std::thread::scope(|scope| {
            scope.spawn(|| {
                meeting.wait();
                cancel.cancel();
                meeting.wait();
            });
            let mut observer = Counter(|| {
                seen += 1;
                if seen == 20 {
                    meeting.wait();
                    meeting.wait();
                }
            });
            solve(&problem, &greedy(Full), &opts, &mut observer)
        });
        assert_eq!(outcome.stop, Stop::Cancelled);
        assert!(outcome.solution.is_none());
        assert!((20..20 + threads).contains(&seen), "{seen} extensions on {threads} threads");
    }
}

struct Counter<F>(F);

impl<F: FnMut() + Send> darrt_core::observe::Observer for Counter<F> {
    fn on_event(&mut self, event: &Event<'_>) -> ControlFlow<()> {
        if matches!(event, Event::Iteration { .. }) {
            (self.0)();
        }
        ControlFlow::Continue(())
    }
}

#[test]
fn an_observer_can_stop_it_without_touching_the_callers_token() {
    let problem = problems::fig3().unwrap();
    let opts = endless();
    let mut seen = 0;
    let outcome = run_observed(&problem, &opts, |event| {
        seen += u32::from(matches!(event, Event::Iteration { .. }));
        if seen == 5 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    assert_eq!((outcome.stop, outcome.iterations), (Stop::Cancelled, 5));
    assert!(!opts.budget.cancel.is_cancelled());
}

#[test]
fn a_cancelled_token_stops_before_the_first_iteration() {
    let problem = problems::open().unwrap();
    let opts = endless();
    opts.budget.cancel.cancel();
    let outcome = run(&problem, &opts);
    assert_eq!((outcome.stop, outcome.iterations), (Stop::Cancelled, 0));
}

#[test]
fn a_start_in_the_goal_is_solved_by_doing_nothing() {
    let problem = small().puck_goal(0, [1.0, 1.0]).problem().unwrap();
    let mut opts = options(0, 0);
    opts.budget.time = Some(Duration::ZERO);
    for threads in [0, 1, 4] {
        let outcome = run(&problem, &SolveOptions { threads, ..opts.clone() });
        assert_eq!((outcome.stop, outcome.iterations), (Stop::Solved, 0));
        let plan = outcome.solution.unwrap().plan().clone();
        assert!(plan.steps().is_empty());
        assert_eq!(plan.end(problem.domain()), *problem.start());
        assert_eq!(plan.length(), 0.0);
    }
}
