//! How long a planner may work, and why it stopped. The only file that reads a clock.

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Cancels a planner from another thread. Clones share one flag.
#[derive(Debug, Clone, Default)]
pub struct Cancel(Arc<AtomicBool>);

impl Cancel {
    /// A token that is not cancelled.
    pub fn new() -> Self {
        Self::default()
    }

    /// Asks the planner to stop; it does so within one instance of an extension, or one check of a verifier that asks.
    pub fn cancel(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Has it been asked to stop?
    pub fn is_cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// Limits on one call of [`solve`](crate::solve::solve). `None` means no limit of that kind.
///
/// When time is up, a plan that was found before is still verified; it is not made shorter or smoother any more.
#[derive(Debug, Clone, Default)]
pub struct Budget {
    /// Wall-clock time over all attempts.
    pub time: Option<Duration>,
    /// Iterations over all attempts.
    pub iterations: Option<u64>,
    /// Nodes in one tree; an attempt that reaches it restarts, or ends the search if restarts are off.
    pub nodes: Option<usize>,
    /// Cancellation from another thread.
    pub cancel: Cancel,
}

/// Why a planner, or one attempt of it, stopped.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Stop {
    /// A verified solution was found.
    Solved,
    /// The time limit was reached.
    TimeLimit,
    /// The iteration limit was reached.
    IterationLimit,
    /// The tree is full.
    NodeLimit,
    /// This attempt used its share of iterations; the next one starts from the initial state.
    Restart,
    /// It was cancelled from outside, or by an observer.
    Cancelled,
    /// An attempt with a lower number has solved the problem.
    Overtaken,
}

impl fmt::Display for Stop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Solved => "solved",
            Self::TimeLimit => "time limit reached",
            Self::IterationLimit => "iteration limit reached",
            Self::NodeLimit => "node limit reached",
            Self::Restart => "restarted",
            Self::Cancelled => "cancelled",
            Self::Overtaken => "overtaken by another attempt",
        })
    }
}

/// Asked between two pieces of work whether to stop, and why.
#[derive(Clone, Copy)]
pub struct Interrupt<'a>(&'a (dyn Fn() -> Option<Stop> + Sync));

impl<'a> Interrupt<'a> {
    /// Never stops.
    pub const NEVER: Interrupt<'static> = Interrupt(&|| None);

    /// Stops as soon as `ask` gives a reason.
    pub fn new(ask: &'a (dyn Fn() -> Option<Stop> + Sync)) -> Self {
        Self(ask)
    }

    /// Why to stop, if it is time to.
    pub fn stop(self) -> Option<Stop> {
        (self.0)()
    }
}

impl fmt::Debug for Interrupt<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Interrupt").field(&self.stop()).finish()
    }
}

/// A running budget.
#[derive(Debug, Clone)]
pub struct Clock {
    deadline: Option<Instant>,
    started: Instant,
    cancel: Cancel,
}

impl Clock {
    /// Starts the clock of `budget`.
    pub fn start(budget: &Budget) -> Self {
        let started = Instant::now();
        // A limit too long to represent is no limit.
        let deadline = budget.time.and_then(|time| started.checked_add(time));
        Self { deadline, started, cancel: budget.cancel.clone() }
    }

    /// `Some` if time is up or the planner was cancelled.
    pub fn stop(&self) -> Option<Stop> {
        if self.cancel.is_cancelled() {
            return Some(Stop::Cancelled);
        }
        let late = self.deadline.is_some_and(|deadline| Instant::now() >= deadline);
        late.then_some(Stop::TimeLimit)
    }

    /// Time since the start.
    pub fn elapsed(&self) -> Duration {
        self.started.elapsed()
    }
}
