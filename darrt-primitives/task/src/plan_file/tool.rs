//! Which hand of a robot with several is at work in a step.

use super::{Step, Waypoint};
use crate::problem_file::PrimitiveName;
use crate::problem_file::suggest::{hint, nearest};
use crate::robot::RobotFacts;

/// A step names a tool that the robot does not have.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`tool` is `{name}`, no tool of the robot{}; there are {}", hint(nearest.as_deref()), available.join(", "))]
pub struct UnknownTool {
    /// The name in the file.
    pub name: String,
    /// The nearest of the robot's.
    pub nearest: Option<String>,
    /// The robot's.
    pub available: Vec<String>,
}

impl Step {
    /// Which of the robot's hands is at work in the step, counted from 0: the one whose tool it names, the first if it names none.
    ///
    /// # Errors
    /// [`UnknownTool`] with the names of the robot's tools.
    pub fn hand(&self, robot: &RobotFacts) -> Result<usize, UnknownTool> {
        self.hand_among(&tool_links(robot))
    }

    /// The same for a robot with these tools, by hand.
    pub(crate) fn hand_among(&self, tools: &[&str]) -> Result<usize, UnknownTool> {
        let Some(name) = &self.tool else { return Ok(0) };
        tools.iter().position(|tool| *tool == name.as_str()).ok_or_else(|| UnknownTool {
            name: name.clone(),
            nearest: nearest(name, tools.iter().copied()).map(str::to_owned),
            available: tools.iter().copied().map(str::to_owned).collect(),
        })
    }
}

/// A step in which the fingers of one hand open or close while all else stands, from one waypoint to another; `tool` as in [`Step`].
pub(crate) fn fingers_alone(tool: Option<String>, ends: [Waypoint; 2]) -> Step {
    Step {
        primitive: PrimitiveName::ARM_TRANSIT,
        object: None,
        tool,
        holds: None,
        pushes: None,
        allowed_contacts: Vec::new(),
        waypoints: ends.into(),
    }
}

/// The links of the tool frames of a robot, by hand.
pub(crate) fn tool_links(robot: &RobotFacts) -> Vec<&str> {
    let second = robot.second.iter().map(|hand| &hand.tool_link);
    std::iter::once(&robot.tool_link).chain(second).map(String::as_str).collect()
}
