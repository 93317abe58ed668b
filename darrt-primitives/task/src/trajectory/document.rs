//! One document with everything a driver needs: trajectories by group, commands to the hand, and where to look.

use std::collections::BTreeMap;

use serde::Serialize;

use super::Sampled;
use super::messages::{GripperCommand, JointTrajectory, Seconds};
use crate::clock::EventKind;
use crate::plan_file::PlanFile;

/// The value of the key `format`.
pub const FORMAT: &str = "darrt-trajectory";
/// The version of the format.
pub const VERSION: u32 = 1;

/// A timed plan for a driver.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Document {
    /// Always [`FORMAT`].
    pub format: &'static str,
    /// Always [`VERSION`].
    pub version: u32,
    /// The problem that the plan solves.
    pub problem: String,
    /// Seconds in all.
    pub duration_s: f64,
    /// The steps with their times.
    pub steps: Vec<StepTime>,
    /// Trajectories by the group of joints that a controller moves: `arm`, `base`, `gripper`, and `second_gripper` of a robot with
    /// two hands, whose `arm` is both arms.
    pub groups: BTreeMap<&'static str, JointTrajectory>,
    /// Where the other joints stand all along: torso, head, a second arm.
    pub standing: BTreeMap<String, f64>,
    /// What the hand is told.
    pub gripper_commands: Vec<TimedCommand>,
    /// Good times to look where everything is: before every contact and after every drive.
    pub sensing: Vec<SensingPoint>,
}

/// When a step is.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StepTime {
    /// Its number, from 1.
    pub step: usize,
    /// The name of its primitive.
    pub primitive: String,
    /// The object that it is about.
    pub object: Option<String>,
    /// The link of the tool frame of the hand at work; missing: the first.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tool: Option<String>,
    /// When it begins.
    pub begin: Seconds,
    /// When it ends.
    pub end: Seconds,
}

/// A command to the hand.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TimedCommand {
    /// When.
    pub time_from_start: Seconds,
    /// The step, from 1.
    pub step: usize,
    /// The link of the tool frame of the hand that is told; missing: the first.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tool: Option<String>,
    /// What it is told.
    pub command: GripperCommand,
}

/// A good time to look.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SensingPoint {
    /// When; the robot stands.
    pub time_from_start: Seconds,
    /// The step that begins then, from 1.
    pub step: usize,
}

impl Document {
    /// The document of a sampled plan.
    pub fn new(plan: &PlanFile, sampled: &Sampled) -> Self {
        let time = |step: usize| Seconds::from_s(sampled.timed().step_start_s(step).unwrap_or(0.0));
        let steps = plan.steps.iter().enumerate().map(|(index, step)| StepTime {
            step: index + 1,
            primitive: step.primitive.to_string(),
            tool: step.tool.clone(),
            object: step.object.clone(),
            begin: time(index),
            end: time(index + 1),
        });
        let events = sampled.events();
        let commands = events.iter().filter_map(|event| {
            let command = sampled.command(event)?;
            let tool = plan.steps.get(event.step).and_then(|step| step.tool.clone());
            Some(TimedCommand { time_from_start: Seconds::from_s(event.time_s), step: event.step + 1, tool, command })
        });
        let grippers = ["gripper", "second_gripper"].into_iter().zip(sampled.grippers());
        let sensing = events.iter().filter(|event| event.kind == EventKind::Sense);
        Self {
            format: FORMAT,
            version: VERSION,
            problem: plan.problem.name.clone(),
            duration_s: sampled.timed().duration_s(),
            steps: steps.collect(),
            groups: [("arm", sampled.arm()), ("base", sampled.base())].into_iter().chain(grippers).collect(),
            standing: sampled.standing().into_iter().collect(),
            gripper_commands: commands.collect(),
            sensing: sensing
                .map(|event| SensingPoint { time_from_start: Seconds::from_s(event.time_s), step: event.step + 1 })
                .collect(),
        }
    }
}
