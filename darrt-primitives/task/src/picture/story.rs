//! What the picture tells: the room, the robot, and what moves from step to step.

use nalgebra::Isometry3;

use crate::plan_file::{JointTable, PlanFile, Waypoint};
use crate::problem_file::geometry::Geometry;
use crate::problem_file::{PrimitiveName, ProblemFile};
use crate::robot::RobotFacts;
use crate::text::counted;

use super::PictureError;
use super::abridged::Telling;
use super::act::Act;
use super::model::{Model, Pose};

/// Largest coordinate that is drawn (m, rad).
const FARTHEST: f64 = 1e4;
/// Largest difference of a quaternion's norm from one.
const UNIT: f64 = 1e-3;

/// The state of everything that moves.
#[derive(Debug, Clone, PartialEq)]
pub struct Snapshot {
    /// Every joint of the robot and where it stands.
    pub robot: Pose,
    /// Pose of every object in the world, in the order of the problem.
    pub objects: Vec<Isometry3<f64>>,
}

/// One primitive of a plan.
#[derive(Debug, Clone, PartialEq)]
pub struct StoryStep {
    /// Its name.
    pub primitive: PrimitiveName,
    /// What it does.
    pub act: Act,
    /// Which hand is at work, from 0.
    pub hand: usize,
    /// Index of the object it acts on, if any.
    pub object: Option<usize>,
    /// The states it runs through, from its first to its last; at least one.
    pub snapshots: Vec<Snapshot>,
}

/// A problem and, where there is one, its plan.
#[derive(Debug, Clone)]
pub struct Story {
    /// The problem.
    pub problem: ProblemFile,
    /// Its solids.
    pub geometry: Geometry,
    /// The robot.
    pub model: Model,
    /// One line under the title, such as the seed.
    pub note: String,
    /// The state at the start.
    pub start: Snapshot,
    /// The steps of the plan; none for a problem.
    pub steps: Vec<StoryStep>,
    /// What each step stands for in an abridged story; empty when each stands for itself.
    pub(super) tellings: Vec<Telling>,
}

impl Story {
    /// The story of a problem for the robot of these facts: the room and the robot at its start, no steps.
    ///
    /// # Errors
    /// When a body or the robot cannot be built.
    pub fn of_problem(problem: &ProblemFile, robot: &RobotFacts) -> Result<Self, PictureError> {
        let geometry = problem.geometry()?;
        let model = Model::new(robot)?;
        let start = Snapshot {
            robot: Pose { base: problem.robot.base, joints: model.start.clone() },
            objects: geometry.objects.iter().map(|object| object.world_from_object).collect(),
        };
        let (steps, tellings) = (Vec::new(), Vec::new());
        Ok(Self { problem: problem.clone(), geometry, model, note: String::new(), start, steps, tellings })
    }

    /// The story of a plan for the robot of these facts.
    ///
    /// # Errors
    /// As [`Story::of_problem`]; when a step names an object that the problem does not have or a primitive without a contract,
    /// or a waypoint lacks a joint or an object.
    pub fn of_plan(plan: &PlanFile, robot: &RobotFacts) -> Result<Self, PictureError> {
        let mut story = Self::of_problem(&plan.problem, robot)?;
        let table = story.model.table.clone();
        story.start = snapshot(&plan.problem, &table, &plan.start, || "start".to_owned())?;
        for (index, step) in plan.steps.iter().enumerate() {
            let place = |at: usize| format!("steps[{index}].waypoints[{at}]");
            let waypoints = step.waypoints.iter().enumerate();
            let snapshots = waypoints.map(|(at, waypoint)| snapshot(&plan.problem, &table, waypoint, || place(at)));
            let snapshots = snapshots.collect::<Result<Vec<_>, _>>()?;
            if snapshots.is_empty() {
                return Err(missing(format!("steps[{index}]"), "waypoint", "any"));
            }
            let name = step.object.as_deref().or(step.pushes.as_deref());
            let object = name.map(|name| {
                let found = plan.problem.objects.iter().position(|object| object.name == name);
                found.ok_or_else(|| missing(format!("steps[{index}]"), "object", name))
            });
            let contract = plan.contracts.get(&step.primitive);
            let contract =
                contract.ok_or_else(|| missing("contracts".to_owned(), "primitive", step.primitive.as_str()))?;
            let hand = step.hand(robot).map_err(|error| {
                let place = format!("steps[{index}].tool");
                PictureError::Tool { place, error: Box::new(error) }
            })?;
            let (primitive, act) = (step.primitive.clone(), Act::of(contract));
            story.steps.push(StoryStep { primitive, act, hand, object: object.transpose()?, snapshots });
        }
        story.note = note(plan);
        Ok(story)
    }

    /// The state after step `index`, or the start for a plan without steps.
    pub fn end_of(&self, index: usize) -> &Snapshot {
        self.steps.get(index).and_then(|step| step.snapshots.last()).unwrap_or(&self.start)
    }

    /// The last state.
    pub fn end(&self) -> &Snapshot {
        self.end_of(self.steps.len().saturating_sub(1))
    }

    /// All states in order, the start first.
    pub fn snapshots(&self) -> impl Iterator<Item = &Snapshot> {
        std::iter::once(&self.start).chain(self.steps.iter().flat_map(|step| &step.snapshots))
    }

    /// Pose of the tool frame of a hand, counted from 0, in the world.
    pub fn world_from_tool(&self, snapshot: &Snapshot, hand: usize) -> Isometry3<f64> {
        self.model.world_from_tool(&snapshot.robot, hand)
    }

    /// The link of the tool frame of the hand at work in a step, for a robot with several hands.
    pub fn tool_of(&self, step: &StoryStep) -> Option<&str> {
        self.model.tool_name(step.hand)
    }
}

/// How the plan was found, in one line.
fn note(plan: &PlanFile) -> String {
    let facts = &plan.planner;
    format!(
        "Seed {}: {} found after {} and {}, tree of {}.",
        plan.seed,
        counted(plan.steps.len() as u64, "step"),
        counted(facts.iterations, "iteration"),
        counted(facts.restarts, "restart"),
        counted(facts.nodes, "node"),
    )
}

/// A waypoint in the words of the kinematics; `place` names it in errors.
fn snapshot(
    problem: &ProblemFile,
    table: &JointTable,
    waypoint: &Waypoint,
    place: impl Fn() -> String,
) -> Result<Snapshot, PictureError> {
    let joints = table
        .variables(&waypoint.joints)
        .map_err(|flaw| PictureError::Joints { place: place(), flaw: Box::new(flaw) })?;
    let robot = Pose { base: waypoint.base, joints };
    let within = |name: &str, value: f64, bound: f64| {
        let flaw = || PictureError::OutOfRange { place: place(), name: name.to_owned(), value, bound };
        if value.abs() <= bound { Ok(()) } else { Err(flaw()) }
    };
    waypoint.base.iter().try_for_each(|value| within("base", *value, FARTHEST))?;
    let pose = |name: &str| -> Result<_, PictureError> {
        let pose = waypoint.objects.get(name).ok_or_else(|| missing(place(), "object", name))?;
        pose.position.iter().try_for_each(|value| within(name, *value, FARTHEST))?;
        let norm = pose.quaternion.iter().map(|value| value * value).sum::<f64>().sqrt();
        within(&format!("{name} (norm of the quaternion, less one)"), norm - 1.0, UNIT)?;
        Ok(Isometry3::from(*pose))
    };
    let objects = problem.objects.iter().map(|object| pose(&object.name));
    Ok(Snapshot { robot, objects: objects.collect::<Result<_, PictureError>>()? })
}

fn missing(place: String, what: &'static str, name: &str) -> PictureError {
    PictureError::Missing { place, what, name: name.to_owned() }
}
