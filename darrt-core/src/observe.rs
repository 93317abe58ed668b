//! What a planner tells while it works.

use std::ops::ControlFlow;

use crate::budget::Stop;
use crate::validity::Blame;

pub mod accounts;
pub mod trace;

/// One thing that happened. Events of concurrent attempts interleave; `attempt` tells them apart.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Event<'a> {
    /// Before the search: what makes it unlikely that there is a plan. The search goes on.
    Doubt {
        /// In words.
        reason: &'a str,
    },
    /// An attempt starts from the initial state (attempt 0 is the first; each later one is a restart).
    AttemptStarted {
        /// Number of the attempt.
        attempt: u64,
    },
    /// One iteration of Algorithm 1 has ended.
    Iteration {
        /// Number of the attempt.
        attempt: u64,
        /// Iterations done in this attempt.
        iteration: u64,
        /// Nodes in this attempt's tree.
        nodes: usize,
        /// States added by this iteration.
        added: usize,
        /// Metres (by the planner's distance) from the goal to the nearest state so far.
        nearest_to_goal: f64,
        /// What blocked the extension.
        blame: Option<&'a Blame>,
    },
    /// A state satisfied the goal but the verifier refused the plan; the search goes on.
    Refused {
        /// Number of the attempt.
        attempt: u64,
        /// The verifier's reason.
        reason: &'a str,
    },
    /// A verified solution.
    Solved {
        /// Number of the attempt.
        attempt: u64,
        /// Iterations done in this attempt.
        iteration: u64,
    },
    /// The attempt has ended.
    AttemptEnded {
        /// Number of the attempt.
        attempt: u64,
        /// Why.
        stop: Stop,
    },
}

/// Receives events. Returning `Break` stops the planner as if it had been cancelled.
///
/// # Example
/// ```
/// use std::ops::ControlFlow;
///
/// use darrt_core::observe::{Event, Observer};
///
/// /// Stops once the tree has a million nodes.
/// struct Bounded;
///
/// impl Observer for Bounded {
///     fn on_event(&mut self, event: &Event<'_>) -> ControlFlow<()> {
///         match event {
///             Event::Iteration { nodes: 1_000_000.., .. } => ControlFlow::Break(()),
///             _ => ControlFlow::Continue(()),
///         }
///     }
/// }
/// ```
pub trait Observer: Send {
    /// Called from the thread on which the event happens, one call at a time.
    fn on_event(&mut self, event: &Event<'_>) -> ControlFlow<()>;
}

/// Ignores everything.
#[derive(Debug, Clone, Copy, Default)]
pub struct Silent;

impl Observer for Silent {
    fn on_event(&mut self, _: &Event<'_>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}
