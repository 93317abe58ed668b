//! From the planner's plan to a plan file: every step as waypoints, every joint by name, every contact with its reason.

use std::collections::BTreeMap;
use std::sync::Arc;

use darrt_core::motion::{Instance, Motion};
use darrt_core::plan::{Plan, Step as PlanStep};
use darrt_core::primitive::PrimitiveId;
use darrt_primitives::contract::{Contract, HandUse};
use darrt_primitives::kinematics::KinematicTree;
use darrt_primitives::manipulator::JointVector as _;
use darrt_primitives::mode::{Mode, TouchReason};
use darrt_primitives::primitive::{ARM_RIGID_TRANSFER, ARM_TRANSIT};
use darrt_primitives::tabletop::{Tabletop, TabletopState};

use crate::plan_file::tool::fingers_alone;
use crate::plan_file::{
    AllowedContact, ContactReason, Hold, JointTable, PlanFile, PlanFormat, PlannerFacts, Pose, Step, VERSION, Waypoint,
};
use crate::problem_file::{PrimitiveName, ProblemFile};
use crate::robot::{RobotError, RobotFacts, TaskRobot};

/// Largest travel of any point of the robot between two waypoints, metres.
const WAYPOINT_SPACING: f64 = 0.05;

/// Writes plans of one problem.
#[derive(Debug)]
pub struct Exporter {
    joints: JointTable,
    hands: Vec<HandNames>,
    problem: ProblemFile,
}

/// The links of a hand that plan files name.
#[derive(Debug)]
struct HandNames {
    tool: String,
    fingers: Vec<String>,
}

/// A plan with an instance of a primitive that its domain does not know, so that nobody could judge it.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "step {step} is an instance of {primitive}, of which the domain knows no contract; see Tabletop::with_primitives"
)]
pub struct UnknownPrimitive {
    /// Number of the step of the planner, from 1.
    pub step: usize,
    /// The primitive.
    pub primitive: PrimitiveId,
}

impl Exporter {
    /// For plans of `problem`, by the robot of these facts.
    ///
    /// # Errors
    /// [`RobotError`] when the robot's description has no tree.
    pub fn new(problem: &ProblemFile, facts: &RobotFacts) -> Result<Self, RobotError> {
        let tree = KinematicTree::new(&facts.description)?;
        let joints = JointTable::new(&facts.description, &tree);
        let names = |hand| {
            let facts = facts.of_hand(hand);
            HandNames { tool: facts.tool_link.clone(), fingers: facts.finger_links.clone() }
        };
        Ok(Self { joints, hands: (0..facts.hands()).map(names).collect(), problem: problem.clone() })
    }

    /// The plan as a file.
    ///
    /// # Errors
    /// [`UnknownPrimitive`].
    pub fn export<M: TaskRobot>(
        &self,
        m: &Tabletop<M>,
        plan: &Plan<Tabletop<M>>,
        seed: u64,
        planner: PlannerFacts,
    ) -> Result<PlanFile, UnknownPrimitive> {
        let written = self.steps(m, plan)?;
        Ok(self.with_steps(m, plan, written, seed, planner))
    }

    /// The plan as a file, its steps written before.
    pub(crate) fn with_steps<M: TaskRobot>(
        &self,
        m: &Tabletop<M>,
        plan: &Plan<Tabletop<M>>,
        (steps, contracts): Written,
        seed: u64,
        planner: PlannerFacts,
    ) -> PlanFile {
        PlanFile {
            format: PlanFormat::DarrtPlan,
            version: VERSION,
            problem: self.problem.clone(),
            seed,
            planner,
            contracts,
            partial: None,
            start: self.waypoint(m, plan.start(), plan.start().mode.gap_m()),
            steps,
            timing: None,
        }
    }

    fn steps<M: TaskRobot>(&self, m: &Tabletop<M>, plan: &Plan<Tabletop<M>>) -> Result<Written, UnknownPrimitive> {
        let mut before = plan.start().clone();
        let mut gap_m = before.mode.gap_m();
        let mut steps: Vec<Step> = Vec::with_capacity(plan.steps().len());
        let mut contracts = BTreeMap::new();
        let mut was_steady = false;
        for (number, step) in (1..).zip(plan.steps()) {
            let (primitive, contract) =
                written_as(m, step).ok_or(UnknownPrimitive { step: number, primitive: step.instance.primitive })?;
            let primitive = PrimitiveName::new(primitive.name());
            let inside = step.instance.at(m, f64::MIN_POSITIVE, &before);
            let hand = inside.robot.arm.hand_at_work();
            if hand != before.robot.arm.hand_at_work() {
                let idle_gap_m = m.manipulator().idle_gap_m();
                if gap_m != idle_gap_m {
                    let transit = m.contract(ARM_TRANSIT).copied();
                    let transit = transit.ok_or(UnknownPrimitive { step: number, primitive: ARM_TRANSIT })?;
                    let leaves = self.leaves_hand(m, &before, [gap_m, idle_gap_m]);
                    contracts.entry(leaves.primitive.clone()).or_insert(transit);
                    steps.push(leaves);
                    was_steady = false;
                }
                before.robot.arm = before.robot.arm.with_hand_at_work(hand);
                gap_m = idle_gap_m;
            }
            contracts.entry(primitive.clone()).or_insert(contract);
            let (written, end, is_steady) = self.step(m, step, (&before, gap_m), &inside.mode, (primitive, contract));
            let may_join = was_steady && is_steady && contract.is_free();
            match steps.last_mut().filter(|last| may_join && goes_on(last, &written)) {
                Some(last) => last.waypoints.extend(written.waypoints.into_iter().skip(1)),
                None => steps.push(written),
            }
            (gap_m, before, was_steady) = (end.mode.gap_m(), end, is_steady);
        }
        Ok((steps, contracts))
    }

    /// The hand that worked so far, free in the state `before`, opens or closes from one gap to the other, metres, before another goes
    /// to work: nothing else moves.
    fn leaves_hand<M: TaskRobot>(&self, m: &Tabletop<M>, before: &TabletopState<M>, gaps_m: [f64; 2]) -> Step {
        fingers_alone(self.tool(before), gaps_m.map(|gap_m| self.waypoint(m, before, gap_m)))
    }

    /// The tool of the hand at work in a state, as a step names it: not that of the first hand.
    fn tool<M: TaskRobot>(&self, state: &TabletopState<M>) -> Option<String> {
        let hand = state.robot.arm.hand_at_work();
        self.hands.get(hand).filter(|_| hand > 0).map(|hand| hand.tool.clone())
    }

    /// One step from a state in which the hand is open by so much, `mode` while it lasts; also the state it ends in, and whether the
    /// hand neither opens nor closes in it.
    fn step<M: TaskRobot>(
        &self,
        m: &Tabletop<M>,
        step: &PlanStep<Tabletop<M>>,
        (before, open_m): (&TabletopState<M>, f64),
        mode: &Mode,
        (primitive, contract): (PrimitiveName, Contract),
    ) -> (Step, TabletopState<M>, bool) {
        let instance = &step.instance;
        let mut waypoints = vec![self.waypoint(m, before, open_m)];
        let gap_m = mode.gap_m();
        if gap_m != open_m {
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
        let written = Step {
            primitive,
            object: instance.object.and_then(name),
            tool: self.tool(before),
            holds: hold(m, mode),
            pushes: instance.object.and_then(name).filter(|_| contract.slides()),
            allowed_contacts: self.contacts(m, instance, (mode, before.robot.arm.hand_at_work()), contract),
            waypoints,
        };
        let is_steady = [open_m, end.mode.gap_m()] == [gap_m; 2];
        (written, end, is_steady)
    }

    /// What may touch in this step besides what rests on its support.
    fn contacts<M: TaskRobot>(
        &self,
        m: &Tabletop<M>,
        instance: &Instance<Tabletop<M>>,
        (mode, hand): (&Mode, usize),
        contract: Contract,
    ) -> Vec<AllowedContact> {
        let name = |id| m.movable(id).map(|o| o.body.name.to_string());
        let mut out = Vec::new();
        let fingers = instance.contacts.fingers.or_else(|| Some((mode.held()?.object, TouchReason::Grasp)));
        if let Some((object, reason)) = fingers
            && let (Some(object), Some(hand)) = (name(object), self.hands.get(hand))
        {
            let reason = match reason {
                TouchReason::Push => ContactReason::Push,
                TouchReason::Retreat => ContactReason::Retreat,
                TouchReason::Grasp => ContactReason::Grasp,
            };
            out.extend(AllowedContact::fingers(&hand.fingers, &object, reason));
        }
        if contract.lifts()
            && let Some((object, surface)) = instance.contacts.support
            && let (Some(object), Some(support)) = (name(object), m.supports().get(surface.index()))
        {
            out.extend(support.bodies.iter().map(|body| AllowedContact::support(&object, body)));
        }
        out
    }

    /// A state as it stands in plan files, the hand open by `gap_m`.
    pub(crate) fn waypoint<M: TaskRobot>(&self, m: &Tabletop<M>, state: &TabletopState<M>, gap_m: f64) -> Waypoint {
        let joints = self.joints.complete(&m.manipulator().joint_values(&state.robot, gap_m));
        let poses = m.movables().iter().zip(&state.objects);
        let objects: BTreeMap<_, _> = poses.map(|(o, pose)| (Arc::clone(&o.body.name), Pose::from(*pose))).collect();
        Waypoint { base: state.robot.base, joints, objects }
    }
}

/// Steps, and the contracts of their primitives.
pub(crate) type Written = (Vec<Step>, BTreeMap<PrimitiveName, Contract>);

/// As which primitive a step is written: what is cut short before the object stands has only carried it.
fn written_as<M: TaskRobot>(m: &Tabletop<M>, step: &PlanStep<Tabletop<M>>) -> Option<(PrimitiveId, Contract)> {
    let own = step.instance.primitive;
    let contract = *m.contract(own)?;
    if contract.hand == HandUse::LetsGo && step.until < 1.0 {
        return Some((ARM_RIGID_TRANSFER, *m.contract(ARM_RIGID_TRANSFER)?));
    }
    Some((own, contract))
}

/// Is the second step more of what the first does? What may go any way is free to turn at any waypoint.
fn goes_on(step: &Step, next: &Step) -> bool {
    (&step.primitive, &step.object, &step.tool, &step.holds, &step.allowed_contacts)
        == (&next.primitive, &next.object, &next.tool, &next.holds, &next.allowed_contacts)
}

/// The parameters of the waypoints: all knots up to `until`, and more between them so that none is far from the next.
fn parameters<M: TaskRobot>(motion: &dyn Motion<Tabletop<M>>, until: f64) -> Vec<f64> {
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

fn hold<M: TaskRobot>(m: &Tabletop<M>, mode: &Mode) -> Option<Hold> {
    let held = mode.held()?;
    let object = m.movable(held.object)?.body.name.to_string();
    Some(Hold { object, tool_from_object: Pose::from(held.tool_from_object) })
}
