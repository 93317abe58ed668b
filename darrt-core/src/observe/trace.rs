//! Keeps a printable line per event: for tests and for finding out what a search did.

use std::ops::ControlFlow;

use super::{Event, Observer};

/// Records every event as text.
#[derive(Debug, Clone, Default)]
pub struct Trace {
    lines: Vec<String>,
}

impl Trace {
    /// The lines so far.
    pub fn lines(&self) -> &[String] {
        &self.lines
    }
}

impl Observer for Trace {
    fn on_event(&mut self, event: &Event<'_>) -> ControlFlow<()> {
        self.lines.push(format!("{event:?}"));
        ControlFlow::Continue(())
    }
}
