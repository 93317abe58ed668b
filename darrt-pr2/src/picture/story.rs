//! What the picture tells: the room, the robot, and what moves from step to step.

use std::path::PathBuf;

use nalgebra::Isometry3;

use crate::arm::{ArmConfiguration, JOINT_NAMES, Side};
use crate::gripper;
use crate::model::{Pr2Model, WholeBody};
use crate::plan_file::{PlanFile, Waypoint};
use crate::postures::ArmPosture;
use crate::problem_file::geometry::Geometry;
use crate::problem_file::{ArmSide, PrimitiveName, ProblemFile};
use crate::words::counted;

use super::PictureError;
use super::abridged::Telling;

/// Gap between the fingers where nothing says otherwise (m).
const OPEN_GAP: f64 = 0.08;

/// Largest coordinate that is drawn (m, rad).
const FARTHEST: f64 = 1e4;
/// Largest difference of a quaternion's norm from one.
const UNIT: f64 = 1e-3;

/// The state of everything that moves.
#[derive(Debug, Clone, PartialEq)]
pub struct Snapshot {
    /// Every joint of the robot and where it stands.
    pub robot: WholeBody,
    /// Pose of every object in the world, in the order of the problem.
    pub objects: Vec<Isometry3<f64>>,
}

/// One primitive of a plan.
#[derive(Debug, Clone, PartialEq)]
pub struct StoryStep {
    /// Its name.
    pub primitive: PrimitiveName,
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
    pub model: Pr2Model,
    /// The arm that manipulates.
    pub side: Side,
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
    /// The story of a problem: the room and the robot at its start, no steps.
    ///
    /// # Errors
    /// When a body or the robot cannot be built, or the start names an unknown posture.
    pub fn of_problem(problem: &ProblemFile) -> Result<Self, PictureError> {
        let geometry = problem.geometry()?;
        let model = match &problem.robot.urdf {
            None => Pr2Model::embedded()?,
            Some(file) => {
                let folders: Vec<PathBuf> = file.parent().map(PathBuf::from).into_iter().collect();
                Pr2Model::from_file(file, &folders)?
            }
        };
        let start = Snapshot {
            robot: starting_robot(problem)?,
            objects: geometry.objects.iter().map(|object| object.world_from_object).collect(),
        };
        let side = side_of(problem.robot.arm);
        let (steps, tellings) = (Vec::new(), Vec::new());
        Ok(Self { problem: problem.clone(), geometry, model, side, note: String::new(), start, steps, tellings })
    }

    /// The story of a plan.
    ///
    /// # Errors
    /// As [`Story::of_problem`]; when a step names an object that the problem does not have, or a waypoint lacks a joint
    /// or an object.
    pub fn of_plan(plan: &PlanFile) -> Result<Self, PictureError> {
        let mut story = Self::of_problem(&plan.problem)?;
        story.start = snapshot(&plan.problem, &plan.start, || "start".to_owned())?;
        for (index, step) in plan.steps.iter().enumerate() {
            let place = |at: usize| format!("steps[{index}].waypoints[{at}]");
            let waypoints = step.waypoints.iter().enumerate();
            let snapshots = waypoints.map(|(at, waypoint)| snapshot(&plan.problem, waypoint, || place(at)));
            let snapshots = snapshots.collect::<Result<Vec<_>, _>>()?;
            if snapshots.is_empty() {
                return Err(missing(format!("steps[{index}]"), "waypoint", "any"));
            }
            let name = step.object.as_deref().or(step.pushes.as_deref());
            let object = name.map(|name| {
                let found = plan.problem.objects.iter().position(|object| object.name == name);
                found.ok_or_else(|| missing(format!("steps[{index}]"), "object", name))
            });
            story.steps.push(StoryStep { primitive: step.primitive, object: object.transpose()?, snapshots });
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

    /// Pose of the hand's tool frame in the world.
    pub fn world_from_tool(&self, snapshot: &Snapshot) -> Isometry3<f64> {
        let [right, left] = &snapshot.robot.arms;
        let joints = if self.side == Side::Right { right } else { left };
        crate::forward::ArmChain::new(self.side, snapshot.robot.torso_m).world_from_tool(&snapshot.robot.base, joints)
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
fn snapshot(problem: &ProblemFile, waypoint: &Waypoint, place: impl Fn() -> String) -> Result<Snapshot, PictureError> {
    let joint = |name: &str| waypoint.joints.get(name).copied().ok_or_else(|| missing(place(), "joint", name));
    let mut robot = WholeBody { base: waypoint.base, ..WholeBody::at_rest() };
    robot.torso_m = joint("torso_lift_joint")?;
    robot.head = [joint("head_pan_joint")?, joint("head_tilt_joint")?];
    let sides = Side::BOTH.into_iter().zip(&mut robot.arms).zip(&mut robot.finger_angles);
    for ((side, arm), finger) in sides {
        for (slot, name) in arm.iter_mut().zip(JOINT_NAMES) {
            *slot = joint(&format!("{}_{name}_joint", side.prefix()))?;
        }
        *finger = joint(&format!("{}_gripper_l_finger_joint", side.prefix()))?;
    }
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

/// The arm of a problem file in the words of the kinematics.
const fn side_of(arm: ArmSide) -> Side {
    match arm {
        ArmSide::Right => Side::Right,
        ArmSide::Left => Side::Left,
    }
}

fn starting_robot(problem: &ProblemFile) -> Result<WholeBody, PictureError> {
    let robot = &problem.robot;
    let side = side_of(robot.arm);
    let mine = arm_start(side, robot.posture.as_deref(), robot.joints.as_deref())?;
    let other = arm_start(side.other(), robot.other_posture.as_deref(), robot.other_joints.as_deref())?;
    let arms = if side == Side::Right { [mine, other] } else { [other, mine] };
    Ok(WholeBody {
        base: robot.base,
        torso_m: robot.torso_m,
        arms,
        finger_angles: [gripper::finger_angle(OPEN_GAP); 2],
        ..WholeBody::at_rest()
    })
}

fn arm_start(side: Side, posture: Option<&str>, joints: Option<&[f64]>) -> Result<ArmConfiguration, PictureError> {
    if let Some(joints) = joints {
        let expected = JOINT_NAMES.len();
        return joints.try_into().map_err(|_| PictureError::Joints { found: joints.len(), expected });
    }
    let name = posture.unwrap_or(crate::problem_file::robot::DEFAULT_POSTURE);
    let posture = ArmPosture::from_name(name).ok_or_else(|| PictureError::Posture { name: name.to_owned() })?;
    Ok(posture.values(side))
}
