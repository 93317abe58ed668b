//! The lines that show that the planner works, and how much is done; on a terminal only.

use std::io::Write as _;
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use darrt_core::observe::{Event, Observer};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use darrt_task::text::{counted, printable};

/// Time between two drawings of the line.
const PERIOD: Duration = Duration::from_millis(100);

/// Follows a planner on the standard error.
#[derive(Debug)]
pub(crate) struct Progress {
    bar: ProgressBar,
    counts: Counts,
    deadline: Option<Instant>,
    next: Instant,
    is_quiet: bool,
}

/// What the line says.
#[derive(Debug, Clone, PartialEq)]
struct Counts {
    iterations: u64,
    nodes: usize,
    nearest: f64,
    restarts: u64,
}

impl Progress {
    /// A line about `problem` with so much time left; hidden when the standard error is not a terminal or `is_quiet`.
    pub(crate) fn start(problem: &str, limit: Option<Duration>, is_quiet: bool) -> Self {
        let target = if is_quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
        let bar = ProgressBar::with_draw_target(None, target);
        if let Ok(style) = ProgressStyle::with_template("{spinner} {prefix}: {wide_msg}") {
            bar.set_style(style);
        }
        bar.set_prefix(printable(problem).into_owned());
        bar.set_message("preparing");
        bar.enable_steady_tick(PERIOD);
        let now = Instant::now();
        let counts = Counts { iterations: 0, nodes: 1, nearest: f64::INFINITY, restarts: 0 };
        Self { bar, counts, deadline: limit.and_then(|limit| now.checked_add(limit)), next: now, is_quiet }
    }

    /// A line that stays.
    fn tell(&self, doubt: &str) {
        if !self.is_quiet {
            // A standard error that has gone away is no reason not to plan.
            let line = printable(doubt);
            let _ = writeln!(std::io::stderr().lock(), "doubtful: {line}; it is searched for all the same");
        }
    }

    /// Takes the line away.
    pub(crate) fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.finish();
    }
}

/// How many of a known number of things are done, and the time that is left for the others.
#[derive(Debug)]
pub(crate) struct Bar(ProgressBar);

impl Bar {
    /// A bar for `count` things called `things`; hidden when the standard error is not a terminal or `is_quiet`.
    pub(crate) fn start(count: usize, things: &str, is_quiet: bool) -> Self {
        let target = if is_quiet || count == 0 { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
        let bar = ProgressBar::with_draw_target(Some(count as u64), target);
        let template = "{bar:32} {pos} of {len} {prefix}{msg}, {elapsed} so far, about {eta} left";
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        bar.set_prefix(things.to_owned());
        bar.enable_steady_tick(5 * PERIOD);
        Self(bar)
    }

    /// One more is done; `words` are said of all.
    pub(crate) fn advance(&self, words: &str) {
        self.0.inc(1);
        self.0.set_message(words.to_owned());
    }

    /// Takes the bar away.
    pub(crate) fn finish(&self) {
        self.0.finish_and_clear();
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.finish();
    }
}

impl Counts {
    fn add(&mut self, event: &Event<'_>) {
        match event {
            Event::AttemptStarted { attempt } => self.restarts = self.restarts.max(*attempt),
            Event::Iteration { nodes, nearest_to_goal, .. } => {
                self.iterations += 1;
                self.nodes = *nodes;
                self.nearest = self.nearest.min(*nearest_to_goal);
            }
            _ => {}
        }
    }

    fn line(&self, left: Option<Duration>) -> String {
        let near = self.nearest.is_finite().then(|| format!("{:.2} m to the goal", self.nearest));
        let restarts = (self.restarts > 0).then(|| counted(self.restarts, "restart"));
        let left = left.map(|left| format!("{} s left", left.as_secs()));
        let work = [counted(self.iterations, "iteration"), format!("tree {}", self.nodes)];
        work.into_iter().chain(near).chain(restarts).chain(left).collect::<Vec<_>>().join(", ")
    }
}

impl Observer for Progress {
    fn on_event(&mut self, event: &Event<'_>) -> ControlFlow<()> {
        if let Event::Doubt { reason } = event {
            self.bar.suspend(|| self.tell(reason));
        }
        self.counts.add(event);
        let now = Instant::now();
        if !self.bar.is_hidden() && now >= self.next {
            self.next = now + PERIOD;
            self.bar.set_message(self.counts.line(self.deadline.map(|end| end.saturating_duration_since(now))));
        }
        ControlFlow::Continue(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_adds_up_the_attempts() {
        let mut counts = Counts { iterations: 0, nodes: 1, nearest: f64::INFINITY, restarts: 0 };
        assert_eq!(counts.line(None), "0 iterations, tree 1");
        for (attempt, nodes, nearest_to_goal) in [(0, 5, 2.0), (0, 9, 1.5), (1, 2, 3.0)] {
            counts.add(&Event::AttemptStarted { attempt });
            let (iteration, added, blame) = (1, 1, None);
            counts.add(&Event::Iteration { attempt, iteration, nodes, added, nearest_to_goal, blame });
        }
        let line = counts.line(Some(Duration::from_millis(4900)));
        assert_eq!(line, "3 iterations, tree 2, 1.50 m to the goal, 1 restart, 4 s left");
    }
}
