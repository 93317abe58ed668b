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
    /// The variables of all its arms.
    pub(crate) arm: Vec<usize>,
    pub(crate) first: BodyHand,
    pub(crate) others: Vec<BodyHand>,
}

/// What the clock must know of a hand.
#[derive(Debug)]
pub(crate) struct BodyHand {
    /// The variable that opens it.
    pub(crate) finger: usize,
    pub(crate) tool: usize,
    /// The links between the root and the tool, and the tool, in ascending order.
    pub(crate) to_tool: Vec<usize>,
    pub(crate) grip_force_n: f64,
}

impl Body {
    pub(crate) fn new(facts: &RobotFacts) -> Result<Self, ClockError> {
        let tree = KinematicTree::new(&facts.description).map_err(|error| ClockError::Robot(error.to_string()))?;
        let joint = |name: &str| {
            let missing = || ClockError::Robot(format!("it has no joint `{name}`"));
            tree.variable_index(name).ok_or_else(missing)
        };
        let is_sliding = |name: &str| {
            let mut joints = facts.description.joints.iter();
            joints.any(|joint| *joint.name == *name && joint.kind == JointKind::Sliding)
        };
        Ok(Self {
            table: JointTable::new(&facts.description, &tree),
            slides: tree.variables().iter().map(|variable| is_sliding(&variable.name)).collect(),
            arm: facts.all_arm_joints().into_iter().map(joint).collect::<Result<_, _>>()?,
            first: BodyHand::new(facts, 0, &tree)?,
            others: (1..facts.hands()).map(|hand| BodyHand::new(facts, hand, &tree)).collect::<Result<_, _>>()?,
            tree,
        })
    }

    /// The hand with this number, from 0.
    pub(crate) fn hand(&self, hand: usize) -> &BodyHand {
        hand.checked_sub(1).and_then(|other| self.others.get(other)).unwrap_or(&self.first)
    }

    /// All of them, in order.
    pub(crate) fn hands(&self) -> impl Iterator<Item = &BodyHand> {
        std::iter::once(&self.first).chain(&self.others)
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

impl BodyHand {
    fn new(facts: &RobotFacts, hand: usize, tree: &KinematicTree) -> Result<Self, ClockError> {
        let facts = facts.of_hand(hand);
        let missing = |what: &str, name: &str| ClockError::Robot(format!("it has no {what} `{name}`"));
        let tool = tree.link_index(&facts.tool_link).ok_or_else(|| missing("link", &facts.tool_link))?;
        let mut to_tool = vec![tool];
        // Parents come before their children, so this ends.
        while let Some(parent) = to_tool.last().and_then(|link| tree.parent(*link)).filter(|parent| *parent > 0) {
            to_tool.push(parent);
        }
        to_tool.reverse();
        let finger = tree.variable_index(&facts.finger_joint).ok_or_else(|| missing("joint", &facts.finger_joint))?;
        Ok(Self { finger, tool, to_tool, grip_force_n: facts.grip_force_n })
    }
}

/// A step as points.
#[derive(Debug)]
pub(crate) struct StepTrack {
    pub(crate) contract: Contract,
    /// Which hand is at work, from 0.
    pub(crate) hand: usize,
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
    pub(crate) fn new(plan: &PlanFile, body: &Body, facts: &RobotFacts) -> Result<Self, ClockError> {
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
            let hand = step.hand(facts).map_err(|error| ClockError::Tool { step: index + 1, error })?;
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
            let (holds, pushes) = (holds.transpose()?, pushes.transpose()?);
            steps.push(StepTrack { contract, hand, points, objects, holds, pushes });
        }
        Ok(Self { start, steps })
    }
}
