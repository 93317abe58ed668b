//! The waypoints of a plan as points of one space: x, y and yaw of the base, then the variables of the robot's tree.
//!
//! Yaw and continuous joints are unwound over the whole plan, so that what lies between two points is the straight line between
//! them.

use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::sync::Arc;

use darrt_primitives::contract::Contract;
use darrt_primitives::kinematics::KinematicTree;
use darrt_primitives::kinematics::urdf::JointKind;
use nalgebra::Isometry3;

use super::ClockError;
use crate::plan_file::{JointTable, PlanFile, Pose, Waypoint};
use crate::problem_file::Object;
use crate::robot::RobotFacts;

/// How many coordinates of a point are the base's.
pub(crate) const BASE: usize = 3;

/// What the clock must know of a robot.
#[derive(Debug)]
pub(crate) struct Body {
    pub(crate) tree: KinematicTree,
    pub(crate) table: JointTable,
    /// By variable: does it slide?
    pub(crate) slides: Vec<bool>,
    /// The variable that opens the hand.
    pub(crate) finger: usize,
    /// The variables of the arm.
    pub(crate) arm: Vec<usize>,
    pub(crate) tool: usize,
    /// The links between the root and the tool, and the tool, in ascending order.
    pub(crate) to_tool: Vec<usize>,
}

impl Body {
    pub(crate) fn new(facts: &RobotFacts) -> Result<Self, ClockError> {
        let tree = KinematicTree::new(&facts.description).map_err(|error| ClockError::Robot(error.to_string()))?;
        let joint = |name: &str| {
            let missing = || ClockError::Robot(format!("it has no joint `{name}`"));
            tree.variable_index(name).ok_or_else(missing)
        };
        let tool = || ClockError::Robot(format!("it has no link `{}`", facts.tool_link));
        let is_sliding = |name: &str| {
            let mut joints = facts.description.joints.iter();
            joints.any(|joint| *joint.name == *name && joint.kind == JointKind::Sliding)
        };
        let tool = tree.link_index(&facts.tool_link).ok_or_else(tool)?;
        let mut to_tool = vec![tool];
        // Parents come before their children, so this ends.
        while let Some(parent) = to_tool.last().and_then(|link| tree.parent(*link)).filter(|parent| *parent > 0) {
            to_tool.push(parent);
        }
        to_tool.reverse();
        Ok(Self {
            table: JointTable::new(&facts.description, &tree),
            slides: tree.variables().iter().map(|variable| is_sliding(&variable.name)).collect(),
            finger: joint(&facts.finger_joint)?,
            arm: facts.arm_joints.iter().map(|name| joint(name)).collect::<Result<_, _>>()?,
            tool,
            to_tool,
            tree,
        })
    }

    /// Does this coordinate of a point turn without end?
    fn is_endless(&self, coordinate: usize) -> bool {
        match coordinate.checked_sub(BASE) {
            Some(variable) => self.tree.variables().get(variable).is_some_and(|v| v.limit.is_unlimited()),
            None => coordinate == 2,
        }
    }

    /// The point of a waypoint, turns counted on from the point `before`.
    fn point(&self, at: &Waypoint, before: Option<&[f64]>) -> Result<Vec<f64>, String> {
        let joints = self.table.variables(&at.joints).map_err(|flaw| flaw.to_string())?;
        let mut point: Vec<f64> = at.base.into_iter().chain(joints).collect();
        if let Some(value) = point.iter().find(|value| !value.is_finite()) {
            return Err(format!("{value} is no finite number"));
        }
        for (coordinate, (slot, before)) in point.iter_mut().zip(before.into_iter().flatten()).enumerate() {
            if self.is_endless(coordinate) {
                *slot += TAU * ((before - *slot) / TAU).round();
            }
        }
        Ok(point)
    }
}

/// A step as points.
#[derive(Debug)]
pub(crate) struct StepTrack {
    pub(crate) contract: Contract,
    /// By waypoint.
    pub(crate) points: Vec<Vec<f64>>,
    /// By waypoint: where the objects are.
    pub(crate) objects: Vec<BTreeMap<Arc<str>, Pose>>,
    /// The object in the hand, and its pose in the frame of the tool.
    pub(crate) holds: Option<(Object, Isometry3<f64>)>,
    /// The object that slides.
    pub(crate) pushes: Option<Object>,
}

/// A plan as points.
#[derive(Debug)]
pub(crate) struct Track {
    pub(crate) start: Vec<f64>,
    pub(crate) steps: Vec<StepTrack>,
}

impl Track {
    pub(crate) fn new(plan: &PlanFile, body: &Body) -> Result<Self, ClockError> {
        let start =
            body.point(&plan.start, None).map_err(|why| ClockError::Waypoint { place: "start".to_owned(), why })?;
        let mut last = start.clone();
        let mut steps = Vec::with_capacity(plan.steps.len());
        for (index, step) in plan.steps.iter().enumerate() {
            let object = |name: &String| {
                let missing = || ClockError::Missing { step: index + 1, what: "object", name: name.clone() };
                plan.problem.objects.iter().find(|object| object.name == *name).cloned().ok_or_else(missing)
            };
            let contract = *plan.contracts.get(&step.primitive).ok_or_else(|| {
                let name = step.primitive.to_string();
                ClockError::Missing { step: index + 1, what: "contract", name }
            })?;
            let mut points = Vec::with_capacity(step.waypoints.len());
            for (at, waypoint) in step.waypoints.iter().enumerate() {
                last = body.point(waypoint, Some(&last)).map_err(|why| {
                    let place = format!("steps[{index}].waypoints[{at}]");
                    ClockError::Waypoint { place, why }
                })?;
                points.push(last.clone());
            }
            if points.len() < 2 {
                return Err(ClockError::Missing { step: index + 1, what: "waypoint", name: "second".to_owned() });
            }
            let holds = step.holds.as_ref().map(|hold| Ok((object(&hold.object)?, hold.tool_from_object.into())));
            let pushes = step.pushes.as_ref().map(object);
            let objects = step.waypoints.iter().map(|waypoint| waypoint.objects.clone()).collect();
            steps.push(StepTrack { contract, points, objects, holds: holds.transpose()?, pushes: pushes.transpose()? });
        }
        Ok(Self { start, steps })
    }
}
