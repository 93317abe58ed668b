//! From the planner's plan to a plan file: every step as waypoints, every joint by name, every contact with its reason.

use std::collections::BTreeMap;
use std::sync::Arc;

use darrt_core::motion::{Instance, Motion};
use darrt_core::plan::{Plan, Step as PlanStep};
use darrt_primitives::mode::{Mode, TouchReason};

use crate::arm::Side;
use crate::model::embedded_description;
use crate::plan_file::{
    AllowedContact, ContactReason, Hold, JointTable, PlanFile, PlanFormat, PlannerFacts, Pose, Step, VERSION, Waypoint,
};
use crate::planning_error::PlanningError;
use crate::problem_file::{PrimitiveName, ProblemFile};
use crate::world::{World, WorldState};
use darrt_primitives::kinematics::RobotDescription;

/// Largest travel of any point of the robot between two waypoints, metres.
const WAYPOINT_SPACING: f64 = 0.05;

/// Writes plans of one problem.
#[derive(Debug)]
pub struct Exporter {
    joints: JointTable,
    problem: ProblemFile,
}

impl Exporter {
    /// For plans of `problem`.
    ///
    /// # Errors
    /// [`PlanningError`] when the robot's description cannot be read.
    pub fn new(problem: &ProblemFile, world: &World) -> Result<Self, PlanningError> {
        let description = match &problem.robot.urdf {
            Some(path) => RobotDescription::from_file(path),
            None => embedded_description().cloned(),
        }
        .map_err(crate::model::ModelError::from)?;
        let joints = JointTable::new(&description, world.manipulator().model().tree());
        Ok(Self { joints, problem: problem.clone() })
    }

    /// The plan as a file.
    pub fn export(&self, m: &World, plan: &Plan<World>, seed: u64, planner: PlannerFacts) -> PlanFile {
        self.with_steps(m, plan, self.steps(m, plan), seed, planner)
    }

    /// The plan as a file, its steps written before.
    pub(crate) fn with_steps(
        &self,
        m: &World,
        plan: &Plan<World>,
        steps: Vec<Step>,
        seed: u64,
        planner: PlannerFacts,
    ) -> PlanFile {
        PlanFile {
            format: PlanFormat::DarrtPlan,
            version: VERSION,
            problem: self.problem.clone(),
            seed,
            planner,
            start: self.waypoint(m, plan.start(), plan.start().mode.gap_m()),
            steps,
        }
    }

    fn steps(&self, m: &World, plan: &Plan<World>) -> Vec<Step> {
        let mut before = plan.start().clone();
        let mut steps: Vec<Step> = Vec::with_capacity(plan.steps().len());
        let mut was_steady = false;
        for step in plan.steps() {
            let (written, end, is_steady) = self.step(m, step, &before);
            match steps.last_mut().filter(|last| was_steady && is_steady && goes_on(last, &written)) {
                Some(last) => last.waypoints.extend(written.waypoints.into_iter().skip(1)),
                None => steps.push(written),
            }
            (before, was_steady) = (end, is_steady);
        }
        steps
    }

    /// One step, the state it ends in, and whether the hand neither opens nor closes in it.
    fn step(&self, m: &World, step: &PlanStep<World>, before: &WorldState) -> (Step, WorldState, bool) {
        let instance = &step.instance;
        let inside = instance.at(m, f64::MIN_POSITIVE, before);
        let mut waypoints = vec![self.waypoint(m, before, before.mode.gap_m())];
        let gap_m = inside.mode.gap_m();
        if gap_m != before.mode.gap_m() {
            waypoints.push(self.waypoint(m, before, gap_m));
        }
        let mut end = before.clone();
        for t in parameters(&*instance.motion, step.until) {
            instance.motion.at_into(m, t, &mut end);
            waypoints.push(self.waypoint(m, &end, gap_m));
        }
        if end.mode.gap_m() != gap_m {
            waypoints.push(self.waypoint(m, &end, end.mode.gap_m()));
        }
        let name = |id| m.movable(id).map(|o| o.body.name.to_string());
        let primitive = PrimitiveName::ALL.into_iter().find(|p| p.as_str() == instance.label);
        let primitive = match primitive.unwrap_or(PrimitiveName::ArmTransit) {
            // What is cut short before the object stands has only carried it.
            PrimitiveName::Place if step.until < 1.0 => PrimitiveName::ArmRigidTransfer,
            primitive => primitive,
        };
        let written = Step {
            primitive,
            object: instance.object.and_then(name),
            holds: hold(m, &inside.mode),
            pushes: instance.object.and_then(name).filter(|_| primitive == PrimitiveName::Push),
            allowed_contacts: contacts(m, instance, &inside.mode, primitive),
            waypoints,
        };
        let is_steady = [before.mode.gap_m(), end.mode.gap_m()] == [gap_m; 2];
        (written, end, is_steady)
    }

    fn waypoint(&self, m: &World, state: &WorldState, gap_m: f64) -> Waypoint {
        let body = m.manipulator().whole_body(&state.robot, gap_m);
        let joints = self.joints.complete(&m.manipulator().model().joint_values(&body));
        let poses = m.movables().iter().zip(&state.objects);
        let objects: BTreeMap<_, _> = poses.map(|(o, pose)| (Arc::clone(&o.body.name), Pose::from(*pose))).collect();
        Waypoint { base: state.robot.base, joints, objects }
    }
}

/// Is the second step more of what the first does? Transits and transfers are free to turn at any waypoint.
fn goes_on(step: &Step, next: &Step) -> bool {
    let may_turn = matches!(
        step.primitive,
        PrimitiveName::ArmTransit
            | PrimitiveName::ArmRigidTransfer
            | PrimitiveName::BaseTransit
            | PrimitiveName::BaseRigidTransfer
    );
    may_turn
        && (step.primitive, &step.object, &step.holds, &step.allowed_contacts)
            == (next.primitive, &next.object, &next.holds, &next.allowed_contacts)
}

/// The parameters of the waypoints: all knots up to `until`, and more between them so that none is far from the next.
fn parameters(motion: &dyn Motion<World>, until: f64) -> Vec<f64> {
    let mut out = Vec::new();
    let mut last = 0.0;
    let knots = motion.knots().iter().copied().filter(|t| *t > 0.0 && *t < until);
    for t in knots.chain([until]) {
        let steps = ((t - last) * motion.length() / WAYPOINT_SPACING).ceil().clamp(1.0, 10_000.0);
        let mut i = 1.0;
        while i < steps {
            out.push(last + (t - last) * i / steps);
            i += 1.0;
        }
        out.push(t);
        last = t;
    }
    out
}

fn hold(m: &World, mode: &Mode) -> Option<Hold> {
    let held = mode.held()?;
    let object = m.movable(held.object)?.body.name.to_string();
    Some(Hold { object, tool_from_object: Pose::from(held.tool_from_object) })
}

/// What may touch in this step besides what rests on its support.
fn contacts(m: &World, instance: &Instance<World>, mode: &Mode, primitive: PrimitiveName) -> Vec<AllowedContact> {
    let side: Side = m.manipulator().arm().side;
    let name = |id| m.movable(id).map(|o| o.body.name.to_string());
    let mut out = Vec::new();
    let fingers = instance.contacts.fingers.or_else(|| Some((mode.held()?.object, TouchReason::Grasp)));
    if let Some((object, reason)) = fingers
        && let Some(object) = name(object)
    {
        let reason = match reason {
            TouchReason::Push => ContactReason::Push,
            TouchReason::Retreat => ContactReason::Retreat,
            TouchReason::Grasp | TouchReason::Support => ContactReason::Grasp,
        };
        out.extend(AllowedContact::fingers(side, &object, reason));
    }
    if matches!(primitive, PrimitiveName::Pick | PrimitiveName::Place)
        && let Some((object, surface)) = instance.contacts.support
        && let (Some(object), Some(support)) = (name(object), m.supports().get(surface.index()))
    {
        out.extend(support.bodies.iter().map(|body| AllowedContact::support(&object, body)));
    }
    out
}
