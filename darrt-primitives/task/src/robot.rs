//! What a robot must say of itself so that problems for it can be read, planned, judged and drawn.
//!
//! A planner moves a [`Manipulator`]; a judge must not trust the planner's code and gets [`RobotFacts`] instead: the
//! description, and the names that say what is arm, hand and finger in it.

use std::sync::Arc;

use darrt_primitives::contract::Contract;
use darrt_primitives::kinematics::{MeshPlaces, RobotDescription, UrdfError};
use darrt_primitives::manipulator::{Configuration, Manipulator};

use crate::clock::MotionLimits;
use crate::problem_file::suggest::nearest;
use crate::problem_file::{PrimitiveName, ProblemFile, Robot as RobotSettings};
use crate::robot_file::RobotFileError;

/// A robot that problem files can be about.
///
/// # Laws
/// Run by [`check_task_robot`](crate::laws::check_task_robot).
/// - The links of [`TaskRobot::facts`], moved by [`TaskRobot::joint_values`], stand where [`Manipulator::link_poses`] says.
/// - [`RobotFacts::start`] holds of the configuration that [`TaskRobot::build`] returns.
///
/// # Example
/// The robot of a robot file, with a closed form for the inverse kinematics of its arm.
/// ```
/// use darrt_primitives::joints::Joints;
/// use darrt_primitives::manipulator::{Configuration, Manipulator};
/// use darrt_task::file_robot::FileRobot;
/// use darrt_task::problem_file::Robot as Settings;
/// use darrt_task::robot::{RobotError, RobotFacts, TaskRobot};
/// # use darrt_primitives::kinematics::JointLimit;
/// # use darrt_primitives::manipulator::{Hand, RobotLink};
/// # use nalgebra::Isometry3;
/// # use rand::Rng;
/// # fn closed_form(_: &[f64; 3], _: &Isometry3<f64>) -> Option<Joints> { None }
///
/// struct Closed(FileRobot);
///
/// impl Manipulator for Closed {
///     type Joints = Joints;
///     fn inverse(&self, base: &[f64; 3], tool: &Isometry3<f64>, rng: &mut dyn Rng) -> Option<Joints> {
///         closed_form(base, tool).or_else(|| self.0.inverse(base, tool, rng))
///     }
///     // All else is asked of the robot of the file.
///     fn hand(&self) -> &dyn Hand { self.0.hand() }
/// #   fn limits(&self) -> &[JointLimit] { self.0.limits() }
/// #   fn world_from_tool(&self, q: &Configuration<Joints>) -> Isometry3<f64> { self.0.world_from_tool(q) }
/// #   fn inverse_near(&self, base: &[f64; 3], tool: &Isometry3<f64>, near: &Joints) -> Option<Joints> {
/// #       self.0.inverse_near(base, tool, near)
/// #   }
/// #   fn base_for(&self, tool: &Isometry3<f64>, rng: &mut dyn Rng) -> [f64; 3] { self.0.base_for(tool, rng) }
/// #   fn may_reach(&self, base: &[f64; 3], tool: &Isometry3<f64>) -> bool { self.0.may_reach(base, tool) }
/// #   fn links(&self) -> &[RobotLink] { self.0.links() }
/// #   fn self_pairs(&self) -> &[(usize, usize)] { self.0.self_pairs() }
/// #   fn link_poses(&self, q: &Configuration<Joints>, gap_m: f64, out: &mut [Isometry3<f64>]) {
/// #       self.0.link_poses(q, gap_m, out);
/// #   }
/// #   fn travel_m(&self, a: &Configuration<Joints>, b: &Configuration<Joints>, held_reach_m: f64) -> f64 {
/// #       self.0.travel_m(a, b, held_reach_m)
/// #   }
/// #   fn joint_weights_m(&self) -> &[f64] { self.0.joint_weights_m() }
/// }
///
/// impl TaskRobot for Closed {
///     fn models() -> Vec<String> { FileRobot::models() }
///     fn posture_names(settings: &Settings) -> Result<Vec<String>, RobotError> { FileRobot::posture_names(settings) }
///     fn build(settings: &Settings) -> Result<(Self, Joints), RobotError> {
///         let (robot, start) = FileRobot::build(settings)?;
///         Ok((Self(robot), start))
///     }
///     fn facts(settings: &Settings) -> Result<RobotFacts, RobotError> { FileRobot::facts(settings) }
///     fn posture(&self, name: &str) -> Option<Joints> { self.0.posture(name) }
///     fn joint_values(&self, q: &Configuration<Joints>, gap_m: f64) -> Vec<f64> { self.0.joint_values(q, gap_m) }
/// }
/// let settings: Settings = toml::from_str("model = \"panda-arm\"\nbase = [0, 0, 0]")?;
/// let (robot, start) = Closed::build(&settings)?;
/// assert_eq!(robot.limits().len(), AsRef::<[f64]>::as_ref(&start).len());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait TaskRobot: Manipulator + Sized {
    /// The names by which `model` in problem files may call it.
    fn models() -> Vec<String>;

    /// The names of the postures of the arm, for problem files with this table `[robot]`.
    ///
    /// # Errors
    /// [`RobotError`] for a robot that cannot be read.
    fn posture_names(settings: &RobotSettings) -> Result<Vec<String>, RobotError>;

    /// The robot of the table `[robot]` of a problem, and where its arm starts.
    ///
    /// # Errors
    /// [`RobotError`] with the key at fault.
    fn build(settings: &RobotSettings) -> Result<(Self, Self::Joints), RobotError>;

    /// The same robot as data.
    ///
    /// # Errors
    /// [`RobotError`] with the key at fault.
    fn facts(settings: &RobotSettings) -> Result<RobotFacts, RobotError>;

    /// `problem` with the robot that a person names on a command line; `contract` says what a primitive does. Also what was
    /// changed besides, in words. By default a robot knows its own names only, and takes the problem as it is.
    ///
    /// # Errors
    /// [`RobotError`] when there is no such robot, or it does not fit the problem.
    fn with_robot(
        problem: ProblemFile,
        name: &str,
        _contract: &dyn Fn(&PrimitiveName) -> Option<Contract>,
    ) -> Result<(ProblemFile, Vec<String>), RobotError> {
        let models = Self::models();
        if !models.iter().any(|model| model == name) {
            let nearest = nearest(name, models.iter().map(String::as_str)).map(str::to_owned);
            return Err(RobotFileError::UnknownRobot { name: name.to_owned(), nearest, available: models }.into());
        }
        let robot = RobotSettings { model: Some(name.to_owned()), file: None, ..problem.robot.clone() };
        Ok((ProblemFile { robot, ..problem }, Vec::new()))
    }

    /// The joints of the arm in the posture of this name.
    fn posture(&self, name: &str) -> Option<Self::Joints>;

    /// The values of the variables of the kinematic tree of [`RobotFacts::description`] (rad or m, in the tree's order), with
    /// the hand at work open by `gap_m`, any other by [`Manipulator::idle_gap_m`].
    fn joint_values(&self, q: &Configuration<Self::Joints>, gap_m: f64) -> Vec<f64>;

    /// Does its base move? Primitives that drive are refused for one that does not.
    fn drives(&self) -> bool {
        true
    }

    /// The same robot that draws where it stands from a model of where its arm reaches, if it has one.
    #[must_use]
    fn with_bases_from_reachability(self) -> Self {
        self
    }
}

/// Which joint of the description has which value.
pub type JointValues = Vec<(String, f64)>;

/// A robot as data. Links and joints are named as in the description.
#[derive(Debug, Clone)]
pub struct RobotFacts {
    /// Links, joints and shapes.
    pub description: Arc<RobotDescription>,
    /// Where its meshes are looked for.
    pub meshes: MeshPlaces,
    /// The joints of the arm that manipulates, from the base outwards. The last one moves the hand.
    pub arm_joints: Vec<String>,
    /// The joint that opens the hand as it grows.
    pub finger_joint: String,
    /// The link whose frame is the tool frame: x out of the hand, y the opening axis.
    pub tool_link: String,
    /// The links that may touch what is manipulated; the tips among them.
    pub finger_links: Vec<String>,
    /// The links whose inner faces are the pads, that on the side of +y first.
    pub tip_links: [String; 2],
    /// Do the soft limits of the description bound the arm, or the hard ones?
    pub is_limited_softly: bool,
    /// Where the problem puts the joints at the start, as far as it says.
    pub start: JointValues,
    /// Where joints stand that it does not speak of, for pictures: the open hand, or the hands as those not at work are open.
    pub at_rest: JointValues,
    /// Pairs of links that must be kept apart.
    pub self_pairs: Vec<[String; 2]>,
    /// Its base is bolted down: it never moves.
    pub is_bolted: bool,
    /// Does the base move along its heading only, and turn on the spot?
    pub drives_along_heading: bool,
    /// Length of a pad from the tip back, metres.
    pub pad_length_m: f64,
    /// Force of each finger on what it holds, newton.
    pub grip_force_n: f64,
    /// The heaviest object that the arm carries, kilograms.
    pub payload_kg: f64,
    /// The largest force with which the hand pushes sideways, newton.
    pub push_force_n: f64,
    /// How fast it is driven: what its description does not say, with [`MotionLimits::default`] for what nobody knows.
    pub motion: MotionLimits,
    /// Its second hand and the arm of that, if it has one; the fields above are about the first.
    pub second: Option<HandFacts>,
}

/// What [`RobotFacts`] says of the first hand and its arm, of another one.
#[derive(Debug, Clone, PartialEq)]
pub struct HandFacts {
    /// The joints of its arm, from the base outwards; those of a lift, say, may be the first arm's too. The last one moves the hand.
    pub arm_joints: Vec<String>,
    /// The joint that opens the hand as it grows.
    pub finger_joint: String,
    /// The link whose frame is the tool frame: x out of the hand, y the opening axis.
    pub tool_link: String,
    /// The links that may touch what is manipulated; the tips among them.
    pub finger_links: Vec<String>,
    /// The links whose inner faces are the pads, that on the side of +y first.
    pub tip_links: [String; 2],
    /// Length of a pad from the tip back, metres.
    pub pad_length_m: f64,
    /// Force of each finger on what it holds, newton.
    pub grip_force_n: f64,
    /// The heaviest object that the arm carries, kilograms.
    pub payload_kg: f64,
    /// The largest force with which the hand pushes sideways, newton.
    pub push_force_n: f64,
}

impl RobotFacts {
    /// How many hands it has.
    pub fn hands(&self) -> usize {
        1 + usize::from(self.second.is_some())
    }

    /// The facts as seen from one of its hands, counted from 0: the names and numbers of that hand and its arm in the place of the
    /// first's, and no second hand. What no hand has is as the first's.
    #[must_use]
    pub fn of_hand(&self, hand: usize) -> Self {
        let mut facts = self.clone();
        let Some(second) = facts.second.take().filter(|_| hand == 1) else { return facts };
        let HandFacts {
            arm_joints,
            finger_joint,
            tool_link,
            finger_links,
            tip_links,
            pad_length_m,
            grip_force_n,
            payload_kg,
            push_force_n,
        } = second;
        Self {
            arm_joints,
            finger_joint,
            tool_link,
            finger_links,
            tip_links,
            pad_length_m,
            grip_force_n,
            payload_kg,
            push_force_n,
            ..facts
        }
    }

    /// The joints of all its arms, in the order of the joint vector: those of the first arm, then those of the second that the
    /// first has not.
    pub fn all_arm_joints(&self) -> Vec<&str> {
        let others = self.second.iter().flat_map(|second| &second.arm_joints);
        let others = others.filter(|name| !self.arm_joints.contains(name));
        self.arm_joints.iter().chain(others).map(String::as_str).collect()
    }

    /// The joints that open its hands, the first hand's first.
    pub fn finger_joints(&self) -> impl Iterator<Item = &str> {
        let others = self.second.iter().map(|second| second.finger_joint.as_str());
        std::iter::once(self.finger_joint.as_str()).chain(others)
    }
}

/// A robot that cannot be built as a problem asks.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RobotError {
    /// The description cannot be used.
    #[error(transparent)]
    Urdf(#[from] UrdfError),
    /// The robot file cannot be used.
    #[error(transparent)]
    File(#[from] RobotFileError),
    /// A start of an arm has the wrong number of joints.
    #[error("`{key}` has {found} entries, must have {expected}, one for each joint of the arm")]
    JointCount {
        /// The key.
        key: &'static str,
        /// How many there are.
        found: usize,
        /// How many the arm has.
        expected: usize,
    },
    /// A posture that the robot does not have.
    #[error("`{key}`: there is no posture `{name}`{}; there are {}", suggestion(nearest.as_deref()), available.join(", "))]
    UnknownPosture {
        /// The key.
        key: String,
        /// The name.
        name: String,
        /// The nearest name.
        nearest: Option<String>,
        /// All names.
        available: Vec<String>,
    },
    /// A key that this robot cannot follow.
    #[error("`{key}` {why}")]
    Key {
        /// The key.
        key: &'static str,
        /// Why not: goes on after the key.
        why: String,
    },
    /// What only this kind of robot knows.
    #[error(transparent)]
    Model(Box<dyn std::error::Error + Send + Sync>),
}

impl RobotError {
    /// There is no posture `name`, which `key` asks for, among those that are `available`.
    pub fn unknown_posture(key: impl Into<String>, name: &str, available: impl IntoIterator<Item = String>) -> Self {
        let available: Vec<_> = available.into_iter().collect();
        let nearest = nearest(name, available.iter().map(String::as_str)).map(str::to_owned);
        Self::UnknownPosture { key: key.into(), name: name.to_owned(), nearest, available }
    }

    /// The joints at `key` are `found`, not as many as those of all arms of a robot with so many hands.
    pub fn joint_count(key: &'static str, found: usize, expected: usize, hands: usize) -> Self {
        if hands < 2 {
            return Self::JointCount { key, found, expected };
        }
        Self::Key { key, why: format!("has {found} entries, must have {expected}, one for each joint of both arms") }
    }

    /// An error of the robot's own model.
    pub fn model(error: impl std::error::Error + Send + Sync + 'static) -> Self {
        Self::Model(Box::new(error))
    }
}

fn suggestion(nearest: Option<&str>) -> String {
    nearest.map_or_else(String::new, |name| format!(", did you mean `{name}`?"))
}
