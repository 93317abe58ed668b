//! Plans made by hand: the arm follows straight lines of the tool by inverse kinematics, nothing is searched.

use std::collections::BTreeMap;

use darrt_pr2::arm::{Arm, ArmConfiguration, LimitKind, Side, Solutions};
use darrt_pr2::forward::{ArmChain, world_from_base};
use darrt_pr2::gripper;
use darrt_pr2::model::{Pr2Model, URDF, WholeBody};
use darrt_pr2::postures::ArmPosture;
use darrt_primitives::kinematics::RobotDescription;
use darrt_primitives::primitive::STANDARD;
use darrt_task::plan_file::{
    AllowedContact, ContactReason, Hold, JointTable, PlanFile, PlanFormat, PlannerFacts, Pose, Step, VERSION, Waypoint,
};
use darrt_task::problem_file::{PrimitiveName, ProblemFile};
use nalgebra::{Isometry3, Vector3};

/// The body that carries the plate.
pub(crate) const TABLE: &str = "central table top";
/// The object of most plans here.
pub(crate) const PLATE: &str = "plate";
/// Distance between waypoints along lines of the tool, metres.
const STEP_M: f64 = 0.02;

/// A state and the steps that led to it.
pub(crate) struct Builder {
    model: Pr2Model,
    table: JointTable,
    arm: Arm,
    pub(crate) body: WholeBody,
    object: String,
    plate: Isometry3<f64>,
    held: Option<Isometry3<f64>>,
    pushed: bool,
    start: Waypoint,
    steps: Vec<Step>,
}

impl Builder {
    /// The right arm at `q`, the hand open by `gap`, the first object where `problem` puts it.
    pub(crate) fn new(problem: &ProblemFile, q: ArmConfiguration, gap: f64) -> Self {
        let model = Pr2Model::embedded().unwrap();
        let table = JointTable::new(&RobotDescription::from_text(URDF).unwrap(), model.tree());
        let mut body = WholeBody::at_rest();
        body.base = problem.robot.base;
        body.torso_m = problem.robot.torso_m.unwrap();
        body.arms = [q, ArmPosture::Side.values(Side::Left)];
        body.finger_angles = [gripper::finger_angle(gap), 0.0];
        let plate = problem.geometry().unwrap().objects[0].world_from_object;
        let arm = Arm::new(Side::Right, body.torso_m, LimitKind::Soft).unwrap();
        let start = Waypoint { base: [0.0; 3], joints: BTreeMap::new(), objects: BTreeMap::new() };
        let mut builder = Self {
            model,
            table,
            arm,
            body,
            object: problem.objects[0].name.clone(),
            plate,
            held: None,
            pushed: false,
            start,
            steps: Vec::new(),
        };
        builder.start = builder.waypoint();
        builder
    }

    /// Pose of the tool in the world.
    pub(crate) fn tool(&self) -> Isometry3<f64> {
        ArmChain::new(Side::Right, self.body.torso_m).world_from_tool(&self.body.base, &self.body.arms[0])
    }

    fn waypoint(&self) -> Waypoint {
        Waypoint {
            base: self.body.base,
            joints: self.table.complete(&self.model.joint_values(&self.body)),
            objects: BTreeMap::from([(self.object.as_str().into(), Pose::from(self.plate))]),
        }
    }

    /// Begins a step at the present state.
    pub(crate) fn begin(&mut self, primitive: &PrimitiveName, object: Option<&str>) -> &mut Self {
        let holds = self.held.map(|pose| Hold { object: self.object.clone(), tool_from_object: pose.into() });
        let first = self.waypoint();
        self.steps.push(Step {
            primitive: primitive.clone(),
            object: object.map(str::to_owned),
            tool: None,
            pushes: (*primitive == PrimitiveName::PUSH).then(|| self.object.clone()),
            allowed_contacts: Vec::new(),
            holds,
            waypoints: vec![first],
        });
        self
    }

    fn record(&mut self) {
        if let Some(held) = self.held {
            self.plate = self.tool() * held;
        }
        let waypoint = self.waypoint();
        self.steps.last_mut().unwrap().waypoints.push(waypoint);
    }

    /// The fingers may touch the plate in this step.
    pub(crate) fn touching(&mut self, reason: ContactReason) -> &mut Self {
        self.allow(AllowedContact::fingers(&finger_links(), &self.object, reason))
    }

    /// The object may touch the body that carries it.
    pub(crate) fn lifting_from(&mut self, body: &str) -> &mut Self {
        let contact = AllowedContact::support(&self.object, body);
        self.allow(vec![contact])
    }

    /// More contacts that this step allows.
    pub(crate) fn allow(&mut self, contacts: Vec<AllowedContact>) -> &mut Self {
        self.steps.last_mut().unwrap().allowed_contacts.extend(contacts);
        self
    }

    /// Moves the tool straight by `way` (world).
    pub(crate) fn line(&mut self, way: Vector3<f64>) -> &mut Self {
        self.follow(way, |arm, near, pose, _| arm.inverse_near(pose, near, 0.3))
    }

    /// Pushes the plate by `way` (world) while the upper arm rolls to `roll`, which keeps the elbow up.
    pub(crate) fn push(&mut self, way: Vector3<f64>, roll: f64) -> &mut Self {
        let from = self.body.arms[0][2];
        self.pushed = true;
        self.follow(way, |arm, near, pose, share| {
            let mut solutions = Solutions::new();
            arm.inverse(pose, from + (roll - from) * share, &mut solutions);
            let distance = |q: &ArmConfiguration| q.iter().zip(near).map(|(a, b)| (a - b).abs()).sum::<f64>();
            solutions.into_iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))
        });
        self.pushed = false;
        self
    }

    fn follow(
        &mut self,
        way: Vector3<f64>,
        solve: impl Fn(&Arm, &ArmConfiguration, &Isometry3<f64>, f64) -> Option<ArmConfiguration>,
    ) -> &mut Self {
        let (from, plate) = (self.tool(), self.plate);
        let count = (way.norm() / STEP_M).ceil();
        let mut i = 1.0;
        while i <= count {
            let share = i / count;
            let mut to = from;
            to.translation.vector += way * share;
            let base_from_tool = world_from_base(&self.body.base).inverse() * to;
            self.body.arms[0] = solve(&self.arm, &self.body.arms[0], &base_from_tool, share).expect("the arm reaches");
            if self.pushed {
                self.plate.translation.vector = plate.translation.vector + way * share;
            }
            self.record();
            i += 1.0;
        }
        self
    }

    /// Moves the arm straight in joint space.
    pub(crate) fn arm_to(&mut self, q: ArmConfiguration) -> &mut Self {
        self.body.arms[0] = q;
        self.record();
        self
    }

    /// Drives.
    pub(crate) fn drive(&mut self, base: [f64; 3]) -> &mut Self {
        self.body.base = base;
        self.record();
        self
    }

    /// Opens or closes the hand to a gap.
    pub(crate) fn hand(&mut self, gap: f64) -> &mut Self {
        self.body.finger_angles[0] = gripper::finger_angle(gap);
        self.record();
        self
    }

    /// The plate is in the hand from the beginning of this step on.
    pub(crate) fn attach(&mut self) -> &mut Self {
        let held = self.tool().inverse() * self.plate;
        self.held = Some(held);
        self.steps.last_mut().unwrap().holds =
            Some(Hold { object: self.object.clone(), tool_from_object: held.into() });
        self
    }

    /// The plate is no longer in the hand after this step.
    pub(crate) fn detach(&mut self) -> &mut Self {
        self.held = None;
        self
    }

    /// The plan so far.
    pub(crate) fn plan(&self, problem: &ProblemFile) -> PlanFile {
        PlanFile {
            format: PlanFormat::DarrtPlan,
            version: VERSION,
            problem: problem.clone(),
            seed: 0,
            planner: PlannerFacts {
                sampler: problem.sampling.sampler.clone(),
                distance: problem.sampling.distance.clone(),
                ..PlannerFacts::default()
            },
            contracts: STANDARD.iter().map(|(id, contract)| (PrimitiveName::new(id.name()), *contract)).collect(),
            partial: None,
            start: self.start.clone(),
            steps: self.steps.clone(),
            timing: None,
        }
    }
}

/// The links of the right hand that may touch things.
pub(crate) fn finger_links() -> [String; 4] {
    ["l_finger", "r_finger", "l_finger_tip", "r_finger_tip"].map(|name| format!("r_gripper_{name}_link"))
}
