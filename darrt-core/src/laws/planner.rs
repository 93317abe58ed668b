//! Laws of the planner with everything that it is built from: a problem and a strategy.

use std::ops::ControlFlow;

use crate::budget::{Budget, Cancel, Stop};
use crate::domain::Domain;
use crate::goal::Goal;
use crate::observe::accounts::Accounts;
use crate::observe::{Event, Observer, Silent};
use crate::plan::Plan;
use crate::problem::Problem;
use crate::search::{Darrt, Strategy};
use crate::solve::{Outcome, SolveOptions, solve};
use crate::tree::Tree;

use super::verifier::{Judged, check_verifier};
use super::watch::{Pulse, entering, patience_s, watched, with_patience};
use super::{Broken, ensure, equal};

/// Edges replay.
pub const REPLAY: &str = "planner.replay: every edge leads from its parent to its child, bit for bit";
/// Nodes are valid.
pub const VALID: &str = "planner.valid: every node of the tree is valid under the contacts of its edge";
/// Same seed, same tree.
pub const SEEDED: &str = "planner.seeded: the same seed grows the same tree";
/// Threads do not matter.
pub const THREADS: &str = "planner.threads: the outcome is the same on 1, 2 and 8 threads";
/// Balance.
pub const BALANCED: &str =
    "planner.balanced: every extension ends in one bucket per primitive, and every added state is a node";
/// Solved implies verified.
pub const VERIFIED: &str = "planner.verified: a solution starts at the start, ends in the goal and is accepted by the verifier, again with the same clearance";
/// Cancellation.
pub const CANCEL: &str = "planner.cancel: after it is cancelled it ends within one extension per thread, and says so";

/// A problem.
pub const PROBLEM: &str =
    "planner.problem: the parts make a problem: its start is valid, and its goal lies in the spaces";

/// The laws of this file.
pub const LAWS: &[&str] = &[PROBLEM, REPLAY, VALID, SEEDED, THREADS, BALANCED, VERIFIED, CANCEL];

/// Iterations when the options set no limit.
const ITERATIONS: u64 = 200;

/// All laws of planning `problem` with `strategy`. Of the options, the seed, the limits on iterations
/// (200 if there is none) and nodes, and the restarts count; time limit, threads and the cancel token do
/// not, so nothing here depends on a clock. The solution, or else the way to the node with the most steps before it, is broken on
/// purpose and shown to the verifier ([`check_verifier`]).
///
/// # Errors
/// The first law that is [`Broken`].
pub fn check_planner<D: Domain>(
    problem: &Problem<D>,
    strategy: &Strategy<D>,
    options: &SolveOptions,
) -> Result<(), Broken> {
    let about = || format!("check_planner({problem:?}, {strategy:?}, {options:?})");
    let check = || {
        let ways = tree(problem, strategy, options)?;
        let one = run(problem, strategy, options, 1);
        outcome(problem, &one)?;
        for threads in [2, 8] {
            same_outcome(&run(problem, strategy, options, threads), &one)
                .map_err(|broken| broken.of(format_args!("{threads} threads")))?;
        }
        let run = |options: &SolveOptions, observer: &mut dyn Observer| solve(problem, strategy, options, observer);
        [1, 2].into_iter().try_for_each(|threads| check_cancel(&run, options, threads))?;
        match &one.solution {
            Some(solution) => judge(problem, problem.goal(), solution.plan(), options.seed),
            None => judge_ways(problem, &ways, options.seed),
        }
    };
    // One iteration may take longer than any single call of a primitive.
    with_patience(PATIENCE_FACTOR * patience_s(), || watched(&about, check)).map_err(|broken| broken.replayed_by(about))
}

/// How much longer one iteration of the search, or the verification of one plan, may take than another call.
pub(super) const PATIENCE_FACTOR: f64 = 6.0;

/// Breaks a plan in many ways, and shows what becomes of it to the verifier.
fn judge<D: Domain>(problem: &Problem<D>, goal: &dyn Goal<D>, plan: &Plan<D>, seed: u64) -> Result<(), Broken> {
    let judged = Judged {
        domain: problem.domain(),
        start: problem.start(),
        goal,
        validity: Some(problem.validity()),
        verifier: problem.verifier(),
    };
    check_verifier(&judged, plan, seed).map(|_| ())
}

/// The same with ways through the tree, the longest first, for the goal to be where each ends. What the verifier refuses as it is
/// says nothing, but if that is all of many, it accepts nothing.
fn judge_ways<D: Domain>(problem: &Problem<D>, ways: &[Plan<D>], seed: u64) -> Result<(), Broken> {
    let m = problem.domain();
    let (mut last, mut at_steps) = (None, 0);
    for plan in ways {
        let goal = super::verifier::each_primitive::its_end(m, plan);
        entering("verify");
        match problem.verifier().verify(m, problem.start(), &goal, plan) {
            Ok(_) => return judge(problem, &goal, plan, seed),
            // A verifier may know its goal by itself: then these ways do not end there.
            Err(refusal) => {
                at_steps += usize::from(refusal.step.is_some());
                last = Some(refusal);
            }
        }
    }
    let text = || {
        format!(
            "{at_steps} ways refused at one of their steps, the last one because {}",
            last.map_or_else(String::new, |r| r.to_string())
        )
    };
    ensure(super::verifier::ACCEPTS, at_steps < MANY_WAYS, text, "one accepted")
}

/// So many ways are judged at most, and so many are not all refused.
const WAYS: usize = 24;
const MANY_WAYS: usize = 16;

/// Tells the watchdog of every event.
pub(super) struct Heart(Pulse);

impl Heart {
    /// Of the check that this thread makes.
    pub(super) fn of_this_thread() -> Self {
        let heart = Self(Pulse::of_this_thread());
        heart.0.beat("an iteration of the search");
        heart
    }
}

impl Observer for Heart {
    fn on_event(&mut self, _: &Event<'_>) -> ControlFlow<()> {
        self.0.beat("an iteration of the search");
        ControlFlow::Continue(())
    }
}

fn run<D: Domain>(problem: &Problem<D>, strategy: &Strategy<D>, options: &SolveOptions, threads: usize) -> Outcome<D> {
    solve(problem, strategy, &timeless(options, threads), &mut Heart::of_this_thread())
}

/// The same options without a clock, with a cancel token of their own.
fn timeless(options: &SolveOptions, threads: usize) -> SolveOptions {
    let iterations = Some(options.budget.iterations.unwrap_or(ITERATIONS));
    let budget = Budget { time: None, iterations, nodes: options.budget.nodes, cancel: Cancel::new() };
    SolveOptions { seed: options.seed, budget, restart_iterations: options.restart_iterations, threads }
}

fn grow<'p, D: Domain>(problem: &'p Problem<D>, strategy: &'p Strategy<D>, options: &SolveOptions) -> Darrt<'p, D> {
    let limit = options.budget.nodes.unwrap_or(usize::MAX);
    let mut darrt = Darrt::new(problem, strategy, options.seed, 0, limit);
    for _ in 0..options.budget.iterations.unwrap_or(ITERATIONS) {
        entering("an iteration of the search");
        let step = darrt.step();
        if step.solution.is_some() || step.stop.is_some() {
            break;
        }
    }
    darrt
}

/// The laws of the tree. Returns ways to nodes, those with the most steps first, and some of the others.
fn tree<D: Domain>(
    problem: &Problem<D>,
    strategy: &Strategy<D>,
    options: &SolveOptions,
) -> Result<Vec<Plan<D>>, Broken> {
    let m = problem.domain();
    let grown = grow(problem, strategy, options);
    let tree = grown.tree();
    for (id, node) in tree.iter() {
        let of = |broken: Broken| broken.of(format_args!("node {}", id.index()));
        let Some(edge) = &node.edge else {
            equal(REPLAY, &node.state, problem.start()).map_err(of)?;
            continue;
        };
        let known = edge.parent < id && edge.t > 0.0 && edge.t <= 1.0;
        ensure(REPLAY, known, || format!("parent {:?}, t {:?}", edge.parent, edge.t), "an earlier parent, t in (0, 1]")
            .map_err(of)?;
        equal(REPLAY, &edge.instance.at(m, edge.t, problem.start()), &node.state)
            .map_err(|broken| of(broken).at(edge.t))?;
        beginning(problem, tree, node).map_err(of)?;
        if let Err(blame) = problem.validity().check(m, &node.state, &edge.instance.contacts) {
            return Err(of(Broken::new(VALID, blame.to_string(), "a valid state").at(edge.t)));
        }
    }
    let again = grow(problem, strategy, options);
    same_tree(tree, again.tree())?;
    check_accounts(grown.accounts(), grown.iteration(), tree.len() as u64 - 1)?;
    equal(SEEDED, again.accounts(), grown.accounts())?;
    let ways = tree.iter().filter_map(|(id, _)| Plan::to_node(tree, id));
    let mut ways: Vec<Plan<D>> = ways.filter(|way| !way.steps().is_empty()).collect();
    // The first of equally long ones.
    ways.sort_by_key(|way| std::cmp::Reverse(way.steps().len()));
    let short = ways.len().saturating_sub(WAYS / 2).max(WAYS / 2);
    let some = ways.into_iter().enumerate().filter(|(i, _)| *i < WAYS / 2 || *i >= short);
    Ok(some.map(|(_, way)| way).collect())
}

/// Every extension was counted once, in one bucket per primitive, and every added state is a node.
///
/// # Errors
/// [`BALANCED`] with the count that is wrong.
pub fn check_accounts(accounts: &Accounts, extensions: u64, added: u64) -> Result<(), Broken> {
    ensure(BALANCED, accounts.are_balanced(), || format!("{accounts:?}"), "rows that sum to the extensions")?;
    equal(BALANCED, &accounts.extensions, &extensions).map_err(|broken| broken.of("extensions"))?;
    equal(BALANCED, &accounts.added, &added).map_err(|broken| broken.of("added states"))
}

/// The parent lies where the instance of the edge begins, or earlier on the same instance.
fn beginning<D: Domain>(problem: &Problem<D>, tree: &Tree<D>, node: &crate::tree::Node<D>) -> Result<(), Broken> {
    let Some(edge) = &node.edge else { return Ok(()) };
    let Some(parent) = tree.node(edge.parent) else {
        return Err(Broken::new(REPLAY, format!("{:?}", edge.parent), "a node of the tree"));
    };
    let earlier = parent.edge.as_ref().filter(|before| std::sync::Arc::ptr_eq(&before.instance, &edge.instance));
    match earlier {
        Some(before) => {
            ensure(REPLAY, before.t < edge.t, || format!("{:?} before {:?}", before.t, edge.t), "growing parameters")
        }
        None => equal(REPLAY, &edge.instance.at(problem.domain(), 0.0, problem.start()), &parent.state)
            .map_err(|broken| broken.at(0.0)),
    }
}

fn same_tree<D: Domain>(found: &Tree<D>, against: &Tree<D>) -> Result<(), Broken> {
    for ((id, p), (_, q)) in found.iter().zip(against.iter()) {
        let of = |broken: Broken| broken.of(format_args!("node {}", id.index()));
        equal(SEEDED, &p.state, &q.state).map_err(of)?;
        let edge = |node: &crate::tree::Node<D>| node.edge.as_ref().map(|e| (e.parent, e.t, e.primitive));
        equal(SEEDED, &edge(p), &edge(q)).map_err(of)?;
    }
    equal(SEEDED, &found.len(), &against.len())
}

fn outcome<D: Domain>(problem: &Problem<D>, outcome: &Outcome<D>) -> Result<(), Broken> {
    check_accounts(&outcome.accounts, outcome.iterations, outcome.accounts.added)?;
    equal(VERIFIED, &(outcome.stop == Stop::Solved), &outcome.solution.is_some())?;
    let Some(solution) = &outcome.solution else { return Ok(()) };
    let (m, plan) = (problem.domain(), solution.plan());
    equal(VERIFIED, plan.start(), problem.start())?;
    let end = plan.end(m);
    ensure(VERIFIED, problem.goal().is_satisfied(m, &end), || format!("{end:?}"), "a state in the goal")?;
    entering("verify");
    let again = problem
        .verifier()
        .verify(m, problem.start(), problem.goal(), plan)
        .map_err(|refusal| Broken::new(VERIFIED, refusal.to_string(), "accepted"))?;
    super::verifier::clearance(&again)?;
    equal(VERIFIED, &again.clearance_m, &solution.clearance_m()).map_err(|broken| broken.of("clearance"))
}

fn same_outcome<D: Domain>(found: &Outcome<D>, against: &Outcome<D>) -> Result<(), Broken> {
    let numbers = |o: &Outcome<D>| (o.stop, o.iterations, o.nodes, o.restarts, o.nearest_to_goal);
    equal(THREADS, &numbers(found), &numbers(against))?;
    equal(THREADS, &found.accounts, &against.accounts)?;
    let steps = |o: &Outcome<D>| o.solution.as_ref().map(|s| s.plan().steps().len());
    equal(THREADS, &steps(found), &steps(against))?;
    if let (Some(p), Some(q)) = (&found.solution, &against.solution) {
        for (i, (a, b)) in p.plan().steps().iter().zip(q.plan().steps()).enumerate() {
            let of = |broken: Broken| broken.of(format_args!("step {i}"));
            equal(THREADS, &(a.until, a.primitive), &(b.until, b.primitive)).map_err(of)?;
            equal(THREADS, &a.instance.primitive, &b.instance.primitive).map_err(of)?;
        }
    }
    Ok(())
}

/// Cancels after the third iteration, and watches what comes after.
#[derive(Default)]
struct CancelAfter {
    /// Iterations so far.
    seen: u64,
    /// Did an attempt say that it was cancelled?
    is_cut_short: bool,
    /// Did an attempt end because its tree was full?
    is_full: bool,
    pulse: Pulse,
}

impl CancelAfter {
    const AT: u64 = 3;
}

impl Observer for CancelAfter {
    fn on_event(&mut self, event: &Event<'_>) -> ControlFlow<()> {
        self.pulse.beat("an iteration of the search");
        match event {
            Event::Iteration { .. } => self.seen += 1,
            Event::AttemptEnded { stop, .. } => {
                self.is_cut_short |= *stop == Stop::Cancelled;
                self.is_full |= *stop == Stop::NodeLimit;
            }
            _ => {}
        }
        if self.seen >= Self::AT { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

/// A solver, given its options and whom to tell.
pub type Solver<'a, D> = &'a dyn Fn(&SolveOptions, &mut dyn Observer) -> Outcome<D>;

/// A solver that is cancelled by its observer or from outside stops within one extension per thread.
///
/// # Errors
/// [`CANCEL`] with the iterations that still came, or with the wrong reason.
pub fn check_cancel<D: Domain>(solve: Solver<'_, D>, options: &SolveOptions, threads: usize) -> Result<(), Broken> {
    let mut observer = CancelAfter { pulse: Pulse::of_this_thread(), ..CancelAfter::default() };
    let heard = timeless(options, threads);
    let outcome = solve(&heard, &mut observer);
    let most = CancelAfter::AT + threads as u64;
    ensure(CANCEL, observer.seen <= most, || format!("{} iterations", observer.seen), "at most one more per thread")?;
    // Everything may have come to its own end just then; but an attempt that was cut short decides.
    let is_used_up = heard.budget.iterations.is_some_and(|n| outcome.iterations >= n);
    let may_end = observer.seen < CancelAfter::AT || observer.is_full || is_used_up;
    let is_right = outcome.solution.is_some() || outcome.stop == Stop::Cancelled || (may_end && !observer.is_cut_short);
    ensure(CANCEL, is_right, || format!("{:?}", outcome.stop), "cancelled")?;

    let stopped = timeless(options, threads);
    stopped.budget.cancel.cancel();
    let outcome = solve(&stopped, &mut Silent);
    equal(CANCEL, &(outcome.stop, outcome.iterations), &(Stop::Cancelled, 0))
}
