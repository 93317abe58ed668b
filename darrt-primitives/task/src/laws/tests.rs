//! Robots that say of themselves what is not so: one that is right, and copies of it with one answer changed each.

use std::sync::atomic::{AtomicU32, Ordering};

use darrt_primitives::joints::Joints;
use darrt_primitives::kinematics::JointLimit;
use darrt_primitives::manipulator::{Hand, JointVector as _, RobotLink};
use nalgebra::Isometry3;
use rand::Rng;

use super::*;
use crate::file_robot::FileRobot;
use crate::testing::{Pr2, builtin};

/// What is changed; by default nothing.
struct Fault {
    models: fn() -> Vec<String>,
    knows: bool,
    postures: fn(Vec<String>) -> Vec<String>,
    posture: fn(&FileRobot, &str) -> Option<Joints>,
    start: fn(Joints) -> Joints,
    facts: fn(&mut RobotFacts),
    values: fn(Vec<f64>, f64) -> Vec<f64>,
    drives: fn(bool) -> bool,
}

const HONEST: Fault = Fault {
    models: FileRobot::models,
    knows: false,
    postures: |names| names,
    posture: |robot, name| robot.posture(name),
    start: |start| start,
    facts: |_| {},
    values: |values, _| values,
    drives: |drives| drives,
};

/// The law that each breaks.
struct Wrong {
    name: &'static str,
    law: &'static str,
    fault: Fault,
}

static CALLS: AtomicU32 = AtomicU32::new(0);

const fn wrong(name: &'static str, law: &'static str, fault: Fault) -> Wrong {
    Wrong { name, law, fault }
}

const COUNT: usize = 26;

/// All of them; the first is honest.
const ALL: [Wrong; COUNT] = [
    wrong("nothing is wrong", "", HONEST),
    wrong("a robot without a name", MODELS, Fault { models: Vec::new, ..HONEST }),
    wrong("two words", MODELS, Fault { models: || vec!["my arm".to_owned()], ..HONEST }),
    wrong("answers to every name", MODELS, Fault { knows: true, ..HONEST }),
    wrong(
        "another start each time",
        BUILD,
        Fault { start: |start| nudged(start, CALLS.fetch_add(1, Ordering::Relaxed)), ..HONEST },
    ),
    wrong("starts in degrees", BUILD, Fault { start: |start| mapped(start, f64::to_degrees), ..HONEST }),
    wrong("starts as NaN", BUILD, Fault { start: |start| mapped(start, |_| f64::NAN), ..HONEST }),
    wrong("a posture that it forgot", POSTURES, Fault { posture: |_, _| None, ..HONEST }),
    wrong(
        "a posture for every name",
        POSTURES,
        Fault { posture: |robot, name| robot.posture(name).or_else(|| Joints::zeros(7)), ..HONEST },
    ),
    wrong(
        "postures in degrees",
        POSTURES,
        Fault { posture: |robot, name| robot.posture(name).map(|arm| mapped(arm, |x| 60.0 * x + 60.0)), ..HONEST },
    ),
    wrong(
        "a posture that is named twice",
        POSTURES,
        Fault { postures: |names| [names.clone(), names].concat(), ..HONEST },
    ),
    wrong("one joint of the arm is missing", ROLES, Fault { facts: |facts| drop(facts.arm_joints.pop()), ..HONEST }),
    wrong("from the hand inwards", ROLES, Fault { facts: |facts| facts.arm_joints.reverse(), ..HONEST }),
    wrong("tips the wrong way round", ROLES, Fault { facts: |facts| facts.tip_links.reverse(), ..HONEST }),
    wrong("one finger is enough", ROLES, Fault { facts: |facts| facts.finger_links.truncate(1), ..HONEST }),
    wrong(
        "a tool that no joint moves",
        ROLES,
        Fault {
            facts: |facts| facts.tool_link = facts.description.links[facts.description.root].name.to_string(),
            ..HONEST
        },
    ),
    wrong(
        "the finger is a joint of the arm",
        ROLES,
        Fault { facts: |facts| facts.finger_joint.clone_from(&facts.arm_joints[0]), ..HONEST },
    ),
    wrong("the start of another problem", START, Fault { facts: |facts| facts.start[0].1 += 0.1, ..HONEST }),
    wrong("starts nowhere", START, Fault { facts: |facts| facts.start.clear(), ..HONEST }),
    wrong(
        "a joint that it does not have",
        START,
        Fault { facts: |facts| facts.at_rest.push(("tail".to_owned(), 0.0)), ..HONEST },
    ),
    wrong("a pair is kept to itself", PAIRS, Fault { facts: |facts| drop(facts.self_pairs.pop()), ..HONEST }),
    wrong("carries more than it says", SAME, Fault { facts: |facts| facts.payload_kg *= 2.0, ..HONEST }),
    wrong("bolted down, and drives", SAME, Fault { drives: |drives| !drives, ..HONEST }),
    wrong(
        "values in the order of the alphabet",
        START,
        Fault {
            values: |mut values, _| {
                values.swap(0, 1);
                values
            },
            ..HONEST
        },
    ),
    wrong("values of the arm alone", VALUES, Fault { values: |values, _| values[..7].to_vec(), ..HONEST }),
    wrong(
        "the gap is forgotten",
        VALUES,
        Fault {
            values: |mut values, gap_m| {
                let last = values.len() - 1;
                values[last] -= 0.5 * gap_m;
                values
            },
            ..HONEST
        },
    ),
];

fn mapped(mut arm: Joints, to: impl Fn(f64) -> f64) -> Joints {
    arm.as_mut().iter_mut().for_each(|x| *x = to(*x));
    arm
}

fn nudged(mut arm: Joints, by: u32) -> Joints {
    arm.as_mut()[0] += 1e-6 * f64::from(by % 7);
    arm
}

/// The number of a fault is part of the type: a robot is built from a table alone.
struct Liar<const N: usize>(FileRobot);

impl<const N: usize> Liar<N> {
    const FAULT: Fault = {
        let Wrong { fault, .. } = &ALL[N];
        Fault { ..*fault }
    };
}

impl<const N: usize> Manipulator for Liar<N> {
    type Joints = Joints;
    fn hand(&self) -> &dyn Hand {
        self.0.hand()
    }
    fn limits(&self) -> &[JointLimit] {
        self.0.limits()
    }
    fn world_from_tool(&self, q: &Configuration<Joints>) -> Isometry3<f64> {
        self.0.world_from_tool(q)
    }
    fn inverse(&self, base: &[f64; 3], tool: &Isometry3<f64>, rng: &mut dyn Rng) -> Option<Joints> {
        self.0.inverse(base, tool, rng)
    }
    fn inverse_near(&self, base: &[f64; 3], tool: &Isometry3<f64>, near: &Joints) -> Option<Joints> {
        self.0.inverse_near(base, tool, near)
    }
    fn base_for(&self, tool: &Isometry3<f64>, rng: &mut dyn Rng) -> [f64; 3] {
        self.0.base_for(tool, rng)
    }
    fn may_reach(&self, base: &[f64; 3], tool: &Isometry3<f64>) -> bool {
        self.0.may_reach(base, tool)
    }
    fn links(&self) -> &[RobotLink] {
        self.0.links()
    }
    fn self_pairs(&self) -> &[(usize, usize)] {
        self.0.self_pairs()
    }
    fn link_poses(&self, q: &Configuration<Joints>, gap_m: f64, out: &mut [Isometry3<f64>]) {
        self.0.link_poses(q, gap_m, out);
    }
    fn travel_m(&self, a: &Configuration<Joints>, b: &Configuration<Joints>, held_reach_m: f64) -> f64 {
        self.0.travel_m(a, b, held_reach_m)
    }
    fn payload_kg(&self) -> f64 {
        self.0.payload_kg()
    }
    fn push_force_n(&self) -> f64 {
        self.0.push_force_n()
    }
    fn joint_weights_m(&self) -> &[f64] {
        self.0.joint_weights_m()
    }
    fn drives_along_heading(&self) -> bool {
        self.0.drives_along_heading()
    }
}

impl<const N: usize> TaskRobot for Liar<N> {
    fn models() -> Vec<String> {
        (Self::FAULT.models)()
    }
    fn posture_names(settings: &RobotSettings) -> Result<Vec<String>, RobotError> {
        FileRobot::posture_names(settings).map(Self::FAULT.postures)
    }
    fn build(settings: &RobotSettings) -> Result<(Self, Joints), RobotError> {
        FileRobot::build(settings).map(|(robot, start)| (Self(robot), (Self::FAULT.start)(start)))
    }
    fn facts(settings: &RobotSettings) -> Result<RobotFacts, RobotError> {
        let mut facts = FileRobot::facts(settings)?;
        (Self::FAULT.facts)(&mut facts);
        Ok(facts)
    }
    fn with_robot(
        problem: ProblemFile,
        name: &str,
        contract: &dyn Fn(&crate::problem_file::PrimitiveName) -> Option<darrt_primitives::contract::Contract>,
    ) -> Result<(ProblemFile, Vec<String>), RobotError> {
        if Self::FAULT.knows { Ok((problem, Vec::new())) } else { FileRobot::with_robot(problem, name, contract) }
    }
    fn posture(&self, name: &str) -> Option<Joints> {
        (Self::FAULT.posture)(&self.0, name)
    }
    fn joint_values(&self, q: &Configuration<Joints>, gap_m: f64) -> Vec<f64> {
        (Self::FAULT.values)(self.0.joint_values(q, gap_m), gap_m)
    }
    fn drives(&self) -> bool {
        (Self::FAULT.drives)(self.0.drives())
    }
}

/// A problem whose robot is `model`; what else is in it is not looked at.
fn about(model: &str) -> ProblemFile {
    let mut problem = builtin("bowl").unwrap();
    problem.robot = serde_json::from_value(serde_json::json!({ "model": model, "base": [0.2, -0.1, 0.5] })).unwrap();
    problem
}

/// Checks the faults from `N` on.
macro_rules! each {
    ($problem:expr, $seed:expr, $($number:literal)*) => {
        [$(check_task_robot::<Liar<$number>>($problem, $seed)),*]
    };
}

#[test]
fn robots_that_say_of_themselves_what_is_not_so_break_the_law_they_should() {
    let problem = about("panda-arm");
    for seed in [0, 7] {
        let found = each!(&problem, seed, 0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24 25);
        for (Wrong { name, law, .. }, found) in ALL.iter().zip(found) {
            match found {
                Ok(()) => assert!(law.is_empty(), "{name} passes, but breaks {law}"),
                Err(broken) => assert_eq!(broken.law, *law, "{name}: {broken}"),
            }
        }
    }
}

#[test]
fn every_law_catches_something_and_the_robots_inside_keep_all() {
    let idle: Vec<_> =
        LAWS.iter().filter(|law| law.starts_with("task-robot") && !ALL.iter().any(|w| w.law == **law)).collect();
    assert_eq!(idle, [&PLACES, &LIMITS], "caught by robots of their own, below");
    for shipped in crate::file_robot::shipped::all() {
        check_task_robot::<FileRobot>(&about(shipped.name), 1).unwrap();
    }
    check_task_robot::<Pr2>(&builtin("bowl").unwrap(), 1).unwrap();
}

/// Facts of a description in which a joint is elsewhere, and of one whose joint goes less far.
#[test]
fn a_description_of_another_robot_is_noticed() {
    let settings = about("panda-arm").robot;
    let (robot, start) = FileRobot::build(&settings).unwrap();
    let trial = |change: &dyn Fn(&mut darrt_primitives::kinematics::RobotDescription)| {
        let mut facts = FileRobot::facts(&settings).unwrap();
        let mut description = (*facts.description).clone();
        change(&mut description);
        facts.description = std::sync::Arc::new(description);
        let tree = KinematicTree::new(&facts.description).unwrap();
        let trial = Trial { robot: &robot, start, facts: &facts, tree, settings: &settings, seed: 3 };
        trial.limits().and_then(|()| trial.configurations()).map_err(|broken| broken.law)
    };
    assert_eq!(trial(&|_| {}), Ok(()));
    let arm = |facts: &RobotFacts| facts.arm_joints[2].clone();
    let name = arm(&FileRobot::facts(&settings).unwrap());
    let of = |description: &mut darrt_primitives::kinematics::RobotDescription,
              change: &dyn Fn(&mut darrt_primitives::kinematics::urdf::JointDescription)| {
        description.joints.iter_mut().filter(|joint| *joint.name == *name).for_each(change);
    };
    assert_eq!(trial(&|d| of(d, &|joint| joint.parent_from_child.translation.z += 0.01)), Err(PLACES));
    let narrow = JointLimit::new(-0.1, 0.1);
    assert_eq!(trial(&|d| of(d, &|joint| (joint.limit, joint.soft_limit) = (narrow, narrow))), Err(LIMITS));
}
