//! The laws of robots and primitives that problem files can be about, as plain functions, besides those of [`darrt_primitives::laws`].
//!
//! | you have | call |
//! |---|---|
//! | a [`TaskRobot`] | [`check_task_robot`] |
//! | a [`TaskPrimitive`](crate::registry::TaskPrimitive) | [`check_task_primitive`] |
//!
//! Each takes concrete inputs and returns the first law that is broken, as a [`Broken`] with the two values.

use std::collections::BTreeSet;

use darrt_core::laws::watch::{entering, watched};
use darrt_core::laws::{Broken, ensure, equal};
use darrt_core::random::{Purpose, stream};
use darrt_core::space::ComponentSpace;
use darrt_primitives::kinematics::KinematicTree;
use darrt_primitives::manipulator::{Configuration, Manipulator};
use darrt_primitives::mobile_arm_space::MobileArmSpace;

use crate::problem_file::{ProblemFile, Robot as RobotSettings};
use crate::robot::{RobotError, RobotFacts, TaskRobot};

mod description;
mod places;
mod primitive;

#[cfg(test)]
mod tests;

pub use primitive::check_task_primitive;

/// Names.
pub const MODELS: &str =
    "task-robot.models: it has names, each once and without blanks, and no robot is given for another name";
/// Building.
pub const BUILD: &str =
    "task-robot.build: the same table gives the same robot, whose arm starts within its limits, and the same facts";
/// Postures.
pub const POSTURES: &str = "task-robot.postures: every posture that is named, each once, is there, within the hard limits of the description, and no other";
/// Joint values.
pub const VALUES: &str = "task-robot.values: joint_values has one finite value for each variable of the description, the same whatever was asked in between; those of the arm are the configuration's, and only the joint that opens the hand changes with the gap, and grows with it";
/// Places.
pub const PLACES: &str = "task-robot.places: the links of the facts, moved by joint_values, stand where link_poses says, and the tool link where world_from_tool says";
/// Where it starts.
pub const START: &str =
    "task-robot.start: what the facts say of the start names joints, each once, and holds of what build returns";
/// Limits.
pub const LIMITS: &str = "task-robot.limits: what the arm's limits allow, the description allows as well";
/// Which joints and links are what.
pub const ROLES: &str = "task-robot.roles: arm joints are joints of the description from the base outwards, one for each of the arm, the finger joint is another one, finger links are the robot's, and the tips are two of them, the one at +y first";
/// Pairs.
pub const PAIRS: &str = "task-robot.pairs: the pairs of links that the robot keeps apart are among those of the facts";
/// Numbers.
pub const SAME: &str =
    "task-robot.same: pads, grip, payload, push force and drives of the facts are those of the robot";

/// Names of a primitive.
pub const NAMED: &str = "task-primitive.named: it has a name without blanks, is known by the id that it is given, and needs other primitives only, each once";
/// Its contract.
pub const CONTRACT: &str = "task-primitive.contract: its contract does not contradict itself";
/// Its settings.
pub const SETTINGS: &str = "task-primitive.settings: it is made of its default settings and of none, and a key that it does not know is refused";

/// Every law of this crate.
pub const LAWS: &[&str] =
    &[MODELS, BUILD, POSTURES, VALUES, PLACES, START, LIMITS, ROLES, PAIRS, SAME, NAMED, CONTRACT, SETTINGS];

/// So many configurations are looked at.
const CONFIGURATIONS: usize = 12;
/// How far two values that should be one may be apart, metres and radians.
const ROUNDING: f64 = 1e-6;

/// All laws of a robot as the robot of `problem`. Its motions are a matter of
/// [`check_manipulator`](darrt_primitives::laws::check_manipulator).
///
/// # Errors
/// The first law that is [`Broken`], with the joint, link or posture at fault.
///
/// # Example
/// A robot of one's own in place of this one, in a test:
/// ```
/// use darrt_task::file_robot::FileRobot;
/// use darrt_task::laws::check_task_robot;
/// use darrt_task::problem_file::ProblemFile;
///
/// let text = r#"
/// format = "darrt-problem"
/// version = 1
/// name = "mine"
/// primitives = ["Arm-Transit", "Straight-Line-Arm-Transit", "Push"]
/// [robot]
/// model = "panda-arm"
/// base = [0, 0, 0]
/// [[obstacle]]
/// name = "table top"
/// shape = { box = { size = [0.5, 0.9, 0.04] } }
/// at = [0.6, 0, 0.2]
/// [[surface]]
/// name = "table"
/// top_of = "table top"
/// [[object]]
/// name = "puck"
/// shape = { cylinder = { radius = 0.05, height = 0.04 } }
/// mass_kg = 0.1
/// friction = { table = 0.3, fingers = 0.5 }
/// symmetry = "z"
/// on = "table"
/// at = [0.5, 0.1]
/// pushable = true
/// [[goal.object]]
/// object = "puck"
/// on = "table"
/// at = [0.6, -0.1]
/// tolerance_m = 0.01
/// "#;
/// let problem = ProblemFile::from_toml(text, "mine")?;
/// check_task_robot::<FileRobot>(&problem, 0)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn check_task_robot<M: TaskRobot>(problem: &ProblemFile, seed: u64) -> Result<(), Broken> {
    let settings = &problem.robot;
    let about = || format!("check_task_robot(&{settings:?}, {seed})");
    let check = || {
        models::<M>(problem)?;
        let (robot, start) = build::<M>(settings)?;
        let told = |error: RobotError| Broken::new(BUILD, error.to_string(), "facts");
        entering("facts");
        let facts = M::facts(settings).map_err(told)?;
        let again = M::facts(settings).map_err(told)?;
        equal(BUILD, &summary(&again), &summary(&facts)).map_err(|broken| broken.of("facts"))?;
        let tree = KinematicTree::new(&facts.description)
            .map_err(|error| Broken::new(BUILD, error.to_string(), "a description that is a tree"))?;
        let trial = Trial { robot: &robot, start, facts: &facts, tree, settings, seed };
        trial.roles()?;
        trial.postures()?;
        trial.limits()?;
        trial.start()?;
        trial.pairs()?;
        trial.same()?;
        trial.configurations()
    };
    watched(&about, check).map_err(|broken| broken.replayed_by(about))
}

/// A robot, what it says of itself, and the tree of that.
struct Trial<'a, M: TaskRobot> {
    robot: &'a M,
    start: M::Joints,
    facts: &'a RobotFacts,
    tree: KinematicTree,
    settings: &'a RobotSettings,
    seed: u64,
}

impl<M: TaskRobot> Trial<'_, M> {
    /// The start and configurations within the limits.
    fn drawn(&self) -> Result<Vec<Configuration<M::Joints>>, Broken> {
        let space =
            MobileArmSpace::<M::Joints>::new([-2.0; 2], [2.0; 2], self.robot.limits(), self.robot.joint_weights_m());
        let space = space.map_err(|error| Broken::new(BUILD, error.to_string(), "limits and weights of a space"))?;
        let mut rng = stream(self.seed, 0, 0, Purpose::Attempt);
        let first = Configuration { base: self.settings.base, arm: self.start };
        Ok(std::iter::once(first).chain((0..CONFIGURATIONS).map(|_| space.sample(&mut rng))).collect())
    }

    fn variable(&self, law: &'static str, joint: &str) -> Result<usize, Broken> {
        let found = self.tree.variable_index(joint);
        found.ok_or_else(|| Broken::new(law, format!("no joint `{joint}`"), "a joint that moves by itself"))
    }
}

/// What of the facts can be compared.
fn summary(facts: &RobotFacts) -> String {
    // Named one by one, so that none that is new is forgotten.
    let RobotFacts {
        description: _,
        meshes: _,
        motion: _,
        arm_joints,
        finger_joint,
        tool_link,
        finger_links,
        tip_links,
        is_limited_softly,
        start,
        at_rest,
        self_pairs,
        is_bolted,
        drives_along_heading,
        pad_length_m,
        grip_force_n,
        payload_kg,
        push_force_n,
        second,
    } = facts;
    let named = (arm_joints, finger_joint, tool_link, finger_links, tip_links, start, at_rest, self_pairs);
    let switches = [is_limited_softly, is_bolted, drives_along_heading];
    format!("{named:?} {switches:?} {:?} {second:?}", [pad_length_m, grip_force_n, payload_kg, push_force_n])
}

fn models<M: TaskRobot>(problem: &ProblemFile) -> Result<(), Broken> {
    entering("models");
    let models = M::models();
    equal(MODELS, &M::models(), &models)?;
    let is_name = |name: &String| !name.is_empty() && !name.contains(char::is_whitespace);
    let distinct: BTreeSet<_> = models.iter().collect();
    let holds = !models.is_empty() && distinct.len() == models.len() && models.iter().all(is_name);
    ensure(MODELS, holds, || format!("{models:?}"), "names without blanks, each once")?;
    entering("with_robot");
    let nobody = M::with_robot(problem.clone(), NOBODY, &|_| None);
    ensure(MODELS, nobody.is_err(), || format!("a robot for `{NOBODY}`"), "an error")
}

/// No robot has this name, and no file.
const NOBODY: &str = "no-robot-of-this-name";

/// Twice.
fn build<M: TaskRobot>(settings: &RobotSettings) -> Result<(M, M::Joints), Broken> {
    entering("build");
    let build = || M::build(settings).map_err(|error| Broken::new(BUILD, error.to_string(), "a robot"));
    let ((robot, start), (again, other)) = (build()?, build()?);
    equal(BUILD, &other, &start).map_err(|broken| broken.of("start"))?;
    within(BUILD, &robot, &start).map_err(|broken| broken.of("start"))?;
    equal(BUILD, &again.limits().len(), &robot.limits().len())?;
    let q = Configuration { base: settings.base, arm: start };
    equal(BUILD, &again.world_from_tool(&q), &robot.world_from_tool(&q))
        .map_err(|broken| broken.of("world_from_tool"))?;
    Ok((robot, start))
}

/// As many joints as there are limits, each within its own.
fn within<M: Manipulator>(law: &'static str, robot: &M, arm: &M::Joints) -> Result<(), Broken> {
    equal(law, &arm.as_ref().len(), &robot.limits().len()).map_err(|broken| broken.of("number of joints"))?;
    for (joint, (value, limit)) in arm.as_ref().iter().zip(robot.limits()).enumerate() {
        let holds = value.is_finite() && limit.contains(*value);
        ensure(law, holds, || format!("{value:?}, limits {limit:?}"), "a value within the limits")
            .map_err(|broken| broken.of(format_args!("joint {joint}")))?;
    }
    Ok(())
}
