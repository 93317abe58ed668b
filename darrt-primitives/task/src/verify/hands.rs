//! The robot as each of its hands sees it: which of them is at work says the step.

use std::sync::Arc;

use super::refusal::{Refusal, RefusalKind, Site};
use super::robot::{Frame, Robot};
use crate::plan_file::Step;
use crate::robot::RobotFacts;

/// One [`Robot`] for each hand; they share all that is no hand's own.
#[derive(Debug)]
pub(super) struct Hands {
    pub(super) first: Arc<Robot>,
    others: Vec<Arc<Robot>>,
}

impl Hands {
    pub(super) fn new(facts: &RobotFacts) -> Result<Self, Refusal> {
        let frame = Frame::new(facts)?;
        let robot = |hand| Robot::new(&frame, facts, hand).map(Arc::new);
        Ok(Self { first: robot(0)?, others: (1..facts.hands()).map(robot).collect::<Result<_, _>>()? })
    }

    /// As the hand with this number, from 0, sees it.
    pub(super) fn get(&self, hand: usize) -> &Arc<Robot> {
        hand.checked_sub(1).and_then(|other| self.others.get(other)).unwrap_or(&self.first)
    }

    /// As each of them sees it, the first first.
    pub(super) fn all(&self) -> impl Iterator<Item = &Robot> {
        std::iter::once(&self.first).chain(&self.others).map(|robot| &**robot)
    }

    /// As the hand at work in a step sees it; refuses a tool that the robot does not have.
    pub(super) fn of_step(&self, site: Site<'_>, step: &Step, facts: &RobotFacts) -> Result<&Arc<Robot>, Refusal> {
        let refuse =
            |error: crate::plan_file::UnknownTool| site.refusal(0.0, RefusalKind::Malformed, error.to_string());
        step.hand(facts).map(|hand| self.get(hand)).map_err(refuse)
    }
}

#[cfg(test)]
mod tests;
