//! The owner of the loop: budget, restarts, threads, observers.
//!
//! Attempts are numbered and independent; each has its own random streams and its own share of the
//! iterations. The result is that of the lowest-numbered attempt that solves, so it is the same on any
//! number of threads.
//!
//! | way of solving | what is different |
//! |---|---|
//! | [`solve`] | Algorithm 1, until the first solution |
//! | [`solve_with`], one [`Member`] | another [`Algorithm`] |
//! | [`solve_with`], several members | a portfolio: the attempts take the members in turn |
//! | [`solve_recorded`] | a [`Recorder`] is told how the trees grow |
//! | [`solve_with`], [`Until::BudgetEnds`] | anytime: attempts go on, and the cheapest solution is the result |

use std::cmp::Ordering;
use std::fmt;
use std::ops::ControlFlow;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering::SeqCst};

use crate::budget::{Budget, Cancel, Clock, Interrupt, Stop};
use crate::domain::Domain;
use crate::observe::accounts::Accounts;
use crate::observe::{Event, Observer};
use crate::plan::Plan;
use crate::problem::Problem;
use crate::record::Recorder;
use crate::search::part::best_of;
use crate::search::{Algorithm, Part, Planner, Start, Strategy};
use crate::state::State;
use crate::validity::Blame;
use crate::verify::{Refusal, Solution};

/// How [`solve`] works.
#[derive(Debug, Clone)]
pub struct SolveOptions {
    /// Seed of every random choice.
    pub seed: u64,
    /// Limits.
    pub budget: Budget,
    /// Start again from the initial state after this many iterations; `None`: never.
    pub restart_iterations: Option<u64>,
    /// How many attempts run at the same time; at least 1.
    pub threads: usize,
}

impl Default for SolveOptions {
    fn default() -> Self {
        Self { seed: 0, budget: Budget::default(), restart_iterations: None, threads: 1 }
    }
}

/// What an attempt is made with.
pub struct Member<'a, D: Domain> {
    /// Which search.
    pub algorithm: Algorithm,
    /// Its sampler, distance and so on.
    pub strategy: &'a Strategy<D>,
}

impl<D: Domain> Clone for Member<'_, D> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<D: Domain> Copy for Member<'_, D> {}

impl<D: Domain> fmt::Debug for Member<'_, D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Member").field("algorithm", &self.algorithm).field("strategy", self.strategy).finish()
    }
}

/// What makes one solution better than another.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cost {
    /// Fewer steps; among equals the shorter travel.
    Steps,
    /// Fewer metres of travel; among equals the fewer steps.
    Travel,
    /// More distance between bodies that may not touch, where they are nearest
    /// ([`Verified::clearance_m`](crate::verify::Verified::clearance_m)); among equals the fewer steps.
    Clearance,
}

impl Cost {
    /// The cost of a plan: the less in the order of the pair, the better. A clearance that is not known is the smallest.
    pub fn of<D: Domain>(self, plan: &Plan<D>, clearance_m: Option<f64>) -> (f64, f64) {
        let (steps, metres) = (plan.steps().len() as f64, plan.length());
        match self {
            Self::Steps => (steps, metres),
            Self::Travel => (metres, steps),
            Self::Clearance => (-clearance_m.unwrap_or(f64::NEG_INFINITY), steps),
        }
    }

    fn compare<D: Domain>(self, a: &Solution<D>, b: &Solution<D>) -> Ordering {
        let of = |solution: &Solution<D>| self.of(solution.plan(), solution.clearance_m());
        let ((a, second), (b, other)) = (of(a), of(b));
        a.total_cmp(&b).then(second.total_cmp(&other))
    }
}

/// When solving ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Until {
    /// With the solution of the lowest-numbered attempt that finds one.
    #[default]
    Solved,
    /// With the budget; the result is the cheapest of all solutions, of equally cheap ones that of the lowest attempt. More
    /// budget never gives a dearer plan. Needs restarts: an attempt ends with its solution.
    BudgetEnds(Cost),
}

/// How it ended. Stopping without a solution is a status, not an error.
pub struct Outcome<D: Domain> {
    /// The verified solution, if there is one.
    pub solution: Option<Solution<D>>,
    /// Why it stopped.
    pub stop: Stop,
    /// Counts over the attempts that decided the outcome.
    pub accounts: Accounts,
    /// Iterations over those attempts.
    pub iterations: u64,
    /// Nodes of the largest tree.
    pub nodes: usize,
    /// How many attempts were begun anew.
    pub restarts: u64,
    /// Metres from the goal to the nearest state found.
    pub nearest_to_goal: f64,
    /// The state that is so near; of equally near ones that of the lowest attempt. No motion to it need be free as a whole.
    pub nearest: Option<State<D>>,
    /// Time used. The only field that differs from run to run.
    pub elapsed: std::time::Duration,
    /// The last refusal of the verifier, if it refused any plan.
    pub last_refusal: Option<String>,
    /// Without a solution, the beginning of one: the way to the best state found in which objects stand elsewhere than at the
    /// start, all motions judged, but by no verifier. It meets the most [parts of the goal](crate::goal::Goal::parts_met).
    pub part: Option<Plan<D>>,
}

// Not derived: that would ask the domain to be printable.
impl<D: Domain> fmt::Debug for Outcome<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Outcome")
            .field("solution", &self.solution)
            .field("stop", &self.stop)
            .field("accounts", &self.accounts)
            .field("iterations", &self.iterations)
            .field("nodes", &self.nodes)
            .field("restarts", &self.restarts)
            .field("nearest_to_goal", &self.nearest_to_goal)
            .field("nearest", &self.nearest)
            .field("elapsed", &self.elapsed)
            .field("last_refusal", &self.last_refusal)
            .field("part", &self.part)
            .finish()
    }
}

/// The result of one attempt.
struct Attempt<D: Domain> {
    number: u64,
    solution: Option<Solution<D>>,
    stop: Stop,
    accounts: Accounts,
    iterations: u64,
    nodes: usize,
    nearest_to_goal: f64,
    nearest: Option<State<D>>,
    last_refusal: Option<String>,
    parts: Vec<Part<D>>,
}

/// What an attempt has come upon so far.
struct Found<D: Domain> {
    solution: Option<Solution<D>>,
    last_refusal: Option<String>,
}

struct Shared<'a, D: Domain> {
    problem: &'a Problem<D>,
    members: &'a [Member<'a, D>],
    until: Until,
    options: &'a SolveOptions,
    clock: Clock,
    /// Set by an observer; the caller's own token is not touched.
    halt: Cancel,
    observer: Mutex<&'a mut dyn Observer>,
    recorder: Option<Mutex<&'a mut dyn Recorder<D>>>,
    /// The number of the next attempt to be taken by a thread.
    next: AtomicU64,
    /// The lowest attempt that has solved; attempts above it are pointless.
    solved: AtomicU64,
    done: Mutex<Vec<Attempt<D>>>,
}

/// Solves `problem` by Algorithm 1, or says why not.
pub fn solve<D: Domain>(
    problem: &Problem<D>,
    strategy: &Strategy<D>,
    options: &SolveOptions,
    observer: &mut dyn Observer,
) -> Outcome<D> {
    let members = [Member { algorithm: Algorithm::Darrt, strategy }];
    solve_with(problem, &members, Until::Solved, options, observer)
}

/// Solves `problem` by the searches of `members`: attempt `n` is made by member `n` modulo their number. Without members
/// nothing is tried, and the outcome says that no iteration was left.
pub fn solve_with<D: Domain>(
    problem: &Problem<D>,
    members: &[Member<'_, D>],
    until: Until,
    options: &SolveOptions,
    observer: &mut dyn Observer,
) -> Outcome<D> {
    solve_recorded(problem, members, until, options, observer, None)
}

/// [`solve_with`], telling `recorder` of everything that the trees gain and lose. The outcome is the same.
pub fn solve_recorded<'a, D: Domain>(
    problem: &'a Problem<D>,
    members: &'a [Member<'a, D>],
    until: Until,
    options: &'a SolveOptions,
    observer: &'a mut dyn Observer,
    recorder: Option<&'a mut dyn Recorder<D>>,
) -> Outcome<D> {
    let shared = Shared {
        problem,
        members,
        until,
        options,
        clock: Clock::start(&options.budget),
        halt: Cancel::new(),
        observer: Mutex::new(observer),
        recorder: recorder.map(Mutex::new),
        next: AtomicU64::new(0),
        solved: AtomicU64::new(u64::MAX),
        done: Mutex::new(Vec::new()),
    };
    if options.threads <= 1 {
        shared.work();
    } else {
        std::thread::scope(|scope| {
            for _ in 0..options.threads {
                scope.spawn(|| shared.work());
            }
        });
    }
    shared.outcome()
}

/// Keeps the cheapest of the solutions, of equally cheap ones that of the lowest attempt: a long search finds many.
fn forget_dearer<D: Domain>(done: &mut [Attempt<D>], cost: Cost) {
    let found = done.iter().filter_map(|attempt| Some((attempt.number, attempt.solution.as_ref()?)));
    let cheapest = found.min_by(|a, b| cost.compare(a.1, b.1).then(a.0.cmp(&b.0)));
    let kept = cheapest.map(|(number, _)| number);
    done.iter_mut().filter(|attempt| Some(attempt.number) != kept).for_each(|attempt| attempt.solution = None);
}

impl<D: Domain> Shared<'_, D> {
    /// Takes attempts until there are none left or the budget ends.
    fn work(&self) {
        loop {
            let number = self.next.fetch_add(1, SeqCst);
            let Some(share) = self.share(number) else { return };
            // The first attempt always begins: it costs nothing and says how far the goal is.
            if number > 0 && (self.is_overtaken(number) || self.stop().is_some()) {
                return;
            }
            let Some(attempt) = self.attempt(number, share) else { return };
            let improves = self.until != Until::Solved;
            if attempt.solution.is_some() && !improves {
                self.solved.fetch_min(number, SeqCst);
            }
            let goes_on = matches!(attempt.stop, Stop::Restart)
                || (attempt.stop == Stop::Solved && improves)
                || (attempt.stop == Stop::NodeLimit && self.options.restart_iterations.is_some());
            if let Ok(mut done) = self.done.lock() {
                done.push(attempt);
                if let Until::BudgetEnds(cost) = self.until {
                    forget_dearer(&mut done, cost);
                }
            }
            if !goes_on {
                return;
            }
        }
    }

    /// How many iterations attempt `number` may use; fixed beforehand, so that it does not depend on
    /// what other threads do. `None` if the budget has nothing left for it; the first attempt is always
    /// begun.
    fn share(&self, number: u64) -> Option<u64> {
        let total = self.options.budget.iterations;
        let Some(each) = self.options.restart_iterations.map(|each| each.max(1)) else {
            return (number == 0).then_some(total.unwrap_or(u64::MAX));
        };
        let Some(total) = total else { return Some(each) };
        let used = each.saturating_mul(number);
        (number == 0 || used < total).then(|| each.min(total - used))
    }

    fn is_overtaken(&self, number: u64) -> bool {
        self.solved.load(SeqCst) < number
    }

    /// `Some` if time is up or somebody asked for an end.
    fn stop(&self) -> Option<Stop> {
        if self.halt.is_cancelled() { Some(Stop::Cancelled) } else { self.clock.stop() }
    }

    fn tell(&self, event: &Event<'_>) {
        let flow = match self.observer.lock() {
            Ok(mut observer) => observer.on_event(event),
            Err(_) => ControlFlow::Break(()),
        };
        if flow.is_break() {
            self.halt.cancel();
        }
    }

    /// The member whose turn it is.
    fn member(&self, number: u64) -> Option<&Member<'_, D>> {
        let turn = number.checked_rem(self.members.len() as u64)?;
        self.members.get(usize::try_from(turn).ok()?)
    }

    fn attempt(&self, number: u64, share: u64) -> Option<Attempt<D>> {
        let Member { algorithm, strategy } = *self.member(number)?;
        let limit = self.options.budget.nodes.unwrap_or(usize::MAX);
        let ask = || self.stop().or_else(|| self.is_overtaken(number).then_some(Stop::Overtaken));
        let (seed, interrupt) = (self.options.seed, Interrupt::new(&ask));
        let start = Start { seed, attempt: number, node_limit: limit, interrupt, is_part: false };
        let mut planner = algorithm.planner(self.problem, strategy, start);
        let mut found = Found { solution: None, last_refusal: None };
        self.tell(&Event::AttemptStarted { attempt: number });
        if self.recorder.is_some() {
            planner.keep_track();
            self.record(number, &*planner, None);
        }
        match planner.prove_start() {
            Some(Ok(solution)) => found.solution = Some(solution),
            Some(Err(refusal)) => found.last_refusal = Some(self.tell_refusal(number, &refusal)),
            None => {}
        }
        let stop = match found.solution {
            Some(_) => Stop::Solved,
            None => self.run(number, share, &mut *planner, &mut found),
        };
        if stop == Stop::Solved {
            self.tell(&Event::Solved { attempt: number, iteration: planner.iteration() });
        }
        self.tell(&Event::AttemptEnded { attempt: number, stop });
        let parts = if stop == Stop::Solved || self.is_overtaken(number) { Vec::new() } else { planner.parts() };
        Some(Attempt {
            number,
            parts,
            solution: found.solution,
            stop,
            iterations: planner.iteration(),
            nodes: planner.nodes(),
            nearest_to_goal: planner.nearest_to_goal(),
            nearest: planner.nearest().cloned(),
            accounts: planner.accounts(),
            last_refusal: found.last_refusal,
        })
    }

    /// Steps until something ends the attempt.
    fn run(&self, number: u64, share: u64, planner: &mut (dyn Planner<D> + '_), found: &mut Found<D>) -> Stop {
        loop {
            if let Some(stop) = self.stop() {
                return stop;
            }
            if self.is_overtaken(number) {
                return Stop::Overtaken;
            }
            if planner.iteration() >= share {
                let is_last = self.share(number + 1).is_none();
                return if is_last { Stop::IterationLimit } else { Stop::Restart };
            }
            let step = planner.step();
            self.tell(&Event::Iteration {
                attempt: number,
                iteration: planner.iteration(),
                nodes: planner.nodes(),
                added: step.added,
                nearest_to_goal: planner.nearest_to_goal(),
                blame: step.blame.as_ref(),
            });
            if self.recorder.is_some() {
                self.record(number, planner, step.blame.as_ref().or(step.withdrawn.as_ref().map(|(_, blame)| blame)));
            }
            if let Some(refusal) = step.refusal {
                found.last_refusal = Some(self.tell_refusal(number, &refusal));
            }
            if step.solution.is_some() {
                found.solution = step.solution;
                return Stop::Solved;
            }
            if let Some(stop) = step.stop {
                return stop;
            }
        }
    }

    fn record(&self, attempt: u64, planner: &(dyn Planner<D> + '_), blame: Option<&Blame>) {
        let (Some(recorder), Some(growth)) = (&self.recorder, planner.growth()) else { return };
        // A recorder that has panicked has nothing more to be told.
        if let Ok(mut recorder) = recorder.lock() {
            recorder.on_growth(attempt, planner.iteration(), &growth, blame);
        }
    }

    fn tell_refusal(&self, attempt: u64, refusal: &Refusal) -> String {
        let reason = refusal.to_string();
        self.tell(&Event::Refused { attempt, reason: &reason });
        reason
    }

    /// Puts together what the deciding attempts say: those up to the one that solved.
    fn outcome(self) -> Outcome<D> {
        let elapsed = self.clock.elapsed();
        let interrupted = self.stop();
        let names = self.problem.primitives().iter().map(|p| p.name()).collect();
        let mut outcome = Outcome {
            solution: None,
            stop: interrupted.unwrap_or(Stop::IterationLimit),
            accounts: Accounts::new(names),
            iterations: 0,
            nodes: 0,
            restarts: 0,
            nearest_to_goal: f64::INFINITY,
            nearest: None,
            elapsed,
            last_refusal: None,
            part: None,
        };
        let mut parts = Vec::new();
        let mut attempts = self.done.into_inner().unwrap_or_default();
        attempts.sort_by_key(|a| a.number);
        // An attempt that was cut short decides, also when one with a higher number came to its own end before.
        let cut_short = attempts.iter().map(|a| a.stop).find(|s| matches!(s, Stop::Cancelled | Stop::TimeLimit));
        for attempt in attempts {
            outcome.accounts.merge(&attempt.accounts);
            outcome.iterations += attempt.iterations;
            outcome.nodes = outcome.nodes.max(attempt.nodes);
            outcome.restarts = attempt.number;
            if attempt.nearest_to_goal < outcome.nearest_to_goal {
                (outcome.nearest_to_goal, outcome.nearest) = (attempt.nearest_to_goal, attempt.nearest);
            }
            outcome.last_refusal = attempt.last_refusal.or(outcome.last_refusal);
            outcome.stop = attempt.stop;
            parts.extend(attempt.parts);
            // Of those that were to be improved only the cheapest is left.
            if attempt.solution.is_some() {
                outcome.solution = attempt.solution;
                if self.until == Until::Solved {
                    break;
                }
            }
        }
        if outcome.solution.is_some() {
            outcome.stop = Stop::Solved;
        }
        if outcome.solution.is_none() {
            outcome.stop = cut_short.unwrap_or(outcome.stop);
            // Who cancels does not want to wait.
            let strategy =
                self.members.first().filter(|_| outcome.stop != Stop::Cancelled).map(|member| member.strategy);
            outcome.part = strategy.and_then(|strategy| best_of(self.problem, strategy, self.options.seed, parts));
        }
        // The budget ended between two attempts.
        if outcome.stop == Stop::Restart {
            outcome.stop = interrupted.unwrap_or(outcome.stop);
        }
        outcome
    }
}
