//! A robot and problems for the unit tests of this crate: the PR2 and what it has built in, by way of texts, because the crate
//! that is tested is not the one that the PR2 knows.

use std::sync::LazyLock;

use darrt_core::budget::Cancel;
use darrt_core::observe::Silent;
pub(crate) use darrt_pr2::robot::Pr2;
use darrt_primitives::manipulator::{Configuration, Manipulator};
use darrt_task::robot::TaskRobot as Outside;

use crate::clock::{Bounds, MotionLimits};
use crate::plan_file::PlanFile;
use crate::planning::{PlanRequest, PlanResult, plan};
use crate::problem_file::collection::{BuiltIn, Collection, ProblemGroup};
use crate::problem_file::{ArmSide, ProblemFile, ProblemFileError, Robot};
use crate::registry::Registry;
use crate::robot::{HandFacts, RobotError, RobotFacts, TaskRobot};
use crate::verify::{Proof, Refusal};

type Joints = <Pr2 as Manipulator>::Joints;

pub(crate) fn builtin_text(name: &str) -> Result<&'static str, darrt_task::problem_file::ProblemFileError> {
    darrt_pr2::problems::builtin_text(name)
}

pub(crate) fn builtin(name: &str) -> Result<ProblemFile, ProblemFileError> {
    ProblemFile::from_toml(builtin_text(name).unwrap_or_default(), &format!("built-in {name}"))
}

pub(crate) fn builtin_names() -> [&'static str; 6] {
    darrt_pr2::problems::builtin_names()
}

pub(crate) fn registry() -> Registry<Pr2> {
    const BOWL: [BuiltIn; 1] = [BuiltIn { name: "bowl", text: include_str!("../../../darrt-pr2/scenes/bowl.toml") }];
    Registry::new().with_problems(Collection::new([ProblemGroup { title: "One", problems: &BOWL }]))
}

pub(crate) fn facts(problem: &ProblemFile) -> RobotFacts {
    <Pr2 as TaskRobot>::facts(&problem.robot).unwrap()
}

/// The PR2 with both hands, the right one the first, whichever arm `problem` plans.
pub(crate) fn both_hands(problem: &ProblemFile) -> RobotFacts {
    let of = |arm| facts(&ProblemFile { robot: Robot { arm, ..problem.robot.clone() }, ..problem.clone() });
    let (right, left) = (of(ArmSide::Right), of(ArmSide::Left));
    let second = HandFacts {
        arm_joints: left.arm_joints,
        finger_joint: left.finger_joint,
        tool_link: left.tool_link,
        finger_links: left.finger_links,
        tip_links: left.tip_links,
        pad_length_m: left.pad_length_m,
        grip_force_n: left.grip_force_n,
        payload_kg: left.payload_kg,
        push_force_n: left.push_force_n,
    };
    let self_pairs = right.self_pairs.iter().chain(&left.self_pairs).cloned().collect();
    RobotFacts { start: facts(problem).start, self_pairs, second: Some(second), ..right }
}

/// The link of the tool frame of the left hand.
pub(crate) const LEFT_TOOL: &str = "l_gripper_tool_frame";

/// A plan of the left arm, written as one of the second hand of [`both_hands`].
pub(crate) fn left_handed() -> PlanFile {
    static PLAN: LazyLock<PlanFile> = LazyLock::new(|| {
        let mut problem = builtin("bowl").unwrap();
        problem.robot.arm = ArmSide::Left;
        let mut plan = (0..8).find_map(|seed| planned(&PlanRequest::new(problem.clone(), seed)).plan).unwrap();
        plan.steps.iter_mut().for_each(|step| step.tool = Some(LEFT_TOOL.to_owned()));
        plan.timing = None;
        plan
    });
    PLAN.clone()
}

pub(crate) fn planned(request: &PlanRequest) -> PlanResult {
    plan(&registry(), request, &Cancel::new(), &mut Silent).unwrap()
}

pub(crate) fn verify(plan: &PlanFile) -> Result<Proof, Refusal> {
    crate::verify::verify(plan, &facts(&plan.problem))
}

fn motion(limits: &darrt_task::clock::MotionLimits) -> MotionLimits {
    let bounds = |b: darrt_task::clock::Bounds| Bounds::new(b.velocity, b.acceleration, b.jerk);
    MotionLimits {
        joint_velocities: limits.joint_velocities.clone(),
        turning_joint: bounds(limits.turning_joint),
        sliding_joint: bounds(limits.sliding_joint),
        drive: bounds(limits.drive),
        turn: bounds(limits.turn),
        loaded_base_share: limits.loaded_base_share,
        grasp_s: limits.grasp_s,
        release_s: limits.release_s,
        contact_s: limits.contact_s,
        at_object_m_per_s: limits.at_object_m_per_s,
    }
}

/// The same table, as the PR2 knows it.
fn outside(settings: &Robot) -> darrt_task::problem_file::Robot {
    serde_json::from_value(serde_json::to_value(settings).unwrap()).unwrap()
}

impl TaskRobot for Pr2 {
    fn models() -> Vec<String> {
        <Self as Outside>::models()
    }

    fn posture_names(settings: &Robot) -> Result<Vec<String>, RobotError> {
        <Self as Outside>::posture_names(&outside(settings)).map_err(RobotError::model)
    }

    fn build(settings: &Robot) -> Result<(Self, Joints), RobotError> {
        <Self as Outside>::build(&outside(settings)).map_err(RobotError::model)
    }

    fn facts(settings: &Robot) -> Result<RobotFacts, RobotError> {
        let facts = <Self as Outside>::facts(&outside(settings)).map_err(RobotError::model)?;
        Ok(RobotFacts {
            description: facts.description,
            meshes: facts.meshes,
            arm_joints: facts.arm_joints,
            finger_joint: facts.finger_joint,
            tool_link: facts.tool_link,
            finger_links: facts.finger_links,
            tip_links: facts.tip_links,
            is_limited_softly: facts.is_limited_softly,
            start: facts.start,
            at_rest: facts.at_rest,
            self_pairs: facts.self_pairs,
            is_bolted: facts.is_bolted,
            drives_along_heading: facts.drives_along_heading,
            pad_length_m: facts.pad_length_m,
            grip_force_n: facts.grip_force_n,
            payload_kg: facts.payload_kg,
            push_force_n: facts.push_force_n,
            motion: motion(&facts.motion),
            second: None,
        })
    }

    fn posture(&self, name: &str) -> Option<Joints> {
        Outside::posture(self, name)
    }

    fn joint_values(&self, q: &Configuration<Joints>, gap_m: f64) -> Vec<f64> {
        Outside::joint_values(self, q, gap_m)
    }
}
